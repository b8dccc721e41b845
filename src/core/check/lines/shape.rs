//! Size and position of every line, and the median distance between vertices.

use glam::DVec2;

use crate::base::parallel;
use crate::contour::{Contour, ContourMap};

/// An upright rectangle; empty where `min` is beyond `max`.
#[derive(Debug, Clone, Copy)]
pub(super) struct Box2 {
    pub min: DVec2,
    pub max: DVec2,
}

impl Box2 {
    pub const EMPTY: Self = Self { min: DVec2::INFINITY, max: DVec2::NEG_INFINITY };

    pub fn of(points: impl Iterator<Item = DVec2>) -> Self {
        points.filter(|p| p.is_finite()).fold(Self::EMPTY, |b, p| Self { min: b.min.min(p), max: b.max.max(p) })
    }

    pub fn with(self, other: &Self) -> Self {
        Self { min: self.min.min(other.min), max: self.max.max(other.max) }
    }

    pub fn is_empty(&self) -> bool {
        !self.min.cmple(self.max).all()
    }

    /// Length of the diagonal; 0 if empty.
    pub fn diagonal(&self) -> f64 {
        if self.is_empty() { 0.0 } else { self.min.distance(self.max) }
    }

    /// Whether all of it could be longitudes and latitudes in degrees.
    pub fn fits_degrees(&self) -> bool {
        !self.is_empty() && self.min.cmpge(-DEGREES).all() && self.max.cmple(DEGREES).all()
    }
}

const DEGREES: DVec2 = DVec2::new(180.0, 90.0);

/// Summary of the map's lines.
pub(super) struct Shape {
    /// The box of each line.
    pub boxes: Vec<Box2>,
    /// The length of each line, map units.
    pub lengths: Vec<f64>,
    /// The median distance between successive vertices, map units; 0 without any.
    pub spacing: f64,
}

pub(super) fn of_map(map: &ContourMap) -> Shape {
    let (boxes, lengths) = map.contours.iter().map(|c| (Box2::of(c.points.iter().copied()), c.length())).unzip();
    let mut steps: Vec<f64> = parallel::flat_map_each(&map.contours, steps);
    Shape { boxes, lengths, spacing: median(&mut steps) }
}

/// The lengths of a line's segments, without those of length zero.
pub(super) fn steps(line: &Contour) -> impl Iterator<Item = f64> {
    line.points.windows(2).map(|w| w[0].distance(w[1])).filter(|d| *d > 0.0 && d.is_finite())
}

/// The upper median; 0 if there are no values.
pub(super) fn median(values: &mut [f64]) -> f64 {
    if values.is_empty() {
        return 0.0;
    }
    let middle = values.len() / 2;
    *values.select_nth_unstable_by(middle, f64::total_cmp).1
}
