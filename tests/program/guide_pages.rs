//! The commands of pages of the guide, and the files that they read.

#![allow(clippy::unwrap_used, reason = "helpers of tests are tests too")]

use std::path::Path;

use glam::DVec2;
use tokosen::base::Grid;
use tokosen::contour::{Contour, ContourMap};
use tokosen::crs::Crs;
use tokosen::io::layer::{Geometry, Layer, Row, Shape};
use tokosen::io::raster::{read_dem, write_dem};
use tokosen::io::{StagedOutput, write_layers};
use tokosen::raster::Dem;

use crate::common::Folder;
use crate::maps::put;
use crate::running::{folder_with_part, said, tokosen};

/// The commands of a page, in the order of the page.
pub fn commands(page: &'static str) -> Vec<&'static str> {
    let mut blocks = page.split("```");
    let mut found = Vec::new();
    while let (Some(_), Some(block)) = (blocks.next(), blocks.next()) {
        found.extend(block.strip_prefix("sh\n").unwrap_or_default().lines());
    }
    found
}

/// The words of a command. What stands in single quotes is one word.
pub fn words(command: &str) -> Vec<String> {
    let parts = command.split('\'').enumerate();
    parts
        .flat_map(|(k, part)| match k % 2 {
            0 => part.split_whitespace().map(str::to_owned).collect::<Vec<_>>(),
            _ => vec![part.to_owned()],
        })
        .collect()
}

/// Runs a command, which must succeed; gives what it said on both streams.
pub fn run(folder: &Folder, command: &str) -> String {
    let words = words(command);
    assert_eq!(words[0], "tokosen");
    let output = tokosen().current_dir(folder.0.path()).args(&words[1..]).output().unwrap();
    assert!(output.status.success(), "{command}: {}", said(&output));
    String::from_utf8_lossy(&output.stdout).into_owned() + &said(&output)
}

/// A square around a place.
fn square(middle: DVec2, half: f64) -> Vec<DVec2> {
    [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0), (-1.0, -1.0)].map(|p| middle + half * DVec2::from(p)).to_vec()
}

/// The cells of a height map from a corner in the north-west on, as many as cover the part of the sample.
fn cut(dem: &Dem, corner: [f64; 2]) -> Dem {
    let (first, size) = (dem.grid.place(DVec2::from(corner)).round(), [130, 115]);
    let [col, row] = first.to_array().map(|at| at as usize);
    let corner = dem.grid.corner + DVec2::new(1.0, -1.0) * dem.grid.cell * first;
    let values = (row..row + size[1]).flat_map(|row| &dem.values[row * dem.grid.cols + col..][..size[0]]);
    let grid = Grid { corner, cols: size[0], rows: size[1], ..dem.grid };
    Dem { grid, values: values.copied().collect(), ..dem.clone() }
}

/// The files that commands of the guide read, made of a part of the sample.
pub fn inputs() -> Folder {
    let folder = folder_with_part("contours.gpkg");
    let samples = Path::new(env!("CARGO_MANIFEST_DIR")).join("samples");
    let truth = cut(&read_dem(&samples.join("caryville_20m_truth.tif")).unwrap().value.dem, [744_800.0, 4_020_700.0]);
    write_dem(&folder.path("published_dem.tif"), &truth).unwrap();
    std::fs::create_dir(folder.path("sheets")).unwrap();
    for command in [
        "tokosen densify contours.gpkg -i 20 -o degrees.gpkg --to-crs EPSG:4326",
        "tokosen densify contours.gpkg -i 20 -o drawing.dxf",
        "tokosen densify contours.gpkg -i 100 --to-unit ft -o feet.gpkg",
        "tokosen densify contours.gpkg -i 20 --extent 744000,4017000,747000,4023000 -o sheets/west.shp",
        "tokosen densify contours.gpkg -i 20 --extent 747000,4017000,751000,4023000 -o sheets/east.shp",
    ] {
        run(&folder, command);
    }
    for (name, middle) in [("quarry", [745_800.0, 4_018_200.0]), ("wrong_lines", [747_800.0, 4_019_900.0])] {
        let ring = square(DVec2::from(middle), 150.0).iter().map(|p| p.to_array()).collect::<Vec<_>>();
        let text = format!(
            r#"{{"type":"FeatureCollection","crs":{{"type":"name","properties":{{"name":"EPSG:32616"}}}},
            "features":[{{"type":"Feature","properties":{{}},"geometry":{{"type":"Polygon","coordinates":[{ring:?}]}}}}]}}"#
        );
        std::fs::write(folder.path(&format!("{name}.geojson")), text).unwrap();
    }
    let ring = "[[745500,4018000],[748000,4018500],[746500,4020000],[745500,4018000]]";
    let district = format!(
        r#"{{"type":"FeatureCollection","crs":{{"type":"name","properties":{{"name":"urn:ogc:def:crs:EPSG::32616"}}}},
        "features":[{{"type":"Feature","properties":{{}},"geometry":{{"type":"Polygon","coordinates":[{ring}]}}}}]}}"#
    );
    std::fs::write(folder.path("district.geojson"), district).unwrap();

    let road = r#"{"type":"FeatureCollection","crs":{"type":"name","properties":{"name":"EPSG:32616"}},"features":[{"type":"Feature",
        "properties":{},"geometry":{"type":"LineString","coordinates":[[745500,4018000],[747500,4019000],[748000,4020300]]}}]}"#;
    std::fs::write(folder.path("road.geojson"), road).unwrap();

    let area = |middle: DVec2| Row { shape: Shape::Area(vec![square(middle, 40.0)]), cells: Vec::new() };
    let layer = |name, middle| Layer { name, geometry: Geometry::Areas, columns: &[], rows: vec![area(middle)] };
    let layers =
        [layer("lakes", DVec2::new(748_000.0, 4_019_000.0)), layer("buildings", DVec2::new(747_000.0, 4_020_000.0))];
    let staged = StagedOutput::create(&folder.path("base_map.gpkg")).unwrap();
    write_layers(&staged, &layers, Some(&Crs::from_epsg(32616))).unwrap();
    staged.commit().unwrap();

    // A coast with hills behind it, and an islet before it.
    let origin = DVec2::new(700_000.0, 4_000_000.0);
    let line = |elevation: f64, points: Vec<DVec2>| Contour { elevation, points, feature: 0.into() };
    let coast = |k: u32| {
        let at = |i: u32| origin + DVec2::new(10.0 * f64::from(i), 50.0 * f64::from(k) + 15.0 * f64::from(i).sin());
        line(10.0 * f64::from(k), (0..=100).map(at).collect())
    };
    let islet = line(0.0, square(origin + DVec2::new(500.0, -400.0), 20.0));
    let contours = (0..6).map(coast).chain([islet]).collect();
    let map = ContourMap { contours, crs: Some(Crs::from_epsg(32616)), ..ContourMap::default() };
    put(&folder.path("coast.gpkg"), &map, "contours");

    let mut spots = "x,y,z\n".to_owned();
    for share in [3, 4, 5] {
        let (col, row) = (truth.grid.cols * share / 10, truth.grid.rows * share / 10);
        let p = truth.grid.center(col, row);
        spots.push_str(&format!("{},{},{}\n", p.x, p.y, truth.values[row * truth.grid.cols + col]));
    }
    std::fs::write(folder.path("spots.csv"), spots).unwrap();
    folder
}
