//! Contours that no cartographer would draw: each must give a surface with all guarantees, or an error that says why not.

use std::f64::consts::TAU;
use std::time::{Duration, Instant};

use crate::common::Random;
use crate::guarantees::Refusal::{self, *};
use crate::guarantees::{Lines, hold, map_of};
use glam::DVec2;
use tokosen::base::error::Error;
use tokosen::resample::{FitParams, SampleParams};
use tokosen::subdomains::Frame;
use tokosen::surface::{Given, SurfaceKind, SurfaceParams};

type Line = (f64, Vec<DVec2>);

/// Far more than any case takes on a slow machine in a test build, far less than work that grows with the square.
const LONG: Duration = Duration::from_secs(120);

/// Asks all guarantees with every kind of surface and frame, of the lines as they are and of fitted and sampled ones. Gives
/// what the steps say about it.
fn all_ways(lines: &[Line], what: &str) -> Vec<Result<(), Error>> {
    let map = map_of(lines);
    let fit = FitParams { tolerance: 0.5, sampling: None };
    let sample = SampleParams { most: 200_000, ..SampleParams::default() };
    let plain = Lines { is_exact: true, ..Lines::default() };
    let made = Lines { fit: Some(fit), sample: Some(sample), snap: 1.0, is_exact: true };
    let start = Instant::now();
    let mut said = Vec::new();
    for (kind, frame, lines) in [
        (SurfaceKind::Linear, Frame::Hull, &plain),
        (SurfaceKind::Skeleton, Frame::Box, &plain),
        (SurfaceKind::Spline, Frame::Hull, &plain),
        (SurfaceKind::Spline, Frame::Box, &made),
    ] {
        let params = SurfaceParams { kind, frame, ..SurfaceParams::default() };
        said.push(hold(map.clone(), lines, (&Given::default(), &params), what));
    }
    assert!(start.elapsed() < LONG, "{what}: {:?}", start.elapsed());
    said
}

fn all_hold(lines: &[Line], what: &str) {
    for outcome in all_ways(lines, what) {
        outcome.unwrap_or_else(|e| panic!("{what}: {e}"));
    }
}

/// Nothing can be made of the lines, for this reason.
fn refused(lines: &[Line], reason: Refusal, what: &str) {
    for outcome in all_ways(lines, what) {
        let Err(error) = outcome else { panic!("{what}: something was made of it") };
        assert_eq!(Refusal::of(&error), Some(reason), "{what}: {error}");
    }
}

fn line(points: &[(f64, f64)]) -> Vec<DVec2> {
    points.iter().map(|&p| p.into()).collect()
}

fn ring(middle: DVec2, radius: f64, corners: usize) -> Vec<DVec2> {
    let at = |k: usize| middle + radius * DVec2::from_angle((k % corners) as f64 * TAU / corners as f64);
    (0..=corners).map(at).collect()
}

#[test]
fn points_on_one_line_and_points_on_one_place() {
    let flat = |y: f64| line(&[(0.0, y), (1.0, y), (5.0, y), (9.0, y)]);
    refused(&[(10.0, flat(0.0))], OneContour, "one line");
    refused(&[(10.0, flat(0.0)), (20.0, flat(0.0))], OneContour, "two lines in one place");
    let after = line(&[(20.0, 0.0), (30.0, 0.0)]);
    refused(&[(10.0, flat(0.0)), (20.0, after)], NoArea, "two lines on one line");
    let place = line(&[(3.0, 3.0), (3.0, 3.0), (3.0, 3.0)]);
    refused(&[(10.0, place.clone()), (20.0, place)], NoContour, "points");
    all_hold(&[(10.0, flat(0.0)), (20.0, flat(7.0)), (30.0, flat(7.5))], "parallel lines");
    refused(&[], NoContour, "nothing");
    refused(&[(f64::NAN, flat(0.0)), (f64::INFINITY, flat(1.0))], NoContour, "no elevations");
    let nowhere = line(&[(f64::NAN, 0.0), (1.0, f64::INFINITY)]);
    refused(&[(10.0, nowhere), (20.0, flat(0.0))], OneContour, "no places");
}

