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
    /// Pieces of contours that stay edges. They meet at vertices only, and the border has a vertex where they end at it.
    pub kept: Vec<[DVec3; 2]>,
    /// Lines that stay edges. They may cross the contours, the border and each other.
    pub lines: Vec<Vec<DVec3>>,
    pub origin: DVec2,
}

impl Outline {
    /// The outline of a triangulation.
    pub fn of_tin(tin: &Tin) -> Self {
        let (vertices, _, edges) = shell(tin);
        Self { vertices, edges, kept: Vec::new(), lines: Vec::new(), origin: tin.origin }
    }

    /// The outline with the contours of the triangulation, which it has a vertex for wherever they end.
    pub fn with_contours(mut self, tin: &Tin) -> Self {
        // The triangle beyond has the same edge.
        let is_first = |t: u32, i: usize| tin.inner_neighbour(t, i).is_none_or(|n| t < n);
        let is_kept = |t: u32, i: usize| tin.contour_level(t, i).is_some() && is_first(t, i);
        let end = |v: u32| tin.positions[v as usize].extend(tin.heights[v as usize]);
        let kept_of = |t: u32| (0..3).filter(move |&i| is_kept(t, i)).map(move |i| tin.edge(t, i).map(end));
        self.kept = (0..tin.len() as u32).filter(|&t| tin.is_inside(t)).flat_map(kept_of).collect();
        self
    }

    /// The outline with lines in map coordinates.
    pub fn with_lines(mut self, lines: impl Iterator<Item = Vec<DVec3>>) -> Self {
        let relative = |line: Vec<DVec3>| line.into_iter().map(|v| v - self.origin.extend(0.0)).collect();
        self.lines = lines.map(relative).collect();
        self
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
        Self { vertices, edges, kept: Vec::new(), lines: Vec::new(), origin }
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
