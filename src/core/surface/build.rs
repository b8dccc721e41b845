//! From a clean map to a surface: subdivision, ridge and canyon lines, smooth surface, and triangles.

use std::sync::atomic::{AtomicBool, Ordering};

use glam::DVec3;

use super::built::Surface;
use super::coarse::account_for_coarse_nodes;
use super::given::Given;
use super::given_lines::known;
use super::groups::Groups;
use super::known_lines::give_heights;
use super::nodes::with_nodes;
use super::params::{SurfaceKind, SurfaceParams, Triangles, Uncertainty};
use super::skeleton_lines::with_skeleton;
use super::smooth::{Lines, Triangulation, smooth};
use super::trial_builder::TrialBuilder;
use super::triangulated::{Triangulated, triangulated};
use crate::base::error::{Finding, FindingKind, Report, Result};
use crate::base::progress::Progress;
use crate::contour::{ContourMap, SoftSpot};
use crate::skeleton::Axis;
use crate::spline::{WorkingGrids, working_grid};
use crate::subdivision::{Subdivision, prepare};
use crate::subdomains::MapExtent;
use crate::validate::{TrialParams, choose, error_field};

/// Spot heights that differ from the surface by more than this share of the contour interval are not met.
const MET: f64 = 1e-3;

/// Builds the surface of a clean map (see [`clean`](fn@crate::clean::clean)).
///
/// # Errors
/// Those of [`subdivide_with_water`](crate::subdivision::subdivide_with_water). An error also arises when a parameter
/// is out of range, or when the smooth surface needs more memory than it may take. The error
/// [`StreamsElsewhere`](crate::base::error::Error::StreamsElsewhere) arises if most streams contradict the contours, unless the map is a
/// part of a larger one: then this is a finding.
pub fn build(
    map: ContourMap,
    given: &Given,
    params: &SurfaceParams,
    progress: &dyn Progress,
) -> Result<Report<Surface>> {
    params.check()?;
    let tuning = &params.tuning;
    let resolution = (params.kind != SurfaceKind::Linear).then_some(params.resolution);
    let builder = TrialBuilder { resolution, tuning: &tuning.skeleton };
    let mut prepared = prepare(map, &params.frame, &given.water)?;
    if let Some(whole) = &params.whole {
        (prepared.interval, prepared.spacing) = (whole.interval, Some(whole.spacing));
    }
    let interval = prepared.interval;
    let groups = Groups::new(&MapExtent::new(&prepared.map, &prepared.frame, interval), params);
    let largest = groups.largest();
    let frame = largest.as_ref().map_or(&params.frame, |largest| &largest.frame);
    let trials = TrialParams { frame, wanted: params.spline.wanted, builder: &builder, tuning, needless: None };
    let needless = AtomicBool::new(false);
    let first_trials = TrialParams { needless: Some(&needless), ..trials };
    // Triangulating keeps only one thread busy. The choice of hyper-parameters needs only the contours, so it runs
    // beside it. It is needless if elevations turn out to be wrong, or if triangulating fails.
    let of_whole = params.whole.as_ref().and_then(|whole| whole.chosen);
    let is_open = params.kind == SurfaceKind::Spline && of_whole.is_none();
    let to_choose = is_open.then(|| match &largest {
        None => (prepared.map.clone(), prepared.frame.clone()),
        Some(largest) => (largest.part(&prepared.map), largest.ring().clone()),
    });
    let (chosen, found) = rayon::join(
        || to_choose.map(|(map, frame)| choose(&MapExtent::new(&map, &frame, interval), &params.spline, &first_trials)),
        || {
            let found = triangulated(prepared, (given, params), (&trials, &groups), &needless, progress);
            found.inspect_err(|_| needless.store(true, Ordering::Relaxed))
        },
    );
    let Triangulated { mut subdivision, trusted, mended, closures, mut streams, mut break_lines, finer, mut findings } =
        found?;
    let mut sinks = given.sinks.clone();
    let mut chosen = of_whole.or(mended).or(chosen);
    let mut skeleton_lines = Vec::new();
    let mut axis = Axis::default();
    if let Some(finer) = finer {
        (subdivision, skeleton_lines, axis) = with_skeleton(subdivision, finer);
        progress.finish();
    }
    let soft_spots = soft_spots(&subdivision, params.kind, &mut findings);
    if params.kind != SurfaceKind::Spline && !given.cliffs.is_empty() {
        let message = format!("{} cliffs: only the smooth surface jumps at them", given.cliffs.len());
        findings.push(Finding::general(FindingKind::SkippedFeature, message));
    }
    let (working, triangles) = match &chosen {
        None => (None, Vec::new()),
        Some(chosen) => {
            let on = Triangulation { subdivision: &subdivision, skeleton_lines: &skeleton_lines, groups: &groups };
            let lines = Lines { streams, break_lines: &mut break_lines, soft_spots: &soft_spots };
            let made = smooth(on, lines, (given, params), &chosen.hyper_parameters, progress);
            (streams, sinks) = (made.streams, made.sinks);
            findings.extend(made.findings);
            findings.extend(missed_spots(&subdivision, &made.working));
            (Some(made.working), made.triangles)
        }
    };
    let coarse = working
        .as_ref()
        .and_then(|working| account_for_coarse_nodes(&subdivision, &groups, working, params, chosen.as_mut()));
    let misfit = coarse.map(|(finding, misfit)| {
        findings.push(finding);
        misfit
    });
    let errors = (params.uncertainty == Uncertainty::Learnt).then(|| {
        progress.start("expected errors", 0);
        let part = largest.as_ref().map(|largest| largest.part(trusted.as_ref().unwrap_or(&subdivision.map)));
        let known = match (&largest, &part) {
            (Some(largest), Some(part)) => Some(MapExtent::new(part, largest.ring(), interval)),
            _ => trusted.as_ref().map(|map| subdivision.extent_of(map)),
        };
        let wanted = |extent: &MapExtent<'_>| working_grid(extent, params.spline.wanted, &tuning.spline.grid);
        let nodes = match &working {
            Some(WorkingGrids(parts)) => parts.iter().map(|w| (w.grid, Some(w.heights.as_slice()))).collect(),
            None => groups.extents(&subdivision, |extent| (wanted(extent), None)),
        };
        let errors = error_field(&subdivision, known, &trials, chosen.as_ref(), &nodes);
        let errors = match &misfit {
            Some(misfit) => errors.with_misfit(|grid| misfit.at_nodes(grid)),
            None => errors,
        };
        progress.finish();
        errors
    });
    if params.triangles == Triangles::Smooth
        && let Some(working) = &working
    {
        progress.start("triangulating the smooth surface", 0);
        give_heights(&mut subdivision.tin, known(&streams, &break_lines));
        (subdivision, skeleton_lines) = with_nodes(subdivision, axis, working, &triangles, tuning)?;
        progress.finish();
    }
    let wrong_lines = subdivision.wrong_lines();
    let Subdivision { map, tin, regions, frame, interval, .. } = subdivision;
    let surface = Surface {
        map,
        tin,
        regions,
        closures,
        skeleton_lines,
        streams,
        stream_tolerance: tuning.streams.cell_tolerance * interval.step,
        river_areas: given.streams.areas.clone(),
        break_lines,
        drain: params.drain,
        sinks,
        wrong_lines,
        frame,
        interval,
        working,
        chosen,
        errors,
    };
    Ok(Report { value: surface, findings })
}

