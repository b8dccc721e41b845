//! Adds points to the sub-domains of a triangulation.
//!
//! Sub-domains are bounded by edges that remain edges, so each can be triangulated on its own. Neighbouring sub-domains
//! form parts. Parts are triangulated in parallel and then joined.

use std::collections::HashMap;
use std::ops::Range;

use glam::DVec2;
use rayon::prelude::*;

use super::build::faces;
use super::faces::Face;
use super::input::TinInput;
use super::network::{CONSTRAINT, NONE, Tin, VertexKind};
use crate::base::error::Result;
use crate::base::parallel;
use crate::base::rows::Rows;

/// A part with this many triangles and points is complete.
const PART: usize = 1 << 18;

/// A point to be added.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct InnerPoint {
    /// The sub-domain in which it lies. It lies off the edges, unless it splits one.
    pub region: u32,
    /// What it stands for.
    pub kind: VertexKind,
    /// Position relative to the origin.
    pub position: DVec2,
    /// Height, metres; NaN if it has none yet, as [`Tin::heights`] may be.
    pub height: f64,
}

/// An edge that is split by some of the points to be added.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct PartedEdge {
    /// Its ends. It is an edge that the triangulation must hold, inside one sub-domain or on the outer border.
    pub edge: [u32; 2],
    /// The points on it, by their numbers, from the first end to the second.
    pub points: Range<usize>,
}

impl Tin {
    /// The constrained Delaunay triangulation of the same vertices and edges, and of `points`, which come last. It
    /// holds the pieces of the `parted` edges. Triangles outside the frame stay as they are.
    ///
    /// `of_triangle` is the sub-domain of each triangle, [`NONE`] outside.
    ///
    /// # Errors
    /// As [`triangulate`](super::triangulate).
    pub fn refined(&self, of_triangle: &[u32], points: &[InnerPoint], parted: &[PartedEdge]) -> Result<Self> {
        self.refined_in_parts(of_triangle, (points, parted), PART)
    }

    fn refined_in_parts(
        &self,
        of_triangle: &[u32],
        (points, parted): (&[InnerPoint], &[PartedEdge]),
        enough: usize,
    ) -> Result<Self> {
        let parted = parted.iter().map(|parted| (sorted(parted.edge), parted));
        let parted: HashMap<[u32; 2], &PartedEdge> = parted.collect();
        let part_of_region = parts(self, of_triangle, points, enough);
        let part = |t: u32| part_of_region.get(of_triangle[t as usize] as usize).copied().unwrap_or(NONE);
        let count = part_of_region.iter().max().map_or(0, |&last| last as usize + 1);
        let own = |p: u32| (p != NONE).then_some(p as usize);
        let triangles = Rows::new(count, || (0..self.len() as u32).filter_map(|t| own(part(t)).map(|part| (part, t))));
        let inner = Rows::new(count, || {
            let each = points.iter().enumerate();
            each.map(|(k, point)| (part_of_region[point.region as usize] as usize, k as u32))
        });
        let each = parallel::map(count, |p| {
            let part = Part { tin: self, is_own: |t| part(t) == p as u32, triangles: triangles.of(p), parted: &parted };
            part.triangulated(inner.of(p), points)
        });
        let mut faces: Vec<Face> = Vec::with_capacity(self.len() + 2 * points.len());
        let mut open = Vec::new();
        for part in each {
            let part = part?;
            let first = faces.len() as u32;
            let numbered = |n: u32| if n == NONE { NONE } else { first + n };
            faces.extend(part.into_iter().map(|face| Face { beyond: face.beyond.map(numbered), ..face }));
        }
        for t in (0..self.len() as u32).filter(|&t| part(t) == NONE) {
            let inside = self.inside[t as usize];
            let (corners, edges) = (self.triangles[t as usize], self.edges[t as usize]);
            faces.push(Face { corners, beyond: [NONE; 3], edges, inside });
        }
        // A triangle without a neighbour in its own part has one in another part, or none.
        for (f, face) in faces.iter().enumerate() {
            for i in (0..3).filter(|&i| face.beyond[i] == NONE) {
                let [u, v] = face.edge(i);
                open.push(([u.min(v), u.max(v)], f as u32, i));
            }
        }
        open.par_sort_unstable();
        for pair in open.windows(2).filter(|pair| pair[0].0 == pair[1].0) {
            let [(_, f, i), (_, g, j)] = [pair[0], pair[1]];
            faces[f as usize].beyond[i] = g;
            faces[g as usize].beyond[j] = f;
        }
        let first = self.source.iter().max().map_or(0, |&last| last + 1);
        let mut refined = Self {
            origin: self.origin,
            positions: self.positions.iter().copied().chain(points.iter().map(|p| p.position)).collect(),
            heights: self.heights.iter().copied().chain(points.iter().map(|p| p.height)).collect(),
            kinds: self.kinds.iter().copied().chain(points.iter().map(|p| p.kind)).collect(),
            source: self.source.iter().copied().chain((first..).take(points.len())).collect(),
            ..Self::default()
        };
        refined.set_faces(faces);
        Ok(refined)
    }
}

