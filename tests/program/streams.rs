//! `--streams` and `--diagnostics`.

#![allow(clippy::unwrap_used, reason = "helpers of tests are tests too")]

use std::fs;
use std::path::Path;

use rusqlite::Connection;
use serde_json::Value;
use tokosen::features::Role;
use tokosen::io::raster::read_dem;
use tokosen::io::{ReadOptions, read_features};
use tokosen::streams::StreamLine;

use crate::common::Folder;
use crate::running::{Running, folder_with_part};

/// A folder with a part of the sample as `c.gpkg`, and its canyon lines as `streams.gpkg`, in their layer `skeleton`.
fn folder() -> Folder {
    with_streams(folder_with_part("c.gpkg"))
}

fn with_streams(folder: Folder) -> Folder {
    folder.succeeds("skeleton c.gpkg -o all.gpkg");
    fs::copy(folder.path("all.gpkg"), folder.path("streams.gpkg")).unwrap();
    let db = Connection::open(folder.path("streams.gpkg")).unwrap();
    // The triggers of the spatial index call functions that only its makers have.
    let triggers: Vec<String> = db
        .prepare("select name from sqlite_master where type = 'trigger' and tbl_name = 'skeleton'")
        .unwrap()
        .query_map([], |row| row.get(0))
        .unwrap()
        .map(Result::unwrap)
        .collect();
    for trigger in triggers {
        db.execute_batch(&format!("drop trigger \"{trigger}\"")).unwrap();
    }
    db.execute("delete from skeleton where kind <> 'canyon'", []).unwrap();
    folder
}

/// The streams of a file of diagnostics: their heights, and the column `turned`.
fn used(path: &Path) -> usize {
    streams_of(path).len()
}

fn streams_of(diagnostics: &Path) -> Vec<StreamLine> {
    let options = ReadOptions { layer: Some("streams".into()), ..ReadOptions::default() };
    read_features(Role::Streams, diagnostics, &options).unwrap().value.features.streams
}

/// How much heights rise along the streams of a file of diagnostics, read at the nearest cell, metres.
fn rises(height_map: &Path, diagnostics: &Path) -> f32 {
    let dem = read_dem(height_map).unwrap().value.dem;
    let mut sum = 0.0;
    for stream in &streams_of(diagnostics) {
        let along = stream.points.windows(2).flat_map(|w| (0..4).map(|k| w[0].lerp(w[1], f64::from(k) / 4.0)));
        let read = |p: glam::DVec2| {
            let place = dem.grid.place(p).round();
            let inside = place.min_element() >= 0.0 && place.x < dem.grid.cols as f64 && place.y < dem.grid.rows as f64;
            if inside { dem.values[place.y as usize * dem.grid.cols + place.x as usize] } else { f32::NAN }
        };
        let values: Vec<f32> = along.map(read).filter(|z| !z.is_nan()).collect();
        sum += values.windows(2).map(|w| (w[1] - w[0]).max(0.0)).sum::<f32>();
    }
    sum
}

#[test]
fn a_height_map_falls_along_its_streams_and_the_summary_tells_of_them() {
    let folder = folder();
    let text = folder.succeeds("dem c.gpkg --cell 10 --streams streams.gpkg -o d.tif --diagnostics used.gpkg");
    assert!(text.contains("streams  ") && text.contains("used.gpkg"), "{text}");
    assert!(used(&folder.path("used.gpkg")) > 20, "{text}");
    folder.succeeds("dem c.gpkg --cell 10 -o plain.tif");
    let [with, without] = ["d.tif", "plain.tif"].map(|name| rises(&folder.path(name), &folder.path("used.gpkg")));
    // Cells keep to the heights of the streams and to the bands of contours; no bank and no trench holds the water. So a quarter
    // of the rises is left.
    assert!(without > 10.0 && with < 0.25 * without, "{with} of {without}");
}

#[test]
fn a_height_map_in_another_system_falls_along_its_streams() {
    let folder = folder();
    // The sample is in UTM 16N on WGS 84; the coordinates of NAD83 differ from these by less than a cell.
    let other = "--to-crs EPSG:26916 --cell 10";
    folder.succeeds(&format!("dem c.gpkg {other} --streams streams.gpkg -o d.tif --diagnostics used.gpkg"));
    folder.succeeds(&format!("dem c.gpkg {other} -o plain.tif"));
    let [with, without] = ["d.tif", "plain.tif"].map(|name| rises(&folder.path(name), &folder.path("used.gpkg")));
    assert!(without > 10.0 && with < 0.3 * without, "{with} of {without}");
}

