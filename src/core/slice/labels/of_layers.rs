//! Labels of all layers of a result, with usual sizes.

use glam::DVec2;

use super::{Label, LabelParams, place_labels};
use crate::base::ElevationUnit;
use crate::base::error::{Error, Result};
use crate::contour::{ContourLayer, ContourLine};

/// The height of a text, as a share of the longer side of the map, if none is given: 2 mm on a sheet of half a metre.
const USUAL: f64 = 1.0 / 250.0;

/// Labels that a run may place. More cannot be read on any map.
const MOST: f64 = 1e6;

/// Chooses the places of labels on the index contours of each layer. `text_height` is that of the text, map units; if
/// `None`, a share of the longer side of the map. `extent` is the box around the map, in which labels lie. Elevations are
/// written in `unit`.
///
/// # Errors
/// [`Error::OutOfRange`] for a height that is not above 0. [`Error::Parameter`] if there would be too many labels.
pub fn label_layers(
    layers: &[ContourLayer],
    text_height: Option<f64>,
    (low, high): (DVec2, DVec2),
    unit: ElevationUnit,
) -> Result<Vec<Vec<Label>>> {
    if let Some(bad) = text_height.filter(|height| !(height.is_finite() && *height > 0.0)) {
        return Err(Error::out_of_range("height of labels", bad, "more than 0"));
    }
    let height = text_height.unwrap_or_else(|| USUAL * (high - low).max_element());
    let params = LabelParams { unit, within: Some([low, high]), ..LabelParams::new(height) };
    let length: f64 = layers.iter().flat_map(|layer| &layer.lines).filter(|line| line.index).map(length_of).sum();
    let count = length / params.spacing;
    if count > MOST {
        let message = format!("a text height of {height} gives about {count:.0} labels: choose a greater height");
        return Err(Error::Parameter(message));
    }
    Ok(layers.iter().map(|layer| place_labels(&layer.lines, &params)).collect())
}

fn length_of(line: &ContourLine) -> f64 {
    line.points.windows(2).map(|pair| pair[0].distance(pair[1])).sum()
}
