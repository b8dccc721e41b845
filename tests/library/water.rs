//! Lakes and the sea: level, met by no contour, and nothing else changed by them.

#![allow(clippy::unwrap_used, reason = "helpers of tests are tests too")]

use std::collections::HashSet;
use std::f64::consts::TAU;

use crate::common;
use crate::common::Random;
use geo::{LineString, Polygon};
use glam::DVec2;
use tokosen::base::Grid;
use tokosen::base::error::{Error, Finding, FindingKind};
use tokosen::clean::{CleanParams, clean};
use tokosen::contour::Target;
use tokosen::contour::{Contour, ContourLayer, ContourMap, Lake, Source};
use tokosen::layers::{LayerParams, contour_layers};
use tokosen::raster::rasterise;
use tokosen::subdivision::Water;
use tokosen::subdomains::Frame;
use tokosen::surface::{Given, Surface, SurfaceKind, SurfaceParams, build};

fn circle(center: (f64, f64), radius: f64) -> Vec<DVec2> {
    (0..=40).map(|k| DVec2::from(center) + radius * DVec2::from_angle(f64::from(k % 40) * TAU / 40.0)).collect()
}

fn contour(elevation: f64, points: Vec<DVec2>) -> Contour {
    Contour { elevation, points, feature: 0.into() }
}

fn ring_of(points: &[DVec2]) -> LineString<f64> {
    points.iter().map(|p| (p.x, p.y)).collect()
}

fn lake(height: Option<f64>, exterior: &[DVec2], holes: &[Vec<DVec2>]) -> Lake {
    let holes = holes.iter().map(|h| ring_of(h)).collect();
    Lake { polygon: Polygon::new(ring_of(exterior), holes), height, feature: 1.into() }
}

fn surface_with(contours: Vec<Contour>, water: Water, kind: SurfaceKind) -> (Surface, Vec<Finding>) {
    let map = ContourMap { contours, ..ContourMap::default() };
    let map = clean(map, &CleanParams::default()).unwrap().value;
    let (given, params) = (Given { water, ..Given::default() }, SurfaceParams { kind, ..SurfaceParams::default() });
    let report = build(map, &given, &params, &()).unwrap();
    (report.value, report.findings)
}

fn flat(lakes: Vec<Lake>) -> Water {
    Water { lakes, ..Water::default() }
}

const KINDS: [SurfaceKind; 2] = [SurfaceKind::Linear, SurfaceKind::Skeleton];

fn height_at(surface: &Surface, x: f64, y: f64) -> f64 {
    let grid = Grid { corner: DVec2::new(x - 0.5, y + 0.5), cell: DVec2::ONE, cols: 1, rows: 1 };
    f64::from(rasterise(&surface.tin, &grid, None, &()).values[0])
}

/// A slope from 150 down to a hollow below 100 in the middle.
fn hollow() -> Vec<Contour> {
    (0..=5).map(|k| contour(100.0 + 10.0 * f64::from(k), circle((0.0, 0.0), 200.0 + 40.0 * f64::from(k)))).collect()
}

fn layer_of(surface: &Surface, step: f64) -> ContourLayer {
    let params = LayerParams { targets: vec![Target::Interval { step, base: 0.0 }], ..LayerParams::default() };
    contour_layers(surface, &params, &()).unwrap().remove(0)
}

