//! `tokosen profile` and `tokosen volume` as users meet them: closed forms, sums made beside the program, contours and height maps.

#![allow(clippy::unwrap_used, reason = "helpers of tests are tests too")]

use std::f64::consts::PI;
use std::fs;

use glam::DVec2;
use tokosen::base::Grid;
use tokosen::crs::Crs;
use tokosen::io::raster::write_dem;
use tokosen::raster::Dem;

use crate::common;
use crate::guide_pages::{commands, inputs, run};
use crate::running::{Running, folder_with_part};

/// These tests.
struct Here;

type Folder = common::Folder<Here>;

/// Wrong usage.
const USAGE: i32 = 2;
/// The middle of the maps.
const MIDDLE: DVec2 = DVec2::new(1000.0, 2000.0);

/// Heights of a function of the way from the middle, on 200 x 200 cells of 2 m.
fn dem(height: impl Fn(DVec2) -> f64) -> Dem {
    let corner = MIDDLE + DVec2::new(-200.0, 200.0);
    let grid = Grid { corner, cell: DVec2::splat(2.0), cols: 200, rows: 200 };
    let value = |i: usize| height(grid.center(i % 200, i / 200) - MIDDLE) as f32;
    Dem { grid, values: (0..grid.len()).map(value).collect(), crs: Some(Crs::from_epsg(6677)) }
}

fn geojson(kind: &str, coordinates: &str) -> String {
    format!(
        r#"{{"type":"FeatureCollection","crs":{{"type":"name","properties":{{"name":"EPSG:6677"}}}},
        "features":[{{"type":"Feature","properties":{{}},"geometry":{{"type":"{kind}","coordinates":{coordinates}}}}}]}}"#
    )
}

impl Folder {
    fn put(&self, name: &str, dem: &Dem) {
        write_dem(&self.path(name), dem).unwrap();
    }

    /// The columns of a table, by their names.
    fn table(&self, name: &str) -> Vec<Vec<(String, f64)>> {
        let text = fs::read_to_string(self.path(name)).unwrap();
        let mut lines = text.lines();
        let names: Vec<&str> = lines.next().unwrap().split(',').collect();
        let value = |text: &str| text.parse().unwrap_or(f64::NAN);
        lines
            .map(|line| names.iter().map(|name| (*name).to_owned()).zip(line.split(',').map(value)).collect())
            .collect()
    }
}

fn of(row: &[(String, f64)], name: &str) -> f64 {
    row.iter().find(|(own, _)| own == name).map(|(_, value)| *value).unwrap()
}

fn near(found: f64, wanted: f64, share: f64) {
    assert!((found - wanted).abs() <= share * wanted.abs(), "{found} is not {wanted}");
}

#[test]
fn volumes_of_a_cone_are_those_of_the_formula() {
    let folder = Folder::new();
    folder.put("cone.tif", &dem(|p| 150.0 - 0.5 * p.length()));
    let said = folder.succeeds("volume cone.tif --levels 100:130:10 --sigma 0.2 -o cone.csv -o cone.svg -o cone.png");
    assert!(said.contains("level 100 m: cut") && said.contains("net ± at most 32000 m³"), "{said}");
    let rows = folder.table("cone.csv");
    assert_eq!(rows.len(), 4);
    for row in &rows {
        let radius = (150.0 - of(row, "level_m")) * 2.0;
        near(of(row, "cut_m3"), PI * radius * radius * radius * 0.5 / 3.0, 0.005);
        // The area is a number of whole cells.
        near(of(row, "cut_area_m2"), PI * radius * radius, 0.01);
        near(of(row, "cut_area_m2") + of(row, "fill_area_m2"), 160_000.0, 1e-9);
        assert_eq!(of(row, "net_error_most_m3"), 32_000.0);
    }
    assert!(fs::read_to_string(folder.path("cone.svg")).unwrap().contains("Storage curve"));
    // Feet: the same volume, and levels in feet.
    folder.succeeds("volume cone.tif --level 400 --to-unit ft -o feet.csv");
    let radius = (150.0 - 400.0 * 0.3048) * 2.0;
    let cubic_feet = PI * radius * radius * radius * 0.5 / 3.0 / 0.3048_f64.powi(3);
    near(of(&folder.table("feet.csv")[0], "cut_ft3"), cubic_feet, 0.005);
}

