//! A gorge between contours that are far apart along it: streams and break lines give the heights of its bottom.

use glam::DVec2;
use tokosen::base::Grid;
use tokosen::break_lines::{Bend, BreakLine};
use tokosen::contour::{Contour, ContourMap};
use tokosen::streams::{StreamLine, Streams};
use tokosen::surface::{Given, SurfaceKind, SurfaceParams, build, heights};

/// The bottom of the gorge. Its height is `y / 10`.
const BOTTOM: [DVec2; 2] = [DVec2::new(0.0, 4900.0), DVec2::new(0.0, -800.0)];

/// A gorge 80 m wide, 900 m long from contour to contour.
fn gorge() -> ContourMap {
    let contour = |k: i32| {
        let tip = 1000.0 * f64::from(k);
        let half = [(0.0, 0.0), (40.0, -40.0), (40.0, -900.0), (600.0, -950.0)];
        let west = half[1..].iter().rev().map(|&(x, y)| DVec2::new(-x, tip + y));
        let east = half.iter().map(|&(x, y)| DVec2::new(x, tip + y));
        Contour { elevation: 0.1 * tip, points: west.chain(east).collect(), feature: 0.into() }
    };
    ContourMap { contours: (0..6).map(contour).collect(), ..ContourMap::default() }
}

/// How far the skeleton surface lies above or below the bottom at most, metres.
fn farthest_from_bottom(given: &Given) -> f64 {
    let params = SurfaceParams { kind: SurfaceKind::Skeleton, ..SurfaceParams::default() };
    let surface = build(gorge(), given, &params, &()).expect("a gorge has a surface").value;
    let grid = Grid::on_multiples(DVec2::new(0.0, 1000.0), DVec2::new(1.0, 4000.0), 1.0);
    let dem = heights(&surface, &grid, &());
    assert_eq!(dem.values.len(), 3000);
    let off = dem.values.iter().enumerate().map(|(row, &z)| (f64::from(z) - 0.1 * grid.center(0, row).y).abs());
    off.fold(0.0, f64::max)
}

#[test]
fn no_ridge_or_canyon_point_stands_in_a_stream() {
    let line = StreamLine { points: BOTTOM.into(), feature: 0.into() };
    let streams = Streams { lines: vec![line], ..Streams::default() };
    let most = farthest_from_bottom(&Given { streams, ..Given::default() });
    assert!(most < 5.0, "{most}");
}

#[test]
fn no_ridge_or_canyon_point_stands_in_a_surveyed_line() {
    let heights = BOTTOM.map(|p| 0.1 * p.y).into();
    let line = BreakLine { points: BOTTOM.into(), heights, bend: Bend::Valley, feature: 7.into() };
    let most = farthest_from_bottom(&Given { break_lines: vec![line], ..Given::default() });
    assert!(most < 5.0, "{most}");
}