/// What holds for every surface with water.
fn check(surface: &Surface, step: f64, what: &str) {
    let tin = &surface.tin;
    tin.validate().unwrap_or_else(|e| panic!("{what}: {e}"));
    for t in (0..tin.len() as u32).filter(|&t| tin.is_inside(t)) {
        let region = surface.regions.region(t).unwrap();
        let heights = tin.corner_heights(t);
        assert!(heights.iter().all(|&z| region.band.contains(z)), "{what}: {heights:?} in {:?}", region.band);
        if let Some(level) = region.water {
            assert_eq!(heights, [level; 3], "{what}");
        }
    }
    let layer = layer_of(surface, step);
    let bits = |p: &DVec2| p.to_array().map(f64::to_bits);
    let kept: Vec<_> = layer.lines.iter().filter(|l| l.source == Source::Input).collect();
    let mut wanted: Vec<&Contour> = surface.map.contours.iter().collect();
    wanted.sort_by(|a, b| a.elevation.total_cmp(&b.elevation));
    assert_eq!(kept.len(), wanted.len(), "{what}");
    for (line, contour) in kept.iter().zip(wanted) {
        let forward = line.points.iter().map(bits).eq(contour.points.iter().map(bits));
        assert!(forward || line.points.iter().rev().map(bits).eq(contour.points.iter().map(bits)), "{what}");
    }
    let lines: Vec<_> = layer.lines.iter().map(|l| (l.elevation, l.points.clone())).collect();
    let bad = common::crossings(&lines);
    assert!(bad.is_empty(), "{what}: {} crossings, the first: {}", bad.len(), bad[0]);
    // No line runs through water: the middle of each of its pieces is on land or on the shore.
    let (mut pieces, mut located) = (0, 0);
    for line in layer.lines.iter().filter(|l| l.source == Source::Interpolated) {
        let mut t = 0;
        for w in line.points.windows(2) {
            let middle = w[0].midpoint(w[1]) - tin.origin;
            pieces += 1;
            if let Some(found) = tin.locate(t, middle) {
                t = found;
                located += 1;
                let edge = |i: usize| tin.edge(t, i).map(|v| tin.positions[v as usize]);
                let on_edge = (0..3).any(|i| {
                    let [a, b] = edge(i);
                    ((b - a).perp_dot(middle - a) / a.distance(b)).abs() < 1e-6
                });
                let is_water = surface.regions.region(t).is_some_and(|r| r.water.is_some());
                assert!(!is_water || on_edge, "{what}: a line of {} in water at {middle}", line.elevation);
            }
        }
    }
    assert_eq!(located, pieces, "{what}: pieces of lines in no triangle");
    // New lines end at the frame or on an input line.
    let frame: Vec<[DVec2; 2]> = surface.frame.edges().collect();
    let given: HashSet<([u64; 2], u64)> =
        kept.iter().flat_map(|l| l.points.iter().map(|p| (bits(p), l.elevation.to_bits()))).collect();
    for line in layer.lines.iter().filter(|l| l.source == Source::Interpolated && !l.is_closed()) {
        for end in [line.points[0], line.points[line.points.len() - 1]] {
            let at_frame = frame.iter().any(|[a, b]| distance(end, *a, *b) <= 2e-9 * surface.frame.diagonal());
            let at_input = given.contains(&(bits(&end), line.elevation.to_bits()));
            assert!(at_frame || at_input, "{what}: a line of level {} ends in the open at {end}", line.elevation);
        }
    }
}

/// A ring from its westernmost vertex on.
fn from_smallest(mut ring: Vec<DVec2>) -> Vec<DVec2> {
    ring.pop();
    let first = (0..ring.len()).min_by(|&i, &j| ring[i].x.total_cmp(&ring[j].x)).unwrap();
    ring.rotate_left(first);
    ring
}

fn distance(p: DVec2, a: DVec2, b: DVec2) -> f64 {
    let t = ((p - a).dot(b - a) / (b - a).length_squared()).clamp(0.0, 1.0);
    p.distance(a + (b - a) * t)
}

#[test]
fn a_lake_with_an_island_is_level_and_the_island_rises() {
    for kind in KINDS {
        let water = flat(vec![lake(Some(94.5), &circle((5.0, 0.0), 100.0), &[circle((0.0, 10.0), 30.0)])]);
        let (surface, findings) = surface_with(hollow(), water, kind);
        assert!(findings.is_empty(), "{findings:?}");
        check(&surface, 0.5, "lake with an island");
        for (x, y) in [(60.0, 0.0), (-80.0, -30.0), (5.0, 90.0)] {
            assert_eq!(height_at(&surface, x, y), 94.5);
        }
        let shore = height_at(&surface, 150.0, 0.0);
        assert!(94.5 < shore && shore < 100.0, "{shore}");
        let island = height_at(&surface, 0.0, 10.0);
        assert!((94.5..=100.0).contains(&island), "{island}");
        if kind == SurfaceKind::Skeleton {
            assert!(island > 94.6, "{island}");
        }
    }
}

#[test]
fn a_shore_that_is_a_contour_has_its_level() {
    let shore = circle((0.0, 0.0), 200.0);
    let mut random = Random::new(7);
    let mut nearly: Vec<DVec2> =
        shore.iter().map(|&p| p + DVec2::new(random.between(-1.0, 1.0), random.between(-1.0, 1.0))).collect();
    nearly[40] = nearly[0];
    for (what, ring) in [("the contour", &shore), ("nearly the contour", &nearly)] {
        for kind in KINDS {
            let (surface, findings) = surface_with(hollow(), flat(vec![lake(None, ring, &[])]), kind);
            assert!(findings.is_empty(), "{what}: {findings:?}");
            check(&surface, 1.0, what);
            for (x, y) in [(0.0, 0.0), (150.0, 100.0), (-190.0, 20.0)] {
                assert_eq!(height_at(&surface, x, y), 100.0, "{what}");
            }
            let (dry, _) = surface_with(hollow(), Water::default(), kind);
            let outside = [surface, dry].map(|s| {
                let lines = layer_of(&s, 1.0).lines.into_iter().filter(|l| l.elevation > 100.0);
                let mut lines: Vec<_> = lines.map(|l| from_smallest(l.points)).collect();
                lines.sort_by(|a, b| a[0].x.total_cmp(&b[0].x));
                lines
            });
            assert!(what != "the contour" || outside[0] == outside[1], "contours outside are the same");
        }
    }
}

