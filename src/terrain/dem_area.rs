//! Areas in the coordinates of a height map: the frame of its ground, the part whose contours are wanted.

use geo::MultiPolygon;

use super::part::box_area;
use tokosen_core::base::error::Result;
use tokosen_core::crs::{Crs, Reprojection};
use tokosen_core::raster::Dem;
#[cfg(feature = "io")]
use tokosen_io::{ReadOptions, VectorSource, read_area};

/// An area in the coordinates of a height map. It is in them already if `crs` is `None`.
///
/// # Errors
/// If its system cannot be converted to that of the height map.
pub fn area_on(dem: &Dem, area: &MultiPolygon<f64>, crs: Option<&Crs>) -> Result<MultiPolygon<f64>> {
    Reprojection::unmoved(dem.crs.clone()).bring(crs)?.boundary(area)
}

/// [`area_on`] for an upright box: least x, least y, greatest x, greatest y.
///
/// # Errors
/// As [`area_on`], and [`Error::Parameter`](crate::Error::Parameter) if the box has no width or no height.
pub fn extent_on(dem: &Dem, extent: [f64; 4], crs: Option<&Crs>) -> Result<MultiPolygon<f64>> {
    area_on(dem, &box_area(extent)?, crs)
}

/// [`area_on`] for the polygons of a file. `memory` is the memory that reading may take, bytes; no limit if `None`.
///
/// # Errors
/// As [`read_area`] and [`area_on`]; the error names the file.
#[cfg(feature = "io")]
pub fn read_area_on(dem: &Dem, source: &VectorSource, memory: Option<u64>) -> Result<MultiPolygon<f64>> {
    let path = &source.path;
    let (area, crs) = read_area(path, &ReadOptions { memory, ..source.reading() })?;
    area_on(dem, &area, crs.as_ref()).map_err(|error| error.in_file(path))
}

#[cfg(test)]
mod tests {
    use geo::{Coord, Rect};
    use glam::DVec2;

    use super::*;
    use tokosen_core::base::Grid;
    use tokosen_core::crs::Transform;

    #[test]
    fn borders_are_as_exact_over_degrees_as_over_metres() {
        let grid = Grid { corner: DVec2::new(139.0, 36.5), cell: DVec2::splat(1e-3), cols: 10, rows: 10 };
        let (degrees, metres) = (Crs::from_epsg(6668), Crs::from_epsg(6677));
        let dem = Dem { grid, values: vec![0.0; 100], crs: Some(degrees.clone()) };
        let given: MultiPolygon<f64> =
            Rect::new(Coord { x: -60_000.0, y: 20_000.0 }, Coord { x: 60_000.0, y: 40_000.0 }).to_polygon().into();
        let area = area_on(&dem, &given, Some(&metres)).unwrap();
        let way = Transform::between(&degrees, &metres).unwrap();
        for line in area.0[0].exterior().lines() {
            let middle = DVec2::new((line.start.x + line.end.x) / 2.0, (line.start.y + line.end.y) / 2.0);
            let p = way.forward(middle).unwrap();
            let off = [p.x.abs() - 60_000.0, p.y - 20_000.0, p.y - 40_000.0].map(f64::abs);
            assert!(off.into_iter().any(|off| off < 0.01), "{p}");
        }
        assert_eq!(extent_on(&dem, [-60_000.0, 20_000.0, 60_000.0, 40_000.0], Some(&metres)).unwrap(), area);
        assert_eq!(area_on(&dem, &given, None).unwrap(), given);
    }
}
