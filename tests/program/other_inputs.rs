//! Inputs in formats that are only read: they give the same results as those that are written.

#![allow(clippy::unwrap_used, reason = "helpers of tests are tests too")]

use std::fs;
use std::process::Output;

use assert_cmd::cargo::cargo_bin_cmd;
use tokosen::io::raster::read_dem;

use crate::common;

/// These tests.
struct Here;

type Folder = common::Folder<Here>;

impl Folder {
    fn put(&self, name: &str, text: &str) -> &Self {
        fs::write(self.path(name), text).unwrap();
        self
    }

    fn run(&self, arguments: &str) -> Output {
        let words: Vec<&str> = arguments.split_whitespace().collect();
        cargo_bin_cmd!("tokosen").current_dir(self.0.path()).args(&words).output().unwrap()
    }

    fn succeeds(&self, arguments: &str) -> String {
        let output = self.run(arguments);
        let told = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!(output.status.code(), Some(0), "{arguments}: {told}");
        told + &String::from_utf8_lossy(&output.stdout)
    }

    fn fails(&self, arguments: &str, words: &str) {
        let output = self.run(arguments);
        let told = String::from_utf8_lossy(&output.stderr);
        assert!(output.status.code() != Some(0) && told.contains(words), "{arguments}: no {words:?} in {told}");
    }
}

/// Three square rings around a top, with their elevations.
fn rings() -> [(f64, Vec<[f64; 2]>); 3] {
    [(10.0, 90.0), (20.0, 60.0), (30.0, 30.0)].map(|(elevation, half)| {
        let corners = [[-half, -half], [half, -half], [half, half], [-half, half], [-half, -half]];
        (elevation, corners.map(|[x, y]| [500_000.0 + x, 5_000_000.0 + y]).to_vec())
    })
}

fn text(points: &[[f64; 2]], between: &str, after: &str) -> String {
    points.iter().map(|[x, y]| format!("{x}{between}{y}")).collect::<Vec<_>>().join(after)
}

#[test]
fn contours_in_every_format_give_the_same_ground() {
    let folder = Folder::new();
    let each = |make: &dyn Fn(f64, &[[f64; 2]]) -> String| {
        rings().iter().map(|(z, points)| make(*z, points)).collect::<String>()
    };
    let feature = |z: f64, points: &[[f64; 2]]| {
        format!(
            "{{\"type\":\"Feature\",\"properties\":{{\"elev\":{z}}},\"geometry\":{{\"type\":\"LineString\",\"coordinates\":[[{}]]}}}}",
            text(points, ",", "],[")
        )
    };
    folder.put("a.geojsonl", &each(&|z, points| feature(z, points) + "\n"));
    folder.put(
        "a.csv",
        &format!("WKT,elev\n{}", each(&|z, points| format!("\"LINESTRING ({})\",{z}\n", text(points, " ", ",")))),
    );
    let member = |z: f64, points: &[[f64; 2]]| {
        let list = text(points, " ", " ");
        format!(
            "<member><C><elev>{z}</elev><g><LineString srsName=\"urn:ogc:def:crs:EPSG::25832\"><posList>{list}</posList></LineString></g></C></member>"
        )
    };
    folder.put("a.gml", &format!("<FeatureCollection>{}</FeatureCollection>", each(&member)));
    let block = each(&|z, points| {
        let vertices: String = points.iter().map(|[x, y]| format!("10\n{x}\n20\n{y}\n")).collect();
        format!("0\nLWPOLYLINE\n8\nc\n38\n{z}\n{vertices}")
    });
    folder.put("a.dxf", &format!("0\nSECTION\n2\nBLOCKS\n0\nBLOCK\n2\nB\n10\n0\n20\n0\n{block}0\nENDBLK\n0\nENDSEC\n0\nSECTION\n2\nENTITIES\n0\nINSERT\n2\nB\n0\nENDSEC\n0\nEOF\n"));
    for extension in ["geojsonl", "csv", "gml", "dxf"] {
        let crs = if extension == "gml" { "" } else { "--crs EPSG:25832" };
        folder.succeeds(&format!("dem a.{extension} --cell 10 -o {extension}.tif {crs}"));
    }
    let wanted = read_dem(&folder.path("geojsonl.tif")).unwrap().value.dem;
    assert_eq!(wanted.crs.as_ref().and_then(|crs| crs.epsg), Some(25832));
    for extension in ["csv", "gml", "dxf"] {
        let dem = read_dem(&folder.path(&format!("{extension}.tif"))).unwrap().value.dem;
        assert_eq!((dem.grid, dem.crs), (wanted.grid, wanted.crs.clone()), "{extension}");
        let same = |(a, b): (&f32, &f32)| a.to_bits() == b.to_bits() || a.is_nan() && b.is_nan();
        assert!(dem.values.iter().zip(&wanted.values).all(same), "{extension}");
    }
}

#[test]
fn an_xyz_raster_is_a_height_map() {
    let folder = Folder::new();
    let height = |col: usize, row: usize| 100.0 + 2.5 * col as f64 + row as f64;
    let cells = || (0..9).flat_map(|row| (0..12).map(move |col| (col, row)));
    let lines: String =
        cells().map(|(col, row)| format!("{} {} {}\n", 1005 + 10 * col, 2085 - 10 * row, height(col, row))).collect();
    folder.put("a.xyz", &lines);
    let rows: String =
        (0..9).map(|row| (0..12).map(|col| format!("{} ", height(col, row))).collect::<String>() + "\n").collect();
    folder.put("b.asc", &format!("ncols 12\nnrows 9\nxllcorner 1000\nyllcorner 2000\ncellsize 10\n{rows}"));
    let told = folder.succeeds("compare a.xyz b.asc --json");
    let found: serde_json::Value = serde_json::from_str(&told[told.find('{').unwrap()..]).unwrap();
    assert_eq!((&found["overall"]["cells"], &found["overall"]["rmse"]), (&108.into(), &0.0.into()), "{found}");
    for (from, to) in [("a.xyz", "a"), ("b.asc", "b")] {
        folder.succeeds(&format!("contour {from} -i 5 --crs EPSG:25832 -o {to}.geojson"));
        folder.succeeds(&format!("derive {from} --slope {to}.tif"));
    }
    let read = |name: &str| fs::read(folder.path(name)).unwrap();
    assert!(read("a.geojson") == read("b.geojson") && read("a.tif") == read("b.tif"));
}

#[test]
fn what_is_not_read_says_how_to_convert_it() {
    let folder = Folder::new();
    folder.put("a.tab", "x").put("a.bil", "x");
    folder.fails("densify a.tab -i 5 -o o.gpkg", "'ogr2ogr out.gpkg FILE'");
    folder.fails("derive a.bil --slope s.tif", "'gdal_translate FILE out.tif'");
    let line = "0\nLINE\n8\n125\n10\n0\n20\n0\n11\n9\n21\n0\n";
    folder.put("a.dxf", &format!("0\nSECTION\n2\nENTITIES\n{line}0\nENDSEC\n0\nEOF\n"));
    folder.fails("densify a.dxf -i 5 -o o.gpkg", "-a layer takes the names of the layers");
}