#[test]
fn cut_and_fill_between_two_maps_are_the_sum_over_their_cells() {
    let folder = Folder::new();
    let before = dem(|p| 100.0 + 4.0 * (p.x / 40.0).sin() + 3.0 * (p.y / 60.0).cos());
    let after = dem(|p| if p.length() < 90.0 { 101.0 } else { 100.0 + 0.01 * p.y });
    folder.put("before.tif", &before);
    folder.put("after.tif", &after);
    fs::write(
        folder.path("site.geojson"),
        geojson("Polygon", "[[[900,1900],[1120,1900],[1120,2060],[900,2060],[900,1900]]]"),
    )
    .unwrap();
    folder.succeeds("volume before.tif after.tif --clip site.geojson -o sum.csv");
    let (mut cut, mut fill) = (0.0, 0.0);
    for (i, (a, b)) in before.values.iter().zip(&after.values).enumerate() {
        let p = before.grid.center(i % 200, i / 200);
        let difference = f64::from(*a) - f64::from(*b);
        if p.x > 900.0 && p.x < 1120.0 && p.y > 1900.0 && p.y < 2060.0 {
            cut += 4.0 * difference.max(0.0);
            fill += 4.0 * (-difference).max(0.0);
        }
    }
    let row = &folder.table("sum.csv")[0];
    near(of(row, "cut_m3"), cut, 0.001);
    near(of(row, "fill_m3"), fill, 0.001);
    near(of(row, "net_m3"), cut - fill, 0.001);
    assert_eq!(of(row, "cut_area_m2") + of(row, "fill_area_m2"), 220.0 * 160.0);
    assert!(of(row, "net_error_most_m3").is_nan());
}

#[test]
fn a_profile_follows_the_ground() {
    let folder = Folder::new();
    folder.put("slope.tif", &dem(|p| 100.0 + 0.1 * p.x - 0.05 * p.y));
    fs::write(folder.path("line.geojson"), geojson("LineString", "[[900,2000],[1000,2000],[1000,1900]]")).unwrap();
    let said =
        folder.succeeds("profile slope.tif --line line.geojson --step 30 --sigma 0.5 -o p.csv -o p.svg -o p.png");
    assert!(said.contains("9 places on 1 lines; 9 of them with a height"), "{said}");
    let rows = folder.table("p.csv");
    let distances: Vec<f64> = rows.iter().map(|row| of(row, "distance_m")).collect();
    assert_eq!(distances, [0.0, 30.0, 60.0, 90.0, 100.0, 120.0, 150.0, 180.0, 200.0]);
    for row in &rows {
        let p = DVec2::new(of(row, "x"), of(row, "y")) - MIDDLE;
        assert!((of(row, "z_m") - (100.0 + 0.1 * p.x - 0.05 * p.y)).abs() < 0.002, "{row:?}");
        assert_eq!(of(row, "error_m"), 0.5);
    }
    folder.succeeds("profile slope.tif --line line.geojson --sections 50 --width 20 --step 5 -o s.csv");
    let sections = folder.table("s.csv");
    assert_eq!(sections.len(), 4 * 5);
    // On the second part of the line, which runs to the south, the left is the east.
    let left = sections.iter().find(|row| of(row, "section_m") == 150.0 && of(row, "distance_m") == -10.0).unwrap();
    assert_eq!([of(left, "x"), of(left, "y")], [1010.0, 1950.0]);
    let svg = fs::read_to_string(folder.path("p.svg")).unwrap();
    assert!(svg.contains("slope.tif") && svg.contains("standard error"), "{svg}");
}

