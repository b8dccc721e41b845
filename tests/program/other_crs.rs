//! Height maps in another coordinate reference system than the contours, and maps over a line where coordinates jump.

#![allow(clippy::unwrap_used, reason = "helpers of tests are tests too")]

use glam::DVec2;
use tokosen::contour::{Contour, ContourLayer, ContourLine, ContourMap, Source};
use tokosen::crs::{Crs, Transform};
use tokosen::io::raster::{read_dem, read_standard_errors};
use tokosen::io::{ReadOptions, StagedOutput, read_contours, write_contours};
use tokosen::raster::Dem;

use crate::common;
use crate::running::{Running, run, said};

/// These tests.
struct Here;

type Folder = common::Folder<Here>;

/// Metres per metre to the east of the slope of [`Folder::slope`].
const RISE: f64 = 0.1;

impl Folder {
    /// Writes straight contours across a kilometre around a place: a plane that rises to the east.
    fn slope(&self, name: &str, crs: u32, middle: DVec2) {
        let line = |k: i32| ContourLine {
            elevation: 100.0 + RISE * 100.0 * f64::from(k),
            points: (-10..=10).map(|i| middle + 100.0 * DVec2::new(f64::from(k), f64::from(i) * 0.5)).collect(),
            source: Source::Input,
            index: false,
            kind: None,
            depression: false,
            expected: None,
        };
        let lines = (-5..=5).map(line).collect();
        let layer = ContourLayer { name: "contours".into(), lines, artefact_rings: 0, dead_ends: 0 };
        let staged = StagedOutput::create(&self.path(name)).unwrap();
        write_contours(&staged, &[layer], Some(&Crs::from_epsg(crs))).unwrap();
        staged.commit().unwrap();
    }

    fn dem(&self, name: &str) -> Dem {
        read_dem(&self.path(name)).unwrap().value.dem
    }

    fn fails(&self, arguments: &str, words: &[&str]) {
        let output = run(self.0.path(), arguments);
        let text = said(&output);
        assert_eq!(output.status.code(), Some(2), "{arguments}: {text}");
        for word in words {
            assert!(text.contains(word), "{arguments}: {text}");
        }
    }
}

/// Asserts that a height map is that of the slope around `middle` in `crs`, and returns the number of its heights.
fn is_the_slope(dem: &Dem, crs: u32, middle: DVec2) -> usize {
    let way = Transform::between(dem.crs.as_ref().unwrap(), &Crs::from_epsg(crs)).unwrap();
    let mut valid = 0;
    for (i, height) in dem.values.iter().enumerate() {
        let place = way.forward(dem.grid.center(i % dem.grid.cols, i / dem.grid.cols)).unwrap() - middle;
        let is_inside = place.abs().max_element() < 499.9;
        assert!(height.is_nan() || place.abs().max_element() < 500.1, "{place}");
        assert!(!is_inside || !height.is_nan(), "{place}");
        assert!(height.is_nan() || (f64::from(*height) - 100.0 - RISE * place.x).abs() < 1e-3, "{place}: {height}");
        valid += usize::from(is_inside);
    }
    valid
}

#[test]
fn the_surface_is_sampled_where_the_cells_of_another_system_are() {
    // Each with the metres per unit of the target, about: Web Mercator, UTM, feet of California, Swiss and polar systems.
    for (crs, middle, to, cell, count) in [
        (6676, DVec2::new(21_000.0, -70_000.0), 3857, "20", 3720.0),
        (6676, DVec2::new(21_000.0, -70_000.0), 32654, "20", 2500.0),
        (26911, DVec2::new(385_000.0, 3_770_000.0), 2229, "100", 1076.0),
        (2056, DVec2::new(2_700_000.0, 1_180_000.0), 32632, "20", 2500.0),
        (3995, DVec2::new(100_000.0, 900_000.0), 3413, "20", 2600.0),
    ] {
        let folder = Folder::new();
        folder.slope("in.gpkg", crs, middle);
        folder.succeeds(&format!("dem in.gpkg --surface linear --to-crs EPSG:{to} --cell {cell} -o out.tif"));
        let dem = folder.dem("out.tif");
        assert_eq!(dem.crs.as_ref().and_then(|crs| crs.epsg), Some(to));
        assert_eq!(dem.grid.cell, DVec2::splat(cell.parse().unwrap()));
        let steps = dem.grid.corner / dem.grid.cell;
        assert_eq!(steps, steps.round(), "cells lie on multiples of their size");
        let valid = is_the_slope(&dem, crs, middle) as f64;
        assert!((valid / count - 1.0).abs() < 0.05, "{to}: {valid} heights");
    }
}

