//! A part of a map: results end at its border, and are what the whole map gives there.

#![allow(clippy::unwrap_used, reason = "helpers of tests are tests too")]

use glam::DVec2;
use tokosen::contour::ContourMap;
use tokosen::io::raster::read_dem;
use tokosen::io::{ReadOptions, read_contours};
use tokosen::raster::Dem;

use crate::common::Folder;
use crate::running::{Running, folder_with, folder_with_part};

/// The extent of the part in the sample.
const EXTENT: [f64; 4] = [745_500.0, 4_018_200.0, 747_000.0, 4_019_400.0];

fn lines(folder: &Folder, name: &str) -> ContourMap {
    read_contours(&folder.path(name), &ReadOptions::default()).unwrap().value
}

fn heights(folder: &Folder, name: &str) -> Dem {
    read_dem(&folder.path(name)).unwrap().value.dem
}

fn is_in(p: DVec2) -> bool {
    let [west, south, east, north] = EXTENT;
    (west - 1e-6..=east + 1e-6).contains(&p.x) && (south - 1e-6..=north + 1e-6).contains(&p.y)
}

#[test]
fn heights_of_a_part_are_those_of_the_whole_map() {
    let folder = folder_with_part("in.gpkg");
    let given = EXTENT.map(|v| v.to_string()).join(",");
    folder.succeeds("dem in.gpkg --cell 20 -o whole.tif");
    folder.succeeds(&format!("dem in.gpkg --cell 20 --extent {given} -o part.tif"));
    let (whole, part) = (heights(&folder, "whole.tif"), heights(&folder, "part.tif"));
    assert_eq!((part.grid.cols, part.grid.rows), (75, 60));
    assert_eq!(part.grid.corner, DVec2::new(EXTENT[0], EXTENT[3]));
    let offset = ((part.grid.corner - whole.grid.corner) / DVec2::new(20.0, -20.0)).round();
    let (mut squares, mut most) = (0.0, 0.0f32);
    for (k, height) in part.values.iter().enumerate() {
        let (col, row) = (k % 75 + offset.x as usize, k / 75 + offset.y as usize);
        let of_whole = whole.values[row * whole.grid.cols + col];
        assert!(height.is_finite());
        squares += f64::from((height - of_whole).powi(2));
        most = most.max((height - of_whole).abs());
    }
    let rms = (squares / part.values.len() as f64).sqrt();
    assert!(rms < 0.02 && most < 0.2, "{rms} m, {most} m, of an interval of 20 m");
}

#[test]
fn lines_of_a_part_end_at_its_border_and_keep_their_vertices() {
    let folder = folder_with_part("in.gpkg");
    let given = EXTENT.map(|v| v.to_string()).join(",");
    folder.succeeds(&format!("densify in.gpkg -i 10 --extent {given} -o part.gpkg --preview part.png"));
    let (input, part) = (lines(&folder, "in.gpkg"), lines(&folder, "part.gpkg"));
    let mut on_border = 0;
    for line in &part.contours {
        assert!(line.points.iter().all(|&p| is_in(p)), "a line leaves the part");
        let ends = [line.points[0], line.points[line.points.len() - 1]];
        let at_edge = |p: DVec2| {
            let [west, south, east, north] = EXTENT;
            [p.x - west, p.x - east, p.y - south, p.y - north].iter().any(|d| d.abs() < 1e-3)
        };
        assert!(line.is_closed() || ends.iter().all(|&p| at_edge(p)), "a line ends inside the part");
        on_border += usize::from(!line.is_closed());
    }
    assert!(on_border > 10);
    // Every vertex of the input in the part is still there, bit for bit.
    let out: std::collections::HashSet<[u64; 2]> =
        part.contours.iter().flat_map(|c| &c.points).map(|p| [p.x.to_bits(), p.y.to_bits()]).collect();
    let inside = input.contours.iter().flat_map(|c| &c.points).filter(|&&p| is_in(p));
    let (mut kept, mut all) = (0, 0);
    for p in inside {
        all += 1;
        kept += usize::from(out.contains(&[p.x.to_bits(), p.y.to_bits()]));
    }
    assert_eq!(kept, all);
    assert!(all > 1000);
}

