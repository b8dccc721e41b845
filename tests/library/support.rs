//! Tests of what the other tests stand on: the crossing check finds what is planted, the terrains are what they say, the
//! tracer's lines are contour lines.

use crate::common::{
    Random, Terrain, all_kinds, cliffs, contours_of, crossings, plane, plateaus, saddles, same_level_crossings, volcano,
};
use crate::guarantees::{Refusal, Tally, map_of};
use geo::Intersects;
use glam::DVec2;
use tokosen::surface::{Given, SurfaceParams, build};

fn line(level: f64, points: &[(f64, f64)]) -> (f64, Vec<DVec2>) {
    (level, points.iter().map(|&(x, y)| DVec2::new(749_340.0 + x, 4_020_658.0 + y)).collect())
}

#[test]
fn lines_apart_have_no_crossings() {
    let outer = line(100.0, &[(0.0, 0.0), (0.0, 9.0), (9.0, 9.0), (9.0, 0.0), (0.0, 0.0)]);
    let inner = line(110.0, &[(2.0, 2.0), (2.0, 7.0), (7.0, 7.0), (7.0, 2.0), (2.0, 2.0)]);
    assert_eq!(crossings(&[outer, inner]), Vec::<String>::new());
    assert_eq!(crossings(&[]), Vec::<String>::new());
    assert_eq!(crossings(&[(1.0, vec![])]), Vec::<String>::new());
}

#[test]
fn meetings_of_different_levels_are_found() {
    let base = line(100.0, &[(0.0, 0.0), (10.0, 0.0), (20.0, 0.0)]);
    for (what, other, verb) in [
        ("a cross", vec![(5.0, -5.0), (5.0, 5.0)], "cross"),
        ("an end on a segment", vec![(5.0, 0.0), (5.0, 5.0)], "touch"),
        ("a shared vertex", vec![(5.0, 5.0), (10.0, 0.0), (15.0, 5.0)], "touch"),
        ("a shared end", vec![(20.0, 0.0), (25.0, 5.0)], "touch"),
        ("a stretch along it", vec![(3.0, 0.0), (7.0, 0.0)], "overlap"),
        ("a point on it", vec![(3.0, 0.0), (3.0, 0.0)], "touch"),
    ] {
        let found = crossings(&[base.clone(), line(110.0, &other)]);
        assert!(!found.is_empty() && found.iter().all(|f| f.ends_with(verb)), "{what}: {found:?}");
        let same = same_level_crossings(&[base.clone(), line(100.0, &other)]);
        assert_eq!(same.is_empty(), verb == "touch", "{what} at one level: {same:?}");
        assert_eq!(crossings(&[base.clone(), line(100.0, &other)]), Vec::<String>::new(), "{what} at one level");
    }
}

#[test]
fn nearest_miss_and_nearest_hit_are_told_apart() {
    let base = line(100.0, &[(0.0, 0.0), (10.0, 3.0)]);
    let above = |x: f64, y: f64| (110.0, vec![DVec2::new(x, y), DVec2::new(x, y + 5.0)]);
    let [a, b] = base.1[..] else { panic!("two points") };
    // The end of one segment is itself an end of the other, then one step of the floating-point numbers above it.
    assert_eq!(crossings(&[base.clone(), above(b.x, b.y)]).len(), 1);
    assert_eq!(crossings(&[base.clone(), above(b.x, b.y.next_up())]).len(), 0);
    assert_eq!(crossings(&[base.clone(), above(a.x, a.y.next_up())]).len(), 0);
}

#[test]
fn a_line_through_itself_is_found() {
    for (what, points) in [
        ("a figure of eight", vec![(0.0, 0.0), (10.0, 10.0), (10.0, 0.0), (0.0, 10.0), (0.0, 0.0)]),
        ("a fold back", vec![(0.0, 0.0), (10.0, 0.0), (5.0, 0.0), (5.0, 5.0)]),
        ("a fold back at the seam", vec![(0.0, 0.0), (10.0, 0.0), (10.0, 9.0), (5.0, 0.0), (0.0, 0.0)]),
        ("there and back", vec![(0.0, 0.0), (10.0, 0.0), (0.0, 0.0)]),
        (
            "a cross at a common vertex",
            vec![(0.0, 0.0), (5.0, 5.0), (10.0, 10.0), (10.0, 0.0), (5.0, 5.0), (0.0, 10.0)],
        ),
        ("a cross of a vertex with a segment", vec![(0.0, 0.0), (10.0, 10.0), (10.0, 0.0), (5.0, 5.0), (0.0, 10.0)]),
        (
            "an overlap further on",
            vec![(0.0, 0.0), (9.0, 0.0), (9.0, 5.0), (3.0, 5.0), (3.0, 0.0), (6.0, 0.0), (6.0, 2.0)],
        ),
    ] {
        assert!(!crossings(&[line(100.0, &points)]).is_empty(), "{what}");
    }
}