#[test]
fn streams_may_be_several_files_and_are_drawn_in_any_direction() {
    let folder = folder();
    let text = folder.succeeds(
        "densify c.gpkg -i 10 --streams streams.gpkg --streams all.gpkg|layername=skeleton -o l.gpkg --diagnostics u.gpkg",
    );
    // Ridge lines are no streams: they run upwards somewhere or fall beside each other, and nothing breaks.
    assert!(text.contains("streams  "), "{text}");
}

#[test]
fn a_stream_without_a_place_in_the_system_of_the_contours_is_left_out_with_a_finding() {
    let folder = folder();
    // Degrees at the other side of the Earth, in a file that names no system: WGS 84.
    fs::write(
        folder.path("far.geojson"),
        r#"{"type":"Feature","properties":{},"geometry":{"type":"LineString","coordinates":[[5,5],[6,6]]}}"#,
    )
    .unwrap();
    let text = folder.succeeds("dem c.gpkg --cell 20 --streams far.geojson -o d.tif");
    assert!(text.contains("streams outside the frame: 1") && text.contains("is left out"), "{text}");
    folder.succeeds("dem c.gpkg --cell 20 -o plain.tif");
    let [with, without] = ["d.tif", "plain.tif"].map(|name| fs::read(folder.path(name)).unwrap());
    assert!(with == without, "nothing else changes");
}

#[test]
fn findings_about_streams_state_lengths_in_metres() {
    let folder = folder_with_part("c.gpkg");
    let line = r#"{"type":"LineString","coordinates":[[740000,4019100],[750000,4019100]]}"#;
    let crs = r#""crs":{"type":"name","properties":{"name":"EPSG:32616"}}"#;
    let feature = format!(r#"{{"type":"Feature","properties":{{}},"geometry":{line}}}"#);
    let all = format!(r#"{{"type":"FeatureCollection",{crs},"features":[{feature}]}}"#);
    fs::write(folder.path("long.geojson"), all).unwrap();
    for command in ["dem c.gpkg --cell 20 -o d.tif", "check c.gpkg", "skeleton c.gpkg -o s.gpkg"] {
        let text = folder.succeeds(&format!("{command} --streams long.geojson -v"));
        assert!(text.contains(" m of the stream lie outside the frame"), "{command}: {text}");
        assert!(!text.contains("map units"), "{command}: {text}");
    }
}

#[test]
fn what_is_wrong_with_streams_is_said_before_the_work() {
    let folder = folder();
    let wrong = folder.ends("dem c.gpkg --cell 10 --surface linear --streams streams.gpkg -o d.tif", 2);
    assert!(wrong.contains("--streams has no meaning for --surface linear"), "{wrong}");
    let wrong = folder.ends("dem c.gpkg --cell 10 --streams streams.gpkg --stream-tolerance -1 -o d.tif", 2);
    assert!(wrong.contains("--stream-tolerance is -1"), "{wrong}");
    let wrong = folder.ends("dem c.gpkg --cell 10 --streams streams.gpkg -o d.tif --diagnostics u.shp", 2);
    assert!(wrong.contains("diagnostics"), "{wrong}");
    fs::write(
        folder.path("point.geojson"),
        r#"{"type":"Feature","properties":{},"geometry":{"type":"Point","coordinates":[1,2]}}"#,
    )
    .unwrap();
    let wrong = folder.ends("dem c.gpkg --cell 10 --streams point.geojson -o d.tif", 1);
    assert!(wrong.contains("no line") && wrong.contains("point.geojson"), "{wrong}");
    assert!(!folder.path("d.tif").exists());
}

/// A height map in other coordinates is compared with the surface that it was made from: both follow the streams.
#[test]
fn compare_and_dem_have_the_same_heights_along_streams_in_other_coordinates() {
    let folder = folder();
    folder.succeeds("dem c.gpkg --streams streams.gpkg --to-crs EPSG:4326 --cell-degrees 1s -o d.tif");
    folder.succeeds("dem c.gpkg --to-crs EPSG:4326 --cell-degrees 1s -o without.tif");
    let rmse = |command: &str| {
        let told: Value = serde_json::from_str(&folder.succeeds(command)).unwrap();
        told["overall"]["rmse"].as_f64().unwrap()
    };
    assert_eq!(rmse("compare c.gpkg d.tif --streams streams.gpkg --json -q"), 0.0);
    assert!(
        rmse("compare without.tif d.tif --json -q") > 0.01,
        "the streams change nothing, so the test shows nothing"
    );
}
