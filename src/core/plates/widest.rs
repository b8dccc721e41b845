//! The widest circle in a piece, and whether a place is in the piece.

use std::collections::BinaryHeap;

use geo::{LineString, MultiPolygon, Polygon};
use glam::DVec2;

use crate::base::Key;
use crate::geometry::{Border, Bounds};

/// The radius of the widest circle is right to this share of it, or to `LEAST` millimetres.
const PRECISION: f64 = 0.02;
const LEAST: f64 = 0.05;

/// A circle, millimetres.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Circle {
    pub middle: DVec2,
    pub radius: f64,
}

/// An area with its holes.
pub(super) struct Shape {
    border: Border,
    bounds: Bounds,
}

impl Shape {
    /// The area of an outer ring and of holes.
    pub fn new(rings: &[Vec<DVec2>]) -> Self {
        let mut lines = rings.iter().map(|ring| ring.iter().map(|p| (p.x, p.y)).collect::<LineString<f64>>());
        let outer = lines.next().unwrap_or_else(|| LineString::new(Vec::new()));
        let area = MultiPolygon::from(Polygon::new(outer, lines.collect()));
        Self { border: Border::new(&area), bounds: Bounds::around(rings.first().map_or(&[], Vec::as_slice)) }
    }

    /// Whether a place lies inside.
    pub fn contains(&self, p: DVec2) -> bool {
        let Bounds { min, max } = self.bounds;
        min.cmple(p).all() && p.cmple(max).all() && self.border.contains(p)
    }

    /// The widest circle that fits inside, nearly. The search ends where no circle of the radius `least` fits.
    ///
    /// Squares that may hold the middle of a wider circle than the widest so far are quartered, the most promising first
    /// (Garcia-Castellanos and Lombardo 2007; the order of the search is that of Mapbox's polylabel).
    pub fn widest(&self, least: f64) -> Circle {
        let Bounds { min, max } = self.bounds;
        let size = max - min;
        let mut best = Circle { middle: min.midpoint(max), radius: 0.0 };
        let half = size.min_element() / 2.0;
        if half < least {
            return best;
        }
        let mut squares = vec![];
        let mut open: BinaryHeap<(Key, usize)> = BinaryHeap::new();
        let counts = (size / (2.0 * half)).ceil();
        let places =
            (0..counts.y as u32).flat_map(|j| (0..counts.x as u32).map(move |i| DVec2::new(i.into(), j.into())));
        let mut next: Vec<Square> = places.map(|at| Square { middle: min + half * (2.0 * at + 1.0), half }).collect();
        loop {
            for square in next {
                let circle = self.circle(square.middle);
                if circle.radius > best.radius {
                    best = circle;
                }
                // No place in the square is further from the middle than a corner.
                open.push((Key(circle.radius + square.half * std::f64::consts::SQRT_2), squares.len()));
                squares.push(square);
            }
            let Some((Key(most), k)) = open.pop() else { return best };
            if most < least || most <= best.radius + (PRECISION * best.radius).max(LEAST) {
                return best;
            }
            next = squares[k].quarters();
        }
    }

    /// The widest circle around a place; its radius is below 0 outside.
    fn circle(&self, middle: DVec2) -> Circle {
        let distance = self.border.distance(middle);
        Circle { middle, radius: if self.border.contains(middle) { distance } else { -distance } }
    }
}

/// A square around a place.
#[derive(Clone, Copy)]
struct Square {
    middle: DVec2,
    half: f64,
}

impl Square {
    fn quarters(self) -> Vec<Self> {
        let half = self.half / 2.0;
        let corners = [(-1.0, -1.0), (1.0, -1.0), (-1.0, 1.0), (1.0, 1.0)];
        corners.iter().map(|corner| Self { middle: self.middle + half * DVec2::from(*corner), half }).collect()
    }
}
