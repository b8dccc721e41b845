//! Maps that do not fill their convex hull: stray lines and points far away, corridors, districts.

#![allow(clippy::unwrap_used, reason = "helpers of tests are tests too")]

use glam::DVec2;
use serde_json::{Value, json};
use tokosen::io::raster::read_dem;
use tokosen::raster::Dem;

use crate::common::Folder;
use crate::running::{Running, folder_with, folder_with_part};

/// The middle of the map, metres.
pub const MIDDLE: DVec2 = DVec2::new(600_000.0, 4_000_000.0);
/// Half the side of the map, metres.
const HALF: f64 = 500.0;

/// The height of the ground: a ridge and two hills.
pub fn ground(p: DVec2) -> f64 {
    let q = (p - MIDDLE) / 180.0;
    100.0 + 30.0 * (q.x * 0.9).sin() * (q.y * 1.1).cos() + 8.0 * (2.1 * q.x + 1.0).sin() + 4.0 * q.y
}

/// The contours of the ground where `is_kept`, as lines between cells of 10 m.
pub fn contours(interval: f64, is_kept: impl Fn(DVec2) -> bool) -> Vec<(f64, Vec<DVec2>)> {
    let side = 101;
    let place = |n: usize| MIDDLE + DVec2::new((n % side) as f64, (n / side) as f64) * 10.0 - HALF;
    let heights: Vec<f64> = (0..side * side).map(|n| ground(place(n))).collect();
    // The tracer's rows run from the north.
    let rows: Vec<f64> = (0..side).rev().flat_map(|row| heights[row * side..(row + 1) * side].to_vec()).collect();
    let lines = crate::common::contours_of(&rows, side, side, 10.0, interval, MIDDLE + DVec2::new(-HALF, HALF));
    let mut kept = Vec::new();
    for (level, points) in lines {
        for piece in points.split(|p| !is_kept(*p)).filter(|piece| piece.len() >= 2) {
            kept.push((level, piece.to_vec()));
        }
    }
    kept
}

pub fn feature(kind: &str, coordinates: Value, elevation: f64) -> Value {
    let geometry = json!({ "type": kind, "coordinates": coordinates });
    json!({ "type": "Feature", "properties": { "elev": elevation }, "geometry": geometry })
}

pub fn line(points: &[DVec2], elevation: f64) -> Value {
    feature("LineString", json!(points.iter().map(|p| [p.x, p.y]).collect::<Vec<_>>()), elevation)
}

pub fn write(folder: &Folder, name: &str, lines: &[(f64, Vec<DVec2>)], others: &[Value]) {
    let lines = lines.iter().map(|(level, points)| line(points, *level));
    let features: Vec<Value> = lines.chain(others.iter().cloned()).collect();
    let crs = json!({ "type": "name", "properties": { "name": "urn:ogc:def:crs:EPSG::32633" } });
    let map = json!({ "type": "FeatureCollection", "crs": crs, "features": features });
    std::fs::write(folder.path(name), map.to_string()).unwrap();
}

pub fn read(folder: &Folder, name: &str) -> String {
    std::fs::read_to_string(folder.path(name)).unwrap()
}

/// A raster of the map, whose cells tests compare.
pub fn write_raster(folder: &Folder) {
    let header = "ncols 100\nnrows 100\nxllcorner 599500\nyllcorner 3999500\ncellsize 10\nnodata_value -9999\n";
    let row = vec!["0"; 100].join(" ");
    std::fs::write(folder.path("like.asc"), header.to_owned() + &vec![row; 100].join("\n")).unwrap();
}

