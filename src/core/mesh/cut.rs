//! A triangulation cut at the border of an area.

use std::collections::HashMap;

use geo::{MultiPolygon, Translate};
use glam::DVec2;
use rstar::primitives::Line;
use rstar::{AABB, RTree};

use crate::base::bits::bits;
use crate::base::error::Result;
use crate::geometry::{Border, Meeting, Segment, meeting, place};
use crate::tin::{NONE, Tin, TinInput, VertexKind, triangulate};

/// The triangles of `tin` inside an area, in map coordinates. A triangle on the border is divided along it. New vertices
/// lie on the triangle, so the ground does not change.
pub(super) fn cut(tin: &Tin, area: &MultiPolygon<f64>) -> Result<Tin> {
    let area = area.translate(-tin.origin.x, -tin.origin.y);
    let border = Border::new(&area);
    let line = |edge: &Segment| Line::new(edge.a.to_array(), edge.b.to_array());
    let edges = RTree::bulk_load(border.edges().iter().map(line).collect());
    let reach = border.tolerance();
    let mut parts = Parts { tin, vertices: HashMap::new(), cut: Tin { origin: tin.origin, ..Tin::default() } };
    for t in (0..tin.len() as u32).filter(|&t| tin.is_inside(t)) {
        let corners = tin.corners(t);
        let (lo, hi) = (corners[0].min(corners[1]).min(corners[2]), corners[0].max(corners[1]).max(corners[2]));
        let around = AABB::from_corners((lo - reach).to_array(), (hi + reach).to_array());
        let near = edges.locate_in_envelope_intersecting(&around);
        let near: Vec<Segment> = near.map(|edge| Segment { a: edge.from.into(), b: edge.to.into() }).collect();
        if near.is_empty() {
            if border.contains((corners[0] + corners[1] + corners[2]) / 3.0) {
                parts.push(t, corners, [Some(0), Some(1), Some(2)]);
            }
            continue;
        }
        for (piece, sides) in divided(corners, &near)? {
            if border.contains((piece[0] + piece[1] + piece[2]) / 3.0) {
                parts.push(t, piece, sides);
            }
        }
    }
    Ok(parts.joined())
}

/// A piece of a triangle, and the sides of the triangle that its edges lie on.
type Piece = ([DVec2; 3], [Option<usize>; 3]);

/// The pieces of a triangle that edges divide.
fn divided(corners: [DVec2; 3], edges: &[Segment]) -> Result<Vec<Piece>> {
    let sides = [0, 1, 2].map(|i| {
        // Both triangles at a side compute the same crossings.
        let (a, b) = (corners[i], corners[(i + 1) % 3]);
        if bits(a) <= bits(b) { Segment { a, b } } else { Segment { a: b, b: a } }
    });
    let inside = |p: DVec2| (0..3).all(|i| (corners[(i + 1) % 3] - corners[i]).perp_dot(p - corners[i]) >= 0.0);
    let mut input =
        TinInput::new([corners[0].min(corners[1]).min(corners[2]), corners[0].max(corners[1]).max(corners[2])], -1.0);
    let mut points: Vec<DVec2> = Vec::new();
    let mut push = |p: DVec2| {
        points.push(p);
        input.push(p, 0.0, VertexKind::Axis)
    };
    let numbers = corners.map(&mut push);
    let mut on_side: [Vec<(f64, u32)>; 3] = Default::default();
    let mut along = Vec::new();
    for edge in edges {
        let length = edge.b - edge.a;
        let mut on_edge: Vec<(f64, u32)> = Vec::new();
        for (side, met) in sides.iter().zip(&mut on_side) {
            if meeting(side, edge) == Meeting::Cross {
                let p = place(side, edge);
                let number = push(p);
                on_edge.push(((p - edge.a).dot(length), number));
                met.push(((p - side.a).dot(side.b - side.a), number));
            }
        }
        for p in [edge.a, edge.b].into_iter().filter(|p| inside(*p)) {
            on_edge.push(((p - edge.a).dot(length), push(p)));
        }
        // A side that ends on the edge divides the triangle there too.
        for (corner, number) in corners.iter().zip(numbers) {
            let share = (*corner - edge.a).dot(length);
            if length.perp_dot(*corner - edge.a) == 0.0 && (0.0..=length.length_squared()).contains(&share) {
                on_edge.push((share, number));
            }
        }
        on_edge.sort_by(|a, b| a.0.total_cmp(&b.0));
        along.extend(on_edge.windows(2).map(|w| [w[0].1, w[1].1]));
    }
    // The sides that points lie on, as bits.
    let mut on_sides: HashMap<u32, u8> = HashMap::new();
    for (i, mut met) in on_side.into_iter().enumerate() {
        let side = &sides[i];
        let on = met.iter().map(|m| m.1).chain([numbers[i], numbers[(i + 1) % 3]]);
        on.for_each(|number| *on_sides.entry(number).or_default() |= 1 << i);
        let ends = [numbers[i], numbers[(i + 1) % 3]];
        let [first, last] = if side.a == corners[i] { ends } else { [ends[1], ends[0]] };
        met.sort_by(|a, b| a.0.total_cmp(&b.0));
        let chain: Vec<u32> = std::iter::once(first).chain(met.iter().map(|m| m.1)).chain([last]).collect();
        chain.windows(2).for_each(|w| input.push_loose_edge(w[0], w[1]));
    }
    along.into_iter().for_each(|[a, b]| input.push_loose_edge(a, b));
    let pieces = triangulate(input)?;
    let corner = |v: u32| points[pieces.source[v as usize] as usize];
    // Crossings lie beside their side by a rounding error. Slivers between them and the side are no ground.
    let sides_of = |v: u32| on_sides.get(&pieces.source[v as usize]).copied().unwrap_or(0);
    let is_sliver = |triangle: &[u32; 3]| triangle.iter().fold(7, |sides, v| sides & sides_of(*v)) != 0;
    let ground = pieces.triangles.iter().filter(|triangle| !is_sliver(triangle));
    let side = |u: u32, v: u32| (0..3).find(|i| sides_of(u) & sides_of(v) & (1 << i) != 0);
    let sides = |[a, b, c]: [u32; 3]| [side(a, b), side(b, c), side(c, a)];
    Ok(ground.map(|triangle| (triangle.map(corner), sides(*triangle))).collect())
}

