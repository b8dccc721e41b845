//! Ridge and canyon lines in the triangulation (paper, section 4: the curve mesh).

use super::known_lines::push_lines;
use crate::base::KnownLine;
use crate::base::error::Result;
use crate::skeleton::{Axis, BreakLine, End, Skeleton, skeleton};
use crate::subdivision::Subdivision;
use crate::tin::{Tin, TinInput, Triangulation, VertexKind};
use crate::tuning::SkeletonTuning;

/// The ridge and canyon lines, and the triangulation with them. `triangulation` is the one of `subdivision`.
pub fn finer(
    subdivision: &Subdivision,
    mut triangulation: Triangulation,
    known: &[KnownLine<'_>],
    resolution: f64,
    tuning: &SkeletonTuning,
) -> Result<(Skeleton, Tin)> {
    let skeleton = skeleton(&subdivision.tin, &subdivision.regions, resolution, tuning);
    let input = triangulation.input();
    subdivision.push_borders(input);
    let points = push_points(input, &skeleton.axis, &skeleton.flow.heights);
    // Streams and break lines come first; ridge and canyon lines give way to them.
    push_lines(input, &subdivision.tin, known);
    push_pieces(input, &subdivision.tin.source, (&skeleton.axis, &points), known.is_empty());
    Ok((skeleton, triangulation.into_tin()?))
}

/// The map with the [`finer`] triangulation, its ridge and canyon lines, and their axis.
pub fn with_skeleton(
    subdivision: Subdivision,
    (skeleton, tin): (Skeleton, Tin),
) -> (Subdivision, Vec<BreakLine>, Axis) {
    (subdivision.retriangulated(tin, &|_| None), skeleton.lines, skeleton.axis)
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
