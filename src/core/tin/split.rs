//! Adds points on edges and in triangles by splitting triangles, without triangulating anew.
//!
//! Every old edge stays, whole or in pieces, so nothing moves outside the triangles that hold points. Each of these is
//! split on its own.

use glam::DVec2;
use rayon::prelude::*;

use super::network::{CONSTRAINT, EDGE_FLAGS, NONE, Tin, VertexKind};
use crate::base::parallel;
use crate::base::rows::Rows;

/// A point that splits an edge or a triangle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SplitPoint {
    /// The triangle that it lies in, or one of the two beside its edge.
    pub triangle: u32,
    /// The edge of the triangle that it splits; `None` for a point inside. No edge and no inside takes two points.
    pub edge: Option<u8>,
    /// Position relative to the origin.
    pub position: DVec2,
    /// Height, metres.
    pub height: f64,
}

/// A triangulation after splitting, and where its triangles lie.
#[derive(Debug, Clone)]
pub struct Split {
    /// The triangulation.
    pub tin: Tin,
    /// For each triangle, the one that it lies in.
    pub parents: Vec<u32>,
}

/// The most corners of a triangle with a point on each edge.
const MOST: usize = 6;

/// Triangles of one old triangle, with a bit for each edge that is a constraint.
type Parts = Vec<([u32; 3], u16)>;

impl Tin {
    /// The triangulation with `points` as vertices of the kind [`VertexKind::Axis`], which come last. The first of them
    /// stands for the input's point `first`. The `pieces` (of vertices, by number) that lie inside one triangle are edges of
    /// it, and constraints.
    pub fn split(&self, points: &[SplitPoint], pieces: &[[u32; 2]], first: u32) -> Split {
        let before = self.positions.len() as u32;
        let (on_edges, inside) = self.places(points);
        let ends = pieces.iter().flat_map(|&[u, v]| [[u, v], [v, u]]).filter(|[u, _]| *u >= before);
        let pieces = Rows::new(points.len(), || ends.clone().map(|[u, v]| ((u - before) as usize, v)));
        let is_piece = |u: u32, v: u32| {
            let [u, v] = [u.max(v), u.min(v)];
            u >= before && pieces.of((u - before) as usize).contains(&v)
        };
        let position = |v: u32| match v.checked_sub(before) {
            Some(k) => points[k as usize].position,
            None => self.positions[v as usize],
        };
        let parts_of = |t: usize| -> Parts {
            let outline = outline(self.triangles[t], on_edges[t]);
            match inside[t] {
                NONE => convex_parts(&outline, &position, &is_piece),
                centre => fan(centre, &outline, &is_piece),
            }
        };
        let is_whole = |t: usize| on_edges[t] == [NONE; 3] && inside[t] == NONE;
        let chunk = 1 << 14;
        let chunks = parallel::map(self.len().div_ceil(chunk), |k| {
            let (mut triangles, mut edges, mut parents) = (Vec::new(), Vec::new(), Vec::new());
            let mut add = |t: usize, (corners, constraints): ([u32; 3], u16)| {
                triangles.push(corners);
                edges.push(constraints);
                parents.push(t as u32);
            };
            for t in k * chunk..self.len().min((k + 1) * chunk) {
                match is_whole(t) {
                    true => add(t, (self.triangles[t], 0)),
                    false => parts_of(t).into_iter().for_each(|part| add(t, part)),
                }
            }
            (triangles, edges, parents)
        });
        let count = chunks.iter().map(|(triangles, ..)| triangles.len()).sum();
        let (mut triangles, mut parents) = (Vec::with_capacity(count), Vec::with_capacity(count));
        // At first, each has the bits of the pieces inside its parent.
        let mut edges: Vec<u16> = Vec::with_capacity(count);
        for (triangles_of_chunk, edges_of_chunk, parents_of_chunk) in chunks {
            triangles.extend(triangles_of_chunk);
            edges.extend(edges_of_chunk);
            parents.extend(parents_of_chunk);
        }
        let mut starts = vec![0_u32; self.len() + 1];
        parents.iter().for_each(|&t| starts[t as usize + 1] += 1);
        (0..self.len()).for_each(|t| starts[t + 1] += starts[t]);
        let with_edge = |parent: u32, [u, v]: [u32; 2]| {
            let own = starts[parent as usize]..starts[parent as usize + 1];
            own.into_iter().find(|&p| (0..3).any(|i| edge_of(triangles[p as usize], i) == [u, v])).unwrap_or(NONE)
        };
        let mut neighbours = vec![[NONE; 3]; count];
        neighbours.par_iter_mut().zip(&mut edges).enumerate().for_each(|(p, (beyond, flags))| {
            let (corners, parent) = (triangles[p], parents[p]);
            let constraints = std::mem::take(flags);
            *beyond = [0, 1, 2].map(|i| {
                let [u, v] = edge_of(corners, i);
                let Some(old) = self.edge_under([u, v], parent, &on_edges) else {
                    *flags |= if constraints >> i & 1 != 0 { CONSTRAINT << i } else { 0 };
                    return with_edge(parent, [v, u]);
                };
                *flags |= ((self.edges[parent as usize] >> old) & EDGE_FLAGS) << i;
                let n = self.neighbours[parent as usize][old];
                if n == NONE { NONE } else { with_edge(n, [v, u]) }
            });
        });
        drop(on_edges);
        let of_parent = |values: &[bool]| parents.iter().map(|&t| values[t as usize]).collect();
        let lakes = match self.lakes.is_empty() {
            true => Vec::new(),
            false => parents.iter().map(|&t| self.lakes[t as usize]).collect(),
        };
        let tin = Self {
            origin: self.origin,
            positions: self.positions.iter().copied().chain(points.iter().map(|p| p.position)).collect(),
            heights: self.heights.iter().copied().chain(points.iter().map(|p| p.height)).collect(),
            kinds: self.kinds.iter().copied().chain(points.iter().map(|_| VertexKind::Axis)).collect(),
            source: self.source.iter().copied().chain((first..).take(points.len())).collect(),
            triangles,
            neighbours,
            edges,
            inside: of_parent(&self.inside),
            lakes,
        };
        Split { tin, parents }
    }

