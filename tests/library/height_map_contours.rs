//! Contours of height maps, checked against the grid itself and against an independent tracer.

#![allow(clippy::unwrap_used, reason = "helpers of tests are tests too")]

use std::collections::HashMap;

use glam::DVec2;
use proptest::prelude::*;
use tokosen::base::error::Error;
use tokosen::base::{ElevationUnit, Grid};
use tokosen::contour::Target;
use tokosen::contour::{ContourLine, Source};
use tokosen::dem::contour::{ContourParams, DemContours, SMALLEST_TOLERANCE, TOLERANCE, contours};
use tokosen::raster::Dem;
use tokosen::slice::signed_area;

use crate::common::{self, Course, Random, Terrain, crossings, traces_of};

/// The heights of a terrain as a height map.
fn dem_of(terrain: &Terrain) -> Dem {
    let half = DVec2::new(-0.5, 0.5) * terrain.cell;
    let grid = Grid {
        corner: terrain.origin + half,
        cell: DVec2::splat(terrain.cell),
        cols: terrain.cols,
        rows: terrain.rows,
    };
    Dem { grid, values: terrain.heights.iter().map(|&z| z as f32).collect(), crs: None }
}

/// Terrain with holes, and with heights in whole steps, so that many are exactly at a level.
fn damaged(mut terrain: Terrain, seed: u64) -> Terrain {
    let mut random = Random::new(seed ^ 77);
    let step = [0.0, 0.0, 0.5, 2.5][random.whole(0, 3)];
    for z in &mut terrain.heights {
        *z = if step > 0.0 { (*z / step).round() * step } else { f64::from(*z as f32) };
    }
    for _ in 0..random.whole(0, 6) {
        let (col, row) = (random.whole(0, terrain.cols - 1), random.whole(0, terrain.rows - 1));
        for n in 0..random.whole(1, 40) {
            let (c, r) = (col + n % 7, row + n / 7);
            if c < terrain.cols && r < terrain.rows {
                terrain.heights[r * terrain.cols + c] = f64::NAN;
            }
        }
    }
    terrain
}

fn run(dem: &Dem, interval: f64, tolerance: Option<f64>) -> DemContours {
    let targets = vec![Target::Interval { step: interval, base: 0.0 }];
    contours(dem, &ContourParams { targets, tolerance, ..ContourParams::default() }, &()).unwrap()
}

fn lines(found: &DemContours) -> &[ContourLine] {
    &found.layers[0].lines
}

/// Points on a line, a quarter of a cell apart or less.
fn samples(line: &[DVec2], cell: f64) -> impl Iterator<Item = DVec2> + '_ {
    line.windows(2).flat_map(move |pair| {
        let count = (4.0 * pair[0].distance(pair[1]) / cell).ceil().max(1.0) as usize;
        (0..=count).map(move |i| pair[0].lerp(pair[1], i as f64 / count as f64))
    })
}

/// No line touches another one or itself.
fn assert_apart(lines: &[ContourLine], what: &str) {
    // With a level of its own for each line, lines of one level must not touch either.
    let each: Vec<(f64, Vec<DVec2>)> = lines.iter().enumerate().map(|(k, l)| (k as f64, l.points.clone())).collect();
    let met = crossings(&each);
    assert!(met.is_empty(), "{what}: {} meetings, {}", met.len(), met[0]);
    for line in lines {
        let mut own: Vec<[u64; 2]> = line.points.iter().map(|p| [p.x.to_bits(), p.y.to_bits()]).collect();
        own.sort_unstable();
        let before = own.len();
        own.dedup();
        assert_eq!(before - own.len(), usize::from(line.is_closed()), "{what}: a line passes a point twice");
    }
}

/// Which corner a line must have on its right where it crosses a side of a square, and how often it does.
#[derive(Default, Clone, Copy)]
struct Passed {
    times: usize,
    is_right: bool,
}

