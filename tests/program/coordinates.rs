//! Maps in any coordinates: degrees in and degrees out, feet, other files in other systems, height maps in degrees.

#![allow(clippy::unwrap_used, reason = "helpers of tests are tests too")]

use std::collections::{HashMap, HashSet};

use geo::{BoundingRect, Coord, MapCoords};
use glam::DVec2;
use tokosen::base::Grid;
use tokosen::clean::{CleanParams, clean};
use tokosen::contour::{Contour, ContourMap};
use tokosen::crs::{Crs, Transform};
use tokosen::io::raster::read_grid;
use tokosen::io::{ReadOptions, read_area, read_contours};
use tokosen::surface::{Given, SurfaceKind, SurfaceParams, build, heights, heights_on};

use crate::common;
use crate::maps::put;
use crate::running::{Running, part};

/// These tests.
struct Here;

type Folder = common::Folder<Here>;

impl Folder {
    /// Writes a map's lines, in the order and with the vertices they have.
    fn put(&self, name: &str, map: &ContourMap) {
        put(&self.path(name), map, "contours");
    }

    fn read(&self, name: &str) -> ContourMap {
        read_contours(&self.path(name), &ReadOptions::default()).unwrap().value
    }
}

/// The map in other coordinates, from the second system of the way to the first.
fn moved(map: &ContourMap, way: &Transform, to: &Crs) -> ContourMap {
    let place = |p: &DVec2| way.inverse(*p).unwrap();
    let line = |c: &Contour| Contour { points: c.points.iter().map(place).collect(), ..c.clone() };
    ContourMap { contours: map.contours.iter().map(line).collect(), crs: Some(to.clone()), ..ContourMap::default() }
}

/// A hill of rings around a place in plane coordinates, with levels every `step`.
fn hill(crs: u32, middle: DVec2, radius: f64, step: f64) -> ContourMap {
    let ring = |k: u32| {
        let radius = radius * (1.0 - 0.15 * f64::from(k));
        let place = |i: u32| middle + radius * DVec2::from_angle(f64::from(i % 72) * std::f64::consts::TAU / 72.0);
        Contour {
            elevation: step * f64::from(k + 1),
            points: (0..=72).map(place).collect(),
            feature: u64::from(k).into(),
        }
    };
    ContourMap { contours: (0..5).map(ring).collect(), crs: Some(Crs::from_epsg(crs)), ..ContourMap::default() }
}

fn bits(p: &DVec2) -> [u64; 2] {
    p.to_array().map(f64::to_bits)
}

fn all_bits(map: &ContourMap) -> HashSet<[u64; 2]> {
    map.contours.iter().flat_map(|c| c.points.iter().map(bits)).collect()
}

/// The greatest distance of a vertex of one map from the nearest vertex of the same elevation in the other, as far as
/// there is one within `reach`.
fn farthest(a: &ContourMap, b: &ContourMap, reach: f64) -> f64 {
    let cell = |p: DVec2| [(p.x / reach).floor() as i64, (p.y / reach).floor() as i64];
    let mut cells: HashMap<(u64, [i64; 2]), Vec<DVec2>> = HashMap::new();
    for c in &b.contours {
        for p in &c.points {
            cells.entry((c.elevation.to_bits(), cell(*p))).or_default().push(*p);
        }
    }
    let nearest = |z: f64, p: DVec2| {
        let [x, y] = cell(p);
        let around = (-1..=1).flat_map(|i| (-1..=1).map(move |j| [x + i, y + j]));
        let near = around.filter_map(|c| cells.get(&(z.to_bits(), c))).flatten();
        near.map(|q| q.distance(p)).fold(f64::INFINITY, f64::min)
    };
    a.contours.iter().flat_map(|c| c.points.iter().map(|p| nearest(c.elevation, *p))).fold(0.0, f64::max)
}

