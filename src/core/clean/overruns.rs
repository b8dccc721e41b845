//! Overruns: a line that goes on over itself at an end, forwards or back.
//!
//! Who traces a ring often goes on past its start, or back along the last pieces. One of the two runs is left out, and the
//! other one stays. So a ring is closed, and an open line keeps its end. A spike inside a line is something else: there
//! both runs go.

use std::collections::HashMap;

use glam::DVec2;

use super::removed::{Removed, Why};
use crate::base::bits::bits;
use crate::contour::Contour;
use crate::geometry::{Segment, point_distance};

/// A last segment runs along another one up to this distance from it, as a share of its own length.
const ALONG: f64 = 1e-4;
/// The same for a distance within which places are one: rounded coordinates move the end of a segment off the other one.
const ROUNDED: f64 = 1e-2;
/// The same for a last segment from a vertex that the line visits twice.
const TWICE: f64 = 1e-2;
/// The same for two ends that overlap, as a share of the length over which they do.
const ABREAST: f64 = 0.05;

/// The line without overruns, and what was left out of it, at most one piece for each end. `near` is a distance within
/// which places are one, map units.
pub(super) fn trim(mut line: Contour, near: f64, removed: &mut Vec<Removed>) -> Contour {
    if is_ring(&line.points) {
        return line;
    }
    if let Some(closed) = closed_over_its_start(&line.points, near) {
        removed.push(Removed::new(&line, closed.left_out, Why::Overlap));
        line.points = closed.points;
        return line;
    }
    for _ in 0..2 {
        let count = overrun(&line.points, near);
        if count > 0 {
            let stays = line.points.len() - count;
            removed.push(Removed::new(&line, line.points[stays - 1..].to_vec(), Why::Overrun));
            line.points.truncate(stays);
        }
        if is_ring(&line.points) {
            break;
        }
        line.points.reverse();
    }
    line
}

fn is_ring(points: &[DVec2]) -> bool {
    points.first() == points.last()
}

/// How many points at the end only repeat what the line has already.
fn overrun(points: &[DVec2], near: f64) -> usize {
    let mut end = points.len();
    if end > 2 && ends_on_itself(points, near) {
        end -= 1;
    }
    let last = end.saturating_sub(1);
    if end < 3 || !points[..last].contains(&points[last]) {
        return points.len() - end;
    }
    let key = |a: DVec2, b: DVec2| (bits(a).min(bits(b)), bits(a).max(bits(b)));
    let mut runs: HashMap<_, usize> = HashMap::with_capacity(end);
    points[..end].windows(2).for_each(|w| *runs.entry(key(w[0], w[1])).or_default() += 1);
    while let Some(count) = runs.get_mut(&key(points[end - 2], points[end - 1])).filter(|count| **count > 1) {
        *count -= 1;
        end -= 1;
    }
    points.len() - end
}

/// Whether the last vertex lies inside another segment that starts at the same vertex as the last one.
fn ends_on_itself(points: &[DVec2], near: f64) -> bool {
    let n = points.len();
    let (root, end) = (points[n - 2], points[n - 1]);
    let length = root.distance(end);
    let is_on = |other: DVec2, reach: f64| {
        let is_short = other != end && length < root.distance(other);
        is_short && point_distance(end, &Segment { a: root, b: other }) <= reach
    };
    let twice = near.max(TWICE * length);
    let is_run = |k: usize| (k > 0 && is_on(points[k - 1], twice)) || is_on(points[k + 1], twice);
    let back = (ALONG * length).max(near.min(ROUNDED * length));
    is_on(points[n - 3], back) || (0..n - 2).any(|k| points[k] == root && is_run(k))
}

/// A ring made of a line whose ends overlap.
struct Closed {
    points: Vec<DVec2>,
    left_out: Vec<DVec2>,
}