#[test]
fn a_line_that_only_touches_itself_is_let_pass() {
    for (what, points) in [
        (
            "two rings in a point",
            vec![(5.0, 5.0), (0.0, 9.0), (0.0, 0.0), (5.0, 5.0), (9.0, 0.0), (9.0, 9.0), (5.0, 5.0)],
        ),
        ("a vertex on a segment", vec![(0.0, 0.0), (10.0, 0.0), (10.0, 5.0), (5.0, 0.0), (0.0, 5.0)]),
        ("repeated points", vec![(0.0, 0.0), (0.0, 0.0), (10.0, 0.0), (10.0, 0.0), (10.0, 5.0)]),
        ("an end on the line", vec![(0.0, 0.0), (10.0, 0.0), (10.0, 5.0), (5.0, 0.0)]),
    ] {
        assert_eq!(crossings(&[line(100.0, &points)]), Vec::<String>::new(), "{what}");
    }
}

#[test]
fn points_that_are_not_finite_are_reported() {
    assert_eq!(crossings(&[line(100.0, &[(0.0, 0.0), (f64::NAN, 0.0), (1.0, 0.0)])]).len(), 1);
}

/// Every pair of random segments, compared by another library's predicate, none left out by the grid.
#[test]
fn the_grid_loses_no_pair() {
    for seed in 0..20 {
        let mut random = Random::new(seed);
        // Short and long ones, some snapped to whole numbers so that touches and overlaps occur.
        let lines: Vec<(f64, Vec<DVec2>)> = (0..300)
            .map(|n| {
                let reach = if n % 10 == 0 { 80.0 } else { 6.0 };
                let a = DVec2::new(random.between(0.0, 100.0), random.between(0.0, 60.0));
                let b = a + DVec2::new(random.between(-reach, reach), random.between(-reach, reach));
                let snap = |p: DVec2| if n % 3 == 0 { p.round() } else { p };
                (n as f64, vec![snap(a), snap(b)])
            })
            .collect();
        let plain: Vec<geo::Line<f64>> =
            lines.iter().map(|(_, p)| geo::Line::new((p[0].x, p[0].y), (p[1].x, p[1].y))).collect();
        let mut expected = 0;
        for i in 0..plain.len() {
            expected += plain[i + 1..].iter().filter(|other| plain[i].intersects(*other)).count();
        }
        assert!(expected > 100);
        assert_eq!(crossings(&lines).len(), expected, "seed {seed}");
    }
}

#[test]
fn every_terrain_gives_contours_that_do_not_cross() {
    for seed in 0..12 {
        for terrain in all_kinds(seed) {
            let lines = terrain.contours();
            assert!(lines.len() >= 2, "{} of seed {seed} has {} lines", terrain.kind, lines.len());
            assert!(terrain.heights.iter().all(|z| z.is_finite()));
            // Lines may fold onto themselves at nodes that are exactly at a level; different levels never meet.
            let exact = matches!(terrain.kind, "plateaus" | "saddles");
            let found: Vec<String> = if exact { different_levels_only(&lines) } else { crossings(&lines) };
            assert_eq!(found, Vec::<String>::new(), "{} of seed {seed}", terrain.kind);
        }
    }
}

/// Meetings of different levels: each line is taken apart into its segments, which then cannot meet as one line's.
fn different_levels_only(lines: &[(f64, Vec<DVec2>)]) -> Vec<String> {
    let segments: Vec<(f64, Vec<DVec2>)> =
        lines.iter().flat_map(|(level, points)| points.windows(2).map(|w| (*level, w.to_vec()))).collect();
    crossings(&segments)
}

