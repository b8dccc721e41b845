//! Levels: the elevations that lines are drawn at.
//!
//! Levels are `base + k * step` with a whole number k. Elevations come as decimal text. So a level is the
//! floating-point number nearest to its decimal value (0.3, not 0.1 + 0.1 + 0.1). A reader of the text gets the same
//! number, so levels can be compared without a tolerance.

use super::map::Contour;

/// A height counts as lying on a level within this share of the step. It is far above the rounding of any elevation,
/// and far below the last digit that people write.
const ON_LEVEL: f64 = 1e-6;

/// Levels are made as decimal numbers if step and base have at most this many decimals.
const MAX_DECIMALS: i32 = 9;

/// The vertical (contour) interval of a map: its levels are `base + k * step` for whole numbers k.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Interval {
    /// Height between neighbouring levels, metres, positive.
    pub step: f64,
    /// Height of the level with k = 0, metres. From [`find_interval`](super::find_interval) it is at least 0 and less than
    /// the step.
    pub base: f64,
    /// How far a height may be from a level and still count as this level, metres. Elevations of maps are rounded: those of 50 ft
    /// are 15, 30, 46, 61 m. From [`find_interval`](super::find_interval), it is the largest such distance. 0 for levels that are
    /// not rounded.
    #[serde(default)]
    pub rounding: f64,
}

impl Interval {
    /// Levels at whole multiples of `step`, metres.
    pub fn every(step: f64) -> Self {
        Self { step, base: 0.0, rounding: 0.0 }
    }

    /// The largest distance of a height from its level, as a share of the step.
    fn on_level(&self) -> f64 {
        ON_LEVEL.max(self.rounding / self.step * (1.0 + ON_LEVEL))
    }

    /// The level number `k`, metres.
    ///
    /// Where step and base are decimal numbers of at most nine places, this is the nearest number to the exact decimal.
    pub fn level(&self, k: i64) -> f64 {
        let k = k as f64;
        for decimals in 0..=MAX_DECIMALS {
            let scale = 10f64.powi(decimals);
            let (step, base) = ((self.step * scale).round(), (self.base * scale).round());
            if step / scale == self.step && base / scale == self.base {
                return (base + k * step) / scale;
            }
        }
        self.base + k * self.step
    }

    /// The level number `k`: as it stands in the sorted list `levels`, if it is there up to rounding; otherwise as
    /// [`Interval::level`] makes it.
    pub fn level_among(&self, k: i64, levels: &[f64]) -> f64 {
        let made = self.level(k);
        let tolerance = self.on_level() * self.step;
        let from = levels.partition_point(|&z| z < made - tolerance);
        levels[from..]
            .iter()
            .copied()
            .take_while(|&z| z <= made + tolerance)
            .min_by(|a, b| (a - made).abs().total_cmp(&(b - made).abs()))
            .unwrap_or(made)
    }

    /// The number of the level nearest to the height `z`.
    pub fn index_of(&self, z: f64) -> i64 {
        ((z - self.base) / self.step).round() as i64
    }

    /// Whether the height `z` is a level, up to rounding.
    pub fn is_level(&self, z: f64) -> bool {
        let k = (z - self.base) / self.step;
        (k - k.round()).abs() <= self.on_level()
    }

    /// The lowest level strictly above the height `z`. For a height on a level (up to rounding), the next level.
    pub fn next_above(&self, z: f64) -> f64 {
        let k = (z - self.base) / self.step;
        let nearest = k.round();
        self.level(if (k - nearest).abs() <= self.on_level() { nearest + 1.0 } else { k.ceil() } as i64)
    }

    /// The highest level strictly below the height `z`. For a height on a level (up to rounding), the level before.
    pub fn next_below(&self, z: f64) -> f64 {
        let k = (z - self.base) / self.step;
        let nearest = k.round();
        self.level(if (k - nearest).abs() <= self.on_level() { nearest - 1.0 } else { k.floor() } as i64)
    }
}

