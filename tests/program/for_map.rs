//! Contours for a map: supplementary contours, the rules of a scale.

#![allow(clippy::unwrap_used, reason = "helpers of tests are tests too")]

use std::collections::{BTreeMap, BTreeSet, HashSet};

use glam::DVec2;
use serde_json::Value;
use tokosen::cartography::{CLOSEST, SMALLEST_RING};

use crate::common::Course;
use crate::common::Folder;
use crate::common::crossings;
use crate::guide_pages::{commands, inputs, run};
use crate::running::{Running, folder_with_part};

/// A line of a GeoJSON.
struct Line {
    kind: String,
    source: String,
    elevation: f64,
    points: Vec<DVec2>,
}

impl Line {
    fn length(&self) -> f64 {
        self.points.windows(2).map(|pair| pair[0].distance(pair[1])).sum()
    }

    fn is_ring(&self) -> bool {
        self.points.first() == self.points.last()
    }

    fn bits(&self) -> Vec<[u64; 2]> {
        self.points.iter().map(|p| p.to_array().map(f64::to_bits)).collect()
    }
}

fn lines(folder: &Folder, name: &str) -> Vec<Line> {
    let text = std::fs::read_to_string(folder.path(name)).unwrap();
    let all: Value = serde_json::from_str(&text).unwrap();
    let line = |feature: &Value| {
        let text = |name: &str| feature["properties"][name].as_str().unwrap_or_default().to_owned();
        let points = feature["geometry"]["coordinates"].as_array().unwrap();
        let points = points.iter().map(|p| DVec2::new(p[0].as_f64().unwrap(), p[1].as_f64().unwrap())).collect();
        let elevation = feature["properties"]["elev"].as_f64().unwrap();
        Line { kind: text("kind"), source: text("source"), elevation, points }
    };
    all["features"].as_array().unwrap().iter().map(line).collect()
}

fn assert_nothing_crosses(lines: &[Line]) {
    let all: Vec<(f64, Vec<DVec2>)> = lines.iter().map(|line| (line.elevation, line.points.clone())).collect();
    assert_eq!(crossings(&all), [""; 0]);
}

#[test]
fn supplementary_contours_are_pieces_where_the_ground_is_flat() {
    let folder = folder_with_part("in.gpkg");
    let make = "densify in.gpkg -i 20 --supplementary 10,5 --supplementary-spacing 150 -o";
    let said = folder.succeeds(&format!("{make} map.geojson"));
    assert!(said.contains("supplementary contours at half of the interval") && said.contains("150 m apart"), "{said}");
    folder.succeeds("densify in.gpkg -i 5 -o all.geojson");
    let (map, all) = (lines(&folder, "map.geojson"), lines(&folder, "all.geojson"));
    let mut kinds: BTreeMap<&str, usize> = BTreeMap::new();
    for line in &map {
        *kinds.entry(line.kind.as_str()).or_default() += 1;
        let steps = line.elevation / 5.0;
        let expected = match line.kind.as_str() {
            "index" => steps % 20.0 == 0.0,
            "intermediate" => steps % 4.0 == 0.0 && steps % 20.0 != 0.0,
            "supplementary" => steps % 4.0 == 2.0,
            "supplementary_quarter" => steps % 2.0 == 1.0,
            other => panic!("{other:?}"),
        };
        assert!(expected, "{} at {}", line.kind, line.elevation);
    }
    assert_eq!(kinds.len(), 4, "{kinds:?}");
    assert_nothing_crosses(&map);

    // Contours of the input are there bit for bit, and supplementary ones are pieces of the lines that run everywhere.
    let input: HashSet<Vec<[u64; 2]>> = map.iter().filter(|line| line.source == "input").map(Line::bits).collect();
    let given = all.iter().filter(|line| line.source == "input").map(Line::bits);
    assert_eq!(input, given.collect());
    let places: HashSet<[u64; 2]> = all.iter().flat_map(Line::bits).collect();
    let is_new = |line: &&Line| line.kind.starts_with("supplementary");
    assert!(map.iter().filter(is_new).flat_map(Line::bits).all(|place| places.contains(&place)));
    let length =
        |lines: &[Line]| -> f64 { lines.iter().filter(|line| line.elevation % 20.0 != 0.0).map(Line::length).sum() };
    let share = length(&map) / length(&all);
    assert!((0.005..0.2).contains(&share), "{share}");
    for line in map.iter().filter(is_new) {
        assert!(line.is_ring() || line.length() >= 100.0, "{} at {}", line.length(), line.elevation);
        // Along most of a piece, the contours beside it are far apart.
        let below = (line.elevation / 20.0).floor() * 20.0;
        let [lower, upper] = [below, below + 20.0].map(|level| {
            let own = map.iter().filter(|other| other.elevation == level && !other.kind.starts_with("supplementary"));
            Course::of(own.map(|other| &other.points[..]))
        });
        let apart = |p: &&DVec2| lower.distance(**p) + upper.distance(**p) >= 100.0;
        let is_far = line.points.iter().filter(apart).count() * 3 >= line.points.len() * 2;
        assert!(line.is_ring() || is_far, "{} at {}", line.kind, line.points[0]);
    }

    let bytes = |name: &str| std::fs::read(folder.path(name)).unwrap();
    folder.succeeds(&format!("{make} one.geojson --threads 1"));
    assert!(bytes("one.geojson") == bytes("map.geojson"));
}

