//! How two segments lie to each other. Contact is tested exactly; nearness is a computed distance.

use glam::DVec2;
use robust::{Coord, orient2d};

use super::order::compare_points;
use super::segment::Segment;

/// How two segments meet.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Meeting {
    /// They share no point.
    Apart,
    /// They share one point, which is an end of one or both.
    Touch,
    /// They share one point inside both.
    Cross,
    /// They share more than a point.
    Overlap,
}

/// On which side of the line through a and b the point lies. The sign is exact.
fn side(s: &Segment, p: DVec2) -> f64 {
    let coord = |p: DVec2| Coord { x: p.x, y: p.y };
    orient2d(coord(s.a), coord(s.b), coord(p))
}

/// How two segments meet, exactly. Neither may have the length zero.
pub fn meeting(s: &Segment, t: &Segment) -> Meeting {
    let (ta, tb) = (side(s, t.a), side(s, t.b));
    if ta == 0.0 && tb == 0.0 {
        return meeting_in_line(s, t);
    }
    if (ta > 0.0 && tb > 0.0) || (ta < 0.0 && tb < 0.0) {
        return Meeting::Apart;
    }
    let (sa, sb) = (side(t, s.a), side(t, s.b));
    if (sa > 0.0 && sb > 0.0) || (sa < 0.0 && sb < 0.0) {
        Meeting::Apart
    } else if ta == 0.0 || tb == 0.0 || sa == 0.0 || sb == 0.0 {
        // Neither has both ends strictly on one side of the other's line, and one end lies on that line: this end is
        // the common point.
        Meeting::Touch
    } else {
        Meeting::Cross
    }
}

/// How two segments on one straight line meet. Along it, points are in the order of their coordinates.
fn meeting_in_line(s: &Segment, t: &Segment) -> Meeting {
    let order = |s: &Segment| {
        let (a, b) = ((s.a.x, s.a.y), (s.b.x, s.b.y));
        if a <= b { (a, b) } else { (b, a) }
    };
    let ((s_low, s_high), (t_low, t_high)) = (order(s), order(t));
    let low = if s_low >= t_low { s_low } else { t_low };
    let high = if s_high <= t_high { s_high } else { t_high };
    if low < high {
        Meeting::Overlap
    } else if low == high {
        Meeting::Touch
    } else {
        Meeting::Apart
    }
}

/// Distance from a point to a segment. It is the same to the last bit for both directions of the segment: what was
/// apart before a line is reversed is apart afterwards.
pub fn point_distance(p: DVec2, s: &Segment) -> f64 {
    let (a, b) = if compare_points(&s.a, &s.b).is_le() { (s.a, s.b) } else { (s.b, s.a) };
    let (along, to) = (b - a, p - a);
    let share = (to.dot(along) / along.length_squared()).clamp(0.0, 1.0);
    // The square of a very short length can underflow to zero. Then the segment is a point.
    if share.is_nan() { to.length() } else { (to - along * share).length() }
}

/// Distance between two segments that do not cross.
pub fn distance(s: &Segment, t: &Segment) -> f64 {
    nearest_end(s, t).0
}

/// The least distance from one of the four ends to the other segment, and that end.
fn nearest_end(s: &Segment, t: &Segment) -> (f64, DVec2) {
    let mut best = (point_distance(s.a, t), s.a);
    for (p, of) in [(s.b, t), (t.a, s), (t.b, s)] {
        let d = point_distance(p, of);
        if d < best.0 {
            best = (d, p);
        }
    }
    best
}

/// The computed position where two segments meet, up to rounding.
pub fn place(s: &Segment, t: &Segment) -> DVec2 {
    let (u, v) = (s.b - s.a, t.b - t.a);
    let share = (t.a - s.a).perp_dot(v) / u.perp_dot(v);
    if meeting(s, t) == Meeting::Cross && (0.0..=1.0).contains(&share) { s.a + u * share } else { nearest_end(s, t).1 }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn segment(ax: f64, ay: f64, bx: f64, by: f64) -> Segment {
        Segment { a: DVec2::new(ax, ay), b: DVec2::new(bx, by) }
    }

    #[test]
    fn all_ways_to_meet() {
        let s = segment(0.0, 0.0, 4.0, 2.0);
        let cases = [
            (segment(0.0, 2.0, 4.0, 0.0), Meeting::Cross),
            (segment(2.0, 1.0, 3.0, 5.0), Meeting::Touch),
            (segment(4.0, 2.0, 3.0, 5.0), Meeting::Touch),
            (segment(4.0, 2.0, 6.0, 3.0), Meeting::Touch),
            (segment(2.0, 1.0, 6.0, 3.0), Meeting::Overlap),
            (segment(-2.0, -1.0, 6.0, 3.0), Meeting::Overlap),
            (segment(4.0, 2.0, 0.0, 0.0), Meeting::Overlap),
            (segment(6.0, 3.0, 8.0, 4.0), Meeting::Apart),
            (segment(0.0, 1.0, 4.0, 3.0), Meeting::Apart),
            (segment(5.0, 0.0, 6.0, 4.0), Meeting::Apart),
            (segment(6.0, 3.0, 7.0, 9.0), Meeting::Apart),
        ];
        for (t, expected) in cases {
            for (s, t) in [(s, t), (t, s), (Segment { a: s.b, b: s.a }, t)] {
                assert_eq!(meeting(&s, &t), expected, "{:?} {:?} and {:?} {:?}", s.a, s.b, t.a, t.b);
            }
        }
    }

    #[test]
    fn upright_lines_meet_by_y() {
        let s = segment(1.0, 0.0, 1.0, 2.0);
        assert_eq!(meeting(&s, &segment(1.0, 3.0, 1.0, 1.0)), Meeting::Overlap);
        assert_eq!(meeting(&s, &segment(1.0, 3.0, 1.0, 2.0)), Meeting::Touch);
        assert_eq!(meeting(&s, &segment(1.0, 3.0, 1.0, 4.0)), Meeting::Apart);
    }

    #[test]
    fn contact_is_exact_at_map_coordinates() {
        // The middle of a segment that is a number, and the next number beside it.
        let s = segment(500_000.0, 4_000_000.0, 500_002.0, 4_000_006.0);
        let on = DVec2::new(500_001.0, 4_000_003.0);
        let beside = DVec2::new(on.x.next_up(), on.y);
        let far = DVec2::new(500_100.0, 4_000_000.0);
        assert_eq!(meeting(&s, &Segment { a: on, b: far }), Meeting::Touch);
        assert_eq!(meeting(&s, &Segment { a: beside, b: far }), Meeting::Apart);
        assert_eq!(meeting(&s, &Segment { a: DVec2::new(on.x.next_down(), on.y), b: far }), Meeting::Cross);
    }

    #[test]
    fn distances() {
        let s = segment(0.0, 0.0, 4.0, 0.0);
        assert_eq!(point_distance(DVec2::new(2.0, 3.0), &s), 3.0);
        assert_eq!(point_distance(DVec2::new(7.0, 4.0), &s), 5.0);
        assert_eq!(distance(&s, &segment(7.0, 4.0, 9.0, 9.0)), 5.0);
        assert_eq!(distance(&segment(2.0, 1.0, 2.0, 5.0), &s), 1.0);
        assert_eq!(point_distance(DVec2::ONE, &segment(1.0, 2.0, 1.0, 2.0)), 1.0);
        assert_eq!(place(&s, &segment(1.0, -1.0, 1.0, 1.0)), DVec2::X);
        assert_eq!(place(&s, &segment(3.0, 0.5, 3.0, 1.0)), DVec2::new(3.0, 0.5));
    }
}
