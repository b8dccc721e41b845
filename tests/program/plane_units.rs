//! Drawings without a coordinate reference system whose x and y are in feet: the work is done in metres, and everything comes
//! back in feet.

#![allow(clippy::unwrap_used, reason = "helpers of tests are tests too")]

use std::collections::BTreeSet;
use std::fs;
use std::path::Path;

use serde_json::{Value, json};
use tokosen::crs::Crs;
use tokosen::io::raster::read_dem;
use tokosen::io::{ReadOptions, read_contours};

use crate::common;
use crate::running::{Running, run};

/// These tests.
struct Here;

type Folder = common::Folder<Here>;

/// Distance between neighbouring contours and between their levels: a plane that rises by 2.228 degrees.
const APART: f64 = 257.0;
const STEP: f64 = 10.0;
const SLOPE: f64 = 2.2283;
/// The first vertex, with decimals that no conversion keeps.
const PLACE: [f64; 2] = [2_000_000.1, 600_000.7];

/// Ten contours of the plane, from south to north.
fn lines() -> Vec<(f64, Vec<[f64; 2]>)> {
    let line = |k: i32| {
        let x = PLACE[0] + APART * f64::from(k);
        let points = (0..=10).map(|j| [x, PLACE[1] + 200.3 * f64::from(j)]).collect();
        (STEP * f64::from(k + 1), points)
    };
    (0..10).map(line).collect()
}

/// The plane as a drawing, with this code of the unit in the header.
fn drawing(unit: Option<u8>) -> String {
    let mut text = String::from("0\nSECTION\n2\nHEADER\n9\n$ACADVER\n1\nAC1015\n");
    if let Some(unit) = unit {
        text += &format!("9\n$INSUNITS\n70\n{unit}\n");
    }
    text += "0\nENDSEC\n0\nSECTION\n2\nENTITIES\n";
    for (z, points) in lines() {
        text += &format!("0\nLWPOLYLINE\n8\nC\n90\n{}\n70\n0\n38\n{z}\n", points.len());
        points.iter().for_each(|[x, y]| text += &format!("10\n{x}\n20\n{y}\n"));
    }
    text + "0\nENDSEC\n0\nEOF\n"
}

/// The plane as GeoJSON; `system` is the text of its coordinate reference system.
fn geojson(system: Option<&str>) -> String {
    let feature = |(z, points): (f64, Vec<[f64; 2]>)| json!({ "type": "Feature", "properties": { "elev": z }, "geometry": { "type": "LineString", "coordinates": points } });
    let features: Vec<Value> = lines().into_iter().map(feature).collect();
    let crs = system.map_or(Value::Null, |name| json!({ "type": "name", "properties": { "name": name } }));
    json!({ "type": "FeatureCollection", "crs": crs, "features": features }).to_string()
}

impl Folder {
    fn with(name: &str, content: &str) -> Self {
        let folder = Self::new();
        folder.put(name, content);
        folder
    }

    fn put(&self, name: &str, content: &str) {
        fs::write(self.path(name), content).unwrap();
    }

    fn text(&self, name: &str) -> String {
        String::from_utf8_lossy(&fs::read(self.path(name)).unwrap()).into_owned()
    }

    /// The values of a raster, in order.
    fn sorted(&self, name: &str) -> Vec<f64> {
        let dem = read_dem(&self.path(name)).unwrap().value.dem;
        let mut values: Vec<f64> = dem.values.iter().filter(|v| v.is_finite()).map(|v| f64::from(*v)).collect();
        values.sort_by(f64::total_cmp);
        assert!(!values.is_empty(), "{name} has no value");
        values
    }

    /// The least and the greatest value of a raster.
    fn range(&self, name: &str) -> (f64, f64) {
        let values = self.sorted(name);
        (values[0], values[values.len() - 1])
    }

    /// Refuses slopes other than that of the plane, also at its border.
    fn has_the_slope(&self, name: &str, what: &str) {
        let slopes = self.sorted(name);
        let (lo, middle, hi) = (slopes[0], slopes[slopes.len() / 2], slopes[slopes.len() - 1]);
        assert!((middle - SLOPE).abs() < 0.003, "{what}: {middle} degrees");
        assert!(lo > 0.99 * SLOPE && hi < 1.01 * SLOPE, "{what}: slopes from {lo} to {hi} degrees");
    }

