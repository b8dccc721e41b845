//! Points that divide long pieces of ridge and canyon lines, and long edges of the frame.
//!
//! A piece is an edge of the triangulation and straight. Where contours are far apart, it is longer than the spacing of
//! the nodes. The surface beside it is not straight. A new contour would run along such an edge and back on its other
//! side, as a needle.
//!
//! An edge of the frame runs from the end of one contour to the end of the next. The ground would fall from the surface
//! to this edge as a cliff.

use std::collections::HashMap;
use std::ops::Range;

use glam::DVec2;
use robust::{Coord, orient2d};

use super::smooth_height::smooth_height;
use crate::skeleton::{Axis, AxisPoint, End, narrow};
use crate::spline::WorkingGrids;
use crate::subdivision::Subdivision;
use crate::tin::{InnerPoint, NONE, PartedEdge, Tin, VertexKind};

/// Rounding moves a point between two others off their line by at most this many units in the last place.
const MOST_STEPS: usize = 4;

/// An edge of the triangulation that is divided, and the axis points on it, from its first end to its second.
pub(crate) struct PartedPiece {
    pub edge: [u32; 2],
    pub points: Range<usize>,
}

/// Divides long pieces of `axis` that are edges of `subdivision`. The parts are at least `spacing` long, map units. The
/// new points are added to `axis`, and their heights on the smooth surface to `heights`.
///
/// `vertices` are the vertices of the axis points.
pub(crate) fn part_long_pieces(
    subdivision: &Subdivision,
    axis: &mut Axis,
    (vertices, heights): (&[u32], &mut Vec<f64>),
    working: &WorkingGrids,
    spacing: f64,
) -> Vec<PartedPiece> {
    let tin = &subdivision.tin;
    let narrow = narrow(tin);
    let mut long: HashMap<[u32; 2], [u32; 2]> = HashMap::new();
    for t in (0..tin.len() as u32).filter(|&t| tin.is_inside(t)) {
        for i in (0..3).filter(|&i| tin.is_constraint(t, i) && tin.edge_length(t, i) >= 2.0 * spacing) {
            if let Some(n) = tin.across(t, i) {
                let [u, v] = tin.edge(t, i);
                long.entry([u.min(v), u.max(v)]).or_insert([t, n]);
            }
        }
    }
    let mut parted = Vec::new();
    let mut pieces = Vec::with_capacity(axis.pieces.len());
    for &piece in &axis.pieces {
        let edge = piece.map(|end| match end {
            End::Axis(p) => vertices[p as usize],
            End::Vertex(v) => v,
        });
        let [u, v] = edge.map(|v| v as usize);
        let ([End::Axis(first), _], Some(sides)) = (piece, long.get(&[edge[0].min(edge[1]), edge[0].max(edge[1])]))
        else {
            pieces.push(piece);
            continue;
        };
        let width = sides.map(|t| tin.width(t)).into_iter().fold(f64::INFINITY, f64::min);
        let parts = parts(tin.positions[u].distance(tin.positions[v]), spacing, width / narrow);
        let level = axis.points[first as usize].level;
        let from = axis.points.len();
        for part in 1..parts {
            let share = part as f64 / parts as f64;
            let position = tin.positions[u].lerp(tin.positions[v], share);
            let before = tin.heights[u] + share * (tin.heights[v] - tin.heights[u]);
            let height = smooth_height(working, position + tin.origin, before, contour_distance(tin, sides, position));
            let (triangle, region) = (sides[0], subdivision.regions.of_triangle[sides[0] as usize]);
            axis.points.push(AxisPoint { position, level, triangle, region });
            heights.push(subdivision.regions.regions[region as usize].band.strictly_inside(height));
        }
        let points = from..axis.points.len();
        let between = points.clone().map(|p| End::Axis(p as u32));
        let ends: Vec<End> = std::iter::once(piece[0]).chain(between).chain([piece[1]]).collect();
        pieces.extend(ends.windows(2).map(|pair| [pair[0], pair[1]]));
        parted.push(PartedPiece { edge, points });
    }
    axis.pieces = pieces;
    parted
}

