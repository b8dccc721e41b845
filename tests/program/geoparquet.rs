//! GeoParquet: the same map as a GeoPackage, and a part of it by a box after the file.

#![allow(clippy::unwrap_used, reason = "helpers of tests are tests too")]

use tokosen::contour::ContourMap;
use tokosen::io::{ReadOptions, VectorSource, read_contours};

use crate::common::Folder;
use crate::running::{Running, folder_with_part};

/// Status of wrong usage.
const USAGE: i32 = 2;
/// Status of work that failed.
const FAILED: i32 = 1;

/// The contours of a file, in an order of their own.
fn contours(folder: &Folder, name: &str) -> ContourMap {
    let source = VectorSource::from_text(&folder.path(name).display().to_string()).unwrap();
    let mut map = read_contours(&source.path, &source.reading()).unwrap().value;
    map.contours.sort_by(|a, b| {
        let key =
            |points: &[glam::DVec2]| points.iter().flat_map(|p| p.to_array()).map(f64::to_bits).collect::<Vec<_>>();
        a.elevation.total_cmp(&b.elevation).then_with(|| key(&a.points).cmp(&key(&b.points)))
    });
    map
}

/// Elevation and vertices of each line.
fn lines(map: &ContourMap) -> Vec<(f64, Vec<glam::DVec2>)> {
    map.contours.iter().map(|line| (line.elevation, line.points.clone())).collect()
}

#[test]
fn it_holds_what_a_geopackage_holds() {
    let folder = folder_with_part("in.gpkg");
    folder.succeeds("densify in.gpkg -i 10 -o a.gpkg");
    folder.succeeds("densify in.gpkg -i 10 -o a.parquet");
    folder.succeeds("densify in.gpkg -i 10 -o a.parquet --threads 1");
    let [one, other] = ["a.gpkg", "a.parquet"].map(|name| contours(&folder, name));
    assert!(lines(&one) == lines(&other) && one.contours.len() > 50);
    assert_eq!(other.crs.and_then(|crs| crs.epsg), Some(32616));
    folder.succeeds("check in.gpkg -o points.parquet");
    folder.succeeds("regions in.gpkg -o areas.parquet");
    folder.succeeds("densify a.parquet -i 5 -o again.gpkg");
}

#[test]
fn a_box_after_a_file_leaves_out_what_lies_elsewhere() {
    let folder = folder_with_part("in.gpkg");
    folder.succeeds("densify in.gpkg -i 5 -o a.parquet");
    folder.succeeds("densify in.gpkg -i 5 -o a.gpkg");
    folder.succeeds("densify in.gpkg -i 5 -o a.fgb");
    let sides = "745000,4019000,746000,4020000";
    let all = contours(&folder, "a.gpkg");
    let meets = |(_, points): &(f64, Vec<glam::DVec2>)| {
        let [low, high] = points.iter().fold([points[0]; 2], |[low, high], p| [low.min(*p), high.max(*p)]);
        low.x <= 746_000.0 && high.x >= 745_000.0 && low.y <= 4_020_000.0 && high.y >= 4_019_000.0
    };
    let expected: Vec<_> = lines(&all).into_iter().filter(meets).collect();
    assert!(expected.len() > 5 && expected.len() < all.contours.len());
    for name in ["a.gpkg", "a.parquet", "a.fgb"] {
        assert!(lines(&contours(&folder, &format!("{name}|bbox={sides}"))) == expected, "{name}");
    }
    let said = folder.ends("check a.parquet|bbox=0,0,1,1", FAILED);
    assert!(said.contains("no feature meets the box"), "{said}");
    let said = folder.ends("check a.parquet|bbox=0,0,1", USAGE);
    assert!(said.contains("XMIN,YMIN,XMAX,YMAX"), "{said}");
}

#[test]
fn a_system_that_it_cannot_name_is_refused() {
    let folder = folder_with_part("in.gpkg");
    // A projection that is not written as PROJJSON: polar stereographic.
    let said = folder.ends("densify in.gpkg -i 20 --to-crs EPSG:3413 -o a.parquet", FAILED);
    assert!(said.contains("a.parquet") && said.contains("write a GeoPackage"), "{said}");
    let reread = read_contours(&folder.path("a.parquet"), &ReadOptions::default());
    assert!(reread.is_err(), "nothing was written");
}