    /// For each triangle, the vertices on its edges and the vertex inside, [`NONE`] where there is none.
    fn places(&self, points: &[SplitPoint]) -> (Vec<[u32; 3]>, Vec<u32>) {
        let (mut on_edges, mut inside) = (vec![[NONE; 3]; self.len()], vec![NONE; self.len()]);
        for (v, point) in (self.positions.len() as u32..).zip(points) {
            let t = point.triangle as usize;
            let Some(edge) = point.edge.map(usize::from) else {
                inside[t] = v;
                continue;
            };
            on_edges[t][edge] = v;
            let n = self.neighbours[t][edge];
            if n != NONE
                && let Some(back) = self.edge_towards(n, point.triangle)
            {
                on_edges[n as usize][back] = v;
            }
        }
        (on_edges, inside)
    }

    /// The edge of an old triangle that the edge from `u` to `v` is, or is a piece of.
    fn edge_under(&self, [u, v]: [u32; 2], parent: u32, on_edges: &[[u32; 3]]) -> Option<usize> {
        (0..3).find(|&i| {
            let [a, b] = self.edge(parent, i);
            let middle = on_edges[parent as usize][i];
            if middle == NONE { [u, v] == [a, b] } else { [u, v] == [a, middle] || [u, v] == [middle, b] }
        })
    }
}

fn edge_of(corners: [u32; 3], i: usize) -> [u32; 2] {
    [corners[i], corners[(i + 1) % 3]]
}

/// The corners of a triangle and the vertices on its edges, counter-clockwise, each with the edges that it lies on, a bit
/// each.
fn outline(corners: [u32; 3], on_edges: [u32; 3]) -> Vec<(u32, u8)> {
    let mut outline = Vec::with_capacity(MOST);
    for i in 0..3 {
        outline.push((corners[i], 1 << i | 1 << ((i + 2) % 3)));
        if on_edges[i] != NONE {
            outline.push((on_edges[i], 1 << i));
        }
    }
    outline
}

/// The triangles from a point inside to all pieces of an outline.
fn fan(centre: u32, outline: &[(u32, u8)], is_piece: &impl Fn(u32, u32) -> bool) -> Parts {
    let next = outline.iter().cycle().skip(1);
    let triangle = |(&(u, _), &(v, _)): (&(u32, u8), &(u32, u8))| {
        ([u, v, centre], u16::from(is_piece(v, centre)) << 1 | u16::from(is_piece(centre, u)) << 2)
    };
    outline.iter().zip(next).map(triangle).collect()
}

