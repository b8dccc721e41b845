//! Sampling against a slow oracle, on random terrain: every vertex has its neighbours as near as was asked, and all that
//! the input had is still there.

use std::cell::Cell;

use crate::common;
use crate::common::Terrain;
use glam::DVec2;
use proptest::prelude::*;
use tokosen::clean::{CleanParams, clean};
use tokosen::contour::{Contour, ContourMap};
use tokosen::resample::{SampleParams, Sampled, sample};

fn clean_map(lines: &[(f64, Vec<DVec2>)]) -> ContourMap {
    let contours = (0u64..).zip(lines).map(|(feature, (elevation, points))| Contour {
        elevation: *elevation,
        points: points.clone(),
        feature: feature.into(),
    });
    let map = ContourMap { contours: contours.collect(), ..ContourMap::default() };
    clean(map, &CleanParams::default()).expect("the terrain's contours are no heap of crossings").value
}

fn sampled(map: &ContourMap, params: &SampleParams) -> Sampled {
    sample(map.clone(), params, &CleanParams::default()).expect("a clean map and a sound ratio").value
}

fn distance(p: DVec2, a: DVec2, b: DVec2) -> f64 {
    let t = ((p - a).dot(b - a) / (b - a).length_squared()).clamp(0.0, 1.0);
    p.distance(a + (b - a) * t)
}

/// Every segment of every other line is tried.
fn nearest_other(map: &ContourMap, line: usize, p: DVec2) -> f64 {
    let others = map.contours.iter().enumerate().filter(|(k, _)| *k != line);
    others.flat_map(|(_, c)| c.points.windows(2)).map(|w| distance(p, w[0], w[1])).fold(f64::INFINITY, f64::min)
}

/// All that must hold; gives the number of vertices that only the lower limit excuses.
fn check(before: &ContourMap, result: &Sampled, ratio: f64, what: &str) -> usize {
    assert_eq!(before.contours.len(), result.map.contours.len(), "{what}");
    let mut excused = 0;
    // Some vertices are enough: the search for each goes through the whole map.
    let some = result.map.vertex_count() / 400 + 1;
    let mut count = 0;
    for (line, (old, new)) in before.contours.iter().zip(&result.map.contours).enumerate() {
        assert_eq!((old.elevation, old.feature), (new.elevation, new.feature), "{what}");
        let mut rest = new.points.iter();
        assert!(old.points.iter().all(|p| rest.any(|q| p == q)), "{what}: a vertex is gone or not in its place");
        assert!(old.points.first() == new.points.first() && rest.next().is_none(), "{what}: the ends moved");
        for (k, p) in new.points.iter().enumerate() {
            count += 1;
            if count % some != 0 {
                continue;
            }
            let near = |q: Option<&DVec2>| q.map_or(0.0, |q| q.distance(*p));
            let widest = near(k.checked_sub(1).and_then(|k| new.points.get(k))).max(near(new.points.get(k + 1)));
            let nearest = nearest_other(&result.map, line, *p);
            if widest > ratio * nearest * (1.0 + 1e-9) {
                assert!(widest < 2.0 * result.least, "{what}: {widest} between vertices, {nearest} from others at {p}");
                excused += 1;
            }
        }
    }
    assert!(excused <= 2 * result.held, "{what}: {excused} vertices excused, {} pieces held", result.held);
    let lines: Vec<_> = result.map.contours.iter().map(|c| (c.elevation, c.points.clone())).collect();
    assert!(common::crossings(&lines).is_empty(), "{what}");
    assert_eq!(result.map.vertex_count(), before.vertex_count() + result.added, "{what}");
    excused
}

fn cases() -> ProptestConfig {
    let few = if std::env::var_os("PROPTEST_CASES").is_some() { ProptestConfig::default().cases } else { 3 };
    ProptestConfig { cases: few, ..common::draws() }
}

/// Small grids: the oracle's time grows with the square of the vertices.
fn small_terrain(seed: u64) -> Vec<Terrain> {
    vec![
        common::hills(seed, 40, 30),
        common::fractal(seed, 30, 30),
        common::saddles(seed, 40, 30),
        common::cliffs(seed, 30, 30, 0.2),
        common::plane(seed, 30, 30),
        common::spiral_valley(seed, 30, 30),
    ]
}

