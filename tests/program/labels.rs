//! Labels of contours in files: on their lines, upright, apart from each other.

#![allow(clippy::unwrap_used, reason = "helpers of tests are tests too")]

use std::path::Path;

use glam::DVec2;
use rusqlite::Connection;
use tokosen::io::{ReadOptions, read_contours};

use crate::common::Course;
use crate::running::{Running, folder_with_part};

/// A label: text, elevation, angle, height, place.
type Row = (String, f64, f64, f64, DVec2);

/// The labels of a layer of a GeoPackage.
fn labels(path: &Path, layer: &str) -> Vec<Row> {
    let db = Connection::open(path).unwrap();
    let mut rows = db.prepare(&format!("SELECT text, elev, angle, height, geom FROM {layer}")).unwrap();
    let place = |blob: Vec<u8>| {
        // The coordinates of a point are the last 16 bytes, or 24 with a height.
        let wkb = blob.len() - 16;
        let number = |at: usize| f64::from_le_bytes(blob[at..at + 8].try_into().unwrap());
        DVec2::new(number(wkb), number(wkb + 8))
    };
    let found = rows.query_map([], |row| {
        Ok((row.get(0)?, row.get(1)?, row.get(2)?, row.get(3)?, place(row.get::<_, Vec<u8>>(4)?)))
    });
    found.unwrap().map(Result::unwrap).collect()
}

#[test]
fn labels_lie_on_index_contours() {
    let folder = folder_with_part("in.gpkg");
    folder.succeeds("densify in.gpkg -i 10 --labels=60 -o out.gpkg");
    let rows = labels(&folder.path("out.gpkg"), "labels");
    assert!(rows.len() > 20, "{}", rows.len());
    let options = ReadOptions { layer: Some("contours_10m".into()), ..ReadOptions::default() };
    let map = read_contours(&folder.path("out.gpkg"), &options).unwrap().value;
    for (text, elevation, angle, height, place) in &rows {
        assert_eq!(text.parse::<f64>().unwrap(), *elevation);
        assert_eq!(elevation % 50.0, 0.0, "{elevation} is no index level");
        assert!(*angle > -90.0 && *angle <= 90.0);
        assert!((height - 60.0).abs() < 1e-6);
        let own = map.contours.iter().filter(|line| line.elevation == *elevation);
        let off = Course::of(own.map(|line| &line.points[..])).distance(*place);
        assert!(off < 1e-6, "{off}");
    }
    for (k, a) in rows.iter().enumerate() {
        for b in &rows[k + 1..] {
            assert!(a.4.distance(b.4) > 60.0, "{a:?} and {b:?}");
        }
    }
}

#[test]
fn several_intervals_have_labels_of_their_own() {
    let folder = folder_with_part("in.gpkg");
    folder.succeeds("densify in.gpkg -i 10,5 --labels -o out.gpkg");
    for layer in ["labels_10m", "labels_5m"] {
        assert!(!labels(&folder.path("out.gpkg"), layer).is_empty());
    }
}

#[test]
fn labels_turn_with_the_coordinates_of_the_output() {
    let folder = folder_with_part("in.gpkg");
    folder.succeeds("densify in.gpkg -i 10 --labels=60 -o plane.gpkg");
    folder.succeeds("densify in.gpkg -i 10 --labels=60 -o degrees.gpkg --to-crs EPSG:4326");
    let [plane, degrees] = ["plane.gpkg", "degrees.gpkg"].map(|name| labels(&folder.path(name), "labels"));
    assert!(plane.len() > 20, "{}", plane.len());
    assert_eq!(plane.len(), degrees.len());
    for (a, b) in plane.iter().zip(&degrees).filter(|(a, _)| a.2.abs() < 80.0) {
        // A degree of longitude is shorter than one of latitude, by the cosine of 36.3 degrees.
        let squeezed = (a.2.to_radians().tan() * 36.3_f64.to_radians().cos()).atan().to_degrees();
        assert!((squeezed - b.2).abs() < 4.0, "{} became {}", a.2, b.2);
        assert!(b.3 < 0.001);
    }
}

#[test]
fn a_drawing_has_texts_in_the_file_of_its_lines() {
    let folder = folder_with_part("in.gpkg");
    folder.succeeds("densify in.gpkg -i 10 --labels=60 -o out.dxf");
    let drawing = std::fs::read_to_string(folder.path("out.dxf")).unwrap();
    let texts = drawing.matches("\nTEXT\n").count();
    assert!(texts > 20 && drawing.contains("CONTOUR-LABEL"), "{texts}");
    assert!(!folder.path("out_labels.dxf").exists());
    // Lines are read again, and texts do no harm.
    let map = read_contours(&folder.path("out.dxf"), &ReadOptions::default()).unwrap().value;
    assert!(map.contours.len() > 100);
    for wrong in
        ["-o out.shp", "-o out.geojson", "-o out.gpkg --index 0", "-o out.gpkg --labels=0", "-o out.gpkg --labels=1e-9"]
    {
        let flag = if wrong.contains("--labels") { "" } else { "--labels" };
        let told = folder.ends(&format!("densify in.gpkg -i 10 {flag} {wrong} --overwrite"), 2);
        assert!(told.contains("labels"), "{told}");
        assert!(!wrong.contains("--labels") || told.contains("--labels"), "{told}");
    }
}
