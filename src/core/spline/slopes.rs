//! Slopes of heights at the nodes of a grid.

use crate::base::{Grid, parallel};

/// Slope at every node, rise over run; NaN beside nodes outside the frame.
pub(crate) fn slopes(heights: &[f32], grid: &Grid) -> Vec<f32> {
    let at = |i: usize, j: usize| {
        let (w, e) = (i.saturating_sub(1), (i + 1).min(grid.cols - 1));
        let (s, t) = (j.saturating_sub(1), (j + 1).min(grid.rows - 1));
        let east =
            (heights[j * grid.cols + e] - heights[j * grid.cols + w]) / ((e - w).max(1) as f64 * grid.cell.x) as f32;
        let south =
            (heights[t * grid.cols + i] - heights[s * grid.cols + i]) / ((t - s).max(1) as f64 * grid.cell.y) as f32;
        (east * east + south * south).sqrt()
    };
    parallel::cells(grid.cols, grid.rows, at)
}
