//! Takes vertices out of new contours that their course does not need.
//!
//! A traced line has a vertex on every edge of the triangulation that it crosses. Around each of them, a part of the edge
//! is free: its window. It ends half-way to the vertices of the triangulation and before half of the way to the next
//! level. A straight piece may replace a part of the line if it passes through the windows of all vertices that it leaves
//! out. Then it crosses the same edges as before, and in the same order as the lines of other levels. So lines still do
//! not cross each other, and no contour of the input.

use glam::DVec2;

use super::edge::Edge;

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

    /// The window around the crossing of a level with an edge of this length, as shares of the edge. `gap` is the difference
    /// to the nearest other level, metres.
    pub(super) fn window(self, length: f64, edge: &Edge, level: f64, gap: f64) -> [f64; 2] {
        let (share, free) = (edge.share(level), self.tolerance / length);
        let next = if edge.rises() { TO_NEXT_LEVEL * gap } else { -TO_NEXT_LEVEL * gap };
        let (before, after) = (edge.share(level - next), edge.share(level + next));
        let (first, last) = (share - TO_END * share, share + TO_END * (1.0 - share));
        [(share - free).max(before).max(first), (share + free).min(after).min(last)]
    }
}

/// The window around `share` of an edge. `tolerance` and `gap`, the way to the next level, are shares of the edge too.
/// `to_end` is the share of the way to the ends of the edge that it may take.
pub(crate) fn window(tolerance: f64, gap: f64, share: f64, to_end: f64) -> [f64; 2] {
    let free = tolerance.min(TO_NEXT_LEVEL * gap);
    [share - free.min(to_end * share), share + free.min(to_end * (1.0 - share))]
}

/// A line of `count` vertices with fewer of them. `vertex` gives the position of one, and the ends of its window on the
/// right and on the left. First and last stay, and those whose window is a point.
pub(crate) fn simplified(count: usize, vertex: impl Fn(usize) -> (DVec2, [DVec2; 2])) -> Vec<DVec2> {
    let mut line = vec![vertex(0).0];
    let mut from = 0;
    while from + 1 < count {
        let (to, position) = farthest(line[line.len() - 1], from, count, &vertex);
        line.push(position);
        from = to;
    }
    line
}

/// How far a straight piece gets from `origin`, which is in the window of vertex `from`, through the windows of all
/// vertices between: the last vertex, and the position in its window.
fn farthest(
    origin: DVec2,
    from: usize,
    count: usize,
    vertex: &impl Fn(usize) -> (DVec2, [DVec2; 2]),
) -> (usize, DVec2) {
    let mut reached = (from + 1, vertex(from + 1).0);
    let mut cone: Option<Cone> = None;
    for k in from + 1..count.min(from + 1 + MOST) {
        let (position, ends) = vertex(k);
        let direction = position - origin;
        if k + 1 == count || ends[0] == ends[1] {
            let is_ahead = cone.is_none_or(|cone| cone.contains(direction));
            return if is_ahead { (k, position) } else { reached };
        }
        let window = Cone { right: ends[0] - origin, left: ends[1] - origin };
        let common = match cone {
            None => window.is_open().then_some(window),
            Some(cone) => cone.common(&window),
        };
        let Some(common) = common else { break };
        reached = (k, origin + common.middle_of(&window));
        cone = Some(common);
    }
    reached
}

/// The directions from one to another, counter-clockwise, less than half a turn.
#[derive(Debug, Clone, Copy)]
struct Cone {
    right: DVec2,
    left: DVec2,
}

impl Cone {
    fn is_open(&self) -> bool {
        self.right.perp_dot(self.left) > 0.0
    }

    fn contains(&self, direction: DVec2) -> bool {
        self.right.perp_dot(direction) >= 0.0 && direction.perp_dot(self.left) >= 0.0
    }

    /// The directions of both; none if only one or no direction is common.
    fn common(&self, other: &Self) -> Option<Self> {
        if !other.is_open() {
            return None;
        }
        let pick = |mine: DVec2, theirs: DVec2| {
            if self.contains(theirs) { Some(theirs) } else { other.contains(mine).then_some(mine) }
        };
        let common = Self { right: pick(self.right, other.right)?, left: pick(self.left, other.left)? };
        common.is_open().then_some(common)
    }

