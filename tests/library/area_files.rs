//! Boundary polygons from files of every format.

#![allow(clippy::unwrap_used, reason = "helpers of tests are tests too")]

use std::fs;
use std::path::{Path, PathBuf};

use geo::{Area, LineString, MultiPolygon, Polygon};
use rusqlite::{Connection, params};
use shapefile::{Point, PolygonRing};
use tempfile::TempDir;
use tokosen::crs::Crs;
use tokosen::io::{ReadOptions, read_area, read_contours};

type Ring = Vec<(f64, f64)>;

/// Two polygons in one feature, the first with a hole; numbers whose decimal form is easily cut short.
fn parts() -> Vec<Vec<Ring>> {
    let (x, y) = (436_265.680_000_000_05, 6_444_375.1 + 0.2);
    let square = |x: f64, y: f64, side: f64| vec![(x, y), (x, y + side), (x + side, y + side), (x + side, y), (x, y)];
    let mut hole = square(x + 10.0 / 3.0, y + 7.0, 20.1);
    hole.reverse();
    vec![vec![square(x, y, 100.0), hole], vec![square(x + 300.0, y, 50.0 / 7.0)]]
}

fn expected() -> MultiPolygon<f64> {
    let polygon = |rings: &Vec<Ring>| {
        let mut rings = rings.iter().map(|ring| LineString::from(ring.clone()));
        Polygon::new(rings.next().unwrap(), rings.collect())
    };
    parts().iter().map(polygon).collect()
}

