//! Figures 2, 3 and 6: kinds of triangles, elimination and the heights of a ridge, every number by hand.

use glam::DVec2;
use tokosen::skeleton::{AxisPoint, axis_heights, skeleton};
use tokosen::tin::TriangleKind;
use tokosen::tuning::SkeletonTuning;

use super::sample::{ORIGIN, Sample, sample};

type Corner = (i32, i32);

/// A triangle's corners as whole numbers in a fixed order.
fn listed(sample: &Sample, t: u32) -> [Corner; 3] {
    let mut corners = sample.corners(t).map(|p| {
        assert!((p - p.round()).length() < 1e-6, "{p}");
        (p.x.round() as i32, p.y.round() as i32)
    });
    corners.sort_unstable();
    corners
}

/// The ring between lower line (A to G) and upper line (K to N) has 7 + 4 + 2 - 2 triangles.
#[test]
fn figure_2_every_triangle() {
    let sample = sample("fig2_triangles");
    let [a, b, c, d, e, f, g]: [Corner; 7] =
        [(0, 0), (90, -10), (100, 40), (160, 50), (100, 60), (95, 110), (-10, 100)];
    let [k, l, m, n]: [Corner; 4] = [(38, 41), (57, 35), (70, 51), (45, 66)];
    use TriangleKind::{Junction, Sleeve, Terminal};
    let mut wanted = vec![
        (Terminal, [c, d, e]),
        (Junction, [c, e, m]),
        // Each of the others holds one piece of line: six of the lower line, four less one corner of the upper.
        (Sleeve, [a, b, l]),
        (Sleeve, [b, c, l]),
        (Sleeve, [e, f, m]),
        (Sleeve, [f, g, n]),
        (Sleeve, [g, a, k]),
        (Sleeve, [k, l, a]),
        (Sleeve, [l, m, c]),
        (Sleeve, [m, n, f]),
        (Sleeve, [n, k, g]),
    ];
    wanted.iter_mut().for_each(|(_, corners)| corners.sort_unstable());
    let between = sample.region_at(10.0, 50.0);
    let found: Vec<(TriangleKind, [Corner; 3])> =
        sample.triangles_of(between).iter().map(|&t| (sample.kinds[t as usize], listed(&sample, t))).collect();
    assert_eq!(found.len(), wanted.len());
    for triangle in wanted {
        assert!(found.contains(&triangle), "{triangle:?} in {found:?}");
    }
    // The top is two triangles with one free edge each; outside, one each side of the spur has none.
    let top = sample.counts(sample.region_at(50.0, 50.0));
    assert_eq!((top.terminal, top.sleeve, top.junction), (2, 0, 0));
    for (x, y) in [(110.0, 30.0), (110.0, 75.0)] {
        let outside = sample.triangle_at(DVec2::new(x, y));
        assert_eq!(sample.kinds[outside as usize], TriangleKind::Isolated);
    }
    assert_eq!(sample.subdivision.regions.regions.len(), 4);
}

/// The only junction in the sub-domain at a place.
fn junction(sample: &Sample, x: f64, y: f64) -> u32 {
    let own = sample.triangles_of(sample.region_at(x, y));
    let junctions: Vec<u32> = own.into_iter().filter(|&t| sample.kinds[t as usize] == TriangleKind::Junction).collect();
    assert_eq!(junctions.len(), 1);
    junctions[0]
}

/// Two corners on the lower line, 9 on both sides of the axis, the third 12 before them: L1 = L2 = 15. The spur is 40 long,
/// so its two sides are LPCO = 41 + 41.
#[test]
fn figure_3a_a_junction_with_two_corners_on_one_line() {
    let sample = sample("fig3a_spur");
    let junction = junction(&sample, -90.0, 0.0);
    assert_eq!(listed(&sample, junction), [(-12, 0), (0, -9), (0, 9)]);
    let r = 82.0 / (15.0 + 15.0);
    let spur = sample.triangle_at(DVec2::new(20.0, 0.0));
    for (w, is_eliminated) in
        [(1.0, false), (r * (1.0 - 1e-9), false), (r, false), (r * (1.0 + 1e-9), true), (10.0, true)]
    {
        let found = sample.elimination(w);
        assert_eq!(found.eliminated[junction as usize], is_eliminated, "w = {w}");
        assert_eq!(found.dropped[spur as usize], is_eliminated, "w = {w}");
        let lines = skeleton(&sample.subdivision.tin, &sample.subdivision.regions, w, &SkeletonTuning::default()).lines;
        let in_spur = |p: &glam::DVec3| p.truncate().distance(ORIGIN) < 1e-6;
        assert_eq!(lines.iter().any(|line| line.points.iter().any(in_spur)), !is_eliminated, "w = {w}");
    }
}