#[test]
fn geographic_targets_have_cells_in_degrees_and_the_own_system_is_no_other() {
    let folder = Folder::new();
    let middle = DVec2::new(21_000.0, -70_000.0);
    folder.slope("in.gpkg", 6676, middle);
    folder.succeeds("dem in.gpkg --surface linear --to-crs EPSG:4326 --cell-degrees 1s -o out.tif");
    let dem = folder.dem("out.tif");
    assert_eq!(dem.crs.as_ref().and_then(|crs| crs.epsg), Some(4326));
    assert_eq!(dem.grid.cell, DVec2::splat(1.0 / 3600.0));
    assert!(is_the_slope(&dem, 6676, middle) > 1000);
    folder.succeeds("dem in.gpkg --to-crs EPSG:6676 --cell 10 -o named.tif");
    folder.succeeds("dem in.gpkg --cell 10 -o plain.tif");
    let bytes = ["named.tif", "plain.tif"].map(|name| std::fs::read(folder.path(name)).unwrap());
    assert!(bytes[0] == bytes[1]);
}

#[test]
fn errors_go_to_another_system_too_and_derive_makes_its_height_map_there() {
    let folder = Folder::new();
    folder.slope("in.gpkg", 6676, DVec2::new(21_000.0, -70_000.0));
    folder.succeeds("dem in.gpkg --to-crs EPSG:32654 --cell 25 --uncertainty -o out.tif");
    let (dem, errors) = (folder.dem("out.tif"), read_standard_errors(&folder.path("out.tif")).unwrap().unwrap());
    assert_eq!((dem.grid, &dem.crs), (errors.grid, &errors.crs));
    let both = dem.values.iter().zip(&errors.values);
    assert!(both.clone().all(|(z, e)| z.is_nan() == e.is_nan() && (e.is_nan() || *e >= 0.0)));
    assert!(both.filter(|(z, _)| !z.is_nan()).count() > 1500);
    // A Cloud Optimized GeoTIFF holds the same.
    folder.succeeds("dem in.gpkg --to-crs EPSG:32654 --cell 25 --uncertainty --cog -o cog.tif");
    assert_eq!(std::fs::read(folder.path("cog.tif")).unwrap()[8..36], *b"GDAL_STRUCTURAL_METADATA_SIZ");
    let bits = |dem: &Dem| dem.values.iter().map(|v| v.to_bits()).collect::<Vec<u32>>();
    assert!(bits(&folder.dem("cog.tif")) == bits(&dem));
    let again = read_standard_errors(&folder.path("cog.tif")).unwrap().unwrap();
    assert!(again.grid == errors.grid && bits(&again) == bits(&errors));
    // Slopes are measured on the ground, not on the map, which is larger.
    folder.succeeds("derive in.gpkg --surface linear --to-crs EPSG:3857 --cell 25 --slope slope.tif");
    let slope = folder.dem("slope.tif");
    assert_eq!(slope.crs.and_then(|crs| crs.epsg), Some(3857));
    let middle = slope.values[slope.grid.rows / 2 * slope.grid.cols + slope.grid.cols / 2];
    assert!((f64::from(middle) - RISE.atan().to_degrees()).abs() < 0.01, "{middle}");
}