#[test]
fn contours_end_only_at_the_border_and_keep_higher_ground_on_the_right() {
    for terrain in all_kinds(7) {
        let (west, north) = (terrain.origin.x, terrain.origin.y);
        let (east, south) =
            (west + (terrain.cols - 1) as f64 * terrain.cell, north - (terrain.rows - 1) as f64 * terrain.cell);
        let border = |p: DVec2| p.x == west || p.x == east || p.y == north || p.y == south;
        for (level, points) in terrain.contours() {
            let (first, last) = (points[0], points[points.len() - 1]);
            assert!(first == last || (border(first) && border(last)), "{}: {first} to {last}", terrain.kind);
            for p in &points {
                assert!((height_at(&terrain, *p) - level).abs() < 1e-6 * level.max(1.0), "{} at {p}", terrain.kind);
            }
        }
        if terrain.kind == "plane" || terrain.kind == "volcano" {
            right_side_is_higher(&terrain);
        }
    }
}

/// A little beside the middle of every longer segment the ground is higher on the right than on the left.
fn right_side_is_higher(terrain: &Terrain) {
    let mut checked = 0;
    for (_, points) in terrain.contours() {
        for w in points.windows(2).filter(|w| w[0].distance(w[1]) > 0.5 * terrain.cell) {
            let right = (w[0] - w[1]).perp().normalize() * 0.05;
            let middle = (w[0] + w[1]) / 2.0;
            assert!(
                height_at(terrain, middle + right) > height_at(terrain, middle - right),
                "{} at {middle}",
                terrain.kind
            );
            checked += 1;
        }
    }
    assert!(checked > 100);
}

/// Bilinear height at a place inside the grid.
fn height_at(terrain: &Terrain, p: DVec2) -> f64 {
    let (x, y) = ((p.x - terrain.origin.x) / terrain.cell, (terrain.origin.y - p.y) / terrain.cell);
    let col = (x.max(0.0) as usize).min(terrain.cols - 2);
    let row = (y.max(0.0) as usize).min(terrain.rows - 2);
    let (u, v) = (x - col as f64, y - row as f64);
    let z = |c: usize, r: usize| terrain.heights[(row + r) * terrain.cols + col + c];
    (z(0, 0) * (1.0 - u) + z(1, 0) * u) * (1.0 - v) + (z(0, 1) * (1.0 - u) + z(1, 1) * u) * v
}

#[test]
fn the_tracer_gives_known_lines() {
    // One high node in the middle: a ring around it, clockwise, half way to its neighbours.
    let mut heights = vec![0.0; 9];
    heights[4] = 10.0;
    let lines = contours_of(&heights, 3, 3, 2.0, 5.0, DVec2::new(0.0, 4.0));
    let levels: Vec<f64> = lines.iter().map(|l| l.0).collect();
    assert_eq!(levels, [5.0], "the lines of levels 0 and 10 have no extent");
    let ring = &lines[0].1;
    assert_eq!(ring.len(), 5);
    assert_eq!(ring[0], ring[4]);
    assert!(ring.contains(&DVec2::new(2.0, 3.0)) && ring.contains(&DVec2::new(3.0, 2.0)));
    let area: f64 = ring.windows(2).map(|w| w[0].perp_dot(w[1])).sum::<f64>() / 2.0;
    assert_eq!(area, -2.0);
    // A row of nodes exactly at the level, lower on both sides: the line folds onto itself and is kept.
    let ridge = [0.0, 0.0, 0.0, 0.0, 5.0, 5.0, 5.0, 5.0, 0.0, 0.0, 0.0, 0.0];
    let lines = contours_of(&ridge, 4, 3, 1.0, 5.0, DVec2::ZERO);
    assert_eq!(lines.len(), 2, "one along each side of the ridge");
    assert!(lines.iter().all(|l| l.1.len() == 4));
    // Lines end at a height that is missing.
    heights[0] = f64::NAN;
    let lines = contours_of(&heights, 3, 3, 2.0, 5.0, DVec2::new(0.0, 4.0));
    assert_eq!((lines.len(), lines[0].1.len()), (1, 4));
}

