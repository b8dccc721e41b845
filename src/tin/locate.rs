//! Finds the triangle at a position by walking from triangle to triangle.

use glam::DVec2;
use robust::orient2d;

use super::network::{NONE, Tin};

impl Tin {
    /// The triangle in or on which a position lies (relative to the origin), walking from triangle `from`. `None`
    /// outside the triangulation.
    pub fn locate(&self, from: u32, place: DVec2) -> Option<u32> {
        self.walk(from, place).ok()
    }

    /// The triangle in or on which a position lies (relative to the origin), walking from triangle `from`. The error is
    /// the triangle where the walk left the triangulation; the next walk from there is short.
    pub fn walk(&self, from: u32, place: DVec2) -> Result<u32, u32> {
        let coord = |p: DVec2| robust::Coord { x: p.x, y: p.y };
        let mut t = from;
        for step in 0..=self.len() {
            // Each step starts at another edge, which keeps the walk from going in circles.
            let beyond = (0..3).map(|k| (step + k) % 3).find(|&i| {
                let [a, b] = self.edge(t, i).map(|v| self.positions[v as usize]);
                orient2d(coord(a), coord(b), coord(place)) < 0.0
            });
            match beyond {
                None => return Ok(t),
                Some(i) if self.neighbours[t as usize][i] == NONE => return Err(t),
                Some(i) => t = self.neighbours[t as usize][i],
            }
        }
        // So long a walk goes round in a circle.
        (0..self.len() as u32).find(|&t| self.holds(t, place)).ok_or(from)
    }

    /// Whether a position (relative to the origin) lies in or on triangle `t`.
    pub fn holds(&self, t: u32, place: DVec2) -> bool {
        let coord = |p: DVec2| robust::Coord { x: p.x, y: p.y };
        let [a, b, c] = self.corners(t);
        [(a, b), (b, c), (c, a)].iter().all(|(u, v)| orient2d(coord(*u), coord(*v), coord(place)) >= 0.0)
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
}
