//! Parts of the map that are left out with `--exclude`.

#![allow(clippy::unwrap_used, reason = "helpers of tests are tests too")]

use std::collections::HashSet;
use std::fs;

use glam::DVec2;
use tokosen::contour::ContourMap;
use tokosen::io::raster::read_dem;
use tokosen::io::{ReadOptions, read_contours};

use crate::common::Folder;
use crate::running::{Running, folder_with_part};

/// A box in the middle of the sample: west, south, east, north.
const HOLE: [f64; 4] = [746_300.0, 4_019_000.0, 746_700.0, 4_019_300.0];

/// Writes boxes as the polygons of a file.
fn write_boxes(folder: &Folder, name: &str, crs: &str, boxes: &[[f64; 4]]) {
    let polygons: Vec<String> = boxes
        .iter()
        .map(|[west, south, east, north]| {
            format!(
                r#"{{"type":"Feature","properties":{{}},"geometry":{{"type":"Polygon","coordinates":
                [[[{west},{south}],[{east},{south}],[{east},{north}],[{west},{north}],[{west},{south}]]]}}}}"#
            )
        })
        .collect();
    let text = format!(
        r#"{{"type":"FeatureCollection","crs":{{"type":"name","properties":{{"name":"{crs}"}}}},"features":[{}]}}"#,
        polygons.join(",")
    );
    fs::write(folder.path(name), text).unwrap();
}

fn lines(folder: &Folder, name: &str) -> ContourMap {
    read_contours(&folder.path(name), &ReadOptions::default()).unwrap().value
}

fn is_in(p: DVec2, margin: f64) -> bool {
    let [west, south, east, north] = HOLE;
    p.x > west - margin && p.x < east + margin && p.y > south - margin && p.y < north + margin
}

fn vertices(map: &ContourMap) -> impl Iterator<Item = DVec2> {
    map.contours.iter().flat_map(|line| line.points.iter().copied())
}

fn set(points: impl Iterator<Item = DVec2>) -> HashSet<[u64; 2]> {
    points.map(|p| [p.x.to_bits(), p.y.to_bits()]).collect()
}

#[test]
fn lines_are_cut_at_the_border_and_kept_bit_for_bit_elsewhere() {
    let folder = folder_with_part("in.gpkg");
    write_boxes(&folder, "hole.geojson", "EPSG:32616", &[HOLE]);
    // Even a large distance for joins closes no line across the hole.
    let said = folder.succeeds("check in.gpkg --exclude hole.geojson --snap 500 --repair all -o out.gpkg -v");
    assert!(said.contains("feature 0 of hole.geojson"), "{said}");
    let plain = folder.succeeds("check in.gpkg --snap 500 --repair all -o plain.gpkg -v");
    let gaps = |said: &str| said.matches("a gap of").count();
    assert_eq!((gaps(&said), said.contains("joined-gap")), (gaps(&plain), false), "{said}");
    let (plain, out) = (lines(&folder, "plain.gpkg"), lines(&folder, "out.gpkg"));
    let (before, after) = (set(vertices(&plain)), set(vertices(&out)));
    let inside = set(vertices(&plain).filter(|p| is_in(*p, -1e-6)));
    assert!(inside.len() > 20);
    assert!(before.difference(&after).all(|p| inside.contains(p)), "a vertex outside of the hole was lost");
    assert!(vertices(&out).all(|p| !is_in(p, -1e-6)), "a vertex inside the hole was kept");
    let new: Vec<DVec2> = vertices(&out).filter(|p| !before.contains(&[p.x.to_bits(), p.y.to_bits()])).collect();
    assert!(new.len() > 10 && new.iter().all(|p| is_in(*p, 1e-6)), "new vertices lie on the border");
    assert_eq!(new.len() % 2, 0);
}

