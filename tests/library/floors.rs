//! Wide places: what the smooth surface does where a slope ends at a floor, and hollows that may be lakes.

#![allow(clippy::unwrap_used, reason = "helpers of tests are tests too")]

use glam::DVec2;
use tokosen::base::Grid;
use tokosen::base::error::{Finding, FindingKind};
use tokosen::clean::{CleanParams, clean};
use tokosen::contour::{Contour, ContourMap};
use tokosen::subdomains::Frame;
use tokosen::surface::{Given, Surface, SurfaceParams, build, heights};

const INTERVAL: f64 = 20.0;

fn built(contours: Vec<Contour>) -> (Surface, Vec<Finding>) {
    let map = ContourMap { contours, ..ContourMap::default() };
    let map = clean(map, &CleanParams::default()).unwrap().value;
    let report =
        build(map, &Given::default(), &SurfaceParams { frame: Frame::Hull, ..SurfaceParams::default() }, &()).unwrap();
    (report.value, report.findings)
}

/// A shore that turns in bays: its radius varies by `bays` of itself.
fn ring(radius: f64, elevation: f64, bays: f64) -> Contour {
    let at = |k: i32| {
        let angle = f64::from(k % 240) * std::f64::consts::TAU / 240.0;
        radius * (1.0 + bays * (7.0 * angle).sin()) * DVec2::from_angle(angle)
    };
    Contour { elevation, points: (0..=240).map(at).collect(), feature: 1.into() }
}

/// Rings around a hollow of this radius, `spacing` apart, rising outwards from 500 m.
fn hollow(radius: f64, spacing: f64, bays: f64) -> Vec<Contour> {
    (0..8).map(|k| ring(radius + f64::from(k) * spacing, 500.0 + f64::from(k) * INTERVAL, bays)).collect()
}

/// Heights at places.
fn heights_at(surface: &Surface, places: &[DVec2]) -> Vec<f64> {
    let cell = |p: &DVec2| Grid { corner: *p + DVec2::new(-0.5, 0.5), cell: DVec2::ONE, cols: 1, rows: 1 };
    places.iter().map(|p| f64::from(heights(surface, &cell(p), &()).values[0])).collect()
}

fn lakes(contours: Vec<Contour>) -> Vec<Finding> {
    built(contours).1.into_iter().filter(|f| f.kind == FindingKind::MayBeLake).collect()
}

#[test]
fn a_long_lowest_contour_at_zero_that_reaches_the_frame_may_be_a_coast() {
    // A coast along x with headlands, and hills behind it, up to a spur at the frame.
    let line = |k: u32, away: DVec2| {
        let at = |i: u32| {
            let x = 10.0 * f64::from(i);
            away + DVec2::new(x, 50.0 * f64::from(k) + 15.0 * (x / 90.0).sin())
        };
        Contour { elevation: 10.0 * f64::from(k), points: (0..=200).map(at).collect(), feature: 1.into() }
    };
    let island = |away: DVec2| Contour {
        elevation: 0.0,
        points: [(900.0, -600.0), (920.0, -590.0), (900.0, -580.0), (900.0, -600.0)]
            .map(|p| away + DVec2::from(p))
            .to_vec(),
        feature: 2.into(),
    };
    let found = |lowest: f64, away: DVec2, has_island: bool| -> Vec<Finding> {
        let mut lines: Vec<Contour> = (0..8).map(|k| line(k, away)).collect();
        lines.extend(has_island.then(|| island(away)));
        lines.iter_mut().for_each(|line| line.elevation += lowest);
        built(lines).1.into_iter().filter(|f| f.kind == FindingKind::MayBeSea).collect()
    };
    // The island far off the coast shows that the map goes on.
    for away in [DVec2::ZERO, DVec2::new(500_000.0, 4_000_000.0)] {
        let sea = found(0.0, away, true);
        assert!(sea.len() == 1 && sea[0].elevations == [0.0], "{sea:?}");
        let place = sea[0].place.unwrap() - away;
        assert!((0.0..2000.0).contains(&place.x) && (-600.0..30.0).contains(&place.y), "{sea:?}");
    }
    assert_eq!(found(120.0, DVec2::ZERO, true), [], "a valley inland");
    assert_eq!(found(0.0, DVec2::ZERO, false), [], "nothing lies beyond the coast");
}