/// Tells of the spot heights that the surface does not pass through.
fn missed_spots(subdivision: &Subdivision, working: &WorkingGrids) -> Option<Finding> {
    let missed = |spot: DVec3| (spot.z - f64::from(working.at(spot.truncate()))).abs();
    let misses = subdivision.used_spots().map(|spot| (missed(spot), spot));
    let missed: Vec<(f64, DVec3)> = misses.filter(|(by, _)| *by > MET * subdivision.interval.step).collect();
    let (by, spot) = missed.iter().max_by(|a, b| a.0.total_cmp(&b.0))?;
    let message = format!(
        "{} of {} spot heights are not met, because others are too near to them: the largest difference, here, is {:.1} % of \
         the contour interval",
        missed.len(),
        subdivision.used_spots().count(),
        100.0 * by / subdivision.interval.step,
    );
    Some(Finding::at(FindingKind::SpotMissed, spot.truncate(), message))
}

/// The spot heights with a standard error that the surface uses.
fn soft_spots(subdivision: &Subdivision, kind: SurfaceKind, findings: &mut Vec<Finding>) -> Vec<SoftSpot> {
    let count = subdivision.map.soft_spots.len();
    if kind != SurfaceKind::Spline && count > 0 {
        let message = format!("{count} spot heights with a standard error: only the smooth surface uses them");
        findings.push(Finding::general(FindingKind::SkippedFeature, message));
        return Vec::new();
    }
    let (used, about) = subdivision.agreeing_soft_spots();
    findings.extend(about);
    used
}
