//! Points of known height.

use glam::DVec3;

use super::stated_unit::StatedUnit;
use super::unit_hint::UnitHint;
use crate::crs::Crs;

/// A spot height with its standard error. The surface comes near it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SoftSpot {
    /// Map position and height, metres.
    pub place: DVec3,
    /// Standard error, metres.
    pub sigma: f64,
}

/// Points of known height.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct SpotHeights {
    /// x, y in map units, height in metres; as a file was read, in its unit.
    pub points: Vec<DVec3>,
    /// The standard error of each height, in the same unit, where the file gives one.
    pub sigmas: Vec<Option<f64>>,
    /// The coordinate reference system, if it is known.
    pub crs: Option<Crs>,
    /// What the file lets suppose about the unit of the heights, if it is more than nothing.
    pub unit_hint: Option<UnitHint>,
    /// What the file states about that unit beside the heights.
    pub stated_unit: Option<StatedUnit>,
}
