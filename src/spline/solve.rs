//! The smooth surface from its conditions: the solve, shelves, shrinkage, curvature gain and breaching, in that order.

use std::borrow::Cow;

use rayon::prelude::*;

use super::conditions::Conditions;
use super::density::{closeness, tension};
use super::energy::CrossingWeight;
use super::grid::NODES_A_GAP;
use super::lattice::Lattice;
use super::params::Knobs;
use super::pits::{Limits, breach};
use super::shelves::shelves;
use super::stages::{Problem, STEP, solve};
use super::working_grid::WorkingGrid;
use super::{expected, relief, residual};
use crate::base::Grid;
use crate::base::progress::Progress;

/// Weights of crossings against second differences: the contours are met within a thousandth of the interval, and where their
/// vertices lie on the lattice, which they were cut from then, as exactly as they can be found in so many steps.
const CONTOUR_WEIGHT: CrossingWeight = CrossingWeight { at_vertex: 1000.0, on_chord: 500.0 };
/// ... and where the noise is 1, on a grid with as many nodes a gap as it should have.
const NOISY_WEIGHT: f64 = 0.1;

/// Finds the smooth surface that meets the conditions.
pub fn spline<'a>(conditions: &'a Conditions<'_>, knobs: &Knobs, progress: &dyn Progress) -> WorkingGrid {
    let Conditions { grid, gap, interval, bounds: [lo, hi], guide, hollows, .. } = conditions;
    let interval = *interval;
    let lattice = Lattice::of_grid(grid);
    let slack = if knobs.noise > 0.0 { (residual::SLACK * interval) as f32 } else { 0.0 };
    let moved = |bound: &'a [f32], by: f32| -> Cow<'a, [f32]> {
        if by == 0.0 { Cow::Borrowed(bound) } else { bound.iter().map(|b| b + by).collect() }
    };
    let closeness = closeness(guide, grid, *gap, interval);
    let problem = Problem {
        lattice,
        contours: &conditions.contours,
        spots: conditions.spot_crossings(),
        creases: &conditions.creases,
        crease_knee: knobs.crease_knee,
        bounds: [moved(lo, -slack), moved(hi, slack)],
        guide,
        tension: tension(&closeness, grid, *gap, knobs.tension),
        contour_weight: contour_weight(knobs.noise, grid, *gap),
        interval,
        gap: *gap,
        hollows,
    };
    let z = solve(&problem, progress);
    progress.start(STEP, 0);
    let mut heights: Vec<f32> = z.into_iter().map(|v| v as f32).collect();
    let share = shelves(&heights, guide, grid);
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
        let variances = expected::variances(knobs.half_way, &heights, &closeness, *gap, &lattice, &problem.spots);
        expected::draw_in(&mut heights, [lo, hi], &variances);
        if knobs.relief > 0.0 {
            let lacking = relief::lacking(&heights, [lo, hi], &variances, *gap, &lattice, interval);
            relief::grow(&mut heights, [lo, hi], &lacking, knobs.relief);
        }
    }
    let limits = Limits { lo, depth: interval as f32 };
    breach(&mut heights, &lattice, &limits, |n| hollows[n]);
    progress.finish();
    WorkingGrid { grid: *grid, heights }
}

/// Weight of a crossing against a second difference: a contour's weight for its length is the same on every grid.
fn contour_weight(noise: f64, grid: &Grid, gap: f64) -> CrossingWeight {
    let cell = (grid.cell.x * grid.cell.y).sqrt();
    let noisy = NOISY_WEIGHT / (noise * noise) * (NODES_A_GAP * cell / gap).powi(3);
    CONTOUR_WEIGHT.map(|weight| noisy.min(weight))
}
