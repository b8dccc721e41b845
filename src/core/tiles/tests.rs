//! Lines drawn at many zooms, compared with a search of all pairs.

use std::collections::{HashMap, HashSet};

use glam::DVec2;
use proptest::prelude::*;

use super::*;
use crate::geometry::{Bounds, Meeting, Segment, meeting, point_distance};

/// Lines beside each other on the waves of a slope, `apart` metres from each other, and a ring between each two.
fn slope(seed: u64, apart: f64, count: u32) -> Vec<LevelLine> {
    let phase = (seed % 97) as f64;
    let wave = |x: f64| 40.0 * (x / 55.0 + phase).sin() + 9.0 * (x / 7.0 + phase * 0.7).sin() + 1.5 * (x / 1.3).sin();
    let mut lines: Vec<LevelLine> = (0..count)
        .map(|k| {
            let along = (0..900).map(|i| f64::from(i) * 1.1);
            let points = along.map(|x| DVec2::new(x, wave(x) + f64::from(k) * apart) + DVec2::new(1.5e6, 4.3e6));
            LevelLine { level: k, points: points.collect() }
        })
        .collect();
    for k in 1..count {
        let middle = DVec2::new(500.0, wave(500.0) + (f64::from(k) - 0.5) * apart) + DVec2::new(1.5e6, 4.3e6);
        let points = (0..=24)
            .map(|i| middle + DVec2::from_angle(f64::from(i % 24) / 24.0 * std::f64::consts::TAU) * 0.2 * apart);
        lines.push(LevelLine { level: k, points: points.collect() });
    }
    lines
}

/// Draws a zoom: the number of lines that are left out, and of gaps.
fn draw(network: &mut Network, is_highest: bool) -> (usize, usize) {
    (network.simplify(is_highest), network.to_grid())
}

/// All segments of a network: the number of the line, and both ends.
fn segments(network: &Network) -> Vec<(usize, Segment)> {
    let vertex = |k: usize, i: usize| DVec2::from(network.line(k).vertex(i).map(|c| c as f64));
    let of_line = |k: usize| {
        let line = network.line(k);
        let count = line.count() - usize::from(!line.is_ring);
        (0..count).map(move |i| (k, Segment { a: vertex(k, i), b: vertex(k, i + 1) }))
    };
    (0..network.count()).flat_map(of_line).collect()
}

