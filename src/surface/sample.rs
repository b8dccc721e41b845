//! Heights of a surface on any grid.

use glam::DVec2;
use rayon::prelude::*;

use super::Surface;
use crate::base::Grid;
use crate::base::progress::Progress;
use crate::dem::{Dem, height, locate, rasterise};
use crate::spline::WorkingGrid;
use crate::spline::on_contours;
use crate::tin::{NONE, Tin};

/// Rows that one task fills.
const BAND_ROWS: usize = 16;
/// Nearer than this to a node, in steps between nodes, is on it.
const AT_NODE: f64 = 1e-6;

/// Heights of the surface at the cell centres of `grid`, NaN outside the frame.
///
/// Those of the smooth surface are the working grid's own where a centre is one of its nodes, else interpolated between
/// them (cubic convolution) and kept in the band of the sub-domain; a centre that is a vertex of a contour has its level. Other
/// surfaces are triangles (see [`rasterise`]).
pub fn heights(surface: &Surface, grid: &Grid, progress: &dyn Progress) -> Dem {
    let Some(working) = &surface.working else {
        return rasterise(&surface.tin, grid, surface.map.crs.clone(), progress);
    };
    if let Some(values) = working.on_nodes(grid) {
        return Dem { grid: *grid, values, crs: surface.map.crs.clone() };
    }
    let triangles = locate(&surface.tin, grid, progress);
    let height = |(i, t): (usize, u32)| {
        if t == NONE { f32::NAN } else { height_in(surface, t, grid.center(i % grid.cols, i / grid.cols)) }
    };
    let mut values: Vec<f32> = triangles.par_iter().copied().enumerate().map(height).collect();
    for (cell, level) in on_contours(&surface.map, grid) {
        if triangles[cell] != NONE
            && let Some(region) = surface.regions.region(triangles[cell])
        {
            values[cell] = level.clamp(region.band.lo, region.band.hi) as f32;
        }
    }
    Dem { grid: *grid, values, crs: surface.map.crs.clone() }
}

/// Heights of the surface at the cell centres of a grid that lies in other coordinates than the surface, row by row from
/// the north-west, NaN outside the frame.
///
/// `to_surface` gives the place on the surface of a place in the grid's coordinates, or none. The surface is evaluated at
/// each centre: no raster is resampled.
pub fn heights_on(
    surface: &Surface,
    grid: &Grid,
    to_surface: &(impl Fn(DVec2) -> Option<DVec2> + Sync),
    progress: &dyn Progress,
) -> Vec<f32> {
    let tin = &surface.tin;
    let mut values = vec![f32::NAN; grid.len()];
    if values.is_empty() || tin.is_empty() {
        return values;
    }
    progress.start("evaluating the surface", grid.rows as u64);
    values.par_chunks_mut(grid.cols * BAND_ROWS).enumerate().for_each(|(band, cells)| {
        // Centres are looked for from the triangle of the centre before, at the start of a row from that of the row before.
        let mut start_of_row = 0;
        for (k, row) in cells.chunks_mut(grid.cols).enumerate() {
            let mut near = start_of_row;
            for (col, value) in row.iter_mut().enumerate() {
                let Some(p) = to_surface(grid.center(col, band * BAND_ROWS + k)) else { continue };
                let found = tin.walk(near, p - tin.origin);
                near = found.unwrap_or_else(|left| left);
                if col == 0 {
                    start_of_row = near;
                }
                if let Some(t) = found.ok().and_then(|t| with_height(tin, t, p - tin.origin)) {
                    *value = height_in(surface, t, p);
                }
            }
        }
        progress.advance((cells.len() / grid.cols) as u64);
    });
    progress.finish();
    values
}

/// The triangle itself or, for a place on its edge, a neighbour, whichever is inside the frame and has heights.
fn with_height(tin: &Tin, t: u32, place: DVec2) -> Option<u32> {
    let good = |t: u32| tin.is_inside(t) && tin.corner_heights(t).iter().all(|h| !h.is_nan());
    if good(t) {
        return Some(t);
    }
    let mut around = tin.neighbours[t as usize].into_iter();
    around.find(|&n| n != NONE && good(n) && tin.holds(n, place))
}

/// The height of the surface at a place in triangle `t`.
fn height_in(surface: &Surface, t: u32, p: DVec2) -> f32 {
    match &surface.working {
        None => height(&surface.tin, t, p - surface.tin.origin) as f32,
        Some(working) => surface.regions.region(t).map_or(f32::NAN, |region| {
            let (lo, hi) = (region.band.lo as f32, region.band.hi as f32);
            // Where the frame is narrower than the working grid's cells, no node may be near.
            let smooth = Some(working.at(p)).filter(|height| !height.is_nan());
            smooth.unwrap_or_else(|| height(&surface.tin, t, p - surface.tin.origin) as f32).clamp(lo, hi)
        }),
    }
}

impl WorkingGrid {
    /// The heights on a grid whose centres are nodes, as far as there are any there: nodes cover the frame. `None` for other
    /// grids.
    fn on_nodes(&self, grid: &Grid) -> Option<Vec<f32>> {
        let from = (grid.center(0, 0) - self.grid.center(0, 0)) / self.grid.cell * DVec2::new(1.0, -1.0);
        let first = from.round();
        // Farther away they are not counted exactly.
        let is_near = first.abs().max_element() < f64::from(u32::MAX);
        if grid.cell != self.grid.cell || !is_near || (from - first).abs().max_element() >= AT_NODE {
            return None;
        }
        let (first_col, first_row) = (first.x as i64, first.y as i64);
        let cols = 0..self.grid.cols as i64;
        let value = |i: usize| {
            let (col, row) = (first_col + (i % grid.cols) as i64, first_row + (i / grid.cols) as i64);
            let node = usize::try_from(row * self.grid.cols as i64 + col).ok().filter(|_| cols.contains(&col));
            node.and_then(|node| self.heights.get(node)).copied().unwrap_or(f32::NAN)
        };
        Some((0..grid.len()).into_par_iter().map(value).collect())
    }

    /// The height at a position: a node's own within a millionth of a cell, else interpolated; NaN off the grid.
    pub(crate) fn at(&self, p: glam::DVec2) -> f32 {
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
        if (x - col).abs() < AT_NODE && (y - row).abs() < AT_NODE {
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

/// Mean of the four nodes around that have heights, by nearness.
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