#[test]
fn degrees_give_the_lines_of_the_plane_with_every_input_vertex_as_it_was() {
    let folder = Folder::new();
    std::fs::write(folder.path("part.gpkg"), part()).unwrap();
    let plane = folder.read("part.gpkg");
    let utm = plane.crs.clone().unwrap();
    let way = Transform::between(&Crs::wgs84(), &utm).unwrap();
    let degrees = moved(&plane, &way, &Crs::wgs84());
    folder.put("degrees.geojson", &degrees);
    folder.put("plane.gpkg", &plane);
    let said = folder.succeeds("densify degrees.geojson -i 10 -o out.geojson --surface skeleton --snap 0");
    assert!(said.contains("WGS 84 (EPSG:4326), working CRS WGS 84 / UTM zone 16N (EPSG:32616)"), "{said}");
    folder.succeeds("densify plane.gpkg -i 10 -o plane.geojson --surface skeleton --snap 0");

    let out = folder.read("out.geojson");
    assert!(out.crs.as_ref().is_some_and(|crs| crs.epsg == Some(4326)));
    let there = all_bits(&out);
    let missing = all_bits(&degrees).iter().filter(|p| !there.contains(*p)).count();
    assert_eq!(missing, 0, "vertices of the input are not there bit for bit");

    let expected = folder.read("plane.geojson");
    let back = Transform::between(&utm, &Crs::wgs84()).unwrap();
    let out = moved(&out, &back, &utm);
    assert_eq!(out.contours.len(), expected.contours.len());
    for (a, b) in [(&out, &expected), (&expected, &out)] {
        let off = farthest(a, b, 0.01);
        assert!(off < 0.01, "{off}");
    }
}

#[test]
fn coordinates_of_no_known_system_are_named_by_a_flag() {
    let folder = Folder::new();
    let plane = hill(6676, DVec2::new(21_000.0, -70_000.0), 500.0, 10.0);
    let way = Transform::between(&Crs::from_epsg(6668), &Crs::from_epsg(6676)).unwrap();
    let degrees = moved(&plane, &way, &Crs::from_epsg(6668));
    folder.put("unnamed.shp", &ContourMap { crs: None, ..degrees.clone() });
    let (well, said) = folder.run("densify unnamed.shp -i 5 -o out.gpkg");
    assert!(!well && said.contains("--crs") && said.contains("degrees"), "{said}");
    let said = folder.succeeds("densify unnamed.shp -i 5 -o out.gpkg --crs EPSG:6668");
    assert!(said.contains("working CRS JGD2011 / Japan Plane Rectangular CS VIII (EPSG:6676)"), "{said}");
    assert!(!said.contains("unknown"), "{said}");
    let out = folder.read("out.gpkg");
    assert_eq!(out.crs.as_ref().and_then(|crs| crs.epsg), Some(6668));
    assert!(all_bits(&degrees).is_subset(&all_bits(&out)));

    folder.succeeds("densify unnamed.shp -i 5 -o other.gpkg --crs EPSG:6668 --to-crs EPSG:6676");
    let other = folder.read("other.gpkg");
    assert_eq!(other.crs.as_ref().and_then(|crs| crs.epsg), Some(6676));
    let far = other.contours.iter().flat_map(|c| &c.points).map(|p| p.distance(DVec2::new(21_000.0, -70_000.0)));
    assert!(far.fold(0.0, f64::max) < 501.0);
}

/// All pairs of numbers in a GeoJSON.
fn corners(value: &serde_json::Value) -> Vec<DVec2> {
    match value {
        serde_json::Value::Array(list) => match list[..] {
            [ref x, ref y] if x.is_number() => vec![DVec2::new(x.as_f64().unwrap(), y.as_f64().unwrap())],
            _ => list.iter().flat_map(corners).collect(),
        },
        serde_json::Value::Object(members) => members.values().flat_map(corners).collect(),
        _ => Vec::new(),
    }
}

