//! Heights of a surface on any grid.

use rayon::prelude::*;

use super::{Surface, WorkingGrid};
use crate::dem::{Dem, Grid, locate, rasterise};
use crate::progress::Progress;
use crate::tin::NONE;

/// Heights of the surface at the cell centres of `grid`, NaN outside the frame.
///
/// Those of the smooth surface are the working grid's own where a centre is one of its nodes, else interpolated between
/// them (cubic convolution) and kept in the band of the sub-domain. Other surfaces are triangles (see [`rasterise`]).
pub fn heights(surface: &Surface, grid: &Grid, progress: &dyn Progress) -> Dem {
    let Some(working) = &surface.working else {
        return rasterise(&surface.tin, grid, surface.map.crs.clone(), progress);
    };
    let triangles = locate(&surface.tin, grid, progress);
    let height = |(i, t): (usize, u32)| {
        let region = if t == NONE { None } else { surface.regions.region(t) };
        let Some(region) = region else { return f32::NAN };
        let value = working.at(grid.center(i % grid.cols, i / grid.cols));
        value.clamp(region.band.lo as f32, region.band.hi as f32)
    };
    let values = triangles.into_par_iter().enumerate().map(height).collect();
    Dem { grid: *grid, values, crs: surface.map.crs.clone() }
}

impl WorkingGrid {
    /// The height at a position: a node's own within a millionth of a cell, else interpolated; NaN off the grid.
    pub(super) fn at(&self, p: glam::DVec2) -> f32 {
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
        if (x - col).abs() < 1e-6 && (y - row).abs() < 1e-6 {
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
