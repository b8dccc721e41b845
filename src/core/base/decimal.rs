//! Short decimal numbers.

/// Most decimals that are tried.
const MOST_DECIMALS: i32 = 9;

/// The number with the fewest decimals between two others; the middle if there is none with few decimals.
pub fn shortest_between(low: f64, high: f64) -> f64 {
    let middle = low + (high - low) / 2.0;
    let decimal = |places: i32| {
        let scale = 10f64.powi(places);
        (middle * scale).round() / scale
    };
    (0..=MOST_DECIMALS).map(decimal).find(|z| (low..=high).contains(z)).unwrap_or(middle)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_fewest_decimals_win() {
        assert_eq!(shortest_between(99.999_998_5, 100.000_001_5), 100.0);
        assert_eq!(shortest_between(100.0, 100.001), 100.0);
        assert_eq!(shortest_between(12.192, 12.192_000_3), 12.192);
        assert_eq!(shortest_between(-0.5, -0.5), -0.5);
        assert_eq!(shortest_between(1.0 / 3.0, 1.0 / 3.0), 1.0 / 3.0);
    }
}