#[test]
fn lines_that_are_nearly_in_one_place() {
    let mut random = Random::new(5);
    for apart in [1e-12, 1e-9, 9e-7, 1.1e-6, 1e-3] {
        let bend: Vec<DVec2> = (0..40).map(|k| DVec2::new(f64::from(k) * 10.0, random.between(0.0, 60.0))).collect();
        let shifted = |by: f64| bend.iter().map(|p| *p + DVec2::new(0.0, by)).collect::<Vec<_>>();
        let lines = [(10.0, bend.clone()), (20.0, shifted(apart)), (30.0, shifted(80.0)), (0.0, shifted(-50.0))];
        all_hold(&lines, &format!("{apart} apart"));
        let both = [(10.0, bend.clone()), (10.0, shifted(apart)), (20.0, shifted(80.0)), (0.0, shifted(-50.0))];
        all_hold(&both, &format!("one level, {apart} apart"));
    }
}

#[test]
fn tiny_things_far_away() {
    for (far, size) in [(1e7, 1.0), (1e7, 1e-2), (-3e6, 1e-3), (1e7, 1e-4), (1e12, 1.0), (1e15, 1e3), (1e-3, 1e-5)] {
        let middle = DVec2::new(far, -0.7 * far);
        let lines: Vec<Line> =
            (1..6).map(|k| (10.0 * f64::from(k), ring(middle, size * f64::from(7 - k), 24))).collect();
        all_hold(&lines, &format!("{size} at {far}"));
    }
    let huge = [(10.0, ring(DVec2::ZERO, 1e150, 9)), (20.0, ring(DVec2::ZERO, 1e149, 9))];
    refused(&huge, NoContour, "huge");
    let tiny = [(10.0, ring(DVec2::ZERO, 1e-150, 9)), (20.0, ring(DVec2::ZERO, 1e-155, 9))];
    refused(&tiny, NoContour, "tiny");
}

#[test]
fn many_lines_through_one_point() {
    let star: Vec<Line> = (0..300)
        .map(|k| {
            let arm = 100.0 * DVec2::from_angle(f64::from(k) * TAU / 600.0);
            (f64::from(k % 7) * 10.0, vec![-arm, DVec2::ZERO, arm])
        })
        .collect();
    refused(&star, OneLevel, "a star");
    let one_level: Vec<Line> = star.iter().map(|(_, points)| (10.0, points.clone())).collect();
    let around = [(0.0, ring(DVec2::ZERO, 150.0, 50))];
    let mut outcomes = all_ways(&[one_level, around.to_vec()].concat(), "a star of one level");
    let sampled =
        outcomes.pop().expect("four ways").expect_err("so many lines near each other ask for too many points");
    assert_eq!(Refusal::of(&sampled), Some(TooManyPoints), "{sampled}");
    outcomes.into_iter().for_each(|outcome| outcome.unwrap());
    // Ends that meet in a point without crossing.
    let fan: Vec<Line> = (0..300)
        .map(|k| (f64::from(k / 50) * 10.0, vec![DVec2::ZERO, 100.0 * DVec2::from_angle(f64::from(k) * TAU / 600.0)]))
        .collect();
    refused(&fan, OneLevel, "a fan");
}

#[test]
fn spirals_and_combs() {
    let spiral = |turn: f64| {
        (0..1500)
            .map(|k| f64::from(k) * 0.05)
            .map(|a| (2.0 + 3.0 * a) * DVec2::from_angle(a + turn))
            .collect::<Vec<_>>()
    };
    let arms: Vec<Line> = (0..4).map(|k| (10.0 * f64::from(k), spiral(f64::from(k) * TAU / 4.0))).collect();
    all_hold(&arms, "a spiral of four arms");
    let comb = |y: f64, long: f64| {
        let tooth = |k: i32| {
            let x = 10.0 * f64::from(k);
            line(&[(x, y), (x + 4.9, y), (x + 4.9, y + long), (x + 5.1, y + long), (x + 5.1, y)])
        };
        (0..60).flat_map(tooth).collect::<Vec<_>>()
    };
    all_hold(&[(10.0, comb(0.0, 200.0)), (20.0, comb(250.0, 300.0)), (30.0, comb(600.0, 5.0))], "combs");
}

