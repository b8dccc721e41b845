//! Small inputs that once took time and memory out of all proportion.

#![allow(clippy::unwrap_used, reason = "helpers of tests are tests too")]

use std::fs;
use std::path::Path;
use std::process::Command;

use serde_json::json;
use tempfile::TempDir;

use crate::running::{run, said};

/// A folder with lines of these elevations in map.geojson.
fn folder(lines: &[(f64, Vec<[f64; 2]>)]) -> TempDir {
    let dir = tempfile::tempdir().unwrap();
    let feature = |(elevation, line): &(f64, Vec<[f64; 2]>)| {
        json!({
            "type": "Feature",
            "properties": { "elev": elevation },
            "geometry": { "type": "LineString", "coordinates": line }
        })
    };
    let features: Vec<_> = lines.iter().map(feature).collect();
    let crs = json!({ "type": "name", "properties": { "name": "urn:ogc:def:crs:EPSG::6677" } });
    let map = json!({ "type": "FeatureCollection", "crs": crs, "features": features });
    fs::write(dir.path().join("map.geojson"), map.to_string()).unwrap();
    dir
}

/// A ring of forty vertices around the origin.
fn ring(radius: f64) -> Vec<[f64; 2]> {
    let angles = (0..=40).map(|k| std::f64::consts::TAU * f64::from(k % 40) / 40.0);
    angles.map(|t| [radius * t.cos(), radius * t.sin()]).collect()
}

/// A hill of eight rings with a radius of at most 100 m.
fn hill() -> TempDir {
    folder(&(0..8).map(f64::from).map(|k| (10.0 * k, ring(100.0 - 10.0 * k))).collect::<Vec<_>>())
}

#[test]
fn cells_larger_than_the_map_are_an_error_and_those_as_large_as_it_need_few_nodes() {
    let dir = hill();
    for line in ["dem map.geojson --cell 1e5 -o a.tif", "densify map.geojson -i 5 -o a.gpkg --dem a.tif --cell 1e9"] {
        let output = run(dir.path(), line);
        assert_eq!(output.status.code(), Some(2), "{line}: {}", said(&output));
        assert!(said(&output).contains("no centre of a cell lies on the map, which is 200 x 200"), "{}", said(&output));
    }
    let output = run(dir.path(), "dem map.geojson --cell-degrees 1 -o a.tif");
    assert!(said(&output).contains("--cell-degrees 1 is too large"), "{}", said(&output));
    assert_eq!(fs::read_dir(dir.path()).unwrap().count(), 1, "no file is left");
}

#[test]
fn a_strip_of_long_straight_lines_has_no_more_nodes_than_its_vertices_need() {
    let line = |k: i32| (f64::from(10 * k), vec![[0.0, 0.2 * f64::from(k)], [1e6, 0.2 * f64::from(k)]]);
    let dir = folder(&(0..6).map(line).collect::<Vec<_>>());
    // 4 million nodes take 500 MB. The limit is for the address space, which is larger than the memory that is used.
    let program = assert_cmd::cargo::cargo_bin!("tokosen");
    let line = format!("ulimit -v 2500000; exec {} dem map.geojson --cell 1 -o a.asc --threads 2", program.display());
    let output = Command::new("sh").current_dir(dir.path()).args(["-c", &line]).output().unwrap();
    assert!(output.status.success(), "{}", said(&output));
}

/// A GeoPackage with a layer that is a view of rows without end: with a geometry each, or with none.
fn endless(path: &Path, geometry: &str, condition: &str) {
    let db = rusqlite::Connection::open(path).unwrap();
    db.execute_batch(&format!(
        "CREATE TABLE gpkg_spatial_ref_sys (srs_name TEXT, srs_id INTEGER, organization TEXT,
            organization_coordsys_id INTEGER, definition TEXT);
         CREATE TABLE gpkg_contents (table_name TEXT, data_type TEXT, identifier TEXT, srs_id INTEGER);
         CREATE TABLE gpkg_geometry_columns (table_name TEXT, column_name TEXT, geometry_type_name TEXT, srs_id INTEGER,
            z TINYINT, m TINYINT);
         INSERT INTO gpkg_geometry_columns VALUES ('lines', 'geom', 'LINESTRING', -1, 0, 0);
         CREATE VIEW lines AS WITH RECURSIVE n(k) AS (SELECT 1 UNION ALL SELECT k + 1 FROM n)
            SELECT k AS fid, {geometry} AS geom, k AS elev FROM n WHERE {condition};"
    ))
    .unwrap();
}

#[test]
fn a_view_without_end_is_told() {
    let dir = tempfile::tempdir().unwrap();
    endless(&dir.path().join("silent.gpkg"), "NULL", "k < 0");
    let output = run(dir.path(), "check silent.gpkg");
    assert_eq!(output.status.code(), Some(1));
    assert!(said(&output).contains("does not come to an end"), "{}", said(&output));
    // A line from 0 0 to 1 1.
    let line = "x'47500001FFFFFFFF01020000000200000000000000000000000000000000000000000000000000F03F000000000000F03F'";
    endless(&dir.path().join("full.gpkg"), line, "1");
    let program = assert_cmd::cargo::cargo_bin!("tokosen");
    let line = format!("ulimit -v 500000; exec {} check full.gpkg --threads 2", program.display());
    let output = Command::new("sh").current_dir(dir.path()).args(["-c", &line]).output().unwrap();
    assert_eq!(output.status.code(), Some(1), "{}", said(&output));
    assert!(said(&output).contains("of memory"), "{}", said(&output));
}

#[test]
fn a_map_that_does_not_fit_is_refused_before_the_work_and_leaves_no_folder() {
    let dir = tempfile::tempdir().unwrap();
    let sample = Path::new(env!("CARGO_MANIFEST_DIR")).join("samples/caryville_20m.gpkg");
    fs::copy(sample, dir.path().join("map.gpkg")).unwrap();
    let program = assert_cmd::cargo::cargo_bin!("tokosen");
    for line in ["densify map.gpkg -i 1 -o a.gpkg", "dem map.gpkg --cell 1 -o a.tif", "regions map.gpkg -o a.gpkg"] {
        // The program itself and the arenas of its threads take most of this.
        let line = format!("ulimit -v 240000; exec {} {line} --threads 1", program.display());
        let output = Command::new("sh").current_dir(dir.path()).args(["-c", &line]).output().unwrap();
        assert_eq!(output.status.code(), Some(1), "{}", said(&output));
        assert!(said(&output).contains("GB are available"), "{}", said(&output));
        assert_eq!(fs::read_dir(dir.path()).unwrap().count(), 1, "no folder is left");
    }
}

#[test]
fn many_rings_close_together_have_no_more_nodes_and_vertices_than_they_need() {
    let rings: Vec<_> = (0..400).map(f64::from).map(|k| (k, ring(9.0 - 0.01 * k))).collect();
    let dir = folder(&rings);
    let program = assert_cmd::cargo::cargo_bin!("tokosen");
    let line =
        format!("ulimit -v 1500000; exec {} densify map.geojson -i 0.5 -o a.geojson --threads 2", program.display());
    let output = Command::new("sh").current_dir(dir.path()).args(["-c", &line]).output().unwrap();
    assert!(output.status.success(), "{}", said(&output));
    let bytes = fs::metadata(dir.path().join("a.geojson")).unwrap().len();
    assert!(bytes < 10_000_000, "{bytes} bytes; the input's lines are half of the new ones");
}
