//! Ridge and canyon lines.

use super::tuned;

tuned! {
    /// Ridge and canyon lines and their heights.
    SkeletonTuning {
        /// Share of the band that a top without a spot height may use. Corners of the frame keep the default.
        ///
        /// Tried 0.45 and 1.8: the RMSE of two maps changes by +0.13 % and +0.42 %.
        ///
        /// Refit: RMSE of tops and pits.
        top_reach: f64 = 0.9,
        /// The same for a hollow. Sediment fills hollows and valleys, so their ground is mostly not far below the last
        /// contour.
        ///
        /// Tried 0.125 and 0.5: the RMSE of nine maps changes by +0.29 % and +0.96 %.
        ///
        /// Refit: RMSE of floors and pits.
        hollow_reach: f64 = 0.25,
        /// Least depth of a separate hollow below the pass to a deeper one, as a share of the band.
        ///
        /// Tried 0.05 and 0.2: the RMSE of two maps changes by +0.01 % and +0.06 %.
        ///
        /// Refit: RMSE.
        hollow_depth: f64 = 0.1,
        /// Largest distance from the tip of a bend, along the axis, in widths of the bend. Within it, a line from the
        /// other side of the contour is joined.
        ///
        /// Tried 1 and 4: the RMSE of two maps changes by -0.19 % and -0.15 %.
        ///
        /// Refit: RMSE.
        join_reach: f64 = 2.0,
        /// How near a point of a ridge or canyon line may be to the bank of a river area whose height is known from contours,
        /// as a share of the point's distance from the contours around. From a surveyed line it keeps the full distance.
        ///
        /// Refit: RMSE near river areas.
        stream_clearance: f64 = 0.25,
    }
}
