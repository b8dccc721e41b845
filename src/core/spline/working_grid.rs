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

    /// The height at a position. A node's own height within a millionth of a cell, otherwise interpolated from the sixteen
    /// nodes around by cubic convolution. Nodes beyond the frame are extrapolated linearly from those inside. NaN where none
    /// of the four nodes around is inside.
    pub(crate) fn at(&self, p: DVec2) -> f32 {
        let place = Lattice::of_grid(&self.grid).place(p);
        let near = place.round();
        if self.node(near).is_none() {
            return f32::NAN;
        }
        if (place - near).abs().max_element() < ON_NODE {
            return self.node(near).unwrap_or(f32::NAN);
        }
        let first = place.floor();
        let mut block: [[f64; 4]; 4] = std::array::from_fn(|j| {
            std::array::from_fn(|i| {
                let node = self.node(first + DVec2::new(i as f64 - 1.0, j as f64 - 1.0));
                node.map_or(f64::NAN, f64::from)
            })
        });
        if block.iter().flatten().any(|height| height.is_nan()) {
            if block[1..3].iter().flat_map(|row| &row[1..3]).all(|height| height.is_nan()) {
                return f32::NAN;
            }
            extrapolate(&mut block);
        }
        let (wx, wy) = (cubic(place.x - first.x), cubic(place.y - first.y));
        let mut sum = 0.0;
        for (row, wy) in block.iter().zip(&wy) {
            for (height, wx) in row.iter().zip(&wx) {
                sum += wx * wy * height;
            }
        }
        sum as f32
    }

    /// The height of a node by its column and row; `None` off the grid. NaN outside the frame.
    fn node(&self, place: DVec2) -> Option<f32> {
        let Grid { cols, rows, .. } = self.grid;
        let is_on = place.cmpge(DVec2::ZERO).all() && place.cmplt(DVec2::new(cols as f64, rows as f64)).all();
        is_on.then(|| self.heights[place.y as usize * cols + place.x as usize])
    }
}

/// Gives nodes without a height one: along rows and columns with two heights or more, linearly, and at last where there is a
/// single height.
fn extrapolate(block: &mut [[f64; 4]; 4]) {
    for least in [2, 2, 1] {
        block.iter_mut().for_each(|row| fill(row, least));
        for i in 0..4 {
            let mut column = block.map(|row| row[i]);
            fill(&mut column, least);
            block.iter_mut().zip(column).for_each(|(row, height)| row[i] = height);
        }
    }
}

/// Gives those without a height one, if at least `least` have one: on the line through the two nearest that have one, or that
/// of the only one.
fn fill(heights: &mut [f64; 4], least: usize) {
    let known = *heights;
    for (k, height) in heights.iter_mut().enumerate().filter(|(_, height)| height.is_nan()) {
        let mut near: Vec<usize> = (0..4).filter(|&n| known[n].is_finite()).collect();
        near.sort_by_key(|&n| n.abs_diff(k));
        match near[..] {
            [a, b, ..] => {
                let slope = (known[b] - known[a]) / (b as f64 - a as f64);
                *height = known[a] + slope * (k as f64 - a as f64);
            }
            [a] if least == 1 => *height = known[a],
            _ => {}
        }
    }
}

/// Weights of four neighbours (Catmull-Rom, Keys 1981 with a = -1/2) at `t` between the second and the third.
fn cubic(t: f64) -> [f64; 4] {
    let (t2, t3) = (t * t, t * t * t);
    [(-t3 + 2.0 * t2 - t) / 2.0, (3.0 * t3 - 5.0 * t2 + 2.0) / 2.0, (-3.0 * t3 + 4.0 * t2 + t) / 2.0, (t3 - t2) / 2.0]
}

#[cfg(test)]
mod tests {
    use super::*;

    /// At the frame, heights follow the slope of the ground: they are not the mean of the nodes inside.
    #[test]
    fn a_slope_goes_on_to_the_last_cell_beside_the_frame() {
        let grid = Grid { corner: DVec2::new(-0.5, 20.5), cell: DVec2::ONE, cols: 21, rows: 21 };
        let slope = |p: DVec2| 100.0 + 3.0 * p.x - 2.0 * p.y;
        let is_inside = |p: DVec2| p.x + 0.4 * p.y < 17.0 && p.y > 2.3;
        let node = |k: usize| grid.center(k % grid.cols, k / grid.cols);
        let height = |k: usize| if is_inside(node(k)) { slope(node(k)) as f32 } else { f32::NAN };
        let working = WorkingGrid { grid, heights: (0..grid.len()).map(height).collect() };
        let places = (0..400).flat_map(|i| (0..400).map(move |j| DVec2::new(f64::from(i), f64::from(j)) * 0.05));
        let (mut seen, mut beside) = (0, 0);
        for p in places.filter(|p| is_inside(*p)) {
            let found = f64::from(working.at(p));
            if found.is_nan() {
                continue;
            }
            seen += 1;
            beside += usize::from(!is_inside(p + DVec2::new(1.0, -1.0)));
            assert!((found - slope(p)).abs() < 1e-3, "{found} at {p}, and {} is right", slope(p));
        }
        assert!(seen > 50_000 && beside > 2_000, "{seen} places, {beside} of them beside the frame");
    }

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
