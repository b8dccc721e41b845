//! Cliffs.

use super::tuned;

tuned! {
    /// How far cliffs act.
    CliffTuning {
        /// Contours that end, cross or run together nearer to a cliff than this do so because of it, in spacings.
        reach: f64 = 0.5,
        /// Ground nearer to a cliff than this follows the contours on its own side alone, in spacings.
        ///
        /// Refit: RMSE near cliffs.
        free: f64 = 1.0,
    }
}
