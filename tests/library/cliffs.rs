//! Cliffs: the surface jumps across them, and contours that end there are no fault.

use glam::DVec2;
use tokosen::base::error::FindingKind;
use tokosen::contour::{CliffLine, Contour, ContourMap};
use tokosen::features::Features;
use tokosen::terrain::{Preparation, Terrain};
use tokosen::{GridSpec, Input, InputOptions, Options};

/// Even slopes on both sides of a cliff at x = 0: `z = 50 + y / 10` in the west, 20 m lower in the east. Contours every 10 m
/// end 3 m before the cliff.
fn map() -> ContourMap {
    let contour = |level: i32, is_west: bool| {
        let y = 10.0 * f64::from(level - if is_west { 50 } else { 30 });
        let side = if is_west { -1.0 } else { 1.0 };
        let points = (0..=12).map(|i| DVec2::new(side * (3.0 + 25.0 * f64::from(i)), y)).collect();
        Contour { elevation: f64::from(level), points, feature: 0.into() }
    };
    let levels = |from: i32| (0..=6).map(move |k| from + 10 * k);
    let contours = levels(50).map(|z| contour(z, true)).chain(levels(30).map(|z| contour(z, false)));
    ContourMap { contours: contours.collect(), ..ContourMap::default() }
}

fn truth(x: f64, y: f64) -> f64 {
    if x < 0.0 { 50.0 + y / 10.0 } else { 30.0 + y / 10.0 }
}

/// The root mean square error within 60 m of the cliff, and the kinds of the findings.
fn error(with_cliff: bool) -> (f64, Vec<FindingKind>) {
    let mut input = Input::from_map(map(), &InputOptions::default()).expect("the map is sound");
    if with_cliff {
        let points = vec![DVec2::new(0.0, -10.0), DVec2::new(0.0, 610.0)];
        let cliffs = vec![CliffLine { points, feature: 1.into() }];
        input.add(Features { cliffs, ..Features::default() }, None).expect("there is no system");
    }
    let grid = GridSpec::Cell(10.0);
    let options = Options { grid: Some(grid.clone()), preparation: Preparation::default(), ..Options::default() };
    let terrain = Terrain::build(input, &options).expect("the map has a surface");
    let dem = terrain.dem(&grid).expect("the grid is small");
    let (mut sum, mut count) = (0.0, 0.0);
    for (i, z) in dem.values.iter().enumerate() {
        let p = dem.grid.center(i % dem.grid.cols, i / dem.grid.cols);
        if p.x.abs() < 60.0 && (60.0..540.0).contains(&p.y) && !z.is_nan() {
            sum += (f64::from(*z) - truth(p.x, p.y)).powi(2);
            count += 1.0;
        }
    }
    assert!(count > 400.0);
    ((sum / count).sqrt(), terrain.findings.iter().map(|f| f.kind).collect())
}

#[test]
fn the_surface_jumps_at_a_cliff_and_contours_that_end_there_are_no_fault() {
    let (without, faults) = error(false);
    let (with, notes) = error(true);
    assert!(faults.iter().any(|kind| matches!(kind, FindingKind::OpenEnd | FindingKind::Gap)), "{faults:?}");
    assert!(notes.iter().all(|kind| *kind == FindingKind::AtCliff), "{notes:?}");
    assert!(without > 1.5 && with < 0.3, "{with} m, {without} m without");
}

#[test]
fn elevations_at_a_cliff_that_is_no_multiple_of_the_interval_high_are_no_fault() {
    // The east is 35 m higher, and the contours are curved.
    let place = |x: f64, y: f64| DVec2::new(x, y + 30.0 * (x / 200.0).sin());
    let side = |is_west: bool| {
        let (turn, first) = if is_west { (-1.0, 0.0) } else { (1.0, 350.0) };
        (0..15).map(move |k| (k, 100.0 * f64::from(k) - first)).filter(|(_, y)| (-50.0..1050.0).contains(y)).map(
            move |(k, y)| Contour {
                elevation: 10.0 * f64::from(k),
                points: (0..=30).map(|i| place(turn * 20.0 * f64::from(i), y)).collect(),
                feature: (2 * k as u64 + u64::from(is_west)).into(),
            },
        )
    };
    let kinds = |with_cliff: bool| {
        let map = ContourMap { contours: side(true).chain(side(false)).collect(), ..ContourMap::default() };
        let mut input = Input::from_map(map, &InputOptions::default()).expect("the map is sound");
        if with_cliff {
            let points = vec![DVec2::new(0.0, -60.0), DVec2::new(0.0, 1060.0)];
            let cliffs = vec![CliffLine { points, feature: 1.into() }];
            input.add(Features { cliffs, ..Features::default() }, None).expect("there is no system");
        }
        let terrain = Terrain::build(input, &Options::default()).expect("the map has a surface");
        terrain.findings.iter().map(|f| f.kind).collect::<Vec<_>>()
    };
    assert!(kinds(false).contains(&FindingKind::WrongLabel), "{:?}", kinds(false));
    assert!(kinds(true).iter().all(|kind| *kind == FindingKind::AtCliff), "{:?}", kinds(true));
}