#[test]
fn densify_writes_lines_and_height_map_in_one_system() {
    let folder = Folder::new();
    let middle = DVec2::new(21_000.0, -70_000.0);
    folder.slope("in.gpkg", 6676, middle);
    folder.succeeds("densify in.gpkg -i 5 -o out.gpkg --to-crs EPSG:3857 --surface linear --dem d.tif --cell 50");
    let lines: ContourMap = read_contours(&folder.path("out.gpkg"), &ReadOptions::default()).unwrap().value;
    let dem = folder.dem("d.tif");
    for crs in [lines.crs, dem.crs.clone()] {
        assert_eq!(crs.and_then(|crs| crs.epsg), Some(3857));
    }
    assert!(is_the_slope(&dem, 6676, middle) > 400);
    let far = |line: &Contour| line.points.iter().all(|p| p.x > 1e7);
    assert!(lines.contours.iter().all(far));
    // A raster has its own system.
    folder.succeeds("dem in.gpkg --cell 50 -o grid.tif");
    folder.succeeds("densify in.gpkg -i 5 -o other.gpkg --to-crs EPSG:3857 --dem like.tif --like grid.tif");
    assert_eq!(folder.dem("like.tif").crs.and_then(|crs| crs.epsg), Some(6676));
}

#[test]
fn sizes_in_the_wrong_unit_and_systems_that_do_not_serve() {
    let folder = Folder::new();
    folder.slope("in.gpkg", 6676, DVec2::new(21_000.0, -70_000.0));
    for (arguments, words) in [
        ("dem in.gpkg --to-crs EPSG:4326 --cell 10 -o d.tif", "--cell-degrees 0.4s"),
        ("densify in.gpkg -i 5 -o o.gpkg --to-crs EPSG:4326 --dem d.tif --cell 10", "--cell-degrees 0.4s"),
        (
            "dem in.gpkg --to-crs EPSG:3857 --cell-degrees 1s -o d.tif",
            "is not in degrees: give the size of cells with --cell",
        ),
        ("dem in.gpkg --to-crs EPSG:4326 --cell-degrees 0 -o d.tif", "--cell-degrees is 0"),
        ("dem in.gpkg --to-crs EPSG:3857 --cell -1 -o d.tif", "--cell is -1"),
        ("dem in.gpkg --to-crs EPSG:3857 -o d.tif", "needs --cell SIZE"),
        ("dem in.gpkg --to-crs EPSG:3857 --like r.tif -o d.tif", "cannot be used with"),
        ("dem in.gpkg --to-crs EPSG:1 --cell 5 -o d.tif", "--to-crs"),
        ("dem in.gpkg --cell 5 --cog -o d.png", "--cog applies to .tif"),
        ("densify in.gpkg -i 5 -o o.gpkg --cog", "needs --dem FILE"),
        ("dem in.gpkg --to-crs EPSG:3857 --cell 1e-4 -o d.tif", "--cell 0.0001 gives"),
        ("dem in.gpkg --to-crs EPSG:4326 --cell-degrees 1e-9 -o d.tif", "--cell-degrees 0.000000001 gives"),
        ("dem in.gpkg --to-crs EPSG:3857 --cell 1e6 -o d.tif", "--cell 1000000 is too large"),
    ] {
        folder.fails(arguments, &[words]);
    }
    // NTF (Paris) is in grads, the shift of NAD27 needs a file.
    for (to, words) in [(4807, "has another unit than degrees"), (4267, "needs a grid file")] {
        let (well, said) = folder.run(&format!("dem in.gpkg --to-crs EPSG:{to} --cell-degrees 1s -o d.tif"));
        assert!(!well && said.contains(words), "{said}");
    }
    std::fs::write(folder.path("none.geojson"), {
        let line = |z: i32| format!(
            r#"{{"type":"Feature","properties":{{"elev":{z}}},"geometry":{{"type":"LineString","coordinates":[[9000,{0}],[9900,{0}]]}}}}"#,
            9000 + z * 10
        );
        format!(
            r#"{{"type":"FeatureCollection","crs":{{"type":"name","properties":{{"name":"mine"}}}},"features":[{},{}]}}"#,
            line(10), line(20)
        )
    })
    .unwrap();
    let (well, said) = folder.run("dem none.geojson --to-crs EPSG:3857 --cell 5 -o d.tif");
    assert!(
        !well && said.contains("is not known, so they cannot be transformed") && said.contains("name it with --crs"),
        "{said}"
    );
    folder.succeeds("dem in.gpkg --cell 10 -o r.tif");
    folder.fails("derive r.tif --to-crs EPSG:3857 --slope s.tif", &["--to-crs applies to contours"]);
}

