//! A straight segment, and the upright rectangle around points.

use glam::DVec2;

/// One segment.
#[derive(Debug, Clone, Copy)]
pub struct Segment {
    /// One end.
    pub a: DVec2,
    /// The other end.
    pub b: DVec2,
}

impl Segment {
    pub fn bounds(&self) -> Bounds {
        Bounds { min: self.a.min(self.b), max: self.a.max(self.b) }
    }
}

/// An upright rectangle.
#[derive(Clone, Copy)]
pub struct Bounds {
    pub min: DVec2,
    pub max: DVec2,
}

impl Bounds {
    /// Grown by `margin` on all sides.
    pub fn grown(self, margin: f64) -> Self {
        Self { min: self.min - margin, max: self.max + margin }
    }

    /// Whether they share a point.
    pub fn meets(&self, other: &Self) -> bool {
        self.min.cmple(other.max).all() && other.min.cmple(self.max).all()
    }

    /// The smallest rectangle around points.
    pub fn around(points: &[DVec2]) -> Self {
        let none = Self { min: DVec2::INFINITY, max: DVec2::NEG_INFINITY };
        points.iter().fold(none, |b, &p| Self { min: b.min.min(p), max: b.max.max(p) })
    }

    pub fn union(self, other: Self) -> Self {
        Self { min: self.min.min(other.min), max: self.max.max(other.max) }
    }
}