/// The triangles of an outline without a point inside: cut along pieces, then along the shortest diagonals.
fn convex_parts(
    outline: &[(u32, u8)],
    position: &impl Fn(u32) -> DVec2,
    is_piece: &impl Fn(u32, u32) -> bool,
) -> Parts {
    let count = outline.len();
    if count == 3 {
        let corners = [outline[0].0, outline[1].0, outline[2].0];
        let flag = |i: usize| {
            let [u, v] = edge_of(corners, i);
            u16::from(is_piece(u, v)) << i
        };
        return vec![(corners, flag(0) | flag(1) | flag(2))];
    }
    let pairs = (0..count).flat_map(|a| (a + 2..count).map(move |b| (a, b)));
    // Neighbours on the outline, and vertices of one edge, are no diagonals.
    let diagonals = pairs.filter(|&(a, b)| (a, b) != (0, count - 1) && outline[a].1 & outline[b].1 == 0);
    let rank = |&(a, b): &(usize, usize)| {
        let [u, v] = [outline[a].0, outline[b].0];
        (!is_piece(u, v), position(u).distance_squared(position(v)))
    };
    let shortest = diagonals.min_by(|a, b| {
        let (a, b) = (rank(a), rank(b));
        a.0.cmp(&b.0).then(a.1.total_cmp(&b.1))
    });
    let Some((a, b)) = shortest else { return Vec::new() };
    let between = &outline[a..=b];
    let around = [&outline[b..], &outline[..=a]].concat();
    [convex_parts(between, position, is_piece), convex_parts(&around, position, is_piece)].concat()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tin::{TinInput, triangulate};

    /// A triangulation of scattered points, with one line in it.
    fn scattered() -> Tin {
        let mut input = TinInput::new([DVec2::splat(-1.0), DVec2::splat(11.0)], 0.0);
        let place = |k: u32, seed: f64| 10.0 * (f64::from(k) * seed).fract();
        for k in 1..80 {
            input.push(DVec2::new(place(k, 0.618_034), place(k, 0.754_878)), 10.0, VertexKind::Contour);
        }
        triangulate(input).unwrap()
    }

    /// A point on every inner edge whose number this takes, and in every triangle whose number it takes.
    fn points(tin: &Tin, takes: impl Fn(usize) -> bool) -> Vec<SplitPoint> {
        let mut points = Vec::new();
        for t in 0..tin.len() as u32 {
            for i in 0..3 {
                let n = tin.neighbours[t as usize][i];
                if n != NONE && t < n && takes(points.len() + t as usize) {
                    let [u, v] = tin.edge(t, i).map(|v| tin.positions[v as usize]);
                    let position = u.midpoint(v);
                    points.push(SplitPoint { triangle: t, edge: Some(i as u8), position, height: 12.0 });
                }
            }
            if takes(t as usize / 2) {
                let [a, b, c] = tin.corners(t);
                let position = (a + b + c) / 3.0;
                points.push(SplitPoint { triangle: t, edge: None, position, height: 13.0 });
            }
        }
        points
    }

    #[test]
    fn split_triangles_fit_together_and_lie_in_their_own() {
        let tin = scattered();
        let choices: [fn(usize) -> bool; 4] = [|_| false, |k| k % 3 == 0, |k| k % 3 > 0, |_| true];
        for (k, takes) in choices.into_iter().enumerate() {
            let points = points(&tin, takes);
            assert!(k == 0 || points.len() > 100, "{k}");
            let Split { tin: finer, parents } = tin.split(&points, &[], 79);
            finer.validate().unwrap();
            assert_eq!(finer.len(), tin.len() + 2 * points.len());
            assert_eq!(finer.positions.len(), tin.positions.len() + points.len());
            let area = |tin: &Tin, t: u32| {
                let [a, b, c] = tin.corners(t);
                (b - a).perp_dot(c - a)
            };
            let mut left: Vec<f64> = (0..tin.len() as u32).map(|t| area(&tin, t)).collect();
            for (t, &parent) in parents.iter().enumerate() {
                assert!(area(&finer, t as u32) > 0.0);
                left[parent as usize] -= area(&finer, t as u32);
            }
            assert!(left.iter().all(|left| left.abs() < 1e-9));
        }
    }

    #[test]
    fn pieces_inside_triangles_become_edges() {
        let tin = scattered();
        let points = points(&tin, |k| k % 4 > 0);
        let (on_edges, inside) = tin.places(&points);
        let mut pieces = Vec::new();
        for t in 0..tin.len() {
            match (on_edges[t], inside[t]) {
                ([a, b, _], NONE) if a != NONE && b != NONE => pieces.push([a, b]),
                // From a point on an edge to the corner opposite.
                ([a, NONE, NONE], NONE) if a != NONE => pieces.push([a, tin.triangles[t][2]]),
                ([a, _, _], centre) if a != NONE && centre != NONE => pieces.push([a, centre]),
                _ => {}
            }
        }
        assert!(pieces.len() > 50);
        let Split { tin: finer, .. } = tin.split(&points, &pieces, 79);
        finer.validate().unwrap();
        let edges = (0..finer.len() as u32).flat_map(|t| (0..3).map(move |i| (t, i)));
        let mut held: Vec<[u32; 2]> =
            edges.filter(|&(t, i)| finer.is_constraint(t, i)).map(|(t, i)| finer.edge(t, i)).collect();
        held.sort_unstable();
        let mut wanted: Vec<[u32; 2]> = pieces.iter().flat_map(|&[u, v]| [[u, v], [v, u]]).collect();
        wanted.sort_unstable();
        assert_eq!(held, wanted);
    }
}
