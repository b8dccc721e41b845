//! Elevations that are none, in another unit, or depths: what every command makes of them.

#![allow(clippy::unwrap_used, reason = "helpers of tests are tests too")]

use std::fs;

use serde_json::{Value, json};

use crate::common;
use crate::running::Running;

/// These tests.
struct Here;

type Folder = common::Folder<Here>;

impl Folder {
    fn put(&self, name: &str, map: &Value) {
        fs::write(self.path(name), map.to_string()).unwrap();
    }

    /// The elevations of written contours, each once and ascending.
    fn levels(&self, name: &str) -> Vec<f64> {
        let text: Value = serde_json::from_slice(&fs::read(self.path(name)).unwrap()).unwrap();
        let features = text["features"].as_array().unwrap().iter();
        let mut levels: Vec<f64> = features.map(|f| f["properties"]["elev"].as_f64().unwrap()).collect();
        levels.sort_by(f64::total_cmp);
        levels.dedup();
        levels
    }
}

fn collection(features: &[Value]) -> Value {
    let crs = json!({"type": "name", "properties": {"name": "urn:ogc:def:crs:EPSG::32633"}});
    json!({"type": "FeatureCollection", "crs": crs, "features": features})
}

fn line(points: Vec<[f64; 2]>, properties: Value) -> Value {
    json!({"type": "Feature", "properties": properties, "geometry": {"type": "LineString", "coordinates": points}})
}

/// Wavy contours of 300 to 480 m.
fn slope() -> Vec<Value> {
    slope_of(10)
}

/// The same with so many contours.
fn slope_of(count: i32) -> Vec<Value> {
    let course = |k: i32| {
        (0..=20).map(move |i| {
            let x = 50.0 * f64::from(i);
            [500_000.0 + x, 5_000_050.0 + 100.0 * f64::from(k) + 15.0 * (x / 110.0).sin()]
        })
    };
    (0..count).map(|k| line(course(k).collect(), json!({"elev": 300 + 20 * k}))).collect()
}

fn frame(elevation: f64) -> Value {
    let (low, high) = (-20.0, 1020.0);
    let corners = [[low, low], [high, low], [high, high], [low, high], [low, low]];
    line(corners.map(|[x, y]| [500_000.0 + x, 5_000_000.0 + y]).to_vec(), json!({"elev": elevation}))
}

/// Rings inside each other.
fn rings(properties: impl Fn(u32) -> Value) -> Value {
    let ring = |k: u32| {
        let at = |i: i32| f64::from(i % 36) * std::f64::consts::TAU / 36.0;
        let radius = 400.0 - 60.0 * f64::from(k);
        (0..=36).map(move |i| [500_000.0 + radius * at(i).cos(), 5_000_000.0 + radius * at(i).sin()]).collect()
    };
    collection(&(0..5).map(|k| line(ring(k), properties(k))).collect::<Vec<Value>>())
}

#[test]
fn every_command_leaves_out_a_frame_without_an_elevation() {
    let folder = Folder::new();
    folder.put("sound.geojson", &collection(&slope()));
    for (name, z) in [("zero", 0.0), ("filler", -9999.0)] {
        folder.put(&format!("{name}.geojson"), &collection(&[slope(), vec![frame(z)]].concat()));
    }
    for command in [
        "dem IN.geojson --cell 20 -o OUT.asc",
        "dem IN.geojson --cell 20 --repair all -o OUT.asc",
        "densify IN.geojson -i 5 -o OUT.geojson",
        "densify IN.geojson -i 5 --repair none -o OUT.geojson",
        "derive IN.geojson --cell 20 --slope OUT.asc",
        "skeleton IN.geojson -o OUT.geojson",
        "regions IN.geojson -o OUT.geojson",
        "mesh IN.geojson -o OUT.ply",
        "check IN.geojson --repair all -o OUT.geojson",
    ] {
        let ending = command.rsplit("OUT").next().unwrap();
        let run = |input: &str| {
            let said = folder.succeeds(&format!("{} --overwrite", command.replace("IN", input).replace("OUT", "out")));
            (said, fs::read(folder.path(&format!("out{ending}"))).unwrap())
        };
        let (said, sound) = run("sound");
        assert!(!said.contains("was left out"), "{command}: {said}");
        for name in ["zero", "filler"] {
            let (said, framed) = run(name);
            assert!(said.contains("was left out"), "{command}: {said}");
            assert!(sound == framed, "{name}: {command}");
        }
    }
}

#[test]
fn the_sea_and_the_coast_keep_contours_at_zero() {
    let folder = Folder::new();
    folder.put("cliff.geojson", &rings(|k| json!({"elev": if k == 0 { 0 } else { 90 + 10 * k }})));
    folder.succeeds("densify cliff.geojson -i 5 -o out.geojson");
    assert_eq!(folder.levels("out.geojson")[0], 100.0);
    for named in ["--sea 0", "--coast 0"] {
        folder.succeeds(&format!("densify cliff.geojson -i 5 {named} -o sea.geojson"));
        assert_eq!(folder.levels("sea.geojson")[0], 0.0, "{named}");
    }
}

#[test]
fn a_unit_beside_the_elevation_is_used_and_told() {
    let folder = Folder::new();
    folder.put("feet.geojson", &rings(|k| json!({"contourelevation": 8000 + 40 * k, "contourunits": 1})));
    let said = folder.succeeds("densify feet.geojson -i 10 -o out.geojson");
    assert!(said.contains("the field \"contourunits\" states feet"), "{said}");
    let levels = folder.levels("out.geojson");
    assert!(levels.contains(&2440.0) && levels.iter().all(|z| (2430.0..2510.0).contains(z)), "{levels:?}");
    let said = folder.succeeds("densify feet.geojson -i 10 --unit m -o out.geojson");
    assert!(said.contains("states feet; the elevations are taken as metres all the same"), "{said}");
    assert!(folder.levels("out.geojson")[0] >= 8000.0);
}

#[test]
fn depths_become_negative_elevations() {
    let folder = Folder::new();
    folder.put("bed.geojson", &rings(|k| json!({"depth_ft": 10 + 10 * k})));
    let said = folder.succeeds("densify bed.geojson -a depth_ft -i 1 -o hill.geojson");
    assert!(said.contains("seems to hold depths"), "{said}");
    assert!(folder.levels("hill.geojson")[0] >= 10.0);
    folder.succeeds("densify bed.geojson -a depth_ft --unit ft --depths -i 1 -o bed2.geojson");
    let levels = folder.levels("bed2.geojson");
    assert!(levels.iter().all(|z| (-19.0..-3.0).contains(z)) && levels.contains(&-4.0), "{levels:?}");
}

#[test]
fn the_line_about_accuracy_counts_findings_of_wrong_elevations() {
    let folder = Folder::new();
    let mut lines = slope_of(40);
    let told = |lines: &[Value], options: &str| {
        folder.put("map.geojson", &collection(lines));
        let text = folder.succeeds(&format!("dem map.geojson --cell 20 --overwrite -o dem.tif {options}"));
        assert!(text.contains("expected error of heights"), "{text}");
        text.contains("more where an elevation is wrong or a contour is missing: 1 finding says so")
    };
    assert!(!told(&lines, ""));
    let elevation = lines[8]["properties"]["elev"].as_f64().unwrap();
    lines[8]["properties"]["elev"] = json!(elevation + 100.0);
    assert!(told(&lines, ""));
    assert!(!told(&lines, "--repair all"));
}
