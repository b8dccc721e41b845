//! Shelves and bulges: places where the smooth surface is less steep than the reference surface.

use super::blur::blurred;
use super::slopes::slopes;
use crate::base::{Grid, parallel};
use crate::tuning::SplineTuning;

/// Share of the reference surface to take at each node. It is above 0 where the surface is less steep than the
/// reference surface.
pub fn shelves(heights: &[f32], reference: &[f32], grid: &Grid, tuning: &SplineTuning) -> Vec<f32> {
    let SplineTuning { shelf_share, shelf_reach, .. } = *tuning;
    let (own, other) = (slopes(heights, grid), slopes(reference, grid));
    let share = |n: usize| {
        let less = 1.0 - own[n] / other[n].max(f32::MIN_POSITIVE);
        if less.is_nan() { 0.0 } else { shelf_share * less.clamp(0.0, 1.0) }
    };
    let shares: Vec<f32> = parallel::values(own.len(), share);
    blurred(&shares, grid.cols, shelf_reach)
}