/// The elevations of the contours, each once, from low to high. Elevations that are not finite are left out.
pub fn distinct_levels(contours: &[Contour]) -> Vec<f64> {
    let mut levels: Vec<f64> = contours.iter().map(|c| c.elevation + 0.0).filter(|z| z.is_finite()).collect();
    levels.sort_unstable_by(f64::total_cmp);
    levels.dedup();
    levels
}

#[cfg(test)]
mod tests {
    use glam::DVec2;

    use super::*;

    #[test]
    fn levels_are_decimal_numbers() {
        let tenth = Interval { step: 0.1, base: 0.0, rounding: 0.0 };
        assert_eq!(tenth.level(3), 0.3);
        assert_eq!(tenth.level(-7), -0.7);
        assert_eq!(tenth.level(12_345), 1234.5);
        let feet = Interval { step: 3.048, base: 0.0, rounding: 0.0 };
        assert_eq!(feet.level(7), 21.336);
        let offset = Interval { step: 2.5, base: 1.25, rounding: 0.0 };
        assert_eq!(offset.level(-1), -1.25);
        let survey_feet = Interval { step: 12_000.0 / 3937.0, base: 0.0, rounding: 0.0 };
        assert_eq!(survey_feet.level(100), 100.0 * survey_feet.step);
    }

    #[test]
    fn neighbours_are_strictly_above_and_below() {
        let tenth = Interval { step: 0.1, base: 0.0, rounding: 0.0 };
        assert_eq!(tenth.next_above(0.1 * 3.0), 0.4);
        assert_eq!(tenth.next_below(0.1 * 3.0), 0.2);
        assert_eq!(tenth.next_above(0.31), 0.4);
        assert_eq!(tenth.next_below(0.31), 0.3);
        let ten = Interval { step: 10.0, base: 5.0, rounding: 0.0 };
        assert_eq!((ten.next_below(-5.0), ten.next_above(-5.0)), (-15.0, 5.0));
        assert_eq!((ten.next_below(9.99), ten.next_above(9.99)), (5.0, 15.0));
        assert_eq!((ten.next_below(15.001), ten.next_above(14.999)), (15.0, 15.0));
        assert_eq!((ten.index_of(26.0), ten.index_of(-14.0)), (2, -2));
        assert!(ten.is_level(25.0) && !ten.is_level(20.0));
    }

    #[test]
    fn the_input_level_is_given_back() {
        let feet = Interval { step: 3.048, base: 0.0, rounding: 0.0 };
        let input = [3.048 * 6.0, 3.048 * 7.0, 3.048 * 9.0];
        assert_eq!(feet.level_among(7, &input).to_bits(), (3.048f64 * 7.0).to_bits());
        assert_eq!(feet.level_among(8, &input), 24.384);
        assert_eq!(feet.level_among(8, &[]), 24.384);
    }

    #[test]
    fn rounded_levels_count_as_their_levels() {
        let feet = Interval { step: 15.24, base: 0.0, rounding: 0.48 };
        assert!(feet.is_level(76.0) && feet.is_level(91.0) && !feet.is_level(84.0));
        assert_eq!((feet.index_of(91.0), feet.next_above(91.0), feet.next_below(91.0)), (6, 106.68, 76.2));
        assert_eq!(feet.level_among(6, &[76.0, 91.0]), 91.0);
    }

    #[test]
    fn absurd_heights_do_not_panic() {
        let ten = Interval { step: 10.0, base: 0.0, rounding: 0.0 };
        for z in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, f64::MAX] {
            let _ = (ten.next_above(z), ten.next_below(z), ten.index_of(z), ten.is_level(z));
        }
        let _ = (ten.level(i64::MAX), ten.level(i64::MIN));
    }

    #[test]
    fn distinct_levels_are_sorted_and_finite() {
        let lines: Vec<Contour> = [30.0, f64::NAN, -0.0, 10.0, 0.0, 30.0, f64::INFINITY]
            .map(|elevation| Contour { elevation, points: vec![DVec2::ZERO, DVec2::X], feature: 0.into() })
            .into();
        assert_eq!(distinct_levels(&lines), [0.0, 10.0, 30.0]);
        assert_eq!(distinct_levels(&[]), [0.0; 0]);
    }
}
