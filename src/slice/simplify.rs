//! Takes vertices out of new contours that their course does not need.
//!
//! A traced line has a vertex on every edge of the triangulation that it crosses. Around each of them, a part of the edge
//! is free: its window. It ends half-way to the vertices of the triangulation and before half of the way to the next
//! level. A straight piece may replace a part of the line if it passes through the windows of all vertices that it leaves
//! out. Then it crosses the same edges as before, and in the same order as the lines of other levels. So lines still do
//! not cross each other, and no contour of the input.

use glam::DVec2;

/// Share of the way to the next level that a window may take. Windows of neighbouring levels do not meet.
const TO_NEXT_LEVEL: f64 = 0.45;
/// Share of the way to the ends of the edge that a window may take.
const TO_END: f64 = 0.5;
/// Most vertices that one straight piece leaves out. It limits the work.
const MOST: usize = 256;

/// How far lines may be simplified.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Simplification {
    /// Largest distance between a line and its simplified course, map units.
    pub tolerance: f64,
}

impl Simplification {
    /// All vertices stay.
    pub const NONE: Self = Self { tolerance: 0.0 };

    /// The window on an edge with these ends and heights, as shares of the edge; the line crosses it at `share`. `gap` is
    /// the difference to the nearest other level, metres.
    pub(super) fn window(self, [a, b]: [DVec2; 2], [za, zb]: [f64; 2], share: f64, gap: f64) -> [f64; 2] {
        let free = (self.tolerance / a.distance(b)).min(TO_NEXT_LEVEL * gap / (zb - za).abs());
        [share - free.min(TO_END * share), share + free.min(TO_END * (1.0 - share))]
    }
}

/// The numbers of the vertices that a line of `count` vertices keeps. `vertex` gives the position of one, and the ends of
/// its window on the right and on the left. First and last stay.
pub(super) fn simplified(count: usize, vertex: impl Fn(usize) -> (DVec2, [DVec2; 2])) -> Vec<usize> {
    let mut kept = vec![0];
    let mut from = 0;
    while from + 1 < count {
        from = farthest(from, count, &vertex);
        kept.push(from);
    }
    kept
}

/// The last vertex that a straight piece from vertex `from` reaches through the windows of all vertices between.
fn farthest(from: usize, count: usize, vertex: &impl Fn(usize) -> (DVec2, [DVec2; 2])) -> usize {
    let origin = vertex(from).0;
    let ahead = vertex(from + 1).0 - origin;
    let mut reached = from + 1;
    // The directions that pass through all windows so far, from the right to the left. All of them lie within a right
    // angle of `ahead`, so the sign of the cross product orders them.
    let [mut right, mut left] = vertex(from + 1).1.map(|end| end - origin);
    if !is_ordered(right, left, ahead) {
        return reached;
    }
    for k in from + 2..count.min(from + 2 + MOST) {
        let (position, window) = vertex(k);
        let [direction, window_right, window_left] = [position, window[0], window[1]].map(|p| p - origin);
        if direction.dot(ahead) <= 0.0 {
            break;
        }
        if right.perp_dot(direction) >= 0.0 && direction.perp_dot(left) >= 0.0 {
            reached = k;
        }
        if !is_ordered(window_right, window_left, ahead) {
            break;
        }
        if right.perp_dot(window_right) > 0.0 {
            right = window_right;
        }
        if left.perp_dot(window_left) < 0.0 {
            left = window_left;
        }
        if right.perp_dot(left) <= 0.0 {
            break;
        }
    }
    reached
}

/// Whether two directions lie within a right angle of `ahead`, the first truly on the right of the second.
fn is_ordered(right: DVec2, left: DVec2, ahead: DVec2) -> bool {
    right.dot(ahead) > 0.0 && left.dot(ahead) > 0.0 && right.perp_dot(left) > 0.0
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Vertices on upright edges; windows reach by `free` up and down. The line runs to the east, so down is right.
    fn kept(heights: &[f64], free: f64) -> Vec<usize> {
        let vertex = |k: usize| {
            let position = DVec2::new(k as f64, heights[k]);
            (position, [position - DVec2::Y * free, position + DVec2::Y * free])
        };
        simplified(heights.len(), vertex)
    }

    #[test]
    fn a_straight_line_keeps_its_ends_and_a_bend_its_vertex() {
        assert_eq!(kept(&[0.0; 9], 0.1), [0, 8]);
        assert_eq!(kept(&[0.0, 0.05, -0.05, 0.05, 0.0], 0.1), [0, 4]);
        assert_eq!(kept(&[0.0, 0.0, 0.0, 1.0, 2.0, 3.0], 0.1), [0, 2, 5]);
        assert_eq!(kept(&[0.0, 0.05, -0.05, 0.05, 0.0], 0.0), [0, 1, 2, 3, 4], "nothing is free");
        assert_eq!(kept(&[3.0], 1.0), [0]);
        assert_eq!(kept(&[3.0, 4.0], 1.0), [0, 1]);
    }

    #[test]
    fn every_window_is_passed() {
        let heights: Vec<f64> = (0..500).map(|k| (f64::from(k) * 0.1).sin() * 5.0 + f64::from(k % 3) * 0.02).collect();
        for free in [0.01, 0.1, 1.0] {
            let kept = kept(&heights, free);
            for pair in kept.windows(2) {
                for k in pair[0]..pair[1] {
                    let share = (k - pair[0]) as f64 / (pair[1] - pair[0]) as f64;
                    let on_piece = heights[pair[0]] + share * (heights[pair[1]] - heights[pair[0]]);
                    assert!((on_piece - heights[k]).abs() <= free + 1e-12);
                }
            }
            assert!(kept.len() < 400, "{} of 500 vertices with {free}", kept.len());
        }
    }

    #[test]
    fn a_window_ends_before_the_next_level_and_before_the_ends_of_its_edge() {
        let edge = [DVec2::ZERO, DVec2::new(10.0, 0.0)];
        let window = |tolerance: f64, gap: f64| Simplification { tolerance }.window(edge, [0.0, 20.0], 0.2, gap);
        assert_eq!(window(0.5, 100.0), [0.15, 0.25]);
        assert_eq!(window(50.0, 100.0), [0.1, 0.6]);
        assert_eq!(window(50.0, 2.0), [0.2 - 0.045, 0.2 + 0.045]);
        assert_eq!(window(0.0, 2.0), [0.2, 0.2]);
    }
}
