//! A part of the map whose contours do not count.

use geo::Polygon;

use crate::base::FeatureId;

/// A polygon whose contours and spot heights are left out.
#[derive(Debug, Clone, PartialEq)]
pub struct Excluded {
    /// The polygon, map units; ground in its holes counts. It does not cross itself.
    pub polygon: Polygon<f64>,
    /// The feature that it came from, for messages.
    pub feature: FeatureId,
}