/// Lines cross exactly those sides of squares that have the level between their ends, once, with the higher end on
/// their right. So they are complete, correctly directed, and every cell centre is on its side. Lines end only at the
/// border of the data.
fn assert_topology(dem: &Dem, found: &DemContours, interval: f64, what: &str) {
    let (cols, rows) = (dem.grid.cols, dem.grid.rows);
    let z = |col: usize, row: usize| f64::from(dem.values[row * cols + col]);
    let is_square = |col: usize, row: usize| {
        col + 1 < cols && row + 1 < rows && (0..4).all(|i| z(col + i % 2, row + i / 2).is_finite())
    };
    // The number of squares with data at a side, by its west or north end.
    let squares = |along_x: bool, col: usize, row: usize| {
        let other = if along_x { row.checked_sub(1).map(|r| (col, r)) } else { col.checked_sub(1).map(|c| (c, row)) };
        usize::from(is_square(col, row)) + usize::from(other.is_some_and(|(c, r)| is_square(c, r)))
    };
    let mut levels: HashMap<u64, HashMap<(bool, usize, usize), Passed>> = HashMap::new();
    for line in lines(found) {
        let level = line.elevation;
        let passed = levels.entry(level.to_bits()).or_default();
        // Vertices lie on sides; rounding must not take them off.
        let snapped = |v: f64| if (v - v.round()).abs() < 1e-7 { v.round() } else { v };
        let place = |p: &DVec2| dem.grid.place(*p).to_array().map(snapped);
        let places: Vec<[f64; 2]> = line.points.iter().map(place).collect();
        for pair in places.windows(2) {
            for axis in 0..2 {
                let (from, to) = (pair[0][axis], pair[1][axis]);
                let (low, high) = (from.min(to), from.max(to));
                // Sides at whole numbers in the half-open range.
                for at in (low.floor() as i64 + 1)..=(high.floor() as i64) {
                    let share = (at as f64 - from) / (to - from);
                    let other = pair[0][1 - axis] + share * (pair[1][1 - axis] - pair[0][1 - axis]);
                    let (fixed, along) = (at as usize, other.floor() as usize);
                    let along_x = axis == 1;
                    let (col, row) = if along_x { (along, fixed) } else { (fixed, along) };
                    let far = if along_x { (col + 1, row) } else { (col, row + 1) };
                    // Rows grow southwards: going east, the south end is on the right; going south, the west end.
                    let forwards = to > from;
                    let right = if along_x == forwards { (col, row) } else { far };
                    let left = if along_x == forwards { far } else { (col, row) };
                    let is_right = z(right.0, right.1) >= level && z(left.0, left.1) < level;
                    let entry = passed.entry((along_x, col, row)).or_default();
                    (entry.times, entry.is_right) = (entry.times + 1, is_right);
                }
            }
        }
        if !line.is_closed() {
            for [x, y] in [places[0], places[places.len() - 1]] {
                let along_x = y == y.round();
                assert!(along_x != (x == x.round()), "{what}: an end at {x} {y} is not on a side");
                let at_side = squares(along_x, x.floor() as usize, y.floor() as usize);
                assert_eq!(at_side, 1, "{what}: a line ends inside, at {x} {y}");
            }
        }
    }
    let (mut missing, none) = (0, HashMap::new());
    let extremes = dem.values.iter().filter(|z| z.is_finite());
    let (low, high) = extremes.fold((f32::MAX, f32::MIN), |(low, high), z| (low.min(*z), high.max(*z)));
    for k in (f64::from(low) / interval).ceil() as i64..=(f64::from(high) / interval).floor() as i64 {
        let level = k as f64 * interval;
        let passed = levels.get(&level.to_bits()).unwrap_or(&none);
        for (row, col, along_x) in
            (0..rows).flat_map(|r| (0..cols).flat_map(move |c| [(r, c, true), (r, c, false)].into_iter()))
        {
            let far = if along_x { (col + 1, row) } else { (col, row + 1) };
            let sides = squares(along_x, col, row);
            if far.0 >= cols || far.1 >= rows || sides == 0 {
                continue;
            }
            let is_crossed = (z(col, row) >= level) != (z(far.0, far.1) >= level);
            let found = passed.get(&(along_x, col, row)).copied().unwrap_or_default();
            let place = || format!("{what}: side {along_x} of column {col}, row {row} at level {level}");
            assert!(found.times <= usize::from(is_crossed), "{}, crossed {} times", place(), found.times);
            assert!(found.times == 0 || found.is_right, "{}: higher ground is on the left", place());
            // Where a line begins or ends on a side, it may be on either side of it.
            missing += usize::from(is_crossed && found.times == 0 && sides == 2);
        }
    }
    assert_eq!(missing, 0, "{what}: {missing} sides are not crossed");
}

