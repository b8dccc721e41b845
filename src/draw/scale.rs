//! Round numbers: the scale bar, the heights below the tint.

use tokosen_core::base::ElevationUnit;

/// The longest scale bar, as a share of the map's width and in pixels.
const LONGEST: (f64, f64) = (0.4, 230.0);
/// Approximate number of labels below the tint.
const TICKS: f64 = 4.0;

/// Feet in a mile.
const MILE: f64 = 5280.0;

/// A scale bar.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Bar {
    /// Its length.
    pub pixels: f64,
    /// The number at its end.
    pub number: String,
    /// The number and the unit.
    pub label: String,
}

/// A scale bar of a round length on a map of so many pixels across, given the metres in a pixel or else the map units
/// in one. It is in feet and miles where heights are in feet. `None` if a pixel has no sensible size.
pub(super) fn bar(across: f64, metres: Option<f64>, units: f64, heights: ElevationUnit) -> Option<Bar> {
    let longest = (across * LONGEST.0).min(LONGEST.1);
    let feet = metres.filter(|_| heights.is_foot()).map(|metres| heights.about(metres));
    let (pixel, factor, unit) = match (metres, feet) {
        (_, Some(feet)) if feet * longest >= MILE => (feet, MILE, "mi"),
        (_, Some(feet)) => (feet, 1.0, "ft"),
        (Some(metres), _) if round_down(metres * longest)? >= 1000.0 => (metres, 1000.0, "km"),
        (Some(metres), _) => (metres, 1.0, "m"),
        (None, None) => (units, 1.0, "map units"),
    };
    let length = round_down(pixel * longest / factor)? * factor;
    let number = number(length / factor);
    Some(Bar { pixels: length / pixel, label: format!("{number} {unit}"), number })
}

/// The largest number 1, 2 or 5 times a power of ten that is not above `value`.
fn round_down(value: f64) -> Option<f64> {
    if !(value.is_finite() && value > 0.0) {
        return None;
    }
    round_near(value).take_while(|round| *round <= value * (1.0 + 1e-12)).last().filter(|round| *round > 0.0)
}

/// The smallest number 1, 2 or 5 times a power of ten that is not below `value`.
pub(super) fn round_up(value: f64) -> Option<f64> {
    if !(value.is_finite() && value > 0.0) {
        return None;
    }
    round_near(value).find(|round| *round >= value * (1.0 - 1e-12)).filter(|round| round.is_finite())
}

/// Round numbers in increasing order, some below and some above a number.
fn round_near(value: f64) -> impl Iterator<Item = f64> {
    let exponent = value.log10().floor() as i32;
    // The logarithm may be off by an ulp at a power of ten, hence the one below.
    (exponent - 1..=exponent + 1).flat_map(|e| [1.0, 2.0, 5.0].map(|digit| decimal(digit, e)))
}

fn decimal(digit: f64, exponent: i32) -> f64 {
    if exponent < 0 { digit / 10_f64.powi(-exponent) } else { digit * 10_f64.powi(exponent) }
}

/// Round heights from `low` to `high`; the height itself if they are the same.
pub(super) fn ticks(low: f64, high: f64) -> Vec<f64> {
    let Some(step) = round_down((high - low) / TICKS * 1.6) else { return vec![low] };
    let (first, last) = ((low / step).ceil(), (high / step).floor());
    (0..=(last - first).max(0.0) as usize).map(|i| (first + i as f64) * step).collect()
}

/// A number without needless digits.
pub(super) fn number(value: f64) -> String {
    let text = format!("{value:.4}");
    let text = text.trim_end_matches('0').trim_end_matches('.');
    if text == "-0" { "0".into() } else { text.to_owned() }
}

#[cfg(test)]
mod tests {
    use super::*;
    use tokosen_core::base::ElevationUnit::{Foot, Metre};

    #[test]
    fn bars_are_round_in_metres_or_in_map_units() {
        let label = |metres, units| bar(1000.0, metres, units, Metre).map(|bar| bar.label);
        assert_eq!(label(Some(10.0), 10.0).as_deref(), Some("2 km"));
        assert_eq!(label(Some(1.0), 1.0).as_deref(), Some("200 m"));
        assert_eq!(label(None, 10.0).as_deref(), Some("2000 map units"));
        // US survey feet: 230 pixels of 10 feet are 701 m.
        assert_eq!(label(Some(10.0 * 1200.0 / 3937.0), 10.0).as_deref(), Some("500 m"));
        assert_eq!(label(Some(92.0), 0.001).as_deref(), Some("20 km"));
        assert_eq!(label(None, f64::NAN), None);
        let in_feet = |metres| bar(1000.0, Some(metres), metres, Foot).map(|bar| bar.label);
        assert_eq!(in_feet(1.0).as_deref(), Some("500 ft"));
        assert_eq!(in_feet(10.0).as_deref(), Some("1 mi"));
        let bar = bar(1000.0, Some(10.0), 10.0, Metre).unwrap();
        assert_eq!((bar.pixels, bar.number.as_str()), (200.0, "2"));
    }

    #[test]
    fn round_numbers() {
        assert_eq!(round_down(1000.0), Some(1000.0));
        assert_eq!(round_down(999.0), Some(500.0));
        assert_eq!(round_down(0.03), Some(0.02));
        assert_eq!(round_down(0.0), None);
        assert_eq!(round_down(f64::MIN_POSITIVE / 4.0), None);
        assert_eq!([1000.0, 1000.1, 0.21, 6.0].map(round_up), [1000.0, 2000.0, 0.5, 10.0].map(Some));
        assert_eq!([0.0, -1.0, f64::NAN, f64::INFINITY].map(round_up), [None; 4]);
        assert_eq!(ticks(1320.0, 3190.0), [1500.0, 2000.0, 2500.0, 3000.0]);
        assert_eq!(ticks(7.5, 7.5), [7.5]);
        assert_eq!([1200.0, 0.25, -0.0, 3.0].map(number), ["1200", "0.25", "0", "3"]);
    }
}
