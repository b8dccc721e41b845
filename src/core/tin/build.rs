//! Builds a [`Tin`], the constrained Delaunay triangulation of points and edges. Only this file, `cdt` and `walk` use
//! spade.

use std::collections::HashMap;

use glam::DVec2;
use rayon::prelude::*;
use spade::handles::{FixedFaceHandle, FixedVertexHandle, InnerTag};
use spade::{InsertionError, Point2, Triangulation as _};

use super::cdt::Cdt;
use super::input::TinInput;
use super::network::{CONSTRAINT, NONE, Tin};
use super::walk::is_found;
use crate::base::error::{Error, Result};
use crate::base::parallel;

/// A constrained Delaunay triangulation that can grow. Points and edges that are added to its [`input`](Self::input)
/// are in the next [`tin`](Self::tin). Earlier points keep their numbers.
#[derive(Debug, Clone, Default)]
pub struct Triangulation {
    cdt: Cdt,
    input: TinInput,
    /// The vertex of each point that was taken in.
    vertex_of: Vec<u32>,
    /// The first point of each vertex.
    source: Vec<u32>,
    /// Number of edges that were taken in.
    edges: usize,
}

impl Triangulation {
    /// Triangulates points and edges.
    ///
    /// # Errors
    /// When a coordinate is out of range, or when edges cross.
    pub fn new(input: TinInput) -> Result<Self> {
        let (source, vertex_of) = merge_equal_positions(&input.positions);
        let edges = input.edges.len();
        let mut built = Self { cdt: Cdt::new(), input, vertex_of, source, edges };
        built.load()?;
        Ok(built)
    }

    /// Triangulates all vertices and edges that were taken in.
    fn load(&mut self) -> Result<()> {
        let Self { input, vertex_of, source, .. } = self;
        let vertices = source.iter().map(|&i| point(input.positions[i as usize])).collect();
        let edges = input.edges[..self.edges].iter().map(|e| e.map(|p| vertex_of[p as usize] as usize));
        let edges = edges.filter(|[u, v]| u != v).collect();
        let mut conflict = None;
        self.cdt = Cdt::try_bulk_load_cdt(vertices, edges, |e| {
            conflict.get_or_insert(e);
        })
        .map_err(refused)?;
        conflict.map_or(Ok(()), |edge| Err(self.crossing(edge.map(|v| v as u32))))
    }

    /// Its points and edges.
    pub fn input(&mut self) -> &mut TinInput {
        &mut self.input
    }

    /// The triangles.
    ///
    /// # Errors
    /// As [`new`](Self::new), and when all points lie on one line.
    pub fn tin(&mut self) -> Result<Tin> {
        self.grow()?;
        let faces = self.faces()?;
        Ok(self.numbered(&faces))
    }

    /// The triangles of a triangulation that need not grow any more. Spade's structure, a large part of the memory, is
    /// freed before they are numbered.
    /// # Errors
    /// As [`tin`](Self::tin).
    pub fn into_tin(mut self) -> Result<Tin> {
        self.grow()?;
        let faces = self.faces()?;
        self.cdt = Cdt::new();
        Ok(self.numbered(&faces))
    }

    fn numbered(&self, faces: &[Face]) -> Tin {
        let Self { input, source, .. } = self;
        let pick = |i: &u32| *i as usize;
        let mut tin = Tin {
            origin: input.origin,
            positions: source.iter().map(|i| input.positions[pick(i)]).collect(),
            heights: source.iter().map(|i| input.heights[pick(i)]).collect(),
            kinds: source.iter().map(|i| input.kinds[pick(i)]).collect(),
            source: source.clone(),
            ..Tin::default()
        };
        tin.set_faces(faces);
        peel_flat_border(&mut tin, input.border_tolerance);
        tin
    }