/// Lines are within the tolerance of those of the independent tracer, and these of them.
fn assert_near(terrain: &Terrain, found: &DemContours, interval: f64, what: &str) -> f64 {
    // A single cell at a level has a ring, so near to it that the tracer gives only the cell's centre.
    let raw = traces_of(&terrain.heights, terrain.cols, terrain.rows, terrain.cell, interval, terrain.origin);
    let most = found.tolerance * (1.0 + 1e-9) + 1e-7;
    let mut by_level: HashMap<u64, [Vec<&[DVec2]>; 2]> = HashMap::new();
    for (level, line) in &raw {
        by_level.entry(level.to_bits()).or_default()[0].push(line);
    }
    for line in lines(found) {
        by_level.entry(line.elevation.to_bits()).or_default()[1].push(&line.points);
    }
    let mut largest = 0.0_f64;
    for [traced, written] in by_level.values() {
        for (lines, others) in [(written, traced), (traced, written)] {
            let others = Course::of(others.iter().copied());
            for p in lines.iter().flat_map(|line| samples(line, terrain.cell)) {
                let off = others.distance(p);
                assert!(off <= most, "{what}: {p} is {off} off");
                largest = largest.max(off);
            }
        }
    }
    largest
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 4, ..common::draws() })]

    #[test]
    fn lines_are_apart_complete_directed_and_near(seed in 0_u64..10_000, tolerance in 0..4_usize) {
        let shares = [None, Some(0.0), Some(0.15), Some(3.0)];
        let mut checked = 0;
        for terrain in common::all_kinds(seed) {
            let terrain = damaged(terrain, seed);
            let interval = terrain.interval / [1.0, 2.0, 4.0][(seed % 3) as usize];
            let what = format!("{} {seed} {tolerance}", terrain.kind);
            let dem = dem_of(&terrain);
            let found = run(&dem, interval, shares[tolerance].map(|share: f64| share * terrain.cell));
            assert_apart(lines(&found), &what);
            assert_topology(&dem, &found, interval, &what);
            let largest = assert_near(&terrain, &found, interval, &what);
            prop_assert!(lines(&found).iter().all(|line| line.source == Source::HeightMap));
            checked += usize::from(largest > 0.0);
        }
        prop_assert!(checked >= 5, "only {} kinds have lines", checked);
    }
}

#[test]
fn few_vertices_are_left_and_the_course_is_smoother() {
    let terrain = common::hills(5, 120, 120);
    let dem = dem_of(&terrain);
    let found = run(&dem, 2.0, None);
    assert_eq!(found.tolerance, TOLERANCE * terrain.cell);
    let vertices: usize = lines(&found).iter().map(|line| line.points.len()).sum();
    assert!((vertices as f64) < 0.3 * found.crossings as f64, "{vertices} of {}", found.crossings);
    let exact = run(&dem, 2.0, Some(0.0));
    assert_eq!(exact.tolerance, SMALLEST_TOLERANCE * terrain.cell);
    assert_eq!(exact.crossings, found.crossings);
    assert_eq!(lines(&exact).len(), lines(&found).len());
    // The sum of all bends, on rough ground.
    let dem = dem_of(&common::fractal(5, 120, 120));
    let (found, exact) = (run(&dem, 2.0, None), run(&dem, 2.0, Some(0.0)));
    let turned = |found: &DemContours| {
        let bends = lines(found).iter().flat_map(|line| line.points.windows(3));
        bends.map(|w| (w[1] - w[0]).angle_to(w[2] - w[1]).abs()).sum::<f64>()
    };
    assert!(turned(&found) < 0.95 * turned(&exact), "{} of {}", turned(&found), turned(&exact));
}

