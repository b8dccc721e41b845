//! Wide places of the smooth surface.

use super::tuned;

tuned! {
    /// Wide places: ground where contours are much further apart than those around it.
    WideTuning {
        /// Distance between contours, against that of the contours around, where a place begins to be wide, and where
        /// it is wide in full.
        ///
        /// Tried one by one: the RMSE of nine maps changes by +1.71 % and -0.15 % with element 0 at 1 and 4; +4.61 % and
        /// -0.49 % with element 1 at 3 and 12.
        ///
        /// Refit: RMSE; error far from contours.
        jump_limits: [f64; 2] = [2.0, 6.0],
        /// Tension in a wide place, against that of the contours around.
        ///
        /// Tried 0.75 and 3: the RMSE of nine maps changes by -0.10 % and +0.28 %.
        ///
        /// Refit: RMSE; error far from contours.
        tension_factor: f64 = 1.5,
        /// How far a slope goes on into a wide place, at most, in spacings of the contours around. The floor at the toe
        /// of a slope then lies about this share of an interval below its last contour.
        ///
        /// Tried 0.2 and 0.8: the RMSE of nine maps changes by +3.23 % and -0.31 %.
        ///
        /// Refit: RMSE; error far from contours.
        slope_reach: f64 = 0.4,
        /// Share of the reference surface's slopes that the tension does not follow in a wide place. It draws to level
        /// ground by this share.
        ///
        /// Tried 0.2 and 0.8: the RMSE of nine maps changes by +0.02 % and +1.29 %.
        ///
        /// Refit: RMSE; error far from contours; stars and facets on plains.
        level_share: f32 = 0.4,
        /// Share of a wide place from which on ridge and canyon lines are no creases.
        ///
        /// Tried 0.25 and 1: the RMSE of nine maps changes by +0.13 % and -0.07 %. With 1 there are stars.
        ///
        /// Refit: RMSE; stars on plains.
        crease_limit: f32 = 0.5,
    }
}