#[test]
fn a_lake_across_a_contour_is_cut_back_with_a_finding() {
    for kind in KINDS {
        let water = flat(vec![lake(Some(95.0), &circle((110.0, 0.0), 100.0), &[])]);
        let (surface, findings) = surface_with(hollow(), water, kind);
        let told: Vec<_> = findings.iter().map(|f| f.kind).collect();
        assert!(told.contains(&FindingKind::LakeCutBack), "{findings:?}");
        assert!(findings.iter().all(|f| f.place.is_some()));
        check(&surface, 1.0, "cut back");
        assert_eq!(height_at(&surface, 100.0, 0.0), 95.0);
        assert_eq!(height_at(&surface, 30.0, 10.0), 95.0);
        assert!(height_at(&surface, 205.0, 0.0) > 100.0, "beyond the contour is land");
    }
}

#[test]
fn water_that_contradicts_its_contours_is_left_out() {
    let water = flat(vec![lake(Some(50.0), &circle((0.0, 0.0), 100.0), &[])]);
    let (surface, findings) = surface_with(hollow(), water, SurfaceKind::Skeleton);
    let kinds: Vec<FindingKind> = findings.iter().map(|f| f.kind).collect();
    assert_eq!(kinds, [FindingKind::LakeLeftOut, FindingKind::MayBeLake], "{findings:?}");
    assert!(surface.regions.regions.iter().all(|r| r.water.is_none()));
    let water = flat(vec![lake(Some(95.0), &circle((5000.0, 0.0), 100.0), &[])]);
    let (_, findings) = surface_with(hollow(), water, SurfaceKind::Skeleton);
    let kinds: Vec<FindingKind> = findings.iter().map(|f| f.kind).collect();
    assert_eq!(kinds, [FindingKind::LakeLeftOut, FindingKind::MayBeLake], "{findings:?}");
}

#[test]
fn a_height_of_water_that_is_none_is_refused() {
    for height in [f64::NAN, f64::INFINITY, -1e30] {
        let map = clean(ContourMap { contours: hollow(), ..ContourMap::default() }, &CleanParams::default()).unwrap();
        let water = flat(vec![lake(Some(height), &circle((0.0, 0.0), 100.0), &[])]);
        let given = Given { water, ..Given::default() };
        let error = build(map.value, &given, &SurfaceParams::default(), &()).unwrap_err();
        assert!(matches!(&error, Error::Data(m) if m.contains("the lake of feature 1 has the height")), "{error}");
    }
}

/// Straight contours, rising to the north.
fn slope() -> Vec<Contour> {
    let line = |k: u32| {
        let y = 100.0 * f64::from(k);
        contour(10.0 * f64::from(k), (0..=20).map(|i| DVec2::new(50.0 * f64::from(i), y)).collect())
    };
    (0..=10).map(line).collect()
}

#[test]
fn a_lake_on_a_slope_has_the_height_of_its_lowest_shore() {
    for kind in KINDS {
        let water = flat(vec![lake(None, &circle((500.0, 550.0), 40.0), &[])]);
        let (surface, findings) = surface_with(slope(), water, kind);
        assert!(findings.is_empty(), "{findings:?}");
        check(&surface, 1.0, "slope");
        assert!((height_at(&surface, 500.0, 550.0) - 51.0).abs() < 0.05);
    }
}

#[test]
fn a_lake_at_the_edge_of_the_sheet_ends_there() {
    for kind in KINDS {
        for center in [(1000.0, 550.0), (0.0, 545.0)] {
            let water = flat(vec![lake(Some(53.0), &circle(center, 40.0), &[])]);
            let (surface, findings) = surface_with(slope(), water, kind);
            assert!(findings.is_empty(), "{findings:?}");
            check(&surface, 1.0, "edge");
            let inside = 0.98 * (center.0 - 500.0) + 500.0;
            assert_eq!(height_at(&surface, inside, center.1), 53.0);
            assert!(height_at(&surface, center.0 + (center.0 - 500.0) * 0.02, 550.0).is_nan());
        }
    }
}

