//! The plane that lines are measured on.

use geo::MultiPolygon;
use glam::DVec2;

use crate::base::Grid;
use crate::contour::{ContourMap, find_interval};
use crate::crs::Crs;
use crate::geometry::{Bounds, rings};
use crate::raster::{Dem, GroundScale};

/// What is known of the ground under the lines of a map.
#[derive(Debug, Clone, PartialEq)]
pub struct Ground {
    /// Length of a map unit in both directions in the middle of the map, metres.
    pub metres: DVec2,
    /// The border of the known ground: rings that repeat their first point, map units. Contours beyond it are not known, so the
    /// spacing on both sides of a line is taken as the same there.
    pub border: Vec<Vec<DVec2>>,
}

/// The mean slope of a height map, as the rise in metres for each metre; 0 without two neighbouring heights.
pub fn mean_slope(dem: &Dem) -> f64 {
    let (cols, cell) = (dem.grid.cols, dem.grid.cell * Ground::of_dem(dem, None).metres);
    let of = |k: usize| {
        let [here, east, south] = [k, k + 1, k + cols].map(|k| dem.values.get(k).copied().unwrap_or(f32::NAN));
        let slope = DVec2::new(f64::from(east - here) / cell.x, f64::from(south - here) / cell.y).length();
        (!(k + 1).is_multiple_of(cols) && slope.is_finite()).then_some(slope)
    };
    let (sum, count) =
        (0..dem.values.len()).filter_map(of).fold((0.0, 0.0), |(sum, count), slope| (sum + slope, count + 1.0));
    if count > 0.0 { sum / count } else { 0.0 }
}

/// The mean slope of the ground between contours, likewise: their interval over their mean spacing.
pub fn slope_between(map: &ContourMap) -> f64 {
    let frame = Bounds::around(&map.contours.iter().flat_map(|c| c.points.iter().copied()).collect::<Vec<_>>());
    let length: f64 = map.contours.iter().flat_map(|c| c.points.windows(2)).map(|pair| pair[0].distance(pair[1])).sum();
    let area = (frame.max - frame.min).element_product();
    let corners = vec![vec![frame.min, frame.max]];
    let metres = Ground::inside(corners, map.crs.as_ref()).metres.max_element();
    find_interval(&map.contours).map_or(0.0, |i| i.step) * length / (area * metres).max(f64::MIN_POSITIVE)
}

impl Ground {
    /// Inside these areas, in a coordinate reference system.
    pub fn within<'a>(areas: impl IntoIterator<Item = &'a MultiPolygon<f64>>, crs: Option<&Crs>) -> Self {
        let points = |ring: &geo::LineString<f64>| ring.coords().map(|c| DVec2::new(c.x, c.y)).collect();
        Self::inside(areas.into_iter().flat_map(rings).map(points).collect(), crs)
    }

    /// Of a height map, or a part of it: inside the outermost centres of its cells.
    pub fn of_dem(dem: &Dem, part: Option<&MultiPolygon<f64>>) -> Self {
        let [min, max] = [dem.grid.center(0, dem.grid.rows - 1), dem.grid.center(dem.grid.cols - 1, 0)];
        let ring = [min, DVec2::new(max.x, min.y), max, DVec2::new(min.x, max.y), min].to_vec();
        let part = Self::within(part, dem.crs.as_ref());
        Self::inside(part.border.into_iter().chain([ring]).collect(), dem.crs.as_ref())
    }

    /// An unknown unit counts as the metre.
    fn inside(border: Vec<Vec<DVec2>>, crs: Option<&Crs>) -> Self {
        let points = || border.iter().flatten();
        let min = points().fold(DVec2::INFINITY, |min, p| min.min(*p));
        let max = points().fold(DVec2::NEG_INFINITY, |max, p| max.max(*p));
        let corner = DVec2::new(min.x, max.y);
        let grid = Grid { corner, cell: (max - min).max(DVec2::splat(f64::MIN_POSITIVE)), cols: 1, rows: 1 };
        Self { metres: GroundScale::on(&grid, crs).row(0), border }
    }
}