    /// The coordinates of all contours of a file, bit for bit, and metres per unit of its system.
    fn vertices(&self, name: &str) -> (BTreeSet<[u64; 2]>, Option<f64>) {
        let map = read_contours(&self.path(name), &ReadOptions::default()).unwrap().value;
        let points = map.contours.iter().flat_map(|line| &line.points);
        let unit = map.crs.and_then(|crs| crs.length_unit()).or(map.plane_unit).map(|unit| unit.metres);
        (points.map(|p| p.to_array().map(f64::to_bits)).collect(), unit)
    }
}

#[test]
fn the_slope_is_that_of_the_ground_whoever_states_the_unit() {
    let site = "LOCAL_CS[\"site\",UNIT[\"foot\",0.3048]]";
    let site_in_wkt_2 = "ENGCRS[\"site\",EDATUM[\"site\"],CS[Cartesian,2],AXIS[\"x\",east],AXIS[\"y\",north],\
                         LENGTHUNIT[\"foot\",0.3048]]";
    let cases = [
        ("a.dxf", drawing(Some(2)), "--unit ft"),
        ("a.dxf", drawing(Some(21)), "--unit us-ft"),
        ("a.dxf", drawing(None), "--unit ft --plane-unit ft"),
        ("a.dxf", drawing(Some(0)), "--unit us-ft --plane-unit us-ft"),
        // The header is wrong, and the user knows better.
        ("a.dxf", drawing(Some(4)), "--unit ft --plane-unit ft"),
        ("a.dxf", drawing(Some(2)), "--unit m --plane-unit m"),
        ("a.geojson", geojson(None), "--unit us-ft --plane-unit us-ft"),
        ("a.geojson", geojson(Some(site)), "--unit ft"),
        ("a.geojson", geojson(Some(site_in_wkt_2)), "--unit ft"),
        // Metres, as ever.
        ("a.dxf", drawing(Some(6)), "--unit m"),
    ];
    for (name, content, options) in &cases {
        let folder = Folder::with(name, content);
        folder.succeeds(&format!("derive {name} {options} --cell 50 --slope slope.asc"));
        folder.has_the_slope("slope.asc", &format!("{name} {options}"));
    }
    assert_eq!(cases.len(), 10);
    // The same in two steps: the height map states its unit.
    let (name, content, options) = &cases[0];
    let folder = Folder::with(name, content);
    for dem in ["dem.tif", "dem.asc", "dem.exr", "dem.png"] {
        let said = folder.succeeds(&format!("dem {name} {options} --cell 50 -o {dem}"));
        let is_dropped = ["dem.exr", "dem.png"].contains(&dem);
        assert_eq!(said.contains("upper left corner ") && said.contains("height in metres = "), is_dropped, "{said}");
        folder.succeeds(&format!("derive {dem} --slope again.asc --overwrite"));
        folder.has_the_slope("again.asc", dem);
    }
}

#[test]
fn lines_come_back_bit_for_bit_in_the_unit_of_the_drawing() {
    let folder = Folder::with("a.dxf", &drawing(Some(2)));
    let given: BTreeSet<[u64; 2]> =
        lines().into_iter().flat_map(|(_, points)| points).map(|p| p.map(f64::to_bits)).collect();
    for file in ["out.dxf", "out.gpkg", "out.geojson", "out.shp", "out.fgb"] {
        let said = folder.succeeds(&format!("densify a.dxf --unit ft --to-unit ft -i 5 -o {file}"));
        assert!(said.contains("x, y and heights in feet"), "{said}");
        let (found, unit) = folder.vertices(file);
        assert!(found.is_superset(&given) && found.len() > given.len(), "{file}");
        assert_eq!(unit, Some(0.3048), "{file}");
    }
    assert!(folder.text("out.dxf").contains("$INSUNITS\n 70\n2\n  9\n$MEASUREMENT\n 70\n0\n"));
    // What follows reads the unit.
    for file in ["out.dxf", "out.gpkg", "out.shp"] {
        folder.succeeds(&format!("derive {file} --unit ft --cell 50 --slope slope.asc --overwrite"));
        folder.has_the_slope("slope.asc", file);
    }
    let said = folder.succeeds("densify a.dxf --unit ft -i 2 -o metres.dxf");
    assert!(said.contains("x and y in feet, but heights in metres"), "{said}");
    assert!(said.contains("unknown; the unit of x and y is the foot; the work is done in metres"), "{said}");
    // A drawing in a system has the unit of that.
    for (system, code) in [("EPSG:2222", 2), ("EPSG:2229", 21), ("EPSG:26912", 6)] {
        folder.succeeds(&format!("densify a.dxf --crs {system} --unit ft -i 5 -o crs.dxf"));
        assert!(folder.text("crs.dxf").contains(&format!("$INSUNITS\n 70\n{code}\n")), "{system}");
    }
    for (unit, code) in [(None, 6), (Some(0), 6), (Some(6), 6), (Some(21), 21)] {
        folder.put("b.dxf", &drawing(unit));
        folder.succeeds("densify b.dxf -i 5 -o b_out.dxf --unit m");
        assert!(folder.text("b_out.dxf").contains(&format!("$INSUNITS\n 70\n{code}\n")), "{unit:?}");
    }
}

