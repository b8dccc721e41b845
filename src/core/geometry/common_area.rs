//! The intersection of two areas, with the vertices of both as they are.

use geo::{BooleanOps, BoundingRect, Coord, MapCoords, MultiPolygon};
use glam::DVec2;
use rstar::RTree;
use rstar::primitives::Line;

use super::{Segment, place, rings};

/// How far the intersection of polygons moves a vertex at most, as a share of their size.
const ROUNDING: f64 = 2e-9;

/// What lies inside two areas.
///
/// The intersection rounds coordinates. Corners of both outlines get their own coordinates back. Where the outlines
/// cross, the point is computed again, to lie on both.
pub fn common_area(area: &MultiPolygon<f64>, other: &MultiPolygon<f64>) -> MultiPolygon<f64> {
    let size = |area: &MultiPolygon<f64>| area.bounding_rect().map_or(0.0, |r| r.width().hypot(r.height()));
    let near = ROUNDING * size(area).max(size(other));
    let corners = rings(area).chain(rings(other)).flat_map(|ring| ring.coords()).map(|c| [c.x, c.y]);
    let corners = RTree::bulk_load(corners.collect());
    let edges = |area: &MultiPolygon<f64>| {
        let lines = rings(area).flat_map(|ring| ring.lines());
        RTree::bulk_load(lines.map(|l| Line::new([l.start.x, l.start.y], [l.end.x, l.end.y])).collect())
    };
    let edges = [edges(area), edges(other)];
    let nearest_edge = |edges: &RTree<Line<[f64; 2]>>, at: [f64; 2]| {
        let edge = edges.nearest_neighbor(&at)?;
        Some(Segment { a: edge.from.into(), b: edge.to.into() })
    };
    area.intersection(other).map_coords(|c| {
        let at = [c.x, c.y];
        let is_near = |p: DVec2| p.distance(at.into()) <= near;
        let corner = corners.nearest_neighbor(&at).map(|&corner| DVec2::from(corner));
        let crossing = || Some(place(&nearest_edge(&edges[0], at)?, &nearest_edge(&edges[1], at)?));
        let exact = corner.filter(|&p| is_near(p)).or_else(|| crossing().filter(|&p| is_near(p)));
        exact.map_or(c, |p| Coord { x: p.x, y: p.y })
    })
}
