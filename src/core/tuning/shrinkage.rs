//! Shrinkage of heights towards the centre of their band, and the curvature gain that follows.

use super::tuned;

tuned! {
    /// Shrinkage towards the centre of the band.
    ShrinkageTuning {
        /// Largest shrinkage, as a share of the distance from the centre.
        ///
        /// Tried 0.25 and 1: the RMSE of two maps changes by -0.04 % and -0.03 %.
        ///
        /// Refit: RMSE.
        max_share: f32 = 0.5,
        /// Nodes from contour to contour where half of the variance of the error is left, because contours cross so
        /// many edges between nodes.
        ///
        /// Tried 2.5 and 10: the RMSE of two maps changes by +0.10 % and -0.01 %.
        ///
        /// Refit: RMSE.
        half_variance_nodes: f32 = 5.0,
        /// Nodes from contour to contour where the relative variance of trial surfaces, from half of the levels, is twice that
        /// of the surface itself. Fewer nodes: more than twice.
        ///
        /// Tried 0 and constant shares from 0.45 to 0.9 on six maps: the RMSE changes by +0.6 % and -0.04 to +0.5 %.
        ///
        /// Refit: RMSE.
        trial_nodes: f64 = 4.0,
        /// How far distances between contours are averaged, spacings.
        ///
        /// Tried 0.25 and 1: the RMSE of two maps changes by +0.32 % and -0.43 %.
        ///
        /// Refit: RMSE; steps in the surface where the density of the contours changes.
        spacing_reach: f64 = 0.5,
        /// Radius around a node within which the unevenness of the ground is measured, spacings.
        ///
        /// Tried 0.5 and 2: the RMSE of two maps changes by +0.83 % and -0.79 %.
        ///
        /// Refit: RMSE.
        unevenness_reach: f64 = 1.0,
        /// Power with which the variance of the error grows with the product of distance between contours and
        /// unevenness.
        ///
        /// Tried 0.35 and 1.4: the RMSE of four maps changes by -0.08 % and +1.88 %.
        ///
        /// Refit: RMSE.
        power: f32 = 0.7,
    }
}

tuned! {
    /// Curvature gain: ridges get higher and valleys deeper than on a surface of minimum curvature.
    GainTuning {
        /// Reach of the surroundings that the height of a node is compared with, spacings.
        ///
        /// Tried 0.375 and 1.5: the RMSE of two maps changes by +0.66 % and -0.44 %.
        ///
        /// Refit: RMSE.
        reach: f64 = 0.75,
        /// Height above the surroundings where the gain is largest, as a share of the contour interval.
        ///
        /// Tried 0.05 and 0.2: the RMSE of two maps changes by -0.50 % and +0.58 %.
        ///
        /// Refit: RMSE.
        peak: f32 = 0.1,
        /// Share of the standard error that disappears where all of the gain is applied. It grows with the square of
        /// the gain. From map to map it is between nothing and a quarter.
        ///
        /// Tried 0.075 and 0.3: the share of errors within one standard error of two maps changes by +0.5 and -0.9
        /// points.
        ///
        /// Refit: shares.
        error_reduction: f64 = 0.15,
    }
}
