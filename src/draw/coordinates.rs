//! Coordinates along the edges of a map: round values, where they meet the edge, and how they are written.
//!
//! The coordinates need not be those of the map's plane. A map on a plane in metres can have degrees along its edges: the
//! conversion is followed along each edge. So the ticks of opposite edges may differ, as on a printed sheet.

use glam::DVec2;

use super::scale::{self, number};
use tokosen_core::crs::Crs;

/// Neighbouring labels are at least this far apart, pixels.
const APART: f64 = 150.0;
/// On a short edge they may be as close as this, pixels, so that it has two of them.
const CLOSEST: f64 = 90.0;
/// Points along an edge at which its coordinates are computed.
const SAMPLES: usize = 128;
/// Seconds of arc of the steps of degrees from one second on.
const ARCS: [f64; 19] = [
    1.0, 2.0, 5.0, 10.0, 15.0, 30.0, 60.0, 120.0, 300.0, 600.0, 900.0, 1800.0, 3600.0, 7200.0, 18_000.0, 36_000.0,
    54_000.0, 108_000.0, 162_000.0,
];

/// How coordinates are written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Notation {
    /// A number of map units.
    Plain,
    /// A number of map units, east or north of the origin.
    Plane,
    /// Degrees, minutes and seconds of longitude and latitude.
    Degrees,
}

impl Notation {
    /// That of the coordinates of a system.
    pub fn of(crs: Option<&Crs>) -> Self {
        match crs {
            Some(crs) if crs.is_geographic() => Self::Degrees,
            Some(_) => Self::Plane,
            None => Self::Plain,
        }
    }
}

/// A coordinate on an edge.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Tick {
    /// Distance from the left or the upper end of the edge, pixels.
    pub at: f64,
    /// The coordinate.
    pub text: String,
}

/// The ticks of the four edges: eastings above and below, northings left and right.
#[derive(Debug, Clone, Default, PartialEq)]
pub(super) struct Ticks {
    pub top: Vec<Tick>,
    pub bottom: Vec<Tick>,
    pub left: Vec<Tick>,
    pub right: Vec<Tick>,
}

/// Ticks around a map of some pixels across and down, given the coordinates of its pixels.
pub(super) fn ticks(size: DVec2, notation: Notation, place: impl Fn(DVec2) -> Option<DVec2>) -> Ticks {
    let corners = [(0.0, 0.0), (1.0, 0.0), (0.0, 1.0), (1.0, 1.0)].map(|(x, y)| DVec2::new(x, y) * size);
    let edge = |axis: usize, from: usize, to: usize| {
        (0..=SAMPLES)
            .map(|i| {
                let share = i as f64 / SAMPLES as f64;
                let value = place(corners[from].lerp(corners[to], share)).map(|p| p[axis]);
                (share * corners[from].distance(corners[to]), value.filter(|v| v.is_finite()))
            })
            .collect::<Vec<_>>()
    };
    let edges = |axis: usize, edges: [(usize, usize); 2]| {
        let edges = edges.map(|(from, to)| edge(axis, from, to));
        // Both edges have the step of the one that needs the larger one.
        let step = edges.iter().filter_map(|edge| step(edge, notation)).max_by(f64::total_cmp);
        edges.map(|edge| step.map_or_else(Vec::new, |step| along(&edge, step, |v| text(v, step, axis, notation))))
    };
    let [top, bottom] = edges(0, [(0, 1), (2, 3)]);
    let [left, right] = edges(1, [(0, 2), (1, 3)]);
    Ticks { top, bottom, left, right }
}

/// The round step between the ticks of an edge.
fn step(edge: &[(f64, Option<f64>)], notation: Notation) -> Option<f64> {
    let length = edge.last()?.0;
    let values = edge.iter().filter_map(|(_, value)| *value);
    let (lo, hi) = values.fold((f64::INFINITY, f64::NEG_INFINITY), |(lo, hi), v| (lo.min(v), hi.max(v)));
    let apart = APART.min(length / 2.5).max(CLOSEST);
    round_up((hi - lo) / length * apart, notation)
}

