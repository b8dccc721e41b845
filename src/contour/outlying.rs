//! Vertices that stand out of a line which is smooth otherwise: the line runs to them and nearly straight back.
//!
//! A vertex that was moved by a slip makes two long segments with a sharp turn between. Lines that bend sharply of
//! themselves do so with segments as short as their others, so both are asked for.

use glam::DVec2;

/// The way over such a vertex is so many times the straight way past it: the line turns back to within 39 degrees.
const SHARP: f64 = 3.0;
/// Both segments at it are so many times as long as three quarters of the line's are.
const LONG: f64 = 2.0;
/// Fewest segments that tell how long a line's are.
const FEWEST: usize = 12;

/// Numbers of a line's vertices that stand out, ascending. Ends of an open line do not.
pub(crate) fn outlying_vertices(points: &[DVec2]) -> Vec<usize> {
    let lengths = points.windows(2).map(|w| w[0].distance(w[1]));
    let mut lengths: Vec<f64> = lengths.filter(|d| *d > 0.0).collect();
    if lengths.len() < FEWEST {
        return Vec::new();
    }
    let last = points.len() - 1;
    let quarter = 3 * lengths.len() / 4;
    let long = LONG * *lengths.select_nth_unstable_by(quarter, f64::total_cmp).1;
    let stands_out = |[a, b, c]: [DVec2; 3]| {
        let (to, back) = (a.distance(b), b.distance(c));
        to > long && back > long && to + back > SHARP * a.distance(c)
    };
    let at_start = points[0] == points[last] && stands_out([points[last - 1], points[0], points[1]]);
    let inside = (1..last).filter(|&k| stands_out([points[k - 1], points[k], points[k + 1]]));
    at_start.then_some(0).into_iter().chain(inside).collect()
}

/// The line without vertices that stand out.
pub(crate) fn without_outlying(points: &[DVec2]) -> Vec<DVec2> {
    let mut outlying = outlying_vertices(points).into_iter().peekable();
    let starts_outlying = outlying.peek() == Some(&0);
    let stays = |&(k, _): &(usize, &DVec2)| outlying.next_if_eq(&k).is_none();
    let mut rest: Vec<DVec2> = points.iter().enumerate().filter(stays).map(|(_, p)| *p).collect();
    if starts_outlying {
        // The ring's end is the vertex that it started with.
        rest.pop();
        rest.extend(rest.first().copied());
    }
    rest
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ring(corners: usize) -> Vec<DVec2> {
        let corner = |k: usize| 10.0 * DVec2::from_angle(k as f64 * std::f64::consts::TAU / corners as f64);
        (0..=corners).map(|k| corner(k % corners)).collect()
    }

    #[test]
    fn a_moved_vertex_stands_out_wherever_it_is() {
        for moved in [0, 1, 17, 59] {
            let mut points = ring(60);
            points[moved] *= 1.5;
            points[60] = points[0];
            assert_eq!(outlying_vertices(&points), [moved]);
            let rest = without_outlying(&points);
            assert_eq!(rest.len(), 60);
            assert_eq!(rest[0], rest[59]);
            assert!(rest.iter().all(|p| p.length() < 11.0));
        }
    }

    #[test]
    fn sharp_bends_and_long_segments_alone_do_not() {
        // Teeth as fine as the rest of the line, and a long way round a corner.
        let mut points: Vec<DVec2> = (0..40).map(|k| DVec2::new(0.2 * f64::from(k), f64::from(k % 2))).collect();
        assert!(outlying_vertices(&points).is_empty());
        points.extend([DVec2::new(20.0, 0.0), DVec2::new(20.0, 20.0), DVec2::new(19.0, 20.0)]);
        assert!(outlying_vertices(&points).is_empty());
        assert_eq!(without_outlying(&points), points);
        assert!(outlying_vertices(&points[..5]).is_empty());
    }
}
