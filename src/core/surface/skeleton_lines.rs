//! Ridge and canyon lines in the triangulation (paper, section 4: the curve mesh).

use rstar::primitives::{GeomWithData, Line};
use rstar::{PointDistance, RTree};

use super::known_lines::push_lines;
use crate::base::error::Result;
use crate::base::{KnownLine, Sure, parallel};
use crate::skeleton::{Axis, BreakLine, End, Skeleton};
use crate::subdivision::Subdivision;
use crate::tin::{Tin, TinInput, Triangulation, VertexKind};
use crate::tuning::SkeletonTuning;

/// A triangulation with the points of ridge and canyon lines.
pub struct Finer {
    pub lines: Vec<BreakLine>,
    /// The points in the triangulation, and the pieces between them.
    pub axis: Axis,
    pub tin: Tin,
}

/// Triangulates with ridge and canyon lines, and with the `known` lines. Points of ridge and canyon lines keep clear of those in
/// `clear_of`. `triangulation` is the one of `subdivision`.
pub fn finer(
    subdivision: &Subdivision,
    mut triangulation: Triangulation,
    Skeleton { mut axis, flow, lines, .. }: Skeleton,
    known: &[KnownLine<'_>],
    clear_of: &[KnownLine<'_>],
    tuning: &SkeletonTuning,
) -> Result<Finer> {
    let mut heights = flow.heights;
    if !clear_of.is_empty() {
        let is_clear = clear_of_known(&subdivision.tin, &axis, clear_of, tuning);
        axis.retain(&is_clear);
        let mut is_clear = is_clear.into_iter();
        heights.retain(|_| is_clear.next().unwrap_or(false));
    }
    let input = triangulation.input();
    subdivision.push_borders(input);
    let points = push_points(input, &axis, &heights);
    // Streams and break lines come first; ridge and canyon lines give way to them.
    push_lines(input, &subdivision.tin, known);
    push_pieces(input, &subdivision.tin.source, (&axis, &points), known.is_empty());
    Ok(Finer { lines, axis, tin: triangulation.into_tin()? })
}

/// The map with the [`finer`] triangulation, its ridge and canyon lines, and their axis.
pub fn with_skeleton(
    subdivision: Subdivision,
    Finer { lines, axis, tin }: Finer,
) -> (Subdivision, Vec<BreakLine>, Axis) {
    (subdivision.retriangulated(tin, &|_| None), lines, axis)
}

/// For each axis point: whether it keeps clear of the lines whose heights are known. Near one, its own vertices tell the
/// height of the ground, and the point would contradict them. Surveyed lines are to be further away than the contours
/// around, and streams and banks of river areas than [`SkeletonTuning::stream_clearance`] of that.
fn clear_of_known(tin: &Tin, axis: &Axis, known: &[KnownLine<'_>], tuning: &SkeletonTuning) -> Vec<bool> {
    let segments = known.iter().flat_map(|line| {
        let ends = line.points.windows(2).map(|w| [w[0], w[1]].map(|p| (p.truncate() - tin.origin).to_array()));
        let sure = line.sure.windows(2).map(|w| w[0].min(w[1]));
        let segments = ends.zip(sure).map(|([a, b], sure)| GeomWithData::new(Line::new(a, b), sure));
        segments.filter(|segment| segment.data > Sure::Guessed)
    });
    let segments = RTree::bulk_load(segments.collect());
    let clearance = tuning.stream_clearance.powi(2);
    parallel::values_each(&axis.points, |point| {
        let corners = tin.corners(point.triangle).into_iter();
        let room = corners.map(|corner| corner.distance_squared(point.position)).fold(f64::INFINITY, f64::min);
        let at = point.position.to_array();
        let is_close = |segment: &GeomWithData<Line<[f64; 2]>, Sure>| {
            segment.data == Sure::Surveyed || segment.distance_2(&at) <= clearance * room
        };
        !segments.locate_within_distance(at, room).any(is_close)
    })
}

/// Adds axis points with heights. Returns their numbers.
fn push_points(input: &mut TinInput, axis: &Axis, heights: &[f64]) -> Vec<u32> {
    let each = axis.points.iter().zip(heights);
    each.map(|(p, &h)| input.push_local(p.position, h, VertexKind::Axis)).collect()
}

/// Adds the pieces between axis points, which have these numbers. `source` gives the input point of each vertex that a
/// piece leads to. If the pieces are not `firm`, those that cross a stream or a break line are left out.
fn push_pieces(input: &mut TinInput, source: &[u32], (axis, points): (&Axis, &[u32]), firm: bool) {
    for piece in &axis.pieces {
        let [a, b] = piece.map(|end| match end {
            End::Axis(p) => points[p as usize],
            End::Vertex(v) => source[v as usize],
        });
        if firm { input.push_edge(a, b) } else { input.push_loose_edge(a, b) }
    }
}
