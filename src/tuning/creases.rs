//! Break lines.

use super::tuned;

tuned! {
    /// How break lines with heights are brought into agreement with contours.
    CreaseTuning {
        /// Vertices of break lines per spacing.
        ///
        /// Refit: RMSE and time.
        vertices_per_spacing: f64 = 6.0,
        /// Heights that contradict the contours by more than this are a finding, in intervals.
        told: f64 = 0.05,
        /// Heights that contradict the contours by more than this are not used, in intervals.
        ///
        /// Refit: RMSE.
        wrong: f64 = 0.5,
    }
}
