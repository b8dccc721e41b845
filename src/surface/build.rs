//! From a clean map to a surface: subdivision, ridge and canyon lines, smooth surface, and triangles.

use std::collections::HashSet;

use glam::DVec2;

use super::built::Surface;
use super::conditions::conditions;
use super::drained::{Wanted, drain_working};
use super::nodes::with_nodes;
use super::params::{SurfaceKind, SurfaceParams, Triangles, Uncertainty};
use super::skeleton_lines::{finer, with_skeleton};
use super::stream_lines::give_heights;
use super::trial_builder::TrialBuilder;
use crate::base::error::{Finding, Report, Result};
use crate::base::memory;
use crate::base::progress::Progress;
use crate::contour::ContourMap;
use crate::dem::locate;
use crate::skeleton::{Axis, Skeleton};
use crate::spline::{self, Conditions, Drainage, bytes_on, spline, working_grid};
use crate::streams::{Stream, settle};
use crate::subdivision::{Prepared, Subdivision, prepare};
use crate::subdomains::{GapEdges, MapExtent, Regions, Side};
use crate::tin::Tin;
use crate::validate::{Chosen, TrialParams, choose, error_field};

/// Builds the surface of a clean map (see [`clean`](fn@crate::clean::clean)).
///
/// # Errors
/// Those of [`subdivide_with_water`](crate::subdivision::subdivide_with_water). An error also arises when a parameter
/// is out of range, or when the smooth surface needs more memory than it may take.
pub fn build(map: ContourMap, params: &SurfaceParams, progress: &dyn Progress) -> Result<Report<Surface>> {
    params.check()?;
    let tuning = &params.tuning;
    let resolution = (params.kind != SurfaceKind::Linear).then_some(params.resolution);
    let builder = TrialBuilder { resolution, tuning: &tuning.skeleton };
    let trials = TrialParams { frame: &params.frame, wanted: params.spline.wanted, builder: &builder, tuning };
    let choose = |extent: &MapExtent<'_>| choose(extent, &params.spline, &trials);
    let prepared = prepare(map, &params.frame, &params.water)?;
    // Triangulating keeps only one thread busy. The choice of hyper-parameters needs only the contours, so it runs
    // beside it.
    let to_choose = (params.kind == SurfaceKind::Spline).then(|| (prepared.map.clone(), prepared.frame.clone()));
    let interval = prepared.interval;
    let (chosen, found) = rayon::join(
        || to_choose.map(|(map, frame)| choose(&MapExtent::new(&map, &frame, interval))),
        || triangulated(prepared, params, progress),
    );
    let Triangulated { mut subdivision, closures, mut streams, finer, mut findings } = found?;
    let mut sinks = params.sinks.clone();
    // That choice took all labels as correct. Only the triangulation shows which are wrong.
    let trusted = subdivision.trusted();
    let chosen = match &trusted {
        Some(map) => chosen.map(|_| Chosen { is_mended: true, ..choose(&subdivision.extent_of(map)) }),
        None => chosen,
    };
    let mut break_lines = Vec::new();
    let mut axis = Axis::default();
    if let Some(finer) = finer {
        (subdivision, break_lines, axis) = with_skeleton(subdivision, finer);
        progress.finish();
    }
    let (working, triangles) = chosen.as_ref().map_or((None, Vec::new()), |chosen| {
        progress.start(spline::STEP, 0);
        let grid = working_grid(&subdivision.extent(), params.spline.wanted, &tuning.spline.grid);
        let triangles = locate(&subdivision.tin, &grid, &());
        let drainage = Drainage { drain: params.drain, sinks: &params.sinks };
        let mut conditions =
            Conditions { streams: &streams, drainage, ..conditions(&subdivision, &break_lines, &grid, &triangles) };
        let course = |stream: &Stream| stream.points.iter().map(|p| p.truncate()).collect();
        conditions.creases.extend(streams.iter().map(course));
        progress.finish();
        let (mut working, followed) = spline(&conditions, &chosen.hyper_parameters, &tuning.spline, progress);
        let wanted = Wanted {
            drain: params.drain,
            sinks: std::mem::take(&mut sinks),
            bounds: &conditions.bounds,
            regions: &subdivision.regions,
            triangles: &triangles,
            interval: interval.step,
        };
        let drained = drain_working(&mut working, wanted);
        sinks = drained.0;
        findings.extend(drained.1);
        drop(conditions);
        streams = followed;
        (Some(working), triangles)
    });
    let errors = (params.uncertainty == Uncertainty::Learnt).then(|| {
        progress.start("expected errors", 0);
        let known = trusted.as_ref().map(|map| subdivision.extent_of(map));
        let errors = error_field(&subdivision, known, &trials, chosen.as_ref(), working.as_ref());
        progress.finish();
        errors
    });
    if params.triangles == Triangles::Smooth
        && let Some(working) = &working
    {
        progress.start("triangulating the smooth surface", 0);
        give_heights(&mut subdivision.tin, &streams);
        (subdivision, break_lines) = with_nodes(subdivision, axis, working, &triangles, tuning)?;
        progress.finish();
    }
    let Subdivision { map, tin, regions, frame, interval, .. } = subdivision;
    let surface = Surface {
        map,
        tin,
        regions,
        closures,
        break_lines,
        streams,
        drain: params.drain,
        sinks,
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
    closures: Vec<(f64, [DVec2; 2])>,
    streams: Vec<Stream>,
    /// Ridge and canyon lines, and the triangulation with them; `None` for the linear surface. Their progress step is
    /// not finished yet.
    finer: Option<(Skeleton, Tin)>,
    findings: Vec<Finding>,
}

/// Triangulates a map, and finds its ridge and canyon lines where they are needed.
fn triangulated(prepared: Prepared, params: &SurfaceParams, progress: &dyn Progress) -> Result<Triangulated> {
    let Report { value: mut subdivision, mut findings } = prepared.subdivide(&params.water, progress)?;
    if params.kind == SurfaceKind::Spline {
        let grid = working_grid(&subdivision.extent(), params.spline.wanted, &params.tuning.spline.grid);
        let length = subdivision.map.contours.iter().map(|c| c.length()).sum();
        let what = format!("the smooth surface on {} x {} nodes", grid.cols, grid.rows);
        let remedy = "choose a larger cell, a smaller frame, or the skeleton surface";
        memory::check(bytes_on(&grid, length), params.memory, what, remedy)?;
    }
    // The triangulation takes much of the memory. It is freed as soon as it is not needed any more.
    let triangulation = std::mem::take(&mut subdivision.triangulation);
    let closures = closures(&subdivision.tin, &subdivision.regions, &subdivision.gaps);
    let streams = if params.kind == SurfaceKind::Linear || params.streams.lines.is_empty() {
        Vec::new()
    } else {
        progress.start("streams", 0);
        let ground = (&subdivision.map, &subdivision.tin, &subdivision.regions);
        let settled = settle(&params.streams, ground, subdivision.extent().spacing, &params.tuning.streams);
        progress.finish();
        findings.extend(settled.findings);
        settled.streams
    };
    let finer = if params.kind == SurfaceKind::Linear {
        None
    } else {
        progress.start("ridge and canyon lines", 0);
        Some(finer(&subdivision, triangulation, &streams, params.resolution, &params.tuning.skeleton)?)
    };
    Ok(Triangulated { subdivision, closures, streams, finer, findings })
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
