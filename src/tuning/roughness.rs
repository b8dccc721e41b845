//! How rough contours are.

use super::tuned;

tuned! {
    /// The exponent that offsets of contours from their chords grow with: about 2 for smooth lines, about 0 for jitter.
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
        /// The exponent where the contours do not tell one.
        ///
        /// Refit: shares, on small maps.
        usual_exponent: f64 = 1.5,
        /// Limits of the power of the contour interval that the error is taken to grow with.
        ///
        /// Refit: shares.
        exponent_limits: [f64; 2] = [0.5, 2.0],
    }
}

impl RoughnessTuning {
    /// The power of the contour interval that the error grows with, from the exponent of the contours if it is known.
    pub fn power(&self, exponent: Option<f64>) -> f64 {
        let [least, most] = self.exponent_limits;
        exponent.unwrap_or(self.usual_exponent).clamp(least, most)
    }
}
