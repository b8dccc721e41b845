//! Areas between levels: a partition of the frame whose borders are the lines.

#![allow(clippy::unwrap_used, reason = "helpers of tests are tests too")]

use std::collections::{HashMap, HashSet};
use std::f64::consts::TAU;

use geo::{Area, MultiPolygon, Polygon, polygon};
use glam::DVec2;
use tokosen::bands::{BandArea, BandKind, areas_above, bands_of_height_map, bands_of_surface};
use tokosen::base::error::{Finding, FindingKind};
use tokosen::base::{ElevationUnit, Grid};
use tokosen::clean::{CleanParams, clean};
use tokosen::contour::{Contour, ContourLayer, ContourLine, ContourMap, Lake, Target};
use tokosen::dem::contour::{ContourParams, contours};
use tokosen::layers::{LayerParams, contour_layers};
use tokosen::raster::Dem;
use tokosen::subdivision::Water;
use tokosen::subdomains::Frame;
use tokosen::surface::{Given, Surface, SurfaceKind, SurfaceParams, build};

use crate::common::{Random, all_kinds};

type Key = [u64; 2];

fn key(p: DVec2) -> Key {
    (p + 0.0).to_array().map(f64::to_bits)
}

fn signed_area(ring: &[DVec2]) -> f64 {
    ring.windows(2).map(|w| (w[0] - ring[0]).perp_dot(w[1] - ring[0])).sum::<f64>() / 2.0
}

/// Checks that areas divide a frame of this size, and that the lines at the levels of the target are their borders. `open` is
/// how many lines may bound nothing. Returns the number of areas between other than neighbouring levels.
fn check(areas: &[BandArea], size: f64, lines: &[ContourLine], target: &Target, open: usize, what: &str) -> usize {
    let mut left: HashMap<(Key, Key), usize> = HashMap::new();
    for (k, area) in areas.iter().enumerate() {
        for (i, ring) in area.rings.iter().enumerate() {
            assert!(ring.len() >= 4 && ring[0] == ring[ring.len() - 1], "{what}: {ring:?}");
            assert_eq!(signed_area(ring) > 0.0, i == 0, "{what}: ring {i} of area {k} turns the wrong way");
            let vertices: HashSet<Key> = ring.iter().map(|p| key(*p)).collect();
            assert_eq!(vertices.len(), ring.len() - 1, "{what}: a ring passes a vertex twice");
            for w in ring.windows(2) {
                let before = left.insert((key(w[0]), key(w[1])), k);
                assert_eq!(before, None, "{what}: two areas on the same side of {} {}", w[0], w[1]);
            }
        }
    }
    let sum: f64 = areas.iter().map(|area| area.rings.iter().map(|ring| signed_area(ring)).sum::<f64>()).sum();
    assert!((sum - size).abs() <= 1e-9 * size, "{what}: {sum} of {size}");
    let shares: f64 = areas.iter().map(|area| area.share).sum();
    assert!((shares - 1.0).abs() < 1e-9, "{what}: {shares}");
    let mut unused = 0;
    for line in lines.iter().filter(|line| target.has(ElevationUnit::Metre, line.elevation)) {
        let mut is_border = true;
        for w in line.points.windows(2) {
            let [below, above] = [(w[0], w[1]), (w[1], w[0])].map(|(a, b)| left.get(&(key(a), key(b))));
            is_border &= below.is_some() || above.is_some();
            let [below, above] = [below, above].map(|area| area.map(|&k| &areas[k]));
            let ground = |area: &&BandArea| area.kind == BandKind::Ground;
            if let Some(area) = below.filter(ground) {
                assert!(area.from < Some(line.elevation), "{what}: {:?} below {}", area.from, line.elevation);
            }
            if let Some(area) = above.filter(ground) {
                assert!(area.to.is_none_or(|to| to > line.elevation), "{what}: {:?} above {}", area.to, line.elevation);
            }
        }
        unused += usize::from(!is_border);
    }
    assert!(unused <= open, "{what}: {unused} lines bound nothing");
    let is_wide = |area: &&BandArea| match (area.from, area.to) {
        (Some(from), Some(to)) => target.beside(ElevationUnit::Metre, from)[1] != to && from < to,
        _ => false,
    };
    areas.iter().filter(is_wide).count()
}

