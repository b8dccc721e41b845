//! Height maps that a base continues beyond the contours, with `--base`.

#![allow(clippy::unwrap_used, reason = "helpers of tests are tests too")]

use std::fs;

use tokosen::io::raster::{RasterParams, read_dem, read_standard_errors, write_dem, write_raster};
use tokosen::raster::Dem;

use crate::common::Folder;
use crate::running::{Running, folder_with_part};

/// A frame in the middle of the sample.
const FRAME: &str = r#"{"type":"FeatureCollection","crs":{"type":"name","properties":{"name":"EPSG:32616"}},"features":[
    {"type":"Feature","properties":{},"geometry":{"type":"Polygon","coordinates":
    [[[745600,4018800],[746700,4018700],[746900,4019800],[745700,4019700],[745600,4018800]]]}}]}"#;

/// How much the base is too high.
const BIAS: f32 = 6.0;

/// The sample's contours, a frame in their middle, and the true heights with a bias as base.
fn prepared() -> Folder {
    let folder = folder_with_part("in.gpkg");
    fs::write(folder.path("frame.geojson"), FRAME).unwrap();
    let truth = concat!(env!("CARGO_MANIFEST_DIR"), "/samples/caryville_20m_truth.tif");
    fs::copy(truth, folder.path("truth.tif")).unwrap();
    write_changed(&folder, "base.tif", |dem| dem.values.iter_mut().for_each(|height| *height += BIAS));
    folder
}

/// Writes the true heights after a change.
fn write_changed(folder: &Folder, name: &str, change: impl FnOnce(&mut Dem)) {
    let mut dem = dem(folder, "truth.tif");
    change(&mut dem);
    write_dem(&folder.path(name), &dem).unwrap();
}

fn dem(folder: &Folder, name: &str) -> Dem {
    read_dem(&folder.path(name)).unwrap().value.dem
}

/// By how much heights rise too much from the cells of `inside` to those beside them, on the mean.
fn mean_step(dem: &Dem, truth: &Dem, inside: &Dem) -> f32 {
    let cols = dem.grid.cols;
    let pairs = (0..dem.values.len() - cols).flat_map(|k| [(k, k + 1), (k + 1, k), (k, k + cols), (k + cols, k)]);
    let outwards = pairs.filter(|&(a, b)| !inside.values[a].is_nan() && inside.values[b].is_nan());
    let rise = |dem: &Dem, a: usize, b: usize| dem.values[b] - dem.values[a];
    let steps: Vec<f32> = outwards.map(|(a, b)| rise(dem, a, b) - rise(truth, a, b)).collect();
    assert!(steps.len() > 100 && steps.iter().all(|step| step.is_finite()));
    steps.iter().sum::<f32>() / steps.len() as f32
}

const FRAMED: &str = "dem in.gpkg --frame frame.geojson --like truth.tif";

#[test]
fn the_base_goes_on_without_a_step_and_the_heights_inside_stay() {
    let folder = prepared();
    folder.succeeds(&format!("{FRAMED} -o plain.tif"));
    let said = folder.succeeds(&format!("{FRAMED} --base base.tif -o joined.tif"));
    folder.succeeds(&format!("{FRAMED} --base base.tif --base-fade 0 -o beside.tif"));
    let [plain, joined, beside, truth] =
        ["plain", "joined", "beside", "truth"].map(|n| dem(&folder, &format!("{n}.tif")));
    assert!(plain.values.iter().filter(|height| height.is_nan()).count() > plain.values.len() / 2);
    for other in [&joined, &beside] {
        let is_kept = |(a, b): (&f32, &f32)| b.is_nan() || a.to_bits() == b.to_bits();
        assert!(other.values.iter().zip(&plain.values).all(is_kept));
    }
    let [joined_step, beside_step] = [&joined, &beside].map(|dem| mean_step(dem, &truth, &plain));
    assert!(joined_step.abs() < 0.15 * BIAS, "{joined_step}");
    assert!((beside_step - BIAS).abs() < 0.15 * BIAS, "{beside_step}");
    // The summary tells the bias.
    let median = said.split_once("median ").unwrap().1.split_once(" m,").unwrap().0.parse::<f32>().unwrap();
    assert!((median + BIAS).abs() < 1.0, "{said}");
    assert!(said.contains("findings   none"), "{said}");
}

