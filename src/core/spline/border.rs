//! Less tension near the frame.
//!
//! The tension draws the slopes to those of the reference surface. Near the frame, the reference surface is a poor one: contours end
//! there, and so do ridge and canyon lines. There the ground goes on better as it bends inside.

use super::steps::distances;
use crate::base::Grid;

/// Lowers the tension at nodes nearer to the frame than `reach` (map units), in proportion to their distance. Those beyond the frame,
/// where `lo` is NaN, keep theirs: they hold the margin of the surface.
pub fn lower_tension(tension: &mut [f32], lo: &[f32], grid: &Grid, reach: f64) {
    if reach == 0.0 {
        return;
    }
    let node = (grid.cell.x * grid.cell.y).sqrt();
    // The nodes beside the frame are one node away.
    let reach = ((reach / node) as f32).max(1.0);
    let distances = distances(|n| lo[n].is_nan(), [grid.cols, grid.rows], (reach, 0.0));
    let inside = tension.iter_mut().zip(lo).zip(distances).filter(|((_, lo), _)| !lo.is_nan());
    inside.for_each(|((tension, _), distance)| *tension *= distance / reach);
}

#[cfg(test)]
mod tests {
    use std::f32::consts::SQRT_2;

    use glam::DVec2;

    use super::*;

    #[test]
    fn the_tension_grows_with_the_distance_from_the_frame() {
        let grid = Grid::on_multiples(DVec2::ZERO, DVec2::new(70.0, 50.0), 10.0);
        let mut lo = vec![0.0; grid.len()];
        lo[grid.cols + 1] = f32::NAN;
        let mut tension = vec![8.0; grid.len()];
        lower_tension(&mut tension, &lo, &grid, 20.0);
        let row = |j: usize| &tension[j * grid.cols..(j + 1) * grid.cols];
        assert_eq!([grid.cols, grid.rows], [7, 5]);
        assert_eq!(row(0), [4.0; 7], "the outermost nodes");
        assert_eq!(row(1), [4.0, 8.0, 4.0, 8.0, 8.0, 8.0, 4.0], "beside a node outside the frame");
        assert_eq!(row(2), [4.0, 4.0, 4.0 * SQRT_2, 8.0, 8.0, 8.0, 4.0]);
    }
}