/// A triangle of sides 18, 15 and 15 with an arm on each. On the long side the arm's two legs are 41 long: the trunk. On the
/// others they are 12.5 and 19.5, so that r1 = 25 / (15 + 18) and r2 = 39 / (15 + 18).
#[test]
fn figure_3b_a_junction_with_three_corners_on_one_line() {
    let sample = sample("fig3b_three_arms");
    let junction = junction(&sample, 0.0, 5.0);
    assert_eq!(listed(&sample, junction), [(-9, 0), (0, 12), (9, 0)]);
    let [trunk, west, east] = [(0.0, -20.0), (-8.0, 10.0), (10.0, 10.0)].map(|p| sample.triangle_at(p.into()));
    let (r1, r2): (f64, f64) = (25.0 / 33.0, 39.0 / 33.0);
    for (w, is_eliminated) in [
        (0.6, false),
        (r1 * (1.0 - 1e-9), false),
        (r1, false),
        (r1 * (1.0 + 1e-9), true),
        (r2 * (1.0 - 1e-9), true),
        (r2 * (1.0 + 1e-9), true),
    ] {
        let found = sample.elimination(w);
        assert_eq!(found.eliminated[junction as usize], is_eliminated, "w = {w}");
        let dropped = [trunk, west, east].map(|t| found.dropped[t as usize]);
        assert_eq!(dropped, [false, is_eliminated, false], "a junction becomes a sleeve: one arm goes, w = {w}");
    }
}

/// The lower limit of w is the largest of 18 / (15 + 15) and 15 / (15 + 18). Below it the limit counts, which both
/// parameters are above.
#[test]
fn figure_3b_the_lower_limit() {
    let sample = sample("fig3b_three_arms");
    let junction = junction(&sample, 0.0, 5.0);
    let limited = |w: f64| sample.elimination(w).limited;
    assert_eq!(limited(0.6), limited(10.0));
    assert_eq!(limited(0.6 * (1.0 - 1e-9)), limited(0.6) + 1);
    assert!(!sample.elimination(0.0).eliminated[junction as usize]);
}

/// Centres q of the edges that span a spur with sides 10 from its axis, before an upper line 30 west of its mouth.
#[test]
fn figure_6_heights_along_a_ridge() {
    let sample = sample("fig6_ridge");
    let (low, high) = (100.0, 110.0);
    let from_upper = |x: f64| x + 30.0;
    // The mouth, then edges between corners that alternate. The last edge is nearest to the slanted end: the line through
    // (75, 0) and (50, -10) passes the point (55, 0) at 200 / sqrt(725).
    let last = 200.0 / 725.0_f64.sqrt();
    let centres = [(0.0, 10.0), (5.0, 10.0), (15.0, 10.0), (25.0, 10.0), (35.0, 10.0), (45.0, 10.0), (55.0, last)];
    let region = sample.region_at(-20.0, 0.0);
    let points: Vec<AxisPoint> = centres
        .iter()
        .map(|&(x, _)| {
            let place = DVec2::new(x, 0.0);
            let position = place + ORIGIN - sample.subdivision.tin.origin;
            AxisPoint { position, level: Some(low), triangle: sample.triangle_at(place), region }
        })
        .collect();
    let found = axis_heights(&sample.subdivision.tin, &sample.subdivision.regions, &points, &SkeletonTuning::default());
    let lines = skeleton(&sample.subdivision.tin, &sample.subdivision.regions, 1.0, &SkeletonTuning::default()).lines;
    for (&(x, to_lower), height) in centres.iter().zip(found) {
        let wanted = (low * from_upper(x) + to_lower * high) / (from_upper(x) + to_lower);
        assert!((height - wanted).abs() < 1e-9, "at {x}: {height}, by hand {wanted}");
        let at = (ORIGIN + DVec2::new(x, 0.0)).extend(wanted);
        assert!(lines.iter().flat_map(|l| &l.points).any(|p| p.distance(at) < 1e-6), "no ridge through {x}");
    }
    // In whole numbers where it comes out even: 30 from one line and 10 from the other; 60 and 10.
    assert_eq!((low * 30.0 + 10.0 * high) / 40.0, 102.5);
}