    /// The triangles in no particular order.
    fn faces(&self) -> Result<Vec<Face>> {
        let cdt = &self.cdt;
        let faces: Vec<_> = cdt.fixed_inner_faces().collect();
        if faces.is_empty() {
            return Err(Error::NoArea);
        }
        let face = |&face: &FixedFaceHandle<InnerTag>| {
            let edges = cdt.face(face).adjacent_edges();
            // The outer face has index 0, so inner faces count from 1.
            let beyond = edges.map(|e| e.rev().face().as_inner().map_or(NONE, |f| f.fix().index() as u32 - 1));
            let flag = |i: usize| if edges[i].is_constraint_edge() { CONSTRAINT << i } else { 0 };
            let corners = edges.map(|e| e.from().fix().index() as u32);
            Face { corners, beyond, edges: flag(0) | flag(1) | flag(2), inside: true }
        };
        Ok(parallel::map_each(&faces, face))
    }

    /// Takes in the points and edges that were added.
    fn grow(&mut self) -> Result<()> {
        let before = self.source.len();
        let first = self.vertex_of.len();
        self.vertex_of.resize(self.input.positions.len(), NONE);
        let mut near = FixedVertexHandle::from_index(0);
        for i in side_by_side(&self.input.positions[first..]).into_iter().map(|i| first + i) {
            let place = point(self.input.positions[i]);
            if !is_found(&self.cdt, place, near) {
                self.source.truncate(before);
                self.number_from(first);
                self.load()?;
                break;
            }
            near = self.cdt.insert_with_hint(place, near).map_err(refused)?;
            let vertex = near.index();
            if vertex == self.source.len() {
                self.source.push(i as u32);
            } else if vertex >= before && self.source[vertex] > i as u32 {
                // Of several new points at one position, the first counts.
                self.source[vertex] = i as u32;
            }
            self.vertex_of[i] = vertex as u32;
        }
        for e in self.edges..self.input.edges.len() {
            let [u, v] = self.input.edges[e].map(|p| self.vertex_of[p as usize]);
            let [from, to] = [u, v].map(|v| FixedVertexHandle::from_index(v as usize));
            if u != v && !self.cdt.can_add_constraint(from, to) {
                return Err(self.crossing([u, v]));
            }
            if u != v {
                self.cdt.add_constraint(from, to);
            }
        }
        self.edges = self.input.edges.len();
        for ends in std::mem::take(&mut self.input.loose) {
            let [from, to] = ends.map(|p| FixedVertexHandle::from_index(self.vertex_of[p as usize] as usize));
            if from != to && self.cdt.can_add_constraint(from, to) {
                self.cdt.add_constraint(from, to);
            }
        }
        Ok(())
    }

    /// Gives each point from `first` on its vertex. Points at one position share a vertex.
    fn number_from(&mut self, first: usize) {
        let Self { input, vertex_of, source, .. } = self;
        let key = |i: usize| input.positions[i].to_array().map(f64::to_bits);
        let mut at: HashMap<[u64; 2], u32> = (0..).zip(&*source).map(|(v, &i)| (key(i as usize), v)).collect();
        for (i, vertex) in vertex_of.iter_mut().enumerate().skip(first) {
            *vertex = *at.entry(key(i)).or_insert_with(|| {
                source.push(i as u32);
                source.len() as u32 - 1
            });
        }
    }

    /// The error that the edge between two vertices crosses another.
    fn crossing(&self, edge: [u32; 2]) -> Error {
        let [u, v] = edge.map(|v| self.input.positions[self.source[v as usize] as usize]);
        Error::LinesCross { place: u.midpoint(v) + self.input.origin }
    }
}

/// A triangle before it has its number.
#[derive(Debug, Clone, Copy)]
pub(super) struct Face {
    pub corners: [u32; 3],
    /// Places of the neighbours in the list of faces.
    pub beyond: [u32; 3],
    pub edges: u16,
    pub inside: bool,
}

impl Face {
    /// The two ends of edge `i`.
    pub fn edge(&self, i: usize) -> [u32; 2] {
        [self.corners[i], self.corners[(i + 1) % 3]]
    }

    /// Whether edge `i` is a constraint.
    pub fn is_constraint(&self, i: usize) -> bool {
        self.edges & (CONSTRAINT << i) != 0
    }
}

