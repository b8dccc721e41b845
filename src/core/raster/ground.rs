//! Length of a map unit on the ground, for slopes and areas on maps in degrees, feet or Web Mercator.

use glam::DVec2;

use super::height_map::Dem;
use crate::base::error::{Error, Result};
use crate::base::{ElevationUnit, Grid};
use crate::crs::{Crs, label};

/// Metres on the ground per map unit, east and north.
#[derive(Debug, Clone, PartialEq)]
pub enum GroundScale {
    /// The same everywhere.
    Uniform(DVec2),
    /// It depends on latitude: one value per row of the height map.
    Rows(Vec<DVec2>),
}

/// The GRS 80 ellipsoid, which JGD2011 uses. That of WGS 84 differs by a tenth of a millimetre.
const SEMI_MAJOR: f64 = 6_378_137.0;
const FLATTENING: f64 = 1.0 / 298.257_222_101;

/// EPSG code of Web Mercator, the coordinate reference system of web maps.
const WEB_MERCATOR: u32 = 3857;

impl GroundScale {
    /// The scale of a height map, from its coordinate reference system. With degrees and with Web Mercator, it depends
    /// on the latitude of each row. With other systems, it depends only on the unit of length. An unknown unit counts
    /// as the metre.
    ///
    /// The scale factor of a projection is not corrected. In the plane rectangular zones and UTM, it is below one part
    /// in a thousand.
    pub fn of(dem: &Dem) -> Self {
        Self::on(&dem.grid, dem.crs.as_ref())
    }

    /// The scale on a grid in some coordinate reference system, as [`GroundScale::of`].
    pub fn on(grid: &Grid, crs: Option<&Crs>) -> Self {
        let rows = |at: fn(f64) -> DVec2| Self::Rows((0..grid.rows).map(|row| at(grid.center(0, row).y)).collect());
        match crs {
            Some(crs) if crs.is_geographic() => rows(per_degree),
            Some(crs) if crs.horizontal().epsg == Some(WEB_MERCATOR) => rows(per_mercator_metre),
            Some(crs) => Self::Uniform(DVec2::splat(crs.length_unit().map_or(1.0, |unit| unit.metres))),
            None => Self::Uniform(DVec2::ONE),
        }
    }

    /// Metres per map unit in a row.
    pub fn row(&self, row: usize) -> DVec2 {
        match self {
            Self::Uniform(scale) => *scale,
            Self::Rows(scales) => scales.get(row).copied().unwrap_or(DVec2::ONE),
        }
    }
}

/// Turns places into those on a plane on which areas are square metres on the ground. For degrees, and for Web Mercator, it is
/// Lambert's cylindrical equal-area projection of the GRS 80 ellipsoid. With other systems, as for [`GroundScale`], only the unit
/// of length counts.
///
/// Source: J. P. Snyder, Map Projections: A Working Manual, USGS Professional Paper 1395 (1987), equations 3-12, 10-14 and 10-15.
pub fn equal_area(crs: Option<&Crs>) -> impl Fn(DVec2) -> DVec2 {
    let is_mercator = crs.is_some_and(|crs| crs.horizontal().epsg == Some(WEB_MERCATOR));
    let angle = crs.and_then(Crs::angle_unit);
    let metres = crs.and_then(Crs::length_unit).map_or(1.0, |unit| unit.metres);
    move |p| {
        let angles = match angle {
            Some(angle) => p * angle,
            None if is_mercator => DVec2::new(p.x / SEMI_MAJOR, (p.y / SEMI_MAJOR).sinh().atan()),
            None => return p * metres,
        };
        let e2 = FLATTENING * (2.0 - FLATTENING);
        let (e, sin) = (e2.sqrt(), angles.y.sin());
        let q = (1.0 - e2) * (sin / (1.0 - e2 * sin * sin) + (e * sin).atanh() / e);
        SEMI_MAJOR * DVec2::new(angles.x, q / 2.0)
    }
}

