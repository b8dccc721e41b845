//! Where tiles are: the square of Web Mercator, halved with each zoom.

use std::f64::consts::PI;

use glam::DVec2;

/// The EPSG code of Web Mercator.
pub const WEB_MERCATOR: u32 = 3857;

/// Half the width of the Web Mercator map, metres: half the equator of its sphere.
pub const HALF_WIDTH: f64 = 6_378_137.0 * PI;

/// The side of a tile in Web Mercator metres.
pub fn tile_size(zoom: u8) -> f64 {
    2.0 * HALF_WIDTH / (1_u64 << zoom) as f64
}

/// A tile: its zoom, its column from the west, its row from the north.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct TilePlace {
    /// Zoom; the whole map is one tile at zoom 0.
    pub zoom: u8,
    /// Column from the west.
    pub x: u32,
    /// Row from the north.
    pub y: u32,
}

/// A place in Web Mercator as distances from the upper left corner of the map, in tiles of a zoom.
pub(super) fn in_tiles(place: DVec2, zoom: u8) -> DVec2 {
    DVec2::new(place.x + HALF_WIDTH, HALF_WIDTH - place.y) / tile_size(zoom)
}

/// A place in Web Mercator as longitude and latitude, degrees.
pub fn to_degrees(place: DVec2) -> DVec2 {
    DVec2::new(place.x / HALF_WIDTH * 180.0, latitude(place).to_degrees())
}

/// The latitude of a place in Web Mercator, radians.
pub(super) fn latitude(place: DVec2) -> f64 {
    (place.y / HALF_WIDTH * PI).sinh().atan()
}
