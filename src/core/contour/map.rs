//! A map as it is read: contours and spot heights.

use std::collections::BTreeMap;

use glam::{DVec2, DVec3};

use super::spots::SoftSpot;
use super::stated_unit::StatedUnit;
use super::unit_hint::UnitHint;
use crate::base::{ElevationUnit, FeatureId};
use crate::crs::{Crs, HeightSystem, LengthUnit};

/// A line of one elevation.
///
/// Coordinates are map units (x east, y north), elevations metres. A closed line repeats its first point at the end.
#[derive(Debug, Clone, PartialEq)]
pub struct Contour {
    /// Elevation of the whole line.
    pub elevation: f64,
    /// The vertices in order.
    pub points: Vec<DVec2>,
    /// The feature that the line came from, for messages.
    pub feature: FeatureId,
}

impl Contour {
    /// Whether the line ends where it starts, around an area.
    pub fn is_closed(&self) -> bool {
        self.points.len() >= 4 && self.points.first() == self.points.last()
    }

    /// Length along the line, in map units.
    pub fn length(&self) -> f64 {
        self.points.windows(2).map(|w| w[0].distance(w[1])).sum()
    }
}

/// A map's contour lines and spot heights with their coordinate reference system.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct ContourMap {
    /// The contour lines.
    pub contours: Vec<Contour>,
    /// Single points of known height (x, y, elevation).
    pub spots: Vec<DVec3>,
    /// Spot heights with a standard error.
    pub soft_spots: Vec<SoftSpot>,
    /// Features, by number, that the input marks as depression contours (true) or as ordinary contours (false). The
    /// marks are only compared with the contours.
    pub depressions: BTreeMap<FeatureId, bool>,
    /// Positions where cleaning removed a piece of a line that met another line or itself. The rest of the line may be
    /// wrong there. So nothing is learnt from the ground around.
    pub mended: Vec<DVec2>,
    /// Ends of contours at the border of a part that was left out ([`cut_out`](super::cut_out)). They are not joined, and
    /// are no gaps.
    pub cut_ends: Vec<DVec2>,
    /// The coordinate reference system, if the input names one.
    pub crs: Option<Crs>,
    /// The height system, if the input names one.
    pub height_system: Option<HeightSystem>,
    /// The unit of x and y, if the input states it and names no coordinate reference system.
    pub plane_unit: Option<LengthUnit>,
    /// What the input lets suppose about the unit of the elevations, if it is more than nothing.
    pub unit_hint: Option<UnitHint>,
    /// What the input states about that unit beside the elevations.
    pub stated_unit: Option<StatedUnit>,
}

impl ContourMap {
    /// Number of vertices of all contours.
    pub fn vertex_count(&self) -> usize {
        self.contours.iter().map(|c| c.points.len()).sum()
    }

    /// The map with its elevations in metres. They are in `unit`.
    pub fn in_metres(mut self, unit: ElevationUnit) -> Self {
        self.contours.iter_mut().for_each(|line| line.elevation = unit.metres(line.elevation));
        self.spots.iter_mut().for_each(|spot| spot.z = unit.metres(spot.z));
        for spot in &mut self.soft_spots {
            (spot.place.z, spot.sigma) = (unit.metres(spot.place.z), unit.metres(spot.sigma));
        }
        self
    }

    /// Whether all coordinates lie within ±180 and ±90, as degrees do. For maps whose coordinate reference system is
    /// not known. False for a map without lines.
    pub fn looks_like_degrees(&self) -> bool {
        let mut points = self.contours.iter().flat_map(|contour| &contour.points).peekable();
        points.peek().is_some() && points.all(|p| p.x.abs() <= 180.0 && p.y.abs() <= 90.0)
    }

    /// The positions of all contour vertices and spot heights.
    pub fn places(&self) -> impl Iterator<Item = DVec2> {
        let vertices = self.contours.iter().flat_map(|c| c.points.iter().copied());
        vertices.chain(self.spots.iter().map(|s| s.truncate()))
    }
}
