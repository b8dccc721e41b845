//! Lines of a coast.

use glam::DVec2;

use crate::base::FeatureId;

/// A line of a coast, or a ring of an area of land or sea.
#[derive(Debug, Clone, PartialEq)]
pub struct CoastLine {
    /// Its vertices, map units.
    pub points: Vec<DVec2>,
    /// The level of the sea; 0 if `None`.
    pub level: Option<f64>,
    /// The feature that it came from, for messages.
    pub feature: FeatureId,
}
