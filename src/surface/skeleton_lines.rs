//! Ridge and canyon lines in the triangulation (paper, section 4: the curve mesh).

use crate::base::error::Result;
use crate::skeleton::{Axis, BreakLine, End, Skeleton, skeleton};
use crate::subdivision::Subdivision;
use crate::tin::{Tin, TinInput, Triangulation, VertexKind};
use crate::tuning::SkeletonTuning;

/// The ridge and canyon lines, and the triangulation with them. `triangulation` is the one of `subdivision`.
pub fn finer(
    subdivision: &Subdivision,
    mut triangulation: Triangulation,
    resolution: f64,
    tuning: &SkeletonTuning,
) -> Result<(Skeleton, Tin)> {
    let skeleton = skeleton(&subdivision.tin, &subdivision.regions, resolution, tuning);
    let input = triangulation.input();
    subdivision.push_borders(input);
    push_axis(input, &subdivision.tin.source, &skeleton.axis, &skeleton.flow.heights);
    Ok((skeleton, triangulation.into_tin()?))
}

/// The map with the [`finer`] triangulation, its ridge and canyon lines, and their axis.
pub fn with_skeleton(
    subdivision: Subdivision,
    (skeleton, tin): (Skeleton, Tin),
) -> (Subdivision, Vec<BreakLine>, Axis) {
    (subdivision.retriangulated(tin, &|_| None), skeleton.lines, skeleton.axis)
}

/// Adds axis points with heights, and the pieces between them. `source` gives the input point of each vertex that a
/// piece leads to.
fn push_axis(input: &mut TinInput, source: &[u32], axis: &Axis, heights: &[f64]) {
    let each = axis.points.iter().zip(heights);
    let points: Vec<u32> = each.map(|(p, &h)| input.push_local(p.position, h, VertexKind::Axis)).collect();
    for piece in &axis.pieces {
        let [a, b] = piece.map(|end| match end {
            End::Axis(p) => points[p as usize],
            End::Vertex(v) => source[v as usize],
        });
        input.push_edge(a, b);
    }
}