/// The root mean square error of a height map where `is_kept`, and the number of cells.
fn error(dem: &Dem, is_kept: impl Fn(DVec2) -> bool) -> (f64, usize) {
    let cells = dem.values.iter().enumerate().filter(|(_, z)| z.is_finite());
    let errors = cells.filter_map(|(n, z)| {
        let p = dem.grid.center(n % dem.grid.cols, n / dem.grid.cols);
        is_kept(p).then(|| (f64::from(*z) - ground(p)).powi(2))
    });
    let errors: Vec<f64> = errors.collect();
    ((errors.iter().sum::<f64>() / errors.len() as f64).sqrt(), errors.len())
}

pub fn heights(folder: &Folder, name: &str) -> Dem {
    read_dem(&folder.path(name)).unwrap().value.dem
}

#[test]
fn what_lies_far_away_does_not_coarsen_the_map() {
    let folder = Folder::new();
    write_raster(&folder);
    let lines = contours(5.0, |_| true);
    write(&folder, "plain.geojson", &lines, &[]);
    folder.succeeds("dem plain.geojson --like like.asc -o plain.tif");
    let (plain, cells) = error(&heights(&folder, "plain.tif"), |_| true);
    assert!(plain < 0.5 && cells > 9_000, "{plain} m at {cells} cells");

    let at = |x: f64, y: f64| MIDDLE + DVec2::new(x, y);
    let corner = |p: DVec2| line(&[p, p + DVec2::new(30.0, 10.0), p + DVec2::new(50.0, -20.0)], 80.0);
    let ring: Vec<DVec2> =
        (0..=40).map(|k| at(5e5, 5e5) + 90.0 * DVec2::from_angle(f64::from(k % 40) * 0.157)).collect();
    let far_copy = |by: f64| {
        lines
            .iter()
            .map(move |(z, points)| line(&points.iter().map(|p| *p + DVec2::new(by, 0.0)).collect::<Vec<_>>(), *z))
    };
    let strays: [(&str, Vec<Value>); 8] = [
        ("a short contour at 0, 0", vec![corner(DVec2::ZERO)]),
        ("a short contour 20 km away", vec![corner(at(2e4, 1e3))]),
        ("a straight contour 300 km away", vec![line(&[at(3e5, 0.0), at(3e5, 500.0)], 85.0)]),
        ("a ring far in the north-east", vec![line(&ring, 95.0)]),
        ("a spot height at 0, 0", vec![feature("Point", json!([0.0, 0.0]), 0.0)]),
        (
            "two spot heights apart",
            vec![feature("Point", json!([0.0, 0.0]), 0.0), feature("Point", json!([9e6, 0.0]), 9.0)],
        ),
        ("the map again, 25 km away", far_copy(25e3).collect()),
        ("the map again, 2000 km away", far_copy(2e6).collect()),
    ];
    for (what, others) in strays {
        write(&folder, "stray.geojson", &lines, &others);
        let said = folder.succeeds("dem stray.geojson --like like.asc -o stray.tif");
        let (found, of) = error(&heights(&folder, "stray.tif"), |_| true);
        assert!(
            found < 1.05 * plain && 200 * of >= 199 * cells,
            "{what}: {found} m at {of} cells, and {plain} m without"
        );
        assert!(said.contains("the contours fill") || said.contains("stand for no data"), "{what}: {said}");
    }
    std::fs::write(folder.path("zero.csv"), "x,y,z\n0,0,0\n").unwrap();
    let said = folder.succeeds("dem plain.geojson --points zero.csv --like like.asc -o stray.tif");
    let (found, of) = error(&heights(&folder, "stray.tif"), |_| true);
    assert!(found < 1.05 * plain && 200 * of >= 199 * cells, "{found} m at {of} cells");
    assert!(said.contains("all spot heights lie") && said.contains("look like degrees"), "{said}");
    assert!(said.contains("the spot height 0 m was left out"), "{said}");
}