fn geojson(dir: &TempDir, geometry: &str) -> PathBuf {
    let path = dir.path().join("frame.geojson");
    let crs = r#"{"type":"name","properties":{"name":"urn:ogc:def:crs:EPSG::25832"}}"#;
    let feature = format!(r#"{{"type":"Feature","properties":{{"name":"x"}},"geometry":{geometry}}}"#);
    fs::write(&path, format!(r#"{{"type":"FeatureCollection","crs":{crs},"features":[{feature}]}}"#)).unwrap();
    path
}

fn multi_polygon_json(parts: &[Vec<Ring>]) -> String {
    let coordinates: Vec<Vec<Vec<[f64; 2]>>> =
        parts.iter().map(|p| p.iter().map(|ring| ring.iter().map(|&(x, y)| [x, y]).collect()).collect()).collect();
    format!(r#"{{"coordinates":{},"type":"MultiPolygon"}}"#, serde_json::to_string(&coordinates).unwrap())
}

fn shapefile(dir: &TempDir) -> PathBuf {
    let path = dir.path().join("frame.shp");
    // The hole comes before the ring around it, which programs are free to do.
    let mut rings: Vec<Ring> = parts().into_iter().flatten().collect();
    rings.swap(0, 1);
    let rings = rings.iter().enumerate().map(|(i, ring)| {
        let points = ring.iter().map(|&(x, y)| Point::new(x, y)).collect();
        if i == 0 { PolygonRing::Inner(points) } else { PolygonRing::Outer(points) }
    });
    let shape = shapefile::Polygon::with_rings(rings.collect());
    shapefile::ShapeWriter::from_path(&path).unwrap().write_shapes(&vec![shape]).unwrap();
    fs::write(path.with_extension("prj"), Crs::from_epsg(25832).wkt1().unwrap()).unwrap();
    path
}

fn wkb(parts: &[Vec<Ring>]) -> Vec<u8> {
    let mut blob = b"GP\0\x01\0\0\0\0".to_vec();
    let head = |blob: &mut Vec<u8>, kind: u32, count: usize| {
        blob.push(1);
        blob.extend(kind.to_le_bytes());
        blob.extend((count as u32).to_le_bytes());
    };
    head(&mut blob, 6, parts.len());
    for rings in parts {
        head(&mut blob, 1003, rings.len());
        for ring in rings {
            blob.extend((ring.len() as u32).to_le_bytes());
            for &(x, y) in ring {
                [x, y, 12.5].iter().for_each(|n: &f64| blob.extend(n.to_le_bytes()));
            }
        }
    }
    blob
}

fn geopackage(dir: &TempDir, layers: &[(&str, &str)]) -> PathBuf {
    let path = dir.path().join("frame.gpkg");
    let db = Connection::open(&path).unwrap();
    db.execute_batch(
        "CREATE TABLE gpkg_spatial_ref_sys (srs_name, srs_id, organization, organization_coordsys_id, definition);
         INSERT INTO gpkg_spatial_ref_sys VALUES ('x', 7, 'EPSG', 25832, 'undefined');
         CREATE TABLE gpkg_geometry_columns (table_name, column_name, geometry_type_name, srs_id, z, m);",
    )
    .unwrap();
    for (name, kind) in layers {
        db.execute("INSERT INTO gpkg_geometry_columns VALUES (?1, 'geom', ?2, 7, 0, 0)", params![name, kind]).unwrap();
        db.execute_batch(&format!("CREATE TABLE {name} (fid INTEGER PRIMARY KEY, geom)")).unwrap();
        db.execute(&format!("INSERT INTO {name} VALUES (3, ?1)"), params![wkb(&parts())]).unwrap();
    }
    path
}

fn read(path: &Path) -> tokosen::base::error::Result<(MultiPolygon<f64>, Option<Crs>)> {
    read_area(path, &ReadOptions::default())
}

#[test]
fn every_format_gives_the_same_area() {
    let dir = tempfile::tempdir().unwrap();
    let paths =
        [geojson(&dir, &multi_polygon_json(&parts())), shapefile(&dir), geopackage(&dir, &[("frame", "MULTIPOLYGON")])];
    for path in paths {
        let (area, crs) = read(&path).unwrap();
        assert_eq!(crs.unwrap().epsg, Some(25832), "{}", path.display());
        assert_eq!(area, expected(), "{}", path.display());
        assert!(area.unsigned_area() < 100.0 * 100.0);
    }
}

#[test]
fn polygons_in_collections_and_bare_geometries_are_read() {
    let dir = tempfile::tempdir().unwrap();
    let ring = "[[0,0],[4000,0],[4000,4000,7],[0,0]]";
    let polygon = format!(r#"{{"type":"Polygon","coordinates":[{ring}]}}"#);
    let collection = format!(r#"{{"type":"GeometryCollection","geometries":[{polygon}]}}"#);
    for geometry in [&polygon, &collection] {
        assert_eq!(read(&geojson(&dir, geometry)).unwrap().0.unsigned_area(), 8e6);
    }
    let path = dir.path().join("bare.json");
    fs::write(&path, &polygon).unwrap();
    assert_eq!(read(&path).unwrap().0.0.len(), 1);
}

#[test]
fn coordinates_in_degrees_are_known_as_such() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("degrees.geojson");
    fs::write(&path, r#"{"type":"Polygon","coordinates":[[[7,58],[8,58],[8,59],[7,58]]]}"#).unwrap();
    assert!(read(&path).unwrap().1.unwrap().is_geographic());
}

#[test]
fn files_without_a_polygon_are_refused() {
    let dir = tempfile::tempdir().unwrap();
    let refused = |path: &Path, expected: &str| {
        let message = read(path).unwrap_err().to_string();
        assert!(message.contains(path.to_str().unwrap()) && message.contains(expected), "{message}");
    };
    refused(&geojson(&dir, r#"{"type":"LineString","coordinates":[[1e5,1e5],[2e5,2e5]]}"#), "(found: 1 lines)");
    refused(&geojson(&dir, r#"{"type":"Polygon","coordinates":[]}"#), "(found: 1 no geometry)");
    refused(&geojson(&dir, r#"{"type":"Polygon","coordinates":[[[1e5,1],[2e5,1],[1e5,1]]]}"#), "feature 0: a ring");
    refused(&geojson(&dir, "null"), "there is no polygon");
    refused(&dir.path().join("none.gpkg"), "cannot read");
    refused(&geopackage(&dir, &[("a", "LINESTRING")]), "there is no layer of polygons");
    fs::remove_file(dir.path().join("frame.gpkg")).unwrap();
    refused(&geopackage(&dir, &[("a", "POLYGON"), ("b", "MULTIPOLYGON")]), "several layers of polygons: \"a\", \"b\"");
    let options = ReadOptions { layer: Some("b".into()), ..ReadOptions::default() };
    assert_eq!(read_area(&dir.path().join("frame.gpkg"), &options).unwrap().0, expected());
}

#[test]
fn polygons_among_contours_are_still_left_out() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("map.geojson");
    let line = r#"{"type":"Feature","properties":{"elev":10},"geometry":{"type":"LineString","coordinates":[[1e5,0],[2e5,1]]}}"#;
    let area = format!(r#"{{"type":"Feature","properties":{{}},"geometry":{}}}"#, multi_polygon_json(&parts()));
    fs::write(&path, format!(r#"{{"type":"FeatureCollection","features":[{line},{area}]}}"#)).unwrap();
    let report = read_contours(&path, &ReadOptions::default()).unwrap();
    assert_eq!(report.value.contours.len(), 1);
    assert!(report.findings.iter().any(|f| f.message.contains("1 geometries of type MultiPolygon left out")));
}
