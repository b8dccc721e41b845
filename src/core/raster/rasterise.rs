//! Rasterises a triangulation to a height map. Triangles are scan-converted in bands of rows, in parallel.

use glam::DVec2;

use super::height_map::Dem;
use crate::base::progress::Progress;
use crate::base::rows::Rows;
use crate::base::{Grid, parallel};
use crate::crs::Crs;
use crate::tin::{NONE, Tin};

/// Rows per task.
const BAND_ROWS: usize = 32;

/// Heights of the triangles at the cell centres of `grid`, metres; NaN outside the frame.
///
/// Every height lies between the lowest and the highest corner of its triangle. A centre on an edge or a corner belongs
/// to the triangle with the lowest number.
pub fn rasterise(tin: &Tin, grid: &Grid, crs: Option<Crs>, progress: &dyn Progress) -> Dem {
    let values = heights_at(tin, grid, &locate(tin, grid, progress));
    Dem { grid: *grid, values, crs }
}

/// Heights of the triangles at the cell centres of `grid`. [`locate`] gives `triangles`.
pub(crate) fn heights_at(tin: &Tin, grid: &Grid, triangles: &[u32]) -> Vec<f32> {
    parallel::cells(grid.cols, grid.rows, |col, row| match triangles[row * grid.cols + col] {
        NONE => f32::NAN,
        t => height(tin, t, grid.center(col, row) - tin.origin) as f32,
    })
}

/// The triangle that each cell centre of `grid` lies in, [`NONE`] outside the frame and where there are no heights.
pub fn locate(tin: &Tin, grid: &Grid, progress: &dyn Progress) -> Vec<u32> {
    let mut triangles = vec![NONE; grid.len()];
    let bands = triangles_by_band(tin, grid);
    progress.start("rasterising", grid.rows as u64);
    if grid.cols > 0 {
        parallel::chunks(&mut triangles, grid.cols * BAND_ROWS, |band, cells| {
            let first_row = band * BAND_ROWS;
            let rows = cells.len() / grid.cols;
            for &t in bands.of(band) {
                fill(tin, grid, t, first_row..first_row + rows, cells);
            }
            progress.advance(rows as u64);
        });
    }
    progress.finish();
    triangles
}

/// Height of triangle `t` at a position relative to the triangulation's origin, between its lowest and highest corner.
pub(crate) fn height(tin: &Tin, t: u32, p: DVec2) -> f64 {
    let heights = tin.corner_heights(t);
    let [_, wb, wc] = tin.weights(t, p);
    let (lowest, highest) = (heights[0].min(heights[1]).min(heights[2]), heights[0].max(heights[1]).max(heights[2]));
    (heights[0] + wb * (heights[1] - heights[0]) + wc * (heights[2] - heights[0])).clamp(lowest, highest)
}

/// Rows whose centres lie between two y coordinates (relative to the origin of the triangulation), with a small margin.
/// Each row makes the exact test itself.
fn rows_between(tin: &Tin, grid: &Grid, lo: f64, hi: f64) -> std::ops::Range<usize> {
    let row = |y: f64| (grid.corner.y - (y + tin.origin.y)) / grid.cell.y - 0.5;
    let limit = |r: f64| r.clamp(0.0, grid.rows as f64) as usize;
    limit((row(hi) - 1e-6).ceil())..limit((row(lo) + 1e-6).floor() + 1.0)
}

/// The triangles that touch each band of rows.
fn triangles_by_band(tin: &Tin, grid: &Grid) -> Rows<u32> {
    let bands: Vec<(u32, u32)> = parallel::values(tin.len(), |t| {
        let [a, b, c] = tin.corners(t as u32);
        let rows = rows_between(tin, grid, a.y.min(b.y).min(c.y), a.y.max(b.y).max(c.y));
        if rows.is_empty() || !tin.is_inside(t as u32) {
            return (0, 0);
        }
        ((rows.start / BAND_ROWS) as u32, rows.end.div_ceil(BAND_ROWS) as u32)
    });
    Rows::new(grid.rows.div_ceil(BAND_ROWS), || {
        let each = bands.iter().enumerate();
        each.flat_map(|(t, &(first, end))| (first..end).map(move |band| (band as usize, t as u32)))
    })
}