/// Divides long edges of `subdivision` at the outer border that are no contours. The parts are at least `spacing` long,
/// map units. The new points are added to `points`. Like corners of the frame, they have no heights yet.
///
/// Edges with a triangle beyond them are not divided. They occur where a polygon is not convex, and where contours end
/// beside a straight border.
pub(crate) fn part_long_borders(
    subdivision: &Subdivision,
    spacing: f64,
    points: &mut Vec<InnerPoint>,
) -> Vec<PartedEdge> {
    let tin = &subdivision.tin;
    let narrow = narrow(tin);
    let mut parted = Vec::new();
    for t in (0..tin.len() as u32).filter(|&t| tin.is_inside(t)) {
        let region = subdivision.regions.of_triangle[t as usize];
        let is_dry = subdivision.regions.region(t).is_some_and(|r| r.water.is_none());
        let is_border = |i: &usize| tin.neighbours[t as usize][*i] == NONE && tin.contour_level(t, *i).is_none();
        for i in (0..3).filter(|i| is_dry && is_border(i) && tin.edge_length(t, *i) >= 2.0 * spacing) {
            let edge = tin.edge(t, i);
            let [u, v] = edge.map(|v| tin.positions[v as usize]);
            let parts = parts(tin.edge_length(t, i), spacing, tin.width(t) / narrow);
            let first = points.len();
            points.extend((1..parts).map(|part| {
                let position = not_left_of(u, v, u.lerp(v, part as f64 / parts as f64));
                InnerPoint { region, kind: VertexKind::Frame, position, height: f64::NAN }
            }));
            parted.push(PartedEdge { edge, points: first..points.len() });
        }
    }
    parted
}

/// Moves a point between `u` and `v` back if rounding has put it to the left of them. So a point on the border of the
/// frame stays in the frame.
fn not_left_of(u: DVec2, v: DVec2, mut place: DVec2) -> DVec2 {
    let coord = |p: DVec2| Coord { x: p.x, y: p.y };
    let step = -(v - u).perp().normalize_or_zero() * f64::EPSILON * u.abs().max(v.abs()).max_element();
    for _ in 0..MOST_STEPS {
        if orient2d(coord(u), coord(v), coord(place)) <= 0.0 {
            break;
        }
        place += step;
    }
    place
}

/// The number of parts of `spacing` or more that an edge is divided into, at most `most`. By rounding, points may lie
/// beside the edge; they must not come near another edge.
fn parts(length: f64, spacing: f64, most: f64) -> usize {
    (length / spacing).min(most) as usize
}

/// Distance from a position to the nearest corner of two triangles that lies on a contour.
fn contour_distance(tin: &Tin, triangles: &[u32; 2], position: DVec2) -> f64 {
    let corners = triangles.iter().flat_map(|&t| tin.triangles[t as usize]);
    let on_contours = corners.filter(|&v| tin.kinds[v as usize] == VertexKind::Contour);
    on_contours.map(|v| position.distance(tin.positions[v as usize])).fold(f64::INFINITY, f64::min)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn places_on_the_border_are_not_left_of_it() {
        let coord = |p: DVec2| Coord { x: p.x, y: p.y };
        let mut moved = 0;
        for k in 1..2000 {
            let at = |seed: f64| 1e4 * (f64::from(k) * seed).fract() - 5e3;
            let (u, v) = (DVec2::new(at(0.618_034), at(0.754_878)), DVec2::new(at(0.569_840), at(0.414_214)));
            let straight = u.lerp(v, f64::from(k % 7 + 1) / 9.0);
            let place = not_left_of(u, v, straight);
            assert!(orient2d(coord(u), coord(v), coord(place)) <= 0.0, "{u} {v} {place}");
            assert!(place.distance(straight) < 1e-11, "{u} {v} {place}");
            moved += usize::from(place != straight);
        }
        assert!(moved > 500, "{moved}");
    }
}
