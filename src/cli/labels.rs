//! The arguments about labels.

use std::path::Path;

use clap::Args;
use glam::DVec2;
use tokosen::base::ElevationUnit;
use tokosen::contour::ContourLayer;
use tokosen::io::VectorFormat;
use tokosen::slice::{Label, LabelParams, place_labels};

use super::failure::Failure;

/// The height of a text, as a share of the longer side of the map, if none is given: 2 mm on a sheet of half a metre.
const USUAL: f64 = 1.0 / 250.0;

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
    /// `unit`.
    pub fn place(
        &self,
        layers: &[ContourLayer],
        (low, high): (DVec2, DVec2),
        unit: ElevationUnit,
    ) -> Option<Vec<Vec<Label>>> {
        let height = self.labels?.unwrap_or_else(|| round(USUAL * (high - low).max_element()));
        let params = LabelParams { unit, within: Some([low, high]), ..LabelParams::new(height) };
        Some(layers.iter().map(|layer| place_labels(&layer.lines, &params)).collect())
    }
}

/// A number near this one whose first digit is 1, 2 or 5 and whose others are 0.
fn round(number: f64) -> f64 {
    let power = 10f64.powf(number.log10().floor());
    let digit = [1.0, 2.0, 5.0, 10.0].into_iter().min_by(|a, b| {
        let off = |digit: &f64| (digit * power / number).ln().abs();
        off(a).total_cmp(&off(b))
    });
    digit.unwrap_or(1.0) * power
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn heights_are_round() {
        for (number, wanted) in [(36.0, 50.0), (12.0, 10.0), (0.0021, 0.002), (800.0, 1000.0)] {
            assert!((round(number) / wanted - 1.0).abs() < 1e-9, "{number}");
        }
    }
}
