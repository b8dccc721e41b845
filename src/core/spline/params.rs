//! Parameters of the smooth surface: what the caller may set, and what is chosen from the data.

use super::{curvature_gain, shrinkage};
use crate::base::Grid;
use crate::tuning::SplineTuning;

/// The cells that heights are wanted on.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Wanted {
    /// Square cells of this size (map units) on multiples of it.
    Cell(f64),
    /// The cells of this grid.
    Grid(Grid),
}

/// Parameters of the smooth surface.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct SplineParams {
    /// Cells that heights are wanted on, if any. The working grid then shares nodes with them.
    pub wanted: Option<Wanted>,
    /// Tension, without dimension: weight of first against second differences, times mean spacing times local spacing
    /// of the contours. With more tension, the surface is nearer to the reference surface, which has ridge and canyon
    /// lines. `None`: chosen from the data.
    pub tension: Option<f64>,
    /// Noise of the contours: 0 for smooth contours, 1 for those of unsmoothed lidar. Noisy contours are first given a
    /// low weight. Then the surface is moved to meet them. `None`: 0 to 1, depending on the contours.
    pub noise: Option<f64>,
}

/// The hyper-parameters: what is chosen from the data.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct HyperParameters {
    /// See [`SplineParams::tension`].
    pub tension: f64,
    /// See [`SplineParams::noise`].
    pub noise: f64,
    /// IRLS threshold across ridge and canyon lines, as a share of the threshold elsewhere. Below it, bending counts
    /// with its square, above it with its size. A lower threshold makes ridges and valleys sharper.
    pub crease_threshold: f64,
    /// Standard error half-way between two contours, metres, found with hidden contours; 0 if it is not known. With it,
    /// heights shrink towards the centre of their band.
    pub half_way_error: f64,
    /// Mean of the relative variance of the surface where this error was found. Errors elsewhere are larger or smaller with
    /// the root of theirs. 0 if it is not known; the mean of the map takes its place.
    pub relative_variance: f64,
    /// Curvature gain, as a share of that error, found with hidden contours.
    pub curvature_gain: f64,
}

impl HyperParameters {
    /// The standard error (metres) that remains after shrinkage and curvature gain, in a band of `height` (metres).
    pub(crate) fn error_left(&self, error: f64, height: f64, tuning: &SplineTuning) -> f64 {
        let SplineTuning { shrinkage, gain, .. } = tuning;
        let error = if self.half_way_error > 0.0 {
            shrinkage::remaining_error(error, height, shrinkage.max_share)
        } else {
            error
        };
        curvature_gain::remaining_error(error, self.curvature_gain, gain.error_reduction)
    }
}
