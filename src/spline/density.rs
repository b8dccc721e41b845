//! The relative contour density at each node, and the tension that follows from it.

use rayon::prelude::*;

use super::slopes::slopes;
use super::wide::WidePlaces;
use crate::base::Grid;
use crate::tuning::WideTuning;

/// Limits of the relative contour density. They keep it finite on level ground and on cliffs.
const DENSITY_LIMITS: (f64, f64) = (1e-3, 1e3);

/// The relative contour density at each node: mean spacing of the contours over local spacing. The local spacing is the
/// contour interval over the slope of the reference surface. `rounds` is
/// [`SplineTuning::density_rounds`](crate::tuning::SplineTuning::density_rounds).
pub fn contour_density(reference: &[f32], grid: &Grid, spacing: f64, interval: f64, rounds: usize) -> Vec<f32> {
    let slopes = slopes(reference, grid);
    let relative = |s: &f32| {
        let density = f64::from(*s) * spacing / interval;
        if density.is_nan() { 1.0 } else { density.clamp(DENSITY_LIMITS.0, DENSITY_LIMITS.1) as f32 }
    };
    let mut factor: Vec<f32> = slopes.par_iter().map(relative).collect();
    for _ in 0..rounds {
        factor = map_inner(&factor, grid, |old, n| {
            (4.0 * old[n] + old[n - 1] + old[n + 1] + old[n - grid.cols] + old[n + grid.cols]) / 8.0
        });
    }
    factor
}

/// Tension at each node, per square of the eastward step: `k / (mean spacing · local spacing)`. In wide places, it
/// passes from the local spacing to that of the contours around ([`WideTuning`]).
pub fn tension(
    contour_density: &[f32],
    wide: &WidePlaces,
    grid: &Grid,
    spacing: f64,
    k: f64,
    tuning: &WideTuning,
) -> Vec<f32> {
    let whole = k * (grid.cell.x / spacing).powi(2);
    let factor = tuning.tension_factor as f32;
    let at = |((own, share), around): ((&f32, &f32), &f32)| {
        let density = if *share > 0.0 { own.powf(1.0 - share) * (factor * around).powf(*share) } else { *own };
        (whole * f64::from(density)) as f32
    };
    contour_density.par_iter().zip(&wide.share).zip(&wide.around).map(at).collect()
}

/// Computes a new value for every node that has all four neighbours. Other nodes keep theirs.
fn map_inner(old: &[f32], grid: &Grid, value: impl Fn(&[f32], usize) -> f32 + Sync) -> Vec<f32> {
    let at = |n: usize| {
        let (i, j) = (n % grid.cols, n / grid.cols);
        let inner = i > 0 && i + 1 < grid.cols && j > 0 && j + 1 < grid.rows;
        if inner { value(old, n) } else { old[n] }
    };
    (0..old.len()).into_par_iter().map(at).collect()
}