/// Checks that the areas above each level are the bands above it, put together: each edge parts such a band from other ground, and
/// the sizes are the same.
fn check_above(bands: &[BandArea], what: &str) {
    let from = |band: &BandArea| band.from.unwrap_or(f64::NEG_INFINITY);
    let edges = |ring: &[DVec2]| ring.windows(2).map(|w| (key(w[0]), key(w[1]))).collect::<Vec<_>>();
    let left: HashMap<(Key, Key), f64> =
        bands.iter().flat_map(|band| band.rings.iter().flat_map(|r| edges(r)).map(|e| (e, from(band)))).collect();
    let size = |rings: &[Vec<DVec2>]| rings.iter().map(|ring| signed_area(ring)).sum::<f64>();
    let whole: f64 = bands.iter().map(|band| size(&band.rings)).sum();
    let mut levels: Vec<f64> = bands.iter().map(from).collect();
    levels.sort_by(f64::total_cmp);
    levels.dedup();
    for (level, areas) in levels.iter().zip(areas_above(bands, &levels)) {
        let above: f64 = bands.iter().filter(|band| from(band) >= *level).map(|band| size(&band.rings)).sum();
        let found: f64 = areas.iter().map(|rings| size(rings)).sum();
        assert!((found - above).abs() <= 1e-9 * whole, "{what}: {found} of {above} above {level}");
        let mut seen = HashSet::new();
        for rings in &areas {
            for (i, ring) in rings.iter().enumerate() {
                assert_eq!(signed_area(ring) > 0.0, i == 0, "{what}: ring {i} above {level} turns the wrong way");
                for (a, b) in edges(ring) {
                    assert!(seen.insert((a, b)), "{what}: an edge of two areas above {level}");
                    assert!(left[&(a, b)] >= *level, "{what}: ground below {level} in an area above it");
                    assert!(left.get(&(b, a)).is_none_or(|from| from < level), "{what}: no border of {level}");
                }
            }
        }
    }
}

/// The heights of a terrain, some of them taken out.
fn dem_of(terrain: &crate::common::Terrain, random: &mut Random) -> Dem {
    let corner = terrain.origin + DVec2::new(-0.5, 0.5) * terrain.cell;
    let grid = Grid { corner, cell: DVec2::splat(terrain.cell), cols: terrain.cols, rows: terrain.rows };
    let mut values: Vec<f32> = terrain.heights.iter().map(|&z| (z / 2.5).round() as f32 * 2.5).collect();
    for _ in 0..random.whole(0, 5) {
        let first = random.whole(0, values.len() - 1);
        (0..random.whole(1, 30)).for_each(|n| {
            if let Some(value) = values.get_mut(first + n % 5 + n / 5 * grid.cols) {
                *value = f32::NAN;
            }
        });
    }
    Dem { grid, values, crs: None }
}

/// The size of the squares between four cells with heights.
fn squares(dem: &Dem) -> f64 {
    let cols = dem.grid.cols;
    let has = |n: usize| [n, n + 1, n + cols, n + cols + 1].iter().all(|&n| !dem.values[n].is_nan());
    let firsts = (0..dem.grid.len() - cols).filter(|n| n % cols + 1 < cols);
    firsts.filter(|&n| has(n)).count() as f64 * dem.grid.cell.element_product()
}

#[test]
fn contours_of_height_maps_divide_them() {
    for seed in 0..6 {
        let mut random = Random::new(seed);
        for (k, terrain) in all_kinds(seed).iter().enumerate() {
            let dem = dem_of(terrain, &mut random);
            let target = Target::Interval { step: 5.0, base: 0.0 };
            let params = ContourParams { targets: vec![target.clone()], ..ContourParams::default() };
            let layer = contours(&dem, &params, &()).unwrap().layers.remove(0);
            let found = bands_of_height_map(&dem, &layer, &target, ElevationUnit::Metre, None);
            let what = format!("terrain {k} of seed {seed}");
            assert_eq!(found.findings, [], "{what}");
            assert_eq!(check(&found.value, squares(&dem), &layer.lines, &target, 0, &what), 0, "{what}");
            check_above(&found.value, &what);
        }
    }
}

