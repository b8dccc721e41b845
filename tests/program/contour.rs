//! `tokosen contour` as its users meet it.

#![allow(clippy::unwrap_used, reason = "helpers of tests are tests too")]

use std::fs;

use glam::DVec2;
use serde_json::{Value, json};
use tokosen::base::{ElevationUnit, Grid};
use tokosen::crs::{Crs, Transform};
use tokosen::io::raster::{RasterParams, write_dem, write_raster};
use tokosen::io::{ReadOptions, read_contours};
use tokosen::raster::Dem;

use super::running::{Running, run, said};
use crate::common;

/// These tests.
struct Here;

type Folder = common::Folder<Here>;

/// A cone of 100 m with a slope of 1 : 1, on cells of 2 m.
fn cone() -> Dem {
    let grid = Grid { corner: DVec2::new(1000.0, 500.0), cell: DVec2::splat(2.0), cols: 81, rows: 81 };
    let top = grid.center(40, 40);
    let height = |i: usize| (100.0 - grid.center(i % 81, i / 81).distance(top)) as f32;
    Dem { grid, values: (0..grid.len()).map(height).collect(), crs: Some(Crs::from_epsg(6677)) }
}

fn features(folder: &Folder, name: &str) -> Vec<Value> {
    let text = fs::read(folder.path(name)).unwrap();
    let collection: Value = serde_json::from_slice(&text).unwrap();
    collection["features"].as_array().unwrap().clone()
}

#[test]
fn lines_have_their_attributes_and_the_summary_its_figures() {
    let folder = Folder::new();
    write_dem(&folder.path("dem.tif"), &cone()).unwrap();
    let text = folder.succeeds("contour dem.tif -i 10 -o lines.geojson --preview look.png");
    assert!(text.contains("input      dem.tif (81 x 81 cells)"), "{text}");
    assert!(
        text.contains("tolerance  1 (half a cell): lines are within it of the contour of the height map"),
        "{text}"
    );
    let dimensions = image::open(folder.path("look.png")).unwrap().to_rgb8().dimensions();
    assert!(dimensions.0 > 400 && dimensions.1 > 400);
    let lines = features(&folder, "lines.geojson");
    assert!(lines.len() >= 7);
    for line in &lines {
        let properties = &line["properties"];
        let elevation = properties["elev"].as_f64().unwrap();
        assert_eq!(properties["source"], "height_map");
        assert_eq!(properties["is_index"], elevation % 50.0 == 0.0);
        assert_eq!(properties["depression"], false);
        let points = line["geometry"]["coordinates"].as_array().unwrap();
        let at = |p: &Value| DVec2::new(p[0].as_f64().unwrap(), p[1].as_f64().unwrap());
        assert_eq!(properties["closed"], points.first() == points.last());
        for p in points {
            let height = 100.0 - at(p).distance(cone().grid.center(40, 40));
            assert!((height - elevation).abs() < 1.1, "{height} {elevation}");
        }
    }
}

#[test]
fn all_formats_and_several_intervals() {
    let folder = Folder::new();
    write_dem(&folder.path("dem.asc"), &cone()).unwrap();
    let count = |name: &str| {
        let layer = name.ends_with("gpkg").then(|| "contours_20m".to_owned());
        let options = ReadOptions { layer, ..ReadOptions::default() };
        read_contours(&folder.path(name), &options).unwrap().value.contours.len()
    };
    let mut counts = Vec::new();
    for extension in ["geojson", "shp", "fgb", "dxf"] {
        folder.succeeds(&format!("contour dem.asc -i 20,5 -o lines.{extension} -q"));
        counts.push([count(&format!("lines_20m.{extension}")), count(&format!("lines_5m.{extension}"))]);
    }
    folder.succeeds("contour dem.asc -i 20,5 -o lines.gpkg");
    assert!(counts.iter().all(|both| *both == counts[0] && both[0] < both[1]), "{counts:?}");
    assert_eq!(count("lines.gpkg"), counts[0][0]);
    let bytes = [1, 3].map(|threads| {
        folder.succeeds(&format!("contour dem.asc -i 5 -o {threads}.fgb --threads {threads}"));
        fs::read(folder.path(&format!("{threads}.fgb"))).unwrap()
    });
    assert!(bytes[0] == bytes[1]);
    // The lines are contours that a height map can be made of.
    folder.succeeds("dem lines_5m.shp --cell 4 -o again.tif");
}

