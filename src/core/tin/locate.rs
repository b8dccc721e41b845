//! Finds the triangle at a position by walking from triangle to triangle.

use foldhash::HashSet;
use glam::DVec2;
use robust::orient2d;

use super::network::{NONE, Tin};

/// A walk that has not ended after so many triangles comes from far.
const FAR: usize = 64;

impl Tin {
    /// The triangle in or on which a position lies (relative to the origin), walking from triangle `from`. `None`
    /// outside the triangulation.
    pub fn locate(&self, from: u32, place: DVec2) -> Option<u32> {
        self.walk(from, place).ok()
    }

    /// The triangle in or on which a position lies (relative to the origin), walking from triangle `from`. On an edge or a
    /// vertex, it is the first of the triangles there, so that the result is the same for each `from`. The error is the
    /// triangle where the walk left the triangulation; the next walk from there is short.
    ///
    /// A long walk goes on from the nearest of some triangles all over the triangulation (jump and walk: Mücke, Saias and
    /// Zhu 1996, Proc. 12th Symp. Comput. Geom.).
    pub fn walk(&self, from: u32, place: DVec2) -> Result<u32, u32> {
        let (mut t, mut before) = (from, NONE);
        for step in 0..=self.len() {
            if step == FAR {
                (t, before) = (self.nearest_of_some(t, place), NONE);
            }
            let near = self.neighbours[t as usize];
            let mut on_edge = false;
            let is_beyond = |&i: &usize| {
                // The walk came across this edge. So the position lies on this side of it.
                let side = if near[i] == before && before != NONE { 1.0 } else { self.side(t, i, place) };
                on_edge |= side == 0.0;
                side < 0.0
            };
            // Each step starts at another edge, which keeps the walk from going in circles.
            match (0..3).map(|k| (step + k) % 3).find(is_beyond) {
                None if on_edge => return Ok(self.first_at(t, place)),
                None => return Ok(t),
                Some(i) if near[i] == NONE => return Err(t),
                Some(i) => (t, before) = (near[i], t),
            }
        }
        // So long a walk goes round in a circle.
        (0..self.len() as u32).find(|&t| self.holds(t, place)).ok_or(from)
    }

    /// Of triangle `t` and as many others as the cube root of their number, all over the triangulation: the one with the
    /// nearest corner.
    fn nearest_of_some(&self, t: u32, place: DVec2) -> u32 {
        let count = (self.len() as f64).cbrt() as usize;
        let some = (0..count).map(|k| (k * self.len() / count) as u32);
        let distance = |t: u32| self.corners(t)[0].distance_squared(place);
        some.fold(t, |nearest, t| if distance(t) < distance(nearest) { t } else { nearest })
    }

    /// The first of the triangles that meet at a position on the border of triangle `t`. There may be thousands.
    fn first_at(&self, t: u32, place: DVec2) -> u32 {
        let mut found = HashSet::from_iter([t]);
        let mut next = vec![t];
        while let Some(t) = next.pop() {
            let near = self.neighbours[t as usize].into_iter().filter(|&n| n != NONE && self.holds(n, place));
            next.extend(near.filter(|&n| found.insert(n)));
        }
        found.into_iter().fold(t, u32::min)
    }

    /// Whether a position (relative to the origin) lies in or on triangle `t`.
    pub fn holds(&self, t: u32, place: DVec2) -> bool {
        (0..3).all(|i| self.side(t, i, place) >= 0.0)
    }

    /// On which side of edge `i` of triangle `t` a position lies: positive inside, zero on the edge.
    fn side(&self, t: u32, i: usize, place: DVec2) -> f64 {
        let coord = |p: DVec2| robust::Coord { x: p.x, y: p.y };
        let [a, b] = self.edge(t, i).map(|v| self.positions[v as usize]);
        orient2d(coord(a), coord(b), coord(place))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tin::{TinInput, VertexKind, triangulate};

    #[test]
    fn a_walk_ends_where_a_search_does() {
        let mut input = TinInput::new([DVec2::ZERO, DVec2::splat(100.0)], 0.0);
        for k in 0..60 {
            let angle = f64::from(k);
            let p = DVec2::splat(50.0) + DVec2::from_angle(angle) * (10.0 + f64::from(k * 7 % 40));
            input.push(p, 0.0, VertexKind::Contour);
        }
        let tin = triangulate(input).unwrap();
        for k in 0..200 {
            let p = DVec2::new(f64::from(k * 37 % 100), f64::from(k * 53 % 100)) - tin.origin;
            let holds = |t: u32| {
                let [a, b, c] = tin.corners(t);
                [(a, b), (b, c), (c, a)].iter().all(|(u, v)| (*v - *u).perp_dot(p - *u) >= 0.0)
            };
            let found = tin.locate(k as u32 % tin.len() as u32, p);
            assert_eq!(found.is_some(), (0..tin.len() as u32).any(holds), "{p}");
            assert!(found.is_none_or(holds), "{p}");
        }
    }

    #[test]
    fn a_walk_ends_in_the_same_triangle_wherever_it_begins() {
        let mut input = TinInput::new([DVec2::ZERO, DVec2::splat(40.0)], 0.0);
        for k in 0..1600 {
            input.push(DVec2::new(f64::from(k % 40), f64::from(k / 40)), 0.0, VertexKind::Contour);
        }
        let tin = triangulate(input).unwrap();
        let count = tin.len() as u32;
        assert!(tin.corners(count / 2)[0].distance(tin.corners(0)[0]) > 10.0, "far apart");
        let mut on_borders = 0;
        for k in 0..300u32 {
            // In triangles, on their edges, on their vertices.
            let place = DVec2::new(f64::from(k * 37 % 78), f64::from(k * 53 % 76)) * 0.5 - tin.origin;
            let holding: Vec<u32> = (0..count).filter(|&t| tin.holds(t, place)).collect();
            on_borders += usize::from(holding.len() > 1);
            for from in [0, count / 3, count / 2, k, count - 1] {
                assert_eq!(tin.locate(from, place), holding.first().copied(), "{place} from {from}");
            }
        }
        assert!(on_borders > 200, "{on_borders}");
    }
}
