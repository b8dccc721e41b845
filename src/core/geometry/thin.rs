//! Outlines without vertices that show nothing.
//!
//! Some programs write a circle or a shore with a vertex every few millimetres. Each vertex takes time and memory in every
//! step. Vertices that lie closer to each other than a distance, on a straight line up to a tolerance, are left out.
//! Outlines with fewer vertices keep every vertex, also those on a straight line.

use geo::{Coord, LineString, MultiPolygon, Polygon};
use glam::DVec2;

/// The directions of lines from a vertex that pass all vertices after it within the tolerance.
struct Cone {
    from: DVec2,
    /// Its right and its left limit; none while all vertices are within the tolerance of `from`.
    limits: Option<[DVec2; 2]>,
    /// Distance of the farthest vertex.
    reach: f64,
}

/// The area without needless vertices: none that is kept is further than `gap` from the next because of those left out,
/// and none that is left out is further than `tolerance` from the outline.
pub fn thinned(area: &MultiPolygon<f64>, tolerance: f64, gap: f64) -> MultiPolygon<f64> {
    let ring = |ring: &LineString<f64>| thinned_ring(ring, tolerance, gap);
    area.iter().map(|p| Polygon::new(ring(p.exterior()), p.interiors().iter().map(ring).collect())).collect()
}

fn thinned_ring(ring: &LineString<f64>, tolerance: f64, gap: f64) -> LineString<f64> {
    let at = |k: usize| DVec2::new(ring.0[k].x, ring.0[k].y);
    // A ring of four points or fewer is a triangle.
    let Some(last) = ring.0.len().checked_sub(1).filter(|last| *last > 3) else { return ring.clone() };
    let mut kept: Vec<Coord<f64>> = vec![ring.0[0]];
    let mut cone = Cone::new(at(0));
    for k in 1..last {
        // Vertex k goes if the line to the next one passes it and those before it.
        cone.take(at(k), tolerance);
        if !(at(k + 1).distance(cone.from) <= gap && cone.holds(at(k + 1), tolerance)) {
            kept.push(ring.0[k]);
            cone = Cone::new(at(k));
        }
    }
    kept.push(ring.0[last]);
    if kept.len() > 3 { LineString::new(kept) } else { ring.clone() }
}

impl Cone {
    fn new(from: DVec2) -> Self {
        Self { from, limits: None, reach: 0.0 }
    }

    /// Narrows the cone to the lines that pass a vertex within the tolerance.
    fn take(&mut self, p: DVec2, tolerance: f64) {
        let way = p - self.from;
        let length = way.length();
        self.reach = self.reach.max(length);
        if length <= tolerance {
            return;
        }
        let (sin, cos) = (tolerance / length, (1.0 - (tolerance / length).powi(2)).sqrt());
        let [right, left] = [DVec2::new(cos, -sin), DVec2::new(cos, sin)].map(|turn| turn.rotate(way));
        self.limits = Some(self.limits.map_or([right, left], |[r, l]| {
            [if r.perp_dot(right) > 0.0 { right } else { r }, if left.perp_dot(l) > 0.0 { left } else { l }]
        }));
    }

    /// Whether the line to a vertex lies in the cone, and leads beyond all vertices taken.
    fn holds(&self, p: DVec2, tolerance: f64) -> bool {
        let way = p - self.from;
        let leads_on = way.length() >= self.reach && way.length() > tolerance;
        let is_between = |[r, l]: [DVec2; 2]| {
            r.perp_dot(way) >= 0.0 && way.perp_dot(l) >= 0.0 && r.perp_dot(l) >= 0.0 && r.dot(way) > 0.0
        };
        leads_on && self.limits.is_none_or(is_between)
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use super::*;
    use crate::geometry::{Border, OrientedBox, Segment, point_distance, rings};

    fn circle(count: u32) -> MultiPolygon<f64> {
        let at =
            |k: u32| DVec2::new(4e5, 3e6) + 1000.0 * DVec2::from_angle(TAU * f64::from(k % count) / f64::from(count));
        let ring: LineString<f64> = (0..=count).map(|k| Coord { x: at(k).x, y: at(k).y }).collect();
        Polygon::new(ring, Vec::new()).into()
    }

    #[test]
    fn a_dense_circle_keeps_its_place_with_few_vertices() {
        let dense = circle(100_000);
        let (tolerance, gap) = (1e-3, 20.0);
        let thin = thinned(&dense, tolerance, gap);
        let count = rings(&thin).map(|ring| ring.0.len()).sum::<usize>();
        assert!((600..3000).contains(&count), "{count}");
        let border = Border::new(&thin);
        for c in rings(&dense).flat_map(|ring| ring.coords()) {
            let p = DVec2::new(c.x, c.y);
            let near = border
                .near_box(OrientedBox::upright(p - 3.0, p + 3.0))
                .map(|(_, edge): (u32, Segment)| point_distance(p, &edge));
            assert!(near.fold(f64::INFINITY, f64::min) <= tolerance * 1.0001);
        }
        let first = |area: &MultiPolygon<f64>| area.0[0].exterior().0[0];
        assert_eq!(first(&thin), first(&dense));
        assert!(rings(&thin).all(|ring| ring.is_closed()));
    }

    #[test]
    fn ordinary_outlines_keep_every_vertex() {
        let sparse = circle(300);
        assert_eq!(thinned(&sparse, 1e-3, 20.0), sparse);
        // Vertices on a straight line, further from each other than half the gap.
        let square: LineString<f64> =
            vec![(0.0, 0.0), (11.0, 0.0), (22.0, 0.0), (22.0, 22.0), (0.0, 22.0), (0.0, 0.0)].into();
        let square: MultiPolygon<f64> = Polygon::new(square, Vec::new()).into();
        assert_eq!(thinned(&square, 1e-3, 20.0), square);
        assert_eq!(thinned(&square, 1e-3, 30.0).0[0].exterior().0.len(), 5);
    }

    #[test]
    fn corners_and_turns_back_stay() {
        let ring: LineString<f64> =
            vec![(0.0, 0.0), (2.0, 0.0), (1.0, 0.0), (1.0, 1.0), (1.0, 2.0), (0.0, 2.0), (0.0, 0.0)].into();
        let area: MultiPolygon<f64> = Polygon::new(ring, Vec::new()).into();
        let thin = thinned(&area, 1e-3, 9.0);
        let expected: LineString<f64> =
            vec![(0.0, 0.0), (2.0, 0.0), (1.0, 0.0), (1.0, 2.0), (0.0, 2.0), (0.0, 0.0)].into();
        assert_eq!(thin.0[0].exterior(), &expected);
        // All of it is smaller than the tolerance.
        assert_eq!(thinned(&area, 9.0, 90.0), area);
    }
}