/// The lines of a file that the program wrote: whether they are of the input, their level and points.
pub fn lines_of(folder: &Folder, name: &str) -> Vec<(bool, f64, Vec<DVec2>)> {
    let made: Value = serde_json::from_str(&read(folder, name)).unwrap();
    let features = made["features"].as_array().unwrap();
    let of = |feature: &Value| {
        let properties = &feature["properties"];
        let points = feature["geometry"]["coordinates"].as_array().unwrap();
        let place = |p: &Value| DVec2::new(p[0].as_f64().unwrap(), p[1].as_f64().unwrap());
        (properties["source"] == "input", properties["elev"].as_f64().unwrap(), points.iter().map(place).collect())
    };
    features.iter().map(of).collect()
}

#[test]
fn maps_far_from_each_other_get_new_lines_as_each_alone() {
    let folder = Folder::new();
    let lines = contours(5.0, |_| true);
    let far =
        |by: f64| lines.iter().map(move |(z, points)| (*z, points.iter().map(|p| *p + DVec2::new(by, 0.0)).collect()));
    write(&folder, "alone.geojson", &lines, &[]);
    write(&folder, "twice.geojson", &lines.iter().cloned().chain(far(2e6)).collect::<Vec<_>>(), &[]);
    let error_of = |input: &str| {
        let said = folder.succeeds(&format!("densify {input} -i 1 -o made.geojson --overwrite --uncertainty"));
        assert!(!said.contains("too wide for its number of vertices"), "{said}");
        let new = lines_of(&folder, "made.geojson").into_iter().filter(|(is_input, ..)| !is_input);
        let near = new.flat_map(|(_, z, points)| points.into_iter().map(move |p| (p, z)));
        let is_inner = |(p, _): &(DVec2, f64)| (*p - MIDDLE).abs().max_element() < 0.8 * HALF;
        let off: Vec<f64> = near.filter(is_inner).map(|(p, z)| (ground(p) - z).powi(2)).collect();
        ((off.iter().sum::<f64>() / off.len() as f64).sqrt(), off.len())
    };
    let (alone, of_alone) = error_of("alone.geojson");
    let (twice, of_twice) = error_of("twice.geojson");
    assert!(alone < 0.5 && of_alone > 1_000, "{alone} m at {of_alone} vertices");
    assert!(
        twice < 1.1 * alone && of_twice.abs_diff(of_alone) < of_alone / 20,
        "{twice} m at {of_twice}, {alone} m alone"
    );
}

#[test]
fn cells_that_are_too_small_name_the_far_line() {
    let folder = Folder::new();
    let far = line(&[DVec2::ZERO, DVec2::new(30.0, 10.0), DVec2::new(50.0, -20.0)], 80.0);
    write(&folder, "stray.geojson", &contours(5.0, |_| true), &[far]);
    let said = folder.ends("dem stray.geojson --cell 1 -o dem.tif", 2);
    assert!(said.contains("because lines (1) lie") && said.contains("at 0.000"), "{said}");
}

/// Whether a place lies in a corridor of 60 m that winds through the map.
fn in_corridor(p: DVec2) -> bool {
    let q = p - MIDDLE;
    let ring = (q.length() - 400.0).abs() < 30.0 && q.y > -300.0;
    ring || (q.x.abs() < 30.0 && q.y.abs() < 380.0)
}

#[test]
fn a_corridor_gets_a_frame_that_follows_it() {
    let folder = Folder::new();
    write_raster(&folder);
    write(&folder, "road.geojson", &contours(0.5, in_corridor), &[]);
    let said = folder.succeeds("dem road.geojson --like like.asc -o road.tif");
    assert!(said.contains("so the ground ends where the contours end"), "{said}");
    folder.succeeds("dem road.geojson --like like.asc --frame hull -o hull.tif");
    let (road, hull) = (heights(&folder, "road.tif"), heights(&folder, "hull.tif"));
    let count = |dem: &Dem| dem.values.iter().filter(|z| z.is_finite()).count();
    assert!(3 * count(&road) < count(&hull), "{} of {} cells", count(&road), count(&hull));
    let (rms, inside) = error(&road, in_corridor);
    assert!(10 * inside > 9 * error(&hull, in_corridor).1, "{inside} cells of the corridor");
    assert!(rms < 0.15, "{rms} m with contours every 0.5 m");
}