/// The smallest round step that is not below a value.
fn round_up(least: f64, notation: Notation) -> Option<f64> {
    let seconds = least * 3600.0;
    match notation {
        Notation::Plain | Notation::Plane => scale::round_up(least),
        Notation::Degrees if seconds > 0.5 => ARCS.into_iter().find(|arc| *arc >= seconds).map(|arc| arc / 3600.0),
        Notation::Degrees => scale::round_up(seconds).map(|arc| arc / 3600.0),
    }
}

/// Where the values of an edge are multiples of a step.
fn along(edge: &[(f64, Option<f64>)], step: f64, text: impl Fn(f64) -> String) -> Vec<Tick> {
    let mut ticks = Vec::new();
    for pair in edge.windows(2) {
        let [(from, Some(a)), (to, Some(b))] = [pair[0], pair[1]] else { continue };
        // Longitudes jump by a whole turn where they start anew.
        if a == b || (a - b).abs() > 180.0_f64.max(2.0 * step) && a.signum() != b.signum() && a.abs() <= 360.0 {
            continue;
        }
        let (lo, hi) = (a.min(b) / step, a.max(b) / step);
        let mut found: Vec<Tick> = (lo.ceil() as i64..=hi.floor() as i64)
            .map(|k| {
                let value = k as f64 * step;
                Tick { at: from + (to - from) * (value - a) / (b - a), text: text(value) }
            })
            .collect();
        if b < a {
            found.reverse();
        }
        // A value at a sample is the end of one piece and the start of the next.
        found.retain(|tick| ticks.last().is_none_or(|last: &Tick| last.text != tick.text));
        ticks.extend(found);
    }
    ticks
}

