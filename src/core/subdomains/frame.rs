//! The frame: the outermost border, which closes the contours that run off the map.

use geo::convex_hull::graham_hull;
use geo::{Area, BoundingRect, ConvexHull, Coord, IsConvex, LineString, MultiPoint, MultiPolygon, Polygon, Rect};
use glam::DVec2;

use crate::contour::ContourMap;
use crate::geometry::{Border, common_area, rings, tolerance, with_corners_at, with_vertices};

/// How far a polygon may reach beyond the box around the map before it is cut to the hull, as a share of the mean spacing. The neat
/// line of a sheet lies a little outside its contours. Further out, the ends of contours are nearer to each other than
/// to the frame, and nothing says where they lead.
const REACH: f64 = 0.5;
/// How far ground is carried on beyond the box around the map at most, as a share of the diagonal of the box.
const FURTHEST: f64 = 1.0;

/// How the frame is chosen.
#[derive(Debug, Clone, PartialEq, Default)]
pub enum Frame {
    /// The convex hull of all contours and spot heights. Where these fill less than a third of it, an outline that follows them:
    /// The facade's `Input::clean` decides. To all steps after it, this is the hull.
    #[default]
    Auto,
    /// The convex hull of all contours and spot heights.
    Hull,
    /// The smallest upright rectangle around them.
    Box,
    /// A boundary polygon of the user's. Its polygons do not overlap, and none crosses itself. Ground is carried on to it where
    /// it reaches beyond the contours.
    Polygon(MultiPolygon<f64>),
    /// The part of such a polygon that lies inside the convex hull of all contours and spot heights.
    PolygonInHull(MultiPolygon<f64>),
    /// An outline of the contours: vertices of theirs are its corners, and all of them lie inside. Its polygons may touch at
    /// corners.
    Outline(MultiPolygon<f64>),
    /// The part of a hull or of a rectangle around a map that lies in a rectangle. Like a hull, it is convex, and no edge of it is
    /// held: the triangulation ends there by itself.
    Convex(MultiPolygon<f64>),
}

impl Frame {
    /// The boundary polygon of the user's, if the frame is one.
    pub fn polygon(&self) -> Option<&MultiPolygon<f64>> {
        match self {
            Self::Polygon(area) | Self::PolygonInHull(area) => Some(area),
            Self::Auto | Self::Hull | Self::Box | Self::Outline(_) | Self::Convex(_) => None,
        }
    }

    /// The same frame, without ground outside the convex hull.
    #[must_use]
    pub fn in_hull(self) -> Self {
        match self {
            Self::Polygon(area) => Self::PolygonInHull(area),
            other => other,
        }
    }
}

/// The frame's outline for one map.
#[derive(Debug, Clone, PartialEq)]
pub struct FrameRing {
    /// The area inside the frame.
    pub area: MultiPolygon<f64>,
}

impl FrameRing {
    /// The lower left and the upper right corner of the box around it.
    pub fn extent(&self) -> (DVec2, DVec2) {
        self.rings().flatten().fold((DVec2::INFINITY, DVec2::NEG_INFINITY), |(lo, hi), p| (lo.min(p), hi.max(p)))
    }

    /// The vertices of each ring, the first one not repeated.
    pub fn rings(&self) -> impl Iterator<Item = Vec<DVec2>> {
        rings(&self.area).map(|ring| {
            let n = ring.0.len().saturating_sub(1);
            ring.0[..n].iter().map(|c| DVec2::new(c.x, c.y)).collect()
        })
    }

    /// The edges of all rings.
    pub fn edges(&self) -> impl Iterator<Item = [DVec2; 2]> {
        rings(&self.area)
            .flat_map(|ring| ring.lines().map(|l| [DVec2::new(l.start.x, l.start.y), DVec2::new(l.end.x, l.end.y)]))
    }

    /// The same outline with further vertices, each on the edge that it lies on. Points elsewhere are ignored.
    pub fn with_points(&self, points: &[DVec2]) -> Self {
        let border = Border::new(&self.area);
        let on_edges = points.iter().filter_map(|&p| {
            let (edge, ends) = border.edge_at(p)?;
            (p != ends.a && p != ends.b).then_some((edge, p))
        });
        Self { area: with_vertices(&self.area, on_edges.collect()) }
    }

