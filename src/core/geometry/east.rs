//! The nearest of many segments to the east of a place.

use glam::DVec2;

use super::Segment;
use super::inside::{by_place, is_west};
use crate::base::parallel;

/// For each place, the number of the nearest segment to the east of it, if there is one. The segments do not cross each other.
/// Level segments, and those through the place, do not count.
///
/// The plane is divided into level strips, about as many as the root of the number of segments. So a search looks at about as
/// many segments.
pub fn nearest_east(segments: &[Segment], places: &[DVec2]) -> Vec<Option<u32>> {
    let upwards = |s: &Segment| if s.a.y <= s.b.y { *s } else { Segment { a: s.b, b: s.a } };
    let (low, high) = segments.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), s| {
        (low.min(s.a.y).min(s.b.y), high.max(s.a.y).max(s.b.y))
    });
    let count = (segments.len() as f64).sqrt().ceil().max(1.0);
    let strip = |y: f64| (((y - low) / (high - low) * count).max(0.0) as usize).min(count as usize - 1);
    let mut strips: Vec<Vec<u32>> = vec![Vec::new(); count as usize];
    for (number, segment) in (0u32..).zip(segments) {
        let segment = upwards(segment);
        strips[strip(segment.a.y)..=strip(segment.b.y)].iter_mut().for_each(|strip| strip.push(number));
    }
    parallel::map_each(places, |&p| {
        let here = strips[strip(p.y)].iter().map(|&number| (number, upwards(&segments[number as usize])));
        here.filter(|(_, s)| s.a.y <= p.y && p.y < s.b.y && is_west(p, s))
            .min_by(|a, b| by_place(&a.1, &b.1))
            .map(|(n, _)| n)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_nearest_segment_is_found_at_and_between_vertices() {
        let up = |x: f64| Segment { a: DVec2::new(x, 0.0), b: DVec2::new(x + 1.0, 10.0) };
        let down = Segment { a: DVec2::new(9.0, 10.0), b: DVec2::new(7.0, 0.0) };
        let level = Segment { a: DVec2::new(0.0, 5.0), b: DVec2::new(9.0, 5.0) };
        let segments = [up(4.0), down, level, up(2.0)];
        let places = [(0.0, 5.0), (2.0, 0.0), (3.0, 5.0), (8.5, 5.0), (0.0, 10.0), (0.0, -1.0), (5.0, 9.999)];
        let found = nearest_east(&segments, &places.map(DVec2::from));
        assert_eq!(found, [Some(3), Some(0), Some(0), None, None, None, Some(1)]);
        assert_eq!(nearest_east(&[], &[DVec2::ZERO]), [None]);
    }
}
