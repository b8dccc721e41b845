//! Streams and break lines in the triangulation: their vertices and the edges between them.

use std::collections::HashMap;

use glam::DVec2;

use crate::base::bits::bits;
use crate::base::{KnownLine, Sure};
use crate::tin::{NONE, Tin, TinInput, VertexKind};

/// A point nearer to the edge of a sub-domain than this share of the edge's length is no vertex of a line.
const CLEARANCE: f64 = 1e-6;

/// Adds the vertices of lines with heights, and the edges between them. A vertex on a contour is added only if the
/// contour has a vertex there, because no point may lie on the edge of a contour.
pub(super) fn push_lines(input: &mut TinInput, tin: &Tin, lines: &[KnownLine<'_>]) {
    if lines.is_empty() {
        return;
    }
    let mut known: HashMap<[u64; 2], u32> = HashMap::new();
    let exact = lines.iter().flat_map(|line| line.vertices()).filter(|(_, sure)| *sure == Sure::Exact);
    known.extend(exact.map(|(p, _)| (bits(p.truncate() - tin.origin), NONE)));
    for (v, p) in tin.positions.iter().enumerate().filter(|(v, _)| tin.kinds[*v] == VertexKind::Contour) {
        if let Some(vertex) = known.get_mut(&bits(*p)) {
            *vertex = tin.source[v];
        }
    }
    let mut near = 0;
    for line in lines {
        let mut before: Option<u32> = None;
        for (p, sure) in line.vertices() {
            let position = p.truncate() - tin.origin;
            let on_contour = known.get(&bits(position)).copied().filter(|&v| v != NONE);
            let vertex = match on_contour {
                Some(vertex) => Some(vertex),
                None if sure == Sure::Exact => None,
                None => {
                    clear_triangle(tin, &mut near, position).map(|_| input.push_local(position, p.z, VertexKind::Axis))
                }
            };
            if let (Some(a), Some(b)) = (before, vertex) {
                input.push_loose_edge(a, b);
            }
            before = vertex;
        }
    }
}

/// Gives the vertices of lines the heights of the lines.
pub(super) fn give_heights<'a>(tin: &mut Tin, lines: impl Iterator<Item = KnownLine<'a>>) {
    let height = heights_by_place(lines, tin.origin, |sure| sure < Sure::Exact);
    let Tin { positions, heights, kinds, .. } = tin;
    let vertices = positions.iter().zip(heights).zip(kinds).filter(|(_, kind)| **kind == VertexKind::Axis);
    for ((position, z), _) in vertices {
        if let Some(&(height, _)) = height.get(&bits(*position)) {
            *z = height;
        }
    }
}

/// The heights of those vertices of lines that are wanted, and how sure they are, by their places from an origin.
pub(super) fn heights_by_place<'a>(
    lines: impl Iterator<Item = KnownLine<'a>>,
    origin: DVec2,
    is_wanted: impl Fn(Sure) -> bool,
) -> HashMap<[u64; 2], (f64, Sure)> {
    let wanted = lines.flat_map(KnownLine::vertices).filter(|(_, sure)| is_wanted(*sure));
    wanted.map(|(p, sure)| (bits(p.truncate() - origin), (p.z, sure))).collect()
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