#[test]
fn a_lake_on_the_way_of_a_contour_to_the_frame_is_cut_back_with_a_finding() {
    let mut lines = slope();
    lines[5].points.retain(|p| p.x <= 920.0);
    let water = flat(vec![lake(Some(50.0), &circle((960.0, 500.0), 25.0), &[])]);
    let (surface, findings) = surface_with(lines, water, SurfaceKind::Skeleton);
    let told: Vec<_> = findings.iter().filter(|f| f.kind == FindingKind::LakeCutBack).collect();
    assert_eq!(told.len(), 1, "{findings:?}");
    assert!(told[0].message.contains("the extension to the frame of contour 50"), "{}", told[0].message);
    check(&surface, 1.0, "beside a link");
    assert_eq!([510.0, 490.0].map(|y| height_at(&surface, 960.0, y)), [50.0; 2]);
}

#[test]
fn a_lake_as_narrow_as_a_line_is_left_out_with_a_finding() {
    let ring = |points: &[(f64, f64)]| points.iter().map(|&p| p.into()).collect::<Vec<DVec2>>();
    // Along the contour at 500 all of its vertices move onto that.
    let narrow = ring(&[(310.0, 500.2), (450.0, 499.8), (590.0, 500.2), (450.0, 500.3), (310.0, 500.2)]);
    let (surface, findings) = surface_with(slope(), flat(vec![lake(Some(50.0), &narrow, &[])]), SurfaceKind::Spline);
    assert_eq!(findings.iter().map(|f| f.kind).collect::<Vec<_>>(), [FindingKind::LakeLeftOut], "{findings:?}");
    check(&surface, 1.0, "narrow");
    // Of a lake with such an arm the rest is kept.
    let armed = ring(&[(590.0, 500.2), (450.0, 500.3), (400.0, 520.0), (350.0, 530.0), (450.0, 499.8), (590.0, 500.2)]);
    let (surface, findings) = surface_with(slope(), flat(vec![lake(Some(50.0), &armed, &[])]), SurfaceKind::Spline);
    assert!(findings.is_empty(), "{findings:?}");
    check(&surface, 1.0, "arm");
    assert_eq!(height_at(&surface, 400.0, 518.0), 50.0);
    assert!(height_at(&surface, 520.0, 501.0) > 50.0);
}

#[test]
fn a_lake_without_width_is_left_out_with_a_finding() {
    let needle: Vec<DVec2> = [(500.0, 510.0), (500.0, 590.0), (500.0 + 1e-9, 590.0)].map(DVec2::from).into();
    let lakes = vec![lake(None, &circle((500.0, 550.0), 30.0), &[]), lake(None, &needle, &[])];
    for kind in KINDS {
        let (surface, findings) = surface_with(slope(), flat(lakes.clone()), kind);
        let told: Vec<_> = findings.iter().filter(|f| f.kind == FindingKind::LakeLeftOut).collect();
        assert!(matches!(&told[..], [f] if f.message.contains("no width")), "{findings:?}");
        check(&surface, 1.0, "needle");
    }
}

#[test]
fn lakes_that_meet_are_one_or_apart() {
    for kind in KINDS {
        let pair = |b: f64| {
            vec![lake(Some(95.0), &circle((-40.0, 0.0), 60.0), &[]), lake(Some(b), &circle((40.0, 3.0), 60.0), &[])]
        };
        let (surface, findings) = surface_with(hollow(), flat(pair(95.0)), kind);
        assert!(findings.is_empty(), "{findings:?}");
        check(&surface, 1.0, "joined");
        assert_eq!(surface.regions.regions.iter().filter(|r| r.water.is_some()).count(), 1);
        let (surface, findings) = surface_with(hollow(), flat(pair(97.0)), kind);
        assert_eq!(findings.iter().map(|f| f.kind).collect::<Vec<_>>(), [FindingKind::LakeCutBack]);
        check(&surface, 1.0, "apart");
        assert_eq!(height_at(&surface, -40.0, 0.0), 95.0);
        assert_eq!(height_at(&surface, 80.0, 0.0), 97.0);
    }
}