/// Fills those cells of a triangle that are still empty.
fn fill(tin: &Tin, grid: &Grid, t: u32, rows: std::ops::Range<usize>, cells: &mut [u32]) {
    let corners = tin.corners(t);
    let heights = tin.corner_heights(t);
    let [a, b, c] = corners;
    if (b - a).perp_dot(c - a) <= 0.0 || heights.iter().any(|h| h.is_nan()) {
        return;
    }
    let (bottom, top) = (a.y.min(b.y).min(c.y), a.y.max(b.y).max(c.y));
    let touched = rows_between(tin, grid, bottom, top);
    for row in touched.start.max(rows.start)..touched.end.min(rows.end) {
        let y = grid.center(0, row).y - tin.origin.y;
        let Some((left, right)) = span(&corners, y) else { continue };
        let column = |x: f64| (x + tin.origin.x - grid.corner.x) / grid.cell.x - 0.5;
        let first = (column(left) - 1e-9).ceil().clamp(0.0, grid.cols as f64) as usize;
        let end = ((column(right) + 1e-9).floor() + 1.0).clamp(0.0, grid.cols as f64) as usize;
        for col in first..end.max(first) {
            let cell = &mut cells[(row - rows.start) * grid.cols + col];
            if *cell == NONE {
                *cell = t;
            }
        }
    }
}

/// The part of the horizontal line at `y` inside a triangle. Both triangles at a common edge get the same end.
fn span(corners: &[DVec2; 3], y: f64) -> Option<(f64, f64)> {
    let (mut left, mut right) = (f64::INFINITY, f64::NEG_INFINITY);
    for i in 0..3 {
        let (mut p, mut q) = (corners[i], corners[(i + 1) % 3]);
        if (p.y, p.x) > (q.y, q.x) {
            std::mem::swap(&mut p, &mut q);
        }
        if p.y <= y && y <= q.y {
            let (lo, hi) = if p.y == q.y {
                (p.x.min(q.x), p.x.max(q.x))
            } else {
                let x = p.x + (q.x - p.x) * ((y - p.y) / (q.y - p.y));
                (x, x)
            };
            left = left.min(lo);
            right = right.max(hi);
        }
    }
    (left <= right).then_some((left, right))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tin::{TinInput, VertexKind, triangulate};

    fn plane(p: DVec2) -> f64 {
        100.0 + 0.25 * p.x - 0.5 * p.y
    }

    #[test]
    fn a_plane_comes_out_exactly_and_without_holes() {
        // Many points are on cell centres and cell edges. So every tie of the scan conversion occurs somewhere.
        let mut input = TinInput::new([DVec2::ZERO, DVec2::splat(16.0)], 0.0);
        for i in 0..=16 {
            for j in 0..=16 {
                let p = DVec2::new(f64::from(i), f64::from(j)) + if (i + j) % 3 == 0 { 0.0 } else { 0.5 };
                input.push(p, plane(p), VertexKind::Spot);
            }
        }
        let tin = triangulate(input).unwrap();
        let grid = Grid { corner: DVec2::new(1.0, 16.0), cell: DVec2::new(0.5, 0.25), cols: 30, rows: 60 };
        let dem = rasterise(&tin, &grid, None, &());
        for row in 0..grid.rows {
            for col in 0..grid.cols {
                let expected = plane(grid.center(col, row)) as f32;
                let value = dem.values[row * grid.cols + col];
                assert!((value - expected).abs() < 1e-4, "{col} {row}: {value} is not {expected}");
            }
        }
    }

    #[test]
    fn cells_outside_are_nodata() {
        let mut input = TinInput::new([DVec2::ZERO, DVec2::splat(4.0)], 0.0);
        for p in [(0.0, 0.0), (4.0, 0.0), (0.0, 4.0)] {
            input.push(p.into(), 1.0, VertexKind::Contour);
        }
        let tin = triangulate(input).unwrap();
        let grid = Grid { corner: DVec2::new(-2.0, 6.0), cell: DVec2::ONE, cols: 8, rows: 8 };
        let dem = rasterise(&tin, &grid, None, &());
        for row in 0..8 {
            for col in 0..8 {
                let p = grid.center(col, row);
                let inside = p.x >= 0.0 && p.y >= 0.0 && p.x + p.y <= 4.0;
                assert_eq!(dem.values[row * 8 + col].is_nan(), !inside, "{p}");
            }
        }
    }
}
