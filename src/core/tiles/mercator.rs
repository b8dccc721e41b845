//! Where tiles are: the square of Web Mercator, halved with each zoom.

use std::f64::consts::PI;

use glam::DVec2;

use crate::base::error::{Error, Result};

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

/// Refuses what the square of Web Mercator does not show. `low` and `high` are the corners of the box around it.
///
/// # Errors
/// [`Error::Data`] if the box reaches beyond a latitude of 85.05°.
pub fn check_latitudes(low: DVec2, high: DVec2) -> Result<()> {
    if low.y >= -HALF_WIDTH && high.y <= HALF_WIDTH {
        return Ok(());
    }
    Err(Error::Data(
        "the map reaches beyond a latitude of 85.05 degrees, where Web Mercator ends: choose a part of it with --extent".into(),
    ))
}

/// Refuses a line that leaps from one side of the square to the other: it crosses the meridian of 180°.
///
/// # Errors
/// [`Error::Data`] names the place where it leaps.
pub fn check_meridian(line: &[DVec2]) -> Result<()> {
    match line.windows(2).find(|ends| (ends[1].x - ends[0].x).abs() > HALF_WIDTH) {
        None => Ok(()),
        Some(ends) => Err(Error::Data(format!(
            "a contour crosses the meridian of 180 degrees at the latitude {:.4}: tiles cannot show it; cut the map there, and \
             make each side by itself",
            latitude(ends[0]).to_degrees()
        ))),
    }
}

/// A place in Web Mercator as longitude and latitude, degrees.
pub fn to_degrees(place: DVec2) -> DVec2 {
    DVec2::new(place.x / HALF_WIDTH * 180.0, latitude(place).to_degrees())
}

/// The latitude of a place in Web Mercator, radians.
pub(super) fn latitude(place: DVec2) -> f64 {
    (place.y / HALF_WIDTH * PI).sinh().atan()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_the_square_does_not_show_is_refused() {
        let end = DVec2::splat(HALF_WIDTH);
        assert!(check_latitudes(-end, end).is_ok());
        assert!(check_latitudes(-end, end + DVec2::Y).is_err() && check_latitudes(-end - DVec2::Y, end).is_err());
        let [west, east] = [-1.0, 1.0].map(|side| DVec2::new(side * (HALF_WIDTH - 5.0), 1e6));
        assert!(check_meridian(&[west, DVec2::ZERO, east]).is_ok());
        let error = check_meridian(&[DVec2::ZERO, east, west]).unwrap_err().to_string();
        assert!(error.contains("latitude 8.9466"), "{error}");
    }
}
