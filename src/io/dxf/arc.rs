//! Replaces the arcs of a polyline by chords.
//!
//! A vertex may have a bulge: the tangent of a quarter of the angle that the arc to the next vertex spans. It is
//! positive if the arc turns left. Chords stay close to the arc, and the polyline's own vertices do not move.

use glam::DVec2;

/// Largest distance between chord and arc, in units of the drawing.
pub(super) const TOLERANCE: f64 = 0.01;

/// An arc from one vertex to the next.
pub(super) struct Arc {
    pub from: DVec2,
    pub to: DVec2,
    pub bulge: f64,
}

impl Arc {
    /// Adds the points between the two vertices, so that chords stay within `tolerance` of the arc. Returns false, and adds
    /// nothing, if the arc needs more than `max_points` chords.
    pub fn push_points(&self, tolerance: f64, max_points: usize, points: &mut Vec<DVec2>) -> bool {
        let Self { from, to, bulge } = *self;
        let chord = to - from;
        let to_centre = (1.0 - bulge * bulge) / (4.0 * bulge);
        let start = from - ((from + to) / 2.0 + chord.perp() * to_centre);
        let radius = start.length();
        if chord == DVec2::ZERO || !radius.is_finite() {
            return true;
        }
        let angle = 4.0 * bulge.atan();
        // The middle of a chord is 1 - cos(half its angle) radii away from the arc, which is 2 sin²(a quarter of it).
        let widest = 4.0 * (tolerance / (2.0 * radius)).min(1.0).sqrt().asin();
        let count = (angle.abs() / widest).ceil();
        if count > max_points as f64 {
            return false;
        }
        let centre = from - start;
        for k in 1..count as usize {
            points.push(centre + DVec2::from_angle(angle * k as f64 / count).rotate(start));
        }
        true
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn push_between(from: DVec2, to: DVec2, bulge: f64, max_points: usize, points: &mut Vec<DVec2>) -> bool {
        Arc { from, to, bulge }.push_points(TOLERANCE, max_points, points)
    }

    #[test]
    fn arcs_stay_on_their_circle() {
        // A half circle that turns left, from the right to the left: over the top.
        let (from, to) = (DVec2::new(110.0, 50.0), DVec2::new(90.0, 50.0));
        let mut points = Vec::new();
        assert!(push_between(from, to, 1.0, 1000, &mut points));
        assert!(points.len() > 10 && points.len() < 80, "{}", points.len());
        let mut last = from;
        for &p in points.iter().chain([&to]) {
            assert!((p.distance(DVec2::new(100.0, 50.0)) - 10.0).abs() < 1e-12 && p.y > 50.0 - 1e-12);
            assert!(((p + last) / 2.0).distance(DVec2::new(100.0, 50.0)) > 10.0 - TOLERANCE - 1e-12);
            last = p;
        }
        // A quarter that turns right passes the chord on its left.
        points.clear();
        let quarter = -(std::f64::consts::FRAC_PI_8).tan();
        assert!(push_between(DVec2::ZERO, DVec2::new(10.0, 10.0), quarter, 1000, &mut points));
        assert!(!points.is_empty());
        assert!(points.iter().all(|p| p.y > p.x && (p.distance(DVec2::new(10.0, 0.0)) - 10.0).abs() < 1e-12));
    }

    #[test]
    fn odd_bulges_add_nothing_or_are_refused() {
        let (from, to) = (DVec2::ZERO, DVec2::new(1e6, 0.0));
        let mut points = Vec::new();
        for bulge in [f64::NAN, f64::INFINITY, 1e300, 1e-300, 1e-15] {
            assert!(push_between(from, to, bulge, 1000, &mut points), "{bulge}");
        }
        assert!(push_between(from, from, 1.0, 1000, &mut points));
        assert!(points.is_empty());
        assert!(!push_between(from, to, 1.0, 1000, &mut points));
        assert!(points.is_empty());
    }
}
