//! Assigns holes to polygons.
//!
//! The format distinguishes exterior rings and holes by their direction, and does not say to which polygon a hole
//! belongs. Many programs write the wrong direction. Therefore the nesting of the rings decides: a ring inside an even
//! number of others bounds an area, and a ring inside an odd number is a hole of the smallest ring around it.

use geo::coordinate_position::{CoordPos, CoordinatePosition};
use geo::{Area, BoundingRect, Coord, LineString, Polygon, Rect};
use glam::DVec2;

use crate::table::Rings;

/// Groups the rings of one shape into polygons, in the order of their exterior rings.
pub(crate) fn grouped(rings: Vec<Vec<DVec2>>) -> Vec<Rings> {
    if rings.len() == 1 {
        return vec![rings];
    }
    let measured: Vec<MeasuredRing> = rings.iter().map(|ring| MeasuredRing::new(ring)).collect();
    let enclosing: Vec<Vec<usize>> = (0..measured.len())
        .map(|inner| {
            (0..measured.len()).filter(|&outer| outer != inner && measured[outer].holds(&measured[inner])).collect()
        })
        .collect();
    let innermost =
        |ring: usize| enclosing[ring].iter().copied().min_by(|&a, &b| measured[a].area.total_cmp(&measured[b].area));
    let is_even = |ring: usize| enclosing[ring].len().is_multiple_of(2);
    // If the smallest ring around a hole is itself a hole, the rings must cross. Such a hole becomes a polygon of its
    // own.
    let owner = |ring: usize| innermost(ring).filter(|&outer| !is_even(ring) && is_even(outer));
    let owners: Vec<Option<usize>> = (0..measured.len()).map(owner).collect();
    let mut place = vec![0; rings.len()];
    let mut polygons: Vec<Rings> = Vec::new();
    let (holes, exteriors): (Vec<_>, Vec<_>) = rings.into_iter().enumerate().partition(|(i, _)| owners[*i].is_some());
    for (i, ring) in exteriors {
        place[i] = polygons.len();
        polygons.push(vec![ring]);
    }
    for (i, ring) in holes {
        polygons[place[owners[i].expect("holes have an owner")]].push(ring);
    }
    polygons
}

/// A ring with its polygon, bounds and area, which the nesting test needs often.
struct MeasuredRing {
    polygon: Polygon<f64>,
    bounds: Option<Rect<f64>>,
    area: f64,
}

impl MeasuredRing {
    fn new(ring: &[DVec2]) -> Self {
        let polygon =
            Polygon::new(ring.iter().map(|p| Coord { x: p.x, y: p.y }).collect::<LineString<f64>>(), Vec::new());
        Self { bounds: polygon.bounding_rect(), area: polygon.unsigned_area(), polygon }
    }

    /// Whether another ring lies inside, judged by its first vertex that is not on the boundary.
    fn holds(&self, other: &Self) -> bool {
        let (Some(outer), Some(inner)) = (self.bounds, other.bounds) else { return false };
        let spans = outer.min().x <= inner.min().x
            && outer.min().y <= inner.min().y
            && outer.max().x >= inner.max().x
            && outer.max().y >= inner.max().y;
        spans
            && self.area > other.area
            && other
                .polygon
                .exterior()
                .coords()
                .map(|c| self.polygon.coordinate_position(c))
                .find(|p| *p != CoordPos::OnBoundary)
                == Some(CoordPos::Inside)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn square(x: f64, half: f64) -> Vec<DVec2> {
        [(-half, -half), (-half, half), (half, half), (half, -half), (-half, -half)]
            .map(|(u, v)| DVec2::new(x + u, v))
            .to_vec()
    }

    #[test]
    fn nesting_tells_holes_whatever_their_direction() {
        let reversed = |mut ring: Vec<DVec2>| {
            ring.reverse();
            ring
        };
        for turn in [false, true] {
            let hole = if turn { reversed(square(0.0, 6.0)) } else { square(0.0, 6.0) };
            let rings = vec![square(0.0, 2.0), square(30.0, 5.0), hole.clone(), square(0.0, 9.0), square(30.0, 1.0)];
            let polygons = grouped(rings);
            let expected =
                [vec![square(0.0, 2.0)], vec![square(30.0, 5.0), square(30.0, 1.0)], vec![square(0.0, 9.0), hole]];
            assert_eq!(polygons, expected);
        }
    }

    #[test]
    fn rings_without_sense_are_kept_as_they_are() {
        let nan = vec![DVec2::NAN; 4];
        let line = vec![DVec2::ZERO, DVec2::ONE, DVec2::ZERO];
        let polygons = grouped(vec![nan, line.clone(), square(0.0, 1.0), square(0.0, 1.0), square(1.0, 1.0)]);
        assert_eq!(polygons.iter().flatten().count(), 5);
        assert!(polygons.iter().flatten().any(|ring| *ring == line));
        assert_eq!(grouped(Vec::new()), Vec::<Rings>::new());
    }
}
