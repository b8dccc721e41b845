//! Ridge and canyon lines in the triangulation (paper, section 4: the curve mesh).

use rstar::primitives::{GeomWithData, Line};
use rstar::{PointDistance, RTree};

use super::known_lines::push_lines;
use crate::base::error::Result;
use crate::base::{KnownLine, Sure, parallel};
use crate::skeleton::{Axis, AxisPoint, End, Skeleton, SkeletonLine};
use crate::subdivision::Subdivision;
use crate::tin::{Split, SplitPoint, Tin, TinInput, VertexKind, triangulate};
use crate::tuning::SkeletonTuning;

/// Ridge and canyon lines, and a triangulation with their points.
pub struct Finer {
    pub lines: Vec<SkeletonLine>,
    /// The points in the triangulation, and the pieces between them.
    pub axis: Axis,
    tin: FinerTin,
}

/// How the points came into the triangulation.
enum FinerTin {
    /// Each triangle was split on its own.
    Split(Split),
    /// All was triangulated anew, because streams and break lines cross many triangles.
    Anew(Tin),
}

/// Adds the points of ridge and canyon lines, and the `known` lines, to the triangulation of `subdivision`, which was made from
/// `input`. Points of ridge and canyon lines keep clear of the lines in `clear_of`.
///
/// The points lie on edges or in triangles, and pieces of lines inside triangles. So without known lines it is enough to
/// split triangles. The smooth surface is as accurate as on a Delaunay triangulation, which takes several times as long.
///
/// # Errors
/// As [`triangulate`](crate::tin::triangulate).
pub fn finer(
    subdivision: &Subdivision,
    input: TinInput,
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
    let tin = match known {
        [] => FinerTin::Split(split(subdivision, &axis, &heights)),
        _ => FinerTin::Anew(anew(subdivision, input, (&axis, &heights), known)?),
    };
    Ok(Finer { lines, axis, tin })
}

/// The map with the [`finer`] triangulation, its ridge and canyon lines, and their axis.
pub fn with_skeleton(
    subdivision: Subdivision,
    Finer { lines, axis, tin }: Finer,
) -> (Subdivision, Vec<SkeletonLine>, Axis) {
    let subdivision = match tin {
        FinerTin::Split(Split { tin, parents }) => subdivision.split(tin, &parents),
        FinerTin::Anew(tin) => subdivision.retriangulated(tin, &|_| None),
    };
    (subdivision, lines, axis)
}

/// The triangulation with axis points of these heights, by splitting.
fn split(subdivision: &Subdivision, axis: &Axis, heights: &[f64]) -> Split {
    let tin = &subdivision.tin;
    let point = |(point, &height): (&AxisPoint, &f64)| {
        let AxisPoint { position, triangle, .. } = *point;
        let is_middle = |i: &usize| {
            let [u, v] = tin.edge(triangle, *i).map(|v| tin.positions[v as usize]);
            u.midpoint(v) == position
        };
        SplitPoint { triangle, edge: (0..3).find(is_middle).map(|i| i as u8), position, height }
    };
    let points: Vec<SplitPoint> = axis.points.iter().zip(heights).map(point).collect();
    let first = tin.positions.len() as u32;
    let vertex = |end: End| match end {
        End::Axis(p) => first + p,
        End::Vertex(v) => v,
    };
    let pieces: Vec<[u32; 2]> = axis.pieces.iter().map(|piece| piece.map(vertex)).collect();
    tin.split(&points, &pieces, subdivision.given as u32)
}

/// The triangulation with axis points of these heights and with the known lines, made anew.
fn anew(
    subdivision: &Subdivision,
    mut input: TinInput,
    (axis, heights): (&Axis, &[f64]),
    known: &[KnownLine<'_>],
) -> Result<Tin> {
    subdivision.push_borders(&mut input);
    let points = push_points(&mut input, axis, heights);
    // Streams and break lines come first; ridge and canyon lines give way to them.
    push_lines(&mut input, &subdivision.tin, known);
    push_pieces(&mut input, &subdivision.tin.source, (axis, &points));
    triangulate(input)
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

/// Adds the pieces between axis points, which have these numbers, except those that cross a stream or a break line. `source`
/// gives the input point of each vertex that a piece leads to.
fn push_pieces(input: &mut TinInput, source: &[u32], (axis, points): (&Axis, &[u32])) {
    for piece in &axis.pieces {
        let [a, b] = piece.map(|end| match end {
            End::Axis(p) => points[p as usize],
            End::Vertex(v) => source[v as usize],
        });
        input.push_loose_edge(a, b);
    }
}