#[test]
fn cells_and_models_are_in_feet() {
    let folder = Folder::with("a.dxf", &drawing(Some(21)));
    let said = folder.succeeds("dem a.dxf --unit us-ft --to-unit us-ft --cell 50 -o dem.tif");
    assert!(said.contains("x, y and heights in US survey feet"), "{said}");
    let dem = read_dem(&folder.path("dem.tif")).unwrap().value.dem;
    assert_eq!(dem.grid.cell.to_array(), [50.0; 2]);
    assert!((dem.grid.corner.x - PLACE[0]).abs() <= 50.0, "{:?}", dem.grid);
    assert_eq!(dem.grid.corner.x % 50.0, 0.0, "cells lie on multiples of their size");
    // Values in memory are metres.
    let (lo, hi) = folder.range("dem.tif");
    assert!((3.0..3.9).contains(&lo) && (29.5..30.5).contains(&hi), "{lo} {hi}");

    for file in ["a.ply", "a.obj"] {
        let said = folder.succeeds(&format!("mesh a.dxf --unit us-ft -o {file}"));
        assert!(said.contains("2313.00 x 2003.00, heights 10.00 to 100.00 US survey feet"), "{said}");
        assert!(said.contains("east = x + ") && said.contains("in the US survey foot"), "{said}");
    }
    let text = folder.text("a.obj");
    assert!(text.contains("\n# unit US survey foot\n"), "{}", &text[..200]);
    let numbers = |line: &str| -> Vec<f64> { line.split(' ').filter_map(|word| word.parse().ok()).collect() };
    let offset = numbers(text.lines().find(|line| line.starts_with("# offset")).unwrap());
    let found: Vec<Vec<f64>> = text.lines().filter(|line| line.starts_with("v ")).map(numbers).collect();
    for (z, points) in lines() {
        for [x, y] in points {
            let is_it = |v: &Vec<f64>| {
                (v[0] + offset[0] - x).abs() < 1e-6 && (v[1] + offset[1] - y).abs() < 1e-6 && (v[2] - z).abs() < 1e-6
            };
            assert!(found.iter().any(is_it), "{x} {y} {z}");
        }
    }
    // The format prescribes metres.
    let said = folder.succeeds("mesh a.dxf --unit us-ft -o a.glb");
    assert!(said.contains("north = ") && said.contains(" - z, height = y + 0, in the metre"), "{said}");
}

#[test]
fn without_a_unit_of_x_and_y_slopes_and_models_are_refused() {
    for (name, content) in [("a.dxf", drawing(None)), ("a.dxf", drawing(Some(0))), ("a.geojson", geojson(None))] {
        let folder = Folder::with(name, &content);
        for verb in ["mesh {} --unit ft -o a.ply", "derive {} --unit us-ft --cell 50 --slope slope.tif"] {
            let said = folder.ends(&verb.replace("{}", name), 1);
            assert!(said.contains("nothing states the unit of x and y") && said.contains("--plane-unit ft"), "{said}");
            assert!(!folder.path("a.ply").exists() && !folder.path("slope.tif").exists());
        }
        let said = folder.succeeds(&format!("densify {name} --unit ft -i 1 -o out.gpkg"));
        assert!(said.contains("which are taken as metres") && said.contains("--plane-unit"), "{said}");
        let (well, said) = folder.run(&format!("densify {name} --unit ft -i 1 -o out.gpkg --strict"));
        assert!(!well && said.contains("--strict"), "{said}");
        // Heights in metres leave no doubt: metres all over, as ever.
        let said = folder.succeeds(&format!("mesh {name} -o metres.ply"));
        assert!(!said.contains("plane-unit"), "{said}");
    }
    // The other way round: x and y in feet, and nothing states the unit of heights.
    for (name, content, options) in [
        ("a.dxf", drawing(Some(2)), ""),
        ("a.dxf", drawing(None), "--plane-unit ft"),
        ("a.geojson", geojson(None), "--plane-unit us-ft"),
    ] {
        let folder = Folder::with(name, &content);
        let said = folder.succeeds(&format!("densify {name} {options} -i 5 -o out.gpkg"));
        assert!(said.contains("the elevations are taken as metres") && said.contains("--unit ft"), "{options}: {said}");
    }
    // A height map with heights in feet that names no system.
    let folder =
        Folder::with("a.asc", "ncols 3\nnrows 3\nxllcorner 1000\nyllcorner 0\ncellsize 50\n1 2 3\n1 2 3\n1 2 3\n");
    let unit = "<PAMDataset><PAMRasterBand band=\"1\"><UnitType>ft</UnitType></PAMRasterBand></PAMDataset>";
    folder.put("a.asc.aux.xml", unit);
    let said = folder.ends("derive a.asc --slope slope.tif", 1);
    assert!(said.contains("nothing states the unit of x and y"), "{said}");
    folder.succeeds("derive a.asc --plane-unit ft --slope slope.tif");
    let (lo, hi) = folder.range("slope.tif");
    let right = (1.0f64 / 50.0).atan().to_degrees();
    assert!((lo - right).abs() < 1e-3 && (hi - right).abs() < 1e-3, "{lo} {hi}");
}

