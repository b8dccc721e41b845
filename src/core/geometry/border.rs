//! The border of an area, with an index of its edges.

use std::sync::OnceLock;

use geo::{BoundingRect, Coord, LineString, MultiPolygon, Polygon};
use glam::DVec2;
use rstar::RTree;

use super::inside::Inside;
use super::{BoxTree, OrientedBox, Segment, point_distance};
use crate::base::parallel;

/// Tolerance of the border, as a share of the diagonal of the box around the area.
const NEAR: f64 = 1e-9;
/// Least tolerance, map units. On the working plane, coordinates are whole micrometres: a point and the edge that it was on
/// move apart by up to the diagonal of a square micrometre.
const LEAST: f64 = 2e-6;
/// The least tolerance is no larger than this share of the diagonal. Maps that are so small are on no working plane.
const MOST: f64 = 1e-6;
/// Tolerance as a share of the largest coordinate, for small areas far from zero, whose coordinates have few digits
/// left.
const ROUNDING: f64 = 16.0 * f64::EPSILON;

/// The number of an edge of the border, and a position on it.
pub type OnEdge = (u32, DVec2);

/// The edges of all rings of an area, with indexes to find those near a position and to tell inside from outside. Each
/// index is built when it is first asked. Both bear outlines with long spikes, whose upright boxes would all meet.
///
/// Edges are numbered ring by ring: of each polygon the exterior, then the holes.
#[derive(Debug)]
pub struct Border {
    edges: Vec<Segment>,
    boxes: OnceLock<BoxTree>,
    inside: OnceLock<Inside>,
    /// Within this distance a position counts as on the border, map units.
    tolerance: f64,
}

impl Border {
    /// Takes the border of an area.
    pub fn new(area: &MultiPolygon<f64>) -> Self {
        let point = |c: Coord| DVec2::new(c.x, c.y);
        let lines = rings(area).flat_map(|ring| ring.lines());
        let edges = lines.map(|l| Segment { a: point(l.start), b: point(l.end) }).collect();
        Self { edges, boxes: OnceLock::new(), inside: OnceLock::new(), tolerance: tolerance(area) }
    }

    /// Within this distance a position counts as on the border, map units.
    pub fn tolerance(&self) -> f64 {
        self.tolerance
    }

    /// The edges in the order of their numbers.
    pub fn edges(&self) -> &[Segment] {
        &self.edges
    }

    /// Whether a position lies inside: a ray from it to the east crosses an odd number of edges.
    pub fn contains(&self, p: DVec2) -> bool {
        self.inside.get_or_init(|| Inside::new(self.edges.iter().copied())).contains(p)
    }

    /// The edge on which a position lies, with its ends.
    pub fn edge_at(&self, p: DVec2) -> Option<(u32, Segment)> {
        let distance = |edge: &Segment| point_distance(p, edge);
        self.near(p, p)
            .map(|(id, edge)| (distance(&edge), id, edge))
            .filter(|(distance, ..)| *distance <= self.tolerance)
            .min_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)))
            .map(|(_, id, edge)| (id, edge))
    }

    /// The edges near the segment from `a` to `b`, in no particular order; some may be a little further away.
    pub fn near(&self, a: DVec2, b: DVec2) -> impl Iterator<Item = (u32, Segment)> {
        self.near_box(OrientedBox::around(&[a, b]).grown(self.tolerance))
    }

    /// The edges that meet a box, in no particular order; some may only be near it.
    pub fn near_box(&self, area: OrientedBox) -> impl Iterator<Item = (u32, Segment)> {
        self.boxes().near(area).map(|id| (id, self.edges[id as usize]))
    }

    /// The distance from a position to the border.
    pub fn distance(&self, p: DVec2) -> f64 {
        let mut best = f64::INFINITY;
        for (id, least) in self.boxes().nearest_first(p) {
            if least >= best {
                break;
            }
            best = best.min(point_distance(p, &self.edges[id as usize]));
        }
        best
    }

    fn boxes(&self) -> &BoxTree {
        self.boxes.get_or_init(|| {
            BoxTree::new(&parallel::map_each(&self.edges, |edge| OrientedBox::around(&[edge.a, edge.b])))
        })
    }
}

