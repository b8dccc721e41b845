//! Break lines as the input gives them, and as they are used.

use glam::{DVec2, DVec3};

use crate::base::{FeatureId, KnownLine, Sure};
use crate::subdomains::Band;

/// A break line as a survey or a map gives it.
#[derive(Debug, Clone, PartialEq)]
pub struct BreakLine {
    /// Its course, map units.
    pub points: Vec<DVec2>,
    /// The height of each point, metres; empty if the line has none.
    pub heights: Vec<f64>,
    /// How the ground bends across it.
    pub bend: Bend,
    /// The feature that it came from, for messages.
    pub feature: FeatureId,
}

/// How the ground bends across a line.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Bend {
    /// In either way.
    #[default]
    Either,
    /// The line is higher than a straight line from side to side.
    Ridge,
    /// The line is lower than a straight line from side to side.
    Valley,
}

/// A piece of a break line as the surface uses it.
#[derive(Debug, Clone, PartialEq)]
pub struct FittedBreakLine {
    /// Vertices (x, y in map units, height in metres).
    pub points: Vec<DVec3>,
    /// How sure the height of each vertex is.
    pub(crate) sure: Vec<Sure>,
    /// The band of the sub-domain around each vertex.
    pub(crate) bands: Vec<Band>,
    /// How the ground bends across it.
    pub bend: Bend,
    /// The feature that it came from.
    pub feature: FeatureId,
}

impl FittedBreakLine {
    /// Its course with heights.
    pub(crate) fn known(&self) -> KnownLine<'_> {
        KnownLine { points: &self.points, is_stream: false, sure: &self.sure }
    }

    /// Length on the map, map units.
    pub fn length(&self) -> f64 {
        self.points.windows(2).map(|w| w[0].truncate().distance(w[1].truncate())).sum()
    }

    /// The share of the vertices whose height the line itself gives.
    pub fn surveyed_share(&self) -> f64 {
        let surveyed = self.sure.iter().filter(|sure| **sure == Sure::Surveyed).count();
        surveyed as f64 / self.sure.len().max(1) as f64
    }

    /// Gives the vertices without a height of their own the heights of a surface.
    pub(crate) fn follow(&mut self, height: impl Fn(DVec2) -> f64) {
        let vertices = self.points.iter_mut().zip(&self.sure).zip(&self.bands);
        for ((p, _), band) in vertices.filter(|((_, sure), _)| **sure == Sure::Guessed) {
            let z = height(p.truncate());
            if !z.is_nan() {
                p.z = band.strictly_inside(z);
            }
        }
    }
}
