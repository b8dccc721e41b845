//! Ground beside a stream moves with it.
//!
//! Where the heights of a stream were lowered or raised on a grid, the cells beside it would be the walls of a trench, or
//! fall away from a dam. So they move by a share of the same amount, which ends at some distance. Near a contour, ground
//! moves little: the contour is known.

use rayon::prelude::*;

use crate::base::Grid;

/// Moves the ground beside cells whose heights changed from `before` to `heights`. The share ends `reach` map units from
/// them. All heights stay between `bounds`.
pub(crate) fn ease(
    before: &[f32],
    heights: &mut [f32],
    grid: &Grid,
    reach: f64,
    bounds: impl Fn(usize) -> [f32; 2] + Sync,
) {
    let cells = (reach / grid.cell).floor().max(glam::DVec2::ZERO);
    let [across, down] = [cells.x as isize, cells.y as isize];
    let mut kernel = Vec::new();
    for j in -down..=down {
        for i in -across..=across {
            let [x, y] = [i as f64 * grid.cell.x, j as f64 * grid.cell.y];
            let left = 1.0 - (x * x + y * y) / (reach * reach);
            if left > 0.0 && (i, j) != (0, 0) {
                kernel.push((i, j, (left * left) as f32));
            }
        }
    }
    let (cols, rows) = (grid.cols as isize, grid.rows as isize);
    // The largest move down and up of each cell.
    let mut moves = vec![[0.0f32; 2]; heights.len()];
    for n in 0..heights.len() {
        let by = heights[n] - before[n];
        if by == 0.0 || by.is_nan() {
            continue;
        }
        let (col, row) = (n as isize % cols, n as isize / cols);
        for &(i, j, share) in &kernel {
            let (c, r) = (col + i, row + j);
            if c >= 0 && r >= 0 && c < cols && r < rows {
                let [lower, raise] = &mut moves[(r * cols + c) as usize];
                (*lower, *raise) = (lower.min(share * by), raise.max(share * by));
            }
        }
    }
    heights.par_iter_mut().zip(before).zip(&moves).enumerate().for_each(|(n, ((z, &before), [lower, raise]))| {
        // What moved with the stream itself stays.
        if *z != before || z.is_nan() {
            return;
        }
        let [lo, hi] = bounds(n);
        let t = ((*z - lo) / (hi - lo)).clamp(0.0, 1.0);
        let free = if t.is_nan() { 0.0 } else { (4.0 * t * (1.0 - t)).sqrt() };
        *z = (*z + free * (lower + raise)).clamp(lo, hi);
    });
}
