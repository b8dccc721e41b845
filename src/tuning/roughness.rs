//! How rough contours are.

use super::tuned;

tuned! {
    /// The Hurst-like exponent of contours: the power with which their offsets from chords grow with the length of the
    /// chords. It is about 2 for smooth lines and about 0 for jitter.
    RoughnessTuning {
        /// Half the length of the chords, a short one and a long one, spacings.
        ///
        /// Refit: RMSE.
        chords: [f64; 2] = [0.25, 0.5],
        /// Least number of chords of each length; with fewer the exponent is unknown.
        ///
        /// Refit: RMSE, on small maps.
        min_chords: usize = 200,
        /// Contours with a smaller exponent are noisy. A spline is the best guess for lines whose exponent is 3/2
        /// (integrated random walks).
        ///
        /// Refit: RMSE, on contours of unsmoothed lidar and on smooth ones.
        noisy_below: f64 = 1.5,
        /// The exponent of contours that are too few to estimate it.
        ///
        /// Refit: shares, on small maps.
        usual_exponent: f64 = 1.5,
        /// Limits of the power with which the error grows with the contour interval.
        ///
        /// Refit: shares.
        exponent_limits: [f64; 2] = [0.5, 2.0],
    }
}

impl RoughnessTuning {
    /// The power with which the error grows with the contour interval. It is the exponent of the contours, if known.
    pub fn power(&self, exponent: Option<f64>) -> f64 {
        let [least, most] = self.exponent_limits;
        exponent.unwrap_or(self.usual_exponent).clamp(least, most)
    }
}