#[test]
fn units_in_which_no_map_is_drawn_are_refused() {
    let cases = [
        (1, "inch"),
        (3, "mile"),
        (4, "millimetre"),
        (5, "centimetre"),
        (7, "kilometre"),
        (10, "yard"),
        (14, "decimetre"),
    ];
    for (code, name) in cases {
        let folder = Folder::with("a.dxf", &drawing(Some(code)));
        for verb in ["densify a.dxf -i 5 -o out.gpkg", "check a.dxf", "dem a.dxf --cell 50 -o dem.tif"] {
            let said = folder.ends(verb, 1);
            assert!(said.contains(&format!("its unit is the {name} ")) && said.contains("--plane-unit m"), "{said}");
        }
        folder.succeeds("densify a.dxf --plane-unit m -i 5 -o out.gpkg");
        folder.succeeds("densify a.dxf --crs EPSG:6677 -i 5 -o crs.gpkg");
    }
    let folder = Folder::with("a.geojson", &geojson(Some("urn:ogc:def:crs:EPSG::2222")));
    let said = folder.ends("densify a.geojson --plane-unit m -i 5 -o out.gpkg", 2);
    assert!(said.contains("cannot be in metres") && said.contains("EPSG:2222"), "{said}");
    folder.succeeds("densify a.geojson --plane-unit ft --unit ft -i 5 -o out.gpkg");
    let said = folder.ends("derive a.geojson --plane-unit us-ft --cell 5 --slope slope.tif", 2);
    assert!(said.contains("cannot be in US survey feet"), "{said}");
}