#[test]
fn smoothing_tolerance_and_levels() {
    let folder = Folder::new();
    let mut rough = cone();
    for (i, z) in rough.values.iter_mut().enumerate() {
        *z += ((i * 7919) % 101) as f32 / 50.0 - 1.0;
    }
    write_dem(&folder.path("rough.tif"), &rough).unwrap();
    let lines = |options: &str| {
        let text = folder.succeeds(&format!("contour rough.tif --levels 52.5,60 -o l.geojson {options}"));
        (features(&folder, "l.geojson").len(), text)
    };
    let (before, text) = lines("");
    assert!(!text.contains("smoothed"), "{text}");
    let (after, text) = lines("--smooth 4 --tolerance 0.5");
    assert!(after <= before && after >= 2, "{after} of {before}");
    assert!(text.contains("smoothed   Gaussian with a standard deviation of 4; largest change of a height"), "{text}");
    assert!(text.contains("tolerance  0.5: lines are within it of the contour of the smoothed heights"), "{text}");
}

#[test]
fn units_and_coordinate_reference_systems() {
    let folder = Folder::new();
    let feet = RasterParams { unit: ElevationUnit::Foot, ..RasterParams::default() };
    write_raster(&folder.path("feet.tif"), &cone(), &feet).unwrap();
    let text = folder.succeeds("contour feet.tif -i 100 --to-unit ft --to-crs EPSG:6668 -o f.geojson");
    assert!(text.contains("layer contours_100ft") && text.contains("heights in feet"), "{text}");
    let lines = features(&folder, "f.geojson");
    assert!(!lines.is_empty());
    for line in &lines {
        let elevation = line["properties"]["elev"].as_f64().unwrap();
        assert_eq!(elevation % 100.0, 0.0);
        let [x, y, z] = [0, 1, 2].map(|i| line["geometry"]["coordinates"][0][i].as_f64().unwrap());
        assert!((130.0..150.0).contains(&x) && (30.0..40.0).contains(&y), "{x} {y}");
        assert_eq!(z, elevation);
    }
    let bare = Dem { crs: None, ..cone() };
    write_dem(&folder.path("bare.asc"), &bare).unwrap();
    let (well, text) = folder.run("contour bare.asc -i 10 -o b.geojson --to-crs EPSG:6668");
    assert!(!well && text.contains("not known") && text.contains("--crs"), "{text}");
    let text = folder.succeeds("contour bare.asc -i 10 -o b.geojson");
    assert!(text.contains("crs        unknown") && text.contains("coordinate reference system unknown"), "{text}");
    let text = folder.succeeds("contour bare.asc -i 10 -o b.geojson --to-crs EPSG:6668 --crs EPSG:6677");
    assert!(!text.contains("unknown"), "{text}");
    // Degrees are worked on as they are.
    let mut degrees = cone();
    (degrees.grid.corner, degrees.grid.cell, degrees.crs) =
        (DVec2::new(138.0, 36.0), DVec2::new(1e-4, 8e-5), Some(Crs::from_epsg(6668)));
    write_dem(&folder.path("degrees.tif"), &degrees).unwrap();
    let text = folder.succeeds("contour degrees.tif -i 10 -o d.gpkg");
    assert!(text.contains("tolerance  0.00004 (half a cell)"), "{text}");
}

