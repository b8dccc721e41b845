//! The distance from a point to a line.

use glam::DVec2;

/// The distance from a point to the nearest place on a line.
pub fn distance(p: DVec2, line: &[DVec2]) -> f64 {
    let to = |pair: &[DVec2]| {
        let (a, along) = (pair[0], pair[1] - pair[0]);
        let share = ((p - a).dot(along) / along.length_squared().max(f64::MIN_POSITIVE)).clamp(0.0, 1.0);
        p.distance(a + share * along)
    };
    line.windows(2).map(to).fold(f64::INFINITY, f64::min)
}
