//! Ridge and canyon lines in the triangulation (paper, section 4: the curve mesh).

use rstar::RTree;
use rstar::primitives::Line;

use super::known_lines::push_lines;
use crate::base::error::Result;
use crate::base::{KnownLine, Sure, parallel};
use crate::skeleton::{Axis, BreakLine, End, Skeleton, skeleton};
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

/// Finds the ridge and canyon lines, and triangulates with them and with the `known` lines. `triangulation` is the one of
/// `subdivision`.
pub fn finer(
    subdivision: &Subdivision,
    mut triangulation: Triangulation,
    known: &[KnownLine<'_>],
    resolution: f64,
    tuning: &SkeletonTuning,
) -> Result<Finer> {
    let Skeleton { mut axis, flow, lines, .. } = skeleton(&subdivision.tin, &subdivision.regions, resolution, tuning);
    let mut heights = flow.heights;
    if known.iter().any(|line| line.sure.contains(&Sure::Surveyed)) {
        let is_clear = clear_of_surveyed(&subdivision.tin, &axis, known);
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

/// For each axis point: whether all surveyed lines are further away than the contours around. A nearer line tells the height
/// of the ground by its own vertices, and the point would contradict them.
fn clear_of_surveyed(tin: &Tin, axis: &Axis, known: &[KnownLine<'_>]) -> Vec<bool> {
    let segments = known.iter().flat_map(|line| {
        // Where a stream runs straight from contour to contour, both ends of a segment are sure, but not surveyed.
        let is_surveyed = line.sure.windows(2).map(|w| w[0].min(w[1]) == Sure::Surveyed);
        let ends = line.points.windows(2).map(|w| [w[0], w[1]].map(|p| (p.truncate() - tin.origin).to_array()));
        ends.zip(is_surveyed).filter(|(_, surveyed)| *surveyed).map(|([a, b], _)| Line::new(a, b))
    });
    let segments = RTree::bulk_load(segments.collect());
    parallel::values_each(&axis.points, |point| {
        let corners = tin.corners(point.triangle).into_iter();
        let room = corners.map(|corner| corner.distance_squared(point.position)).fold(f64::INFINITY, f64::min);
        segments.locate_within_distance(point.position.to_array(), room).next().is_none()
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
