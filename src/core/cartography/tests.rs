//! Supplementary contours and the rules of a scale on drawn lines.

use glam::DVec2;

use super::{Ground, Kinds, MapParams, MapScale, OfInput, Steep, for_map};
use crate::base::ElevationUnit;
use crate::contour::{ContourKind, ContourLayer, ContourLine, Interval, Source};

fn line(elevation: f64, points: Vec<DVec2>) -> ContourLine {
    let (source, index, kind) = (Source::Interpolated, false, None);
    ContourLine { elevation, points, source, index, kind, depression: false, expected: None }
}

/// A line from west to east with a vertex every 10 m.
fn across(elevation: f64, length: f64, y: impl Fn(f64) -> f64) -> ContourLine {
    let at = |k: usize| DVec2::new(k as f64 * 10.0, y(k as f64 * 10.0));
    line(elevation, (0..=(length / 10.0) as usize).map(at).collect())
}

/// A ring of 48 corners around higher ground, which is on its right.
fn ring(elevation: f64, middle: [f64; 2], radius: f64) -> ContourLine {
    let at =
        |k: usize| DVec2::from(middle) + radius * DVec2::from_angle(-std::f64::consts::TAU * (k % 48) as f64 / 48.0);
    line(elevation, (0..=48).map(at).collect())
}

/// What is left of lines with contours every 10 m, supplementary ones every 5 m where these are 100 m apart.
fn drawn(lines: Vec<ContourLine>, scale: Option<f64>, steep: Steep) -> Vec<ContourLine> {
    let interval = Interval::every(10.0);
    let kinds = Kinds { interval, unit: ElevationUnit::Metre, index_every: 5, parts: 2 };
    let params = MapParams { kinds, apart: Some(100.0), scale: scale.and_then(MapScale::new), steep };
    let mut layer = ContourLayer { lines, ..ContourLayer::default() };
    for_map(&mut layer, &params, OfInput::AsNew, &Ground { metres: DVec2::ONE, border: vec![] });
    layer.lines
}

fn supplementary(lines: Vec<ContourLine>) -> Vec<ContourLine> {
    let mut lines = drawn(lines, None, Steep::Keep);
    lines.retain(|line| line.kind == Some(ContourKind::Supplementary));
    lines
}

#[test]
fn a_line_begins_where_the_contours_beside_it_spread() {
    // 40 m apart up to x = 500 m, 140 m from 1000 m on.
    let half = |x: f64| 20.0 + 50.0 * ((x - 500.0) / 500.0).clamp(0.0, 1.0);
    let lines = vec![across(10.0, 2000.0, |x| -half(x)), across(15.0, 2000.0, |_| 0.0), across(20.0, 2000.0, half)];
    let found = supplementary(lines);
    assert_eq!(found.len(), 1);
    let ends = [found[0].points[0].x, found[0].points[found[0].points.len() - 1].x];
    // They are 80 m apart at 700 m, measured along the shortest way.
    assert!((700.0..=715.0).contains(&ends[0]) && ends[1] == 2000.0, "{ends:?}");
}

#[test]
fn a_line_close_to_another_one_is_not_drawn() {
    let lines = |gap: f64| {
        let (low, high) = (across(10.0, 1000.0, |_| 0.0), across(20.0, 1000.0, |_| 200.0));
        supplementary(vec![low, across(15.0, 1000.0, |_| gap), high]).len()
    };
    assert_eq!([1.0, 10.0].map(lines), [0, 1]);
}

#[test]
fn rings_show_tops_that_no_contour_shows() {
    let count = |lines: Vec<ContourLine>| supplementary(lines).len();
    let (low, high) = (across(10.0, 1000.0, |_| -40.0), across(20.0, 1000.0, |_| 40.0));
    let slope = vec![low.clone(), across(15.0, 1000.0, |_| 20.0), high.clone()];
    assert_eq!(count(slope.clone()), 0);
    assert_eq!(count([slope.clone(), vec![ring(15.0, [500.0, -10.0], 12.0)]].concat()), 1, "a knoll on a slope");
    assert_eq!(count([slope, vec![ring(15.0, [500.0, -10.0], 5.0)]].concat()), 0, "it is too small");
    // A ring of 10 m around one of 15 m: the top is known. Around two, the saddle is not.
    let hill = || ring(10.0, [0.0, 0.0], 45.0);
    assert_eq!(count(vec![hill(), ring(15.0, [0.0, 0.0], 20.0)]), 0);
    assert_eq!(count(vec![hill(), ring(15.0, [-20.0, 0.0], 12.0), ring(15.0, [20.0, 0.0], 12.0)]), 2);
    // A wide top: the ring of 10 m is 120 m across.
    assert_eq!(count(vec![ring(10.0, [0.0, 0.0], 60.0), ring(15.0, [0.0, 0.0], 40.0)]), 1);
    // Another contour inside: the ring is no top.
    let steps = vec![hill(), ring(15.0, [0.0, 0.0], 30.0), ring(20.0, [0.0, 0.0], 20.0)];
    assert_eq!(count(steps), 0);
}

#[test]
fn a_scale_leaves_out_small_rings_and_lines_on_steep_slopes() {
    // At 1:10 000, 0.25 mm are 2.5 m and 1 mm is 10 m. The lines are 2 m apart between x = 350 and 550 m, and 20 m beyond 250 and
    // 650 m.
    let squeezed = |k: f64| move |x: f64| k * (20.0 - 18.0 * ((200.0 - (x - 450.0).abs()) / 100.0).clamp(0.0, 1.0));
    let level = |k: usize| across(10.0 * k as f64, 900.0, squeezed(k as f64));
    let lines = || {
        [(0..=5).map(level).collect(), vec![ring(10.0, [450.0, 400.0], 4.0), ring(10.0, [450.0, 300.0], 6.0)]].concat()
    };
    let kept = drawn(lines(), Some(10_000.0), Steep::Keep);
    assert_eq!(kept.len(), 7, "one ring is too small");
    assert!(kept[0].points.len() == 2 && kept[1].points.len() >= 6, "a straight line needs two vertices");
    let thinned = drawn(lines(), Some(10_000.0), Steep::Thin);
    let of = |kind: ContourKind| thinned.iter().filter(move |line| line.kind == Some(kind) && !line.is_closed());
    assert_eq!(of(ContourKind::Index).count(), 2);
    assert_eq!(of(ContourKind::Intermediate).count(), 8, "four lines in two pieces");
    assert!(of(ContourKind::Intermediate).all(|line| line.points.iter().all(|p| !(251.0..=649.0).contains(&p.x))));
}
