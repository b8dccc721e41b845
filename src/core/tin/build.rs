//! Builds a [`Tin`], the constrained Delaunay triangulation of points and edges.

use std::borrow::Borrow;

use glam::DVec2;
use rayon::prelude::*;

use super::blocks::{BLOCK, in_blocks};
use super::faces::{Face, conflicts, faces_between, with_loose};
use super::input::TinInput;
use super::network::{NONE, Tin};
use crate::base::error::{Error, Result};
use crate::base::parallel;
use crate::geometry::Segment;

impl Tin {
    /// Takes these triangles. They are numbered along the contours, as the vertices are. So work that goes from
    /// triangle to triangle finds its data close together in memory.
    pub(super) fn set_faces(&mut self, faces: Vec<Face>) {
        // A counting sort by least corner. Triangles with the same one keep their order.
        let least: Vec<u32> = parallel::values_each(&faces, |face| face.corners.into_iter().fold(NONE, u32::min));
        let mut next = vec![0; self.positions.len() + 1];
        least.iter().for_each(|&v| next[v as usize + 1] += 1);
        (0..self.positions.len()).for_each(|v| next[v + 1] += next[v]);
        let mut order = vec![0; faces.len()];
        let mut number = vec![0; faces.len()];
        for (f, v) in least.into_iter().enumerate() {
            let t = &mut next[v as usize];
            (number[f], order[*t as usize]) = (*t, f as u32);
            *t += 1;
        }
        let numbered = |f: u32| if f == NONE { NONE } else { number[f as usize] };
        let count = faces.len();
        (self.triangles, self.neighbours) = (vec![[NONE; 3]; count], vec![[NONE; 3]; count]);
        (self.edges, self.inside) = (vec![0; count], vec![false; count]);
        let of_vertices = self.triangles.par_iter_mut().zip(&mut self.neighbours);
        let of_flags = self.edges.par_iter_mut().zip(&mut self.inside);
        // One pass, because each looks faces up all over memory.
        of_vertices.zip(of_flags).zip(&order).for_each(|(((corners, beyond), (edges, inside)), &f)| {
            let face = faces[f as usize];
            (*corners, *beyond) = (face.corners, face.beyond.map(numbered));
            (*edges, *inside) = (face.edges, face.inside);
        });
        drop((faces, order, number));
        self.edges = parallel::values(self.len(), |t| self.with_contours(t as u32));
    }
}

/// Triangulates points and edges.
///
/// # Errors
/// When a coordinate is out of range, when edges cross, or when all points lie on one line.
pub fn triangulate(input: impl Borrow<TinInput>) -> Result<Tin> {
    let input = input.borrow();
    let (source, vertex_of) = merge_equal_positions(&input.positions);
    let [edges, loose] = [&input.edges, &input.loose].map(|edges| between_vertices(edges, &vertex_of));
    drop(vertex_of);
    let positions: Vec<DVec2> = source.iter().map(|&i| input.positions[i as usize]).collect();
    let in_blocks = match positions.len() > 2 * BLOCK && loose.is_empty() {
        true => in_blocks(&positions, &edges, BLOCK).map_err(|e| input.in_map(e))?,
        false => None,
    };
    let faces = match in_blocks {
        Some(faces) => faces,
        None => with_loose(&positions, &edges, &loose).map_err(|e| input.in_map(e))?,
    };
    drop((edges, loose));
    numbered(input, (source, positions), faces)
}

/// The edges that cross others which [`triangulate`] would hold, in map coordinates.
///
/// # Errors
/// When a coordinate is out of range.
pub(crate) fn crossing_edges(input: &TinInput) -> Result<Vec<Segment>> {
    let (source, vertex_of) = merge_equal_positions(&input.positions);
    let edges = between_vertices(&input.edges, &vertex_of);
    let positions: Vec<DVec2> = source.iter().map(|&i| input.positions[i as usize]).collect();
    let place = |v: u32| positions[v as usize] + input.origin;
    Ok(conflicts(&positions, &edges)?.into_iter().map(|[u, v]| Segment { a: place(u), b: place(v) }).collect())
}

/// Triangulates points and edges, and gives only the triangles, in no particular order. Their corners are points of the
/// input: of several at one position, the first.
///
/// # Errors
/// As [`triangulate`].
pub(super) fn faces(input: &TinInput) -> Result<Vec<Face>> {
    let (source, vertex_of) = merge_equal_positions(&input.positions);
    let edges = between_vertices(&input.edges, &vertex_of);
    let positions: Vec<DVec2> = source.iter().map(|&i| input.positions[i as usize]).collect();
    let mut faces = faces_between(&positions, &edges)?;
    faces.iter_mut().flat_map(|face| &mut face.corners).for_each(|v| *v = source[*v as usize]);
    Ok(faces)
}

/// The edges between vertices, if `vertex_of` gives the vertex of each point. Those between points at one position are left out.
fn between_vertices(edges: &[[u32; 2]], vertex_of: &[u32]) -> Vec<[u32; 2]> {
    edges.iter().map(|edge| edge.map(|p| vertex_of[p as usize])).filter(|[u, v]| u != v).collect()
}

