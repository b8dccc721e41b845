//! The smooth surface from its conditions. The steps: solution, shelves, shrinkage, curvature gain, breaching.

use super::conditions::{Conditions, line_crossings, spot_crossings};
use super::density::{contour_density, tension};
use super::energy::CrossingWeight;
use super::lattice::{Crossing, Lattice};
use super::params::HyperParameters;
use super::pits::Limits;
use super::shelves::shelves;
use super::shrinkage::{self, HalfWay, Relative};
use super::slack::with_slack;
use super::stages::{Problem, STEP, solve};
use super::wide::WidePlaces;
use super::working_grid::WorkingGrid;
use super::{curvature_gain, far, flats, misses, residual, soft_spots, spots};
use crate::base::progress::Progress;
use crate::base::{Grid, Sure, parallel};
use crate::streams::Stream;
use crate::tuning::SplineTuning;

/// The nodes per spacing of the grid that the weight of noisy contours is for.
const NODES_PER_SPACING: f64 = 6.0;

/// Finds the smooth surface that meets the conditions.
pub fn spline(
    conditions: &Conditions<'_>,
    hyper_parameters: &HyperParameters,
    tuning: &SplineTuning,
    progress: &dyn Progress,
) -> WorkingGrid {
    let Conditions { grid, spacing, interval, bounds: [lo, hi], reference, hollows, .. } = conditions;
    let interval = *interval;
    let lattice = Lattice::of_grid(grid);
    let slack = (tuning.noise_slack * interval * hyper_parameters.noise.min(1.0)) as f32;
    let slack_reach = (tuning.noise_slack_reach * *spacing / (grid.cell.x * grid.cell.y).sqrt()).round() as usize;
    let contour_density = contour_density(reference, grid, *spacing, interval, tuning.density_rounds);
    let wide = WidePlaces::new(&contour_density, lo, grid.cols, &tuning.wide);
    let averaged = far::averaged(reference, lo, grid.cols, &wide.share);
    let mut tension = tension(&contour_density, &wide, grid, *spacing, hyper_parameters.tension, &tuning.wide);
    // Whether cliffs free a node from the reference surface and from the middle of its band.
    let free = &conditions.beside_cliffs;
    tension.iter_mut().zip(free).filter(|(_, free)| **free).for_each(|(tension, _)| *tension = 0.0);
    let mut problem = Problem {
        lattice,
        contours: &conditions.contours,
        spots: conditions.spot_crossings(),
        creases: &conditions.creases,
        cliffs: conditions.cliffs,
        known: &conditions.known,
        crease_threshold: hyper_parameters.crease_threshold,
        bounds: with_slack([lo, hi], slack, slack_reach, grid.cols),
        reference: &averaged,
        tension,
        wide: wide.share,
        contour_weight: contour_weight(hyper_parameters.noise, grid, *spacing, tuning),
        interval,
        spacing: *spacing,
        hollows,
        drainage: conditions.drainage,
        grid,
        tuning,
    };
    let mut surveyed = conditions.surveyed();
    let variances = |error: f64, heights: &[f32], surveyed: &[(Crossing, f64)]| {
        let half_way = HalfWay { error, relative: hyper_parameters.relative_variance };
        let relative = Relative::new(heights, &contour_density, *spacing, &lattice, &tuning.shrinkage);
        let density = (contour_density.as_slice(), *spacing);
        let mut variances = relative.variances(half_way, heights, density, &lattice, surveyed, &tuning.shrinkage);
        variances.iter_mut().zip(free).filter(|(_, free)| **free).for_each(|(variance, _)| *variance = 0.0);
        variances
    };
    let mut heights = bounded(&problem, conditions, hyper_parameters, tuning, progress);
    if !conditions.soft_spots.is_empty() {
        let half_way = match hyper_parameters.half_way_error {
            0.0 => tuning.usual_half_way_error * interval,
            known => known,
        };
        let variances = variances(half_way, &heights, &surveyed);
        let least = tuning.least_spot_variance * half_way * half_way;
        let first = WorkingGrid { grid: *grid, heights };
        let estimates = soft_spots::estimates(conditions, &first, &variances, &problem.wide, least);
        let crossings = spot_crossings(&estimates, &lattice, reference);
        surveyed.extend_from_slice(&crossings);
        problem.spots.extend(crossings);
        heights = bounded(&problem, conditions, hyper_parameters, tuning, progress);
    }
    progress.start(STEP, 0);
    if hyper_parameters.half_way_error > 0.0 {
        let (half_way, shrinkage) = (hyper_parameters.half_way_error, &tuning.shrinkage);
        let of_gain = (!conditions.streams.is_empty()).then(|| {
            // Streams show the valleys already. So the ground there gains no curvature, as if it were surveyed.
            let along = |stream: &Stream| line_crossings(stream.known(), Sure::Guessed, 0.0, &lattice).concat();
            let known: Vec<_> = conditions.streams.iter().flat_map(along).chain(surveyed.iter().copied()).collect();
            variances(half_way, &heights, &known)
        });
        let variances = variances(half_way, &heights, &surveyed);
        shrinkage::shrink(&mut heights, [lo, hi], &variances, shrinkage.max_share);
        if hyper_parameters.curvature_gain > 0.0 {
            let unit_gain = curvature_gain::unit_gain(
                &heights,
                [lo, hi],
                (of_gain.as_ref().unwrap_or(&variances), &problem.wide),
                *spacing,
                &lattice,
                interval,
                &tuning.gain,
            );
            curvature_gain::add_gain(&mut heights, [lo, hi], &unit_gain, hyper_parameters.curvature_gain);
        }
    }
    flats::even_out(&mut heights, conditions, &contour_density, tuning);
    let mut working = WorkingGrid { grid: *grid, heights };
    misses::add_misses(&mut working, conditions, [lo, hi]);
    spots::meet(&conditions.spots, &mut working, [lo, hi], *spacing, interval);
    // Between neighbouring contours no cut needs to be deeper.
    problem.breach(&mut working.heights, &Limits { lo, depth: interval as f32 });
    // A way out of a pit may pass a spot height.
    spots::meet(&conditions.spots, &mut working, [lo, hi], *spacing, interval);
    progress.finish();
    working
}

