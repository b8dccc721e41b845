//! Classes of cells: by slope, by elevation, by distance to the nearest contour.

use serde::Serialize;

use super::Statistics;
use super::statistics::quantile;

/// Bounds of the classes of slope, degrees.
pub const SLOPE_BOUNDS: [f64; 6] = [0.0, 5.0, 15.0, 30.0, 45.0, 90.0];
/// Largest number of classes of elevation.
const MOST_CLASSES: f64 = 8.0;

/// Cells whose value is at least `from` and less than `to`, and the statistics of their differences.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Class {
    /// Lower bound; it belongs to the class.
    pub from: f64,
    /// Upper bound; it does not belong to the class. `None` if the class is open.
    pub to: Option<f64>,
    /// The statistics. `None` if no cell is in the class.
    pub statistics: Option<Statistics>,
}

/// The smallest of 1, 2 and 5 times a power of ten that is not below `value`, which is positive.
pub(super) fn round_up(value: f64) -> f64 {
    let power = 10f64.powi(value.log10().floor() as i32);
    // The tolerance keeps rounding from taking a number such as 0.3 for more than 3 tenths.
    [1.0, 2.0, 5.0].into_iter().map(|m| m * power).find(|r| *r >= value * (1.0 - 1e-12)).unwrap_or(10.0 * power)
}

/// Bounds of classes of elevation: multiples of a round number that cover the range. At most eight classes, mostly five
/// or more.
pub(super) fn elevation_bounds(lowest: f64, highest: f64) -> Vec<f64> {
    if !(lowest.is_finite() && highest.is_finite()) {
        return Vec::new();
    }
    // A range whose ends are both on bounds takes one class more.
    let range = if highest > lowest { (highest - lowest).max(1e-2) } else { MOST_CLASSES };
    let mut step = round_up(range / MOST_CLASSES);
    let count = |step: f64| (highest / step).floor() - (lowest / step).floor() + 1.0;
    while count(step) > MOST_CLASSES {
        step = round_up(step * 1.01);
    }
    let first = (lowest / step).floor();
    (0..=count(step) as u32).map(|k| (first + f64::from(k)) * step).collect()
}

/// Bounds of classes of distance. They double from a round number on. About half of the cells are in the first two
/// classes. The last class is open.
pub(super) fn distance_bounds(distances: impl Iterator<Item = f64>) -> Vec<f64> {
    let mut known: Vec<f64> = distances.filter(|d| d.is_finite()).collect();
    let median = quantile(&mut known, 0.5);
    if median.is_nan() || median <= 0.0 {
        return Vec::new();
    }
    let unit = round_up(median / 2.0);
    vec![0.0, unit, 2.0 * unit, 4.0 * unit, 8.0 * unit, f64::INFINITY]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn round_numbers() {
        for (value, expected) in
            [(1.0, 1.0), (1.1, 2.0), (3.0, 5.0), (7.0, 10.0), (0.2, 0.2), (0.03, 0.05), (500.0, 500.0)]
        {
            assert!((round_up(value) / expected - 1.0).abs() < 1e-9, "{value}: {}", round_up(value));
        }
    }

    #[test]
    fn elevations_fall_into_few_round_classes() {
        assert_eq!(elevation_bounds(12.0, 397.0), [0.0, 50.0, 100.0, 150.0, 200.0, 250.0, 300.0, 350.0, 400.0]);
        assert_eq!(elevation_bounds(-3.0, 4.0), [-3.0, -2.0, -1.0, 0.0, 1.0, 2.0, 3.0, 4.0, 5.0]);
        for (lowest, highest) in [(5.0, 5.0), (0.0, 800.0), (99.9, 100.1), (-12_000.0, 9000.0), (1e5, 1e5 + 0.25)] {
            let bounds = elevation_bounds(lowest, highest);
            assert!((2..=9).contains(&bounds.len()), "{bounds:?}");
            assert!(bounds[0] <= lowest && highest < bounds[bounds.len() - 1], "{lowest} {highest} {bounds:?}");
        }
        assert!(elevation_bounds(f64::INFINITY, f64::NEG_INFINITY).is_empty());
    }

    #[test]
    fn distances_double() {
        let bounds = distance_bounds([f64::NAN, 1.0, 7.0, 30.0].into_iter());
        assert_eq!(bounds, [0.0, 5.0, 10.0, 20.0, 40.0, f64::INFINITY]);
        assert!(distance_bounds(std::iter::empty()).is_empty());
        assert!(distance_bounds([0.0, 0.0].into_iter()).is_empty());
    }
}
