//! Catchments above outlets, streams as lines, and floods, as users of `tokosen derive` meet them.

#![allow(clippy::unwrap_used, reason = "helpers of tests are tests too")]

use std::fs;
use std::path::Path;

use glam::DVec2;
use serde_json::{Value, json};
use tokosen::base::Grid;
use tokosen::crs::Crs;
use tokosen::io::raster::{read_dem, write_dem};
use tokosen::raster::Dem;

use crate::common;
use crate::running::Running;

/// These tests.
struct Here;

type Folder = common::Folder<Here>;

/// A valley of 41 x 31 cells of 10 m: it falls to the west along row 15 by 0.1 m per cell; its sides rise by 1 m per cell.
fn valley() -> Dem {
    let grid = Grid { corner: DVec2::new(5000.0, 7310.0), cell: DVec2::splat(10.0), cols: 41, rows: 31 };
    let height = |i: usize| 50.0 + 0.1 * (i % 41) as f32 + (i / 41).abs_diff(15) as f32;
    Dem { grid, values: (0..grid.len()).map(height).collect(), crs: Some(Crs::from_epsg(6677)) }
}

impl Folder {
    /// A folder with the valley, `dem.tif`.
    fn with_valley() -> Self {
        let folder = Self::new();
        write_dem(&folder.path("dem.tif"), &valley()).unwrap();
        folder
    }

    fn features(&self, name: &str) -> Vec<Value> {
        let found: Value = serde_json::from_slice(&fs::read(self.path(name)).unwrap()).unwrap();
        found["features"].as_array().unwrap().clone()
    }

    fn raster(&self, name: &str) -> Vec<f32> {
        read_dem(&self.path(name)).unwrap().value.dem.values
    }
}

fn number(feature: &Value, name: &str) -> f64 {
    feature["properties"][name].as_f64().unwrap()
}

#[test]
fn accumulation_is_in_cells_or_square_metres() {
    let folder = Folder::with_valley();
    folder.succeeds("derive dem.tif --flow-accumulation cells.tif");
    folder.succeeds("derive dem.tif --flow-accumulation m2.tif --accumulation-unit m2");
    let (cells, areas) = (folder.raster("cells.tif"), folder.raster("m2.tif"));
    assert_eq!(cells[15 * 41], 41.0 * 31.0);
    // Read as heights, values above 100 km would be no data.
    let small = cells.iter().zip(&areas).filter(|(cells, _)| **cells < 900.0);
    assert!(small.clone().count() > 1200 && small.clone().all(|(cells, area)| cells * 100.0 == *area));
    let text = fs::read(folder.path("m2.tif")).unwrap();
    assert!(String::from_utf8_lossy(&text).contains("upstream area"));
}

#[test]
fn the_catchment_above_a_place_is_that_of_the_stream_beside_it() {
    let folder = Folder::with_valley();
    // Two cells beside the stream, in column 20.
    let text = folder.succeeds("derive dem.tif --outlet 5205,7135 --catchments c.geojson");
    assert!(text.contains("moved by") && text.contains("at most 30.0 m"), "{text}");
    assert!(text.contains("reaches the edge"), "{text}");
    let features = folder.features("c.geojson");
    assert_eq!(features.len(), 1);
    // It moves as far downstream as it may: to column 18 in row 15.
    let [x, y] = ["outlet_x", "outlet_y"].map(|name| number(&features[0], name));
    assert_eq!((x, y), (5185.0, 7155.0));
    assert_eq!(number(&features[0], "area_m2"), number(&features[0], "above_m2"));
    assert!((number(&features[0], "moved_m") - 20.0_f64.hypot(20.0)).abs() < 1e-6);
    // Without moving, it is the catchment of the cell on the side.
    folder.succeeds("derive dem.tif --outlet 5205,7135 --outlet-snap 0 --catchments one.tif");
    let one = folder.raster("one.tif").iter().filter(|v| !v.is_nan()).count();
    assert!(one < 20, "{one}");
}

