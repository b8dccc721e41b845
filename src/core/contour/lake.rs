//! Flat water beside the contours.

use geo::Polygon;

use crate::base::{ElevationUnit, FeatureId};

/// A lake, a reservoir, a piece of the sea: level ground at one height.
#[derive(Debug, Clone, PartialEq)]
pub struct Lake {
    /// The shore, map units; holes are islands. It does not cross itself.
    pub polygon: Polygon<f64>,
    /// Height of the water, metres, if it is known.
    pub height: Option<f64>,
    /// The feature that it came from, for messages.
    pub feature: FeatureId,
}

impl Lake {
    /// The lake with its height in metres. It is in `unit`.
    pub fn in_metres(self, unit: ElevationUnit) -> Self {
        Self { height: self.height.map(|height| unit.metres(height)), ..self }
    }
}
