//! Cuts lakes back from contours that contradict them.

use std::collections::BTreeMap;

use geo::{
    BooleanOps, BoundingRect, Buffer, Coord, Intersects, LineString, MapCoords, MultiLineString, MultiPoint,
    MultiPolygon, Point, Rect,
};
use glam::DVec2;
use rstar::RTree;

use super::net::Net;
use crate::geometry::{Border, OrientedBox, rings, tolerance};
use crate::geometry::{Meeting, meeting, place, point_distance};

/// How far a boolean operation moves a vertex at most, as a share of the size of its input.
const ROUNDING: f64 = 4e-9;

/// Segments up to this share of the distance to keep count as points, because a buffer around a line without length is
/// empty. Points that close to each other count as one, because circles around many such points would all cross each
/// other.
const SHORT: f64 = 1e-3;

/// A point where a contour of another level, or a frame extension, meets a lake.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Clash {
    pub level: f64,
    pub is_extension: bool,
    pub place: DVec2,
}

/// Cuts a lake back from contours of other levels that lie in it, cross it or touch it: all that is nearer to them than
/// `distance` is removed. Also returns the first such point of each level.
///
/// The lake is cut back from frame extensions of its own level too. They are not drawn, and a line along a shore must
/// not end on one.
pub(crate) fn cut_back(
    area: MultiPolygon<f64>,
    height: f64,
    net: &Net,
    distance: f64,
) -> (MultiPolygon<f64>, Vec<Clash>) {
    let border = Border::new(&area);
    let Some(bounds) = area.bounding_rect() else { return (area, Vec::new()) };
    let corner = |c: Coord<f64>| DVec2::new(c.x, c.y);
    let mut lines: Vec<LineString<f64>> = Vec::new();
    let mut points: BTreeMap<[i64; 2], Point<f64>> = BTreeMap::new();
    let mut clashes: Vec<Clash> = Vec::new();
    let around = OrientedBox::upright(corner(bounds.min()), corner(bounds.max())).grown(border.tolerance());
    for piece in net.near_box(around) {
        let is_extension = net.courses[piece.line as usize].is_extension;
        if piece.level == height && !is_extension {
            continue;
        }
        let ends = piece.ends;
        let touched = border.near(ends.a, ends.b).find_map(|(_, edge)| {
            let is_near = |p: DVec2, of| point_distance(p, of) <= border.tolerance();
            let met = (edge.a != edge.b && meeting(&ends, &edge) != Meeting::Apart)
                || [edge.a, edge.b].iter().any(|&p| is_near(p, &ends))
                || [ends.a, ends.b].iter().any(|&p| is_near(p, &edge));
            met.then(|| place(&ends, &edge))
        });
        let Some(at) = touched.or_else(|| border.contains(ends.a).then_some(ends.a)) else { continue };
        if ends.a.distance(ends.b) > SHORT * distance {
            lines.push([ends.a, ends.b].map(|p| Coord { x: p.x, y: p.y }).to_vec().into());
        } else {
            let cell = ((ends.a - corner(bounds.min())) / (SHORT * distance)).to_array().map(|v| v as i64);
            points.entry(cell).or_insert(Point::new(ends.a.x, ends.a.y));
        }
        if clashes.iter().all(|clash| clash.level != piece.level || clash.is_extension != is_extension) {
            clashes.push(Clash { level: piece.level, is_extension, place: at });
        }
    }
    let mut rest = area.clone();
    if !lines.is_empty() {
        rest = rest.difference(&MultiLineString::new(lines).buffer(distance));
    }
    if !points.is_empty() {
        rest = rest.difference(&MultiPoint::new(points.into_values().collect()).buffer(distance));
    }
    (with_own_vertices(rest, &area), clashes)
}

