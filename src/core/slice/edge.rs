//! Where levels cross an edge of the triangulation.
//!
//! The heights of a smooth surface are not linear along an edge. So a level crosses the edge where the smooth surface has it.
//! Heights never turn back along an edge: between its ends, higher levels cross it further on. So lines of different levels
//! cross each edge in the same order as on flat triangles, and do not cross each other.

use crate::base::parallel;
use crate::spline::WorkingGrids;
use crate::tin::Tin;

/// Parts of an edge in which heights are linear.
const PARTS: usize = 4;
/// Least climb in a part of an edge, as a share of the climb of a straight edge. Without it, lines of different levels could
/// meet.
const LEAST_CLIMB: f64 = 0.05;
/// Edges shorter than this are straight, in steps between the nodes of the working grid. The grid tells little between them.
const SHORTEST: f64 = 0.5;

/// How a smooth surface bends along the edges of its triangulation.
pub struct Bends<'a> {
    tin: &'a Tin,
    working: &'a WorkingGrids,
    /// The smooth surface at the vertices of the triangulation, metres. A vertex need not have this height: contours have
    /// their levels.
    at_vertices: Vec<f32>,
}

impl<'a> Bends<'a> {
    /// The bends of the smooth surface on `working`, along the edges of `tin`.
    pub fn new(tin: &'a Tin, working: &'a WorkingGrids) -> Self {
        let at_vertices = parallel::values_each(&tin.positions, |p| working.at(*p + tin.origin));
        Self { tin, working, at_vertices }
    }

    /// The climb in each part of the edge between two vertices, as shares of the whole climb. `climb` is the difference of
    /// their heights, metres. `None` for a straight edge.
    fn along(&self, [u, v]: [u32; 2], climb: f64) -> Option<[f64; PARTS]> {
        let [a, b] = [u, v].map(|v| self.tin.positions[v as usize]);
        let grid = &self.working.around(a + self.tin.origin)?.grid;
        if a.distance(b) < SHORTEST * grid.cell.max_element() {
            return None;
        }
        let [from, to] = [u, v].map(|v| f64::from(self.at_vertices[v as usize]));
        let mut climbs = [LEAST_CLIMB / PARTS as f64; PARTS];
        let mut highest = 0.0;
        for (k, part) in climbs.iter_mut().enumerate() {
            let share = (k + 1) as f64 / PARTS as f64;
            let smooth = f64::from(self.working.at(a.lerp(b, share) + self.tin.origin));
            let bend = if k + 1 == PARTS { 0.0 } else { smooth - (from + share * (to - from)) };
            if bend.is_nan() {
                return None;
            }
            let height = (share + bend / climb).clamp(highest, 1.0);
            *part = part.max(height - highest);
            highest = height;
        }
        let sum: f64 = climbs.iter().sum();
        Some(climbs.map(|part| part / sum))
    }
}

/// The heights along an edge, from one end to the other.
pub(super) struct Edge {
    from: f64,
    climb: f64,
    /// The climb in each part, as shares of the whole one; `None` if it is straight.
    bend: Option<[f64; PARTS]>,
}

impl Edge {
    /// The edge between two vertices with different heights.
    pub fn new(vertices: [u32; 2], [from, to]: [f64; 2], bends: Option<&Bends<'_>>) -> Self {
        let climb = to - from;
        Self { from, climb, bend: bends.and_then(|bends| bends.along(vertices, climb)) }
    }

    /// Where a level crosses the edge, as a share of its length. Levels beyond an end cross there, or beyond it.
    pub fn share(&self, level: f64) -> f64 {
        let mut left = (level - self.from) / self.climb;
        let Some(climbs) = &self.bend else { return left };
        left = left.clamp(0.0, 1.0);
        for (k, part) in climbs.iter().enumerate() {
            if left <= *part {
                return (k as f64 + left / part) / PARTS as f64;
            }
            left -= part;
        }
        1.0
    }

    /// Whether heights rise from its first end to its second.
    pub fn rises(&self) -> bool {
        self.climb > 0.0
    }
}

#[cfg(test)]
mod tests {
    use glam::DVec2;

    use super::*;
    use crate::base::Grid;
    use crate::spline::WorkingGrid;
    use crate::tin::{TinInput, VertexKind, triangulate};

    /// The edge from (0, 0) to (8, 0) on a surface of these heights over x, and the shares at which levels cross it.
    fn shares(height: impl Fn(f64) -> f64, levels: &[f64]) -> Vec<f64> {
        let grid = Grid { corner: DVec2::new(-4.5, 4.5), cell: DVec2::ONE, cols: 17, rows: 9 };
        let heights = (0..grid.len()).map(|n| height(grid.center(n % grid.cols, 0).x) as f32).collect();
        let working = WorkingGrids(vec![WorkingGrid { grid, heights }]);
        let mut input = TinInput::new([DVec2::ZERO, DVec2::new(8.0, 3.0)], 0.0);
        let ends = [DVec2::ZERO, DVec2::new(8.0, 0.0), DVec2::new(3.0, 3.0)];
        for p in ends {
            input.push(p, height(p.x), VertexKind::Spot);
        }
        let tin = triangulate(input).unwrap();
        let vertex = |p: DVec2| tin.positions.iter().position(|q| *q + tin.origin == p).unwrap();
        let [u, v] = [vertex(ends[0]), vertex(ends[1])];
        let bends = Bends::new(&tin, &working);
        let edge = Edge::new([u as u32, v as u32], [tin.heights[u], tin.heights[v]], Some(&bends));
        levels.iter().map(|&level| edge.share(level)).collect()
    }

    #[test]
    fn levels_cross_an_edge_where_the_smooth_surface_has_them() {
        let parabola = shares(|x| x * x / 8.0, &[0.0, 0.5, 2.0, 4.5, 8.0]);
        let expected = [0.0, 0.25, 0.5, 0.75, 1.0];
        assert!(parabola.iter().zip(expected).all(|(a, b)| (a - b).abs() < 0.02), "{parabola:?}");
        let straight = shares(|x| 10.0 - x, &[9.0, 6.0, 3.0]);
        assert!(straight.iter().zip([0.125, 0.5, 0.875]).all(|(a, b)| (a - b).abs() < 1e-6), "{straight:?}");
    }

    #[test]
    fn levels_keep_their_order_where_the_smooth_surface_turns_back() {
        let waves = |x: f64| x / 4.0 + 3.0 * (x * 1.3).sin();
        let (from, to) = (waves(0.0), waves(8.0));
        let levels: Vec<f64> = (0..=1000).map(|k| from + (to - from) * f64::from(k) / 1000.0).collect();
        let shares = shares(waves, &levels);
        assert!(shares.windows(2).all(|w| w[0] < w[1]), "{shares:?}");
        assert!(shares[0] == 0.0 && (shares[1000] - 1.0).abs() < 1e-9);
    }
}
