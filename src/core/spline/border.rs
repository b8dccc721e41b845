//! Less tension near the frame.
//!
//! The tension draws the slopes to those of the reference surface. Near the frame, the reference surface is a poor one: contours end
//! there, and so do ridge and canyon lines. There the ground goes on better as it bends inside.

use std::f32::consts::SQRT_2;

use crate::base::Grid;

/// Steps to four of the eight neighbours of a node, and their lengths. The other four are opposite.
const STEPS: [(isize, isize, f32); 4] = [(1, 0, 1.0), (0, 1, 1.0), (1, 1, SQRT_2), (-1, 1, SQRT_2)];

/// Lowers the tension at nodes nearer to the frame than `reach` (map units), in proportion to their distance. `lo` is NaN outside
/// the frame.
pub fn lower_tension(tension: &mut [f32], lo: &[f32], grid: &Grid, reach: f64) {
    let node = (grid.cell.x * grid.cell.y).sqrt();
    // The nodes beside the frame are one node away.
    let reach = ((reach / node) as f32).max(1.0);
    for (tension, distance) in tension.iter_mut().zip(distances(lo, [grid.cols, grid.rows], reach)) {
        *tension *= distance / reach;
    }
}

/// The distance of each node from the frame, along steps between nodes, in nodes; `most` where it is larger.
fn distances(lo: &[f32], [cols, rows]: [usize; 2], most: f32) -> Vec<f32> {
    let mut distances: Vec<f32> = lo.iter().map(|lo| if lo.is_nan() { 0.0 } else { most }).collect();
    let mut shorten = |n: usize, sign: isize| {
        let [i, j] = [(n % cols) as isize, (n / cols) as isize];
        for (east, south, length) in STEPS {
            let [i, j] = [i + sign * east, j + sign * south];
            let is_on_grid = (0..cols as isize).contains(&i) && (0..rows as isize).contains(&j);
            let from = if is_on_grid { distances[j as usize * cols + i as usize] } else { 0.0 };
            distances[n] = distances[n].min(from + length);
        }
    };
    (0..lo.len()).for_each(|n| shorten(n, -1));
    (0..lo.len()).rev().for_each(|n| shorten(n, 1));
    distances
}

#[cfg(test)]
mod tests {
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
        assert_eq!(row(1), [4.0, 0.0, 4.0, 8.0, 8.0, 8.0, 4.0], "beside a node outside the frame");
        assert_eq!(row(2), [4.0, 4.0, 4.0 * SQRT_2, 8.0, 8.0, 8.0, 4.0]);
    }
}