/// A height map with cells of 1 m.
fn small(rows: &[&[f32]]) -> Dem {
    let grid = Grid { corner: DVec2::new(100.0, 200.0), cell: DVec2::ONE, cols: rows[0].len(), rows: rows.len() };
    Dem { grid, values: rows.concat(), crs: None }
}

#[test]
fn ground_exactly_at_a_level_is_above_it() {
    // A lake at 100 m in higher ground: no line. Its outlet is lower.
    let lake = small(&[&[103.0; 5], &[103.0, 100.0, 100.0, 100.0, 103.0], &[103.0; 5]]);
    assert!(lines(&run(&lake, 100.0, None)).is_empty());
    // A plateau at 100 m in lower ground: one ring.
    let low = [97.0; 6];
    let flat = [97.0, 100.0, 100.0, 100.0, 100.0, 97.0];
    let found = run(&small(&[&low, &flat, &flat, &low]), 100.0, None);
    assert_eq!(lines(&found).len(), 1);
    let ring = &lines(&found)[0];
    assert!(ring.is_closed() && !ring.depression && !ring.index);
    assert!(signed_area(&ring.points) < 0.0, "clockwise around higher ground");
    // A single top and a crest at 100 m have a ring, or a line on each side that is in the map.
    let top = [97.0, 97.0, 100.0, 97.0, 97.0, 97.0];
    let (to_edge, whole) = ([97.0, 97.0, 100.0, 100.0, 100.0, 100.0], [100.0; 6]);
    let cases: [(&[&[f32]], &[bool]); 6] = [
        (&[&low, &top, &low], &[true]),
        (&[&low, &flat, &low], &[true]),
        (&[&low, &to_edge, &low], &[false]),
        (&[&low, &whole, &low], &[false, false]),
        (&[&whole, &low, &low], &[false]),
        (&[&low, &low, &top], &[false]),
    ];
    for (rows, closed) in cases {
        for tolerance in [None, Some(0.0), Some(0.01)] {
            let found = run(&small(rows), 100.0, tolerance);
            assert_eq!(lines(&found).iter().map(ContourLine::is_closed).collect::<Vec<_>>(), closed, "{rows:?}");
            assert_apart(lines(&found), "a crest");
            assert!(lines(&found).iter().all(|line| !line.depression), "{rows:?}");
        }
    }
    // A hollow.
    let found = run(&small(&[&[103.0; 4], &[103.0, 98.0, 98.0, 103.0], &[103.0; 4]]), 100.0, None);
    assert!(lines(&found)[0].depression);
}

#[test]
fn cells_without_data_end_lines_and_single_columns_have_none() {
    let slope: &[f32] = &[0.0, 2.0, 4.0, 6.0, 8.0, 10.0];
    let mut dem = small(&[slope; 7]);
    dem.values[3 * 6 + 2] = f32::NAN;
    let found = run(&dem, 5.0, None);
    // The squares around the hole have no lines: the level between 4 and 6 m is cut.
    let of_five: Vec<_> = lines(&found).iter().filter(|line| line.elevation == 5.0).collect();
    assert_eq!(of_five.len(), 2);
    let single = small(&[&[1.0], &[9.0]]);
    assert!(lines(&run(&single, 5.0, None)).is_empty());
    let nothing = small(&[&[f32::NAN; 3] as &[f32]; 3]);
    let targets = vec![Target::Levels(vec![5.0])];
    let refused = contours(&nothing, &ContourParams { targets, ..ContourParams::default() }, &()).unwrap_err();
    assert!(matches!(refused, Error::Data(_)), "{refused}");
}

