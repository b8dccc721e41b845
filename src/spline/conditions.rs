//! What the smooth surface on a grid has to meet, whatever the hyper-parameters.

use glam::{DVec2, DVec3};

use super::density::contour_density;
use super::lattice::{Crossing, Lattice};
use super::{curvature_gain, shrinkage};
use crate::base::Grid;
use crate::tuning::SplineTuning;

/// What the smooth surface on a grid has to meet. Arrays have a value per node, row by row from the north-west; NaN marks nodes
/// outside the frame.
pub struct Conditions<'a> {
    /// Its cells' centres are the nodes.
    pub grid: Grid,
    /// Level (metres) and vertices (map coordinates) of the contours.
    pub contours: Vec<(f64, &'a [DVec2])>,
    /// Spot heights: map position and height, metres.
    pub spots: Vec<DVec3>,
    /// Ridge and canyon lines, map coordinates.
    pub creases: Vec<Vec<DVec2>>,
    /// Contour interval, metres.
    pub interval: f64,
    /// Mean distance between neighbouring contours, map units.
    pub spacing: f64,
    /// Lowest and highest heights, metres.
    pub bounds: [Vec<f32>; 2],
    /// Heights of the reference surface, whose slopes the tension draws to, metres.
    pub reference: Vec<f32>,
    /// Whether water may stay at a node.
    pub hollows: Vec<bool>,
}

impl Conditions<'_> {
    /// What bulges and hollows of a surface on the grid lack ([`curvature_gain::unit_gain`]) if it may be off by a metre half-way between
    /// contours in the mean.
    pub fn unit_curvature_gain(&self, heights: &[f32], tuning: &SplineTuning) -> Vec<f32> {
        let Conditions { grid, spacing, interval, bounds: [lo, hi], reference, .. } = self;
        let lattice = Lattice::of_grid(grid);
        let contour_density = contour_density(reference, grid, *spacing, *interval, tuning.density_rounds);
        let spots = self.spot_crossings();
        let variances =
            shrinkage::variances(1.0, heights, &contour_density, *spacing, &lattice, &spots, &tuning.shrinkage);
        curvature_gain::unit_gain(heights, [lo, hi], &variances, *spacing, &lattice, *interval, &tuning.gain)
    }

    /// Spot heights as crossings of the edges between nodes.
    pub(super) fn spot_crossings(&self) -> Vec<(Crossing, f64)> {
        spot_crossings(&self.spots, &Lattice::of_grid(&self.grid), &self.reference)
    }
}

/// Spot heights, carried along the reference surface to the edges north and south of each.
fn spot_crossings(spots: &[DVec3], lattice: &Lattice, reference: &[f32]) -> Vec<(Crossing, f64)> {
    let mut found = Vec::new();
    for spot in spots {
        let place = lattice.place(spot.truncate());
        let (col, row) = (place.x.floor(), place.y.floor());
        if col < 0.0 || row < 0.0 || col as usize + 1 >= lattice.cols || row as usize + 1 >= lattice.rows {
            continue;
        }
        let (u, v) = (place.x - col, place.y - row);
        let node = row as usize * lattice.cols + col as usize;
        let below = node + lattice.cols;
        let g = |n: usize| f64::from(reference[n]);
        let north = g(node) * (1.0 - u) + g(node + 1) * u;
        let south = g(below) * (1.0 - u) + g(below + 1) * u;
        let here = north * (1.0 - v) + south * v;
        if here.is_finite() {
            // The guide passes through the spot itself; its slope carries the height to the edges north and south.
            found.push((Crossing { node: node as u32, along: u, at_vertex: false }, spot.z + north - here));
            found.push((Crossing { node: below as u32, along: u, at_vertex: false }, spot.z + south - here));
        }
    }
    found
}