impl Dem {
    /// The height map with the unit of x and y that the caller names, if one is. A height map with a coordinate reference system
    /// has its unit.
    ///
    /// # Errors
    /// [`Error::Parameter`] if its system states another unit.
    pub fn with_plane_unit(self, unit: Option<ElevationUnit>) -> Result<Self> {
        let crs = in_plane_unit(self.crs, unit)?;
        Ok(Self { crs, ..self })
    }

    /// Metres on the ground per map unit, east and north, in the middle row. `None` if the unit is not known.
    pub fn metres_per_unit(&self) -> Option<DVec2> {
        metres_per_unit(&self.grid, self.crs.as_ref())
    }
}

/// Metres on the ground per map unit, east and north, in the middle row of a grid. `None` if the unit is not known.
pub fn metres_per_unit(grid: &Grid, crs: Option<&Crs>) -> Option<DVec2> {
    let crs = crs?;
    let is_known = crs.is_geographic() || crs.length_unit().is_some();
    is_known.then(|| GroundScale::on(grid, Some(crs)).row(grid.rows / 2))
}

/// The coordinate reference system with the unit of x and y that the caller names, if one is.
///
/// # Errors
/// [`Error::Parameter`] if the system states another unit.
pub fn in_plane_unit(crs: Option<Crs>, unit: Option<ElevationUnit>) -> Result<Option<Crs>> {
    let Some(unit) = unit else { return Ok(crs) };
    if crs.as_ref().is_none_or(|crs| crs.kind().is_none() && crs.length_unit().is_none()) {
        return Ok(Some(Crs::of_plane_in(unit)));
    }
    let own = crs.as_ref().and_then(Crs::length_unit);
    match own.and_then(|own| ElevationUnit::of_size(own.metres)) == Some(unit) {
        true => Ok(crs),
        false => Err(other_unit(unit, crs.as_ref())),
    }
}

/// The error about a unit of x and y that contradicts the coordinate reference system.
pub fn other_unit(unit: ElevationUnit, crs: Option<&Crs>) -> Error {
    let name = crs.map_or_else(String::new, label);
    Error::Parameter(format!(
        "the coordinates cannot be in {}: their coordinate reference system, {name}, states another unit",
        unit.name()
    ))
}

/// Whether a height map without a coordinate reference system can only be in degrees, by its coordinates and cells.
pub fn looks_like_degrees(grid: &Grid, crs: Option<&Crs>) -> bool {
    let far = grid.corner + DVec2::new(grid.cols as f64, -(grid.rows as f64)) * grid.cell;
    let within = |p: DVec2| p.x.abs() <= 360.0 && p.y.abs() <= 90.0;
    crs.is_none() && within(grid.corner) && within(far) && grid.cell.max_element() < 0.1
}

/// Radii at a latitude (radians), metres: of the parallel, and of curvature along the meridian.
fn radii(latitude: f64) -> DVec2 {
    let eccentricity = FLATTENING * (2.0 - FLATTENING);
    let bend = 1.0 - eccentricity * latitude.sin().powi(2);
    let normal = SEMI_MAJOR / bend.sqrt();
    DVec2::new(normal * latitude.cos(), normal * (1.0 - eccentricity) / bend)
}

fn per_degree(latitude: f64) -> DVec2 {
    // At a pole, a row has no width and its slope would be undefined.
    radii(latitude.clamp(-89.999, 89.999).to_radians()) * 1.0_f64.to_radians()
}

