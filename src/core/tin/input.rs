//! The input of a triangulation: points with heights, and edges between them.

use glam::DVec2;

use super::network::VertexKind;
use crate::base::error::Error;

/// Points and edges to triangulate.
///
/// If several points share a position, the first gives kind and height. So contours must go in before anything else.
#[derive(Debug, Clone, Default)]
pub struct TinInput {
    pub(super) origin: DVec2,
    pub(super) positions: Vec<DVec2>,
    pub(super) heights: Vec<f64>,
    pub(super) kinds: Vec<VertexKind>,
    pub(super) edges: Vec<[u32; 2]>,
    /// Edges that are left out where they cross others.
    pub(super) loose: Vec<[u32; 2]>,
    pub(super) border_tolerance: f64,
}

impl TinInput {
    /// An input without points. `extent` is the lower left and the upper right corner of all points to come, map units.
    ///
    /// Triangles on the outer border that are flatter than `border_tolerance` (map units) will lie outside the frame.
    pub fn new(extent: [DVec2; 2], border_tolerance: f64) -> Self {
        let origin = origin_of(extent);
        Self {
            origin,
            positions: Vec::new(),
            heights: Vec::new(),
            kinds: Vec::new(),
            edges: Vec::new(),
            loose: Vec::new(),
            border_tolerance,
        }
    }

    /// Points of a part of a triangulation, relative to its origin. The whole triangulation keeps heights and kinds.
    pub(super) fn local(positions: impl Iterator<Item = DVec2>) -> Self {
        let positions: Vec<DVec2> = positions.collect();
        let (heights, kinds) = (vec![0.0; positions.len()], vec![VertexKind::Axis; positions.len()]);
        Self { positions, heights, kinds, border_tolerance: -1.0, ..Self::default() }
    }

    /// The error with its place in map coordinates, if the place is relative to the origin.
    pub(super) fn in_map(&self, error: Error) -> Error {
        match error {
            Error::LinesCross { place } => Error::LinesCross { place: place + self.origin },
            other => other,
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

    /// Makes room for as many points on lines.
    pub fn reserve(&mut self, points: usize) {
        self.positions.reserve_exact(points);
        self.heights.reserve_exact(points);
        self.kinds.reserve_exact(points);
        self.edges.reserve_exact(points);
    }

    /// Adds a point in map coordinates and returns its index.
    pub fn push(&mut self, position: DVec2, height: f64, kind: VertexKind) -> u32 {
        self.push_local(position - self.origin, height, kind)
    }

    /// Adds a point relative to the origin and returns its index.
    pub fn push_local(&mut self, position: DVec2, height: f64, kind: VertexKind) -> u32 {
        // Spade refuses smaller numbers as underflow, so they become zero.
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

    /// Adds an edge that the triangulation holds only if it crosses none of the other edges. Of two loose edges that cross,
    /// the one that was added first is held.
    pub fn push_loose_edge(&mut self, a: u32, b: u32) {
        self.loose.push([a, b]);
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

/// A whole-number origin near the points, or zero if none is needed.
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