/// No lines of different levels touch, and no line touches itself, except neighbours at their common vertex.
fn assert_apart(network: &Network) {
    let all = segments(network);
    for (i, (k, s)) in all.iter().enumerate() {
        assert!(s.a != s.b, "a segment without length");
        for (l, t) in &all[i + 1..] {
            let is_same_level = k != l && network.line(*k).level == network.line(*l).level;
            if is_same_level || !s.bounds().meets(&t.bounds()) {
                continue;
            }
            let found = meeting(s, t);
            let is_corner = k == l && [s.a, s.b].iter().any(|p| [t.a, t.b].contains(p)) && found == Meeting::Touch;
            assert!(found == Meeting::Apart || is_corner, "{found:?} at zoom {}: {k} {s:?}, {l} {t:?}", network.zoom());
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    #[test]
    fn nothing_touches_at_any_zoom(seed in 0_u64..1000, apart in prop_oneof![0.3_f64..3.0, 3.0_f64..40.0]) {
        assert_apart_at_zooms(slope(seed, apart, 8));
    }
}

/// Draws lines at five zooms, of which the lower ones show every second level.
fn assert_apart_at_zooms(lines: Vec<LevelLine>) {
    let count = lines.len();
    let mut network = Network::new(lines, 14);
    let (left_out, gaps) = draw(&mut network, true);
    assert_apart(&network);
    assert!(gaps > 0 || network.count() + left_out == count);
    let mut network = network.coarser(|level| level % 2 == 0);
    for _ in 0..4 {
        draw(&mut network, false);
        assert_apart(&network);
        network = network.coarser(|_| true);
    }
}

#[test]
fn a_line_never_folds_back_onto_itself() {
    assert_apart_at_zooms(slope(855, 0.454_886_567_701_236_1, 8));
}

#[test]
fn lines_that_a_grid_cannot_hold_make_it_finer() {
    let mut network = Network::new(slope(5, 0.2, 6), 14);
    let (_, gaps) = draw(&mut network, true);
    assert_apart(&network);
    assert_eq!(gaps, 0);
    assert!(network.extent() > EXTENT, "a step is {} m", tile_size(14) / f64::from(EXTENT));
}

#[test]
fn what_touches_already_gets_a_gap() {
    let line = |level: u32, y: f64| LevelLine {
        level,
        points: (0..50).map(|i| DVec2::new(f64::from(i) * 9.0, y * (f64::from(i) - 25.0)) + 4e5).collect(),
    };
    let mut network = Network::new(vec![line(1, 1.0), line(2, -1.0)], 14);
    let (_, gaps) = draw(&mut network, true);
    assert!(gaps > 0);
}

#[test]
fn lines_stay_where_they_are_and_lose_most_of_their_vertices() {
    let lines = slope(11, 25.0, 6);
    let count: usize = lines.iter().map(|line| line.points.len()).sum();
    let mut network = Network::new(lines.clone(), 14);
    draw(&mut network, true);
    assert_eq!(network.extent(), EXTENT);
    let all = segments(&network);
    assert!(all.len() < count / 2, "{} of {count}", all.len());
    let unit = tile_size(14) / f64::from(EXTENT);
    for line in lines.iter().take(6) {
        for p in &line.points {
            let place = DVec2::new(p.x + HALF_WIDTH, HALF_WIDTH - p.y) / unit;
            let near = all.iter().map(|(_, s)| point_distance(place, s)).fold(f64::INFINITY, f64::min);
            // One unit by leaving out vertices, three quarters by the grid.
            assert!(near < 1.8, "{near}");
        }
    }
    for _ in 0..4 {
        network = network.coarser(|_| true);
        draw(&mut network, false);
        let longest = segments(&network).iter().map(|(_, s)| s.a.distance(s.b)).fold(0.0, f64::max);
        assert!(longest <= 1030.0, "{longest}");
    }
}

#[test]
fn lines_of_one_level_stay_joined_where_three_ends_meet() {
    let centre = DVec2::new(1.23e6, 4.56e6);
    let arm = |turn: f64| LevelLine {
        level: 4,
        points: (0..40)
            .map(|i| centre + DVec2::from_angle(turn + 0.004 * f64::from(i)) * 12.3 * f64::from(i))
            .collect(),
    };
    let mut network = Network::new(vec![arm(0.3), arm(2.4), arm(4.5)], 14);
    let (left_out, gaps) = draw(&mut network, true);
    assert_eq!((network.count(), left_out, gaps), (3, 0, 0));
    let starts: HashSet<[i64; 2]> = (0..3).map(|k| network.line(k).vertex(0)).collect();
    assert_eq!(starts.len(), 1, "{starts:?}");
}

#[test]
fn runs_hold_every_segment_in_each_tile_that_it_meets() {
    let mut network = Network::new(slope(3, 30.0, 5), 16);
    draw(&mut network, true);
    let extent = f64::from(network.extent());
    let all = runs(&network, |level| level != 2);
    let mut tiles: HashMap<TilePlace, Vec<(usize, Segment)>> = HashMap::new();
    for run in &all {
        let line = network.line(run.line as usize);
        assert!(line.level != 2 && run.segments > 0);
        let vertex = |k: u32| DVec2::from(line.vertex((run.first + k) as usize).map(|c| c as f64));
        let list = tiles.entry(run.tile).or_default();
        list.extend((0..run.segments).map(|k| (run.line as usize, Segment { a: vertex(k), b: vertex(k + 1) })));
    }
    assert!(tiles.len() > 3);
    for (tile, held) in &tiles {
        let corner = DVec2::new(f64::from(tile.x), f64::from(tile.y)) * extent;
        let own = Bounds { min: corner, max: corner + extent }.grown((extent * BUFFER).floor());
        let mut expected: Vec<_> = segments(&network)
            .into_iter()
            .filter(|(k, s)| {
                network.line(*k).level != 2 && s.bounds().meets(&own) && s.bounds().max.cmplt(own.max).all()
            })
            .map(|(k, s)| (k, s.a.to_array().map(f64::to_bits), s.b.to_array().map(f64::to_bits)))
            .collect();
        let held: HashSet<_> = held
            .iter()
            .map(|(k, s)| (*k, s.a.to_array().map(f64::to_bits), s.b.to_array().map(f64::to_bits)))
            .collect();
        expected.retain(|segment| !held.contains(segment));
        assert!(expected.is_empty(), "{tile:?} lacks {expected:?}");
    }
    // A ring inside one tile is one run.
    let rings = (0..network.count()).filter(|k| network.line(*k).is_ring && network.line(*k).level != 2);
    for ring in rings {
        let parts: Vec<_> = all.iter().filter(|run| run.line as usize == ring).collect();
        let per_tile: HashSet<_> = parts.iter().map(|run| run.tile).collect();
        assert_eq!(parts.len(), per_tile.len());
    }
}
