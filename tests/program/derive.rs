//! `tokosen derive` as its users meet it.

#![allow(clippy::unwrap_used, reason = "helpers of tests are tests too")]

use std::fs;

use glam::DVec2;
use tokosen::base::Grid;
use tokosen::crs::Crs;
use tokosen::io::raster::{read_dem, write_dem};
use tokosen::raster::Dem;

use crate::common;
use crate::running::Running;

/// These tests.
struct Here;

type Folder = common::Folder<Here>;

impl Folder {
    /// Contours of a plane that rises to the east, `c.geojson`.
    fn write_contours(&self) {
        let line = |z: i32| {
            let x = 10 * z;
            format!(
                r#"{{"type":"Feature","properties":{{"elev":{z}}},"geometry":{{"type":"LineString",
                "coordinates":[[{x},0],[{x},100],[{x},200],[{x},300]]}}}}"#
            )
        };
        let lines: Vec<String> = [0, 10, 20, 30].map(line).to_vec();
        let text = format!(
            r#"{{"type":"FeatureCollection","crs":{{"type":"name","properties":{{"name":"EPSG:6677"}}}},"features":[{}]}}"#,
            lines.join(",")
        );
        fs::write(self.path("c.geojson"), text).unwrap();
    }
}

/// A plane that rises by 0.75 to the east, with cells of 2 m.
fn plane() -> Dem {
    let grid = Grid { corner: DVec2::new(1000.0, 500.0), cell: DVec2::splat(2.0), cols: 30, rows: 20 };
    let values = (0..600).map(|i| 100.0 + (i % 30) as f32 * 1.5).collect();
    Dem { grid, values, crs: Some(Crs::from_epsg(6677)) }
}

#[test]
fn all_products_of_a_plane() {
    let folder = Folder::new();
    write_dem(&folder.path("dem.asc"), &plane()).unwrap();
    let text = folder
        .succeeds("derive dem.asc --slope slope.tif --aspect aspect.exr --hillshade shade.png --steep steep.geojson");
    let slope = read_dem(&folder.path("slope.tif")).unwrap().value.dem;
    assert_eq!((slope.grid, slope.crs.unwrap().epsg), (plane().grid, Some(6677)));
    assert!(slope.values.iter().all(|v| (v - 0.75_f32.atan().to_degrees()).abs() < 1e-4));
    let aspect = read_dem(&folder.path("aspect.exr")).unwrap().value.dem;
    assert!(aspect.values.iter().all(|v| (v - 270.0).abs() < 1e-4));
    assert_eq!(image::open(folder.path("shade.png")).unwrap().to_luma8().dimensions(), (30, 20));
    let steep: serde_json::Value = serde_json::from_slice(&fs::read(folder.path("steep.geojson")).unwrap()).unwrap();
    let features = steep["features"].as_array().unwrap();
    assert_eq!(features.len(), 1);
    let properties = &features[0]["properties"];
    assert_eq!(properties["area_m2"].as_f64(), Some(2400.0));
    assert_eq!(properties["height_m"].as_f64(), Some(43.5));
    assert!(properties["note"].as_str().unwrap().contains("Not a survey"));
    assert!(text.contains("note       From a height map") && text.contains("1 areas"), "{text}");
}

#[test]
fn contours_are_derived_from_with_their_caution() {
    let folder = Folder::new();
    folder.write_contours();
    let said = folder.succeeds("derive c.geojson --cell 5 --slope s.tif --steep steep.gpkg --steep-angle 5");
    assert!(said.contains("contours 10 m apart, which cannot show a slope of 5 m"), "{said}");
    let slope = read_dem(&folder.path("s.tif")).unwrap().value.dem;
    let inside = slope.values.iter().filter(|v| v.is_finite());
    assert!(inside.clone().count() > 1000);
    assert!(inside.clone().all(|v| (v - 0.1_f32.atan().to_degrees()).abs() < 0.2), "{:?}", inside.collect::<Vec<_>>());
    let said = folder.ends("derive c.geojson --slope t.tif", 2);
    assert!(said.contains("needs --cell SIZE"), "{said}");
}

