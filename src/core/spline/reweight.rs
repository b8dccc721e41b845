//! Weights that follow the surface: where it bends much, it may bend.

use super::energy::Energy;
use super::fold::{Fold, Folds};
use crate::base::parallel;
use crate::tuning::SplineTuning;

/// Nodes per task. Each task begins its sums anew. So the sums do not depend on the number of threads.
const CHUNK: usize = 1 << 14;

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
