//! What is known of a map before it is triangulated: its frame, interval and mean spacing.

use glam::DVec2;

use crate::contour::{ContourMap, Interval};
use crate::subdomains::FrameRing;

/// The contours of a map in their frame.
#[derive(Debug, Clone, Copy)]
pub struct MapExtent<'a> {
    /// The map, cut to the frame.
    pub map: &'a ContourMap,
    /// The frame's outline.
    pub frame: &'a FrameRing,
    /// The vertical interval.
    pub interval: Interval,
    /// Mean spacing of the contours: area divided by length of contour, map units.
    pub spacing: f64,
}

impl<'a> MapExtent<'a> {
    /// Takes the area inside the frame. Parts of the frame without any contour count too.
    pub fn new(map: &'a ContourMap, frame: &'a FrameRing, interval: Interval) -> Self {
        Self::with_area(map, frame, interval, geo::Area::unsigned_area(&frame.area))
    }

    /// Takes a given area, square map units. An area that is larger than the box around the contours counts as much as this box.
    pub fn with_area(map: &'a ContourMap, frame: &'a FrameRing, interval: Interval, area: f64) -> Self {
        let (lo, hi) = map.places().fold((DVec2::INFINITY, DVec2::NEG_INFINITY), |(lo, hi), p| (lo.min(p), hi.max(p)));
        let area = area.min((hi - lo).max(DVec2::ZERO).element_product());
        let length: f64 = map.contours.iter().map(|c| c.length()).sum();
        Self { map, frame, interval, spacing: area / length.max(f64::MIN_POSITIVE) }
    }
}
