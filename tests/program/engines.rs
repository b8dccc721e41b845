//! `dem --for`: height maps for game engines and 3-D programs.

#![allow(clippy::unwrap_used, reason = "helpers of tests are tests too")]

use std::fs;

use serde_json::Value;

use crate::common::Folder;
use crate::running::{Running, folder_with, folder_with_part};

fn about(folder: &Folder, name: &str) -> Value {
    serde_json::from_slice(&fs::read(folder.path(name)).unwrap()).unwrap()
}

#[test]
fn each_program_gets_its_sizes_and_heights_come_back_by_its_rule() {
    let folder = folder_with("fig1f_nested.geojson", "in.geojson");
    folder.succeeds("dem in.geojson --cell 10 --frame bbox -o plain.asc");
    let said = folder.succeeds("dem in.geojson --for unity --size 65 --frame bbox -o a.raw");
    assert!(said.contains("65 x 65 cells") && said.contains("Terrain Height"), "{said}");
    let (bytes, a) = (fs::read(folder.path("a.raw")).unwrap(), about(&folder, "a.json"));
    assert_eq!(bytes.len(), 2 * 65 * 65);
    let values: Vec<u16> = bytes.chunks(2).map(|b| u16::from_le_bytes([b[0], b[1]])).collect();
    assert_eq!((values.iter().min(), values.iter().max()), (Some(&0), Some(&65535)));
    assert_eq!(a["settings"]["Position Y"], a["lowest_m"]);

    // The same heights in metres, from north to south.
    folder.succeeds("dem in.geojson --for blender --size 65 --frame bbox -o b.exr");
    let b = tokosen::io::raster::read_dem(&folder.path("b.exr")).unwrap().value.dem;
    assert_eq!(b.grid.cols.max(b.grid.rows), 65);

    // Tiles where one is too small.
    let extent = a["spacing_m"].as_f64().unwrap() * 64.0;
    let said = folder
        .succeeds(&format!("dem in.geojson --for unity --size 33 --cell {} --frame bbox -o t.raw", extent / 60.0));
    assert!(said.contains("tiles of 33 x 33 samples"), "{said}");
    let files: Vec<String> =
        about(&folder, "t.json")["files"].as_array().unwrap().iter().map(|f| f.as_str().unwrap().to_owned()).collect();
    assert!(files.len() >= 2 && files.contains(&"t_0_0.raw".to_owned()), "{files:?}");
    for file in &files {
        assert_eq!(fs::metadata(folder.path(file)).unwrap().len(), 2 * 33 * 33, "{file}");
    }
    assert!(!folder.path("t.raw").exists());
}

#[test]
fn a_stac_item_lies_beside_a_cog() {
    let folder = folder_with_part("in.gpkg");
    let part = "--extent 745000,4018000,746000,4019000";
    folder.succeeds(&format!("dem in.gpkg {part} --cell 20 --cog --stac 2016-10-01 -o a.tif"));
    let item = about(&folder, "a.json");
    assert_eq!(item["stac_version"], "1.1.0");
    assert_eq!(item["properties"]["datetime"], "2016-10-01T00:00:00Z");
    assert_eq!(item["assets"]["data"]["href"], "./a.tif");
    // Again over its own files; not over those of others.
    folder.succeeds(&format!("densify in.gpkg {part} -i 10 -o l.gpkg --cell 20 --dem a.tif --cog --stac 2016-10-01"));
    fs::write(folder.path("a.json"), "{}").unwrap();
    let said = folder.ends(&format!("dem in.gpkg {part} --cell 20 --cog --stac 2016-10-01 -o a.tif"), 1);
    assert!(said.contains("a.json") && said.contains("--overwrite"), "{said}");
    assert!(folder.ends("dem in.gpkg --cell 20 --stac 2016-10-01 -o a.tif", 2).contains("--cog"));
    assert!(folder.ends("dem in.gpkg --cell 20 --cog --stac soon -o a.tif", 2).contains("2016-10-01"));
}

#[test]
fn what_does_not_fit_a_program_is_refused_before_the_work() {
    let folder = folder_with("fig1f_nested.geojson", "in.geojson");
    for (line, words) in [
        ("dem in.geojson --for unity --size 1000 -o a.raw", "unity takes 33, 65"),
        ("dem in.geojson --for unity -o a.raw", "needs --size N or --cell SIZE"),
        ("dem in.geojson --for unity --size 65 -o a.png", ".raw"),
        ("dem in.geojson --for unreal --size 127 --cog -o a.png", "--cog does not apply"),
        ("dem in.geojson --for godot --cell 0 -o a.exr", "more than 0"),
        ("dem in.geojson --size 65 --cell 5 -o a.tif", "--for"),
        ("dem in.geojson --for doom --size 65 -o a.raw", "unreal"),
    ] {
        let said = folder.ends(line, 2);
        assert!(said.contains(words), "{line}: {said}");
    }
    assert!(!folder.path("a.raw").exists() && !folder.path("a.json").exists());
}