/// The ring, if the last vertex lies on the first segment, and the first vertex on the last segment.
fn closed_over_its_start(points: &[DVec2], near: f64) -> Option<Closed> {
    let n = points.len();
    let (&[first, second, ..], &[.., before, last]) = (points, points) else { return None };
    let overlap = first.distance(last);
    if n < 5 || overlap <= near || overlap >= first.distance(second).min(before.distance(last)) {
        return None;
    }
    let reach = (ALONG * overlap).max(near.min(ABREAST * overlap));
    let is_on = |p: DVec2, a: DVec2, b: DVec2| point_distance(p, &Segment { a, b }) <= reach;
    (is_on(last, first, second) && is_on(first, before, last))
        .then(|| Closed { points: [&points[..n - 1], &[first]].concat(), left_out: vec![before, last, first] })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::compare_points;

    fn places(points: &[(f64, f64)]) -> Vec<DVec2> {
        points.iter().map(|&p| p.into()).collect()
    }

    fn trimmed(points: &[(f64, f64)], near: f64) -> (Vec<DVec2>, Vec<Why>) {
        let line = Contour { elevation: 10.0, points: places(points), feature: 1.into() };
        let mut removed = Vec::new();
        let line = trim(line, near, &mut removed);
        let mut points = line.points;
        if compare_points(&points[points.len() - 1], &points[0]).is_lt() {
            points.reverse();
        }
        (points, removed.into_iter().map(|r| r.why).collect())
    }

    const SQUARE: [(f64, f64); 5] = [(0.0, 0.0), (8.0, 0.0), (8.0, 8.0), (0.0, 8.0), (0.0, 0.0)];

    /// The square, entered at its corner number `from` after `start` and left after the corner number `to` for `end`.
    fn square(start: &[(f64, f64)], from: usize, to: usize, end: &[(f64, f64)]) -> Vec<(f64, f64)> {
        let corners = (from..=to).map(|k| SQUARE[k % 4]);
        start.iter().copied().chain(corners).chain(end.iter().copied()).collect()
    }

    #[test]
    fn a_ring_is_closed_whichever_way_its_end_overruns() {
        let cases = [
            ("forward", square(&[], 0, 6, &[])),
            ("back", square(&[], 0, 4, &[SQUARE[3], SQUARE[2]])),
            ("forward at both ends", square(&[SQUARE[2]], 3, 9, &[])),
            ("back at both ends", square(&[SQUARE[2], SQUARE[1]], 0, 4, &[SQUARE[3]])),
            ("more than twice round", square(&[], 0, 10, &[])),
            ("forward, into a segment", square(&[], 0, 5, &[(8.0, 3.0)])),
            ("back, into a segment", square(&[], 0, 4, &[SQUARE[3], (5.0, 8.0)])),
            ("from a segment", square(&[(0.0, 5.0)], 0, 4, &[])),
            ("from a segment, into a segment", square(&[(0.0, 5.0)], 0, 4, &[(2.0, 0.0)])),
        ];
        for (name, points) in cases {
            for turned in [false, true] {
                let mut points = points.clone();
                if turned {
                    points.reverse();
                }
                let (rest, why) = trimmed(&points, 0.0);
                assert!(is_ring(&rest) && rest.len() == 5, "{name}: {rest:?}");
                assert!(!why.is_empty() && why.iter().all(|why| *why == Why::Overrun), "{name}: {why:?}");
            }
        }
    }

    #[test]
    fn ends_between_the_same_two_corners_overlap() {
        let points = square(&[(0.0, 6.0)], 0, 3, &[(0.0, 2.0)]);
        let (rest, why) = trimmed(&points, 0.0);
        assert_eq!((rest.len(), is_ring(&rest), &why[..]), (6, true, &[Why::Overlap][..]), "{rest:?}");
        let beside = square(&[(0.0, 6.0)], 0, 3, &[(0.008, 2.0)]);
        assert_eq!(trimmed(&beside, 0.01).1, [Why::Overlap]);
        let apart = square(&[(0.0, 6.0)], 0, 3, &[(0.5, 2.0)]);
        assert_eq!(trimmed(&apart, 0.01).1, []);
        let open = square(&[(0.0, 2.0)], 0, 3, &[(0.0, 6.0)]);
        assert_eq!(trimmed(&open, 0.01).1, [], "a gap");
    }

    #[test]
    fn an_open_line_keeps_its_end() {
        let line = [(0.0, 0.0), (8.0, 1.0), (16.0, 0.0), (24.0, 1.0)];
        for (start, end) in [
            (&[][..], &[line[2]][..]),
            (&[], &[line[2], line[1]]),
            (&[], &[(20.0, 0.5)]),
            (&[], &[line[2], (12.0, 0.5)]),
            (&[line[1]], &[line[2]]),
            (&[(4.0, 0.5)], &[]),
        ] {
            let points = [start, &line[..], end].concat();
            let (rest, why) = trimmed(&points, 0.0);
            assert_eq!(rest, places(&line), "{points:?}");
            assert_eq!(why.len(), usize::from(!start.is_empty()) + usize::from(!end.is_empty()));
        }
    }

    #[test]
    fn a_place_rounded_off_its_segment_lies_on_it() {
        let line = [(0.0, 0.0), (7.0, 3.0), (14.0, 0.0), (20.0, 7.0)];
        let end = |off: f64| [&line[..], &[line[2], (10.5, 1.5 + off)]].concat();
        assert_eq!(trimmed(&end(0.004), 0.01).0, places(&line));
        assert_eq!(trimmed(&end(0.004), 0.0).0, places(&line));
        assert_eq!(trimmed(&end(0.5), 0.01).0.len(), 6);
    }

    #[test]
    fn what_is_no_overrun_stays() {
        let spike = [(0.0, 0.0), (5.0, 0.0), (5.0, 5.0), (5.0, 0.0), (9.0, 1.0)];
        let nine = [(0.0, 0.0), (5.0, 0.0), (5.0, 3.0), (2.0, 3.0), (5.0, 0.0)];
        let there_and_back = [(0.0, 0.0), (5.0, 1.0), (9.0, 0.0), (5.0, 1.0), (0.0, 0.0)];
        let sharp = [(0.0, 0.0), (9.0, 0.0), (3.0, 0.5)];
        for points in [&spike[..], &nine, &there_and_back, &sharp, &SQUARE, &sharp[..2]] {
            assert_eq!(trimmed(points, 0.01).1, [], "{points:?}");
        }
    }
}
