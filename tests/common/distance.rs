//! The distance from a point to lines.

use glam::DVec2;
use rstar::primitives::Line;
use rstar::{PointDistance, RTree};

/// Lines to which distances are measured.
pub struct Course(RTree<Line<[f64; 2]>>);

impl Course {
    pub fn of<'a>(lines: impl IntoIterator<Item = &'a [DVec2]>) -> Self {
        let pairs = lines.into_iter().flat_map(|line| line.windows(2));
        Self(RTree::bulk_load(pairs.map(|pair| Line::new(pair[0].to_array(), pair[1].to_array())).collect()))
    }

    /// The distance from a point to the nearest place on any of the lines. Infinite if there is no line.
    pub fn distance(&self, p: DVec2) -> f64 {
        let nearest = self.0.nearest_neighbor(&p.to_array());
        nearest.map_or(f64::INFINITY, |line| line.distance_2(&p.to_array()).sqrt())
    }
}