/// The surface of a problem: solved, freed of shelves, and kept inside the bands.
fn bounded(
    problem: &Problem<'_>,
    conditions: &Conditions<'_>,
    hyper_parameters: &HyperParameters,
    tuning: &SplineTuning,
    progress: &dyn Progress,
) -> Vec<f32> {
    let Conditions { grid, bounds: [lo, hi], reference, beside_cliffs: free, .. } = conditions;
    let z = solve(problem, progress);
    progress.start(STEP, 0);
    let mut heights: Vec<f32> = z.into_iter().map(|v| v as f32).collect();
    let share = shelves(&heights, reference, grid, tuning);
    parallel::update(&mut heights, |n, z| {
        if !reference[n].is_nan() && free.get(n) != Some(&true) {
            *z += share[n] * (1.0 - problem.wide[n]) * (reference[n] - *z);
        }
    });
    if hyper_parameters.noise > 0.0 {
        residual::add_residuals(problem, &mut heights);
    }
    parallel::update(&mut heights, |n, z| {
        *z = if lo[n].is_nan() { f32::NAN } else { z.clamp(lo[n], hi[n]) };
    });
    progress.finish();
    heights
}

/// Weight of the square at a crossing, against that of a second difference. The surface meets the contours within a
/// thousandth of the interval. Vertices on edges of the lattice mean that the contours were cut from its nodes. The
/// surface meets them as exactly as the steps allow. For noisy contours, the weight per length is the same on
/// every grid.
fn contour_weight(noise: f64, grid: &Grid, spacing: f64, tuning: &SplineTuning) -> CrossingWeight {
    let SplineTuning { contour_weight_at_vertex: at_vertex, contour_weight_on_chord: on_chord, .. } = *tuning;
    let cell = (grid.cell.x * grid.cell.y).sqrt();
    let per_length = (NODES_PER_SPACING * cell / spacing).powi(3);
    let noisy = tuning.noisy_contour_weight / (noise * noise) * per_length;
    CrossingWeight { at_vertex, on_chord }.map(|weight| noisy.min(weight))
}
