//! Numbers below 0 as values of options: depths of a sea bed, coordinates west and south of an origin.

#![allow(clippy::unwrap_used, reason = "helpers of tests are tests too")]

use std::collections::BTreeSet;
use std::fs;

use serde_json::{Value, json};

use crate::common;
use crate::running::Running;

/// These tests.
struct Here;

type Folder = common::Folder<Here>;

/// Square rings around the origin, from -20 m outside to 0 m inside, in steps of 5 m.
fn basin() -> Folder {
    let ring = |k: i32| {
        let half = 1000.0 - 150.0 * f64::from(k);
        let corners = [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0), (-1.0, -1.0)];
        let points: Vec<[f64; 2]> = corners.iter().map(|(i, j)| [half * i, half * j]).collect();
        json!({ "type": "Feature", "properties": { "elev": -20.0 + 5.0 * f64::from(k) },
                "geometry": { "type": "LineString", "coordinates": points } })
    };
    let crs = json!({ "type": "name", "properties": { "name": "urn:ogc:def:crs:EPSG::6677" } });
    let features: Vec<Value> = (0..5).map(ring).collect();
    let folder = Folder::new();
    let file = json!({ "type": "FeatureCollection", "crs": crs, "features": features });
    fs::write(folder.path("a.geojson"), file.to_string()).unwrap();
    folder
}

impl Folder {
    /// The elevations of new contours.
    fn new_levels(&self, name: &str) -> BTreeSet<String> {
        let file: Value = serde_json::from_str(&fs::read_to_string(self.path(name)).unwrap()).unwrap();
        let features = file["features"].as_array().unwrap().iter().map(|feature| &feature["properties"]);
        let new = features.filter(|feature| feature["source"] == json!("interpolated"));
        new.map(|feature| feature["elev"].to_string()).collect()
    }
}

#[test]
fn lists_of_levels_below_zero_are_levels() {
    let folder = basin();
    for (given, expected) in [
        ("--levels -12.5,-7", &["-12.5", "-7.0"][..]),
        ("--levels=-12.5,-7", &["-12.5", "-7.0"]),
        ("--levels -7", &["-7.0"]),
        ("--levels -.5,-17.5", &["-0.5", "-17.5"]),
        ("--levels 1e-1,-1.25e1 --quiet", &["-12.5", "0.1"]),
    ] {
        folder.succeeds(&format!("densify a.geojson {given} -o out.geojson --overwrite"));
        let found = folder.new_levels("out.geojson");
        assert_eq!(found, expected.iter().map(|level| (*level).to_owned()).collect(), "{given}");
    }
}

#[test]
fn other_options_take_them_and_say_what_is_wrong() {
    let folder = basin();
    folder.succeeds("dem a.geojson --cell 50 --extent -500,-400,-100,300.5 -o part.tif");
    folder.succeeds("densify a.geojson -i 1 --base-level -2.5 --sea -20 --coast -20 -o out.gpkg");
    folder.succeeds("mesh a.geojson --base-height -100 -o solid.ply");
    // The names of earlier versions.
    folder.succeeds("densify a.geojson -i 1 --base -2.5 -o by_alias.gpkg");
    folder.succeeds("mesh a.geojson --base -100 -o by_alias.ply");
    for (given, status, words) in [
        ("densify a.geojson -i -5,2 -o out.gpkg", 2, "--interval is -5"),
        ("densify a.geojson -i 5 --index -5 -o out.gpkg", 2, "invalid value '-5' for '--index"),
        ("dem a.geojson --cell -50 -o dem.tif", 2, "--cell"),
        ("dem a.geojson --cell-degrees -0.4s -o dem.tif", 2, "--cell-degrees"),
        ("densify a.geojson -i 1 --coast -3 -o out.gpkg --overwrite", 2, "no contour has the level"),
        // Flags are no values.
        ("densify a.geojson --levels --dem x.tif -o out.gpkg", 2, "a value is required for '--levels"),
        ("densify a.geojson --levels -i 5 -o out.gpkg", 2, "a value is required for '--levels"),
        ("dem a.geojson --extent --cell 5 -o dem.tif", 2, "a value is required for '--extent"),
        ("densify a.geojson --levels -7 -8 -o out.gpkg", 2, "unexpected argument '-8'"),
    ] {
        let (well, said) = folder.run(given);
        assert!(!well && said.contains(words), "{given}: {said}");
        assert!(status == 1 || folder.ends(given, status).contains(words), "{given}");
    }
}

#[test]
fn saved_runs_take_them_too() {
    let folder = basin();
    folder.succeeds("densify a.geojson --levels -12.5,-7 -o out.geojson --save-run run.json");
    fs::remove_file(folder.path("out.geojson")).unwrap();
    folder.succeeds("--run run.json");
    assert_eq!(folder.new_levels("out.geojson").len(), 2);
}