    /// Where the middle of these directions meets a window that holds all of them.
    fn middle_of(&self, window: &Self) -> DVec2 {
        let middle = self.right.normalize_or_zero() + self.left.normalize_or_zero();
        let (right, left) = (window.right.perp_dot(middle), middle.perp_dot(window.left));
        let share = if right + left > 0.0 { (right / (right + left)).clamp(0.0, 1.0) } else { 0.5 };
        window.right.lerp(window.left, share)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Vertices on upright edges; windows reach by `free` up and down. The line runs to the east, so down is right.
    fn line(heights: &[f64], free: f64) -> Vec<DVec2> {
        let vertex = |k: usize| {
            let position = DVec2::new(k as f64, heights[k]);
            (position, [position - DVec2::Y * free, position + DVec2::Y * free])
        };
        simplified(heights.len(), vertex)
    }

    #[test]
    fn a_straight_line_keeps_its_ends_and_a_bend_a_vertex() {
        let of = |heights: &[f64], free: f64| line(heights, free).iter().map(|p| p.x as usize).collect::<Vec<_>>();
        assert_eq!(of(&[0.0; 9], 0.1), [0, 8]);
        assert_eq!(of(&[0.0, 0.05, -0.05, 0.05, 0.0], 0.1), [0, 4]);
        assert_eq!(of(&[0.0, 0.0, 0.0, 1.0, 2.0, 3.0], 0.1).len(), 3);
        assert_eq!(of(&[0.0, 0.05, -0.05, 0.05, 0.0], 0.0), [0, 1, 2, 3, 4], "nothing is free");
        assert_eq!(of(&[3.0], 1.0), [0]);
        assert_eq!(of(&[3.0, 4.0], 1.0), [0, 1]);
    }

    #[test]
    fn every_window_is_passed() {
        let heights: Vec<f64> = (0..500).map(|k| (f64::from(k) * 0.1).sin() * 5.0 + f64::from(k % 3) * 0.02).collect();
        for (free, most) in [(0.011, 350), (0.1, 120), (1.0, 45)] {
            let line = line(&heights, free);
            assert_eq!((line[0].y, line[line.len() - 1].y), (heights[0], heights[499]));
            for pair in line.windows(2) {
                let passed = |k: f64| pair[0].x <= k && k <= pair[1].x;
                for (k, height) in heights.iter().enumerate().map(|(k, z)| (k as f64, z)).filter(|(k, _)| passed(*k)) {
                    let on_piece = pair[0].lerp(pair[1], (k - pair[0].x) / (pair[1].x - pair[0].x)).y;
                    assert!((on_piece - height).abs() <= free + 1e-9);
                }
            }
            assert!(line.len() < most, "{} of 500 vertices with {free}", line.len());
        }
    }

    #[test]
    fn a_line_that_turns_right_round_passes_its_windows_in_order() {
        // A ring on spokes from its middle; right is outside.
        let spoke = |k: usize| DVec2::from_angle(std::f64::consts::TAU * (k % 60) as f64 / 60.0);
        let ring = simplified(61, |k| (spoke(k) * 10.0, [spoke(k) * 11.0, spoke(k) * 9.0]));
        assert!((4..=9).contains(&ring.len()), "{ring:?}");
        assert_eq!(ring[0], ring[ring.len() - 1]);
        let turns: f64 = ring.windows(2).map(|pair| pair[0].angle_to(pair[1])).sum();
        assert!((turns - std::f64::consts::TAU).abs() < 1e-9);
        for pair in ring.windows(2) {
            let length = pair[0].distance(pair[1]);
            assert!(pair[0].perp_dot(pair[1]) / length > 8.99, "a piece leaves the windows");
        }
    }

    #[test]
    fn a_window_ends_before_the_next_level_and_before_the_ends_of_its_edge() {
        let edge = Edge::new([0, 1], [0.0, 20.0], None);
        for (tolerance, gap, ends) in [
            (0.5, 100.0, [0.15, 0.25]),
            (50.0, 100.0, [0.1, 0.6]),
            (50.0, 2.0, [0.2 - 0.045, 0.2 + 0.045]),
            (0.0, 2.0, [0.2, 0.2]),
        ] {
            let window = Simplification { tolerance }.window(10.0, &edge, 4.0, gap);
            assert!(window.iter().zip(ends).all(|(a, b)| (a - b).abs() < 1e-12), "{window:?}");
        }
    }
}