/// Within this distance a position counts as on the border of an area, map units. Positions computed to lie on it are
/// off by less.
pub fn tolerance(area: &MultiPolygon<f64>) -> f64 {
    area.bounding_rect().map_or(0.0, |r| {
        let corner = |c: Coord| DVec2::new(c.x, c.y);
        tolerance_of_box(corner(r.min()), corner(r.max()))
    })
}

/// The same for an area with the box around it.
pub fn tolerance_of_box(min: DVec2, max: DVec2) -> f64 {
    let size = min.distance(max);
    (NEAR * size).max(LEAST.min(MOST * size)) + ROUNDING * min.abs().max(max.abs()).max_element()
}

/// The area with further vertices on its border, each with the number of its edge. Along an edge they are sorted by
/// position, so that no edge turns back.
pub fn with_vertices(area: &MultiPolygon<f64>, mut vertices: Vec<OnEdge>) -> MultiPolygon<f64> {
    vertices.sort_by(|a, b| a.0.cmp(&b.0).then(a.1.x.total_cmp(&b.1.x)).then(a.1.y.total_cmp(&b.1.y)));
    vertices.dedup();
    let (mut id, mut next) = (0, 0);
    let mut ring_with = |ring: &LineString<f64>| {
        let mut coords = Vec::with_capacity(ring.0.len());
        for line in ring.lines() {
            coords.push(line.start);
            let from = next;
            while vertices.get(next).is_some_and(|v| v.0 == id) {
                next += 1;
            }
            let start = DVec2::new(line.start.x, line.start.y);
            let along = DVec2::new(line.end.x, line.end.y) - start;
            let new = &mut vertices[from..next];
            new.sort_by(|a, b| (a.1 - start).dot(along).total_cmp(&(b.1 - start).dot(along)));
            coords.extend(new.iter().map(|(_, p)| Coord { x: p.x, y: p.y }));
            id += 1;
        }
        let mut ring = LineString::new(coords);
        ring.close();
        ring
    };
    let polygons = area.iter().map(|p| {
        let exterior = ring_with(p.exterior());
        Polygon::new(exterior, p.interiors().iter().map(&mut ring_with).collect())
    });
    polygons.collect()
}

/// The area with its corners moved to points of the map beside them. Two positions that differ only by rounding, but
/// have different heights, would leave room for lines between them. Points of a map never move.
pub fn with_corners_at(points: &[DVec2], area: &MultiPolygon<f64>) -> MultiPolygon<f64> {
    let reach = tolerance(area);
    let corners: RTree<[f64; 2]> =
        RTree::bulk_load(rings(area).flat_map(|ring| ring.coords()).map(|c| [c.x, c.y]).collect());
    let nearest =
        |corner: DVec2, points: &RTree<[f64; 2]>| points.nearest_neighbor(&corner.to_array()).map(|&p| DVec2::from(p));
    let is_beside = |p: DVec2, q: &DVec2| p.distance(*q) <= reach;
    let beside = parallel::flat_map_each(points, |&p| {
        nearest(p, &corners).filter(|corner| is_beside(p, corner)).map(|_| p.to_array())
    });
    let beside = RTree::bulk_load(beside);
    let moved = |ring: &LineString<f64>| {
        let corners = ring.coords().map(|c| {
            let corner = DVec2::new(c.x, c.y);
            let p = nearest(corner, &beside).filter(|p| is_beside(corner, p)).unwrap_or(corner);
            Coord { x: p.x, y: p.y }
        });
        let mut corners: Vec<Coord<f64>> = corners.collect();
        corners.dedup();
        LineString::new(corners)
    };
    area.iter().map(|p| Polygon::new(moved(p.exterior()), p.interiors().iter().map(moved).collect())).collect()
}