#[test]
fn other_verbs_go_back_to_degrees_too() {
    let folder = Folder::new();
    let plane = hill(32632, DVec2::new(441_000.0, 6_445_000.0), 500.0, 10.0);
    let way = Transform::between(&Crs::wgs84(), &Crs::from_epsg(32632)).unwrap();
    let degrees = moved(&plane, &way, &Crs::wgs84());
    folder.put("hill.geojson", &degrees);
    folder.succeeds("regions hill.geojson -o regions.geojson");
    let text = std::fs::read_to_string(folder.path("regions.geojson")).unwrap();
    assert!(!text.contains("\"crs\""), "WGS 84 needs no name");
    let areas: serde_json::Value = serde_json::from_str(&text).unwrap();
    let corners: HashSet<[u64; 2]> = corners(&areas).into_iter().map(|p| bits(&p)).collect();
    let outer: HashSet<[u64; 2]> = degrees.contours[0].points.iter().map(bits).collect();
    assert!(outer.is_subset(&corners), "the outermost ring is the outline, bit for bit");
    folder.succeeds("skeleton hill.geojson -o lines.gpkg --curve-mesh --triangles");
    // A model stays in metres.
    let said = folder.succeeds("mesh hill.geojson -o model.ply");
    assert!(said.contains("working CRS ETRS89 / UTM zone 32N"), "{said}");
}

#[test]
fn feet_on_the_map_and_in_the_heights() {
    let folder = Folder::new();
    let feet = hill(2229, DVec2::new(6_501_118.85, 1_858_834.33), 1500.0, 40.0);
    folder.put("feet.gpkg", &feet);
    let said = folder.succeeds("densify feet.gpkg -i 5 -o out.gpkg --unit ft --dem dem.tif --cell 10");
    assert!(said.contains("working CRS NAD83 / UTM zone 11N (EPSG:26911)"), "{said}");
    assert!(said.contains("vertical interval 40 ft"), "{said}");
    let out = folder.read("out.gpkg");
    assert_eq!(out.crs.as_ref().and_then(|crs| crs.epsg), Some(2229));
    assert!(all_bits(&feet).is_subset(&all_bits(&out)));
    let levels: HashSet<u64> = out.contours.iter().map(|c| c.elevation.to_bits()).collect();
    assert!(levels.contains(&12.192f64.to_bits()) && levels.contains(&15f64.to_bits()), "{said}");
    let (grid, crs) = read_grid(&folder.path("dem.tif")).unwrap();
    assert_eq!(crs.and_then(|crs| crs.epsg), Some(26911));
    // 3000 feet are 914 metres.
    assert!((90..=94).contains(&grid.cols), "{}", grid.cols);
}

#[test]
fn frames_and_water_in_other_coordinates_are_brought_over() {
    let folder = Folder::new();
    let middle = DVec2::new(441_000.0, 6_445_000.0);
    folder.put("hill.gpkg", &hill(25832, middle, 500.0, 10.0));
    let way = Transform::between(&Crs::wgs84(), &Crs::from_epsg(25832)).unwrap();
    let square = [(-450.0, -450.0), (450.0, -450.0), (450.0, 450.0), (-450.0, 450.0), (-450.0, -450.0)];
    let square = geo::MultiPolygon::new(vec![geo::Polygon::new(geo::LineString::from(square.to_vec()), Vec::new())]);
    let plane = square.map_coords(|c| Coord { x: c.x + middle.x, y: c.y + middle.y });
    let degrees = plane.map_coords(|c| {
        let p = way.inverse(DVec2::new(c.x, c.y)).unwrap();
        Coord { x: p.x, y: p.y }
    });
    for (name, area, code) in [("plane", &plane, 25832), ("degrees", &degrees, 4326)] {
        let ring: Vec<[f64; 2]> = area.0[0].exterior().coords().map(|c| [c.x, c.y]).collect();
        let text = format!(
            r#"{{"type":"FeatureCollection","crs":{{"type":"name","properties":{{"name":"EPSG:{code}"}}}},"features":[
            {{"type":"Feature","properties":{{}},"geometry":{{"type":"Polygon","coordinates":[{ring:?}]}}}}]}}"#
        );
        std::fs::write(folder.path(&format!("{name}.geojson")), text).unwrap();
        folder.succeeds(&format!("regions hill.gpkg -o out_{name}.geojson --frame {name}.geojson"));
    }
    let bounds = |name: &str| {
        let area = read_area(&folder.path(&format!("out_{name}.geojson")), &ReadOptions::default()).unwrap().0;
        area.bounding_rect().unwrap()
    };
    let (a, b) = (bounds("plane"), bounds("degrees"));
    for (p, q) in [(a.min(), b.min()), (a.max(), b.max())] {
        // A piece of a parallel as long as that lies an inch off the straight line between its ends.
        assert!((p.x - q.x).hypot(p.y - q.y) < 0.03, "{p:?} {q:?}");
    }
    assert!((a.width() - 900.0).abs() < 0.01 && (b.width() - 900.0).abs() < 0.01, "the frame was taken");
}

