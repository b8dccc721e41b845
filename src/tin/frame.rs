//! The frame: the outermost border, which closes the contours that run off the map.

use geo::{BoundingRect, ConvexHull, Coord, LineString, MultiPoint, MultiPolygon, Polygon};
use glam::DVec2;
use rstar::RTree;
use rstar::primitives::{GeomWithData, Line};

use crate::contour::ContourMap;

/// How the frame is chosen.
#[derive(Debug, Clone, PartialEq, Default)]
pub enum Frame {
    /// The convex hull of all contours and spot heights.
    #[default]
    Hull,
    /// The smallest upright rectangle around them.
    Box,
    /// A boundary polygon of the user's.
    Polygon(MultiPolygon<f64>),
}

/// The frame's outline for one map.
#[derive(Debug, Clone, PartialEq)]
pub struct FrameRing {
    /// The area inside the frame.
    pub area: MultiPolygon<f64>,
}

impl FrameRing {
    /// The vertices of each ring, the first one not repeated.
    pub fn rings(&self) -> impl Iterator<Item = Vec<DVec2>> {
        self.area.iter().flat_map(|p| std::iter::once(p.exterior()).chain(p.interiors())).map(|ring| {
            let n = ring.0.len().saturating_sub(1);
            ring.0[..n].iter().map(|c| DVec2::new(c.x, c.y)).collect()
        })
    }

    /// The edges of all rings.
    pub fn edges(&self) -> impl Iterator<Item = [DVec2; 2]> {
        self.area
            .iter()
            .flat_map(|p| std::iter::once(p.exterior()).chain(p.interiors()))
            .flat_map(|ring| ring.lines().map(|l| [DVec2::new(l.start.x, l.start.y), DVec2::new(l.end.x, l.end.y)]))
    }

    /// The same outline with further vertices, each on the edge that is nearest to it.
    pub fn with_points(&self, points: &[DVec2]) -> Self {
        let edges = self.edges().enumerate().map(|(id, [a, b])| GeomWithData::new(Line::new(a.into(), b.into()), id));
        let tree: RTree<GeomWithData<Line<[f64; 2]>, usize>> = RTree::bulk_load(edges.collect());
        let mut on_edge: Vec<Vec<DVec2>> = vec![Vec::new(); tree.size()];
        for p in points {
            if let Some(edge) = tree.nearest_neighbor(&p.to_array()) {
                on_edge[edge.data].push(*p);
            }
        }
        let mut id = 0;
        let mut ring_with = |ring: &LineString<f64>| {
            let mut coords = Vec::with_capacity(ring.0.len());
            for line in ring.lines() {
                let start = DVec2::new(line.start.x, line.start.y);
                coords.push(line.start);
                let new = &mut on_edge[id];
                new.sort_by(|a, b| a.distance_squared(start).total_cmp(&b.distance_squared(start)));
                coords.extend(new.iter().map(|p| Coord { x: p.x, y: p.y }));
                id += 1;
            }
            LineString::new(coords)
        };
        let polygons = self.area.iter().map(|p| {
            let exterior = ring_with(p.exterior());
            Polygon::new(exterior, p.interiors().iter().map(&mut ring_with).collect())
        });
        Self { area: polygons.collect() }
    }

    /// Length of the diagonal of the box around the frame.
    pub fn diagonal(&self) -> f64 {
        self.area.bounding_rect().map_or(0.0, |r| r.width().hypot(r.height()))
    }
}

/// The frame of a map.
pub fn frame_ring(map: &ContourMap, frame: &Frame) -> FrameRing {
    let points = || {
        let contours = map.contours.iter().flat_map(|c| c.points.iter().copied());
        contours.chain(map.spots.iter().map(|s| s.truncate())).map(|p| geo::Point::new(p.x, p.y))
    };
    let area = match frame {
        Frame::Hull => points().collect::<MultiPoint<f64>>().convex_hull().into(),
        Frame::Box => match points().collect::<MultiPoint<f64>>().bounding_rect() {
            Some(rect) => rect.to_polygon().into(),
            None => MultiPolygon::<f64>::new(Vec::<Polygon<f64>>::new()),
        },
        Frame::Polygon(area) => area.clone(),
    };
    FrameRing { area }
}
