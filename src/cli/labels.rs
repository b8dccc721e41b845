//! The arguments about labels.

use std::path::Path;

use clap::Args;
use glam::DVec2;
use tokosen::base::ElevationUnit;
use tokosen::contour::ContourLayer;
use tokosen::io::VectorFormat;
use tokosen::slice::{Label, label_layers};

use super::failure::Failure;

#[derive(Debug, Clone, Args)]
pub struct LabelArgs {
    /// Also write labels of index contours, as points with text, angle (degrees counter-clockwise) and height: a layer
    /// 'labels' in a .gpkg, texts in a .dxf, a folder in a .kml or .kmz. Their height can be given: --labels=20 [units of the working CRS]
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
            Ok(VectorFormat::GeoPackage | VectorFormat::Dxf | VectorFormat::Kml) => Ok(()),
            _ => Err(Failure::Usage(format!("{}: labels are written in .gpkg, .dxf, .kml or .kmz", output.display()))),
        }
    }

    /// Places labels on the index contours of each layer. `usual` is their height if none is given, map units. `extent` is the box around the map; elevations are written in
    /// `unit`. `None` if there are to be none.
    pub fn place(
        &self,
        layers: &[ContourLayer],
        usual: Option<f64>,
        extent: (DVec2, DVec2),
        unit: ElevationUnit,
    ) -> Result<Option<Vec<Vec<Label>>>, Failure> {
        let placed = self.labels.map(|height| label_layers(layers, height.or(usual), extent, unit));
        placed.transpose().map_err(|error| Failure::Usage(format!("--labels: {error}")))
    }
}