    /// The same outline with only the vertices that `is_kept` accepts.
    pub fn only(self, is_kept: impl Fn(DVec2) -> bool) -> Self {
        let kept = |ring: &LineString<f64>| {
            let mut ring: LineString<f64> = ring.coords().copied().filter(|c| is_kept(DVec2::new(c.x, c.y))).collect();
            ring.close();
            ring
        };
        let polygon = |p: &Polygon<f64>| Polygon::new(kept(p.exterior()), p.interiors().iter().map(kept).collect());
        Self { area: self.area.iter().map(polygon).collect() }
    }

    /// Points of the frame closer than this count as one, map units.
    pub fn tolerance(&self) -> f64 {
        tolerance(&self.area)
    }

    /// Length of the diagonal of the box around the frame.
    pub fn diagonal(&self) -> f64 {
        self.area.bounding_rect().map_or(0.0, |r| r.width().hypot(r.height()))
    }
}

/// The frame of a map.
///
/// Of a polygon that reaches very far beyond the map, only the part counts that is no further from the box around the map
/// than the box is wide.
pub fn frame_ring(map: &ContourMap, frame: &Frame) -> FrameRing {
    let points = || map.places().map(|p| geo::Point::new(p.x, p.y));
    let hull = || {
        let quick = points().collect::<MultiPoint<f64>>().convex_hull();
        if quick.exterior().is_strictly_ccw_convex() {
            return quick;
        }
        // Where points lie on one line but for rounding, this hull can turn back. The slower method does not.
        Polygon::new(graham_hull(&mut quick.into_inner().0.into_inner(), false), Vec::new())
    };
    let bounds = || points().collect::<MultiPoint<f64>>().bounding_rect();
    let area = match frame {
        Frame::Auto | Frame::Hull => hull().into(),
        Frame::Outline(area) | Frame::Convex(area) => area.clone(),
        Frame::Box => match bounds() {
            Some(rect) => with_corners_at(&map.places().collect::<Vec<_>>(), &rect.to_polygon().into()),
            None => MultiPolygon::<f64>::new(Vec::<Polygon<f64>>::new()),
        },
        Frame::Polygon(area) => match (area.bounding_rect(), bounds()) {
            (Some(wanted), Some(known)) => {
                let reach = FURTHEST * known.width().hypot(known.height());
                let grown = Rect::new(
                    Coord { x: known.min().x - reach, y: known.min().y - reach },
                    Coord { x: known.max().x + reach, y: known.max().y + reach },
                );
                let is_near = is_near(&wanted, &known, reach);
                if is_near { area.clone() } else { common_area(area, &grown.to_polygon().into()) }
            }
            _ => area.clone(),
        },
        Frame::PolygonInHull(area) => match (area.bounding_rect(), bounds()) {
            (Some(wanted), Some(known)) => {
                let hull = hull();
                let length: f64 = map.contours.iter().map(|c| c.length()).sum();
                let reach = REACH * hull.unsigned_area() / length;
                if is_near(&wanted, &known, reach) { area.clone() } else { common_area(area, &hull.into()) }
            }
            _ => area.clone(),
        },
    };
    FrameRing { area }
}

/// Whether a rectangle reaches beyond another by no more than `reach`.
fn is_near(wanted: &Rect<f64>, known: &Rect<f64>, reach: f64) -> bool {
    let west_south = known.min() - wanted.min();
    let east_north = wanted.max() - known.max();
    [west_south.x, west_south.y, east_north.x, east_north.y].into_iter().all(|beyond| beyond <= reach)
}

#[cfg(test)]
mod tests {
    use geo::polygon;

    use super::*;
    use crate::contour::Contour;

    /// Two lines across a square of 100 from (5e5, 4e6).
    fn map() -> ContourMap {
        let line = |elevation: f64, y: f64| {
            let points = [0.0, 37.0, 100.0].map(|x| DVec2::new(5e5 + x, 4e6 + y)).to_vec();
            Contour { elevation, points, feature: 0.into() }
        };
        ContourMap { contours: vec![line(10.0, 0.0), line(20.0, 55.5), line(30.0, 100.0)], ..ContourMap::default() }
    }

