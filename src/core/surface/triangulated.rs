//! From a prepared map to its triangulation, with the lines that are in it.

use std::collections::HashSet;
use std::sync::atomic::{AtomicBool, Ordering};

use glam::DVec2;

use super::given::Given;
use super::given_lines::{GivenLines, known, settle_lines};
use super::groups::Groups;
use super::params::{SurfaceKind, SurfaceParams};
use super::skeleton_lines::{Finer, finer};
use crate::base::error::{Error, Finding, FindingKind, Report, Result};
use crate::base::progress::Progress;
use crate::base::{KnownLine, memory};
use crate::break_lines::FittedBreakLine;
use crate::contour::ContourMap;
use crate::skeleton::{skeleton, skeleton_with};
use crate::spline::bytes_on;
use crate::streams::Stream;
use crate::subdivision::{Prepared, Subdivision};
use crate::subdomains::{GapEdges, MapExtent, Regions, Side};
use crate::tin::{Tin, TinInput};
use crate::validate::{Chosen, TrialParams, choose};

/// The triangulated map, before the ridge and canyon lines are in it.
pub(super) struct Triangulated {
    pub subdivision: Subdivision,
    /// The map without wrong elevations; `None` if it has none.
    pub trusted: Option<ContourMap>,
    /// The hyper-parameters that this map gives.
    pub mended: Option<Chosen>,
    pub closures: Vec<(f64, [DVec2; 2])>,
    pub streams: Vec<Stream>,
    pub break_lines: Vec<FittedBreakLine>,
    /// Ridge and canyon lines, and the triangulation with them; `None` for the linear surface. Their progress step is
    /// not finished yet.
    pub finer: Option<Finer>,
    pub findings: Vec<Finding>,
}

/// Triangulates a map, and finds its ridge and canyon lines where they are needed. If elevations are wrong, `trials`
/// give the hyper-parameters without them. The first trials, which run beside this, are then `needless`.
pub(super) fn triangulated(
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
        let grids = groups.grids(&subdivision, &given.break_lines, params);
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
    let GivenLines { streams, break_lines, findings: of_lines, heights } =
        settle_lines(&subdivision, given, params, progress);
    // A part of a map may have few streams, and these may be bad ones.
    let of_whole_map = of_lines.iter().filter(|_| params.whole.is_none());
    if let Some(elsewhere) = of_whole_map.into_iter().find(|finding| finding.kind == FindingKind::StreamsElsewhere) {
        return Err(Error::StreamsElsewhere(elsewhere.message.clone()));
    }
    findings.extend(of_lines);
    let known: Vec<KnownLine<'_>> = known(&streams, &break_lines).collect();
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
    Ok(Triangulated { subdivision, trusted, mended, closures, streams, break_lines, finer, findings })
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