#[test]
fn every_vertex_has_near_neighbours() {
    let (given, added) = (Cell::new(0), Cell::new(0));
    proptest!(cases(), |(seed in any::<u64>(), ratio in 0.2f64..0.99)| {
        for terrain in small_terrain(seed) {
            let map = clean_map(&terrain.contours());
            let result = sampled(&map, &SampleParams { ratio, ..SampleParams::default() });
            check(&map, &result, ratio, terrain.kind);
            prop_assert_eq!(result.whole, 0);
            given.set(given.get() + map.vertex_count());
            added.set(added.get() + result.added);
        }
    });
    // Measured: 0.75 new vertices for each given one.
    assert!(2 * added.get() > given.get(), "{} new vertices beside {} given ones", added.get(), given.get());
}

proptest! {
    #![proptest_config(cases())]

    #[test]
    fn neither_threads_nor_order_matter(seed in any::<u64>()) {
        let terrain = common::fractal(seed, 50, 50);
        let lines = terrain.contours();
        let run = |lines: &[(f64, Vec<DVec2>)], threads: usize| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("a pool");
            let mut result = pool.install(|| sampled(&clean_map(lines), &SampleParams::default()));
            result.map.contours.iter_mut().for_each(|c| c.feature = 0.into());
            result
        };
        let one = run(&lines, 1);
        prop_assert_eq!(&one, &run(&lines, 2));
        let mut turned = lines.clone();
        turned.reverse();
        turned.rotate_left(lines.len() / 3);
        prop_assert_eq!(&one, &run(&turned, 2));
    }
}

#[test]
fn ratios_near_their_ends() {
    let terrain = common::hills(7, 20, 20);
    let map = clean_map(&terrain.contours());
    for ratio in [0.03, 1.0 - 1e-12] {
        let result = sampled(&map, &SampleParams { ratio, ..SampleParams::default() });
        check(&map, &result, ratio, "hills");
        assert!(ratio > 0.5 || result.added > 10 * map.vertex_count());
    }
}

/// Lines 50 m apart; the last comes down to a millimetre from the one before and goes up again.
#[test]
fn a_cliff_is_held_by_the_lower_limit() {
    let at = |x: f64, y: f64| DVec2::new(36_000.0 + x, -27_000.0 + y);
    let row = |k: u32| (0..=40u32).map(|i| at(25.0 * f64::from(i), 50.0 * f64::from(k))).collect::<Vec<_>>();
    let mut lines: Vec<(f64, Vec<DVec2>)> = (0..10).map(|k| (10.0 * f64::from(k), row(k))).collect();
    for (i, p) in lines[9].1.iter_mut().enumerate() {
        p.y = -27_000.0 + 400.0 + (i.abs_diff(20) as f64 * 5.0).clamp(0.001, 50.0);
    }
    let map = clean_map(&lines);
    let result = sampled(&map, &SampleParams::default());
    let excused = check(&map, &result, 0.5, "cliff");
    assert!(excused > 0 && result.held > 0, "this cliff is not sharp enough to test anything");
    let params = SampleParams { least: Some(1e-4), ..SampleParams::default() };
    let free = sampled(&map, &params);
    assert_eq!((check(&map, &free, 0.5, "cliff"), free.held), (0, 0));
    assert!(free.added > result.added, "{} {}", free.added, result.added);
}

/// Lines as near to each other along their lengths as cleaning leaves them (of the six, every second), at coordinates so
/// large that rounding moves added points by a hundredth of that.
#[test]
fn rounding_makes_no_crossing() {
    let origin = DVec2::new(7e8, 4e9);
    let lines: Vec<(f64, Vec<DVec2>)> = (0..6u32)
        .map(|k| {
            let shift = f64::from(k) * 2e-5;
            let at = |x: f64, y: f64| origin + DVec2::new(x, y + shift);
            (f64::from(k) * 10.0, vec![at(0.0, 0.0), at(1000.7, 333.3), at(1999.9, -77.7)])
        })
        .collect();
    let map = clean_map(&lines);
    let result = sampled(&map, &SampleParams { ratio: 0.5, least: Some(10.0), ..SampleParams::default() });
    let lines: Vec<_> = result.map.contours.iter().map(|c| (c.elevation, c.points.clone())).collect();
    assert!(common::crossings(&lines).is_empty());
    assert!(map.contours.len() >= 3 && result.added > 300, "{} lines, {} new", map.contours.len(), result.added);
    for (old, new) in map.contours.iter().zip(&result.map.contours) {
        let mut rest = new.points.iter();
        assert!(old.points.iter().all(|p| rest.any(|q| p == q)));
    }
}
