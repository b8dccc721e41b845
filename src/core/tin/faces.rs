//! Triangles as spade gives them, before they have their numbers. Only this file uses spade.

use glam::DVec2;
use spade::handles::{FixedFaceHandle, FixedVertexHandle, InnerTag};
use spade::{ConstrainedDelaunayTriangulation, InsertionError, Point2, Triangulation as _};

use super::network::{CONSTRAINT, NONE};
use crate::base::error::{Error, Result};
use crate::base::parallel;

/// A constrained Delaunay triangulation as spade builds it.
type Cdt = ConstrainedDelaunayTriangulation<Point2<f64>>;

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

/// The triangles between different positions, none if all lie on one line.
///
/// # Errors
/// When a coordinate is out of range, or when edges cross: their place as the positions are.
pub(super) fn faces_between(positions: &[DVec2], edges: &[[u32; 2]]) -> Result<Vec<Face>> {
    with_loose(positions, edges, &[])
}

/// As [`faces_between`], with those `loose` edges that cross no others.
pub(super) fn with_loose(positions: &[DVec2], edges: &[[u32; 2]], loose: &[[u32; 2]]) -> Result<Vec<Face>> {
    let mut cdt = loaded(positions, edges)?;
    for ends in loose {
        let [from, to] = ends.map(|v| FixedVertexHandle::from_index(v as usize));
        if cdt.can_add_constraint(from, to) {
            cdt.add_constraint(from, to);
        }
    }
    Ok(faces_of(&cdt))
}

/// Spade's triangulation of different positions.
fn loaded(positions: &[DVec2], edges: &[[u32; 2]]) -> Result<Cdt> {
    let vertices = positions.iter().map(|&p| point(p)).collect();
    let mut conflict = None;
    let cdt = Cdt::try_bulk_load_cdt(vertices, edges.iter().map(|e| e.map(|v| v as usize)).collect(), |e| {
        conflict.get_or_insert(e);
    });
    let cdt = cdt.map_err(refused)?;
    match conflict {
        Some([u, v]) => Err(Error::LinesCross { place: positions[u].midpoint(positions[v]) }),
        None => Ok(cdt),
    }
}

/// The triangles in no particular order.
fn faces_of(cdt: &Cdt) -> Vec<Face> {
    let faces: Vec<_> = cdt.fixed_inner_faces().collect();
    let face = |&face: &FixedFaceHandle<InnerTag>| {
        let edges = cdt.face(face).adjacent_edges();
        // The outer face has index 0, so inner faces count from 1.
        let beyond = edges.map(|e| e.rev().face().as_inner().map_or(NONE, |f| f.fix().index() as u32 - 1));
        let flag = |i: usize| if edges[i].is_constraint_edge() { CONSTRAINT << i } else { 0 };
        let corners = edges.map(|e| e.from().fix().index() as u32);
        Face { corners, beyond, edges: flag(0) | flag(1) | flag(2), inside: true }
    };
    parallel::map_each(&faces, face)
}

fn point(position: DVec2) -> Point2<f64> {
    Point2::new(position.x, position.y)
}

fn refused(error: InsertionError) -> Error {
    Error::Data(format!("a coordinate cannot be triangulated: {error}"))
}