#[test]
fn outlets_of_a_file_are_converted_and_those_outside_are_findings() {
    let folder = Folder::with_valley();
    fs::write(folder.path("p.csv"), "x,y,name\n5205,7155,a\n5305,7155,b\n99999,7155,c\n").unwrap();
    let text = folder.succeeds("derive dem.tif --outlet p.csv --outlet-snap 1 --catchments c.geojson");
    assert!(text.contains("outlets outside the height map: 1"), "{text}");
    let features = folder.features("c.geojson");
    let of = |number_: f64| features.iter().find(|f| number(f, "catchment") == number_).unwrap();
    assert_eq!(number(of(1.0), "area_m2") + number(of(2.0), "area_m2"), number(of(1.0), "above_m2"));
    assert_eq!(number(of(2.0), "area_m2"), number(of(2.0), "above_m2"));
    let text = folder.ends("derive dem.tif --outlet 7155,5205 --catchments d.geojson", 1);
    assert!(text.contains("no outlet lies on the height map") && text.contains("7155.0 5205.0"), "{text}");
    assert!(!folder.path("d.geojson").exists());
    // Points in degrees lie at the same place.
    let to = tokosen::crs::Transform::between(&Crs::from_epsg(6677), &Crs::from_epsg(6668)).unwrap();
    let p = to.forward(DVec2::new(5205.0, 7155.0)).unwrap();
    let point = format!(
        r#"{{"type":"FeatureCollection","crs":{{"type":"name","properties":{{"name":"EPSG:6668"}}}},"features":[
        {{"type":"Feature","properties":{{}},"geometry":{{"type":"Point","coordinates":[{},{}]}}}}]}}"#,
        p.x, p.y
    );
    fs::write(folder.path("degrees.geojson"), point).unwrap();
    folder.succeeds("derive dem.tif --outlet degrees.geojson --outlet-snap 1 --catchments e.geojson");
    assert_eq!(number(&folder.features("e.geojson")[0], "above_m2"), number(of(1.0), "above_m2"));
}

#[test]
fn streams_are_lines_with_heights() {
    let folder = Folder::with_valley();
    let text = folder.succeeds("derive dem.tif --stream-lines s.geojson --threshold 50000");
    assert!(text.contains("streams    1 lines"), "{text}");
    let [line] = &folder.features("s.geojson")[..] else { panic!("{text}") };
    let points = line["geometry"]["coordinates"].as_array().unwrap();
    let z = |k: usize| points[k][2].as_f64().unwrap();
    assert!((1..points.len()).all(|k| z(k) < z(k - 1)));
    assert_eq!(number(line, "strahler"), 1.0);
    assert_eq!(number(line, "length_m"), 10.0 * (points.len() - 1) as f64);
    assert!((number(line, "fall_m") - 0.1 * (points.len() - 1) as f64).abs() < 1e-3);
    assert_eq!(number(line, "above_m2"), 41.0 * 31.0 * 100.0);
    assert_eq!(line["properties"]["into"], Value::Null);
    for name in ["s.gpkg", "s.shp", "s.fgb", "s.dxf"] {
        folder.succeeds(&format!("derive dem.tif --stream-lines {name} --threshold 50000"));
        assert!(folder.path(name).exists());
    }
}

