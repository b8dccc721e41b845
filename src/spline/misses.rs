//! What a surface on a grid misses at the contours.
//!
//! Where several contours pass between two nodes, the nodes do not tell where. What the surface misses at the vertices of the
//! contours is then linear in the triangles between them.

use glam::DVec2;

use super::conditions::Conditions;
use super::working_grid::WorkingGrid;
use crate::base::parallel;
use crate::tin::{NONE, Tin};

/// Distances between contours, in steps between nodes, up to which misses count in full, and from which they do not count. Where
/// contours are further apart, the nodes tell enough.
const REACH: [f64; 2] = [3.0, 6.0];

/// What a surface misses at the contours.
pub(crate) struct Misses<'a> {
    tin: &'a Tin,
    /// At the vertices of the triangulation, metres; 0 off the contours.
    at_vertices: Vec<f32>,
    /// The step between nodes, map units.
    step: f64,
}

impl<'a> Misses<'a> {
    /// `levels` are those of the contours at the vertices of `tin`, NaN elsewhere. `at` gives the surface at a map position;
    /// its nodes are `step` apart.
    pub fn new(tin: &'a Tin, levels: &[f32], step: f64, at: impl Fn(DVec2) -> f32 + Sync) -> Self {
        let missed = |v: usize| {
            let missed = if levels[v].is_nan() { 0.0 } else { levels[v] - at(tin.positions[v] + tin.origin) };
            if missed.is_nan() { 0.0 } else { missed }
        };
        Self { tin, at_vertices: parallel::values(levels.len(), missed), step }
    }

    /// What is missed at a place in triangle `t`, relative to the origin of the triangulation, metres.
    pub fn at(&self, t: u32, place: DVec2) -> f32 {
        let missed = self.tin.triangles[t as usize].map(|v| self.at_vertices[v as usize]);
        let share = if missed == [0.0; 3] { 0.0 } else { self.share(t) };
        if share == 0.0 {
            return 0.0;
        }
        // A place at the border of a sliver may have any weights, by rounding.
        let weights = self.tin.weights(t, place).map(|weight| weight.clamp(0.0, 1.0) as f32);
        let sum: f32 = weights.into_iter().zip(missed).map(|(weight, missed)| weight * missed).sum();
        if sum.is_nan() { 0.0 } else { share * sum }
    }

    /// How far the misses count in triangle `t`, 0 to 1. It depends on the shortest way from one level to another.
    fn share(&self, t: u32) -> f32 {
        let heights = self.tin.corner_heights(t);
        let across = (0..3).filter(|&i| heights[i] != heights[(i + 1) % 3]).map(|i| self.tin.edge_length(t, i));
        let steps = across.fold(f64::INFINITY, f64::min) / self.step;
        let [full, none] = REACH;
        ((none - steps) / (none - full)).clamp(0.0, 1.0) as f32
    }
}

/// Adds to the nodes what the surface misses at the contours around them. Nodes stay within their bounds `lo` and `hi`.
pub(super) fn add_misses(working: &mut WorkingGrid, conditions: &Conditions<'_>, [lo, hi]: [&[f32]; 2]) {
    let Conditions { tin, levels, triangles, beside_cliffs, grid, .. } = conditions;
    let misses = Misses::new(tin, levels, grid.cell.max_element(), |p| working.at(p));
    parallel::update(&mut working.heights, |n, height| {
        // Across a cliff, the surface between nodes tells nothing.
        if triangles[n] != NONE && beside_cliffs.get(n) != Some(&true) {
            let place = grid.center(n % grid.cols, n / grid.cols) - tin.origin;
            *height = (*height + misses.at(triangles[n], place)).clamp(lo[n], hi[n]);
        }
    });
}
