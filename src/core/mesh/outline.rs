//! The border of the ground that few triangles are to cover.

use glam::{DVec2, DVec3};

use super::shell;
use crate::dem::derive::square_outlines;
use crate::raster::Dem;
use crate::tin::Tin;

/// The border of some ground. The ground lies on the left of its edges.
pub(super) struct Outline {
    /// Relative to the origin, map units and metres.
    pub vertices: Vec<DVec3>,
    pub edges: Vec<[u32; 2]>,
    pub origin: DVec2,
}

impl Outline {
    /// The outline of a triangulation.
    pub fn of_tin(tin: &Tin) -> Self {
        let (vertices, _, edges) = shell(tin);
        Self { vertices, edges, origin: tin.origin }
    }

    /// The outline of the squares between four cells with heights. Its origin is in whole numbers, near the middle.
    pub fn of_cells(dem: &Dem) -> Self {
        let origin = middle(dem);
        let (mut vertices, mut edges) = (Vec::new(), Vec::new());
        for mut ring in square_outlines(dem).into_iter().flatten() {
            ring.dedup();
            if ring.first() == ring.last() {
                ring.pop();
            }
            let (first, count) = (vertices.len() as u32, ring.len() as u32);
            edges.extend((0..count).map(|k| [first + k, first + (k + 1) % count]));
            let height = |p: DVec2| height_at(dem, (dem.grid.place(p) * DVec2::new(1.0, -1.0)).round());
            vertices.extend(ring.into_iter().map(|p| (p - origin).extend(height(p).unwrap_or(f64::NAN))));
        }
        Self { vertices, edges, origin }
    }
}

/// The middle of a height map, in whole numbers.
pub(super) fn middle(dem: &Dem) -> DVec2 {
    let [low, high] = dem.corners();
    low.midpoint(high).round()
}

/// The height of a cell at a whole-numbered place.
pub(super) fn height_at(dem: &Dem, at: DVec2) -> Option<f64> {
    let (col, row) = (at.x as usize, (-at.y) as usize);
    let is_on = at.x >= 0.0 && at.y <= 0.0 && col < dem.grid.cols && row < dem.grid.rows;
    is_on.then(|| f64::from(dem.values[row * dem.grid.cols + col])).filter(|height| height.is_finite())
}
