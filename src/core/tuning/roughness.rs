//! How rough contours are.

use super::tuned;

tuned! {
    /// The Hurst-like exponent of contours: the power with which their offsets from chords grow with the length of the
    /// chords. It is about 2 for smooth lines and about 0 for jitter.
    RoughnessTuning {
        /// Half the length of the chords, a short one and a long one, spacings.
        ///
        /// Tried one by one: the RMSE of two maps (in brackets the share of errors within one standard error) changes
        /// by +0.19 % and +1.89 % (+0.8 and +5.2 points) with element 0 at 0.125 and 0.5; +1.89 % and +0.02 % (+5.2
        /// and +0.1 points) with element 1 at 0.25 and 1.
        ///
        /// Refit: RMSE.
        chords: [f64; 2] = [0.25, 0.5],
        /// Contours with the first exponent, or a smaller one, are noisy; those with the second, or a larger one, are not;
        /// between them, their noise falls evenly. A spline is the best guess for lines whose exponent is 3/2 (integrated random
        /// walks).
        ///
        /// Refit: RMSE, on contours of unsmoothed lidar and on smooth ones.
        noisy_exponents: [f64; 2] = [1.3, 1.5],
        /// The exponent of contours that are too few to estimate it.
        ///
        /// Tried 0.75 and 3: no effect on the RMSE or the shares of two maps.
        ///
        /// Refit: shares, on small maps.
        usual_exponent: f64 = 1.4,
        /// By how much the power with which the error grows with the contour interval exceeds the exponent of the contours.
        ///
        /// Refit: RMSE and shares.
        power_excess: f64 = 0.15,
        /// Limits of the power with which the error grows with the contour interval.
        ///
        /// Tried one by one: the RMSE of two to four maps (in brackets the share of errors within one standard error)
        /// changes by 0 with element 0 at 0.25 and 1; +4.19 % and 0 % (+8.5 and -0.1 points) with element 1 at 1 and
        /// 4.
        ///
        /// Refit: shares.
        exponent_limits: [f64; 2] = [0.5, 2.0],
    }
}

impl RoughnessTuning {
    /// How noisy contours are, from 0 to 1; 0 if nothing shows it.
    pub fn noisy_share(&self, exponent: Option<f64>) -> f64 {
        let [noisy, smooth] = self.noisy_exponents;
        exponent.map_or(0.0, |exponent| ((smooth - exponent) / (smooth - noisy)).clamp(0.0, 1.0))
    }

    /// The power with which the error grows with the contour interval.
    pub fn power(&self, exponent: Option<f64>) -> f64 {
        let [least, most] = self.exponent_limits;
        (exponent.unwrap_or(self.usual_exponent) + self.power_excess).clamp(least, most)
    }
}