#[test]
fn the_light_of_the_hillshade_is_that_of_the_options() {
    let folder = Folder::new();
    write_dem(&folder.path("dem.tif"), &plane()).unwrap();
    // Brightness is 1 + 254 times the cosine of the angle between the light and the normal of the plane, which faces
    // west. With the factor, it rises by 1.5.
    let toward = |azimuth: f64, altitude: f64, rise: f64| {
        let (angle, altitude) = ((azimuth - 270.0).to_radians(), altitude.to_radians());
        (altitude.sin() + rise * altitude.cos() * angle.cos()) / f64::hypot(1.0, rise)
    };
    // The weights are 0.5 sin2 of the angle between the azimuths and the aspect.
    let many = 0.25 * toward(225.0, 60.0, 0.75) + 0.25 * toward(315.0, 60.0, 0.75) + 0.5 * toward(360.0, 60.0, 0.75);
    for (options, expected) in [
        ("", toward(315.0, 45.0, 0.75)),
        ("--azimuth 240 --altitude 30", toward(240.0, 30.0, 0.75)),
        ("--azimuth 360 --altitude 90 --z-factor 2", toward(360.0, 90.0, 1.5)),
        ("--z-factor 0.5", toward(315.0, 45.0, 0.375)),
        ("--azimuth 90 --altitude 20", 0.0),
        ("--multidirectional --altitude 60", many),
    ] {
        let off = |v: &f32| (f64::from(*v) - 1.0 - 254.0 * expected).abs();
        // A GeoTIFF has whole numbers, and no other value.
        for (file, bound) in [("shade.exr", 1e-3), ("shade.tif", 0.5 + 1e-3)] {
            folder.succeeds(&format!("derive dem.tif --hillshade {file} {options}"));
            let shade = read_dem(&folder.path(file)).unwrap().value.dem;
            assert!(shade.values.iter().all(|v| off(v) < bound), "{file} {options}: {} {expected}", shade.values[0]);
        }
    }
}

#[test]
fn water_flows_down_a_plane_in_every_format() {
    let folder = Folder::new();
    write_dem(&folder.path("dem.tif"), &plane()).unwrap();
    let text = folder.succeeds(
        "derive dem.tif --flow-direction d.png --flow-accumulation a.asc --catchments c.geojson --slope slope.tif",
    );
    assert!(text.contains("layer catchments (20 polygons), 20 catchments"), "{text}");
    // The plane falls to the west: each row is a catchment.
    let directions = read_dem(&folder.path("d.png")).unwrap().value.dem;
    let accumulation = read_dem(&folder.path("a.asc")).unwrap().value.dem;
    assert_eq!((directions.grid, accumulation.grid), (plane().grid, plane().grid));
    for cell in 0..600 {
        let col = cell % 30;
        let expected = (if col == 0 { 0.0 } else { 16.0 }, 30.0 - col as f32);
        assert_eq!((directions.values[cell], accumulation.values[cell]), expected, "{cell}");
    }
    let found: serde_json::Value = serde_json::from_slice(&fs::read(folder.path("c.geojson")).unwrap()).unwrap();
    let features = found["features"].as_array().unwrap();
    assert_eq!(features.len(), 20);
    for (row, feature) in features.iter().enumerate() {
        let properties = &feature["properties"];
        assert_eq!(properties["catchment"].as_u64(), Some(row as u64 + 1));
        assert_eq!(properties["area_m2"].as_f64(), Some(120.0));
        assert_eq!(properties["outlet_x"].as_f64(), Some(1001.0));
        assert_eq!(properties["outlet_y"].as_f64(), Some(499.0 - 2.0 * row as f64));
    }
    for name in ["c.tif", "c.asc", "c.gpkg", "c.shp"] {
        let text = folder.succeeds(&format!("derive dem.tif --catchments {name}"));
        assert!(text.contains("20 catchments"), "{text}");
    }
    for name in ["c.tif", "c.asc"] {
        let numbers = read_dem(&folder.path(name)).unwrap().value.dem.values;
        assert!((0..600).all(|cell| numbers[cell] == (cell / 30 + 1) as f32), "{name}");
    }
}