#[test]
fn a_ring_that_is_cut_open_marks_no_depression() {
    let folder = folder_with("fig5cd_three_branches_basin.geojson", "in.geojson");
    let marks = |name: &str| -> Vec<(bool, bool)> {
        let file: serde_json::Value = serde_json::from_slice(&std::fs::read(folder.path(name)).unwrap()).unwrap();
        let of = |feature: &serde_json::Value, name: &str| feature["properties"][name].as_bool().unwrap();
        let features = file["features"].as_array().unwrap().iter();
        features.map(|feature| (of(feature, "closed"), of(feature, "depression"))).collect()
    };
    folder.succeeds("densify in.geojson -i 5 -o whole.geojson");
    let input = lines(&folder, "in.geojson");
    let points = || input.contours.iter().flat_map(|line| &line.points);
    let [low, high] =
        [points().fold(DVec2::INFINITY, |m, p| m.min(*p)), points().fold(DVec2::NEG_INFINITY, |m, p| m.max(*p))];
    assert!(marks("whole.geojson").contains(&(true, true)), "the sample has a basin");
    let middle = low.midpoint(high);
    let extent = format!("{},{},{},{}", low.x, low.y, middle.x, high.y);
    folder.succeeds(&format!("densify in.geojson -i 5 --extent {extent} -o part.geojson"));
    let part = marks("part.geojson");
    assert!(part.iter().any(|(closed, _)| !closed) && part.iter().all(|(closed, mark)| *closed || !mark), "{part:?}");
}

#[test]
fn a_part_can_be_in_another_system_or_a_polygon() {
    let folder = folder_with_part("in.gpkg");
    let degrees = "-84.255,36.280,-84.244,36.286";
    let text = folder.succeeds(&format!("dem in.gpkg --cell 20 --extent {degrees} --extent-crs EPSG:4326 -o part.tif"));
    assert!(heights(&folder, "part.tif").values.iter().any(|v| v.is_finite()), "{text}");
    let ring = "[[745500,4018200],[747000,4018200],[745500,4019400],[745500,4018200]]";
    let polygon = format!(
        r#"{{"type":"FeatureCollection","crs":{{"type":"name","properties":{{"name":"urn:ogc:def:crs:EPSG::32616"}}}},
        "features":[{{"type":"Feature","properties":{{}},"geometry":{{"type":"Polygon","coordinates":[{ring}]}}}}]}}"#
    );
    std::fs::write(folder.path("part.geojson"), polygon).unwrap();
    folder.succeeds("dem in.gpkg --cell 20 --clip part.geojson -o part.tif");
    let dem = heights(&folder, "part.tif");
    let share = dem.values.iter().filter(|v| v.is_finite()).count() as f64 / dem.values.len() as f64;
    assert!((share - 0.5).abs() < 0.02, "{share}");
    folder.succeeds("densify in.gpkg -i 10 --clip part.geojson -o part.gpkg");
}

#[test]
fn a_part_that_is_not_there_is_told() {
    let folder = folder_with("caryville_20m.gpkg", "in.gpkg");
    let outside = folder.ends("dem in.gpkg --cell 20 --extent 0,0,10,10 -o part.tif", 1);
    assert!(outside.contains("outside of the contours"), "{outside}");
    // A corner of the box around the contours, outside of their hull.
    let corner = "754450,4024440,754480,4024480";
    let nothing = folder.ends(&format!("densify in.gpkg -i 10 --extent {corner} -o part.gpkg"), 1);
    assert!(nothing.contains("outside of the contours"), "{nothing}");
    for wrong in ["1,2,3", "10,0,0,10", "a,b,c,d"] {
        folder.ends(&format!("dem in.gpkg --cell 20 --extent {wrong} -o part.tif"), 2);
    }
    folder.ends("dem in.gpkg --cell 20 --extent 0,0,10,10 --clip x.gpkg -o part.tif", 2);
}
