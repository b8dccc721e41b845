//! Ridge and canyon lines in the triangulation (paper, section 4: the curve mesh).

use std::collections::HashMap;

use glam::DVec2;

use crate::base::error::Result;
use crate::skeleton::{Axis, BreakLine, End, Skeleton, skeleton};
use crate::streams::{Stream, Sure};
use crate::subdivision::Subdivision;
use crate::tin::{NONE, Tin, TinInput, Triangulation, VertexKind};
use crate::tuning::SkeletonTuning;

/// Streams take their edges first, the pieces of ridge and canyon lines where they leave room.
const FIRST: u8 = 0;
const AFTER_STREAMS: u8 = 1;
/// A point nearer to the edge of a sub-domain than this share of the edge's length is no vertex of a stream.
const CLEARANCE: f64 = 1e-6;

/// The ridge and canyon lines, and the triangulation with them. `triangulation` is the one of `subdivision`.
pub fn finer(
    subdivision: &Subdivision,
    mut triangulation: Triangulation,
    streams: &[Stream],
    resolution: f64,
    tuning: &SkeletonTuning,
) -> Result<(Skeleton, Tin)> {
    let skeleton = skeleton(&subdivision.tin, &subdivision.regions, resolution, tuning);
    let input = triangulation.input();
    subdivision.push_borders(input);
    push_axis(input, &subdivision.tin.source, &skeleton.axis, &skeleton.flow.heights, streams.is_empty());
    push_streams(input, subdivision, streams);
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
///
/// Beside streams the pieces are loose: those that cross a stream are left out.
fn push_axis(input: &mut TinInput, source: &[u32], axis: &Axis, heights: &[f64], is_firm: bool) {
    let each = axis.points.iter().zip(heights);
    let points: Vec<u32> = each.map(|(p, &h)| input.push_local(p.position, h, VertexKind::Axis)).collect();
    for piece in &axis.pieces {
        let [a, b] = piece.map(|end| match end {
            End::Axis(p) => points[p as usize],
            End::Vertex(v) => source[v as usize],
        });
        if is_firm {
            input.push_edge(a, b);
        } else {
            input.push_loose_edge(a, b, AFTER_STREAMS);
        }
    }
}

/// Adds the vertices of streams with heights, and the edges between them. A vertex on a contour is added only if the
/// contour has a vertex there, because no point may lie on the edge of a contour.
fn push_streams(input: &mut TinInput, subdivision: &Subdivision, streams: &[Stream]) {
    let tin = &subdivision.tin;
    let place = |p: DVec2| p.to_array().map(f64::to_bits);
    let mut known: HashMap<[u64; 2], u32> = HashMap::new();
    let exact = streams.iter().flat_map(|s| s.points.iter().zip(&s.sure)).filter(|(_, sure)| **sure == Sure::Exact);
    known.extend(exact.map(|(p, _)| (place(p.truncate() - tin.origin), NONE)));
    for (v, p) in tin.positions.iter().enumerate().filter(|(v, _)| tin.kinds[*v] == VertexKind::Contour) {
        if let Some(vertex) = known.get_mut(&place(*p)) {
            *vertex = tin.source[v];
        }
    }
    let mut near = 0;
    for stream in streams {
        let mut before: Option<u32> = None;
        for (p, sure) in stream.points.iter().zip(&stream.sure) {
            let position = p.truncate() - tin.origin;
            let on_contour = known.get(&place(position)).copied().filter(|&v| v != NONE);
            let vertex = match on_contour {
                Some(vertex) => Some(vertex),
                None if *sure == Sure::Exact => None,
                None => {
                    clear_triangle(tin, &mut near, position).map(|_| input.push_local(position, p.z, VertexKind::Axis))
                }
            };
            if let (Some(a), Some(b)) = (before, vertex) {
                input.push_loose_edge(a, b, FIRST);
            }
            before = vertex;
        }
    }
}

/// Gives the vertices of streams the heights of the streams.
pub fn give_heights(tin: &mut Tin, streams: &[Stream]) {
    let place = |p: DVec2| p.to_array().map(f64::to_bits);
    let all = streams.iter().flat_map(|stream| stream.points.iter().zip(&stream.sure));
    let free = all.filter(|(_, sure)| **sure < Sure::Exact);
    let height: HashMap<[u64; 2], f64> = free.map(|(p, _)| (place(p.truncate() - tin.origin), p.z)).collect();
    let Tin { positions, heights, kinds, .. } = tin;
    let vertices = positions.iter().zip(heights).zip(kinds).filter(|(_, kind)| **kind == VertexKind::Axis);
    for ((position, z), _) in vertices {
        if let Some(&height) = height.get(&place(*position)) {
            *z = height;
        }
    }
}

/// The triangle inside the frame that a position lies in, if it is clear of edges that borders run along.
fn clear_triangle(tin: &Tin, near: &mut u32, position: DVec2) -> Option<u32> {
    let t = match tin.walk(*near, position) {
        Ok(t) => t,
        Err(left) => {
            *near = left;
            return None;
        }
    };
    *near = t;
    let corners = tin.corners(t);
    let is_clear = |i: usize| {
        let (a, b) = (corners[i], corners[(i + 1) % 3]);
        tin.across(t, i).is_some() || (b - a).perp_dot(position - a) > CLEARANCE * (b - a).length_squared()
    };
    (tin.is_inside(t) && (0..3).all(is_clear)).then_some(t)
}