#[test]
fn files_beside_a_drawing_are_in_its_plane() {
    let folder = Folder::with("a.dxf", &drawing(Some(2)));
    let [x, y] = PLACE;
    // Offsets from the first vertex, in feet.
    let extent = format!("{},{},{},{}", x + 400.0, y + 400.0, x + 1400.0, y + 1400.0);
    folder.succeeds(&format!("dem a.dxf --unit ft --cell 50 --extent {extent} -o part.tif"));
    let said = folder.ends("dem a.dxf --unit ft --cell 50 --extent 0,0,100,100 -o none.tif", 1);
    assert!(said.contains("(x 0.0 to 100.0, y 0.0 to 100.0)") && said.contains("2000000.1"), "{said}");
    let grid = read_dem(&folder.path("part.tif")).unwrap().value.dem.grid;
    assert!((20..=21).contains(&grid.cols) && (20..=21).contains(&grid.rows), "{grid:?}");
    let ring =
        json!([[x + 400.0, y + 400.0], [x + 1400.0, y + 400.0], [x + 1400.0, y + 1400.0], [x + 400.0, y + 400.0]]);
    let area = |crs: Value| {
        let geometry = json!({ "type": "Polygon", "coordinates": [ring] });
        json!({ "type": "FeatureCollection", "crs": crs,
                "features": [{ "type": "Feature", "properties": {}, "geometry": geometry }] })
        .to_string()
    };
    folder.put("area.geojson", &area(Value::Null));
    folder.succeeds("dem a.dxf --unit ft --cell 50 --frame area.geojson -o framed.tif");
    let framed = read_dem(&folder.path("framed.tif")).unwrap().value.dem;
    assert!((framed.grid.corner.x - x - 400.0).abs() <= 50.0, "{:?}", framed.grid);
    // A system in the same unit is that of the drawing, which names none.
    let name = json!({ "type": "name", "properties": { "name": "urn:ogc:def:crs:EPSG::2222" } });
    folder.put("area_crs.geojson", &area(name));
    folder.succeeds("dem a.dxf --unit ft --cell 50 --frame area_crs.geojson -o framed_crs.tif");
    assert_eq!(read_dem(&folder.path("framed_crs.tif")).unwrap().value.dem.grid, framed.grid);

    folder.put("spots.csv", &format!("x,y,z\n{},{},25.5\n", x + 400.0, y + 700.0));
    let said = folder.succeeds("densify a.dxf --unit ft -i 5 --points spots.csv -o out.gpkg --strict");
    assert!(said.contains("spots      1"), "{said}");

    // A height map is a base, a grid to copy and a side of a comparison, with its system and without.
    folder.succeeds("dem a.dxf --unit ft --cell 50 -o dem.asc");
    for prj in ["with", "without"] {
        folder.succeeds("dem a.dxf --unit ft --like dem.asc -o like.tif --overwrite");
        let (like, dem) = (read_dem(&folder.path("like.tif")).unwrap(), read_dem(&folder.path("dem.asc")).unwrap());
        assert_eq!(like.value.dem.grid, dem.value.dem.grid, "{prj}");
        assert_eq!(like.value.dem.crs.and_then(|crs| crs.length_unit()).map(|unit| unit.metres), Some(0.3048));
        let output = run(folder.0.path(), "compare dem.asc a.dxf --unit ft --json");
        let found: Value = serde_json::from_slice(&output.stdout).unwrap();
        let rmse = found["overall"]["rmse"].as_f64().unwrap();
        assert!(rmse < 0.02 && found["overall"]["cells"].as_u64().unwrap() > 1000, "{prj}: {}", found["overall"]);
        folder.succeeds(&format!(
            "dem a.dxf --unit ft --base dem.asc --cell 50 --extent {extent} -o joined.tif --overwrite"
        ));
        folder.succeeds("contour dem.asc -i 2 -o contours.dxf --overwrite");
        if prj == "with" {
            assert!(folder.text("contours.dxf").contains("$INSUNITS\n 70\n2\n"));
            folder.remove("dem.prj");
            folder.remove("dem.asc.aux.xml");
        }
    }
}

impl Folder {
    fn remove(&self, name: &str) {
        let path = self.path(name);
        if Path::new(&path).exists() {
            fs::remove_file(path).unwrap();
        }
    }
}

#[test]
fn sheets_of_one_map_may_have_different_units() {
    let folder = Folder::with("feet.dxf", &drawing(Some(2)));
    let metres = Crs::of_plane_in(tokosen::base::ElevationUnit::Metre);
    assert!(metres.is_unnamed_plane());
    // The northern half of the same plane, in metres.
    let mut north = String::from("0\nSECTION\n2\nHEADER\n9\n$INSUNITS\n70\n6\n0\nENDSEC\n0\nSECTION\n2\nENTITIES\n");
    for (z, points) in lines() {
        north += &format!("0\nLWPOLYLINE\n8\nC\n90\n{}\n70\n0\n38\n{z}\n", points.len());
        for [x, y] in points {
            north += &format!("10\n{}\n20\n{}\n", x * 0.3048, (y + 2003.0) * 0.3048);
        }
    }
    folder.put("metres.dxf", &(north + "0\nENDSEC\n0\nEOF\n"));
    let cases = [("feet.dxf metres.dxf", 50.0, 0.3048, 4006.0), ("metres.dxf feet.dxf", 15.0, 1.0, 4006.0 * 0.3048)];
    for (files, cell, unit, height) in cases {
        let said = folder.succeeds(&format!("dem {files} --unit ft --cell {cell} -o dem.tif --overwrite"));
        assert!(said.contains("were turned into the unit of the others"), "{said}");
        let dem = read_dem(&folder.path("dem.tif")).unwrap().value.dem;
        assert_eq!(dem.crs.and_then(|crs| crs.length_unit()).map_or(1.0, |unit| unit.metres), unit);
        let found = dem.grid.rows as f64 * dem.grid.cell.y;
        assert!((found - height).abs() < 110.0, "{files}: {found}");
    }
    folder.put("inches.dxf", &drawing(Some(1)));
    let said = folder.ends("dem feet.dxf inches.dxf --unit ft --cell 50 -o dem.tif", 1);
    assert!(said.contains("inches.dxf") && said.contains("the inch"), "{said}");
}
