//! From a clean map to a surface: subdivision, ridge and canyon lines, smooth surface, and triangles.

use std::collections::HashSet;
use std::sync::atomic::{AtomicBool, Ordering};

use glam::DVec2;

use super::built::Surface;
use super::coarse::account_for_coarse_nodes;
use super::conditions::conditions;
use super::drained::{Wanted, drain_working};
use super::given::Given;
use super::given_lines::{GivenLines, known, settle_lines};
use super::groups::Groups;
use super::known_lines::give_heights;
use super::nodes::with_nodes;
use super::params::{SurfaceKind, SurfaceParams, Triangles, Uncertainty};
use super::skeleton_lines::{Finer, finer, with_skeleton};
use super::trial_builder::TrialBuilder;
use crate::base::error::{Error, Finding, FindingKind, Report, Result};
use crate::base::progress::Progress;
use crate::base::{KnownLine, memory};
use crate::contour::{ContourMap, SoftSpot};
use crate::creases::{Bend, Crease};
use crate::drain::Sink;
use crate::skeleton::{Axis, skeleton, skeleton_with};
use crate::spline::{self, Conditions, Drainage, Fold, WorkingGrids, bytes_on, spline, working_grid};
use crate::streams::{Stream, follow, without_climbs};
use crate::subdivision::{Prepared, Subdivision, prepare};
use crate::subdomains::{GapEdges, MapExtent, Regions, Side};
use crate::tin::{Tin, TinInput};
use crate::validate::{Chosen, TrialParams, choose, error_field};

