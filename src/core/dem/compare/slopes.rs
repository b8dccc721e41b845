//! Slopes of two height maps: how they are compared with bounds in degrees, and their error.

use serde::Serialize;

/// The difference of slopes, A − B.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct SlopeError {
    /// Cells that have all eight neighbours in both.
    pub cells: usize,
    /// Root mean square difference, degrees.
    pub rmse: f64,
    /// Mean difference, degrees. Below 0 where A is smoother.
    pub bias: f64,
}

/// Sums of the differences of slopes.
#[derive(Debug, Default)]
pub(super) struct SlopeSums {
    cells: usize,
    sum: f64,
    squares: f64,
}

impl SlopeSums {
    /// Takes the differences in a row, degrees.
    pub fn add(&mut self, row: &[f64]) {
        self.cells += row.len();
        self.sum += row.iter().sum::<f64>();
        self.squares += row.iter().map(|d| d * d).sum::<f64>();
    }

    /// The error. `None` if there are no differences.
    pub fn error(&self) -> Option<SlopeError> {
        let count = self.cells as f64;
        let error = || SlopeError { cells: self.cells, rmse: (self.squares / count).sqrt(), bias: self.sum / count };
        (self.cells > 0).then(error)
    }
}

/// The smallest slope of at least some degrees, as rise over run in single precision.
pub(super) fn steepness_of(bound: f64) -> f64 {
    let degrees = |steepness: f32| f64::from(steepness).atan().to_degrees();
    let (mut low, mut high) = (0, f32::INFINITY.to_bits());
    while low < high {
        let middle = low.midpoint(high);
        if degrees(f32::from_bits(middle)) >= bound { high = middle } else { low = middle + 1 }
    }
    f32::from_bits(low).into()
}