#[test]
fn a_scale_leaves_out_what_cannot_be_seen_and_nothing_crosses() {
    let folder = folder_with_part("in.gpkg");
    folder.succeeds("dem in.gpkg --cell 20 --surface linear -o dem.tif");
    folder.succeeds("contour dem.tif -i 10 -o all.geojson");
    let all: usize = lines(&folder, "all.geojson").iter().map(|line| line.points.len()).sum();
    for scale in [25_000.0, 100_000.0] {
        folder.succeeds(&format!("contour dem.tif -i 10 --supplementary 5 --scale {scale} --thin -o map.geojson"));
        let map = lines(&folder, "map.geojson");
        assert_nothing_crosses(&map);
        let count: usize = map.iter().map(|line| line.points.len()).sum();
        // The height map has cells of 20 m: at 1:25 000, little is finer than the scale shows.
        let most = if scale > 50_000.0 { all / 2 } else { all };
        assert!(count < most, "{count} of {all} vertices at 1:{scale}");
        let metres = |millimetres: f64| millimetres * scale / 1000.0;
        for line in &map {
            let [low, high] = line.points.iter().fold([line.points[0]; 2], |[a, b], p| [a.min(*p), b.max(*p)]);
            assert!(!line.is_ring() || (high - low).max_element() >= metres(SMALLEST_RING), "{}", line.points[0]);
        }
        let levels: BTreeSet<i64> = map.iter().map(|line| line.elevation.round() as i64).collect();
        for level in levels {
            let (own, others): (Vec<&Line>, Vec<&Line>) =
                map.iter().partition(|line| line.elevation.round() as i64 == level);
            let others = Course::of(others.iter().map(|line| &line.points[..]));
            // Index contours may be close to each other.
            for line in own.iter().filter(|line| line.kind != "index") {
                let near = line.points.iter().map(|p| others.distance(*p)).fold(f64::INFINITY, f64::min);
                assert!(near >= metres(CLOSEST), "{near} m between {level} and another level");
            }
        }
    }
    let said = folder.succeeds("contour dem.tif --scale 1:50000 -o open.gpkg");
    assert!(said.contains("interval   20 m") && said.contains("layer contours ("), "{said}");
    let said = folder.succeeds("densify in.gpkg --scale 50000 --overwrite -o open.gpkg");
    assert!(said.contains("interval   20 m"), "{said}");
}

#[test]
fn a_coarser_interval_chooses_among_contours_of_the_input() {
    let folder = folder_with_part("in.gpkg");
    folder.succeeds("densify in.gpkg -i 40 --supplementary 20 -o map.geojson");
    folder.succeeds("densify in.gpkg -i 40 --supplementary 20 --keep-input -o kept.geojson");
    let of = |name: &str| -> f64 {
        lines(&folder, name).iter().filter(|line| line.elevation % 40.0 != 0.0).map(Line::length).sum()
    };
    assert!(of("map.geojson") * 2.0 < of("kept.geojson"), "{} {}", of("map.geojson"), of("kept.geojson"));
    assert!(lines(&folder, "map.geojson").iter().all(|line| line.source == "input"));
}

#[test]
fn what_makes_no_sense_is_said() {
    let folder = folder_with_part("in.gpkg");
    for (arguments, expected) in [
        ("-i 20 --supplementary 4", "10 or 10,5 for an interval of 20"),
        ("-i 20 --supplementary 20", "10 or 10,5"),
        ("-i 20 --supplementary 5", "10 or 10,5"),
        ("-i 20 --supplementary -10", "10 or 10,5"),
        ("-i 20,10 --supplementary 5", "one interval"),
        ("--levels 305 --supplementary 5", "one interval"),
        ("--scale 25000 --supplementary 5", "need an interval"),
        ("-i 20 --supplementary 10 --supplementary-spacing 0", "more than 0"),
        ("-i 20 --supplementary-spacing 100", "--supplementary"),
        ("-i 20 --thin", "--scale"),
        ("-i 20 --scale 0", "5000 or 1:5000"),
        ("-i 20 --scale large", "5000 or 1:5000"),
        ("--scale 500", "1:500"),
        ("", "--interval"),
    ] {
        let said = folder.ends(&format!("densify in.gpkg {arguments} -o out.gpkg"), 2);
        assert!(said.contains(expected), "{arguments}: {said}");
    }
    let said = folder.ends("densify in.gpkg -i 20 --supplementary 10 -o out.pmtiles", 2);
    assert!(said.contains("map tiles"), "{said}");
    assert!(folder.ends("densify in.gpkg -i 20 --scale 5000 -o out.pmtiles", 2).contains("map tiles"));
    assert!(!folder.path("out.gpkg").exists());
}

#[test]
fn kinds_are_in_every_format_and_in_pictures() {
    let folder = folder_with_part("in.gpkg");
    let make = "densify in.gpkg -i 20 --supplementary 10,5 --supplementary-spacing 150";
    folder.succeeds(&format!("{make} -o map.dxf --preview map.svg"));
    let text = |name: &str| std::fs::read_to_string(folder.path(name)).unwrap();
    for layer in [
        "CONTOUR-INTERPOLATED-SUPPLEMENTARY\n",
        "CONTOUR-INTERPOLATED-SUPPLEMENTARY_QUARTER\n",
        "CONTOUR-INPUT-INDEX\n",
    ] {
        assert!(text("map.dxf").replace('\r', "").contains(layer), "{layer}");
    }
    assert!(text("map.svg").contains(">Supplementary contours</text>"));
    assert!(text("map.svg").contains(">Supplementary contours, a quarter of the interval</text>"));
    folder.succeeds(&format!("{make} -o map.kml"));
    assert!(text("map.kml").contains("<name>supplementary contours</name>"));
}

#[test]
fn the_commands_of_the_guide_run() {
    let folder = inputs();
    std::fs::copy(folder.path("published_dem.tif"), folder.path("dem.tif")).unwrap();
    let commands = commands(include_str!("../../src/guide/contours_for_a_map.md"));
    assert_eq!(commands.len(), 3);
    commands.iter().for_each(|command| drop(run(&folder, command)));
}