#[test]
fn a_part_of_a_height_map_is_divided_up_to_its_border() {
    let mut random = Random::new(3);
    for (k, terrain) in all_kinds(3).iter().enumerate() {
        let dem = dem_of(terrain, &mut random);
        let [low, high] = dem.corners();
        let at = |x: f64, y: f64| (low + (high - low) * DVec2::new(x, y)).into();
        let ring = |points: &[(f64, f64)]| points.iter().map(|&(x, y)| at(x, y)).collect::<Vec<(f64, f64)>>().into();
        let outer = ring(&[(0.13, 0.21), (0.87, 0.1), (1.4, 0.55), (0.6, 0.9), (0.13, 0.21)]);
        let hole = ring(&[(0.4, 0.4), (0.6, 0.45), (0.5, 0.6), (0.4, 0.4)]);
        let part = MultiPolygon::from(Polygon::new(outer, vec![hole]));
        let target = Target::Levels(vec![300.0, 10.0, 20.0, 35.0, 80.0]);
        let params =
            ContourParams { targets: vec![target.clone()], part: Some(part.clone()), ..ContourParams::default() };
        let layer = contours(&dem, &params, &()).unwrap().layers.remove(0);
        let found = bands_of_height_map(&dem, &layer, &target, ElevationUnit::Metre, Some(&part)).value;
        let inside: f64 = found.iter().map(|area| area.area).sum();
        assert!(inside > 0.0 && inside <= part.unsigned_area() * (1.0 + 1e-9), "terrain {k}");
        check(&found, inside, &layer.lines, &target, 0, &format!("part of terrain {k}"));
        assert!(
            found.iter().all(|area| area.from.is_some() || area.to.is_some()),
            "a level list is open at its ends only"
        );
    }
}

#[test]
fn areas_without_a_line_get_their_levels_from_heights() {
    let grid = Grid { corner: DVec2::ZERO, cell: DVec2::ONE, cols: 5, rows: 2 };
    let values = vec![12.0, 13.0, f32::NAN, 30.0, 31.0, 12.0, 13.0, f32::NAN, 30.0, 32.0];
    let dem = Dem { grid, values, crs: None };
    let target = Target::Interval { step: 10.0, base: 0.0 };
    let found = bands_of_height_map(&dem, &ContourLayer::default(), &target, ElevationUnit::Metre, None).value;
    let levels: Vec<_> = found.iter().map(|area| (area.from, area.to, area.middle(), area.area)).collect();
    let expected = [(Some(10.0), Some(20.0), Some(15.0), 1.0), (Some(30.0), Some(40.0), Some(35.0), 1.0)];
    assert_eq!(levels, expected);
}

fn circle(center: (f64, f64), radius: f64) -> Vec<DVec2> {
    (0..=40).map(|k| DVec2::from(center) + radius * DVec2::from_angle(f64::from(k % 40) * TAU / 40.0)).collect()
}

fn contour(elevation: f64, points: Vec<DVec2>) -> Contour {
    Contour { elevation, points, feature: 0.into() }
}

/// The surface of contours, a layer every so many metres, and the areas between its lines.
fn divided(
    contours: Vec<Contour>,
    step: f64,
    (given, frame): (&Given, Frame),
) -> (Surface, ContourLayer, Vec<BandArea>, Vec<Finding>) {
    let map = clean(ContourMap { contours, ..ContourMap::default() }, &CleanParams::default()).unwrap().value;
    let params = SurfaceParams { kind: SurfaceKind::Linear, frame, ..SurfaceParams::default() };
    let surface = build(map, given, &params, &()).unwrap().value;
    let target = Target::Interval { step, base: 0.0 };
    let layers = LayerParams { targets: vec![target.clone()], ..LayerParams::default() };
    let layer = contour_layers(&surface, &layers, &()).unwrap().remove(0);
    let found = bands_of_surface(&surface, &layer, &target, ElevationUnit::Metre);
    (surface, layer, found.value, found.findings)
}

