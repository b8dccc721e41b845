//! What is known of a map before it is triangulated.

use crate::contour::{ContourMap, Interval};
use crate::subdomains::FrameRing;

/// Contours in a frame.
#[derive(Debug, Clone, Copy)]
pub struct MapExtent<'a> {
    /// The map, cut to the frame.
    pub map: &'a ContourMap,
    /// The frame's outline.
    pub frame: &'a FrameRing,
    /// The vertical interval.
    pub interval: Interval,
    /// Mean distance between neighbouring contours, area over length of contour, map units.
    pub spacing: f64,
}

impl<'a> MapExtent<'a> {
    /// With the area inside the frame: parts of it that hold no contour count too.
    pub fn new(map: &'a ContourMap, frame: &'a FrameRing, interval: Interval) -> Self {
        Self::with_area(map, frame, interval, geo::Area::unsigned_area(&frame.area))
    }

    /// With an area that is known.
    pub fn with_area(map: &'a ContourMap, frame: &'a FrameRing, interval: Interval, area: f64) -> Self {
        let length: f64 = map.contours.iter().map(|c| c.length()).sum();
        Self { map, frame, interval, spacing: area / length.max(f64::MIN_POSITIVE) }
    }
}
