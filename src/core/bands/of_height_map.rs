//! The bands between the contours of a height map.

use geo::{LineString, MultiPolygon, Polygon};
use glam::DVec2;

use super::{BandArea, Ground, bands};
use crate::base::ElevationUnit;
use crate::base::error::Report;
use crate::contour::{ContourLayer, Target};
use crate::dem::derive::square_outlines;
use crate::geometry::common_area;
use crate::raster::Dem;

/// The areas between the contours of a height map, up to the outermost cell centres and to cells without data. `layer` are its
/// lines at the levels of a target, which are in `unit`; `part` is the part of the map that they cover, if it is not the whole.
pub fn bands_of_height_map(
    dem: &Dem,
    layer: &ContourLayer,
    target: &Target,
    unit: ElevationUnit,
    part: Option<&MultiPolygon<f64>>,
) -> Report<Vec<BandArea>> {
    let ring = |ring: &Vec<DVec2>| ring.iter().map(|p| (p.x, p.y)).collect::<LineString<f64>>();
    let polygon = |rings: Vec<Vec<DVec2>>| Polygon::new(ring(&rings[0]), rings[1..].iter().map(ring).collect());
    let whole: MultiPolygon<f64> = square_outlines(dem).into_iter().map(polygon).collect();
    let frame = part.map_or(whole.clone(), |part| common_area(&whole, part));
    let height = |p: DVec2| {
        let place = dem.grid.place(p).round();
        let inside = place.cmpge(DVec2::ZERO).all() && place.x < dem.grid.cols as f64 && place.y < dem.grid.rows as f64;
        let cell = inside.then(|| place.y as usize * dem.grid.cols + place.x as usize)?;
        Some(f64::from(dem.values[cell])).filter(|height| !height.is_nan())
    };
    let ground = Ground { frame: &frame, water: &[], height: &height, crs: dem.crs.as_ref() };
    bands(layer.lines.iter(), target, unit, &ground)
}
