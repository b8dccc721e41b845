//! The frame: the outermost border, which closes the contours that run off the map.

use geo::{BoundingRect, ConvexHull, MultiPoint, MultiPolygon, Polygon};
use glam::DVec2;

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