fn per_mercator_metre(y: f64) -> DVec2 {
    let latitude = (y / SEMI_MAJOR).sinh().atan();
    let DVec2 { x, y } = radii(latitude);
    DVec2::new(x, y * latitude.cos()) / SEMI_MAJOR
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_degree_is_as_long_as_on_the_ellipsoid() {
        let of = |epsg: Option<u32>, north: f64| {
            let grid = Grid { corner: DVec2::new(138.0, north), cell: DVec2::splat(0.5), cols: 4, rows: 2 };
            Dem { grid, values: vec![], crs: epsg.map(Crs::from_epsg) }.metres_per_unit()
        };
        // The middle of the second row is at 36 degrees: 1' of latitude is 1849.32 m there.
        let degree = of(Some(6668), 36.75).unwrap();
        assert!((degree.y / 60.0 - 1849.3).abs() < 0.2 && (degree.x / 60.0 - 1502.8).abs() < 0.5, "{degree}");
        let equator = of(Some(4326), 0.75).unwrap();
        assert!((equator.x - 111_319.49).abs() < 0.01 && (equator.y - 110_574.28).abs() < 0.02, "{equator}");
        assert_eq!(of(Some(6690), 36.0), Some(DVec2::ONE));
        assert_eq!(of(None, 36.0), None);
    }

    #[test]
    fn degrees_have_their_length_on_the_ellipsoid() {
        // Lengths of a degree from the usual tables: latitude, along the parallel, along the meridian.
        for (latitude, x, y) in [(0.0, 111_319.5, 110_574.3), (45.0, 78_846.8, 111_131.8), (35.0, 91_287.8, 110_940.6)]
        {
            let scale = per_degree(latitude);
            assert!((scale - DVec2::new(x, y)).abs().max_element() < 1.0, "{latitude}: {scale}");
        }
    }

    #[test]
    fn areas_of_degrees_are_those_on_the_ellipsoid() {
        // A cell of a hundredth of a degree has the size of its sides in the middle.
        for (epsg, latitude) in [(6668, 36.0), (4326, -67.5)] {
            let crs = Crs::from_epsg(epsg);
            let place = equal_area(Some(&crs));
            let [a, b] = [-0.005, 0.005].map(|d| place(DVec2::new(138.0 + d, latitude + d)));
            let (area, sides) = ((b - a).element_product(), per_degree(latitude).element_product() * 1e-4);
            assert!((area / sides - 1.0).abs() < 1e-7, "{latitude}: {area} {sides}");
        }
        let mercator = Crs::from_epsg(WEB_MERCATOR);
        let y = SEMI_MAJOR * 36.0_f64.to_radians().tan().asinh();
        let degrees = equal_area(Some(&Crs::wgs84()))(DVec2::new(138.0, 36.0));
        let metres = equal_area(Some(&mercator))(DVec2::new(138.0_f64.to_radians() * SEMI_MAJOR, y));
        assert!(degrees.distance(metres) < 1e-6);
        let feet = equal_area(Some(&Crs::from_epsg(2229)))(DVec2::ONE);
        assert!((feet.x - 0.304_800_6).abs() < 1e-6);
    }

    #[test]
    fn web_mercator_and_degrees_agree_on_the_ground() {
        let latitude = 36.5_f64;
        let y = SEMI_MAJOR * latitude.to_radians().tan().asinh();
        // Degrees per metre of the map at this latitude.
        let degrees = DVec2::new(1.0, latitude.to_radians().cos()) / SEMI_MAJOR * 1.0_f64.to_degrees();
        let difference = per_mercator_metre(y) - per_degree(latitude) * degrees;
        assert!(difference.abs().max_element() < 1e-9, "{difference}");
    }

    #[test]
    fn systems_tell_their_unit() {
        let grid = Grid { corner: DVec2::new(138.0, 36.0), cell: DVec2::splat(0.0001), cols: 3, rows: 2 };
        let dem = |code: Option<u32>| Dem { grid, values: vec![0.0; 6], crs: code.map(Crs::from_epsg) };
        assert_eq!(GroundScale::of(&dem(Some(6677))), GroundScale::Uniform(DVec2::ONE));
        assert_eq!(GroundScale::of(&dem(None)), GroundScale::Uniform(DVec2::ONE));
        assert!((GroundScale::of(&dem(Some(2229))).row(0).x - 0.304_800_6).abs() < 1e-6);
        assert!(matches!(GroundScale::of(&dem(Some(6668))), GroundScale::Rows(rows) if rows.len() == 2));
        assert!(matches!(GroundScale::of(&dem(Some(3857))), GroundScale::Rows(_)));
        assert!(looks_like_degrees(&grid, None) && !looks_like_degrees(&grid, Some(&Crs::from_epsg(6668))));
    }
}