#[test]
fn one_level_only() {
    let rings: Vec<Line> = (0..30).map(|k| (10.0, ring(DVec2::new(f64::from(k) * 30.0, 0.0), 10.0, 12))).collect();
    refused(&rings, OneLevel, "one level");
}

#[test]
fn nested_rings() {
    let rings: Vec<Line> =
        (0..2_000).map(|k| (f64::from(k), ring(DVec2::ZERO, 10.0 + f64::from(2_000 - k), 12))).collect();
    let params = SurfaceParams { kind: SurfaceKind::Skeleton, ..SurfaceParams::default() };
    let start = Instant::now();
    hold(map_of(&rings), &Lines { is_exact: true, ..Lines::default() }, (&Given::default(), &params), "nested rings")
        .unwrap();
    assert!(start.elapsed() < LONG, "{:?}", start.elapsed());
}

#[test]
fn contours_that_touch_in_a_point() {
    let west = line(&[(0.0, 0.0), (-10.0, 8.0), (-20.0, 0.0), (-10.0, -8.0), (0.0, 0.0)]);
    let east: Vec<DVec2> = west.iter().map(|p| -*p).collect();
    let around = ring(DVec2::ZERO, 40.0, 30);
    all_hold(&[(20.0, west.clone()), (20.0, east.clone()), (10.0, around.clone())], "a figure of eight of two rings");
    let eight = [&west[..], &east[1..]].concat();
    all_hold(&[(20.0, eight), (10.0, around.clone())], "a figure of eight of one line");
    all_hold(&[(20.0, west), (30.0, east), (10.0, around)], "of two levels");
}

#[test]
fn squares_side_by_side() {
    let corner = |x: i32, y: i32| DVec2::new(f64::from(x) * 10.0, f64::from(y) * 10.0);
    let square =
        |x: i32, y: i32| vec![corner(x, y), corner(x + 1, y), corner(x + 1, y + 1), corner(x, y + 1), corner(x, y)];
    let field = |of: &dyn Fn(i32, i32) -> f64| -> Vec<Line> {
        (0..144).map(|n| (of(n % 12, n / 12), square(n % 12, n / 12))).collect()
    };
    let around = [(0.0, ring(DVec2::splat(60.0), 200.0, 40))];
    all_hold(&[field(&|_, _| 10.0), around.to_vec()].concat(), "squares of one level");
    all_hold(&field(&|x, y| f64::from((x + y) % 5)), "squares of five levels");
    // Every other one: they touch at corners only.
    let chess: Vec<Line> =
        (0..144).filter(|n| (n % 12 + n / 12) % 2 == 0).map(|n| (10.0, square(n % 12, n / 12))).collect();
    all_hold(&[chess, around.to_vec()].concat(), "a chessboard");
}

#[test]
fn long_lines_side_by_side_on_the_slant() {
    let along = DVec2::new(1.0, 1.0).normalize();
    let lines: Vec<Line> = (0..3_000)
        .map(|k| {
            let start = along.perp() * 0.5 * f64::from(k);
            (f64::from(k), vec![start, start + 5_000.0 * along])
        })
        .collect();
    let params = SurfaceParams { kind: SurfaceKind::Linear, ..SurfaceParams::default() };
    let start = Instant::now();
    hold(map_of(&lines), &Lines { is_exact: true, ..Lines::default() }, (&Given::default(), &params), "slanted lines")
        .unwrap();
    assert!(start.elapsed() < LONG, "{:?}", start.elapsed());
}