    fn square(x: f64, y: f64, side: f64) -> MultiPolygon<f64> {
        let (x, y) = (5e5 + x, 4e6 + y);
        polygon![(x: x, y: y), (x: x + side, y: y), (x: x + side, y: y + side), (x: x, y: y + side)].into()
    }

    #[test]
    fn a_polygon_a_little_larger_than_the_map_is_kept() {
        for area in [square(10.3, 10.3, 50.1), square(-5.0, -5.0, 110.0)] {
            assert_eq!(frame_ring(&map(), &Frame::Polygon(area.clone())).area, area);
        }
    }

    #[test]
    fn a_box_has_the_points_beside_its_corners() {
        let beside = DVec2::new(5e5 + 100.0 - 1e-8, 4e6);
        let mut map = map();
        map.contours[0].points[2] = beside;
        let corners: Vec<DVec2> = frame_ring(&map, &Frame::Box).rings().flatten().collect();
        assert!(corners.len() == 4 && corners.contains(&beside), "{corners:?}");
    }

    #[test]
    fn a_polygon_without_ground_beyond_the_contours_ends_at_their_hull() {
        let ring = |frame| {
            let ring = frame_ring(&map(), &frame);
            let mut corners: Vec<[u64; 2]> = ring.rings().flatten().map(|p| p.to_array().map(f64::to_bits)).collect();
            corners.sort_unstable();
            corners
        };
        assert_eq!(ring(Frame::PolygonInHull(square(-1e6, -1e6, 2.1e6))), ring(Frame::Hull));
        let partly = frame_ring(&map(), &Frame::PolygonInHull(square(33.3, 20.2, 1e6)));
        let corners: Vec<DVec2> = partly.rings().flatten().map(|p| p - DVec2::new(5e5, 4e6)).collect();
        assert_eq!(corners.len(), 4);
        assert!(corners.iter().any(|p| p.distance(DVec2::new(33.3, 20.2)) < 1e-9));
        assert!(corners.contains(&DVec2::splat(100.0)));
        let on_hull = corners.iter().filter(|p| p.x == 100.0 || p.y == 100.0).count();
        assert_eq!(on_hull, 3, "crossings lie exactly on the edge of the map: {corners:?}");
    }

    #[test]
    fn a_polygon_is_kept_unless_it_is_far_larger_than_the_map() {
        for area in [square(-80.0, 20.0, 90.0), square(50.0, 50.0, 120.0)] {
            assert_eq!(frame_ring(&map(), &Frame::Polygon(area.clone())).area, area);
        }
        let (lo, hi) = frame_ring(&map(), &Frame::Polygon(square(-1e6, 20.0, 1e6 + 30.0))).extent();
        let reach = 100.0 * 2_f64.sqrt();
        assert!((lo - DVec2::new(5e5 - reach, 4e6 + 20.0)).length() < 1e-9, "{lo}");
        assert!((hi - DVec2::new(5e5 + 30.0, 4e6 + 100.0 + reach)).length() < 1e-9, "{hi}");
    }

    #[test]
    fn the_hull_of_points_on_a_line_but_for_rounding_never_turns_back() {
        let (a, b) = (DVec2::new(-1e7, 0.1), DVec2::new(6.791_015_624_999_999, -14_755.998_480_224_609));
        let on_line = [9, 5, 80, 128, 256, 10, 12, 16, 96].map(|k| a.lerp(b, f64::from(k) / 1024.0));
        let points = std::iter::once(a).chain(on_line).chain([b, DVec2::new(-9_890_000.0, 310_000.1), a]).collect();
        let contour = Contour { elevation: 0.0, points, feature: 0.into() };
        let map = ContourMap { contours: vec![contour], ..ContourMap::default() };
        let ring = frame_ring(&map, &Frame::Hull).rings().next().unwrap();
        let coord = |k: usize| {
            let p = ring[k % ring.len()];
            robust::Coord { x: p.x, y: p.y }
        };
        for k in 0..ring.len() {
            assert!(robust::orient2d(coord(k), coord(k + 1), coord(k + 2)) > 0.0, "vertex {} of {ring:?}", k + 1);
        }
    }

    #[test]
    fn a_polygon_elsewhere_leaves_nothing() {
        assert_eq!(frame_ring(&map(), &Frame::Polygon(square(500.0, 0.0, 10.0))).area, MultiPolygon::new(Vec::new()));
    }
}
