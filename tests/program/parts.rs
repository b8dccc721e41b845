//! A part of a map: results end at its border, and are what the whole map gives there.

#![allow(clippy::unwrap_used, reason = "helpers of tests are tests too")]

use std::path::Path;

use glam::DVec2;
use tokosen::contour::ContourMap;
use tokosen::dem::Dem;
use tokosen::io::raster::read_dem;
use tokosen::io::{ReadOptions, read_contours};

use crate::common::Folder;
use crate::running::{run, said};

/// The extent of the part in the sample.
const EXTENT: [f64; 4] = [745_000.0, 4_022_000.0, 746_500.0, 4_023_200.0];

fn done(folder: &Folder, line: &str) -> String {
    let output = run(folder.0.path(), line);
    let text = String::from_utf8_lossy(&output.stdout).into_owned() + &said(&output);
    assert!(output.status.success(), "{line}: {text}");
    text
}

fn failed(folder: &Folder, line: &str, code: i32) -> String {
    let output = run(folder.0.path(), line);
    assert_eq!(output.status.code(), Some(code), "{line}: {}", said(&output));
    said(&output)
}

/// A folder with the sample in it, in.gpkg.
fn sample() -> Folder {
    let folder = Folder::new();
    let sample = Path::new(env!("CARGO_MANIFEST_DIR")).join("samples/caryville_20m.gpkg");
    std::fs::copy(sample, folder.path("in.gpkg")).unwrap();
    folder
}

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
    let folder = sample();
    let given = EXTENT.map(|v| v.to_string()).join(",");
    done(&folder, "dem in.gpkg --cell 20 -o whole.tif");
    done(&folder, &format!("dem in.gpkg --cell 20 --extent {given} -o part.tif"));
    let (whole, part) = (heights(&folder, "whole.tif"), heights(&folder, "part.tif"));
    assert_eq!((part.grid.cols, part.grid.rows), (75, 60));
    assert_eq!(part.grid.corner, DVec2::new(EXTENT[0], EXTENT[3]));
    let offset = ((part.grid.corner - whole.grid.corner) / DVec2::new(20.0, -20.0)).round();
    let mut squares = 0.0;
    for (k, height) in part.values.iter().enumerate() {
        let (col, row) = (k % 75 + offset.x as usize, k / 75 + offset.y as usize);
        let of_whole = whole.values[row * whole.grid.cols + col];
        assert!(height.is_finite());
        squares += f64::from((height - of_whole).powi(2));
    }
    let rms = (squares / part.values.len() as f64).sqrt();
    assert!(rms < 0.25, "{rms} m, of an interval of 20 m");
}

#[test]
fn lines_of_a_part_end_at_its_border_and_keep_their_vertices() {
    let folder = sample();
    let given = EXTENT.map(|v| v.to_string()).join(",");
    done(&folder, &format!("densify in.gpkg -i 10 --extent {given} -o part.gpkg --preview part.png"));
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
fn a_part_can_be_in_another_system_or_a_polygon() {
    let folder = sample();
    let degrees = "-84.268,36.314,-84.257,36.320";
    let text = done(&folder, &format!("dem in.gpkg --cell 20 --extent {degrees} --extent-crs EPSG:4326 -o part.tif"));
    assert!(heights(&folder, "part.tif").values.iter().any(|v| v.is_finite()), "{text}");
    let ring = "[[745000,4022000],[746500,4022000],[745000,4023200],[745000,4022000]]";
    let polygon = format!(
        r#"{{"type":"FeatureCollection","crs":{{"type":"name","properties":{{"name":"urn:ogc:def:crs:EPSG::32616"}}}},
        "features":[{{"type":"Feature","properties":{{}},"geometry":{{"type":"Polygon","coordinates":[{ring}]}}}}]}}"#
    );
    std::fs::write(folder.path("part.geojson"), polygon).unwrap();
    done(&folder, "dem in.gpkg --cell 20 --clip part.geojson -o part.tif");
    let dem = heights(&folder, "part.tif");
    let share = dem.values.iter().filter(|v| v.is_finite()).count() as f64 / dem.values.len() as f64;
    assert!((share - 0.5).abs() < 0.02, "{share}");
    done(&folder, "densify in.gpkg -i 10 --clip part.geojson -o part.gpkg");
}

#[test]
fn a_part_that_is_not_there_is_told() {
    let folder = sample();
    let outside = failed(&folder, "dem in.gpkg --cell 20 --extent 0,0,10,10 -o part.tif", 1);
    assert!(outside.contains("outside of the contours"), "{outside}");
    for wrong in ["1,2,3", "10,0,0,10", "a,b,c,d"] {
        failed(&folder, &format!("dem in.gpkg --cell 20 --extent {wrong} -o part.tif"), 2);
    }
    failed(&folder, "dem in.gpkg --cell 20 --extent 0,0,10,10 --clip x.gpkg -o part.tif", 2);
}