#[test]
fn lakes_and_the_sea_are_areas_of_their_own() {
    let contours: Vec<Contour> =
        (0..=5).map(|k| contour(10.0 * f64::from(k), circle((0.0, 0.0), 400.0 - 60.0 * f64::from(k)))).collect();
    let ring = |points: &[DVec2]| points.iter().map(|p| (p.x, p.y)).collect::<geo::LineString<f64>>();
    let island = ring(&circle((190.0, 0.0), 5.0));
    let lake = Lake {
        polygon: Polygon::new(ring(&circle((190.0, 0.0), 25.0)), vec![island]),
        height: Some(33.0),
        feature: 1.into(),
    };
    let water = Water { lakes: vec![lake], sea: Some(0.0), ..Water::default() };
    let square = polygon![(x: -450., y: -450.), (x: 450., y: -450.), (x: 450., y: 450.), (x: -450., y: 450.)];
    for step in [5.0, 3.0, 2.0, 1.0] {
        let given = Given { water: water.clone(), ..Given::default() };
        let frame = Frame::Polygon(square.clone().into());
        let (surface, layer, areas, findings) = divided(contours.clone(), step, (&given, frame));
        let what = format!("every {step} m");
        let target = Target::Interval { step, base: 0.0 };
        let wide = check(&areas, surface.frame.area.unsigned_area(), &layer.lines, &target, 0, &what);
        assert!(wide == 0 && findings.is_empty(), "{what}: {wide} {findings:?}");
        check_above(&areas, &what);
        let of = |kind: BandKind| areas.iter().filter(|area| area.kind == kind).collect::<Vec<_>>();
        let (lakes, seas) = (of(BandKind::Lake), of(BandKind::Sea));
        assert!(lakes.len() == 1 && !seas.is_empty(), "{what}: {} {}", lakes.len(), seas.len());
        assert_eq!((lakes[0].from, lakes[0].to, lakes[0].rings.len()), (Some(33.0), Some(33.0), 2), "{what}");
        let size = |radius: f64| 20.0 * radius * radius * (TAU / 40.0).sin();
        assert!((lakes[0].area - (size(25.0) - size(5.0))).abs() < 1e-6, "{what}");
        let sea: f64 = seas.iter().map(|area| area.area).sum();
        assert!((sea - (900.0 * 900.0 - size(400.0))).abs() < 1e-3, "{what}: {sea}");
    }
}

#[test]
fn lines_that_end_inside_the_map_bound_nothing_and_are_told() {
    let across = |y: f64, from: f64, to: f64| {
        (0..=20).map(|k| DVec2::new(from + (to - from) * f64::from(k) / 20.0, y)).collect()
    };
    let contours = vec![
        contour(10.0, across(0.0, 0.0, 1000.0)),
        contour(20.0, across(100.0, 0.0, 1000.0)),
        contour(30.0, across(200.0, 300.0, 700.0)),
        contour(40.0, across(300.0, 0.0, 1000.0)),
        contour(50.0, across(400.0, 0.0, 1000.0)),
    ];
    let target = Target::Interval { step: 10.0, base: 0.0 };
    let (surface, layer, areas, _) = divided(contours.clone(), 10.0, (&Given::default(), Frame::default()));
    assert_eq!(check(&areas, surface.frame.area.unsigned_area(), &layer.lines, &target, 0, "continued"), 0);
    // Without the lines that continue it, the contour ends inside.
    let open = ContourLayer {
        lines: layer.lines.into_iter().filter(|line| line.elevation != 30.0 || line.points.len() == 21).collect(),
        ..ContourLayer::default()
    };
    let found = bands_of_surface(&surface, &open, &target, ElevationUnit::Metre);
    assert_eq!(check(&found.value, surface.frame.area.unsigned_area(), &open.lines, &target, 1, "open"), 1);
    let kinds: Vec<FindingKind> = found.findings.iter().map(|finding| finding.kind).collect();
    assert_eq!(kinds[0], FindingKind::BandOpenLine);
    assert!(
        found.findings[0].message.contains("the contour 30 m")
            && [300.0, 700.0].contains(&found.findings[0].place.unwrap().x)
    );
    let wide = found.value.iter().find(|area| area.to.unwrap() - area.from.unwrap() > 10.0).unwrap();
    assert_eq!((wide.from, wide.to), (Some(20.0), Some(40.0)));
}
