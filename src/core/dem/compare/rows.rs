//! What is computed for each row of two height maps: differences and slopes.

use glam::DVec2;

use crate::base::parallel;
use crate::raster::Block;
use crate::raster::gradient::gradients;

/// A row of the comparison.
#[derive(Debug, Default, Clone)]
pub(super) struct Row {
    /// The differences A − B, NaN where one of them has no height.
    pub differences: Vec<f64>,
    /// The slopes of B as rise over run, NaN where it has no height.
    pub steepness: Vec<f32>,
    /// The differences of slopes, degrees, of the cells that have all neighbours in both.
    pub slopes: Vec<f64>,
    /// The slopes of A, where all neighbours are known.
    steepness_a: Vec<f32>,
}

impl Row {
    /// The differences of heights.
    pub fn subtract(&mut self, a: &[f32], b: &[f32]) {
        let difference = |(&a, &b): (&f32, &f32)| {
            let d = f64::from(a) - f64::from(b);
            if d.is_finite() { d } else { f64::NAN }
        };
        self.differences.clear();
        self.differences.extend(a.iter().zip(b).map(difference));
    }

    /// The slopes of B.
    pub fn incline(&mut self, b: [Option<&[f32]>; 3], cell: DVec2) {
        let Self { differences, steepness, .. } = self;
        steepness.clear();
        steepness.resize(differences.len(), f32::NAN);
        gradients(b, cell, |col, gradient, _| steepness[col] = gradient.length() as f32);
    }

    /// The slopes of B, and their differences where all neighbours are known in both. So no height is extrapolated.
    pub fn compare_slopes(&mut self, a: [Option<&[f32]>; 3], b: [Option<&[f32]>; 3], cell: DVec2) {
        let Self { differences, steepness, slopes, steepness_a } = self;
        steepness_a.clear();
        steepness_a.resize(differences.len(), f32::NAN);
        gradients(a, cell, |col, gradient, is_whole| {
            if is_whole {
                steepness_a[col] = gradient.length() as f32;
            }
        });
        steepness.clear();
        steepness.resize(differences.len(), f32::NAN);
        slopes.clear();
        gradients(b, cell, |col, gradient, is_whole| {
            steepness[col] = gradient.length() as f32;
            let (a, b) = (f64::from(steepness_a[col]), f64::from(steepness[col]));
            if is_whole && !a.is_nan() {
                // The difference of two angles, by one arc tangent: both are from 0 to 90 degrees.
                slopes.push(((a - b) / (1.0 + a * b)).atan().to_degrees());
            }
        });
    }
}

/// The cells of a row of both height maps.
#[derive(Debug, Clone, Copy)]
pub(super) struct Cells<'a> {
    /// The index of the first cell.
    pub first: usize,
    /// What was computed.
    pub row: &'a Row,
    /// The heights of B.
    pub heights: &'a [f32],
    /// The distances to the nearest contour. Empty if there are none.
    pub distances: &'a [f64],
}

/// Computes each row of a block. `compute` gets its number in the raster.
pub(super) fn fill(block: &Block, rows: &mut Vec<Row>, compute: impl Fn(usize, &mut Row) + Sync) {
    rows.resize(block.rows.len(), Row::default());
    parallel::update(rows, |k, row| compute(block.rows.start + k, row));
}
