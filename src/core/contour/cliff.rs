//! Cliffs: lines across which the ground may jump.

use glam::DVec2;

use crate::base::FeatureId;

/// A cliff as a map draws it.
#[derive(Debug, Clone, PartialEq)]
pub struct CliffLine {
    /// Its course, map units.
    pub points: Vec<DVec2>,
    /// The feature that it came from, for messages.
    pub feature: FeatureId,
}
