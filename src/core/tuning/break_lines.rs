//! Break lines.

use super::tuned;

tuned! {
    /// How break lines with heights are brought into agreement with contours.
    BreakLineTuning {
        /// Vertices of break lines per spacing.
        ///
        /// Refit: RMSE and time.
        vertices_per_spacing: f64 = 6.0,
        /// Nodes of the working grid per distance between neighbouring break lines, at least, where lines with heights run
        /// beside each other.
        ///
        /// Tried 1 and 4 on a surveyed road, with lines about 1 m apart and cells of 1 m: the same grid.
        ///
        /// Refit: RMSE near break lines, and time.
        nodes_per_line_spacing: f64 = 2.0,
        /// Heights that contradict the contours by more than this are a finding, in intervals.
        told: f64 = 0.05,
        /// Heights that contradict the contours by more than this are not used, in intervals.
        ///
        /// Refit: RMSE.
        wrong: f64 = 0.5,
    }
}
