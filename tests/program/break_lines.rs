//! `--breaklines`, `--cliffs`, `--points-sigma`, and what the diagnostics tell of them.

#![allow(clippy::unwrap_used, reason = "helpers of tests are tests too")]

use std::fs;

use rusqlite::Connection;

use crate::common::Folder;
use crate::running::{Running, folder_with, folder_with_part, run};

/// A folder with a part of the sample's contours as `c.gpkg` and the ridge and canyon lines of its surface, which have heights, as
/// `lines.geojson`.
fn folder() -> Folder {
    let folder = folder_with_part("c.gpkg");
    folder.succeeds("skeleton c.gpkg -o lines.geojson");
    folder
}

/// A line or a point in the middle of the sample, in its coordinates.
fn feature(folder: &Folder, name: &str, kind: &str, coordinates: &str, properties: &str) {
    let crs = r#""crs":{"type":"name","properties":{"name":"EPSG:32616"}}"#;
    let text = format!(
        r#"{{"type":"FeatureCollection",{crs},"features":[{{"type":"Feature","properties":{{{properties}}},"geometry":{{"type":"{kind}","coordinates":{coordinates}}}}}]}}"#
    );
    fs::write(folder.path(name), text).unwrap();
}

fn rows(folder: &Folder, file: &str, layer: &str) -> i64 {
    let db = Connection::open(folder.path(file)).unwrap();
    db.query_row(&format!("select count(*) from \"{layer}\""), [], |row| row.get(0)).unwrap()
}

#[test]
fn break_lines_are_used_and_the_diagnostics_hold_them() {
    let folder = folder();
    let text = folder.succeeds("dem c.gpkg --cell 10 --breaklines lines.geojson -o d.tif --diagnostics used.gpkg");
    assert!(text.contains("break lines of an unknown kind") && text.contains("canyon"), "{text}");
    assert!(text.contains("breaklines ") && text.contains("used.gpkg"), "{text}");
    assert!(rows(&folder, "used.gpkg", "breaklines") > 20);
    assert_eq!(rows(&folder, "used.gpkg", "streams"), 0);
    let conflicts = rows(&folder, "used.gpkg", "conflicts");
    let text = folder.succeeds("densify c.gpkg -i 5 --breaklines lines.geojson -o l.gpkg");
    assert!(text.contains("breaklines "), "{text}");
    // The lines come from the surface itself, so few of them contradict the contours.
    assert!(conflicts < 20, "{conflicts}");
}

#[test]
fn check_tells_where_lines_contradict_the_contours() {
    let folder = folder();
    let codes = |command: &str| {
        let output = run(folder.0.path(), command);
        let json: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
        json["codes"].clone()
    };
    assert!(codes("check c.gpkg --json").get("stream-cut").is_none());
    // Ridge lines are no streams: some run upwards across contours somewhere, or beside each other.
    let told = codes("check c.gpkg --json --streams lines.geojson --breaklines lines.geojson");
    let kinds = ["stream-cut", "stream-moved", "stream-turned", "stream-left-out"];
    assert!(kinds.iter().any(|kind| told.get(kind).is_some()), "{told}");
    let wrong = folder.ends("check c.gpkg --streams lines.geojson --stream-tolerance -1", 2);
    assert!(wrong.contains("--stream-tolerance is -1"), "{wrong}");
}

#[test]
fn the_skeleton_tells_which_canyon_lines_are_given() {
    let folder = folder();
    let text = folder.succeeds("skeleton c.gpkg --streams lines.geojson -o s.gpkg");
    assert!(text.contains("streams  "), "{text}");
    let db = Connection::open(folder.path("s.gpkg")).unwrap();
    let count = |what: &str| -> i64 {
        db.query_row(&format!("select count(*) from skeleton where {what}"), [], |row| row.get(0)).unwrap()
    };
    assert!(count("given and kind = 'canyon' and region is null") > 5);
    assert_eq!(count("given and kind = 'ridge'"), 0);
    assert!(count("not given and kind = 'canyon' and region is not null") > 5);
}