#[test]
fn a_district_is_judged_inside_its_border() {
    let folder = folder_with("caryville_20m.gpkg", "in.gpkg");
    let angle = |k: usize| k as f64 * std::f64::consts::TAU / 14.0;
    let radius = |k: usize| if k.is_multiple_of(2) { 4_200.0 } else { 1_500.0 };
    let centre = DVec2::new(749_250.0, 4_020_000.0);
    let star: Vec<[f64; 2]> =
        (0..=14).map(|k| (centre + radius(k % 14) * DVec2::from_angle(angle(k % 14))).to_array()).collect();
    write(&folder, "area.geojson", &[], &[feature("Polygon", json!([star]), 0.0)]);
    std::fs::write(folder.path("area.geojson"), read(&folder, "area.geojson").replace("32633", "32616")).unwrap();
    folder.succeeds("densify in.gpkg --levels 300 --clip area.geojson -o district.gpkg");
    let count = |arguments: &str| {
        let found: Value =
            serde_json::from_str(&folder.succeeds(&format!("check district.gpkg --json {arguments}"))).unwrap();
        (found["counts"]["error"].as_u64().unwrap(), found["codes"]["hull-beyond-map"].as_u64().unwrap_or(0))
    };
    let (without, told) = count("");
    assert!(without > 5 && told == 1, "a star leaves much of its hull empty: {without} errors, {told}");
    assert_eq!(count("--frame area.geojson"), (0, 0));
    let said = folder.succeeds("check district.gpkg --frame area.geojson --repair all -o fixed.gpkg");
    assert!(!said.contains("joined"), "{said}");
    let said = folder.succeeds("dem district.gpkg --frame area.geojson --repair all --cell 50 -o dem.tif");
    assert!(!said.contains("joined"), "{said}");
}

#[test]
fn areas_lines_and_models_of_a_part_end_at_its_border() {
    let folder = folder_with_part("in.gpkg");
    let part = "--extent 746000,4018000,747500,4019500";
    folder.succeeds(&format!("regions in.gpkg {part} -o regions.geojson"));
    folder.succeeds(&format!("skeleton in.gpkg {part} -o lines.geojson --triangles --curve-mesh"));
    let said = folder.succeeds(&format!("mesh in.gpkg {part} -o model.ply --base 100"));
    assert!(said.contains("1500.00 x 1500.00"), "{said}");
    let is_in = |p: &Value| {
        let [x, y] = [p[0].as_f64().unwrap(), p[1].as_f64().unwrap()];
        (745_999.999..747_500.001).contains(&x) && (4_017_999.999..4_019_500.001).contains(&y)
    };
    let mut area = 0.0;
    let regions: Value = serde_json::from_str(&read(&folder, "regions.geojson")).unwrap();
    for region in regions["features"].as_array().unwrap() {
        for ring in region["geometry"]["coordinates"].as_array().unwrap() {
            let ring = ring.as_array().unwrap();
            assert!(ring.iter().all(is_in));
            let at =
                |k: usize| DVec2::new(ring[k][0].as_f64().unwrap() - 746e3, ring[k][1].as_f64().unwrap() - 4_018e3);
            area += (1..ring.len()).map(|k| at(k - 1).perp_dot(at(k)) / 2.0).sum::<f64>();
        }
    }
    assert!((area - 1500.0 * 1500.0).abs() < 1.0, "{area}");
    let lines: Value = serde_json::from_str(&read(&folder, "lines_skeleton.geojson")).unwrap();
    let lines = lines["features"].as_array().unwrap();
    assert!(!lines.is_empty());
    assert!(lines.iter().all(|line| line["geometry"]["coordinates"].as_array().unwrap().iter().all(is_in)));
}
