//! A line by the distance along it.

use glam::DVec2;

/// A line and the distance of each of its vertices from its start.
pub(super) struct Course<'a> {
    points: &'a [DVec2],
    distances: Vec<f64>,
}

impl<'a> Course<'a> {
    pub fn new(points: &'a [DVec2]) -> Self {
        let mut sum = 0.0;
        let mut distances = Vec::with_capacity(points.len());
        for (k, point) in points.iter().enumerate() {
            sum += if k > 0 { point.distance(points[k - 1]) } else { 0.0 };
            distances.push(sum);
        }
        Self { points, distances }
    }

    pub fn length(&self) -> f64 {
        self.distances.last().copied().unwrap_or(0.0)
    }

    /// The point at a distance along the line, which has at least one segment.
    pub fn point(&self, at: f64) -> DVec2 {
        let next = self.distances.partition_point(|&d| d <= at).clamp(1, self.points.len() - 1);
        let [from, to] = [self.distances[next - 1], self.distances[next]];
        let share = if to > from { ((at - from) / (to - from)).clamp(0.0, 1.0) } else { 0.0 };
        self.points[next - 1].lerp(self.points[next], share)
    }

    /// The largest distance from the straight line through `start` along a unit vector, over a part of the course.
    pub fn farthest_off(&self, [from, to]: [f64; 2], start: DVec2, along: DVec2) -> f64 {
        let first = self.distances.partition_point(|&d| d <= from);
        let last = self.distances.partition_point(|&d| d < to).max(first);
        self.points[first..last].iter().map(|p| (*p - start).perp_dot(along).abs()).fold(0.0, f64::max)
    }

    /// Whether the segment with this number lies between two distances at least in part. The distances of a closed line
    /// may be beyond its ends.
    pub fn is_between(&self, segment: usize, [from, to]: [f64; 2]) -> bool {
        let meets = |shift: f64| self.distances[segment] + shift <= to && self.distances[segment + 1] + shift >= from;
        let is_closed = self.points.first() == self.points.last();
        meets(0.0) || (is_closed && (meets(self.length()) || meets(-self.length())))
    }
}
