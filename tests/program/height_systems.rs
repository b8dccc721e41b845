//! Height systems: mixtures are found, and grids shift height maps from one to another.

#![allow(clippy::unwrap_used, reason = "helpers of tests are tests too")]

use std::fs;

use glam::DVec2;
use serde_json::json;
use tokosen::base::Grid;
use tokosen::crs::Crs;
use tokosen::io::raster::{read_dem, write_dem};
use tokosen::raster::Dem;

use crate::common::Folder;
use crate::guide_pages::{commands, inputs, run};
use crate::running::Running;

/// Rings around a hill in metres, in a system by its name.
fn hill(name: &str, middle: f64, levels: std::ops::Range<i32>) -> String {
    let ring = |level: i32| {
        let half = 300.0 - 2.0 * f64::from(level);
        let corners = [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0), (-1.0, -1.0)];
        let points: Vec<_> = corners.iter().map(|(x, y)| [middle + half * x, 6_650_000.0 + half * y]).collect();
        json!({ "type": "Feature", "properties": { "elev": level }, "geometry": { "type": "LineString", "coordinates": points } })
    };
    let features: Vec<_> = levels.step_by(10).map(ring).collect();
    json!({ "type": "FeatureCollection", "crs": { "type": "name", "properties": { "name": name } }, "features": features })
        .to_string()
}

fn spots(name: &str) -> String {
    let spot = json!({ "type": "Feature", "properties": { "elev": 93 }, "geometry": { "type": "Point", "coordinates": [600_010.0, 6_650_010.0] } });
    json!({ "type": "FeatureCollection", "crs": { "type": "name", "properties": { "name": name } }, "features": [spot] })
        .to_string()
}

/// A height map of 95 m around the hill, with a system of heights in its .prj file.
fn height_map(folder: &Folder, stem: &str, crs: &str) {
    let rows = vec!["95 ".repeat(30); 30].join("\n");
    let text =
        format!("ncols 30\nnrows 30\nxllcorner 599700\nyllcorner 6649700\ncellsize 20\nNODATA_value -9999\n{rows}\n");
    fs::write(folder.path(&format!("{stem}.asc")), text).unwrap();
    fs::write(folder.path(&format!("{stem}.prj")), Crs::from_name(crs).unwrap().wkt.unwrap()).unwrap();
}

#[test]
fn mixtures_are_found_with_their_usual_size_and_its_source() {
    let folder = Folder::new();
    fs::write(folder.path("new.geojson"), hill("EPSG:25832+5941", 600_000.0, 10..100)).unwrap();
    fs::write(folder.path("old.geojson"), hill("EPSG:25832+5776", 601_000.0, 10..100)).unwrap();
    fs::write(folder.path("plain.geojson"), hill("EPSG:25832", 601_000.0, 10..100)).unwrap();
    fs::write(folder.path("spots.geojson"), spots("EPSG:25832+5776")).unwrap();
    height_map(&folder, "old", "EPSG:25832+5776");
    let size = "they differ by -0.15 to +0.35 m (Kartverket";
    for (what, command) in [
        ("two sheets", "densify new.geojson old.geojson -i 5 -o a.gpkg"),
        ("spot heights", "densify new.geojson --points spots.geojson -i 5 -o b.gpkg"),
        ("a base", "dem new.geojson --base old.asc --cell 20 -o c.tif"),
        ("a comparison", "compare new.geojson old.asc"),
    ] {
        let said = folder.succeeds(command);
        assert!(said.contains("different height systems treated as one: 1"), "{what}: {said}");
        assert!(said.contains("NN1954") && said.contains("NN2000") && said.contains(size), "{what}: {said}");
    }
    let said = folder.succeeds("densify new.geojson plain.geojson -i 5 -o d.gpkg");
    assert!(said.contains("plain.geojson names no height system") && said.contains("NN2000"), "{said}");
    let said = folder.succeeds("densify new.geojson -i 5 -o e.gpkg");
    assert!(said.contains("heights    NN2000") && !said.contains("height systems"), "{said}");
    let said = folder.succeeds("densify plain.geojson -i 5 -o f.gpkg");
    assert!(said.contains("heights    the input does not name their system"), "{said}");
}

/// A grid of 12.25 m everywhere around a place.
fn gtx(folder: &Folder, name: &str, [west, south]: [f64; 2]) {
    let mut bytes = Vec::new();
    [south, west, 0.5, 0.5].iter().for_each(|number| bytes.extend(number.to_be_bytes()));
    [5u32, 5].iter().for_each(|count| bytes.extend(count.to_be_bytes()));
    (0..25).for_each(|_| bytes.extend(12.25f32.to_be_bytes()));
    fs::write(folder.path(name), bytes).unwrap();
}

