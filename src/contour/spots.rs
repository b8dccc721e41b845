//! Points of known height.

use glam::DVec3;

use crate::crs::Crs;

/// Points of known height.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct SpotHeights {
    /// x, y in map units, height in metres.
    pub points: Vec<DVec3>,
    /// The coordinate reference system, if it is known.
    pub crs: Option<Crs>,
}