/// The network of these triangles. `source` gives the point of each vertex.
fn numbered(input: &TinInput, (source, positions): (Vec<u32>, Vec<DVec2>), faces: Vec<Face>) -> Result<Tin> {
    if faces.is_empty() {
        return Err(Error::NoArea);
    }
    let pick = |i: &u32| *i as usize;
    let mut tin = Tin {
        origin: input.origin,
        positions,
        heights: source.iter().map(|i| input.heights[pick(i)]).collect(),
        kinds: source.iter().map(|i| input.kinds[pick(i)]).collect(),
        source,
        ..Tin::default()
    };
    tin.set_faces(faces);
    peel_flat_border(&mut tin, input.border_tolerance);
    Ok(tin)
}

/// Merges points of the same position. Returns the first point of each position, and for each point its merged index.
fn merge_equal_positions(positions: &[DVec2]) -> (Vec<u32>, Vec<u32>) {
    let place = |i: &u32| positions[*i as usize].to_array().map(f64::to_bits);
    let mut order: Vec<([u64; 2], u32)> = parallel::values(positions.len(), |i| (place(&(i as u32)), i as u32));
    order.par_sort_unstable();
    let mut index = vec![0; positions.len()];
    for same in order.chunk_by(|a, b| a.0 == b.0) {
        same.iter().for_each(|&(_, i)| index[i as usize] = same[0].1);
    }
    let mut unique = Vec::with_capacity(positions.len());
    for i in 0..positions.len() {
        // The first of a position comes before all others.
        index[i] = if index[i] as usize == i {
            unique.push(i as u32);
            (unique.len() - 1) as u32
        } else {
            index[index[i] as usize]
        };
    }
    (unique, index)
}

