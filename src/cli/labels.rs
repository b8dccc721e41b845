//! The arguments about labels.

use std::path::Path;

use clap::Args;
use glam::DVec2;
use tokosen::base::ElevationUnit;
use tokosen::contour::{ContourLayer, ContourLine};
use tokosen::io::VectorFormat;
use tokosen::slice::{Label, LabelParams, place_labels};

use super::failure::Failure;

/// The height of a text, as a share of the longer side of the map, if none is given: 2 mm on a sheet of half a metre.
const USUAL: f64 = 1.0 / 250.0;

/// Labels that a run may place. More cannot be read on any map.
const MOST: f64 = 1e6;

#[derive(Debug, Clone, Args)]
pub struct LabelArgs {
    /// Also write labels of index contours, as points with text, angle (degrees counter-clockwise) and height: a layer
    /// 'labels' in a .gpkg, texts in a .dxf. Their height can be given: --labels=20 [units of the working CRS]
    #[arg(long, value_name = "HEIGHT", num_args = 0..=1, require_equals = true)]
    pub labels: Option<Option<f64>>,
}

impl LabelArgs {
    /// Checks what can be checked before anything is read. `output` is the file of the contours.
    pub fn check(&self, output: &Path, index: u32) -> Result<(), Failure> {
        let Some(height) = self.labels else { return Ok(()) };
        if let Some(bad) = height.filter(|height| !(height.is_finite() && *height > 0.0)) {
            return Err(Failure::Usage(format!("--labels is {bad}, it must be more than 0")));
        }
        if index == 0 {
            return Err(Failure::Usage("--labels are on index contours, and --index 0 asks for none".into()));
        }
        match VectorFormat::from_path(output) {
            Ok(VectorFormat::GeoPackage | VectorFormat::Dxf) => Ok(()),
            _ => Err(Failure::Usage(format!("{}: labels are written in .gpkg or .dxf", output.display()))),
        }
    }

    /// Places labels on the index contours of each layer. `extent` is the box around the map; elevations are written in
    /// `unit`. `None` if there are to be none.
    pub fn place(
        &self,
        layers: &[ContourLayer],
        (low, high): (DVec2, DVec2),
        unit: ElevationUnit,
    ) -> Result<Option<Vec<Vec<Label>>>, Failure> {
        let Some(height) = self.labels else { return Ok(None) };
        let height = height.unwrap_or_else(|| USUAL * (high - low).max_element());
        let params = LabelParams { unit, within: Some([low, high]), ..LabelParams::new(height) };
        let length: f64 = layers.iter().flat_map(|layer| &layer.lines).filter(|line| line.index).map(length_of).sum();
        let count = length / params.spacing;
        if count > MOST {
            let message = format!("--labels={height} gives about {count:.0} labels: choose a greater height");
            return Err(Failure::Usage(message));
        }
        Ok(Some(layers.iter().map(|layer| place_labels(&layer.lines, &params)).collect()))
    }
}

fn length_of(line: &ContourLine) -> f64 {
    line.points.windows(2).map(|pair| pair[0].distance(pair[1])).sum()
}