#[test]
fn without_cells_that_are_given_the_whole_base_is_covered() {
    let folder = prepared();
    folder.succeeds("dem in.gpkg --frame frame.geojson --base base.tif --cell 40 -o whole.tif");
    let (whole, base) = (dem(&folder, "whole.tif").grid, dem(&folder, "base.tif").grid);
    let size = |grid: &tokosen::base::Grid| [grid.cols as f64 * grid.cell.x, grid.rows as f64 * grid.cell.y];
    for (whole, base) in size(&whole).into_iter().zip(size(&base)) {
        assert!((whole - base).abs() < 100.0, "{whole} and {base}");
    }
    // In another system, too.
    folder.succeeds("dem in.gpkg --frame frame.geojson --base base.tif --cell-degrees 2s -o degrees.tif");
    let degrees = dem(&folder, "degrees.tif");
    let known = degrees.values.iter().filter(|height| height.is_finite()).count();
    assert!(known > degrees.values.len() * 9 / 10, "{known} of {}", degrees.values.len());

    let part = "dem in.gpkg --frame frame.geojson --cell 10 --extent 745400,4018900,746000,4019400";
    folder.succeeds(&format!("{part} -o plain.tif"));
    folder.succeeds(&format!("{part} --base base.tif -o part.tif"));
    let (plain, part) = (dem(&folder, "plain.tif"), dem(&folder, "part.tif"));
    assert_eq!((part.grid.cols, part.grid.rows), (60, 50));
    assert!(part.values.iter().all(|height| height.is_finite()));
    let mut kept = 0;
    for (k, height) in plain.values.iter().enumerate().filter(|(_, height)| !height.is_nan()) {
        let place = part.grid.place(plain.grid.center(k % plain.grid.cols, k / plain.grid.cols)).round();
        assert_eq!(*height, part.values[place.y as usize * part.grid.cols + place.x as usize]);
        kept += 1;
    }
    assert!(kept > 500);
}

#[test]
fn standard_errors_are_those_of_the_surface_alone() {
    let folder = prepared();
    folder.succeeds(&format!("{FRAMED} --uncertainty -o plain.tif"));
    folder.succeeds(&format!("{FRAMED} --uncertainty --base base.tif -o joined.tif"));
    let [plain, joined] = ["plain.tif", "joined.tif"].map(|n| read_standard_errors(&folder.path(n)).unwrap().unwrap());
    let is_same = |(a, b): (&f32, &f32)| a.to_bits() == b.to_bits() || (a.is_nan() && b.is_nan());
    assert!(plain.values.iter().zip(&joined.values).all(is_same));
    assert!(plain.values.iter().any(|error| error.is_finite()));
}

#[test]
fn a_base_that_does_not_fit_is_told() {
    let folder = prepared();
    write_changed(&folder, "high.tif", |dem| dem.values.iter_mut().for_each(|height| *height += 37.0));
    let said = folder.succeeds(&format!("{FRAMED} --base high.tif -o out.tif"));
    assert!(said.contains("high.tif lies") && said.contains("above the surface"), "{said}");
    assert!(said.contains("datum") && !said.contains("seem to be in feet"), "{said}");
    let said = folder.ends(&format!("{FRAMED} --base high.tif -o strict.tif --strict"), 1);
    assert!(said.contains("high.tif lies") && !folder.path("strict.tif").exists(), "{said}");

    // Feet that the file does not state.
    write_changed(&folder, "feet.tif", |dem| dem.values.iter_mut().for_each(|height| *height /= 0.3048));
    let said = folder.succeeds(&format!("{FRAMED} --base feet.tif -o out.tif"));
    assert!(said.contains("seem to be in feet"), "{said}");
    // Feet that it states are turned into metres.
    let params = RasterParams { unit: tokosen::base::ElevationUnit::Foot, ..RasterParams::default() };
    write_raster(&folder.path("stated.tif"), &dem(&folder, "truth.tif"), &params).unwrap();
    let said = folder.succeeds(&format!("{FRAMED} --base stated.tif -o out.tif"));
    assert!(!said.contains("lies"), "{said}");

    // Without a system it is taken to be in that of the contours.
    write_changed(&folder, "nameless.tif", |dem| dem.crs = None);
    let said = folder.succeeds(&format!("{FRAMED} --base nameless.tif -o nameless_out.tif"));
    assert!(said.contains("nameless.tif") && said.contains("taken to be in that of the contours"), "{said}");
    folder.succeeds(&format!("{FRAMED} --base truth.tif -o truth_out.tif"));
    assert_eq!(dem(&folder, "nameless_out.tif").values, dem(&folder, "truth_out.tif").values);
}