#[test]
fn the_surface_bridges_a_hole_without_findings_about_it() {
    let folder = folder_with_part("in.gpkg");
    write_boxes(&folder, "hole.geojson", "EPSG:32616", &[HOLE]);
    let plain = folder.succeeds("dem in.gpkg --cell 20 -o plain.tif");
    let said = folder.succeeds("dem in.gpkg --cell 20 --exclude hole.geojson -o out.tif");
    for word in ["gap", "end inside the map", "is missing", "contradict"] {
        assert_eq!(said.contains(word), plain.contains(word), "{word}: {said}");
    }
    let [plain, out] = ["plain.tif", "out.tif"].map(|name| read_dem(&folder.path(name)).unwrap().value.dem);
    assert_eq!(plain.grid, out.grid);
    let (mut squares, mut count, mut worst) = (0.0, 0.0, 0.0_f32);
    for (k, (a, b)) in plain.values.iter().zip(&out.values).enumerate() {
        assert_eq!(a.is_nan(), b.is_nan());
        let off = (a - b).abs();
        if is_in(plain.grid.center(k % plain.grid.cols, k / plain.grid.cols), 0.0) {
            assert!(off < 60.0, "{off} m");
            (squares, count) = (squares + off.powi(2), count + 1.0);
        } else if !is_in(plain.grid.center(k % plain.grid.cols, k / plain.grid.cols), 400.0) {
            worst = worst.max(off);
        }
    }
    let rms = f32::sqrt(squares / count);
    assert!(rms > 0.5 && rms < 7.0, "{rms} m");
    assert!(worst < 2.0, "{worst} m far from the hole");
}

#[test]
fn polygons_come_in_any_system_and_what_does_not_fit_is_told() {
    let folder = folder_with_part("in.gpkg");
    // The first box is in the sample.
    write_boxes(&folder, "degrees.geojson", "EPSG:4326", &[[-84.255, 36.28, -84.245, 36.29], [10.0, 50.0, 10.1, 50.1]]);
    let said = folder.succeeds("check in.gpkg --exclude degrees.geojson");
    assert!(said.contains("feature 0 of degrees.geojson"), "{said}");
    assert!(said.contains(" m of ") && !said.contains("map units"), "{said}");
    assert!(said.contains("1 of the 2 polygons of degrees.geojson"), "{said}");
    write_boxes(&folder, "far.geojson", "EPSG:32616", &[[0.0, 0.0, 10.0, 10.0]]);
    let said = folder.succeeds("check in.gpkg --exclude far.geojson");
    assert!(said.contains("no contour and no spot height lies inside a polygon of far.geojson"), "{said}");
    assert!(!folder.run("dem in.gpkg --cell 20 --strict --exclude far.geojson -o a.tif").0);
    let (well, said) = folder.run("dem in.gpkg --cell 20 --exclude in.gpkg -o a.tif");
    assert!(!well && said.contains("there is no layer of polygons"), "{said}");
    let [_, south, east, north] = HOLE;
    write_boxes(&folder, "hole.geojson", "EPSG:32616", &[HOLE]);
    let text = fs::read_to_string(folder.path("hole.geojson")).unwrap();
    let twisted =
        text.replacen(&format!("[{east},{south}],[{east},{north}]"), &format!("[{east},{north}],[{east},{south}]"), 1);
    assert_ne!(text, twisted);
    fs::write(folder.path("twisted.geojson"), twisted).unwrap();
    let (well, said) = folder.run("dem in.gpkg --cell 20 --exclude twisted.geojson -o a.tif");
    assert!(!well && said.contains("crosses itself"), "{said}");
    folder.succeeds("dem in.gpkg --cell 100 -o plain.tif");
    let (well, said) = folder.run("derive plain.tif --exclude hole.geojson --slope a.tif");
    assert!(!well && said.contains("--exclude applies to contours"), "{said}");
}

#[test]
fn a_hole_that_leaves_nothing_is_an_error() {
    let folder = folder_with_part("in.gpkg");
    write_boxes(&folder, "all.geojson", "EPSG:32616", &[[600_000.0, 3_900_000.0, 900_000.0, 4_200_000.0]]);
    let (well, said) = folder.run("dem in.gpkg --cell 20 --exclude all.geojson -o a.tif");
    assert!(!well && said.contains("left out"), "{said}");
}