#[test]
fn a_wide_hollow_among_steep_slopes_may_be_a_lake() {
    let found = lakes(hollow(600.0, 40.0, 0.02));
    assert_eq!(found.len(), 1, "{found:?}");
    assert!(found[0].place.unwrap().length() < 60.0 && found[0].elevations == [500.0], "{found:?}");
    let area: f64 = found[0].message.split("about ").nth(1).unwrap().split(' ').next().unwrap().parse().unwrap();
    assert!((area / (std::f64::consts::PI * 600.0 * 600.0) - 1.0).abs() < 0.01, "{found:?}");
    // The place is right far from the origin of the coordinates, too.
    let away = DVec2::new(500_000.0, 4_000_000.0);
    let mut moved = hollow(600.0, 40.0, 0.02);
    moved.iter_mut().flat_map(|line| &mut line.points).for_each(|p| *p += away);
    let found = lakes(moved);
    assert!(found.len() == 1 && found[0].place.unwrap().distance(away) < 60.0, "{found:?}");
    // The bowl goes on inwards with its slope: nothing shows water.
    assert_eq!(lakes(hollow(60.0, 40.0, 0.02)), []);
    // So far from a slope, a hollow may be anything.
    assert_eq!(lakes(hollow(600.0, 500.0, 0.02)), []);
    // A top is no lake.
    let top = hollow(600.0, 40.0, 0.02).into_iter().map(|c| Contour { elevation: 1000.0 - c.elevation, ..c });
    assert_eq!(lakes(top.collect()), []);
    // A shore that is drawn through is a hollow that reaches the frame, or an open end: its other side is unknown.
    let mut open = hollow(600.0, 40.0, 0.02);
    open.iter_mut().for_each(|c| c.points.retain(|p| p.x < 300.0));
    open.iter_mut().for_each(|c| {
        c.points.pop();
    });
    assert_eq!(lakes(open), []);
}

#[test]
fn the_floor_of_a_wide_hollow_is_gentle_and_near_its_shore() {
    let radius = 600.0;
    let (surface, _) = built(hollow(radius, 40.0, 0.02));
    let at = |share: f64, angle: f64| share * radius * DVec2::from_angle(angle);
    let places: Vec<DVec2> =
        (0..19).flat_map(|k| (0..12).map(move |a| at(f64::from(k) * 0.05, f64::from(a)))).collect();
    let floor = heights_at(&surface, &places);
    let depth = |z: f64| (500.0 - z) / INTERVAL;
    let (least, most) = floor.iter().fold((f64::MAX, f64::MIN), |(a, b), z| (a.min(depth(*z)), b.max(depth(*z))));
    assert!(least > 0.0 && most < 0.65, "{least} {most} intervals below the shore");
    // No funnel, no star: the middle half is nearly level.
    let middle: Vec<f64> = floor[..9 * 12].iter().map(|z| depth(*z)).collect();
    let (low, high) = middle.iter().fold((f64::MAX, f64::MIN), |(a, b), d| (a.min(*d), b.max(*d)));
    assert!(high - low < 0.1, "{low} to {high} intervals");
}

#[test]
fn a_slope_ends_at_the_contour_where_the_spacing_jumps() {
    // A long flank with contours 10 apart comes down to a plain, whose next contour is 600 further.
    let at = |x: f64, elevation: f64| Contour {
        elevation,
        points: (0..=60).map(|k| DVec2::new(x, f64::from(k) * 10.0)).collect(),
        feature: 1.into(),
    };
    let flank = (0..40).map(|k| (-10.0 * f64::from(k), 500.0 + INTERVAL * f64::from(k)));
    let plain = [(600.0, 480.0), (1200.0, 460.0), (1800.0, 440.0)];
    for turned in [1.0, -1.0] {
        // Turned upside down, it is a plateau above an edge.
        let lines = flank.clone().chain(plain).map(|(x, z)| at(x, 500.0 + turned * (z - 500.0)));
        let (surface, _) = built(lines.collect());
        let places: Vec<DVec2> = (1..12).map(|k| DVec2::new(f64::from(k) * 50.0, 300.0)).collect();
        let found = heights_at(&surface, &places);
        // There is no trough beside the toe.
        assert!(found[..8].windows(2).all(|z| turned * (z[0] - z[1]) > 0.0), "{turned}: {found:?}");
        for (place, z) in places.iter().zip(found) {
            let straight = 500.0 - turned * INTERVAL * place.x / 600.0;
            let off = (z - straight).abs() / INTERVAL;
            // Where the slope goes on into the plain, it is 0.8 intervals.
            assert!(off < 0.5, "{turned}: {off} intervals off the straight way at {place}");
        }
    }
}
