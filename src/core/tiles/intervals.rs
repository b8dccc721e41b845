//! Which contours a zoom shows.
//!
//! A zoom shows the smallest round interval whose lines lie [`APART`] pixels from each other on a slope of 45°, where a tile is
//! [`DRAWN`] pixels wide. In the middle latitudes this is 10 m at zoom 14, 20 m at 13, 50 m at 12, 100 m at 11: the intervals of
//! the contour tiles that styles are made for.

use glam::DVec2;

use super::mercator::{latitude, tile_size};
use crate::base::error::{Error, Result};

/// Pixels of a tile's side, as map libraries draw vector tiles.
const DRAWN: f64 = 512.0;
/// Pixels from line to line on a slope of 45°.
const APART: f64 = 2.0;
/// The highest zoom that is chosen. A unit of its tiles is 15 cm at the equator.
const HIGHEST: u8 = 16;
/// The highest zoom that may be asked for. A unit of its tiles is 1 cm.
const MOST: u8 = 20;
/// Zooms below the one where the map's longer side has this many pixels are left out.
const SMALLEST: f64 = 128.0;

/// A zoom, and the interval that it shows.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ZoomInterval {
    /// The zoom.
    pub zoom: u8,
    /// Its interval is this many times the interval of the lines.
    pub multiple: u32,
}

/// The intervals of all zooms for a map in Web Mercator from `low` to `high`, in order of the zoom. Its lines have an interval
/// of `step` times `metres`, the metres in a unit of heights. The highest zoom is the first that shows all lines.
pub fn intervals(step: f64, metres: f64, low: DVec2, high: DVec2) -> Vec<ZoomInterval> {
    let on_ground = latitude(low.midpoint(high)).cos();
    let needed = |zoom: u8| APART * tile_size(zoom) * on_ground / DRAWN / metres;
    let highest = (0..HIGHEST).find(|zoom| needed(*zoom) <= step).unwrap_or(HIGHEST);
    let lowest = lowest_zoom(high - low, highest);
    let multiple = |zoom: u8| if zoom == highest { 1 } else { multiple(step, needed(zoom)) };
    (lowest..=highest).map(|zoom| ZoomInterval { zoom, multiple: multiple(zoom) }).collect()
}

/// The lowest zoom of tiles for a map of this width and height in Web Mercator metres: below it, the map is smaller than 128
/// pixels.
pub fn lowest_zoom(size: DVec2, highest: u8) -> u8 {
    let pixels = |zoom: u8| size.max_element() / tile_size(zoom) * DRAWN;
    (0..highest).find(|zoom| pixels(*zoom) >= SMALLEST).unwrap_or(highest)
}

/// The multiple of an interval that is at least `needed`: one that gives 1, 2 or 5 times a power of ten, if it is less than twice
/// as large as the smallest of 1, 2, 5, 10 times the interval and so on.
fn multiple(step: f64, needed: f64) -> u32 {
    let multiples = || (0..9).flat_map(|power| [1, 2, 5].map(|digit| digit * 10_u32.pow(power)));
    let smallest = multiples().find(|m| f64::from(*m) * step >= needed).unwrap_or(1);
    let most = 2.0 * f64::from(smallest) * step;
    let powers = (-9..10).flat_map(|power| [1.0, 2.0, 5.0].map(|digit| digit * 10_f64.powi(power)));
    let round = powers
        .map(|interval| interval / step)
        .find(|m| m * step >= needed && m * step < most && m.round() >= 1.0 && (m - m.round()).abs() < 1e-9 * m);
    round.map_or(smallest, |m| m.round() as u32)
}