/// A polygon as GeoJSON in the system of a code.
fn polygon(folder: &Folder, name: &str, code: u32, corners: &[[f64; 2]]) {
    let ring: Vec<[f64; 2]> = corners.iter().chain(corners.first()).copied().collect();
    let crs = json!({ "type": "name", "properties": { "name": format!("urn:ogc:def:crs:EPSG::{code}") } });
    let geometry = json!({ "type": "Polygon", "coordinates": [ring] });
    let feature = json!({ "type": "Feature", "properties": {}, "geometry": geometry });
    let all = json!({ "type": "FeatureCollection", "crs": crs, "features": [feature] });
    fs::write(folder.path(name), all.to_string()).unwrap();
}

/// The vertices of all lines, and those at which open lines end.
fn vertices(folder: &Folder, name: &str) -> [Vec<DVec2>; 2] {
    let [mut all, mut ends] = [Vec::new(), Vec::new()];
    for line in features(folder, name) {
        let at = |p: &Value| DVec2::new(p[0].as_f64().unwrap(), p[1].as_f64().unwrap());
        let points: Vec<DVec2> = line["geometry"]["coordinates"].as_array().unwrap().iter().map(at).collect();
        let (first, last) = (points[0], points[points.len() - 1]);
        assert_eq!(line["properties"]["closed"], first == last);
        ends.extend([first, last].into_iter().filter(|_| first != last));
        all.extend(points);
    }
    [all, ends]
}

#[test]
fn lines_are_cut_to_a_part_of_the_map_and_end_on_its_border() {
    let folder = Folder::new();
    write_dem(&folder.path("dem.tif"), &cone()).unwrap();
    folder.succeeds("contour dem.tif -i 10 -o whole.geojson");
    let [whole, _] = vertices(&folder, "whole.geojson");
    // A triangle around the top, in the system of the height map and in degrees.
    let corners = [[1051.0, 390.0], [1120.0, 390.0], [1082.0, 455.0]];
    let way = Transform::between(&Crs::from_epsg(6668), &Crs::from_epsg(6677)).unwrap();
    polygon(&folder, "area.geojson", 6677, &corners);
    polygon(&folder, "degrees.geojson", 6668, &corners.map(|p| way.inverse(p.into()).unwrap().to_array()));
    let off = |p: DVec2| {
        let side = |k: usize| [corners[k], corners[(k + 1) % 3]].map(DVec2::from);
        (0..3).map(side).map(|[a, b]| (b - a).normalize().perp_dot(p - a)).fold(f64::INFINITY, f64::min)
    };
    for (options, near) in [("--clip area.geojson", 1e-6), ("--clip degrees.geojson", 2e-3)] {
        folder.succeeds(&format!("contour dem.tif -i 10 -o part.geojson {options} --preview part.png"));
        let [all, ends] = vertices(&folder, "part.geojson");
        assert!(ends.len() >= 6 && ends.iter().all(|p| off(*p).abs() < near), "{options}: {ends:?}");
        assert!(all.iter().all(|p| off(*p) > -near), "{options}");
        // The heights around the part count: what is left of the lines has not moved.
        assert!(all.iter().all(|p| whole.contains(p) || ends.contains(p) || off(*p).abs() < near), "{options}");
        assert!(all.len() > 20, "{options}");
    }
    folder.succeeds("contour dem.tif -i 10 -o box.geojson --extent 1050,400,1100,440");
    let [all, ends] = vertices(&folder, "box.geojson");
    let on_box = |p: &DVec2| p.x == 1050.0 || p.x == 1100.0 || p.y == 400.0 || p.y == 440.0;
    assert!(ends.len() >= 6 && ends.iter().all(on_box), "{ends:?}");
    assert!(all.iter().all(|p| (1050.0..=1100.0).contains(&p.x) && (400.0..=440.0).contains(&p.y)));
    let text = folder.succeeds("contour dem.tif --levels 95 -o none.geojson --extent 1002,402,1008,408");
    assert!(text.contains("none of its levels in this part"), "{text}");
}