/// The lake without the part that is nearer than `distance` to other water; none if the two do not meet.
pub(crate) fn cut_from_water(
    area: &MultiPolygon<f64>,
    other: &MultiPolygon<f64>,
    distance: f64,
) -> Option<MultiPolygon<f64>> {
    let reach = tolerance(area).max(tolerance(other));
    let [a, b] = [area.bounding_rect()?, other.bounding_rect()?];
    let grown = Rect::new(a.min() - Coord { x: reach, y: reach }, a.max() + Coord { x: reach, y: reach });
    if !grown.intersects(&b) {
        return None;
    }
    let borders = [Border::new(area), Border::new(other)];
    // A distance within rounding counts as contact: otherwise both shores would have a height at one position.
    let touches = |area: &MultiPolygon<f64>, border: &Border| {
        let mut corners = rings(area).flat_map(|ring| ring.coords()).map(|c| DVec2::new(c.x, c.y));
        corners.any(|corner| border.edge_at(corner).is_some())
    };
    let meet = area.intersects(other) || touches(area, &borders[1]) || touches(other, &borders[0]);
    // The buffer of an area omits its arms without width. The buffer of its shore has them.
    let shore = MultiLineString::new(rings(other).cloned().collect());
    let around =
        |area: &MultiPolygon<f64>| area.difference(&other.buffer(distance)).difference(&shore.buffer(distance));
    meet.then(|| with_own_vertices(around(area), area))
}

/// The union of two pieces of water of one height; none if they do not meet.
pub(crate) fn joined(area: &MultiPolygon<f64>, other: &MultiPolygon<f64>) -> Option<MultiPolygon<f64>> {
    let bounds = [area.bounding_rect()?, other.bounding_rect()?];
    (bounds[0].intersects(&bounds[1]) && area.intersects(other)).then(|| {
        let both: MultiPolygon<f64> = area.iter().chain(other).cloned().collect();
        with_own_vertices(area.union(other), &both)
    })
}

/// A result of boolean operations. Vertices that moved only by rounding get back their coordinates in `before`.
fn with_own_vertices(after: MultiPolygon<f64>, before: &MultiPolygon<f64>) -> MultiPolygon<f64> {
    let Some(bounds) = before.bounding_rect() else { return after };
    let near = ROUNDING * bounds.width().hypot(bounds.height());
    let corners: Vec<[f64; 2]> = rings(before).flat_map(|ring| ring.coords()).map(|c| [c.x, c.y]).collect();
    let corners = RTree::bulk_load(corners);
    after.map_coords(|c| match corners.nearest_neighbor(&[c.x, c.y]) {
        Some(&[x, y]) if (x - c.x).hypot(y - c.y) <= near => Coord { x, y },
        _ => c,
    })
}

#[cfg(test)]
mod tests {
    use geo::{Area, polygon};

    use super::*;

    #[test]
    fn water_is_cut_back_from_an_arm_without_width() {
        let area =
            MultiPolygon::from(polygon![(x: 0.0, y: 0.0), (x: 40.0, y: 0.0), (x: 40.0, y: 20.0), (x: 0.0, y: 20.0)]);
        let arm = MultiPolygon::from(polygon![(x: 5.0, y: -9.0), (x: 5.0 + 1e-9, y: 15.0), (x: 5.0, y: 15.0)]);
        let rest = cut_from_water(&area, &arm, 0.5).unwrap();
        assert!((area.unsigned_area() - rest.unsigned_area() - 15.4).abs() < 0.1, "{}", rest.unsigned_area());
    }

    #[test]
    fn water_apart_by_rounding_is_cut_back() {
        let lake = |from: f64| -> MultiPolygon<f64> {
            polygon![(x: from, y: 0.0), (x: from + 4.0, y: 0.0), (x: from + 4.0, y: 4.0), (x: from, y: 4.0)].into()
        };
        let rest = cut_from_water(&lake(4.0 + 1e-15), &lake(0.0), 0.5).unwrap();
        assert!((rest.unsigned_area() - 14.0).abs() < 1e-6, "{rest:?}");
        assert_eq!(cut_from_water(&lake(4.001), &lake(0.0), 0.5), None);
    }
}