fn sorted([u, v]: [u32; 2]) -> [u32; 2] {
    [u.min(v), u.max(v)]
}

/// Groups sub-domains into parts: neighbours together, until they have `enough` triangles and points. Returns the part
/// of each sub-domain.
fn parts(tin: &Tin, of_triangle: &[u32], points: &[InnerPoint], enough: usize) -> Vec<u32> {
    let count = of_triangle.iter().filter(|&&r| r != NONE).max().map_or(0, |&last| last as usize + 1);
    let mut size = vec![0; count];
    for &r in of_triangle.iter().filter(|&&r| r != NONE).chain(points.iter().map(|p| &p.region)) {
        size[r as usize] += 1;
    }
    let mut beside: Vec<(usize, u32)> = parallel::flat_map(tin.len(), |t| {
        let own = of_triangle[t];
        let others = tin.neighbours[t].into_iter().filter(move |&n| own != NONE && n != NONE);
        let others = others.map(|n| of_triangle[n as usize]);
        others.filter(move |&other| other != own && other != NONE).map(move |other| (own as usize, other))
    });
    beside.par_sort_unstable();
    beside.dedup();
    let beside = Rows::new(count, || beside.iter().copied());
    let mut part = vec![NONE; count];
    let (mut current, mut filled) = (0, 0);
    for first in 0..count {
        let mut queue = std::collections::VecDeque::from([first as u32]);
        while let Some(r) = queue.pop_front().map(|r| r as usize) {
            if part[r] != NONE {
                continue;
            }
            if filled >= enough {
                (current, filled) = (current + 1, 0);
            }
            part[r] = current;
            filled += size[r];
            queue.extend(beside.of(r).iter().filter(|&&other| part[other as usize] == NONE));
        }
    }
    part
}

/// Some sub-domains of a triangulation.
struct Part<'a, F> {
    tin: &'a Tin,
    is_own: F,
    triangles: &'a [u32],
    parted: &'a HashMap<[u32; 2], &'a PartedEdge>,
}

