//! Streams and break lines in the triangulation: their vertices and the edges between them.

use foldhash::{HashMap, HashMapExt};
use glam::{DVec2, DVec3};

use crate::base::bits::bits;
use crate::base::{KnownLine, Sure, parallel};
use crate::tin::{NONE, Tin, TinInput, VertexKind};

/// A point nearer to the edge of a sub-domain than this share of the edge's length is no vertex of a line.
const CLEARANCE: f64 = 1e-6;
/// Lines per parallel task. The search for the first triangle starts anew with each task.
const CHUNK: usize = 64;

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
    let on_contour = |position: DVec2| known.get(&bits(position)).copied().filter(|&v| v != NONE);
    let chunks: Vec<&[KnownLine<'_>]> = lines.chunks(CHUNK).collect();
    let may_be_new: Vec<Vec<bool>> = parallel::flat_map_each(&chunks, |lines| {
        let mut near = 0;
        let mut may_be_new = |(p, sure): (DVec3, Sure)| {
            let position = p.truncate() - tin.origin;
            sure < Sure::Exact && on_contour(position).is_none() && is_clear(tin, &mut near, position)
        };
        lines.iter().map(|line| line.vertices().map(&mut may_be_new).collect()).collect::<Vec<_>>()
    });
    for (line, may_be_new) in lines.iter().zip(may_be_new) {
        let mut before: Option<u32> = None;
        for ((p, _), may_be_new) in line.vertices().zip(may_be_new) {
            let position = p.truncate() - tin.origin;
            let new = || may_be_new.then(|| input.push_local(position, p.z, VertexKind::Axis));
            let vertex = on_contour(position).or_else(new);
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

/// Whether a position lies in a triangle inside the frame, and clear of edges that borders run along.
fn is_clear(tin: &Tin, near: &mut u32, position: DVec2) -> bool {
    let t = match tin.walk(*near, position) {
        Ok(t) => t,
        Err(left) => {
            *near = left;
            return false;
        }
    };
    *near = t;
    let corners = tin.corners(t);
    let is_clear = |i: usize| {
        let (a, b) = (corners[i], corners[(i + 1) % 3]);
        tin.across(t, i).is_some() || (b - a).perp_dot(position - a) > CLEARANCE * (b - a).length_squared()
    };
    tin.is_inside(t) && (0..3).all(is_clear)
}
