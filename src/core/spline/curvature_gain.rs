//! Curvature gain: makes ridges higher and valleys deeper than on a surface of minimum curvature.
//!
//! Between two contours, a surface of minimum curvature is as flat as they allow. The ground is mostly less flat. Where
//! the surface bulges above its surroundings, the ground is higher still on average. Where the surface is hollow, the
//! ground is lower. The difference grows with the standard error of the surface.
//!
//! The amount differs from map to map. It comes from hidden contours, by a regression of their residuals on
//! [`unit_gain`]. Nodes that already stand out much, such as single tops and pits, hardly change.

use super::blur::{PASSES, blurred};
use super::lattice::Lattice;
use crate::base::parallel;
use crate::tuning::GainTuning;

/// Least reach of the surroundings, nodes. Where contours are closer, the lattice shows no bulges between them.
const FEWEST: usize = 2;

/// Curvature gain at each node, metres, for a gain of 1. It is positive where the surface lies above its surroundings.
///
/// The gain is at most half of the standard error. It is 0 on the levels of contours, and outside the frame, where
/// `heights` are NaN.
///
/// `variances` are the variances half-way between contours ([`super::shrinkage::variances`]). `spacing` is the mean
/// spacing of the contours, map units. `wide` is the share of a wide place. Where it is 1, there is no gain: beside
/// the toe of a slope, it would dig a trough.
pub fn unit_gain(
    heights: &[f32],
    bounds: [&[f32]; 2],
    (variances, wide): (&[f32], &[f32]),
    spacing: f64,
    lattice: &Lattice,
    interval: f64,
    tuning: &GainTuning,
) -> Vec<f32> {
    let step = (lattice.step.x * lattice.step.y).sqrt();
    let reach = (tuning.reach * spacing / step).round() as usize;
    if reach < FEWEST {
        return vec![0.0; heights.len()];
    }
    let mean_around = surroundings(heights, lattice.cols, reach);
    let unit = tuning.peak * interval as f32;
    let at = |n: usize| {
        let (z, lo, height) = (heights[n], bounds[0][n], bounds[1][n] - bounds[0][n]);
        let t = ((z - lo) / height).clamp(0.0, 1.0);
        let bulge = (z - mean_around[n]) / unit;
        // The gain starts with slope 0 at a contour. Otherwise there would be a notch along every contour.
        let open = (4.0 * t * (1.0 - t)).powi(2);
        let by = (1.0 - wide[n].powi(4)) * open * variances[n].sqrt() * bulge / (1.0 + bulge * bulge);
        if by.is_finite() { by } else { 0.0 }
    };
    parallel::values(heights.len(), at)
}

/// Adds `amount` times the unit gain to the heights, within `bounds`.
pub fn add_gain(heights: &mut [f32], bounds: [&[f32]; 2], unit_gain: &[f32], amount: f64) {
    parallel::update(heights, |n, z| {
        if unit_gain[n] != 0.0 {
            *z = (*z + amount as f32 * unit_gain[n]).clamp(bounds[0][n], bounds[1][n]);
        }
    });
}

/// The standard error that remains after a curvature gain of `amount`. `reduction` is [`GainTuning::error_reduction`].
pub fn remaining_error(error: f64, amount: f64, reduction: f64) -> f64 {
    error * (1.0 - reduction * amount * amount)
}

/// The mean height around each node. Only nodes inside the frame count.
fn surroundings(heights: &[f32], cols: usize, reach: usize) -> Vec<f32> {
    let smooth = |value: fn(f32) -> f32| {
        let mut mean: Vec<f32> = parallel::values_each(heights, |z| value(*z));
        for _ in 0..PASSES {
            mean = blurred(&mean, cols, reach);
        }
        mean
    };
    let mut sum = smooth(|z| if z.is_nan() { 0.0 } else { z });
    let share = smooth(|z| if z.is_nan() { 0.0 } else { 1.0 });
    parallel::update(&mut sum, |n, sum| *sum /= share[n]);
    sum
}

#[cfg(test)]
mod tests {
    use glam::DVec2;

    use super::*;

    const LATTICE: Lattice = Lattice { first: DVec2::ZERO, step: DVec2::ONE, cols: 60, rows: 40 };

    /// The unit gain of heights in the band from 100 to 120 m, with a standard error of 2 m, and the heights.
    fn unit_gain_of(height: impl Fn(f32, f32) -> f32) -> (Vec<f32>, Vec<f32>) {
        let heights: Vec<f32> = (0..LATTICE.len()).map(|n| height((n % 60) as f32, (n / 60) as f32)).collect();
        let bounds = [vec![100.0; heights.len()], vec![120.0; heights.len()]];
        let variances = vec![4.0; heights.len()];
        (
            unit_gain(
                &heights,
                [&bounds[0], &bounds[1]],
                (&variances, &vec![0.0; heights.len()]),
                8.0,
                &LATTICE,
                20.0,
                &GainTuning::default(),
            ),
            heights,
        )
    }

    #[test]
    fn ridges_rise_valleys_sink_and_planes_and_levels_stay() {
        let (plane, _) = unit_gain_of(|i, j| 102.0 + 0.2 * i + 0.1 * j);
        let inner = |n: usize| (15..45).contains(&(n % 60)) && (15..25).contains(&(n / 60));
        assert!((0..plane.len()).filter(|n| inner(*n)).all(|n| plane[n].abs() < 1e-3));
        let (waves, _) = unit_gain_of(|i, _| 110.0 + 2.0 * (i / 60.0 * 6.0 * std::f32::consts::TAU).cos());
        // There is a ridge every ten nodes and a valley half-way. The gain is at most half of the error.
        let row = &waves[20 * 60..21 * 60];
        assert!(row[20] > 0.5 && row[20] <= 1.0 && row[25] < -0.5 && row[25] >= -1.0, "{row:?}");
        let (level, _) = unit_gain_of(|i, _| if i < 30.0 { 100.0 } else { 120.0 });
        assert!(level.iter().all(|by| *by == 0.0));
        let coarse = Lattice { step: DVec2::splat(6.0), ..LATTICE };
        let (_, heights) = unit_gain_of(|i, _| 110.0 + (i * 2.0).sin());
        let bounds = [vec![100.0; heights.len()], vec![120.0; heights.len()]];
        let variances = vec![4.0; heights.len()];
        let tuning = GainTuning::default();
        let by = unit_gain(
            &heights,
            [&bounds[0], &bounds[1]],
            (&variances, &vec![0.0; heights.len()]),
            8.0,
            &coarse,
            20.0,
            &tuning,
        );
        assert!(by.iter().all(|by| *by == 0.0), "contours are as close as nodes");
    }

    #[test]
    fn heights_stay_in_their_band_and_nothing_comes_in_from_outside() {
        let (by, heights) = unit_gain_of(|i, j| if i + j < 25.0 { f32::NAN } else { 110.0 });
        assert!(by.iter().all(|by| by.abs() < 1e-3), "level ground at the border has no bulge");
        let mut grown = heights.clone();
        let bounds = [vec![100.0; heights.len()], vec![120.0; heights.len()]];
        add_gain(&mut grown, [&bounds[0], &bounds[1]], &vec![1.0; heights.len()], 100.0);
        assert_eq!((remaining_error(2.0, 0.0, 0.15), remaining_error(2.0, 1.0, 0.15)), (2.0, 2.0 * (1.0 - 0.15)));
        for (z, before) in grown.iter().zip(&heights) {
            assert!(if before.is_nan() { z.is_nan() } else { *z == 120.0 }, "{before} became {z}");
        }
    }
}