impl Tin {
    /// Takes these triangles. They are numbered along the contours, as the vertices are. So work that goes from
    /// triangle to triangle finds its data close together in memory.
    pub(super) fn set_faces(&mut self, faces: &[Face]) {
        // A counting sort by least corner. Triangles with the same one keep their order.
        let least: Vec<u32> = parallel::values_each(faces, |face| face.corners.into_iter().fold(NONE, u32::min));
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
        let of = |&f: &u32| faces[f as usize];
        let numbered = |f: u32| if f == NONE { NONE } else { number[f as usize] };
        self.triangles = parallel::values_each(&order, |f| of(f).corners);
        self.neighbours = parallel::values_each(&order, |f| of(f).beyond.map(numbered));
        self.inside = parallel::values_each(&order, |f| of(f).inside);
        self.edges = parallel::values_each(&order, |f| of(f).edges);
        self.edges = parallel::values(self.len(), |t| self.with_contours(t as u32));
    }
}

/// Triangulates points and edges.
///
/// # Errors
/// As [`Triangulation::tin`].
pub fn triangulate(input: TinInput) -> Result<Tin> {
    Triangulation::new(input)?.into_tin()
}

/// Triangulates points and edges, and gives only the triangles, in no particular order. Their corners are points of the
/// input: of several at one position, the first.
///
/// # Errors
/// As [`Triangulation::tin`].
pub(super) fn faces(input: TinInput) -> Result<Vec<Face>> {
    let built = Triangulation::new(input)?;
    let mut faces = built.faces()?;
    faces.iter_mut().flat_map(|face| &mut face.corners).for_each(|v| *v = built.source[*v as usize]);
    Ok(faces)
}

fn point(position: DVec2) -> Point2<f64> {
    Point2::new(position.x, position.y)
}

