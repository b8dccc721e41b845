//! The triangle at a place, by walking.

use glam::DVec2;
use robust::orient2d;

use super::network::{NONE, Tin};

impl Tin {
    /// The triangle that a place (relative to the origin) lies in or on, walking from triangle `from`; none outside of the
    /// triangulation.
    pub fn locate(&self, from: u32, place: DVec2) -> Option<u32> {
        self.walk(from, place).ok()
    }

    /// The triangle that a place (relative to the origin) lies in or on, walking from triangle `from`; as an error the
    /// triangle where the way left the triangulation, from which the next walk is short.
    pub fn walk(&self, from: u32, place: DVec2) -> Result<u32, u32> {
        let coord = |p: DVec2| robust::Coord { x: p.x, y: p.y };
        let mut t = from;
        for step in 0..=self.len() {
            // Starting at another edge each time keeps the walk out of circles.
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
        // A walk that goes on for so long goes round in a circle.
        (0..self.len() as u32).find(|&t| self.holds(t, place)).ok_or(from)
    }

    /// Whether a place (relative to the origin) lies in or on triangle `t`.
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
