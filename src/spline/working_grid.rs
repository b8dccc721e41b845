//! Heights on the working grid, and between its nodes.

use glam::DVec2;

use super::lattice::Lattice;
use crate::base::{Grid, parallel};

/// A place nearer to a node than this is at the node, in steps between nodes: a tolerance of rounding.
const ON_NODE: f64 = 1e-6;

/// Heights at the nodes of a working grid.
#[derive(Debug, Clone, PartialEq)]
pub struct WorkingGrid {
    /// The grid. The centres of its cells are the nodes.
    pub grid: Grid,
    /// Heights, metres, within the band of each node's sub-domain; NaN outside the frame.
    pub heights: Vec<f32>,
}

/// The smooth surface on a working grid for each group of contours that lie far apart. Most maps have one.
#[derive(Debug, Clone, PartialEq)]
pub struct WorkingGrids(pub Vec<WorkingGrid>);

impl WorkingGrids {
    /// The heights on a grid whose cell centres are nodes of all working grids, NaN beyond them. `None` for other grids.
    pub(crate) fn on_nodes(&self, grid: &Grid) -> Option<Vec<f32>> {
        let mut parts = self.0.iter().map(|working| working.on_nodes(grid));
        let mut heights = parts.next()??;
        for part in parts {
            let part = part?;
            parallel::update(&mut heights, |cell, height| {
                if height.is_nan() {
                    *height = part[cell];
                }
            });
        }
        Some(heights)
    }

    /// The working grid around a position; `None` off all of them.
    pub(crate) fn around(&self, p: DVec2) -> Option<&WorkingGrid> {
        self.0.iter().find(|working| working.nearest(p).is_some())
    }

    /// The height at a position, as [`WorkingGrid::at`] gives it.
    pub(crate) fn at(&self, p: DVec2) -> f32 {
        self.around(p).map_or(f32::NAN, |working| working.at(p))
    }
}

impl WorkingGrid {
    /// The heights on a grid whose cell centres are nodes, NaN beyond the working grid. `None` for other grids.
    pub(crate) fn on_nodes(&self, grid: &Grid) -> Option<Vec<f32>> {
        let from = (grid.center(0, 0) - self.grid.center(0, 0)) / self.grid.cell * DVec2::new(1.0, -1.0);
        let first = from.round();
        // Larger offsets cannot be counted exactly.
        let is_near = first.abs().max_element() < f64::from(u32::MAX);
        if grid.cell != self.grid.cell || !is_near || (from - first).abs().max_element() >= ON_NODE {
            return None;
        }
        let (first_col, first_row) = (first.x as i64, first.y as i64);
        let cols = 0..self.grid.cols as i64;
        let value = |i: usize| {
            let (col, row) = (first_col + (i % grid.cols) as i64, first_row + (i / grid.cols) as i64);
            let node = usize::try_from(row * self.grid.cols as i64 + col).ok().filter(|_| cols.contains(&col));
            node.and_then(|node| self.heights.get(node)).copied().unwrap_or(f32::NAN)
        };
        Some(parallel::values(grid.len(), value))
    }

    /// The node nearest to a position; `None` off the grid.
    pub(crate) fn nearest(&self, p: DVec2) -> Option<usize> {
        let place = Lattice::of_grid(&self.grid).place(p).round();
        let is_on = place.cmpge(DVec2::ZERO).all()
            && place.cmplt(DVec2::new(self.grid.cols as f64, self.grid.rows as f64)).all();
        is_on.then(|| place.y as usize * self.grid.cols + place.x as usize)
    }

    /// The height at a position. A node's own height within a millionth of a cell, otherwise interpolated; NaN off the
    /// grid.
    pub(crate) fn at(&self, p: DVec2) -> f32 {
        let grid = &self.grid;
        let first = grid.center(0, 0);
        let (x, y) = ((p.x - first.x) / grid.cell.x, (first.y - p.y) / grid.cell.y);
        let (col, row) = (x.round(), y.round());
        let on_grid = |c: f64, r: f64| c >= 0.0 && r >= 0.0 && c < grid.cols as f64 && r < grid.rows as f64;
        let node = |c: f64, r: f64| {
            let (c, r) = (c.clamp(0.0, grid.cols as f64 - 1.0), r.clamp(0.0, grid.rows as f64 - 1.0));
            self.heights[r as usize * grid.cols + c as usize]
        };
        if !on_grid(col, row) {
            return f32::NAN;
        }
        if (x - col).abs() < ON_NODE && (y - row).abs() < ON_NODE {
            return node(col, row);
        }
        let (c, r) = (x.floor(), y.floor());
        let (wx, wy) = (cubic(x - c), cubic(y - r));
        let (mut sum, mut complete) = (0.0, true);
        for (j, wy) in wy.iter().enumerate() {
            for (i, wx) in wx.iter().enumerate() {
                let value = node(c + i as f64 - 1.0, r + j as f64 - 1.0);
                complete &= value.is_finite();
                sum += wx * wy * f64::from(value);
            }
        }
        if complete { sum as f32 } else { nearest(&node, x, y) }
    }
}

/// Mean of those of the four nodes around that have heights, weighted by nearness.
fn nearest(node: &impl Fn(f64, f64) -> f32, x: f64, y: f64) -> f32 {
    let (c, r) = (x.floor(), y.floor());
    let (mut sum, mut weights) = (0.0, 0.0);
    for (i, j) in [(0.0, 0.0), (1.0, 0.0), (0.0, 1.0), (1.0, 1.0)] {
        let value = node(c + i, r + j);
        let weight = (1.0 - (x - c - i).abs()) * (1.0 - (y - r - j).abs());
        if value.is_finite() {
            sum += weight * f64::from(value);
            weights += weight;
        }
    }
    (sum / weights) as f32
}

/// Weights of four neighbours (Catmull-Rom, Keys 1981 with a = -1/2) at `t` between the second and the third.
fn cubic(t: f64) -> [f64; 4] {
    let (t2, t3) = (t * t, t * t * t);
    [(-t3 + 2.0 * t2 - t) / 2.0, (3.0 * t3 - 5.0 * t2 + 2.0) / 2.0, (-3.0 * t3 + 4.0 * t2 + t) / 2.0, (t3 - t2) / 2.0]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cells_on_nodes_have_their_heights() {
        let grid = Grid { corner: DVec2::new(100.0, 50.0), cell: DVec2::new(2.0, 3.0), cols: 4, rows: 3 };
        let working = WorkingGrid { grid, heights: (0_u8..12).map(f32::from).collect() };
        let moved = |by: DVec2| Grid { corner: grid.corner + by, cols: 3, rows: 3, ..grid };
        let values = working.on_nodes(&moved(DVec2::new(4.0, -3.0))).unwrap();
        let expected = [6.0, 7.0, f32::NAN, 10.0, 11.0, f32::NAN, f32::NAN, f32::NAN, f32::NAN];
        let bits = |values: &[f32]| values.iter().map(|v| v.to_bits()).collect::<Vec<u32>>();
        assert_eq!(bits(&values), bits(&expected));
        let values = working.on_nodes(&moved(DVec2::new(-2.0, 3.0))).unwrap();
        assert!(values[..4].iter().all(|v| v.is_nan()) && values[4..6] == [0.0, 1.0] && values[7..] == [4.0, 5.0]);
        assert_eq!(working.on_nodes(&moved(DVec2::new(1.0, 0.0))), None);
        assert_eq!(working.on_nodes(&moved(DVec2::new(1e300, 0.0))), None);
        assert_eq!(working.on_nodes(&Grid { cell: DVec2::new(2.0, 1.5), ..grid }), None);
    }
}