/// A coordinate along an axis (0 east, 1 north).
fn text(value: f64, step: f64, axis: usize, notation: Notation) -> String {
    let sign = |letters: [[&'static str; 2]; 2]| letters[axis][usize::from(value < 0.0)];
    match notation {
        Notation::Plain => grouped(value),
        Notation::Plane => format!("{} {}", grouped(value), sign([["E", "E"], ["N", "N"]])),
        Notation::Degrees => {
            let letter = if value == 0.0 { "" } else { sign([[" E", " W"], [" N", " S"]]) };
            format!("{}{letter}", arc(value.abs(), step * 3600.0))
        }
    }
}

/// Degrees, minutes and seconds, as far as the step of seconds needs them.
fn arc(degrees: f64, step: f64) -> String {
    // Thousandths of a second are three centimetres on the ground.
    let thousandths = (degrees * 3_600_000.0).round() as i64;
    let (seconds, rest) = (thousandths / 1000, thousandths % 1000);
    let (degrees, minutes, seconds) = (seconds / 3600, seconds / 60 % 60, seconds % 60);
    if step >= 3600.0 {
        format!("{degrees}°")
    } else if step >= 60.0 {
        format!("{degrees}°{minutes:02}'")
    } else if step >= 1.0 {
        format!("{degrees}°{minutes:02}'{seconds:02}\"")
    } else {
        format!("{degrees}°{minutes:02}'{seconds:02}.{rest:03}\"")
    }
}

/// A number with a space between thousands.
fn grouped(value: f64) -> String {
    let text = number(value);
    let (sign, digits) = text.strip_prefix('-').map_or(("", text.as_str()), |digits| ("−", digits));
    let (whole, fraction) = digits.split_once('.').map_or((digits, ""), |(whole, _)| (whole, &digits[whole.len()..]));
    let mut out = String::from(sign);
    for (i, digit) in whole.chars().enumerate() {
        if i > 0 && (whole.len() - i).is_multiple_of(3) && whole.len() > 4 {
            out.push(' ');
        }
        out.push(digit);
    }
    out + fraction
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn steps_are_round() {
        let plane = |least| round_up(least, Notation::Plane);
        assert_eq!(
            [plane(1.0), plane(1.1), plane(2.1), plane(5.5), plane(900.0)].map(Option::unwrap),
            [1.0, 2.0, 5.0, 10.0, 1000.0]
        );
        assert_eq!([plane(0.03), plane(0.21)].map(Option::unwrap), [0.05, 0.5]);
        assert_eq!((plane(0.0), plane(f64::NAN), plane(f64::INFINITY)), (None, None, None));
        let arcs = |seconds: f64| round_up(seconds / 3600.0, Notation::Degrees).map(|step| step * 3600.0);
        for (least, step) in
            [(0.9, 1.0), (6.0, 10.0), (12.0, 15.0), (40.0, 60.0), (1000.0, 1800.0), (3000.0, 3600.0), (0.03, 0.05)]
        {
            assert!((arcs(least).unwrap() - step).abs() < 1e-9, "{least}: {:?}", arcs(least));
        }
    }

    #[test]
    fn ticks_of_a_plane_are_at_round_metres_and_not_crowded() {
        for (width, cell) in [(1500.0, 7.0), (300.0, 0.4), (1200.0, 1250.0), (801.0, 0.0017)] {
            let size = DVec2::new(width, 700.0);
            let corner = DVec2::new(740_123.4, 4_020_456.7);
            let ticks = ticks(size, Notation::Plane, |p| Some(corner + DVec2::new(p.x, -p.y) * cell));
            assert_eq!(ticks.top, ticks.bottom);
            assert!((2..=10).contains(&ticks.top.len()) && (2..=6).contains(&ticks.left.len()), "{ticks:?}");
            for (edge, axis) in [(&ticks.top, 0), (&ticks.left, 1)] {
                let apart = edge[1].at - edge[0].at;
                assert!(apart >= CLOSEST - 1e-6, "{apart}");
                for pair in edge.windows(2) {
                    assert!((pair[1].at - pair[0].at - apart).abs() < 1e-3);
                }
                for tick in edge {
                    let written: f64 = tick.text[..tick.text.len() - 2].replace(' ', "").parse().unwrap();
                    let value = if axis == 0 { corner.x + tick.at * cell } else { corner.y - tick.at * cell };
                    assert!((written - value).abs() < 1e-6 * value.abs().max(cell), "{written} {value}");
                }
            }
        }
    }

    #[test]
    fn degrees_are_followed_along_each_edge() {
        // A map turned by a little: the meridians lean, so they meet the upper edge elsewhere than the lower one.
        let place = |p: DVec2| Some(DVec2::new(138.5 + p.x * 1e-4 + p.y * 1e-5, 36.5 - p.y * 1e-4));
        let ticks = ticks(DVec2::new(1000.0, 800.0), Notation::Degrees, place);
        let texts = |edge: &[Tick]| edge.iter().map(|t| t.text.clone()).collect::<Vec<_>>();
        assert_eq!(
            texts(&ticks.top),
            ["138°30' E", "138°31' E", "138°32' E", "138°33' E", "138°34' E", "138°35' E", "138°36' E"]
        );
        assert!(
            (ticks.top[3].at - 500.0).abs() < 1e-6
                && (ticks.bottom[2].at - (1000.0 / 3.0 - 80.0 + 166.666_666)).abs() < 200.0
        );
        assert_ne!(ticks.top[2].at, ticks.bottom[2].at);
        assert_eq!(texts(&ticks.left)[0], "36°30' N");
        assert!(ticks.left.windows(2).all(|w| w[0].at < w[1].at));
    }

    #[test]
    fn coordinates_are_written_as_on_maps() {
        assert_eq!(
            [746_000.0, 4_020_500.0, 950.0, 4500.0, -16_500.25, 0.5].map(grouped),
            ["746 000", "4 020 500", "950", "4500", "−16 500.25", "0.5"]
        );
        assert_eq!(text(-86.25, 0.25, 0, Notation::Degrees), "86°15' W");
        assert_eq!(text(-33.0, 1.0, 1, Notation::Degrees), "33° S");
        assert_eq!(text(0.0, 1.0, 1, Notation::Degrees), "0°");
        assert_eq!(text(138.0 + 59.0 / 60.0 + 59.9999 / 3600.0, 1.0 / 3600.0, 0, Notation::Degrees), "139°00'00\" E");
        assert_eq!(text(35.500_125, 0.0001 / 36.0, 1, Notation::Degrees), "35°30'00.450\" N");
        assert_eq!(text(12_000.0, 500.0, 0, Notation::Plain), "12 000");
    }

    #[test]
    fn edges_without_coordinates_have_no_ticks() {
        assert_eq!(ticks(DVec2::splat(500.0), Notation::Plane, |_| None), Ticks::default());
        assert_eq!(ticks(DVec2::splat(500.0), Notation::Plane, |_| Some(DVec2::ONE)), Ticks::default());
    }
}