#[test]
fn several_targets_share_their_lines_and_units_are_exact() {
    let terrain = common::volcano(9, 60, 60);
    let dem = dem_of(&terrain);
    let targets = [10.0, 5.0].map(|step| Target::Interval { step, base: 0.0 }).to_vec();
    let params = ContourParams { targets, ..ContourParams::default() };
    let found = contours(&dem, &params, &()).unwrap();
    let names: Vec<&str> = found.layers.iter().map(|layer| layer.name.as_str()).collect();
    assert_eq!(names, ["contours_10m", "contours_5m"]);
    for line in &found.layers[0].lines {
        assert!(found.layers[1].lines.iter().any(|other| other.points == line.points));
    }
    let index: Vec<f64> = found.layers[1].lines.iter().filter(|line| line.index).map(|line| line.elevation).collect();
    assert!(!index.is_empty() && index.iter().all(|z| z % 25.0 == 0.0), "{index:?}");
    // A plateau at 2600 feet, as a file in feet is read.
    let unit = ElevationUnit::Foot;
    let feet = |z: f64| unit.metres(z) as f32;
    let (low, high) = ([feet(2595.0); 4], [feet(2595.0), feet(2600.0), feet(2600.0), feet(2595.0)]);
    let dem = small(&[&low, &high, &high, &low]);
    let targets = vec![Target::Interval { step: 100.0, base: 0.0 }];
    let found = contours(&dem, &ContourParams { targets, unit, ..ContourParams::default() }, &()).unwrap();
    assert_eq!(found.layers[0].name, "contours_100ft");
    assert_eq!(lines(&found).iter().map(|line| unit.from_metres(line.elevation)).collect::<Vec<_>>(), [2600.0]);
    // A list: its interval is the smallest difference.
    let targets = vec![Target::Levels(vec![812.5, 840.0, 850.0, 855.0])];
    let found = contours(&dem_of(&terrain), &ContourParams { targets, ..ContourParams::default() }, &()).unwrap();
    assert!(lines(&found).iter().all(|line| line.index == (line.elevation == 850.0)));
    assert!(lines(&found).iter().any(|line| line.index));
}

#[test]
fn the_result_does_not_depend_on_the_number_of_threads() {
    let dem = dem_of(&common::fractal(3, 110, 90));
    let targets = vec![Target::Interval { step: 3.0, base: 1.0 }];
    let params = ContourParams { targets, smooth: Some(12.0), ..ContourParams::default() };
    let [one, four] = [1, 4].map(|threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| contours(&dem, &params, &()).unwrap())
    });
    assert!(one == four && !lines(&one).is_empty());
    assert!(one.smoothing.is_some_and(|change| change.rms > 0.0));
    assert_apart(lines(&one), "smoothed");
}

#[test]
fn parameters_without_sense_are_refused() {
    let dem = dem_of(&common::hills(1, 40, 40));
    let good = ContourParams { targets: vec![Target::Levels(vec![5.0])], ..ContourParams::default() };
    let none = ContourParams { targets: vec![], ..good.clone() };
    let close = ContourParams { targets: vec![Target::Levels(vec![500.0, 500.000_001])], ..good.clone() };
    let huge = ContourParams { memory: Some(100), ..good.clone() };
    let negative = ContourParams { tolerance: Some(-1.0), ..good.clone() };
    let smooth = ContourParams { smooth: Some(1e9), ..good.clone() };
    let mut high = dem.clone();
    high.values.iter_mut().zip([499.0, 501.0].iter().cycle()).for_each(|(z, other)| *z = *other);
    let refused = |dem: &Dem, params: &ContourParams| contours(dem, params, &()).unwrap_err();
    assert!(matches!(refused(&dem, &none), Error::Parameter(_)));
    assert!(
        matches!(refused(&high, &close), Error::Parameter(text) if text.contains("closer than heights of 32 bits"))
    );
    assert!(matches!(refused(&dem, &huge), Error::OutOfMemory { .. }));
    assert!(matches!(refused(&dem, &negative), Error::OutOfRange { .. }));
    assert!(matches!(refused(&dem, &smooth), Error::OutOfRange { .. }));
}