/// All rings of an area, in the order of their edges' numbers.
pub fn rings(area: &MultiPolygon<f64>) -> impl Iterator<Item = &LineString<f64>> {
    area.iter().flat_map(|p| std::iter::once(p.exterior()).chain(p.interiors()))
}

#[cfg(test)]
mod tests {
    use std::collections::HashSet;

    use geo::polygon;

    use super::*;

    fn area() -> MultiPolygon<f64> {
        polygon!(
            exterior: [(x: 0.0, y: 0.0), (x: 10.0, y: 0.0), (x: 10.0, y: 10.0), (x: 5.0, y: 4.0), (x: 0.0, y: 10.0)],
            interiors: [[(x: 2.0, y: 2.0), (x: 2.0, y: 3.0), (x: 3.0, y: 2.0)]],
        )
        .into()
    }

    #[test]
    fn inside_and_outside() {
        let border = Border::new(&area());
        for (x, y, inside) in [
            (1.0, 1.0, true),
            (2.2, 2.2, false),
            (1.0, 2.0, true),
            (1.0, 3.0, true),
            (4.0, 2.0, true),
            (5.0, 5.0, false),
            (4.5, 4.0, true),
            (-1.0, 4.0, false),
            (-1.0, 0.0, false),
            (-1.0, 10.0, false),
            (11.0, 5.0, false),
        ] {
            assert_eq!(border.contains(DVec2::new(x, y)), inside, "{x} {y}");
        }
        assert!(!Border::new(&MultiPolygon::new(Vec::new())).contains(DVec2::ZERO));
    }

    #[test]
    fn places_on_the_border_name_their_edge() {
        let border = Border::new(&area());
        let at = |x: f64, y: f64| border.edge_at(DVec2::new(x, y)).map(|(id, _)| id);
        assert_eq!(at(5.0, 1e-9), Some(0));
        assert_eq!(at(5.0, 1e-5), None);
        assert_eq!(at(0.0, 5.0), Some(4));
        assert_eq!(at(2.5, 2.5), Some(6));
        assert_eq!(at(2.0, 2.0), Some(5), "the first of the two edges of a corner");
    }

    #[test]
    fn corners_lie_where_the_points_beside_them_do() {
        let beside = DVec2::new(10.0 - 1e-9, 2e-9);
        let points = [beside, DVec2::new(9.9, 0.0), DVec2::new(4.0, 2.0), DVec2::new(3.0, 2.0 + 1e-9)];
        let moved = with_corners_at(&points, &area());
        let corners: HashSet<[u64; 2]> =
            rings(&moved).flat_map(|ring| &ring.0).map(|c| [c.x.to_bits(), c.y.to_bits()]).collect();
        let at = |p: DVec2| p.to_array().map(f64::to_bits);
        assert_eq!(corners.len(), 8);
        assert!(corners.contains(&at(beside)) && corners.contains(&at(points[3])));
        assert!(!corners.contains(&at(DVec2::new(10.0, 0.0))) && corners.contains(&at(DVec2::new(2.0, 2.0))));
        assert_eq!(with_corners_at(&[], &area()), area());
    }

    #[test]
    fn new_vertices_follow_their_edge() {
        let p = |x: f64, y: f64| DVec2::new(x, y);
        let more = with_vertices(
            &area(),
            vec![(0, p(7.0, 1e-9)), (4, p(0.0, 3.0)), (0, p(2.0, 0.0)), (4, p(0.0, 6.0)), (0, p(2.0, 0.0))],
        );
        let ring: Vec<(f64, f64)> = more.0[0].exterior().0.iter().map(|c| (c.x, c.y)).collect();
        let expected = [
            (0.0, 0.0),
            (2.0, 0.0),
            (7.0, 1e-9),
            (10.0, 0.0),
            (10.0, 10.0),
            (5.0, 4.0),
            (0.0, 10.0),
            (0.0, 6.0),
            (0.0, 3.0),
            (0.0, 0.0),
        ];
        assert_eq!(ring, expected);
        assert_eq!(with_vertices(&area(), Vec::new()), area());
    }
}