/// The intervals of all zooms by those that are given: pairs of a zoom and an interval, which holds until the next pair. The
/// last pair is the highest zoom. `step` is the interval of the lines.
///
/// # Errors
/// There is no pair, zooms are not in order or too high, or an interval is not a whole multiple of `step`.
pub fn given_intervals(pairs: &[(u8, f64)], step: f64) -> Result<Vec<ZoomInterval>> {
    let wrong = |message: String| Err(Error::Parameter(format!("--zooms: {message}")));
    let (Some(first), Some(last)) = (pairs.first(), pairs.last()) else {
        return wrong("no zoom is given".into());
    };
    if last.0 > MOST {
        return wrong(format!("zoom {} is too high, the highest is {MOST}", last.0));
    }
    if pairs.windows(2).any(|pair| pair[0].0 >= pair[1].0) {
        return wrong("zooms must ascend".into());
    }
    let mut multiples = Vec::new();
    for (zoom, interval) in pairs {
        let multiple = (interval / step).round();
        if !(multiple >= 1.0
            && multiple <= f64::from(u32::MAX)
            && (multiple * step - interval).abs() <= 1e-9 * interval)
        {
            return wrong(format!(
                "the interval {interval} at zoom {zoom} is not a whole multiple of the lines' interval {step}"
            ));
        }
        multiples.push((*zoom, multiple as u32));
    }
    let of = |zoom: u8| multiples.iter().rev().find(|(from, _)| *from <= zoom).map_or(1, |(_, multiple)| *multiple);
    Ok((first.0..=last.0).map(|zoom| ZoomInterval { zoom, multiple: of(zoom) }).collect())
}

/// Whether a zoom that shows every `multiple`-th level has this one. `steps` is the number of intervals from the base to the
/// level; a level between them is shown where all are.
pub fn is_shown(steps: f64, multiple: u32) -> bool {
    let turns = steps / f64::from(multiple);
    multiple <= 1 || (turns - turns.round()).abs() * f64::from(multiple) < 1e-6
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tiles::HALF_WIDTH;

    #[test]
    fn intervals_are_those_of_common_styles() {
        // 45 degrees north, 100 km wide.
        let low = DVec2::new(0.0, 5_621_521.0);
        let shown = |step: f64| {
            let all = intervals(step, 1.0, low, low + 100e3);
            all.iter().map(|z| (z.zoom, f64::from(z.multiple) * step)).collect::<Vec<_>>()
        };
        let tens = [(8, 500.0), (9, 500.0), (10, 200.0), (11, 100.0), (12, 50.0), (13, 20.0), (14, 10.0)];
        assert_eq!(shown(10.0)[shown(10.0).len() - 7..], tens);
        assert_eq!(shown(20.0).last(), Some(&(13, 20.0)));
        let fives = [(11, 100.0), (12, 50.0), (13, 20.0), (14, 10.0), (15, 5.0)];
        assert_eq!(shown(5.0)[shown(5.0).len() - 5..], fives);
        let fours = [(12, 40.0), (13, 20.0), (14, 8.0), (15, 4.0)];
        assert_eq!(shown(4.0)[shown(4.0).len() - 4..], fours);
        assert_eq!(shown(1.0).last(), Some(&(16, 1.0)), "no zoom above 16");
        assert_eq!(shown(1.0)[shown(1.0).len() - 2], (15, 5.0));
        // A map smaller than a tile at the highest zoom has one zoom at least.
        assert_eq!(intervals(100.0, 1.0, low, low + 10.0).len(), 1);
        assert_eq!(
            intervals(1e6, 1.0, DVec2::splat(-HALF_WIDTH), DVec2::splat(HALF_WIDTH)),
            [ZoomInterval { zoom: 0, multiple: 1 }]
        );
    }

    #[test]
    fn given_intervals_hold_until_the_next_pair() {
        let all = given_intervals(&[(10, 100.0), (12, 20.0), (14, 5.0)], 5.0).unwrap();
        let pairs: Vec<_> = all.iter().map(|z| (z.zoom, z.multiple)).collect();
        assert_eq!(pairs, [(10, 20), (11, 20), (12, 4), (13, 4), (14, 1)]);
        assert!(given_intervals(&[(1, 0.3)], 0.1).is_ok());
        for wrong in [
            &[][..],
            &[(3, 5.0), (3, 5.0)],
            &[(4, 5.0), (3, 5.0)],
            &[(21, 5.0)],
            &[(3, 7.0)],
            &[(3, 0.0)],
            &[(3, -5.0)],
        ] {
            assert!(given_intervals(wrong, 5.0).unwrap_err().to_string().contains("--zooms"), "{wrong:?}");
        }
        assert!(given_intervals(&[(3, f64::NAN)], 5.0).is_err());
    }

    #[test]
    fn levels_are_shown_by_their_number() {
        assert!(is_shown(7.0, 1) && is_shown(7.5, 1));
        assert!(is_shown(-20.0, 10) && is_shown(0.0, 10) && is_shown(30.000_000_000_1, 10));
        assert!(!is_shown(5.0, 10) && !is_shown(7.5, 5));
    }
}