#[test]
fn spot_heights_with_a_standard_error_count_as_far_as_it_says() {
    let folder = folder();
    let text = folder.succeeds("dem c.gpkg --cell 20 -o plain.tif");
    assert!(!text.contains("standard error"), "{text}");
    fs::write(folder.path("p.csv"), "x,y,z,sigma\n746500,4019000,687,\n746550,4019000,692,2\n746600,4019000,702,abc\n")
        .unwrap();
    let text = folder.succeeds("dem c.gpkg --cell 20 --points p.csv --points-sigma 1 -o d.tif");
    assert!(text.contains("p.csv: ") && text.contains("which is no standard error"), "{text}");
    assert!(
        text.contains("p.csv: the file does not name its coordinate reference system; it is taken to be in"),
        "{text}"
    );
    assert!(text.contains("2 of them with a standard error"), "{text}");
}

#[test]
fn what_is_wrong_with_lines_is_said() {
    let folder = folder();
    let ends = |command: &str, status: i32, said: &str| {
        let wrong = folder.ends(command, status);
        assert!(wrong.contains(said), "{command}: {wrong}");
        assert!(!folder.path("d.tif").exists(), "{command}");
    };
    feature(&folder, "point.geojson", "Point", "[746500,4019000,1]", "");
    ends("dem c.gpkg --cell 20 --breaklines point.geojson -o d.tif", 1, "no line");
    ends("dem c.gpkg --cell 20 --cliffs point.geojson -o d.tif", 1, "cliffs are lines");
    ends("dem c.gpkg --cell 20 --breaklines none.gpkg -o d.tif", 1, "none.gpkg");
    ends("dem c.gpkg --cell 20 --surface linear --breaklines lines.geojson -o d.tif", 2, "--breaklines has no meaning");
    ends("dem c.gpkg --cell 20 --points-sigma 1 -o d.tif", 2, "--points");
    fs::write(folder.path("p.csv"), "x,y,z\n746500,4019000,687\n").unwrap();
    ends("dem c.gpkg --cell 20 --points p.csv --points-sigma -1 -o d.tif", 2, "--points-sigma is -1");
    let text = folder.succeeds("dem c.gpkg --cell 20 --surface skeleton --cliffs lines.geojson -o e.tif");
    assert!(text.contains("only the smooth surface jumps"), "{text}");
}

#[test]
fn a_surface_that_is_handed_over_has_its_break_lines_and_they_are_read_again() {
    let folder = folder_with("fig3a_spur.geojson", "map.geojson");
    let line = r#"{"type":"FeatureCollection","features":[{"type":"Feature","properties":{},"geometry":
        {"type":"LineString","coordinates":[[13930,-16505],[13970,-16500],[14010,-16498]]}}]}"#;
    std::fs::write(folder.path("edge.geojson"), line).unwrap();
    folder.succeeds("mesh map.geojson --breaklines edge.geojson -o surface.xml");
    let text = std::fs::read_to_string(folder.path("surface.xml")).unwrap();
    let start = text.find("<Breaklines>").unwrap();
    assert!(start < text.find("<Definition").unwrap() && text.contains("brkType=\"standard\""), "{}", &text[..900]);
    // The same lines again, from the file that was handed over. Its heights agree with the contours.
    let said = folder.succeeds("mesh map.geojson --breaklines surface.xml -o again.xml");
    let lines = |name: &str| {
        let text = std::fs::read_to_string(folder.path(name)).unwrap();
        text.matches("<Breakline ").count()
    };
    assert!(lines("surface.xml") >= 1 && lines("again.xml") >= 1, "{said}");
    // Its points as spot heights; it has no contours.
    folder.succeeds("check map.geojson --points surface.xml");
    let said = folder.ends("dem surface.xml --cell 10 -o dem.tif", 1);
    assert!(said.contains("surface.xml") && said.contains("triangle"), "{said}");
}
