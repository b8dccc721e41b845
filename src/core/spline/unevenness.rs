//! Unevenness of the ground: the part of its slope that is not common to the ground around.

use super::blur::{PASSES, blurred};
use super::lattice::Lattice;
use crate::base::parallel;

/// Unevenness at each node: 1 - |mean slope|² / mean of |slope|², over the slopes at most `reach` nodes away. Slopes
/// are vectors, rise over run. It is 0 on a plane. It is 1 where slopes cancel each other, and outside the frame, where
/// heights are NaN.
pub fn unevenness(heights: &[f32], lattice: &Lattice, reach: usize) -> Vec<f32> {
    let cols = lattice.cols;
    let [east, south] = lattice.step.as_vec2().to_array();
    let slope = |i: usize, j: usize| {
        if i + 1 >= cols || j + 1 >= lattice.rows {
            return None;
        }
        let n = j * cols + i;
        let slope = [(heights[n + 1] - heights[n]) / east, (heights[n + cols] - heights[n]) / south];
        slope.iter().all(|s| s.is_finite()).then_some(slope)
    };
    let local_mean = |of: fn([f32; 2]) -> f32| {
        let mut mean: Vec<f32> = parallel::cells(cols, lattice.rows, |i, j| slope(i, j).map_or(0.0, of));
        for _ in 0..PASSES {
            mean = blurred(&mean, cols, reach);
        }
        mean
    };
    let (x, y) = (local_mean(|[x, _]| x), local_mean(|[_, y]| y));
    // Nodes without a slope must not count. Otherwise ground beside the frame would look uneven.
    let (square, count) = (local_mean(|[x, y]| x * x + y * y), local_mean(|_| 1.0));
    let at = |n: usize| {
        let common = (x[n] * x[n] + y[n] * y[n]) / (square[n] * count[n]);
        if common.is_nan() { 1.0 } else { (1.0 - common).clamp(0.0, 1.0) }
    };
    parallel::values(heights.len(), at)
}

#[cfg(test)]
mod tests {
    use glam::DVec2;

    use super::*;

    #[test]
    fn planes_are_even_and_roofs_are_not() {
        let lattice = Lattice { first: DVec2::ZERO, step: DVec2::new(2.0, 3.0), cols: 60, rows: 50 };
        let find = |height: fn(f32, f32) -> f32| {
            let z: Vec<f32> = (0..lattice.len()).map(|n| height((n % 60) as f32, (n / 60) as f32)).collect();
            (unevenness(&z, &lattice, 4), z)
        };
        let (plane, _) = find(|i, j| 3000.0 + 0.4 * i - 0.3 * j);
        assert!(plane.iter().all(|u| *u < 1e-3));
        let (cut, z) = find(|i, j| if i + j < 40.0 { f32::NAN } else { 0.4 * i - 0.3 * j });
        assert!(cut.iter().zip(&z).all(|(u, z)| z.is_nan() || *u < 1e-3 || *u == 1.0));
        assert!(cut[0] == 1.0 && cut[25 * 60 + 17] < 1e-3);
        // Beside the border a few nodes have too few neighbours.
        let known = z.iter().filter(|z| !z.is_nan()).count();
        let even = cut.iter().zip(&z).filter(|(u, z)| !z.is_nan() && **u < 1e-3).count();
        assert!(even * 100 > known * 99, "{even} of {known}");
        let (roof, _) = find(|i, _| (i - 30.0).abs());
        assert!(roof[25 * 60 + 30] > 0.95 && roof[25 * 60 + 10] < 1e-3 && roof[25 * 60 + 50] < 1e-3);
        assert!(roof[25 * 60 + 21] < roof[25 * 60 + 25] && roof[25 * 60 + 25] < roof[25 * 60 + 30]);
        assert!(find(|_, _| 7.0).0.iter().all(|u| *u == 1.0));
    }
}