#[test]
fn grids_shift_height_maps_both_ways() {
    let folder = Folder::new();
    let grid = Grid { corner: DVec2::new(500_000.0, 4_000_000.0), cell: DVec2::splat(10.0), cols: 40, rows: 30 };
    let values: Vec<f32> = (0..grid.len()).map(|k| 100.0 + (k % 40) as f32 * 0.25).collect();
    write_dem(&folder.path("dem.tif"), &Dem { grid, values, crs: Some(Crs::from_epsg(32654)) }).unwrap();
    gtx(&folder, "here.gtx", [140.0, 35.0]);
    gtx(&folder, "elsewhere.gtx", [10.0, 35.0]);
    let lines = |options: &str, levels: &str| {
        folder.succeeds(&format!("contour dem.tif --levels {levels} {options} -o out.geojson --overwrite"));
        let text = fs::read_to_string(folder.path("out.geojson")).unwrap();
        let read: serde_json::Value = serde_json::from_str(&text).unwrap();
        let first = &read["features"][0]["geometry"]["coordinates"];
        first.as_array().unwrap().iter().map(|p| (p[0].as_f64().unwrap(), p[1].as_f64().unwrap())).collect::<Vec<_>>()
    };
    let plain = lines("", "104");
    assert_eq!(lines("--vertical-shift here.gtx", "116.25"), plain);
    assert_eq!(lines("--vertical-shift here.gtx --vertical-shift-inverse", "91.75"), plain);
    let said = folder.ends("contour dem.tif -i 5 --vertical-shift elsewhere.gtx -o out.gpkg", 1);
    assert!(said.contains("elsewhere.gtx") && said.contains("does not cover"), "{said}");
    for (command, why) in [
        ("contour dem.tif -i 5 --vertical-shift dem.xyz -o out.gpkg", "grids of shifts are read as .gtx"),
        ("contour dem.tif -i 5 --vertical-shift-inverse -o out.gpkg", "--vertical-shift"),
    ] {
        let said = folder.ends(command, 2);
        assert!(said.contains(why), "{said}");
    }
    fs::write(folder.path("hill.geojson"), hill("EPSG:25832", 600_000.0, 10..100)).unwrap();
    gtx(&folder, "hill.gtx", [9.5, 59.0]);
    folder.succeeds("dem hill.geojson --cell 20 -o plain.tif");
    folder.succeeds("dem hill.geojson --cell 20 --vertical-shift hill.gtx -o shifted.tif");
    let [plain, shifted] = ["plain.tif", "shifted.tif"].map(|name| read_dem(&folder.path(name)).unwrap().value.dem);
    let pairs = plain.values.iter().zip(&shifted.values).filter(|(a, _)| !a.is_nan());
    assert!(pairs.clone().count() > 100);
    assert!(pairs.into_iter().all(|(a, b)| (b - a - 12.25).abs() < 1e-4));
    // A shift of one height map is found by those that compare two.
    folder.succeeds("compare plain.tif shifted.tif --vertical-shift hill.gtx -o difference.tif");
    let difference = read_dem(&folder.path("difference.tif")).unwrap().value.dem.values;
    assert!(difference.iter().filter(|d| !d.is_nan()).count() > 100);
    assert!(difference.iter().all(|d| d.is_nan() || d.abs() < 1e-4));
    let said = folder.succeeds("volume plain.tif shifted.tif --vertical-shift hill.gtx");
    assert!(said.contains("hill.gtx does not name the height system"), "{said}");
    folder.succeeds("derive plain.tif --flood low.tif --flood-level 22");
    folder.succeeds("derive plain.tif --vertical-shift hill.gtx --flood high.tif --flood-level 34.25");
    let [low, high] = ["low.tif", "high.tif"].map(|name| read_dem(&folder.path(name)).unwrap().value.dem.values);
    assert!(low.iter().any(|depth| *depth > 0.0));
    assert!(low.iter().zip(&high).all(|(a, b)| a.is_nan() && b.is_nan() || (a - b).abs() < 1e-4));
    let said = folder.ends("compare hill.geojson hill.geojson --cell 20 --vertical-shift hill.gtx", 2);
    assert!(said.contains("is for height maps"), "{said}");
}

#[test]
fn the_commands_of_the_page_run() {
    let folder = inputs();
    run(&folder, "tokosen dem contours.gpkg --cell 20 -o dem.tif --surface linear");
    gtx(&folder, "shift.gtx", [-85.5, 35.5]);
    let commands = commands(include_str!("../../src/guide/height_systems.md"));
    assert_eq!(commands.len(), 3);
    commands.into_iter().for_each(|command| drop(run(&folder, command)));
}