fn refused(error: InsertionError) -> Error {
    Error::Data(format!("a coordinate cannot be triangulated: {error}"))
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

/// The numbers of points in strips, so that each point is near the one before. Spade starts the search for a point from
/// there.
fn side_by_side(positions: &[DVec2]) -> Vec<usize> {
    let low = positions.iter().fold(f64::INFINITY, |low, p| low.min(p.y));
    let high = positions.iter().fold(f64::NEG_INFINITY, |high, p| high.max(p.y));
    let strips = (positions.len() as f64).sqrt() / (high - low).max(f64::MIN_POSITIVE);
    let strip = |i: &usize| ((positions[*i].y - low) * strips) as i64;
    let mut order: Vec<usize> = (0..positions.len()).collect();
    order.sort_by(|a, b| {
        let (a_strip, b_strip) = (strip(a), strip(b));
        let along = positions[*a].x.total_cmp(&positions[*b].x);
        a_strip.cmp(&b_strip).then(if a_strip % 2 == 0 { along } else { along.reverse() })
    });
    order
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
    use crate::tin::walk::winding_lines;

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
        let tin = triangulate(input).unwrap();
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
        let tin = triangulate(input).unwrap();
        assert_eq!(tin.positions.len(), 4);
        assert!(tin.heights.iter().all(|&h| h == 10.0));
    }

    #[test]
    fn a_grown_triangulation_is_that_of_all_points_and_edges() {
        let points = |n: u32, seed: f64| {
            let at = move |k: u32| 4.0 * (f64::from(k) * seed).fract() - 2.0;
            (0..n).map(move |k| DVec2::new(at(k + 1), at(7 * k + 3)))
        };
        let mut input = TinInput::new([DVec2::splat(-3.0), DVec2::splat(3.0)], 1e-9);
        square(&mut input, 3.0, 10.0);
        points(40, 0.618_034).for_each(|p| _ = input.push(p, 11.0, VertexKind::Spot));
        let mut grown = Triangulation::new(input.clone()).unwrap();
        let before = grown.tin().unwrap();
        for input in [&mut input, grown.input()] {
            points(30, 0.414_214).for_each(|p| _ = input.push(p, 12.0, VertexKind::Axis));
            let again = input.push(DVec2::splat(3.0), 99.0, VertexKind::Axis);
            let inner = input.push(DVec2::splat(2.5), 12.0, VertexKind::Axis);
            input.push_edge(again, inner);
            input.push(DVec2::splat(2.5), 77.0, VertexKind::Axis);
        }
        let (grown, whole) = (grown.tin().unwrap(), triangulate(input.clone()).unwrap());
        grown.validate().unwrap();
        assert_eq!(grown.source[..before.source.len()], before.source);
        // The same vertices, edges and constraints, by the points that they were made of.
        let sorted = |tin: &Tin| {
            let edges = (0..tin.len() as u32).flat_map(|t| (0..3).map(move |i| (t, i)));
            let edges = edges.map(|(t, i)| (tin.edge(t, i).map(|v| tin.source[v as usize]), tin.is_constraint(t, i)));
            let mut edges: Vec<_> = edges.collect();
            edges.sort_unstable();
            edges
        };
        assert_eq!(sorted(&grown), sorted(&whole));
        assert!(!grown.heights.contains(&77.0) && !grown.heights.contains(&99.0));
        let mut crossed = Triangulation::new(input).unwrap();
        let [a, b] = [(-3.5, 0.0), (3.5, 0.1)].map(|p| crossed.input().push(p.into(), 1.0, VertexKind::Axis));
        crossed.input().push_edge(a, b);
        assert!(crossed.tin().unwrap_err().to_string().contains("lines cross"));
    }

    #[test]
    fn a_triangulation_grows_among_winding_lines() {
        let (vertices, edges, points) = winding_lines();
        let mut input = TinInput::new([DVec2::ZERO, DVec2::splat(31.0)], 0.0);
        vertices.into_iter().for_each(|p| _ = input.push(p, 10.0, VertexKind::Contour));
        edges.into_iter().for_each(|e| input.push_edge(e[0] as u32, e[1] as u32));
        let mut grown = Triangulation::new(input).unwrap();
        let before = grown.tin().unwrap();
        for p in points.iter().rev().chain(&points) {
            grown.input().push(*p, 5.0, VertexKind::Axis);
        }
        let tin = grown.tin().unwrap();
        tin.validate().unwrap();
        assert_eq!(tin.source[..16], before.source);
        let mut added = tin.source[16..].to_vec();
        added.sort_unstable();
        assert_eq!(added, [16, 17, 18, 19, 20]);
        let constraints = |tin: &Tin| {
            let edges = (0..tin.len() as u32).flat_map(|t| (0..3).map(move |i| (t, i)));
            edges.filter(|&(t, i)| tin.is_constraint(t, i)).count()
        };
        assert_eq!(constraints(&tin), constraints(&before));
    }

    #[test]
    fn crossing_lines_and_a_single_line_are_errors() {
        let mut input = TinInput::new([DVec2::ZERO, DVec2::ONE], 0.0);
        input.push_line(&[DVec2::new(0.0, 0.0), DVec2::new(1.0, 1.0)], 1.0, VertexKind::Contour);
        input.push_line(&[DVec2::new(0.0, 1.0), DVec2::new(1.0, 0.0)], 2.0, VertexKind::Contour);
        assert!(triangulate(input).unwrap_err().to_string().contains("lines cross near 0.5"));
        let mut input = TinInput::new([DVec2::ZERO, DVec2::ONE], 0.0);
        input.push_line(&[DVec2::new(0.0, 0.0), DVec2::new(1.0, 1.0)], 1.0, VertexKind::Contour);
        assert!(triangulate(input).unwrap_err().to_string().contains("no area"));
        assert!(triangulate(TinInput::new([DVec2::ZERO, DVec2::ONE], 0.0)).is_err());
    }

    #[test]
    fn slivers_on_the_border_are_peeled_off() {
        let mut input = TinInput::new([DVec2::ZERO, DVec2::splat(10.0)], 1e-6);
        for p in [(0.0, 0.0), (5.0, 1e-8), (10.0, 0.0), (10.0, 10.0), (0.0, 10.0)] {
            input.push(p.into(), 1.0, VertexKind::Contour);
        }
        let tin = triangulate(input).unwrap();
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
        let tin = triangulate(input).unwrap();
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
        let tin = triangulate(input).unwrap();
        let holds = |t: &u32| (0..3).any(|i| tin.contour_level(*t, i) == Some(5.0));
        assert!((0..tin.len() as u32).find(holds).is_some_and(|t| tin.is_inside(t)));
    }
}
