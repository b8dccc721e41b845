//! Weights that follow the surface: creases may bend, and tension rises where the surface meets its bounds.

use rayon::prelude::*;

use super::energy::Energy;
use super::fold::{Fold, Folds};
use crate::base::parallel;
use crate::tuning::SplineTuning;

/// Nodes per task. Each task begins its sums anew. So the sums do not depend on the number of threads.
const CHUNK: usize = 1 << 14;
/// A height nearer to a bound than this is at the bound, as a share of the contour interval: a tolerance of rounding.
const AT_BOUND: f64 = 1e-3;
/// The largest factor on the tension after all rounds.
const MAX_FACTOR: f32 = 1000.0;

/// Lowers the bending weights where the surface bends much, by iteratively reweighted least squares (IRLS).
///
/// Curvature of the ground has a heavy tail: edges and creases are few and sharp. Least squares would spread each over
/// its surroundings. A difference δ gets the weight `1 / sqrt(1 + (δ / limit)²)`. So its part of the energy grows like
/// |δ| where δ is large. The limit is `irls_threshold` times the mean of |δ|. `folds` marks differences across lines where
/// the surface may bend sharply. Their limit is `share` times as large.
pub fn reweight_bending(energy: &mut Energy<'_>, folds: &Folds, tuning: &SplineTuning, share: f64, z: &[f64]) {
    let SplineTuning { irls_threshold: threshold, crease_weight, .. } = *tuning;
    for (kind, folds) in folds.iter().enumerate() {
        let difference = |n: usize| energy.second_difference(kind, n, z).abs();
        // Sums are added up in a fixed order, whatever the number of threads.
        let weights = &energy.bending[kind];
        let sums: Vec<(f64, f64)> = parallel::map(weights.len().div_ceil(CHUNK), |k| {
            let nodes = k * CHUNK..weights.len().min((k + 1) * CHUNK);
            let bent = nodes.filter(|&n| weights[n] > 0.0).map(difference);
            bent.fold((0.0, 0.0), |(sum, count), d| (sum + d, count + 1.0))
        });
        let (sum, count) = sums.into_iter().fold((0.0, 0.0), |a, b| (a.0 + b.0, a.1 + b.1));
        if sum == 0.0 {
            continue;
        }
        let mean: f64 = sum / count;
        let mut bending = std::mem::take(&mut energy.bending[kind]);
        parallel::update(&mut bending, |n, weight| {
            if *weight > 0.0 {
                let (difference, fold) = (energy.second_difference(kind, n, z), folds[n]);
                let limit = mean * if fold.may_bend(difference) { threshold * share } else { threshold };
                if fold != Fold::None && !fold.may_bend(difference) {
                    *weight /= crease_weight;
                }
                *weight /= (1.0 + (difference / limit).powi(2)).sqrt() as f32;
            }
        });
        energy.bending[kind] = bending;
    }
}

/// The ends of the edges that contours cross, and their neighbours.
pub fn near_contours(energy: &Energy<'_>) -> Vec<bool> {
    let [cols, rows] = energy.size;
    let mut near = vec![false; cols * rows];
    for (side, step) in [1, cols].into_iter().enumerate() {
        for n in energy.contours[side].all().iter().map(|t| t.node as usize) {
            for end in [n, n + step] {
                for m in [end.wrapping_sub(1), end, end + 1, end.wrapping_sub(cols), end + cols] {
                    if let Some(near) = near.get_mut(m) {
                        *near = true;
                    }
                }
            }
        }
    }
    near
}

/// Raises the factor on the tension around nodes that lie at a bound, away from the contours.
///
/// There, steep ground beside them carries on its slope. Without more tension, the surface would be a shelf at the
/// bound.
pub fn raise_tension_at_bounds(
    factors: &mut [f32],
    near_contours: &[bool],
    [lo, hi]: [&[f32]; 2],
    z: &[f64],
    cols: usize,
    interval: f64,
    tuning: &SplineTuning,
) {
    let SplineTuning { bound_tension_factor, bound_tension_reach, .. } = *tuning;
    let rows = z.len() / cols;
    let slack = AT_BOUND * interval;
    let at_bound = |n: usize| z[n] <= f64::from(lo[n]) + slack || z[n] >= f64::from(hi[n]) - slack;
    let is_pressed = |n: usize| if !near_contours[n] && at_bound(n) { 1.0 } else { 0.0 };
    let mut share: Vec<f32> = parallel::values(z.len(), is_pressed);
    if share.iter().all(|&s| s == 0.0) {
        return;
    }
    for _ in 0..bound_tension_reach {
        let before = share.clone();
        share.par_chunks_mut(cols).enumerate().skip(1).take(rows.saturating_sub(2)).for_each(|(j, row)| {
            for (i, share) in row.iter_mut().enumerate().take(cols - 1).skip(1) {
                let n = j * cols + i;
                let around = before[n - 1] + before[n + 1] + before[n - cols] + before[n + cols];
                *share = share.max(around / 4.0);
            }
        });
    }
    factors.par_iter_mut().zip(&share).filter(|(_, s)| **s > 0.0).for_each(|(factor, &share)| {
        *factor = (*factor * bound_tension_factor.powf(share)).min(MAX_FACTOR);
    });
}
