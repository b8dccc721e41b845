//! Builds a [`Tin`]: the constrained Delaunay triangulation of points and edges. The only file that knows spade.

use std::collections::HashMap;

use glam::DVec2;
use rayon::prelude::*;
use spade::{ConstrainedDelaunayTriangulation, Point2, Triangulation};

use super::{CONSTRAINT, NONE, Tin, VertexKind};
use crate::error::{Error, Result};

/// Points and edges to triangulate.
///
/// Where several points share a position the first one gives kind and height, so contours go in before anything else.
#[derive(Debug, Clone)]
pub struct TinInput {
    origin: DVec2,
    positions: Vec<DVec2>,
    heights: Vec<f64>,
    kinds: Vec<VertexKind>,
    edges: Vec<[u32; 2]>,
    border_tolerance: f64,
}

impl TinInput {
    /// No points yet. `extent` is the lower left and the upper right corner of all that will come, map units.
    ///
    /// Triangles flatter than `border_tolerance` (map units) on the outer border will lie outside the frame.
    pub fn new(extent: [DVec2; 2], border_tolerance: f64) -> Self {
        let origin = origin_of(extent);
        Self {
            origin,
            positions: Vec::new(),
            heights: Vec::new(),
            kinds: Vec::new(),
            edges: Vec::new(),
            border_tolerance,
        }
    }

    /// The origin that positions are relative to.
    pub fn origin(&self) -> DVec2 {
        self.origin
    }

    /// Number of points.
    pub fn len(&self) -> usize {
        self.positions.len()
    }

    /// Whether there is no point yet.
    pub fn is_empty(&self) -> bool {
        self.positions.is_empty()
    }

    /// Adds a point in map coordinates and returns its index.
    pub fn push(&mut self, position: DVec2, height: f64, kind: VertexKind) -> u32 {
        self.push_local(position - self.origin, height, kind)
    }

    /// Adds a point relative to the origin and returns its index.
    pub fn push_local(&mut self, position: DVec2, height: f64, kind: VertexKind) -> u32 {
        // Sizes that spade refuses as underflow become zero.
        let axis = |v: f64| if v.abs() < 1e-40 { 0.0 } else { v };
        self.positions.push(DVec2::new(axis(position.x), axis(position.y)));
        self.heights.push(height);
        self.kinds.push(kind);
        (self.positions.len() - 1) as u32
    }

    /// Adds an edge between two points that the triangulation must hold. Edges may touch, not cross.
    pub fn push_edge(&mut self, a: u32, b: u32) {
        self.edges.push([a, b]);
    }

    /// Adds the vertices of a line in map coordinates and the edges between them.
    pub fn push_line(&mut self, points: &[DVec2], height: f64, kind: VertexKind) {
        for (i, &p) in points.iter().enumerate() {
            let v = self.push(p, height, kind);
            if i > 0 {
                self.push_edge(v - 1, v);
            }
        }
    }
}

