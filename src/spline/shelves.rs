//! Shelves and bulges: places where the smooth surface is less steep than the reference surface.

use rayon::prelude::*;

use super::blur::blurred;
use super::slopes::slopes;
use crate::base::Grid;
use crate::tuning::SplineTuning;

/// Share of the reference surface to take at each node. It is above 0 where the surface is less steep than the
/// reference surface.
pub fn shelves(heights: &[f32], reference: &[f32], grid: &Grid, tuning: &SplineTuning) -> Vec<f32> {
    let SplineTuning { shelf_share, shelf_reach, .. } = *tuning;
    let (own, other) = (slopes(heights, grid), slopes(reference, grid));
    let share = |(own, other): (&f32, &f32)| {
        let less = 1.0 - own / other.max(f32::MIN_POSITIVE);
        if less.is_nan() { 0.0 } else { shelf_share * less.clamp(0.0, 1.0) }
    };
    let shares: Vec<f32> = own.par_iter().zip(&other).map(share).collect();
    blurred(&shares, grid.cols, shelf_reach)
}
