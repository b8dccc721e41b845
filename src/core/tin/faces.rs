//! Triangles as spade gives them, before they have their numbers. Only this file uses spade.

use glam::DVec2;
use spade::handles::{FixedFaceHandle, FixedVertexHandle, InnerTag};
use spade::{ConstrainedDelaunayTriangulation, InsertionError, Point2, Triangulation as _};

use super::insertion::in_rounds;
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
    let Triangulated { mut cdt, order, conflicts } = triangulated(positions, edges)?;
    if let Some(&[u, v]) = conflicts.first() {
        return Err(Error::LinesCross { place: positions[u as usize].midpoint(positions[v as usize]) });
    }
    let place = order.as_ref().map(|order| places(order));
    for ends in loose {
        let [from, to] = ends.map(|v| handle(v, place.as_deref()));
        if cdt.can_add_constraint(from, to) {
            cdt.add_constraint(from, to);
        }
    }
    let mut faces = faces_of(&cdt);
    if let Some(order) = order {
        faces.iter_mut().flat_map(|face| &mut face.corners).for_each(|v| *v = order[*v as usize]);
    }
    Ok(faces)
}

/// Edges that are not held, because each crosses one that is.
///
/// # Errors
/// When a coordinate is out of range.
pub(super) fn conflicts(positions: &[DVec2], edges: &[[u32; 2]]) -> Result<Vec<[u32; 2]>> {
    Ok(triangulated(positions, edges)?.conflicts)
}

/// Spade's triangulation of different positions.
struct Triangulated {
    cdt: Cdt,
    /// The positions in the order of its vertices, if it is another one.
    order: Option<Vec<u32>>,
    /// The edges that it does not hold.
    conflicts: Vec<[u32; 2]>,
}

fn triangulated(positions: &[DVec2], edges: &[[u32; 2]]) -> Result<Triangulated> {
    let mut conflicts = Vec::new();
    let Some(rounds) = in_rounds(positions, edges) else {
        let vertices = positions.iter().map(|&p| point(p)).collect();
        let cdt = Cdt::try_bulk_load_cdt(vertices, edges.iter().map(|e| e.map(|v| v as usize)).collect(), |e| {
            conflicts.push(e.map(|v| v as u32));
        });
        return Ok(Triangulated { cdt: cdt.map_err(refused)?, order: None, conflicts });
    };
    let order: Vec<u32> = rounds.iter().flat_map(|round| &round.points).copied().collect();
    let place = places(&order);
    let mut cdt = Cdt::default();
    for round in &rounds {
        for &v in &round.points {
            cdt.insert(point(positions[v as usize])).map_err(refused)?;
        }
        for ends in round.edges.iter().map(|&e| edges[e as usize]) {
            let [from, to] = ends.map(|v| handle(v, Some(&place)));
            if cdt.try_add_constraint(from, to).is_empty() {
                conflicts.push(ends);
            }
        }
    }
    Ok(Triangulated { cdt, order: Some(order), conflicts })
}

/// The place of each position in an order.
fn places(order: &[u32]) -> Vec<u32> {
    let mut place = vec![0; order.len()];
    order.iter().enumerate().for_each(|(k, &v)| place[v as usize] = k as u32);
    place
}

/// The vertex of a position.
fn handle(v: u32, place: Option<&[u32]>) -> FixedVertexHandle {
    FixedVertexHandle::from_index(place.map_or(v, |place| place[v as usize]) as usize)
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
