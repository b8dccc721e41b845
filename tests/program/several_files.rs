//! Several files as one map: sheets that share an edge, patterns, folders, layers that are named after the file.

#![allow(clippy::unwrap_used, reason = "helpers of tests are tests too")]

use glam::DVec2;
use tokosen::contour::{Contour, ContourMap};
use tokosen::crs::{Crs, Transform};
use tokosen::io::{ReadOptions, read_contours};

use crate::common::Folder;
use crate::maps::put;
use crate::running::Running;

/// The middle of a hill, in JGD2011 / Japan Plane Rectangular CS IX.
const MIDDLE: DVec2 = DVec2::new(-12_000.0, -34_000.0);

/// The half of a hill's rings on one side of the line x = middle, with ends exactly on it.
fn half(is_east: bool) -> ContourMap {
    let start = if is_east { -0.25 } else { 0.25 };
    let arc = |k: u32| {
        let radius = 100.0 * f64::from(6 - k);
        let at = |i: u32| match i {
            0 => MIDDLE + DVec2::new(0.0, if is_east { -radius } else { radius }),
            40 => MIDDLE + DVec2::new(0.0, if is_east { radius } else { -radius }),
            i => MIDDLE + radius * DVec2::from_angle(std::f64::consts::TAU * (start + 0.5 * f64::from(i) / 40.0)),
        };
        Contour { elevation: f64::from(100 + 10 * k), points: (0..=40).map(at).collect(), feature: u64::from(k).into() }
    };
    ContourMap { contours: (0..6).map(arc).collect(), crs: Some(Crs::from_epsg(6677)), ..ContourMap::default() }
}

fn read(folder: &Folder, name: &str) -> ContourMap {
    read_contours(&folder.path(name), &ReadOptions::default()).unwrap().value
}

/// A folder with the two sheets as shapefiles in `sheets`.
fn sheets() -> Folder {
    let folder = Folder::new();
    std::fs::create_dir(folder.path("sheets")).unwrap();
    put(&folder.path("sheets/east.shp"), &half(true), "contours");
    put(&folder.path("sheets/west.shp"), &half(false), "contours");
    folder
}

#[test]
fn lines_of_sheets_are_joined_at_their_edge() {
    let folder = sheets();
    for input in ["sheets/east.shp sheets/west.shp", "sheets/*.shp", "sheets"] {
        let text = folder.succeeds(&format!("densify {input} -i 5 -o out.gpkg"));
        let map = read(&folder, "out.gpkg");
        assert_eq!(map.contours.len(), 6 + 5, "{input}: {text}");
        assert!(map.contours.iter().all(Contour::is_closed), "{input}: {text}");
        let input_vertices: Vec<DVec2> = half(true).contours.iter().flat_map(|c| c.points.clone()).collect();
        let out: Vec<DVec2> = map.contours.iter().flat_map(|c| c.points.clone()).collect();
        assert!(input_vertices.iter().all(|p| out.contains(p)), "{input}: vertices are not kept");
    }
}

#[test]
fn a_sheet_in_a_wrong_system_is_the_reason_why_a_height_map_is_too_large() {
    let folder = sheets();
    // The same coordinates in zone XVIII, 1,800 km away.
    put(&folder.path("wrong.gpkg"), &ContourMap { crs: Some(Crs::from_epsg(6686)), ..half(false) }, "contours");
    let said = folder.ends("dem sheets/east.shp wrong.gpkg --cell 1 -o dem.tif", 2);
    assert!(said.contains("lines (6 of file 1) lie") && said.contains("they are in another zone"), "{said}");
}

#[test]
fn a_sheet_in_another_system_is_transformed_and_told() {
    let folder = sheets();
    let to = Crs::from_epsg(6668);
    let way = Transform::between(&Crs::from_epsg(6677), &to).unwrap();
    let mut west = half(false);
    west.contours.iter_mut().flat_map(|c| &mut c.points).for_each(|p| *p = way.forward(*p).unwrap());
    put(&folder.path("west.geojson"), &ContourMap { crs: Some(to), ..west }, "contours");
    let text = folder.succeeds("densify sheets/east.shp west.geojson -i 5 -o out.gpkg");
    assert!(text.contains("west.geojson: the file is in JGD2011"), "{text}");
    let map = read(&folder, "out.gpkg");
    assert!(map.contours.len() == 11 && map.contours.iter().all(Contour::is_closed), "{text}");
    assert_eq!(map.crs.and_then(|crs| crs.epsg), Some(6677));
}

#[test]
fn findings_name_the_file_of_a_feature() {
    let folder = sheets();
    let mut west = half(false);
    let repeated = west.contours[2].points[20];
    west.contours[2].points.insert(20, repeated);
    put(&folder.path("sheets/west.shp"), &west, "contours");
    let text = folder.succeeds("check sheets -v");
    assert!(text.contains("(feature 2 of file 2) is repeated"), "{text}");
    let json = folder.succeeds("check sheets --json");
    assert!(json.contains("\"2 of file 2\""), "{json}");
}

#[test]
fn a_layer_is_named_after_its_file() {
    let folder = Folder::new();
    put(&folder.path("all.gpkg"), &half(true), "east");
    put(&folder.path("all.gpkg"), &half(false), "west");
    let ambiguous = folder.ends("dem all.gpkg --cell 20 -o out.tif", 1);
    assert!(ambiguous.contains("east") && ambiguous.contains("west"), "{ambiguous}");
    folder.succeeds("dem all.gpkg|layername=east --cell 20 -o out.tif");
    folder.succeeds("densify all.gpkg|layername=east all.gpkg|layername=west -i 5 -o out.gpkg");
    assert!(read(&folder, "out.gpkg").contours.iter().all(Contour::is_closed));
    let wrong = folder.ends("dem all.gpkg|layername=north --cell 20 -o out.tif", 1);
    assert!(wrong.contains("there is no layer \"north\""), "{wrong}");
    let wrong = folder.ends("dem all.gpkg|layerid=1 --cell 20 -o out.tif", 2);
    assert!(wrong.contains("|layername=NAME"), "{wrong}");
    // As other programs write it.
    for other in ["all.gpkg:east", "all.gpkg,east"] {
        let wrong = folder.ends(&format!("dem {other} --cell 20 -o out.tif"), 1);
        assert!(wrong.contains("'all.gpkg|layername=contours'"), "{wrong}");
    }
}

#[test]
fn what_cannot_be_one_map_is_told() {
    let folder = sheets();
    let none = folder.ends("dem sheets/*.gpkg --cell 20 -o out.tif", 1);
    assert!(none.contains("no file matches"), "{none}");
    folder.succeeds("dem sheets --cell 20 -o out.tif");
    let mixed = folder.ends("derive out.tif sheets/east.shp --slope slope.tif", 2);
    assert!(mixed.contains("out.tif is a height map"), "{mixed}");
    // The output is one of the inputs, also when a pattern names it.
    let own = folder.ends("densify sheets/*.shp -i 5 -o sheets/west.shp", 2);
    assert!(own.contains("is an input"), "{own}");
}
