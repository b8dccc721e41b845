//! Ridge and canyon lines: they fall, they meet, and fewer remain when more are asked to go.

#![allow(clippy::unwrap_used, reason = "helpers of tests are tests too")]

mod common;

use std::collections::{HashMap, HashSet};
use std::path::Path;

use common::{Terrain, all_kinds};
use glam::DVec2;
use tokosen::contour::{CleanParams, Contour, ContourMap, clean};
use tokosen::io::{ReadOptions, read_contours};
use tokosen::skeleton::{BreakKind, BreakLine, LineEnd, Skeleton, skeleton};
use tokosen::surface::{SurfaceParams, Tiling, build, tiling};
use tokosen::tin::Frame;

fn tiling_of(map: ContourMap) -> Tiling {
    let map = clean(map, &CleanParams::default()).unwrap().value;
    tiling(map, &Frame::Hull, &()).unwrap().value
}

fn sample(name: &str) -> Tiling {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("samples").join(name);
    tiling_of(read_contours(&path, &ReadOptions::default()).unwrap().value)
}

fn of_terrain(terrain: &Terrain) -> Tiling {
    let contours = terrain.contours().into_iter().enumerate().map(|(i, (elevation, points))| Contour {
        elevation,
        points,
        feature: i as u64,
    });
    tiling_of(ContourMap { contours: contours.collect(), ..ContourMap::default() })
}

fn lines_of(tiling: &Tiling, resolution: f64) -> Skeleton {
    skeleton(&tiling.tin, &tiling.regions, resolution)
}

const SAMPLES: [&str; 8] = [
    "fig1a_one_to_one.geojson",
    "fig1b_one_convolution.geojson",
    "fig1c_many_convolutions.geojson",
    "fig1d_two_branches_one_convolution.geojson",
    "fig1e_three_branches.geojson",
    "fig1f_nested.geojson",
    "fig5ab_two_branches_ridges_canyon.geojson",
    "fig5cd_three_branches_basin.geojson",
];

fn bits(p: DVec2) -> [u64; 2] {
    [p.x.to_bits(), p.y.to_bits()]
}

/// Every line falls from each vertex to the next, lies in its band, and its ends are what they say.
fn check(tiling: &Tiling, lines: &[BreakLine], what: &str) {
    let contour: HashMap<[u64; 2], f64> =
        tiling.map.contours.iter().flat_map(|c| c.points.iter().map(|p| (bits(*p), c.elevation))).collect();
    let mut ends: HashMap<[u64; 2], HashSet<u32>> = HashMap::new();
    for line in lines {
        assert!(line.points.len() >= 2, "{what}");
        let falls = line.points.windows(2).all(|w| w[0].z > w[1].z);
        assert!(falls, "{what}: a {:?} line does not fall: {:?}", line.kind, line.points);
        let band = tiling.regions.regions[line.region as usize].band;
        for p in &line.points[1..line.points.len() - 1] {
            assert!(band.lo < p.z && p.z < band.hi, "{what}: {} is not inside {band:?}", p.z);
        }
        for (end, p) in line.ends.iter().zip([line.points[0], line.points[line.points.len() - 1]]) {
            let level = contour.get(&bits(p.truncate()));
            assert_eq!(*end == LineEnd::Contour, level == Some(&p.z), "{what}: {end:?} at {p}");
            ends.entry(bits(p.truncate())).or_default().insert(line.network);
        }
    }
    assert!(ends.values().all(|networks| networks.len() == 1), "{what}: lines meet and are not one network");
}

#[test]
fn lines_fall_on_all_kinds_of_terrain() {
    let mut canyons = 0;
    for seed in 0..6 {
        for terrain in all_kinds(seed) {
            let tiling = of_terrain(&terrain);
            for resolution in [0.0, 1.0, 3.0] {
                let found = lines_of(&tiling, resolution);
                check(&tiling, &found.lines, &format!("{} {seed}, w {resolution}", terrain.kind));
                canyons += found.lines.iter().filter(|l| l.kind == BreakKind::Canyon).count();
            }
        }
    }
    assert!(canyons > 100, "{canyons}");
}

/// Of the places where lines of one kind reach a contour from one side: how many, and at how many a line of that kind goes on.
fn continued(lines: &[BreakLine]) -> (usize, usize) {
    let mut at: HashMap<(bool, [u64; 2]), HashSet<u32>> = HashMap::new();
    for line in lines {
        for (end, p) in line.ends.iter().zip([line.points[0], line.points[line.points.len() - 1]]) {
            if *end == LineEnd::Contour {
                at.entry((line.kind == BreakKind::Ridge, bits(p.truncate()))).or_default().insert(line.region);
            }
        }
    }
    (at.len(), at.values().filter(|regions| regions.len() > 1).count())
}

#[test]
fn lines_go_on_from_sub_domain_to_sub_domain() {
    let tiling = sample("caryville_20m.gpkg");
    let found = lines_of(&tiling, 1.0);
    check(&tiling, &found.lines, "caryville");
    let (places, shared) = continued(&found.lines);
    println!(
        "{places} places, {shared} shared, {} lines, moved {} by {}",
        found.lines.len(),
        found.flow.moved,
        found.flow.most_moved
    );
    assert!(2 * shared > places, "{shared} of {places}");
}

#[test]
fn more_resolution_leaves_fewer_and_shorter_lines() {
    for name in SAMPLES.into_iter().chain(["caryville_20m.gpkg"]) {
        let tiling = sample(name);
        let totals: Vec<(f64, usize, f64)> = [0.0, 0.3, 0.7, 1.0, 1.5, 2.0, 3.0, 5.0, 10.0]
            .into_iter()
            .map(|w| {
                let lines = lines_of(&tiling, w).lines;
                (w, lines.len(), lines.iter().map(BreakLine::length).sum())
            })
            .collect();
        let falls = totals.windows(2).all(|p| p[0].1 >= p[1].1 && p[0].2 >= p[1].2 - 1e-9 * p[0].2);
        assert!(falls, "{name}: {totals:?}");
    }
}

#[test]
fn the_surface_has_the_same_lines() {
    let tiling = sample("fig5ab_two_branches_ridges_canyon.geojson");
    let surface = build(tiling.map.clone(), &SurfaceParams::default(), &()).unwrap().value;
    let found = lines_of(&tiling, 1.0);
    assert_eq!(surface.break_lines, found.lines);
    let height: HashMap<[u64; 2], f64> = (0..surface.tin.positions.len() as u32)
        .map(|v| (bits(surface.tin.point(v).truncate()), surface.tin.heights[v as usize]))
        .collect();
    for p in found.lines.iter().flat_map(|l| &l.points) {
        assert_eq!(height.get(&bits(p.truncate())), Some(&p.z));
    }
}
