//! Keeps the outline of the frame when points are added to the triangulation.
//!
//! The flat triangles along the outer border lie outside the frame. A finer triangulation has other triangles there,
//! and some are not as flat. They would join sub-domains that were separate. So the outline's edges go into the finer
//! triangulation, and what lies beyond them stays outside.

use rayon::prelude::*;

use crate::tin::{CONSTRAINT, CONTOUR, NONE, Tin};

/// The edges with a triangle in the frame on the left and one outside it on the right.
#[derive(Debug, Clone)]
pub struct Outline {
    /// The edges, as pairs of vertices, ascending; and whether the edge is a constraint anyway.
    edges: Vec<([u32; 2], bool)>,
    /// Whether any triangle lies in the frame.
    has_inside: bool,
}

impl Outline {
    /// Takes the outline of a triangulation.
    pub fn new(tin: &Tin) -> Self {
        let inside = (0..tin.len() as u32).into_par_iter().filter(|&t| tin.is_inside(t));
        let ends_at = |t: u32, i: usize| tin.neighbours[t as usize][i] != NONE && tin.inner_neighbour(t, i).is_none();
        let of_triangle = |t: u32| (0..3).filter(move |&i| ends_at(t, i)).map(move |i| (t, i));
        let mut edges: Vec<_> =
            inside.flat_map_iter(of_triangle).map(|(t, i)| (tin.edge(t, i), tin.is_constraint(t, i))).collect();
        edges.par_sort_unstable();
        Self { edges, has_inside: tin.inside.contains(&true) }
    }

    /// The edges that a finer triangulation holds only if they are added to it.
    pub fn loose_edges(&self) -> impl Iterator<Item = [u32; 2]> {
        self.edges.iter().filter(|(_, is_constraint)| !is_constraint).map(|(edge, _)| *edge)
    }

    /// The frame of a finer triangulation that holds these edges. Vertices have the same numbers in both.
    ///
    /// Edges that were added only for the outline are no constraints afterwards. Between two vertices of one contour
    /// such a constraint would count as a piece of the contour.
    pub fn applied(&self, mut tin: Tin) -> Tin {
        tin.inside.fill(self.has_inside);
        let Tin { triangles, edges, inside, .. } = &mut tin;
        let all = triangles.par_iter().zip(edges).zip(inside).enumerate();
        let beyond = all.filter_map(|(t, ((corners, edges), inside))| {
            let mut is_beyond = false;
            for i in 0..3 {
                let Some((is_left, is_constraint)) = self.side([corners[i], corners[(i + 1) % 3]]) else { continue };
                if !is_constraint {
                    *edges &= !((CONSTRAINT | CONTOUR) << i);
                }
                is_beyond |= !is_left;
            }
            (is_beyond && std::mem::replace(inside, false)).then_some(t as u32)
        });
        let mut outside: Vec<u32> = beyond.collect();
        while let Some(t) = outside.pop() {
            for i in 0..3 {
                let n = tin.neighbours[t as usize][i];
                let goes_on = n != NONE && self.side(tin.edge(t, i)).is_none();
                if goes_on && std::mem::replace(&mut tin.inside[n as usize], false) {
                    outside.push(n);
                }
            }
        }
        tin
    }

    /// For an edge of the outline: whether the frame is on its left, and whether it is a constraint anyway.
    fn side(&self, [u, v]: [u32; 2]) -> Option<(bool, bool)> {
        let find = |edge: [u32; 2]| Some(self.edges[self.edges.binary_search_by(|(e, _)| e.cmp(&edge)).ok()?].1);
        find([u, v]).map(|is_constraint| (true, is_constraint)).or_else(|| Some((false, find([v, u])?)))
    }
}

#[cfg(test)]
mod tests {
    use glam::DVec2;

    use super::*;
    use crate::tin::{TinInput, VertexKind, triangulate};

    /// A square whose lower side is not quite straight, without the triangle below it.
    fn input() -> TinInput {
        let mut input = TinInput::new([DVec2::ZERO, DVec2::splat(10.0)], 1e-6);
        for p in [(0.0, 0.0), (5.0, 1e-8), (10.0, 0.0), (10.0, 10.0), (0.0, 10.0)] {
            input.push(p.into(), 1.0, VertexKind::Contour);
        }
        input
    }

    #[test]
    fn the_frame_of_a_finer_triangulation_ends_where_it_ended() {
        let coarse = triangulate(input()).unwrap();
        let outline = Outline::new(&coarse);
        assert_eq!(outline.loose_edges().count(), 2);
        let mut finer = input();
        outline.loose_edges().for_each(|[u, v]| finer.push_edge(u, v));
        // The triangle between this vertex and the side is as flat as the one below.
        finer.push(DVec2::new(2.5, 6e-9), 2.0, VertexKind::Axis);
        let finer = outline.applied(triangulate(finer).unwrap());
        let outside: Vec<u32> = (0..finer.len() as u32).filter(|&t| !finer.is_inside(t)).collect();
        assert_eq!(outside.len(), 1);
        assert_eq!(finer.triangles[outside[0] as usize].iter().sum::<u32>(), 3, "the corners 0, 1 and 2");
        assert!((0..finer.len() as u32).all(|t| (0..3).all(|i| !finer.is_constraint(t, i))));
    }
}
