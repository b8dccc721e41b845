//! The smooth surface of a triangulated map, with its streams and pits.

use glam::DVec2;

use super::conditions::conditions;
use super::drained::{Wanted, drain_working};
use super::given::Given;
use super::given_lines::known;
use super::groups::Groups;
use super::params::SurfaceParams;
use crate::base::KnownLine;
use crate::base::error::Finding;
use crate::base::progress::Progress;
use crate::break_lines::{Bend, FittedBreakLine};
use crate::contour::SoftSpot;
use crate::drain::Sink;
use crate::skeleton::SkeletonLine;
use crate::spline::{self, Conditions, Drainage, Fold, HyperParameters, WorkingGrids, spline};
use crate::streams::{Stream, follow, without_climbs};
use crate::subdivision::Subdivision;

/// What the smooth surface is built on.
pub(super) struct Triangulation<'a> {
    /// The triangulated map.
    pub subdivision: &'a Subdivision,
    /// Its ridge and canyon lines.
    pub skeleton_lines: &'a [SkeletonLine],
    /// The groups that get a working grid each.
    pub groups: &'a Groups,
}

/// The lines and points besides contours that the smooth surface agrees with.
pub(super) struct Lines<'a> {
    /// The streams.
    pub streams: Vec<Stream>,
    /// The break lines. They get the heights of the surface where they have none of their own.
    pub break_lines: &'a mut [FittedBreakLine],
    /// Spot heights with a standard error.
    pub soft_spots: &'a [SoftSpot],
}

/// The smooth surface.
pub(super) struct Smooth {
    /// The working grid of each group.
    pub working: WorkingGrids,
    /// For each working grid, the triangle that each node lies in.
    pub triangles: Vec<Vec<u32>>,
    /// The streams that are used, with the heights of the surface.
    pub streams: Vec<Stream>,
    /// Where water may stay, each at its place on the surface.
    pub sinks: Vec<Sink>,
    /// Pits that stay, and streams that climb.
    pub findings: Vec<Finding>,
}

/// Solves the smooth surface of each group.
pub(super) fn smooth(
    on: Triangulation<'_>,
    lines: Lines<'_>,
    (given, params): (&Given, &SurfaceParams),
    hyper_parameters: &HyperParameters,
    progress: &dyn Progress,
) -> Smooth {
    let Triangulation { subdivision, skeleton_lines, groups } = on;
    let Lines { streams, break_lines, soft_spots } = lines;
    let (tuning, interval) = (&params.tuning, subdivision.interval.step);
    let cliff_reach = tuning.cliffs.free * subdivision.extent().spacing;
    let streams_of = groups.shared(streams, |s| s.points.first().map(|p| p.truncate()));
    let sinks_of = groups.shared(given.sinks.iter().cloned(), Sink::place);
    let grids = groups.grids(subdivision, &given.break_lines, params);
    let (mut working, mut triangles) = (Vec::new(), Vec::new());
    let (mut used_streams, mut sinks, mut findings) = (Vec::new(), Vec::new(), Vec::new());
    for ((grid, own_streams), own_sinks) in grids.iter().zip(streams_of).zip(sinks_of) {
        progress.start(spline::STEP, 0);
        let lines: Vec<KnownLine<'_>> = known(&own_streams, break_lines).collect();
        // What a stream knows between contours is a guess, and the surface knows better.
        let surveyed = break_lines.iter().map(FittedBreakLine::known).collect();
        let of_map = conditions(subdivision, skeleton_lines, &lines, grid, (&given.cliffs, cliff_reach));
        let mut conditions = Conditions {
            soft_spots,
            drainage: Drainage { drain: params.drain, sinks: &own_sinks },
            streams: &own_streams,
            known: surveyed,
            ..of_map
        };
        conditions.creases.extend(own_streams.iter().map(|stream| (Fold::Valley, stream.known().course())));
        conditions.creases.extend(break_lines.iter().map(|line| (fold(line.bend), line.known().course())));
        progress.finish();
        let mut solved = spline(&conditions, hyper_parameters, &tuning.spline, progress);
        let wanted = Wanted {
            drain: params.drain,
            sinks: own_sinks.clone(),
            bounds: &conditions.bounds,
            regions: &subdivision.regions,
            triangles: &conditions.triangles,
            interval,
        };
        let (moved, of_pits) = drain_working(&mut solved, wanted);
        sinks.extend(moved);
        findings.extend(of_pits);
        let height = |p: DVec2| f64::from(solved.at(p));
        let (mut used, climbs) = without_climbs(&own_streams, height, tuning.streams.climb * interval);
        follow(&mut used, |p| height(p.truncate()));
        used_streams.extend(used);
        findings.extend(climbs);
        working.push(solved);
        triangles.push(conditions.triangles);
    }
    let working = WorkingGrids(working);
    break_lines.iter_mut().for_each(|line| line.follow(|p| f64::from(working.at(p))));
    Smooth { working, triangles, streams: used_streams, sinks, findings }
}

/// How the surface may bend across a break line.
fn fold(bend: Bend) -> Fold {
    match bend {
        Bend::Either => Fold::Given,
        Bend::Ridge => Fold::Ridge,
        Bend::Valley => Fold::Valley,
    }
}