#[test]
fn floods_come_from_the_edge_from_places_or_along_streams() {
    let folder = Folder::new();
    // A dam across the valley in column 20.
    let mut dam = valley();
    for row in 0..31 {
        dam.values[row * 41 + 20] = 70.0;
    }
    // The borders are high, except at the west end of the valley.
    for col in 0..41 {
        dam.values[col] = 90.0;
        dam.values[30 * 41 + col] = 90.0;
    }
    (0..31).for_each(|row| dam.values[row * 41 + 40] = 90.0);
    write_dem(&folder.path("dem.tif"), &dam).unwrap();
    let text = folder.succeeds("derive dem.tif --flood edge.tif --flood-level 55");
    let wet = folder.raster("edge.tif");
    let expected = |col: usize, row: usize| f64::from(55.0 - dam.values[row * 41 + col]).max(0.0);
    for (cell, &depth) in wet.iter().enumerate() {
        let (col, row) = (cell % 41, cell / 41);
        let wanted = if col < 20 { expected(col, row) } else { 0.0 };
        assert!((f64::from(if depth.is_nan() { 0.0 } else { depth }) - wanted).abs() < 1e-4, "{col} {row}");
    }
    let square_metres = wet.iter().filter(|v| !v.is_nan()).count() as f64 * 100.0;
    assert!(text.contains(&format!(" {square_metres:.0} m²")) && text.contains("5.00 m at most"), "{text}");
    folder.succeeds("derive dem.tif --flood lake.geojson --flood-level 55 --flood-from 5305,7155");
    let lake = folder.features("lake.geojson");
    assert_eq!(lake.len(), 1);
    assert!(number(&lake[0], "volume_m3") > 0.0 && (number(&lake[0], "depth_max") - 2.9).abs() < 1e-3);
    folder
        .succeeds("derive dem.tif --flood bands.geojson --flood-level 55 --flood-from 5305,7155 --flood-bands 0.5,1,2");
    let bands = folder.features("bands.geojson");
    let sum = |name: &str| bands.iter().map(|band| number(band, name)).sum::<f64>();
    for name in ["area_m2", "volume_m3"] {
        assert!((sum(name) - number(&lake[0], name)).abs() < 1e-6 * sum(name), "{name}");
    }
    let mut ends: Vec<_> =
        bands.iter().map(|band| (number(band, "depth_from"), &band["properties"]["depth_to"])).collect();
    ends.sort_by(|a, b| a.0.total_cmp(&b.0));
    ends.dedup();
    let expected = [(0.0, &json!(0.5)), (0.5, &json!(1.0)), (1.0, &json!(2.0)), (2.0, &Value::Null)];
    assert_eq!(ends, expected);
    folder.succeeds("derive dem.tif --flood bands.gpkg --flood-level 55 --flood-from 5305,7155 --flood-bands 0.5,1,2");
    let db = rusqlite::Connection::open(folder.path("bands.gpkg")).unwrap();
    let style: String = db.query_row("SELECT styleQML FROM layer_styles", [], |row| row.get(0)).unwrap();
    assert!(style.contains("array_agg(depth_from)") && style.contains("fillColor"), "{style}");
    for (place, words) in [("5305,7300", "not below the level"), ("1,1", "outside the height map")] {
        let text = folder.ends(&format!("derive dem.tif --flood x.tif --flood-level 55 --flood-from {place}"), 1);
        assert!(text.contains(words), "{text}");
    }
    let text = folder.succeeds("derive dem.tif --flood dry.tif --flood-level 1");
    assert!(text.contains("--flood-from names"), "{text}");
    let text =
        folder.succeeds("derive dem.tif --stream-lines none.gpkg --flood none.tif --flood-level +3 --threshold 1e9");
    assert!(text.contains("streams    none") && text.contains("there is no stream"), "{text}");
    let folder = Folder::with_valley();
    folder.succeeds("derive dem.tif --flood rise.tif --flood-level +1.5 --threshold 50000");
    let rise = folder.raster("rise.tif");
    assert_eq!((rise[15 * 41], rise[13 * 41].is_nan()), (1.5, true));
    assert!((rise[14 * 41 + 5] - 0.6).abs() < 0.2, "{}", rise[14 * 41 + 5]);
}

#[test]
fn wrong_usage_is_told_before_the_work() {
    let folder = Folder::with_valley();
    for (arguments, words) in [
        ("derive dem.tif --outlet 1,2 --slope a.tif", "--catchments <FILE>"),
        ("derive dem.tif --catchments a.gpkg --outlet-snap 5", "--outlet"),
        ("derive dem.tif --catchments a.gpkg --outlet 1,2 --outlet-snap -5", "--outlet-snap is -5"),
        ("derive dem.tif --stream-lines a.gpkg", "--threshold <AREA>"),
        ("derive dem.tif --stream-lines a.gpkg --threshold 0", "--threshold is 0"),
        ("derive dem.tif --stream-lines a.tif --threshold 9", "streams are written as"),
        ("derive dem.tif --slope a.tif --threshold 9", "--threshold goes with"),
        ("derive dem.tif --flood a.tif", "--flood-level <LEVEL|+H>"),
        ("derive dem.tif --flood a.jpg --flood-level 5", "a flood is written as"),
        ("derive dem.tif --flood a.tif --flood-level high", "a level such as 12.5"),
        ("derive dem.tif --flood a.tif --flood-level +2", "needs --threshold"),
        ("derive dem.tif --flood a.tif --flood-level +2 --threshold 9 --flood-from 1,2", "--flood-from goes with"),
        ("derive dem.tif --flood a.tif --flood-level 5 --flood-bands 1,2", "--flood-bands parts areas"),
        ("derive dem.tif --flood a.gpkg --flood-level 5 --flood-bands 2,1", "from small to large"),
        ("derive dem.tif --slope a.tif --accumulation-unit m2", "--flow-accumulation <FILE>"),
        ("derive dem.tif --flood a.gpkg --flood-level 5 --catchments a.gpkg", "the name of two outputs"),
    ] {
        let text = folder.ends(arguments, 2);
        assert!(text.contains(words), "{arguments}: {text}");
    }
    let text = folder.ends("derive dem.tif --outlet none.gpkg --catchments a.gpkg", 1);
    assert!(text.contains("none.gpkg"), "{text}");
    assert!(Path::new(&folder.path("dem.tif")).exists() && fs::read_dir(folder.0.path()).unwrap().count() == 1);
}