#[test]
fn flow_of_contours_is_the_same_for_any_number_of_threads() {
    let folder = Folder::new();
    folder.write_contours();
    let run = |threads: usize| {
        let out = |name: &str| format!("{name}{threads}.tif");
        folder.succeeds(&format!(
            "derive c.geojson --cell 5 --threads {threads} --flow-direction {} --flow-accumulation {} --catchments {} --cog",
            out("d"),
            out("a"),
            out("c")
        ));
        ["d", "a", "c"].map(|name| fs::read(folder.path(&out(name))).unwrap())
    };
    assert!(run(1) == run(2));
    let read = |name: &str| read_dem(&folder.path(name)).unwrap().value.dem.values;
    let (directions, accumulation) = (read("d1.tif"), read("a1.tif"));
    let count = directions.iter().filter(|code| code.is_finite()).count();
    let outlets = directions.iter().zip(&accumulation).filter(|(code, _)| **code == 0.0);
    assert!(count > 100);
    assert_eq!(outlets.map(|(_, cells)| *cells as usize).sum::<usize>(), count, "every cell drains to an outlet");
}

#[test]
fn wrong_usage_is_told_before_the_work() {
    let folder = Folder::new();
    write_dem(&folder.path("dem.tif"), &plane()).unwrap();
    let mut lost = plane();
    (lost.grid.corner, lost.grid.cell, lost.crs) = (DVec2::new(138.0, 36.0), DVec2::splat(1e-4), None);
    write_dem(&folder.path("degrees.tif"), &lost).unwrap();
    for (arguments, status, words) in [
        ("derive dem.tif", 2, "choose an output"),
        ("derive dem.tif --slope dem.tif", 2, "is an input"),
        ("derive dem.tif --slope a.tif --aspect a.tif", 2, "the name of two outputs"),
        ("derive dem.tif --slope a.jpg", 2, "height maps are written as"),
        ("derive dem.tif --steep a.tif", 2, "steep places are written as"),
        ("derive dem.tif --steep a.gpkg --steep-angle 90", 2, "--steep-angle is 90"),
        ("derive dem.tif --steep a.gpkg --steep-height -1", 2, "--steep-height is -1"),
        ("derive dem.tif --slope a.tif --steep-angle 45", 2, "--steep <FILE>"),
        ("derive dem.tif --slope a.tif --steep-height 9", 2, "--steep <FILE>"),
        ("derive dem.tif --slope a.tif --azimuth 45", 2, "--hillshade <FILE>"),
        ("derive dem.tif --slope a.tif --altitude 30", 2, "--hillshade <FILE>"),
        ("derive dem.tif --slope a.tif --z-factor 2", 2, "--hillshade <FILE>"),
        ("derive dem.tif --slope a.tif --multidirectional", 2, "--hillshade <FILE>"),
        ("derive dem.tif --hillshade a.tif --azimuth 361", 2, "--azimuth is 361"),
        ("derive dem.tif --hillshade a.tif --azimuth -1", 2, "--azimuth is -1"),
        ("derive dem.tif --hillshade a.tif --altitude 91", 2, "--altitude is 91"),
        ("derive dem.tif --hillshade a.tif --altitude nan", 2, "--altitude is NaN"),
        ("derive dem.tif --hillshade a.tif --z-factor 0", 2, "--z-factor is 0"),
        ("derive dem.tif --hillshade a.tif --z-factor inf", 2, "--z-factor is inf"),
        ("derive dem.tif --hillshade a.tif --azimuth 45 --multidirectional", 2, "cannot be used with"),
        ("derive dem.tif --hillshade a.png --cog", 2, "--cog applies to .tif"),
        ("derive dem.tif --steep a.gpkg --cog", 2, "--cog applies to .tif"),
        ("derive dem.tif --catchments a.gpkg --cog", 2, "--cog applies to .tif"),
        ("derive dem.tif --catchments a.jpg", 2, "catchments are written as"),
        ("derive dem.tif --catchments a.gpkg --steep a.gpkg", 2, "the name of two outputs"),
        ("derive dem.tif --flow-direction a.shp", 2, "height maps are written as"),
        ("derive dem.tif --cell 5 --slope a.tif", 2, "the input is a height map"),
        ("derive dem.tif --crs 6668 --slope a.tif", 2, "--crs applies to contours"),
        ("derive dem.doc --slope a.tif", 1, "dem.doc"),
        ("derive none.tif --slope a.tif", 1, "cannot read none.tif"),
        ("derive degrees.tif --slope a.tif", 1, "look like degrees"),
    ] {
        let text = folder.ends(arguments, status);
        assert!(text.contains(words), "{arguments}: {text}");
    }
    assert_eq!(fs::read_dir(folder.0.path()).unwrap().count(), 2);
}
