//! How the smooth surface is drawn: what the caller may set, and what is chosen from the data.

use super::{curvature_gain, shrinkage};
use crate::base::Grid;
use crate::tuning::SplineTuning;

/// Cells that heights are wanted on.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Wanted {
    /// Square cells of this size (map units) on multiples of it.
    Cell(f64),
    /// These.
    Grid(Grid),
}

/// How the smooth surface is drawn.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct SplineParams {
    /// Where heights are wanted, if anywhere: the working grid then shares its nodes.
    pub wanted: Option<Wanted>,
    /// Tension without dimension: weight of first against second differences, times mean gap times local gap between
    /// contours. More of it, and the surface is nearer to the one with ridge and canyon lines. `None`: chosen from the data.
    pub tension: Option<f64>,
    /// How much the contours jitter: 0 for smooth ones, 1 for those of unsmoothed lidar. The surface is first found with
    /// less regard for them, then moved to meet them. `None`: 0 or 1, as the contours look.
    pub noise: Option<f64>,
}

/// What is chosen from the data.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct HyperParameters {
    /// See [`SplineParams::tension`].
    pub tension: f64,
    /// See [`SplineParams::noise`].
    pub noise: f64,
    /// The bending across ridge and canyon lines from which on it counts with its size, not its square, as a share of that
    /// elsewhere: less of it, and they are sharper.
    pub crease_threshold: f64,
    /// Standard error half-way between two contours, metres, as hidden ones tell; 0 where it is not known. Heights are drawn
    /// from the levels towards the middle between them for it.
    pub half_way_error: f64,
    /// By how much the relief of the surface is less than the ground's, as a share of that error, as hidden contours tell.
    pub curvature_gain: f64,
}

impl HyperParameters {
    /// What is left of a standard error (metres) in a band of a height (metres), after shrinkage and curvature gain.
    pub(crate) fn error_left(&self, error: f64, height: f64, tuning: &SplineTuning) -> f64 {
        let SplineTuning { shrinkage, gain, .. } = tuning;
        let error = if self.half_way_error > 0.0 { shrinkage::left(error, height, shrinkage.max_share) } else { error };
        curvature_gain::left(error, self.curvature_gain, gain.error_reduction)
    }
}
