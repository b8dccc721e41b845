//! Places along a line by their distance from its start.

use glam::DVec2;

use crate::subdomains::Stretch;

/// A line with the distance of each vertex from its start.
pub(super) struct Along<'a> {
    points: &'a [DVec2],
    at: Vec<f64>,
}

impl<'a> Along<'a> {
    pub fn new(points: &'a [DVec2]) -> Self {
        let mut at = vec![0.0];
        let mut sum = 0.0;
        for w in points.windows(2) {
            sum += w[0].distance(w[1]);
            at.push(sum);
        }
        Self { points, at }
    }

    /// The vertices strictly inside a stretch, and the ends of the line at its ends.
    pub fn inside(&self, stretch: Stretch) -> impl Iterator<Item = DVec2> + '_ {
        let last = self.points.len() - 1;
        let is_in = move |k: usize| {
            let at = self.at[k];
            (stretch.from < at && at < stretch.to)
                || (k == 0 && stretch.from == 0.0)
                || (k == last && stretch.to >= self.at[last])
        };
        let from = self.at.partition_point(|at| *at < stretch.from);
        let to = self.at.partition_point(|at| *at <= stretch.to);
        (from..to).filter(move |&k| is_in(k)).map(|k| self.points[k])
    }

    /// The piece between two distances.
    pub fn between(&self, from: f64, to: f64) -> Vec<DVec2> {
        let first = self.at.partition_point(|at| *at <= from);
        let end = self.at.partition_point(|at| *at < to).max(first);
        let inner = self.points[first..end].iter().copied();
        [self.place(from)].into_iter().chain(inner).chain([self.place(to)]).collect()
    }

    /// The place at a distance; the nearer end beyond the ends.
    pub fn place(&self, at: f64) -> DVec2 {
        let k = self.at.partition_point(|a| *a <= at).clamp(1, self.points.len() - 1);
        let (a, b) = (self.at[k - 1], self.at[k]);
        let share = if b > a { ((at - a) / (b - a)).clamp(0.0, 1.0) } else { 0.0 };
        self.points[k - 1].lerp(self.points[k], share)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn places_and_pieces_are_found_by_their_distance() {
        let points = [(0.0, 0.0), (10.0, 0.0), (10.0, 5.0), (10.0, 25.0)].map(DVec2::from);
        let along = Along::new(&points);
        for (at, place) in [(-1.0, (0.0, 0.0)), (4.0, (4.0, 0.0)), (12.0, (10.0, 2.0)), (99.0, (10.0, 25.0))] {
            assert_eq!(along.place(at), place.into());
        }
        assert_eq!(along.between(4.0, 16.0), [(4.0, 0.0), (10.0, 0.0), (10.0, 5.0), (10.0, 6.0)].map(DVec2::from));
        let inside = |from: f64, to: f64| along.inside(Stretch { region: 0, from, to }).collect::<Vec<DVec2>>();
        assert_eq!(inside(0.0, 15.0), points[..2]);
        assert_eq!(inside(10.0, 35.0), points[2..]);
    }
}