/// Triangulates points and edges.
///
/// # Errors
/// When a coordinate is out of range, when edges cross, or when all points lie on one line.
pub fn triangulate(input: TinInput) -> Result<Tin> {
    let origin = input.origin;
    let (source, index) = merge_equal_positions(&input.positions);
    let pick = |i: &u32| *i as usize;
    let positions: Vec<DVec2> = source.iter().map(|i| input.positions[pick(i)]).collect();
    let heights: Vec<f64> = source.iter().map(|i| input.heights[pick(i)]).collect();
    let kinds: Vec<VertexKind> = source.iter().map(|i| input.kinds[pick(i)]).collect();
    let edges: Vec<[usize; 2]> =
        input.edges.iter().map(|e| e.map(|v| index[v as usize] as usize)).filter(|[u, v]| u != v).collect();
    let tolerance = input.border_tolerance;
    drop((input, index));

    let vertices: Vec<Point2<f64>> = positions.iter().map(|p| Point2::new(p.x, p.y)).collect();
    let mut conflict = None;
    let cdt = ConstrainedDelaunayTriangulation::<Point2<f64>>::try_bulk_load_cdt(vertices, edges, |e| {
        conflict.get_or_insert(e);
    })
    .map_err(|e| Error::Data(format!("a coordinate cannot be triangulated: {e}")))?;
    if let Some([u, v]) = conflict {
        let p = positions[u].midpoint(positions[v]) + origin;
        return Err(Error::Data(format!(
            "lines cross near {:.3} {:.3}, where no two may; if contours do, clean them first, and if one crosses the \
             frame, move the frame's border a little",
            p.x, p.y
        )));
    }
    let faces: Vec<_> = cdt.fixed_inner_faces().collect();
    if faces.is_empty() {
        return Err(Error::Data("all points lie on one line: there is no area between the contours".into()));
    }
    // Along the contours, as the vertices are, so that what is done triangle by triangle finds its data side by side.
    let corners = |f: u32| cdt.face(faces[f as usize]).vertices().map(|v| v.fix().index() as u32);
    let first_corner = |f: u32| corners(f).into_iter().fold(NONE, u32::min);
    let mut order: Vec<(u32, u32)> = (0..faces.len() as u32).into_par_iter().map(|f| (first_corner(f), f)).collect();
    order.par_sort_unstable();
    let mut number = vec![0; faces.len()];
    for (t, &(_, f)) in order.iter().enumerate() {
        number[f as usize] = t as u32;
    }
    let triangle = |&(_, f): &(u32, u32)| {
        let edges = cdt.face(faces[f as usize]).adjacent_edges();
        let corners = edges.map(|e| e.from().fix().index() as u32);
        // The outer face has index 0, so inner faces count from 1.
        let neighbours = edges.map(|e| e.rev().face().as_inner().map_or(NONE, |f| number[f.fix().index() - 1]));
        let flags =
            edges.iter().enumerate().fold(0, |m, (i, e)| m | (u16::from(e.is_constraint_edge()) * CONSTRAINT) << i);
        (corners, (neighbours, flags))
    };
    let (triangles, (neighbours, edges)): (Vec<_>, (Vec<_>, Vec<_>)) = order.par_iter().map(triangle).unzip();
    drop((order, number, faces, cdt));
    let inside = vec![true; triangles.len()];
    let mut tin =
        Tin { origin, positions, heights, kinds, source, triangles, neighbours, edges, inside, lakes: Vec::new() };
    tin.edges = (0..tin.len() as u32).into_par_iter().map(|t| tin.with_contours(t)).collect();
    peel_flat_border(&mut tin, tolerance);
    Ok(tin)
}

/// A whole-number origin near the points, or zero where it is not needed.
///
/// Subtracting it is exact: all coordinates of an axis lie within a tenth of their own size from each other, so the
/// difference has no more binary digits than the coordinate.
fn origin_of([lo, hi]: [DVec2; 2]) -> DVec2 {
    let axis = |lo: f64, hi: f64| {
        let far = lo.abs().max(hi.abs());
        if hi - lo < 0.1 * far { lo.midpoint(hi).round() } else { 0.0 }
    };
    DVec2::new(axis(lo.x, hi.x), axis(lo.y, hi.y))
}

/// Merges points of the same position. Returns the first point of each position and, a point, its merged index.
fn merge_equal_positions(positions: &[DVec2]) -> (Vec<u32>, Vec<u32>) {
    let mut seen: HashMap<[u64; 2], u32> = HashMap::with_capacity(positions.len());
    let mut unique = Vec::with_capacity(positions.len());
    let index = positions
        .iter()
        .enumerate()
        .map(|(i, p)| {
            *seen.entry([p.x.to_bits(), p.y.to_bits()]).or_insert_with(|| {
                unique.push(i as u32);
                (unique.len() - 1) as u32
            })
        })
        .collect();
    (unique, index)
}

/// Takes the slivers along the outer border out of the frame.
///
/// Contours that end on a straight sheet edge end on it only up to rounding. The triangles between those ends and the
/// convex hull are flat slivers that would let neighbouring sub-domains run together.
fn peel_flat_border(tin: &mut Tin, tolerance: f64) {
    let mut open: Vec<(u32, usize)> = (0..tin.len() as u32)
        .flat_map(|t| (0..3).map(move |i| (t, i)))
        .filter(|&(t, i)| tin.neighbours[t as usize][i] == NONE)
        .collect();
    while let Some((t, i)) = open.pop() {
        if !tin.inside[t as usize] || tin.is_constraint(t, i) {
            continue;
        }
        let [a, b] = tin.edge(t, i).map(|v| tin.positions[v as usize]);
        let c = tin.corners(t)[(i + 2) % 3];
        let altitude = (b - a).perp_dot(c - a).abs() / a.distance(b);
        // A contour along the border has nothing but this triangle on its inner side.
        let bears_a_line = (0..3).any(|j| tin.is_constraint(t, j) && tin.inner_neighbour(t, j).is_none());
        if altitude <= tolerance && !bears_a_line {
            tin.inside[t as usize] = false;
            for j in [(i + 1) % 3, (i + 2) % 3] {
                let n = tin.neighbours[t as usize][j];
                if n != NONE
                    && let Some(k) = tin.edge_towards(n, t)
                {
                    open.push((n, k));
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

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
