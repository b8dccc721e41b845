//! The relative contour density at each node, and the tension that follows from it.

use super::slopes::slopes;
use super::wide::WidePlaces;
use crate::base::{Grid, parallel};
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
    let mut factor: Vec<f32> = parallel::values_each(&slopes, relative);
    for _ in 0..rounds {
        factor = map_inner(&factor, grid, |old, n| {
            (4.0 * old[n] + old[n - 1] + old[n + 1] + old[n - grid.cols] + old[n + grid.cols]) / 8.0
        });
    }
    factor
}

/// Tension at each node, per square of the eastward step: `k / (mean spacing · local spacing)`.
///
/// In wide places the local spacing passes to that of the contours around. The tension is at least
/// `1 / (reach · spacing around)²` there: a slope then ends within this reach ([`WideTuning::slope_reach`]).
pub fn tension(
    contour_density: &[f32],
    wide: &WidePlaces,
    grid: &Grid,
    spacing: f64,
    k: f64,
    tuning: &WideTuning,
) -> Vec<f32> {
    let step = (grid.cell.x / spacing).powi(2);
    let (whole, ending) = (k * step, (step / tuning.slope_reach.powi(2)) as f32);
    let usual = (whole * tuning.tension_factor) as f32;
    let at = |n: usize| {
        let (share, around) = (wide.share[n], wide.around[n]);
        let own = (whole * f64::from(contour_density[n])) as f32;
        if share > 0.0 { own.powf(1.0 - share) * (around * usual.max(around * ending)).powf(share) } else { own }
    };
    parallel::values(contour_density.len(), at)
}

/// Computes a new value for every node that has all four neighbours. Other nodes keep theirs.
fn map_inner(old: &[f32], grid: &Grid, value: impl Fn(&[f32], usize) -> f32 + Sync) -> Vec<f32> {
    let at = |i: usize, j: usize| {
        let n = j * grid.cols + i;
        let inner = i > 0 && i + 1 < grid.cols && j > 0 && j + 1 < grid.rows;
        if inner { value(old, n) } else { old[n] }
    };
    parallel::cells(grid.cols, grid.rows, at)
}