/// Builds the surface of a clean map (see [`clean`](fn@crate::clean::clean)).
///
/// # Errors
/// Those of [`subdivide_with_water`](crate::subdivision::subdivide_with_water). An error also arises when a parameter
/// is out of range, or when the smooth surface needs more memory than it may take. [`Error::StreamsElsewhere`] if most streams
/// contradict the contours, unless the map is a part of a larger one: then this is a finding.
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
    let Triangulated { mut subdivision, trusted, mended, closures, mut streams, mut creases, finer, mut findings } =
        found?;
    let mut sinks = given.sinks.clone();
    let mut chosen = of_whole.or(mended).or(chosen);
    let mut break_lines = Vec::new();
    let mut axis = Axis::default();
    if let Some(finer) = finer {
        (subdivision, break_lines, axis) = with_skeleton(subdivision, finer);
        progress.finish();
    }
    let soft_spots = soft_spots(&subdivision, params.kind, &mut findings);
    if params.kind != SurfaceKind::Spline && !given.cliffs.is_empty() {
        let message = format!("{} cliffs: only the smooth surface jumps at them", given.cliffs.len());
        findings.push(Finding::general(FindingKind::SkippedFeature, message));
    }
    let (working, triangles) = chosen.as_ref().map_or((None, Vec::new()), |chosen| {
        let cliff_reach = tuning.cliffs.free * subdivision.extent().spacing;
        let streams_of = groups.shared(std::mem::take(&mut streams), |s| s.points.first().map(|p| p.truncate()));
        let sinks_of = groups.shared(std::mem::take(&mut sinks), Sink::place);
        let (mut working, mut triangles) = (Vec::new(), Vec::new());
        for ((grid, own_streams), own_sinks) in
            groups.grids(&subdivision, &given.creases, params).iter().zip(streams_of).zip(sinks_of)
        {
            progress.start(spline::STEP, 0);
            let lines: Vec<KnownLine<'_>> = known(&own_streams, &creases).collect();
            // What a stream knows between contours is a guess, and the surface knows better.
            let surveyed = creases.iter().map(Crease::known).collect();
            let of_map = conditions(&subdivision, &break_lines, &lines, grid, (&given.cliffs, cliff_reach));
            let mut conditions = Conditions {
                soft_spots: &soft_spots,
                drainage: Drainage { drain: params.drain, sinks: &own_sinks },
                streams: &own_streams,
                known: surveyed,
                ..of_map
            };
            conditions.creases.extend(own_streams.iter().map(|stream| (Fold::Valley, stream.known().course())));
            conditions.creases.extend(creases.iter().map(|crease| (fold(crease.bend), crease.known().course())));
            progress.finish();
            let mut solved = spline(&conditions, &chosen.hyper_parameters, &tuning.spline, progress);
            let wanted = Wanted {
                drain: params.drain,
                sinks: own_sinks.clone(),
                bounds: &conditions.bounds,
                regions: &subdivision.regions,
                triangles: &conditions.triangles,
                interval: interval.step,
            };
            let (moved, of_pits) = drain_working(&mut solved, wanted);
            sinks.extend(moved);
            findings.extend(of_pits);
            let height = |p: DVec2| f64::from(solved.at(p));
            let (mut used, climbs) = without_climbs(&own_streams, height, tuning.streams.climb * interval.step);
            follow(&mut used, |p| height(p.truncate()));
            streams.extend(used);
            findings.extend(climbs);
            working.push(solved);
            triangles.push(conditions.triangles);
        }
        let working = WorkingGrids(working);
        creases.iter_mut().for_each(|crease| crease.follow(|p| f64::from(working.at(p))));
        (Some(working), triangles)
    });
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
        give_heights(&mut subdivision.tin, known(&streams, &creases));
        (subdivision, break_lines) = with_nodes(subdivision, axis, working, &triangles, tuning)?;
        progress.finish();
    }
    let wrong_lines = subdivision.wrong_lines();
    let Subdivision { map, tin, regions, frame, interval, .. } = subdivision;
    let surface = Surface {
        map,
        tin,
        regions,
        closures,
        break_lines,
        streams,
        stream_tolerance: tuning.streams.cell_tolerance * interval.step,
        river_areas: given.streams.areas.clone(),
        creases,
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

/// The triangulated map, before the ridge and canyon lines are in it.
struct Triangulated {
    subdivision: Subdivision,
    /// The map without wrong elevations; `None` if it has none.
    trusted: Option<ContourMap>,
    /// The hyper-parameters that this map gives.
    mended: Option<Chosen>,
    closures: Vec<(f64, [DVec2; 2])>,
    streams: Vec<Stream>,
    creases: Vec<Crease>,
    /// Ridge and canyon lines, and the triangulation with them; `None` for the linear surface. Their progress step is
    /// not finished yet.
    finer: Option<Finer>,
    findings: Vec<Finding>,
}

/// Triangulates a map, and finds its ridge and canyon lines where they are needed. If elevations are wrong, `trials`
/// give the hyper-parameters without them. The first trials, which run beside this, are then `needless`.
fn triangulated(
    prepared: Prepared,
    (given, params): (&Given, &SurfaceParams),
    (trials, groups): (&TrialParams<'_>, &Groups),
    needless: &AtomicBool,
    progress: &dyn Progress,
) -> Result<Triangulated> {
    let Report { value: mut subdivision, mut findings } = prepared.subdivide(&given.water, progress)?;
    // The choice that runs beside this takes all elevations as correct. Only the triangulation shows which are wrong.
    let trusted = subdivision.trusted();
    needless.store(trusted.is_some(), Ordering::Relaxed);
    if params.kind == SurfaceKind::Spline {
        // Grids are solved one after another, so the largest one decides.
        let grids = groups.grids(&subdivision, &given.creases, params);
        if let Some(grid) = grids.iter().max_by_key(|grid| grid.len()) {
            let length = subdivision.map.contours.iter().map(|c| c.length()).sum();
            let what = format!("the smooth surface on {} x {} nodes", grid.cols, grid.rows);
            let remedy = "choose a larger cell, a smaller frame, or the skeleton surface";
            memory::check(bytes_on(grid, length), params.memory, what, remedy)?;
        }
    }
    // What was triangulated takes much of the memory. It is freed as soon as it is not needed any more.
    let mut input = std::mem::take(&mut subdivision.input);
    let closures = closures(&subdivision.tin, &subdivision.regions, &subdivision.gaps);
    let GivenLines { streams, creases, findings: of_lines, heights } =
        settle_lines(&subdivision, given, params, progress);
    // A part of a map may have few streams, and these may be bad ones.
    let of_whole_map = of_lines.iter().filter(|_| params.whole.is_none());
    if let Some(elsewhere) = of_whole_map.into_iter().find(|finding| finding.kind == FindingKind::StreamsElsewhere) {
        return Err(Error::StreamsElsewhere(elsewhere.message.clone()));
    }
    findings.extend(of_lines);
    let known: Vec<KnownLine<'_>> = known(&streams, &creases).collect();
    if known.is_empty() {
        input = TinInput::default();
    }
    let tuning = &params.tuning.skeleton;
    let skeleton = (params.kind != SurfaceKind::Linear).then(|| {
        progress.start("ridge and canyon lines", 0);
        match heights {
            Some(heights) => skeleton_with(&heights, params.resolution, tuning),
            None => skeleton(&subdivision.tin, &subdivision.regions, params.resolution, tuning),
        }
    });
    // The smooth surface knows the ground along streams better than they do. So points near them stay.
    let is_clear_of = |line: &&KnownLine<'_>| params.kind == SurfaceKind::Skeleton || !line.is_stream;
    let clear_of: Vec<KnownLine<'_>> = known.iter().filter(is_clear_of).copied().collect();
    let finer = || skeleton.map(|skeleton| finer(&subdivision, input, skeleton, &known, &clear_of, tuning)).transpose();
    let largest = groups.largest();
    let of_map = |map: &ContourMap| {
        let chosen = match &largest {
            None => choose(&subdivision.extent_of(map), &params.spline, trials),
            Some(largest) => choose(
                &MapExtent::new(&largest.part(map), largest.ring(), subdivision.interval),
                &params.spline,
                trials,
            ),
        };
        Chosen { is_mended: true, ..chosen }
    };
    let is_open = params.kind == SurfaceKind::Spline && params.whole.is_none();
    let to_mend = trusted.as_ref().filter(|_| is_open);
    // Triangulating with the ridge and canyon lines keeps one thread busy too.
    let (mended, finer) = rayon::join(|| to_mend.map(of_map), finer);
    let finer = finer?;
    drop(known);
    Ok(Triangulated { subdivision, trusted, mended, closures, streams, creases, finer, findings })
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

/// How the surface may bend across a break line.
fn fold(bend: Bend) -> Fold {
    match bend {
        Bend::Either => Fold::Given,
        Bend::Ridge => Fold::Ridge,
        Bend::Valley => Fold::Valley,
    }
}

/// The gap closures as lines, with higher ground on their right.
fn closures(tin: &Tin, regions: &Regions, gaps: &GapEdges) -> Vec<(f64, [DVec2; 2])> {
    let mut wanted: HashSet<[u32; 2]> = gaps.closures.iter().map(|&[u, v]| [u.min(v), u.max(v)]).collect();
    let mut found = Vec::new();
    for t in (0..tin.len() as u32).filter(|&t| tin.is_inside(t)) {
        for i in 0..3 {
            let [u, v] = tin.edge(t, i);
            if wanted.is_empty() || !wanted.remove(&[u.min(v), u.max(v)]) {
                continue;
            }
            let level = tin.heights[u as usize];
            let rises = regions.region(t).and_then(|r| r.side(level)) == Some(Side::Above);
            // The triangle lies on the left of the edge from u to v.
            let ends = if rises { [v, u] } else { [u, v] };
            found.push((level, ends.map(|v| tin.point(v).truncate())));
        }
    }
    found
}