#[test]
fn the_ground_of_a_height_map_ends_at_a_frame() {
    let folder = Folder::new();
    let mut rough = cone();
    let top = rough.grid.center(40, 40);
    // Outside of the frame, heights that must have no effect on smoothed ones inside.
    let size = rough.grid;
    let away = |i: usize| (size.center(i % 81, i / 81) - top).abs().max_element();
    rough.values.iter_mut().enumerate().filter(|(i, _)| away(*i) > 30.0).for_each(|(_, z)| *z += 500.0);
    write_dem(&folder.path("rough.tif"), &rough).unwrap();
    write_dem(&folder.path("dem.tif"), &cone()).unwrap();
    let [west, south, east, north] = [top.x - 30.0, top.y - 30.0, top.x + 30.0, top.y + 30.0];
    polygon(&folder, "frame.geojson", 6677, &[[west, south], [east, south], [east, north], [west, north]]);
    let text = |dem: &str| {
        folder.succeeds(&format!("contour {dem} -i 10 --smooth 4 --frame frame.geojson -o {dem}.geojson"));
        vertices(&folder, &format!("{dem}.geojson"))
    };
    let [all, ends] = text("rough.tif");
    assert_eq!(all, text("dem.tif")[0]);
    assert!(ends.len() >= 8 && ends.iter().all(|p| ((*p - top).abs().max_element() - 30.0).abs() < 1e-6), "{ends:?}");
    // Both: the ground ends at the polygon, and the lines are cut to a box.
    folder.succeeds(&format!(
        "contour dem.tif -i 10 --frame frame.geojson --extent {west},{south},{},{north} -o both.geojson",
        top.x
    ));
    assert!(vertices(&folder, "both.geojson")[0].iter().all(|p| p.x >= west && p.x <= top.x));
}

#[test]
fn wrong_usage_and_wrong_input_say_what_to_do() {
    let folder = Folder::new();
    write_dem(&folder.path("dem.tif"), &cone()).unwrap();
    folder.succeeds("contour dem.tif -i 10 -o lines.geojson");
    polygon(&folder, "elsewhere.geojson", 6677, &[[0.0, 0.0], [9.0, 0.0], [9.0, 9.0]]);
    for (arguments, status, words) in [
        ("contour dem.tif -o a.gpkg", 2, "--interval"),
        ("contour dem.tif -i 0 -o a.gpkg", 2, "--interval is 0"),
        ("contour dem.tif -i 5 --levels 7 -o a.gpkg", 2, "cannot be used with"),
        ("contour dem.tif -i 5 -o a.tif", 2, "contours are written as"),
        ("contour dem.tif -i 5 -o a.gpkg --preview a.jpg", 2, "pictures are written as"),
        ("contour dem.tif -i 5 -o a.gpkg --tolerance -1", 2, "--tolerance is -1"),
        ("contour dem.tif -i 5 -o a.gpkg --smooth 0", 2, "--smooth is 0"),
        ("contour dem.tif -i 5 -o a.gpkg --smooth 300", 2, "at most 50 cells"),
        ("contour dem.tif -i 0.00001 -o a.gpkg", 2, "choose a larger"),
        ("contour dem.tif -i 5 -o a.gpkg --extent 0,0,10,10", 1, "lies outside of the height map (x 1000.0 to 1162.0"),
        ("contour dem.tif -i 5 -o a.gpkg --extent 0,0,10,10 --clip a.shp", 2, "cannot be used with"),
        ("contour dem.tif -i 5 -o a.gpkg --extent-crs EPSG:6668", 2, "--extent"),
        ("contour dem.tif -i 5 -o a.gpkg --clip none.gpkg", 1, "cannot read none.gpkg"),
        ("contour dem.tif -i 5 -o a.gpkg --frame elsewhere.geojson", 1, "elsewhere.geojson: no cell of the height map"),
        ("contour none.tif -i 5 -o a.gpkg", 1, "cannot read none.tif"),
        ("contour lines.geojson -i 5 -o a.gpkg", 1, "'tokosen densify' makes denser contours"),
        ("densify dem.tif -i 5 -o a.gpkg", 1, "'tokosen contour' draws its contours"),
        ("dem dem.tif --cell 5 -o a.tif", 1, "'tokosen contour' draws its contours"),
        ("regions dem.tif -o a.gpkg", 1, "'tokosen contour' draws its contours"),
        ("skeleton dem.tif -o a.gpkg", 1, "'tokosen contour' draws its contours"),
        ("check dem.tif", 1, "'tokosen contour' draws its contours"),
    ] {
        let output = run(folder.0.path(), arguments);
        let text = said(&output);
        assert_eq!(output.status.code(), Some(status), "{arguments}: {text}");
        assert!(text.contains(words), "{arguments}: {text}");
    }
    assert_eq!(fs::read_dir(folder.0.path()).unwrap().count(), 3);
    let text = folder.succeeds("contour dem.tif --levels 5000 -o none.gpkg");
    assert!(text.contains("layer contours has no line"), "{text}");
}