impl<F: Fn(u32) -> bool> Part<'_, F> {
    /// The part's triangles with the additional points: those of `points` with these numbers, ascending.
    ///
    /// Long because the local numbers of vertices and points, which all steps use, are closures here.
    fn triangulated(&self, numbers: &[u32], points: &[InnerPoint]) -> Result<Vec<Face>> {
        let tin = self.tin;
        let mut vertices: Vec<u32> = self.triangles.iter().flat_map(|&t| tin.triangles[t as usize]).collect();
        vertices.sort_unstable();
        vertices.dedup();
        let local = |v: u32| vertices.partition_point(|&w| w < v) as u32;
        let added = |k: usize| (vertices.len() + numbers.partition_point(|&n| (n as usize) < k)) as u32;
        let kept = vertices.iter().map(|&v| tin.positions[v as usize]);
        let mut input = TinInput::local(kept.chain(numbers.iter().map(|&k| points[k as usize].position)));
        // The outline with the part on its left, and whether each edge is a constraint.
        let mut outline: Vec<([u32; 2], bool)> = Vec::new();
        for &t in self.triangles {
            for i in 0..3 {
                let n = tin.neighbours[t as usize][i];
                let is_constraint = tin.is_constraint(t, i);
                let is_outline = n == NONE || !(self.is_own)(n);
                if !(is_outline || is_constraint && t < n) {
                    continue;
                }
                let edge = tin.edge(t, i);
                let [mut from, last] = edge.map(local);
                let mut hold = |to: u32| {
                    input.push_edge(from, to);
                    if is_outline {
                        outline.push(([from, to], is_constraint));
                    }
                    from = to;
                };
                if let Some(parted) = self.parted.get(&sorted(edge)) {
                    let between = parted.points.clone().map(added);
                    if parted.edge == edge { between.for_each(&mut hold) } else { between.rev().for_each(&mut hold) }
                }
                hold(last);
            }
        }
        let outline = Rows::new(vertices.len() + numbers.len(), || {
            outline.iter().map(|&([u, v], is_constraint)| (u as usize, (v, is_constraint)))
        });
        let on_outline = |[u, v]: [u32; 2]| {
            outline.of(u as usize).iter().find(|(to, _)| *to == v).map(|(_, is_constraint)| *is_constraint)
        };
        // The triangulation also fills the ground between the outline and its convex hull.
        let found = faces(&input)?;
        let is_border_of_filling = |face: &Face, i: usize| {
            let [u, v] = face.edge(i);
            face.is_constraint(i) && on_outline([v, u]).is_some()
        };
        let is_filling = |face: &Face| {
            let is_hull = |i: usize| face.beyond[i] == NONE && on_outline(face.edge(i)).is_none();
            (0..3).any(|i| is_hull(i) || is_border_of_filling(face, i))
        };
        let mut filling = vec![false; found.len()];
        let mut stack: Vec<usize> = (0..found.len()).filter(|&f| is_filling(&found[f])).collect();
        while let Some(f) = stack.pop() {
            if std::mem::replace(&mut filling[f], true) {
                continue;
            }
            let open = (0..3).filter(|&i| found[f].beyond[i] != NONE && !is_border_of_filling(&found[f], i));
            stack.extend(open.map(|i| found[f].beyond[i] as usize));
        }
        let mut number = vec![NONE; found.len()];
        for (own, f) in (0..found.len()).filter(|&f| !filling[f]).enumerate() {
            number[f] = own as u32;
        }
        let global = |v: u32| match vertices.get(v as usize) {
            Some(&v) => v,
            None => tin.positions.len() as u32 + numbers[v as usize - vertices.len()],
        };
        let face = |face: &Face| {
            let outlines = [0, 1, 2].map(|i| if face.is_constraint(i) { on_outline(face.edge(i)) } else { None });
            let flag = |i: usize| if outlines[i].unwrap_or(face.is_constraint(i)) { CONSTRAINT << i } else { 0 };
            let beyond = [0, 1, 2].map(|i| match (outlines[i], face.beyond[i]) {
                (None, n) if n != NONE => number[n as usize],
                _ => NONE,
            });
            Face { corners: face.corners.map(global), beyond, edges: flag(0) | flag(1) | flag(2), inside: true }
        };
        Ok((0..found.len()).filter(|&f| !filling[f]).map(|f| face(&found[f])).collect())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tin::triangulate;

    /// Nested squares, one per level, round a point in the middle; `open` of them end on the border of the largest.
    fn nested(open: usize) -> TinInput {
        let mut input = TinInput::new([DVec2::splat(-12.0), DVec2::splat(12.0)], 1e-9);
        let corner = |half: f64| [(-half, -half), (half, -half), (half, half), (-half, half)].map(DVec2::from);
        for (k, half) in [12.0, 9.5, 6.25, 3.125].into_iter().enumerate() {
            let mut ring = corner(half).to_vec();
            if k < open {
                ring = vec![
                    DVec2::new(-half, -12.0),
                    DVec2::new(-half, half),
                    DVec2::new(half, half),
                    DVec2::new(half, -12.0),
                ];
            } else {
                ring.push(ring[0]);
            }
            input.push_line(&ring, 10.0 * k as f64, VertexKind::Contour);
        }
        input
    }

    /// The number of the sub-domain of each triangle.
    fn numbered(tin: &Tin) -> Vec<u32> {
        let mut of_triangle = vec![NONE; tin.len()];
        let mut count = 0;
        for first in (0..tin.len() as u32).filter(|&t| tin.is_inside(t)) {
            if of_triangle[first as usize] != NONE {
                continue;
            }
            let mut stack = vec![first];
            while let Some(t) = stack.pop() {
                of_triangle[t as usize] = count;
                let beyond = (0..3).filter_map(|i| tin.across(t, i));
                stack.extend(beyond.filter(|&n| of_triangle[n as usize] == NONE));
            }
            count += 1;
        }
        of_triangle
    }

    #[test]
    fn parts_joined_are_the_triangulation_of_all() {
        for (open, enough) in [(0, 1), (0, 12), (0, 1000), (3, 1), (3, 30)] {
            let mut input = nested(open);
            let ends = [-5.0, 5.0].map(|y| input.push_local(DVec2::new(-8.0, y) - input.origin, 5.0, VertexKind::Axis));
            let mut with_edge = input.clone();
            with_edge.push_edge(ends[0], ends[1]);
            let tin = triangulate(&with_edge).unwrap();
            let of_triangle = numbered(&tin);
            let place = |k: u32, seed: f64| 23.9 * (f64::from(k) * seed).fract() - 11.95;
            let scattered = (1..200).map(|k| DVec2::new(place(k, 0.618_034), place(k, 0.754_878)));
            let between = [2.5, 0.0, -3.0].map(|y| DVec2::new(-8.0, y));
            // Between the ends of two lines on the frame.
            let on_frame = [-8.75, -8.0, -7.25].map(|x| DVec2::new(x, -12.0));
            let on_frame = &on_frame[..if open > 2 { 3 } else { 0 }];
            let points: Vec<InnerPoint> = between
                .into_iter()
                .chain(on_frame.iter().copied())
                .chain(scattered)
                .filter_map(|position| {
                    let position = position - tin.origin;
                    let t = tin.locate(0, position)?;
                    let region = of_triangle[t as usize];
                    (region != NONE).then_some(InnerPoint { region, kind: VertexKind::Axis, position, height: 5.0 })
                })
                .collect();
            assert!(points.len() > 100, "{open} {}", points.len());
            let vertex = |source: u32| tin.source.iter().position(|&s| s == source).unwrap() as u32;
            let mut parted = vec![PartedEdge { edge: [vertex(ends[1]), vertex(ends[0])], points: 0..between.len() }];
            if !on_frame.is_empty() {
                let at = |x: f64| tin.positions.iter().position(|p| *p + tin.origin == DVec2::new(x, -12.0)).unwrap();
                let edge = [at(-9.5) as u32, at(-6.25) as u32];
                parted.push(PartedEdge { edge, points: between.len()..between.len() + on_frame.len() });
            }
            let refined = tin.refined_in_parts(&of_triangle, (&points, &parted), enough).unwrap();
            refined.validate().unwrap();
            let added = points.iter().map(|p| input.push_local(p.position, p.height, VertexKind::Axis));
            let added: Vec<u32> = added.collect();
            let chain = [&[ends[1]], &added[..between.len()], &[ends[0]]].concat();
            chain.windows(2).for_each(|pair| input.push_edge(pair[0], pair[1]));
            let whole = triangulate(&input).unwrap();
            assert_eq!(refined.positions, whole.positions);
            assert_eq!(refined.kinds, whole.kinds);
            let sorted = |tin: &Tin| {
                let edges = (0..tin.len() as u32).flat_map(|t| (0..3).map(move |i| (t, i)));
                let beyond = |t: u32, i: usize| tin.neighbours[t as usize][i] == NONE;
                let mut edges: Vec<_> =
                    edges.map(|(t, i)| (tin.edge(t, i), tin.edges[t as usize] >> i & 0o111, beyond(t, i))).collect();
                edges.sort_unstable();
                edges
            };
            assert_eq!(sorted(&refined), sorted(&whole), "{open} {enough}");
        }
    }
}