/// Takes the slivers along the outer border out of the frame.
///
/// Contours that end on a straight edge of the map end on it only up to rounding. The triangles between those ends and
/// the convex hull are flat slivers. Neighbouring sub-domains would be connected through them.
///
/// A sliver is judged by its distance from an edge of the hull. Otherwise slivers of slivers could reach further in.
/// Points on the map's edge lie on it within the tolerance on either side, so twice the tolerance can lie between them.
fn peel_flat_border(tin: &mut Tin, tolerance: f64) {
    let mut open: Vec<(u32, usize, [DVec2; 2])> = (0..tin.len() as u32)
        .flat_map(|t| (0..3).map(move |i| (t, i)))
        .filter(|&(t, i)| tin.neighbours[t as usize][i] == NONE)
        .map(|(t, i)| (t, i, tin.edge(t, i).map(|v| tin.positions[v as usize])))
        .collect();
    while let Some((t, i, hull)) = open.pop() {
        if !tin.inside[t as usize] || tin.is_constraint(t, i) {
            continue;
        }
        let [a, b] = hull;
        let c = tin.corners(t)[(i + 2) % 3];
        let depth = (b - a).perp_dot(c - a).abs() / a.distance(b);
        // A contour along the border has only this triangle on its inner side.
        let bears_a_line = (0..3).any(|j| tin.is_constraint(t, j) && tin.inner_neighbour(t, j).is_none());
        if depth <= 2.0 * tolerance && !bears_a_line {
            tin.inside[t as usize] = false;
            for j in [(i + 1) % 3, (i + 2) % 3] {
                let n = tin.neighbours[t as usize][j];
                if n != NONE
                    && let Some(k) = tin.edge_towards(n, t)
                {
                    open.push((n, k, hull));
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tin::VertexKind;

    fn square(input: &mut TinInput, half: f64, height: f64) {
        let ring = [(-half, -half), (half, -half), (half, half), (-half, half), (-half, -half)].map(DVec2::from);
        input.push_line(&ring, height, VertexKind::Contour);
    }

    #[test]
    fn nested_squares_far_from_zero_keep_their_coordinates() {
        let far = DVec2::new(-35_000.125, 4_123_456.7);
        let mut input = TinInput::new([far, far + 4.0], 1e-9);
        let ring = [(0.1, 0.1), (3.9, 0.1), (3.9, 3.9), (0.1, 3.9), (0.1, 0.1)].map(|p| far + DVec2::from(p));
        input.push_line(&ring, 10.0, VertexKind::Contour);
        let tin = triangulate(&input).unwrap();
        tin.validate().unwrap();
        assert_eq!(tin.positions.len(), 4);
        for (v, p) in ring[..4].iter().enumerate() {
            assert_eq!(tin.point(v as u32).truncate(), *p);
        }
    }

    #[test]
    fn the_first_point_of_a_position_wins() {
        let mut input = TinInput::new([DVec2::ZERO, DVec2::ONE], 0.0);
        square(&mut input, 1.0, 10.0);
        input.push(DVec2::new(1.0, 1.0), 99.0, VertexKind::Spot);
        let tin = triangulate(&input).unwrap();
        assert_eq!(tin.positions.len(), 4);
        assert!(tin.heights.iter().all(|&h| h == 10.0));
    }

    #[test]
    fn loose_edges_give_way_to_others_and_to_earlier_ones() {
        let mut input = TinInput::new([DVec2::splat(-3.0), DVec2::splat(3.0)], 1e-9);
        square(&mut input, 3.0, 10.0);
        let place = [(-2.0, 0.1), (2.0, 0.2), (0.1, -2.0), (0.2, 2.0), (0.0, 5.0), (1.5, 2.9)];
        let points = place.map(|p| input.push(DVec2::from(p), 11.0, VertexKind::Axis));
        for [a, b] in [[0, 1], [2, 3], [3, 4], [3, 5]] {
            input.push_loose_edge(points[a], points[b]);
        }
        let tin = triangulate(&input).unwrap();
        tin.validate().unwrap();
        let is_held = |[a, b]: [usize; 2]| {
            let edges = (0..tin.len() as u32).flat_map(|t| (0..3).map(move |i| (t, i)));
            let ends = [points[a], points[b]];
            let of = |t: u32, i: usize| tin.edge(t, i).map(|v| tin.source[v as usize]);
            edges
                .into_iter()
                .any(|(t, i)| tin.is_constraint(t, i) && (of(t, i) == ends || of(t, i) == [ends[1], ends[0]]))
        };
        assert_eq!([[0, 1], [2, 3], [3, 4], [3, 5]].map(is_held), [true, false, false, true]);
    }

    #[test]
    fn crossing_lines_and_a_single_line_are_errors() {
        let mut input = TinInput::new([DVec2::ZERO, DVec2::ONE], 0.0);
        input.push_line(&[DVec2::new(0.0, 0.0), DVec2::new(1.0, 1.0)], 1.0, VertexKind::Contour);
        input.push_line(&[DVec2::new(0.0, 1.0), DVec2::new(1.0, 0.0)], 2.0, VertexKind::Contour);
        assert!(triangulate(&input).unwrap_err().to_string().contains("lines cross near 0.5"));
        let mut input = TinInput::new([DVec2::ZERO, DVec2::ONE], 0.0);
        input.push_line(&[DVec2::new(0.0, 0.0), DVec2::new(1.0, 1.0)], 1.0, VertexKind::Contour);
        assert!(triangulate(&input).unwrap_err().to_string().contains("no area"));
        assert!(triangulate(TinInput::new([DVec2::ZERO, DVec2::ONE], 0.0)).is_err());
    }

    #[test]
    fn slivers_on_the_border_are_peeled_off() {
        let mut input = TinInput::new([DVec2::ZERO, DVec2::splat(10.0)], 1e-6);
        for p in [(0.0, 0.0), (5.0, 1e-8), (10.0, 0.0), (10.0, 10.0), (0.0, 10.0)] {
            input.push(p.into(), 1.0, VertexKind::Contour);
        }
        let tin = triangulate(&input).unwrap();
        let outside: Vec<u32> = (0..tin.len() as u32).filter(|&t| !tin.is_inside(t)).collect();
        assert_eq!(outside.len(), 1);
        assert!(tin.triangles[outside[0] as usize].contains(&1));
    }

    #[test]
    fn slivers_are_peeled_off_no_deeper_than_twice_the_tolerance() {
        // A fan of slivers, each flat against the one before.
        let mut input = TinInput::new([DVec2::ZERO, DVec2::new(100.0, 10.0)], 1e-3);
        for p in [(0.0, 0.0), (100.0, 0.0), (100.0, 10.0), (0.0, 10.0)] {
            input.push(p.into(), 1.0, VertexKind::Contour);
        }
        (1..=20).for_each(|k| _ = input.push(DVec2::new(4.0, 4e-4) * f64::from(k), 1.0, VertexKind::Contour));
        let tin = triangulate(&input).unwrap();
        let outside = (0..tin.len() as u32).filter(|&t| !tin.is_inside(t));
        let deepest = outside.flat_map(|t| tin.corners(t)).fold(0.0, |m: f64, p| m.max((p + tin.origin).y));
        assert!(deepest > 1e-3 && deepest <= 2e-3, "{deepest}");
    }

    #[test]
    fn no_contour_on_the_border_is_peeled_off() {
        let mut input = TinInput::new([DVec2::ZERO, DVec2::splat(10.0)], 1e-6);
        input.push_line(&[DVec2::ZERO, DVec2::new(1e-8, 0.0)], 5.0, VertexKind::Contour);
        for p in [(0.0, 5.0), (10.0, 0.0), (10.0, 10.0), (0.0, 10.0)] {
            input.push(p.into(), 1.0, VertexKind::Contour);
        }
        let tin = triangulate(&input).unwrap();
        let holds = |t: &u32| (0..3).any(|i| tin.contour_level(*t, i) == Some(5.0));
        assert!((0..tin.len() as u32).find(holds).is_some_and(|t| tin.is_inside(t)));
    }
}
