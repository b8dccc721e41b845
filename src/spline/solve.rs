//! The smooth surface from its conditions: the solve, shelves, shrinkage, curvature gain and breaching, in that order.

use std::borrow::Cow;

use rayon::prelude::*;

use super::conditions::Conditions;
use super::density::{closeness, tension};
use super::energy::CrossingWeight;
use super::lattice::Lattice;
use super::params::Knobs;
use super::pits::{Limits, breach};
use super::shelves::shelves;
use super::stages::{Problem, STEP, solve};
use super::working_grid::WorkingGrid;
use super::{expected, relief, residual};
use crate::base::Grid;
use crate::base::progress::Progress;
use crate::tuning::SplineTuning;

/// Finds the smooth surface that meets the conditions.
pub fn spline<'a>(
    conditions: &'a Conditions<'_>,
    knobs: &Knobs,
    tuning: &'a SplineTuning,
    progress: &dyn Progress,
) -> WorkingGrid {
    let Conditions { grid, gap, interval, bounds: [lo, hi], guide, hollows, .. } = conditions;
    let interval = *interval;
    let lattice = Lattice::of_grid(grid);
    let slack = if knobs.noise > 0.0 { (tuning.noise_slack * interval) as f32 } else { 0.0 };
    let moved = |bound: &'a [f32], by: f32| -> Cow<'a, [f32]> {
        if by == 0.0 { Cow::Borrowed(bound) } else { bound.iter().map(|b| b + by).collect() }
    };
    let closeness = closeness(guide, grid, *gap, interval, tuning.density_rounds);
    let problem = Problem {
        lattice,
        contours: &conditions.contours,
        spots: conditions.spot_crossings(),
        creases: &conditions.creases,
        crease_knee: knobs.crease_knee,
        bounds: [moved(lo, -slack), moved(hi, slack)],
        guide,
        tension: tension(&closeness, grid, *gap, knobs.tension),
        contour_weight: contour_weight(knobs.noise, grid, *gap, tuning),
        interval,
        gap: *gap,
        hollows,
        tuning,
    };
    let z = solve(&problem, progress);
    progress.start(STEP, 0);
    let mut heights: Vec<f32> = z.into_iter().map(|v| v as f32).collect();
    let share = shelves(&heights, guide, grid, tuning);
    heights.par_iter_mut().enumerate().for_each(|(n, z)| {
        if !guide[n].is_nan() {
            *z += share[n] * (guide[n] - *z);
        }
    });
    if knobs.noise > 0.0 {
        residual::meet(&problem, &mut heights);
    }
    heights.par_iter_mut().enumerate().for_each(|(n, z)| {
        *z = if lo[n].is_nan() { f32::NAN } else { z.clamp(lo[n], hi[n]) };
    });
    if knobs.half_way > 0.0 {
        let (half_way, spots, shrinkage) = (knobs.half_way, &problem.spots, &tuning.shrinkage);
        let variances = expected::variances(half_way, &heights, &closeness, *gap, &lattice, spots, shrinkage);
        expected::draw_in(&mut heights, [lo, hi], &variances, shrinkage.max_share);
        if knobs.relief > 0.0 {
            let lacking = relief::lacking(&heights, [lo, hi], &variances, *gap, &lattice, interval, &tuning.gain);
            relief::grow(&mut heights, [lo, hi], &lacking, knobs.relief);
        }
    }
    let limits = Limits { lo, depth: interval as f32 };
    breach(&mut heights, &lattice, &limits, |n| hollows[n]);
    progress.finish();
    WorkingGrid { grid: *grid, heights }
}

/// Weight of a crossing against a second difference. The surface meets the contours within a thousandth of the interval. Vertices
/// that lie on edges of the lattice, which the contours were cut from then, it meets as exactly as the steps allow. For noisy contours
/// the weight per length of contour is the same on every grid.
fn contour_weight(noise: f64, grid: &Grid, gap: f64, tuning: &SplineTuning) -> CrossingWeight {
    let SplineTuning { contour_weight_at_vertex: at_vertex, contour_weight_on_chord: on_chord, .. } = *tuning;
    let cell = (grid.cell.x * grid.cell.y).sqrt();
    let noisy = tuning.noisy_contour_weight / (noise * noise) * (tuning.grid.nodes_per_spacing * cell / gap).powi(3);
    CrossingWeight { at_vertex, on_chord }.map(|weight| noisy.min(weight))
}