#[test]
fn contours_have_errors_of_their_own() {
    let folder = folder_with_part("in.gpkg");
    let road = "[[745200,4017700],[748300,4020300]]";
    fs::write(folder.path("line.geojson"), geojson("LineString", road).replace("6677", "32616")).unwrap();
    folder.succeeds("profile in.gpkg --line line.geojson --step 30 -o p.csv");
    let text = fs::read_to_string(folder.path("p.csv")).unwrap();
    let errors: Vec<f64> = text.lines().skip(1).map(|line| line.rsplit(',').next().unwrap().parse().unwrap()).collect();
    assert!(errors.len() > 100 && errors.iter().all(|error| (0.0..10.0).contains(error)), "{errors:?}");
    assert!(errors.iter().any(|error| *error > 0.5));
    let said = folder.succeeds("volume in.gpkg --cell 20 --level 500");
    assert!(said.contains("errors: cut ± ") && said.contains(", at most "), "{said}");
}

#[test]
fn what_is_missing_is_said() {
    let folder = Folder::new();
    folder.put("slope.tif", &dem(|p| 100.0 + 0.1 * p.x));
    fs::write(folder.path("far.geojson"), geojson("LineString", "[[0,0],[10,10]]")).unwrap();
    fs::write(folder.path("point.geojson"), geojson("Point", "[1000,2000]")).unwrap();
    fs::write(folder.path("place.geojson"), geojson("LineString", "[[1000,2000],[1000,2000]]")).unwrap();
    fs::write(folder.path("here.geojson"), geojson("LineString", "[[950,2000],[1050,2000]]")).unwrap();
    let mut elsewhere = dem(|p| p.y);
    elsewhere.grid.corner.x += 5000.0;
    folder.put("elsewhere.tif", &elsewhere);
    for (command, status, words) in [
        ("volume slope.tif", USAGE, "give a level with --level Z"),
        ("volume slope.tif --level 3 -o v.svg", USAGE, "give --levels LOW:HIGH:STEP"),
        ("volume slope.tif --level 3 --cell 5", USAGE, "leave out --cell"),
        ("volume slope.tif --level 3 --unit ft", USAGE, "--unit applies to contours"),
        ("volume slope.tif --levels 3:1:1 -o v.csv", USAGE, "must not be below the lowest"),
        ("volume slope.tif --level 3 --sigma -1", USAGE, "--sigma is -1"),
        ("profile slope.tif --line far.geojson -o p.csv", 1, "no line lies where there are heights"),
        ("profile slope.tif --line point.geojson -o p.csv", 1, "there is no line in it"),
        ("profile slope.tif --line place.geojson -o p.csv", 1, "no line in it has a length (feature 0)"),
        (
            "profile slope.tif elsewhere.tif --line here.geojson -o p.csv",
            1,
            "elsewhere.tif: no line lies where there are heights",
        ),
        ("profile slope.tif --line far.geojson -o p.pdf", USAGE, ".csv, .svg, .png"),
        ("profile slope.tif --line far.geojson --sections 3 -o p.csv", USAGE, "--width"),
        ("profile slope.tif --line far.geojson --step 0 -o p.csv", USAGE, "--step is 0"),
    ] {
        let output = crate::running::run(&folder.path("."), command);
        let said = crate::running::said(&output);
        assert_eq!(output.status.code(), Some(status), "{command}: {said}");
        assert!(said.contains(words), "{command}: {said}");
    }
    let lines = "[[[950,2000],[1050,2000]],[[0,0],[10,10]]]";
    fs::write(folder.path("two.geojson"), geojson("MultiLineString", lines)).unwrap();
    let said = folder.succeeds("profile slope.tif --line two.geojson -o p.csv");
    assert!(said.contains("no height along all of a line or section: feature 0"), "{said}");
}

#[test]
fn the_commands_of_the_page_run() {
    let folder = inputs();
    let commands = commands(include_str!("../../src/guide/profiles_volumes.md"));
    assert!(commands.len() >= 6, "{commands:?}");
    commands.iter().for_each(|command| drop(run(&folder, command)));
}