#[test]
fn what_is_said_about_heights_exactly_at_a_level_is_true() {
    let folder = Folder::new();
    let grid = Grid { corner: DVec2::new(0.0, 50.0), cell: DVec2::splat(10.0), cols: 5, rows: 5 };
    let write = |name: &str, ground: f32, at: &[usize], height: f32| {
        let mut values = vec![ground; 25];
        at.iter().for_each(|&i| values[i] = height);
        write_dem(&folder.path(name), &Dem { grid, values, crs: Some(Crs::from_epsg(6677)) }).unwrap();
    };
    write("top.tif", 99.0, &[12], 100.0);
    write("row.tif", 99.0, &[10, 11, 12, 13, 14], 100.0);
    write("lake.tif", 100.0, &[12], 103.0);
    write("holes.tif", f32::NAN, &[12], 103.0);
    let said = |dem: &str, options: &str| folder.succeeds(&format!("contour {dem} -o lines.geojson {options}"));
    for (dem, count) in [("top.tif", 1), ("row.tif", 2)] {
        let text = said(dem, "-i 100");
        assert!(!text.contains("has no line") && text.contains(&format!("({count} lines")), "{text}");
        assert_eq!(features(&folder, "lines.geojson").len(), count);
    }
    let text = said("lake.tif", "-i 100");
    assert!(text.contains("no line: the level 100 m is the lowest height, and a height equal"), "{text}");
    let text = said("lake.tif", "-i 2");
    assert!(text.contains("no line at 100 m, the lowest height: a height equal") && !text.contains("has no"), "{text}");
    let text = said("lake.tif", "--levels 50,104");
    assert!(text.contains("no line: none of its levels is between the lowest and the highest height, 100 m and 103 m"));
    let text = said("lake.tif", "--levels 328.0839895013123 --to-unit ft");
    assert!(text.contains("the level 328.084 ft is the lowest height"), "{text}");
    let text = said("holes.tif", "-i 103");
    assert!(text.contains("no line"), "{text}");
    for quiet in ["top.tif", "lake.tif"] {
        assert_eq!(said(quiet, "-i 100 -q"), "");
    }
}

#[test]
fn a_tolerance_that_is_raised_is_told() {
    let folder = Folder::new();
    write_dem(&folder.path("dem.tif"), &cone()).unwrap();
    for (asked, is_told) in [("0", true), ("0.0019", true), ("0.002", false), ("0.5", false)] {
        let text = folder.succeeds(&format!("contour dem.tif -i 10 -o lines.geojson --tolerance {asked}"));
        let told = format!("--tolerance {asked} is less than a thousandth of a cell: 0.002 is used");
        assert_eq!(text.contains(&told), is_told, "{text}");
    }
}