/// The triangles of the cut triangulation, up to now.
struct Parts<'a> {
    tin: &'a Tin,
    vertices: HashMap<[u64; 2], u32>,
    cut: Tin,
}

impl Parts<'_> {
    /// Adds a piece of triangle `t`. An edge that lies on a side of the triangle is what the side is.
    fn push(&mut self, t: u32, piece: [DVec2; 3], sides: [Option<usize>; 3]) {
        let corners = self.tin.corners(t);
        let heights = self.tin.corner_heights(t);
        let cut = &mut self.cut;
        let vertex = |p: DVec2| {
            *self.vertices.entry(bits(p)).or_insert_with(|| {
                cut.positions.push(p);
                cut.heights.push(height(corners, heights, p));
                cut.positions.len() as u32 - 1
            })
        };
        let triangle = piece.map(vertex);
        cut.triangles.push(triangle);
        let flags = sides.map(|side| side.map_or(0, |side| self.tin.edge_flags(t, side)));
        cut.edges.push(flags[0] | flags[1] << 1 | flags[2] << 2);
    }

    /// The triangulation, with the neighbours of its triangles.
    fn joined(self) -> Tin {
        let mut cut = self.cut;
        let sides: HashMap<[u32; 2], u32> = (0u32..)
            .zip(&cut.triangles)
            .flat_map(|(t, [a, b, c])| [([*a, *b], t), ([*b, *c], t), ([*c, *a], t)])
            .collect();
        let beyond = |a: u32, b: u32| sides.get(&[b, a]).copied().unwrap_or(NONE);
        cut.neighbours = cut.triangles.iter().map(|&[a, b, c]| [beyond(a, b), beyond(b, c), beyond(c, a)]).collect();
        cut.inside = vec![true; cut.triangles.len()];
        cut
    }
}

/// The height of a triangle at a place. Corners have their own height.
fn height(corners: [DVec2; 3], heights: [f64; 3], p: DVec2) -> f64 {
    if let Some(corner) = corners.iter().position(|corner| *corner == p) {
        return heights[corner];
    }
    let [a, b, c] = corners;
    let whole = (b - a).perp_dot(c - a);
    let [u, v] = [(b - p).perp_dot(c - p) / whole, (c - p).perp_dot(a - p) / whole];
    u * heights[0] + v * heights[1] + (1.0 - u - v) * heights[2]
}

#[cfg(test)]
mod tests {
    use geo::{Area, polygon};

    use super::*;

    #[test]
    fn a_plane_that_is_cut_keeps_its_heights_and_has_the_area_of_the_part() {
        let side = 10;
        let mut input = TinInput::new([DVec2::splat(500.0), DVec2::splat(510.0)], 0.0);
        let plane = |p: DVec2| 3.0 * p.x - 2.0 * p.y;
        for n in 0..(side + 1) * (side + 1) {
            let p = DVec2::new(500.0 + f64::from(n % (side + 1)), 500.0 + f64::from(n / (side + 1)));
            input.push(p, plane(p), VertexKind::Axis);
        }
        let tin = triangulate(input).unwrap();
        // A star with corners on vertices, on sides and inside triangles, and a hole.
        let area: MultiPolygon<f64> = polygon!(
            exterior: [(x: 501.0, y: 501.0), (x: 505.0, y: 503.3), (x: 509.5, y: 500.5), (x: 507.1, y: 505.0), (x: 508.0, y: 509.0), (x: 504.4, y: 506.2)],
            interiors: [[(x: 504.2, y: 504.1), (x: 504.8, y: 504.9), (x: 505.3, y: 504.2)]],
        )
        .into();
        let cut = cut(&tin, &area).unwrap();
        let doubled = |t: u32| {
            let [a, b, c] = cut.corners(t);
            (b - a).perp_dot(c - a)
        };
        let found: f64 = (0..cut.len() as u32).map(doubled).sum::<f64>() / 2.0;
        assert!((found - area.unsigned_area()).abs() < 1e-9, "{found}");
        assert!((0..cut.len() as u32).all(|t| doubled(t) > 0.0));
        let is_right = |(p, z): (&DVec2, &f64)| (plane(*p + cut.origin) - z).abs() < 1e-9;
        assert!(cut.positions.iter().zip(&cut.heights).all(is_right));
        // Each side is that of two triangles, or lies on the border of the part.
        let border = Border::new(&area);
        let open = (0..cut.len() as u32).flat_map(|t| (0..3).map(move |i| (t, i)));
        let open = open.filter(|&(t, i)| cut.inner_neighbour(t, i).is_none());
        let mut count = 0;
        for (t, i) in open {
            let [u, v] = cut.edge(t, i).map(|v| cut.positions[v as usize] + cut.origin);
            assert!(border.edge_at(u.midpoint(v)).is_some(), "{u} {v}");
            count += 1;
        }
        assert!(count > 9);
    }
}