#[test]
fn a_map_across_the_180th_meridian_is_told_and_another_system_serves() {
    // The meridian crosses the middle: in PDC Mercator, in UTM zones 60 and 1 south (Fiji), in a system of New Zealand.
    let equator = |degrees: f64| 6_378_137.0 * degrees.to_radians();
    let meridian = |utm: u32, lat: f64| {
        Transform::between(&Crs::wgs84(), &Crs::from_epsg(utm)).unwrap().forward(DVec2::new(180.0, lat)).unwrap()
    };
    for (crs, middle) in [
        (3832, DVec2::new(equator(30.0), -1_900_000.0)),
        (32760, meridian(32760, -16.5)),
        (32701, meridian(32701, -16.5)),
        (2193, meridian(2193, -43.9)),
    ] {
        let folder = Folder::new();
        folder.slope("in.gpkg", crs, middle);
        for grid in ["--cell-degrees 1s", "--to-crs EPSG:4326 --cell-degrees 36s", "--to-crs EPSG:3857 --cell 1000"] {
            folder.fails(&format!("dem in.gpkg {grid} -o d.tif"), &["180th meridian", "--to-crs", "--extent"]);
            assert!(!folder.path("d.tif").exists());
        }
        folder.fails("densify in.gpkg -i 5 -o o.gpkg --dem d.tif --cell-degrees 1s", &["180th meridian"]);
        folder.fails("derive in.gpkg --cell-degrees 1s --slope d.tif", &["180th meridian"]);
        folder.succeeds("dem in.gpkg --cell 50 -o d.tif");
        let to = if crs == 3832 { 32760 } else { 3832 };
        folder.succeeds(&format!("dem in.gpkg --surface linear --to-crs EPSG:{to} --cell 50 -o other.tif"));
        assert!(is_the_slope(&folder.dem("other.tif"), crs, middle) > 300);
        // So does the part of the map on one side of it.
        let ([west, south], [east, north]) =
            ((middle + DVec2::new(-490.0, -400.0)).to_array(), (middle + DVec2::new(-80.0, 400.0)).to_array());
        let extent = format!("{west},{south},{east},{north}");
        folder.succeeds(&format!("dem in.gpkg --surface linear --extent {extent} --cell-degrees 1s -o part.tif"));
        let dem = folder.dem("part.tif");
        assert!(dem.grid.cols < 30 && dem.values.iter().filter(|z| !z.is_nan()).count() > 250, "{:?}", dem.grid);
        // Beside the meridian, degrees serve. It is up to five degrees off the north of the maps.
        for east in [-600.0, 600.0] {
            let middle = middle + DVec2::new(east, 0.0);
            folder.slope("beside.gpkg", crs, middle);
            folder.succeeds("dem beside.gpkg --surface linear --cell-degrees 1s -o beside.tif --overwrite");
            let dem = folder.dem("beside.tif");
            assert!(dem.grid.cols < 60, "{}", dem.grid.cols);
            assert!(is_the_slope(&dem, crs, middle) > 500);
        }
    }
}

#[test]
fn a_map_around_a_pole_is_told_and_a_map_beside_it_is_not() {
    for crs in [3995, 3413, 3031, 3976] {
        let folder = Folder::new();
        folder.slope("in.gpkg", crs, DVec2::new(120.0, -80.0));
        for grid in ["--cell-degrees 1s", "--to-crs EPSG:4326 --cell-degrees 36s"] {
            folder.fails(&format!("dem in.gpkg {grid} -o d.tif"), &["contains a pole", "--cell SIZE"]);
        }
        let (well, said) = folder.run("dem in.gpkg --to-crs EPSG:3857 --cell 1000 -o d.tif");
        assert!(!well && (said.contains("180th meridian") || said.contains("no part")), "{said}");
        folder.succeeds("dem in.gpkg --cell 50 -o d.tif");
        // Far from it, on one side of the meridians that the system is cut at.
        let middle = match crs {
            3995 | 3413 => DVec2::new(500_000.0, -300_000.0),
            _ => DVec2::new(500_000.0, 300_000.0),
        };
        folder.slope("beside.gpkg", crs, middle);
        folder.succeeds("dem beside.gpkg --surface linear --cell-degrees 2s -o beside.tif");
        assert!(is_the_slope(&folder.dem("beside.tif"), crs, middle) > 100);
    }
}
