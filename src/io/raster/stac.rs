//! The item of a SpatioTemporal Asset Catalog (STAC) that describes a height map.
//!
//! STAC 1.1.0 with the projection extension 2.0.0: footprint and box in longitude and latitude, size and placement of the cells,
//! lowest and highest value.

use std::io::Write;
use std::path::Path;

use glam::DVec2;
use serde_json::{Value, json};
use tokosen_core::base::ElevationUnit;
use tokosen_core::base::error::{Error, Result};
use tokosen_core::crs::{Crs, Transform};
use tokosen_core::raster::Dem;

use super::output::{create, geo_transform};
use crate::maker::MADE_BY;

/// Points on each side of the footprint: sides of a map are curved in degrees.
const ON_SIDE: usize = 8;

/// Writes the item of a Cloud Optimized GeoTIFF to `path`. The file is named without a folder: it lies beside the item. `date` is that of
/// the ground, such as `2016-10-01`, and `unit` that of the heights.
///
/// # Errors
/// [`Error::UnknownCrs`] if the height map names no system. A corner has no place in longitude and latitude. The operating system reports
/// an error.
pub fn write_stac_item(path: &Path, dem: &Dem, name: &str, (date, unit): (&str, ElevationUnit)) -> Result<()> {
    let crs = dem.crs.as_ref().filter(|crs| !crs.is_local());
    let crs = crs.ok_or_else(|| Error::file(path, "a STAC item needs a CRS: name that of the contours with --crs"))?;
    let way = Transform::between(crs, &Crs::wgs84())?;
    let ring = outline(dem).into_iter().map(|p| way.forward(p)).collect::<Option<Vec<DVec2>>>();
    let ring =
        ring.ok_or_else(|| Error::file(path, "a side of the height map has no place in longitude and latitude"))?;
    let (lo, hi) = ring.iter().fold((DVec2::INFINITY, DVec2::NEG_INFINITY), |(lo, hi), p| (lo.min(*p), hi.max(*p)));
    let ring: Vec<[f64; 2]> = ring.iter().map(|p| p.to_array()).collect();
    let [x, width, _, y, _, height] = geo_transform(&dem.grid);
    let heights = dem.values.iter().filter(|z| z.is_finite()).map(|z| f64::from(*z));
    let range = heights
        .fold(None, |range: Option<[f64; 2]>, z| Some(range.map_or([z, z], |[low, high]| [low.min(z), high.max(z)])));
    let statistics =
        range.map(|range| range.map(|z| unit.about(z))).map(|[low, high]| json!({ "minimum": low, "maximum": high }));
    let mut properties = json!({
        "description": MADE_BY,
        "datetime": format!("{date}T00:00:00Z"),
        "proj:shape": [dem.grid.rows, dem.grid.cols],
        "proj:transform": [width, 0.0, x, 0.0, height, y],
    });
    let (key, system) = match crs.horizontal().epsg {
        Some(code) => ("proj:code", json!(format!("EPSG:{code}"))),
        None => ("proj:wkt2", json!(crs.header_wkt())),
    };
    properties[key] = system;
    let mut band = json!({ "name": "height", "data_type": "float32", "nodata": -9999, "unit": unit.symbol() });
    if let Some(statistics) = statistics {
        band["statistics"] = statistics;
    }
    let item: Value = json!({
        "type": "Feature",
        "stac_version": "1.1.0",
        "stac_extensions": ["https://stac-extensions.github.io/projection/v2.0.0/schema.json"],
        "id": Path::new(name).file_stem().and_then(|stem| stem.to_str()).unwrap_or(name),
        "geometry": { "type": "Polygon", "coordinates": [ring] },
        "bbox": [lo.x, lo.y, hi.x, hi.y],
        "properties": properties,
        "links": [],
        "assets": {
            "data": {
                "href": format!("./{name}"),
                "type": "image/tiff; application=geotiff; profile=cloud-optimized",
                "roles": ["data"],
                "bands": [band],
            }
        },
    });
    create(path, |out| Ok(writeln!(out, "{item:#}")?))
}

/// The border of the cells, counterclockwise, closed.
fn outline(dem: &Dem) -> Vec<DVec2> {
    let size = dem.grid.cell * DVec2::new(dem.grid.cols as f64, dem.grid.rows as f64);
    let (west, north) = (dem.grid.corner.x, dem.grid.corner.y);
    let [a, b] = [DVec2::new(west, north - size.y), DVec2::new(west + size.x, north - size.y)];
    let [c, d] = [DVec2::new(west + size.x, north), DVec2::new(west, north)];
    let side = |from: DVec2, to: DVec2| (0..ON_SIDE).map(move |k| from.lerp(to, k as f64 / ON_SIDE as f64));
    [(a, b), (b, c), (c, d), (d, a)].into_iter().flat_map(|(from, to)| side(from, to)).chain([a]).collect()
}

#[cfg(test)]
mod tests {
    use tokosen_core::base::Grid;

    use super::*;

    #[test]
    fn the_item_says_where_the_cells_are() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.json");
        let grid = Grid { corner: DVec2::new(500_000.0, 4_000_000.0), cell: DVec2::splat(10.0), cols: 3, rows: 2 };
        let crs = Some(Crs::from_epsg(32616));
        let dem = Dem { grid, values: vec![1.0, 2.0, f32::NAN, 4.0, 5.0, 6.5], crs };
        write_stac_item(&path, &dem, "a.tif", ("2016-10-01", ElevationUnit::Metre)).unwrap();
        let item: Value = serde_json::from_slice(&std::fs::read(&path).unwrap()).unwrap();
        assert_eq!(item["properties"]["proj:code"], "EPSG:32616");
        assert_eq!(item["properties"]["proj:shape"], json!([2, 3]));
        assert_eq!(item["properties"]["proj:transform"], json!([10.0, 0.0, 500_000.0, 0.0, -10.0, 4_000_000.0]));
        let bbox: Vec<f64> = item["bbox"].as_array().unwrap().iter().map(|v| v.as_f64().unwrap()).collect();
        // The central meridian of the zone is 87 degrees west.
        assert!((bbox[0] + 87.0).abs() < 1e-6 && bbox[2] > bbox[0] && bbox[3] > bbox[1], "{bbox:?}");
        let ring = item["geometry"]["coordinates"][0].as_array().unwrap();
        assert_eq!(ring.first(), ring.last());
        let statistics = &item["assets"]["data"]["bands"][0]["statistics"];
        assert_eq!((&statistics["minimum"], &statistics["maximum"]), (&json!(1.0), &json!(6.5)));
        let nowhere = Dem { crs: None, ..dem };
        assert!(write_stac_item(&path, &nowhere, "a.tif", ("2016-10-01", ElevationUnit::Metre)).is_err());
    }
}