#[test]
fn the_sea_is_level_up_to_the_frame_and_islands_rise() {
    let coast = |k: u32| {
        let y = 100.0 * f64::from(k);
        let wave = |i: u32| 20.0 * (f64::from(i) * 0.7).sin();
        contour(10.0 * f64::from(k), (0..=40).map(|i| DVec2::new(25.0 * f64::from(i), y + wave(i))).collect())
    };
    let mut contours: Vec<Contour> = (0..=4).map(coast).collect();
    contours.push(contour(0.0, circle((300.0, -200.0), 60.0)));
    contours.push(contour(0.0, circle((800.0, -400.0), 10.0)));
    contours.push(contour(0.0, circle((100.0, -400.0), 10.0)));
    for kind in KINDS {
        let water = Water { sea: Some(0.0), ..Water::default() };
        let (surface, findings) = surface_with(contours.clone(), water, kind);
        assert!(findings.is_empty(), "{findings:?}");
        check(&surface, 1.0, "sea");
        for (x, y) in [(500.0, -100.0), (450.0, -390.0), (30.0, -50.0)] {
            assert_eq!(height_at(&surface, x, y), 0.0);
        }
        assert!(height_at(&surface, 500.0, 50.0) > 0.0);
        let new = layer_of(&surface, 1.0).lines;
        assert!(new.iter().all(|l| l.elevation > 0.0 || l.source == Source::Input));
        if kind == SurfaceKind::Skeleton {
            assert!(height_at(&surface, 300.0, -200.0) > 0.1, "the island");
        }
    }
    let map = ContourMap { contours, ..ContourMap::default() };
    let given = Given { water: Water { sea: Some(3.0), ..Water::default() }, ..Given::default() };
    match build(map, &given, &SurfaceParams::default(), &()) {
        Err(Error::Parameter(message)) => assert!(message.contains("are 0 m, 10 m, 20 m"), "{message}"),
        other => panic!("{other:?}"),
    }
}

/// A ring around a place, its radius changing from corner to corner.
fn blob(random: &mut Random, center: DVec2, radius: f64) -> Vec<DVec2> {
    let count = random.whole(5, 60);
    let mut ring: Vec<DVec2> = (0..count)
        .map(|k| center + random.between(0.4, 1.0) * radius * DVec2::from_angle(k as f64 * TAU / count as f64))
        .collect();
    ring.push(ring[0]);
    ring
}

#[test]
fn any_water_on_any_terrain_keeps_the_rules() {
    let (mut wet, mut told, mut woven) = (0, 0, 0);
    for seed in 0..4 {
        for terrain in common::all_kinds(seed) {
            let mut random = Random::new(seed + 100);
            let lines = terrain.contours();
            let contours: Vec<Contour> = lines.iter().map(|(z, points)| contour(*z, points.clone())).collect();
            let size = DVec2::new(terrain.cols as f64, terrain.rows as f64) * terrain.cell;
            let (mut lo, mut hi) = (DVec2::INFINITY, DVec2::NEG_INFINITY);
            for p in contours.iter().flat_map(|c| &c.points) {
                lo = lo.min(*p);
                hi = hi.max(*p);
            }
            let mut lakes = Vec::new();
            for _ in 0..4 {
                let center = DVec2::new(random.between(lo.x, hi.x), random.between(lo.y, hi.y));
                let radius = random.between(0.02, 0.25) * size.min_element();
                lakes.push(lake(None, &blob(&mut random, center, radius), &[]));
            }
            let rings: Vec<&Contour> = contours.iter().filter(|c| c.is_closed()).collect();
            for k in 0..rings.len().min(3) {
                let mut points = rings[k * rings.len() / 3].points.clone();
                if k == 1 {
                    let last = points.len() - 1;
                    for p in &mut points {
                        *p += DVec2::new(random.between(-0.3, 0.3), random.between(-0.3, 0.3));
                    }
                    points[last] = points[0];
                }
                lakes.push(lake(None, &points, &[]));
            }
            for kind in KINDS {
                let map = ContourMap { contours: contours.clone(), ..ContourMap::default() };
                let map = clean(map, &CleanParams::default()).expect("the terrain's contours are no heap of crossings");
                let params = SurfaceParams {
                    kind,
                    frame: [Frame::Hull, Frame::Box][seed as usize % 2].clone(),
                    ..SurfaceParams::default()
                };
                let what = format!("{} {seed} {kind:?}", terrain.kind);
                let given = Given { water: flat(lakes.clone()), ..Given::default() };
                let report = build(map.value, &given, &params, &()).unwrap_or_else(|e| panic!("{what}: {e}"));
                check(&report.value, 2.0, &what);
                wet += report.value.regions.regions.iter().filter(|r| r.water.is_some()).count();
                woven += report.findings.iter().filter(|f| f.message.contains("weaves")).count();
                told += report.findings.iter().filter(|f| f.kind == FindingKind::LakeLeftOut).count();
            }
        }
    }
    assert!(wet > 500 && woven * 50 < wet, "{wet} pieces of water, {told} left out, {woven} for their shores");
    eprintln!("{wet} pieces of water, {told} left out, {woven} for their shores");
}