#[test]
fn heights_on_a_grid_in_degrees_are_those_at_its_places() {
    let middle = DVec2::new(441_000.0, 6_445_000.0);
    let map = clean(hill(25832, middle, 500.0, 10.0), &CleanParams::default()).unwrap().value;
    let way = Transform::between(&Crs::from_epsg(4258), &Crs::from_epsg(25832)).unwrap();
    let corner = way.inverse(middle + DVec2::new(-520.0, 520.0)).unwrap();
    let grid = Grid { corner, cell: DVec2::new(0.0003, 0.0002), cols: 60, rows: 50 };
    for kind in [SurfaceKind::Linear, SurfaceKind::Skeleton, SurfaceKind::Spline] {
        let surface = build(map.clone(), &Given::default(), &SurfaceParams { kind, ..SurfaceParams::default() }, &())
            .unwrap()
            .value;
        let found = heights_on(&surface, &grid, &|p| way.forward(p), &());
        let mut valid = 0;
        for (i, value) in found.iter().enumerate() {
            let p = way.forward(grid.center(i % grid.cols, i / grid.cols)).unwrap();
            let one = Grid { corner: p + DVec2::new(-0.5, 0.5), cell: DVec2::ONE, cols: 1, rows: 1 };
            let expected = heights(&surface, &one, &()).values[0];
            assert_eq!(value.is_nan(), expected.is_nan(), "{kind:?} {p}");
            assert!(value.is_nan() || (value - expected).abs() < 1e-3, "{kind:?} {p}: {value} is not {expected}");
            valid += usize::from(!value.is_nan());
        }
        assert!((1000..found.len()).contains(&valid), "{kind:?}: {valid}");
        let one = rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap();
        let alone = one.install(|| heights_on(&surface, &grid, &|p| way.forward(p), &()));
        assert!(alone.iter().zip(&found).all(|(a, b)| a.to_bits() == b.to_bits()), "{kind:?}");
        assert!(heights_on(&surface, &grid, &|_| None, &()).iter().all(|z| z.is_nan()));
    }
}

#[test]
fn height_maps_in_degrees_and_on_the_grid_of_another_system() {
    let folder = Folder::new();
    folder.put("hill.gpkg", &hill(6676, DVec2::new(21_000.0, -70_000.0), 500.0, 10.0));
    folder.succeeds("dem hill.gpkg --cell-degrees 0.4s -o degrees.tif");
    let (grid, crs) = read_grid(&folder.path("degrees.tif")).unwrap();
    assert_eq!(crs.and_then(|crs| crs.epsg), Some(6668));
    assert!((grid.cell.x * 9000.0 - 1.0).abs() < 1e-9, "{}", grid.cell);
    let steps = grid.corner.x * 9000.0;
    assert!((steps - steps.round()).abs() < 1e-4, "the cells lie on multiples of their size: {steps}");
    // A kilometre is 81 cells of 12.3 m high.
    assert!((80..=84).contains(&grid.rows), "{}", grid.rows);
    folder.succeeds("dem hill.gpkg --like degrees.tif -o again.tif");
    let same = ["degrees.tif", "again.tif"].map(|name| std::fs::read(folder.path(name)).unwrap());
    assert!(same[0] == same[1]);
    let (well, said) = folder.run("dem hill.gpkg --cell-degrees 0 -o none.tif");
    assert!(!well && said.contains("--cell-degrees is 0"), "{said}");
}
