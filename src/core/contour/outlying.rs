//! Vertices that stick out of an otherwise even and smooth line: the line runs to them and nearly straight back.
//!
//! A vertex moved by mistake has two long segments with a sharp turn between them. Without it the line continues
//! smoothly. In a narrow valley a line turns as sharply, but it follows the valley to the turn and back. Lines traced
//! on triangles have some long segments among many short ones. Such uneven lines are not judged.

use glam::DVec2;

/// Least ratio of the way over such a vertex to the straight way past it. The line turns back to within 39 degrees.
const SHARP: f64 = 3.0;
/// Least ratio of both segments at the vertex to the upper quartile of the line's segment lengths.
const LONG: f64 = 2.0;
/// Largest ratio of the upper to the lower quartile of segment lengths in an even line.
const EVEN: f64 = 3.0;
/// Least cosine of the turn at the vertices before and after, once the vertex is left out: less than 45 degrees.
const COS_ON: f64 = 0.7;
/// Fewest segments from which the quartiles are taken.
const FEWEST: usize = 12;

/// Numbers of a line's vertices that stick out, ascending. Vertices next to the ends of an open line are not judged.
pub(crate) fn outlying_vertices(points: &[DVec2]) -> Vec<usize> {
    let lengths = points.windows(2).map(|w| w[0].distance(w[1]));
    let mut lengths: Vec<f64> = lengths.filter(|d| *d > 0.0).collect();
    if lengths.len() < FEWEST {
        return Vec::new();
    }
    let quarter = lengths.len() / 4;
    let shorter = *lengths.select_nth_unstable_by(quarter, f64::total_cmp).1;
    let longer = *lengths.select_nth_unstable_by(3 * quarter, f64::total_cmp).1;
    if longer > EVEN * shorter {
        return Vec::new();
    }
    let goes_on = |a: DVec2, b: DVec2, c: DVec2| (b - a).dot(c - b) > COS_ON * a.distance(b) * b.distance(c);
    let stands_out = |[before, a, b, c, after]: [DVec2; 5]| {
        let (to, back) = (a.distance(b), b.distance(c));
        to.min(back) > LONG * longer
            && to + back > SHARP * a.distance(c)
            && goes_on(before, a, c)
            && goes_on(a, c, after)
    };
    let last = points.len() - 1;
    if points[0] == points[last] {
        let around = |k: usize| [last - 2, last - 1, 0, 1, 2].map(|step| points[(k + step) % last]);
        (0..last).filter(|&k| stands_out(around(k))).collect()
    } else {
        (2..last - 1).filter(|&k| stands_out([0, 1, 2, 3, 4].map(|step| points[k + step - 2]))).collect()
    }
}

/// The line without the vertices that stick out.
pub(crate) fn without_outlying(points: &[DVec2]) -> Vec<DVec2> {
    let mut outlying = outlying_vertices(points).into_iter().peekable();
    let starts_outlying = outlying.peek() == Some(&0);
    let stays = |&(k, _): &(usize, &DVec2)| outlying.next_if_eq(&k).is_none();
    let mut rest: Vec<DVec2> = points.iter().enumerate().filter(stays).map(|(_, p)| *p).collect();
    if starts_outlying {
        // The ring ends with the vertex that it started with, which is left out.
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

    #[test]
    fn a_narrow_valley_does_not_stand_out_and_a_line_of_uneven_steps_is_not_judged() {
        let with_slip = |step: fn(u32) -> f64| {
            let mut points: Vec<DVec2> = (0..40).map(|k| DVec2::new(step(k), 0.0)).collect();
            points[20].y = 9.0;
            points
        };
        assert_eq!(outlying_vertices(&with_slip(f64::from)), [20]);
        assert_eq!(outlying_vertices(&with_slip(|k| f64::from(k) + 0.4 * f64::from(k % 2))), [20]);
        assert!(outlying_vertices(&with_slip(|k| f64::from(k) + 0.8 * f64::from(k % 2))).is_empty(), "uneven");
        let mut valley = with_slip(f64::from);
        let sides = [(19.2, 1.0), (19.4, 2.0), (19.5, 3.0), (20.0, 9.0), (20.5, 3.0), (20.6, 2.0), (20.8, 1.0)];
        valley.splice(20..21, sides.map(DVec2::from));
        assert!(outlying_vertices(&valley).is_empty(), "a valley");
    }
}
