//! The axis while it is built.

use std::collections::HashSet;

use glam::DVec2;

use super::pieces::{Axis, AxisPoint, End};
use crate::subdomains::{Regions, Side};
use crate::tin::Tin;

/// The axis while it is built, and where its pieces run.
pub(super) struct AxisBuilder {
    pub axis: Axis,
    /// The axis point on each edge of each triangle, [`NONE`] where the edge is no chord.
    pub of_edge: Vec<[u32; 3]>,
    /// The piece through each triangle that has exactly one, otherwise [`NONE`].
    pub piece_of: Vec<u32>,
    /// Where lines reach the next contour.
    pub arrivals: Vec<Arrival>,
    /// Triangles with a side line. No triangle has two, because they could cross.
    pub crossed: HashSet<u32>,
}

/// Where a line reaches the next contour.
#[derive(Debug, Clone, Copy)]
pub(super) struct Arrival {
    /// The contour's vertex.
    pub vertex: u32,
    /// The sub-domain that the line comes from.
    pub region: u32,
    /// Its last triangle.
    pub triangle: u32,
}

impl AxisBuilder {
    /// Adds the point of a level in a triangle, and returns its number.
    pub fn add_point(&mut self, regions: &Regions, t: u32, position: DVec2, level: f64) -> u32 {
        let region = regions.of_triangle[t as usize];
        self.axis.points.push(AxisPoint { position, level: Some(level), triangle: t, region });
        (self.axis.points.len() - 1) as u32
    }

    /// Adds the one piece of a triangle.
    pub fn add_piece(&mut self, t: u32, from: u32, to: End) {
        self.piece_of[t as usize] = self.axis.pieces.len() as u32;
        self.axis.pieces.push([End::Axis(from), to]);
    }
}

/// The side of the contour on which the ground beyond an arrival lies: it continues to fall, or to rise.
pub(super) fn beyond(tin: &Tin, regions: &Regions, arrival: &Arrival) -> Option<Side> {
    let level = tin.heights[arrival.vertex as usize];
    regions.regions[arrival.region as usize].side(level).map(|side| match side {
        Side::Above => Side::Below,
        Side::Below => Side::Above,
    })
}