#[test]
fn terrains_are_what_they_say() {
    assert_eq!(all_kinds(3), all_kinds(3));
    for (a, b) in all_kinds(3).iter().zip(&all_kinds(4)) {
        assert_ne!(a.heights, b.heights, "{}", a.kind);
    }
    let closed = |l: &(f64, Vec<DVec2>)| l.1.first() == l.1.last();
    assert!(!plane(5, 50, 60).contours().iter().any(closed));
    for seed in 0..10 {
        for terrain in [plateaus(seed, 80, 60), saddles(seed, 60, 80)] {
            let exact = terrain.heights.iter().filter(|z| **z % terrain.interval == 0.0).count();
            assert!(exact * 20 > terrain.heights.len(), "{} of seed {seed}: {exact} nodes at a level", terrain.kind);
        }
        let sinks = volcano(seed, 80, 80).contours().iter().filter(|l| closed(l) && is_counterclockwise(&l.1)).count();
        assert!(sinks >= 2, "seed {seed}: {sinks} depression contours");
    }
}

/// Higher ground on the right: a ring that runs counterclockwise has lower ground inside.
fn is_counterclockwise(ring: &[DVec2]) -> bool {
    ring.windows(2).map(|w| (w[0] - ring[0]).perp_dot(w[1] - ring[0])).sum::<f64>() > 0.0
}

#[test]
fn cliffs_bring_lines_as_close_as_asked() {
    let terrain = cliffs(2, 40, 40, 1e-3);
    let lines = terrain.contours();
    assert!(lines.len() >= 1000);
    assert_eq!(crossings(&lines), Vec::<String>::new());
    // Vertices on the same column of the grid, from south to north.
    let mut vertices: Vec<DVec2> = lines.iter().flat_map(|l| l.1.iter().copied()).collect();
    vertices.sort_by(|a, b| a.x.total_cmp(&b.x).then(a.y.total_cmp(&b.y)));
    let steps = vertices.windows(2).filter(|w| w[0].x == w[1].x && w[0].y != w[1].y).map(|w| w[1].y - w[0].y);
    let nearest = steps.fold(f64::INFINITY, f64::min) / terrain.cell;
    assert!(nearest > 1e-4 && nearest < 2e-3, "{nearest}");
}

#[test]
fn only_maps_without_ground_are_refused() {
    let flat = |level: f64, y: f64| (level, vec![DVec2::new(0.0, y), DVec2::new(9.0, y)]);
    let refusal = |lines: &[(f64, Vec<DVec2>)]| {
        let made = build(map_of(lines), &Given::default(), &SurfaceParams::default(), &());
        Refusal::of(&made.expect_err("no surface can be made of that"))
    };
    assert_eq!(refusal(&[]), Some(Refusal::NoContour));
    assert_eq!(refusal(&[flat(10.0, 0.0)]), Some(Refusal::OneContour));
    assert_eq!(refusal(&[flat(10.0, 0.0), flat(10.0, 5.0)]), Some(Refusal::OneLevel));
    assert_eq!(
        refusal(&[flat(10.0, 0.0), (20.0, vec![DVec2::new(10.0, 0.0), DVec2::new(12.0, 0.0)])]),
        Some(Refusal::NoArea)
    );
    // Contours that cross although they should be clean are a fault.
    let across = (20.0, vec![DVec2::new(5.0, -5.0), DVec2::new(5.0, 5.0)]);
    assert_eq!(refusal(&[flat(10.0, 0.0), across]), None);
}

#[test]
#[should_panic(expected = "0.500 of the cases were made")]
fn a_tally_with_too_few_cases_fails() {
    let tally = Tally::default();
    let params = SurfaceParams::default();
    let flat = |level: f64, y: f64| (level, vec![DVec2::new(0.0, y), DVec2::new(9.0, y + 1.0)]);
    for lines in [vec![flat(10.0, 0.0)], vec![flat(10.0, 0.0), flat(20.0, 5.0)]] {
        tally.take(build(map_of(&lines), &Given::default(), &params, &()), &[Refusal::OneContour], "some lines");
    }
    tally.assert_share(0.6, 0.0);
}

#[test]
#[should_panic(expected = "there is one contour line only")]
fn a_tally_accepts_no_other_refusal() {
    let line = (10.0, vec![DVec2::ZERO, DVec2::ONE]);
    let made = build(map_of(&[line]), &Given::default(), &SurfaceParams::default(), &());
    Tally::default().take(made, &[Refusal::OneLevel], "one line");
}

#[test]
#[should_panic(expected = "new lines were checked")]
fn a_tally_without_new_lines_fails() {
    let tally = Tally::default();
    tally.take(Ok(()), &[], "nothing");
    tally.assert_share(1.0, 1.0);
}