#[test]
fn a_base_that_gives_nothing_is_told() {
    let folder = prepared();
    write_changed(&folder, "elsewhere.tif", |dem| dem.grid.corner.x += 50_000.0);
    let said = folder.ends(&format!("{FRAMED} --base elsewhere.tif -o out.tif"), 1);
    assert!(said.contains("elsewhere.tif") && said.contains("do they overlap"), "{said}");

    // Heights in the frame only; heights far from it only.
    folder.succeeds(&format!("{FRAMED} -o plain.tif"));
    let plain = dem(&folder, "plain.tif");
    let holes = |dem: &mut Dem, is_hole: &dyn Fn(usize) -> bool| {
        (0..dem.values.len()).filter(|&k| is_hole(k)).for_each(|k| dem.values[k] = f32::NAN);
    };
    write_changed(&folder, "inner.tif", |dem| holes(dem, &|k| plain.values[k].is_nan()));
    let said = folder.succeeds(&format!("{FRAMED} --base inner.tif -o inner_out.tif"));
    assert!(said.contains("inner.tif has no height at the cells outside"), "{said}");
    let same = dem(&folder, "inner_out.tif");
    assert!(same.values.iter().zip(&plain.values).all(|(a, b)| a.to_bits() == b.to_bits() || a.is_nan() && b.is_nan()));
    let cols = plain.grid.cols;
    let rows = plain.values.chunks(cols).position(|row| row.iter().any(|h| !h.is_nan())).unwrap();
    write_changed(&folder, "far.tif", |dem| holes(dem, &|k| k / cols + 5 > rows));
    let said = folder.succeeds(&format!("{FRAMED} --base far.tif -o far_out.tif"));
    assert!(said.contains("far.tif has no heights along the border"), "{said}");
    assert_eq!(dem(&folder, "far_out.tif").values[..10], dem(&folder, "far.tif").values[..10]);
}

#[test]
fn wrong_use_is_told_before_the_work() {
    let folder = prepared();
    write_changed(&folder, "degrees.tif", |dem| {
        dem.crs = None;
        dem.grid.corner = glam::DVec2::new(-84.25, 36.3);
        dem.grid.cell = glam::DVec2::splat(0.0001);
    });
    fs::write(folder.path("empty.tif"), "").unwrap();
    for (arguments, status, words) in [
        ("--base missing.tif", 1, "missing.tif"),
        ("--base in.gpkg", 1, "not a height map"),
        ("--base empty.tif", 1, "empty"),
        ("--base degrees.tif", 1, "look like degrees"),
        ("--base base.tif --base-fade -1", 2, "--base-fade is -1, it must be 0 or more"),
        ("--base base.tif --base-fade nan", 2, "--base-fade is NaN"),
        ("--base-fade 10", 2, "--base <DEM>"),
    ] {
        let said = folder.ends(&format!("dem in.gpkg --cell 40 -o out.tif {arguments}"), status);
        assert!(said.contains(words), "{said}");
        assert!(!folder.path("out.tif").exists());
    }
    let said = folder.ends("dem in.gpkg --cell 40 --base base.tif -o base.tif", 2);
    assert!(said.contains("base.tif is an input"), "{said}");
}

#[test]
fn derive_takes_a_base_for_contours() {
    let folder = prepared();
    let said = folder.ends("derive base.tif --base truth.tif --slope slope.tif", 2);
    assert!(said.contains("--base applies to contours"), "{said}");
    folder.succeeds("derive in.gpkg --frame frame.geojson --like truth.tif --base base.tif --slope slope.tif");
    folder.succeeds(&format!("{FRAMED} --base base.tif -o joined.tif"));
    folder.succeeds("derive joined.tif --slope of_joined.tif");
    assert_eq!(dem(&folder, "slope.tif").values, dem(&folder, "of_joined.tif").values);
}
