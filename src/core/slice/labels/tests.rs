//! Labels on lines that are known, and on drawn ones against a slow oracle.

use proptest::prelude::*;

use super::*;
use crate::contour::Source;
use crate::draws::draws;

fn line(elevation: f64, points: Vec<DVec2>) -> ContourLine {
    ContourLine { elevation, points, source: Source::Input, index: true, kind: None, depression: false, expected: None }
}

/// A ring, clockwise: higher ground inside.
fn ring(elevation: f64, centre: DVec2, radius: f64) -> ContourLine {
    let angle = |k: i32| -f64::from(k % 360).to_radians();
    line(elevation, (0..=360).map(|k| centre + radius * DVec2::from_angle(angle(k))).collect())
}

#[test]
fn a_hill_is_labelled_on_its_southern_side_with_the_top_uphill() {
    let labels = place_labels(&[ring(250.0, DVec2::new(5e5, 4e6), 200.0)], &LabelParams::new(20.0));
    let [label] = labels.as_slice() else { panic!("{labels:?}") };
    assert!(label.position.y < 4e6 - 150.0, "{label:?}");
    assert!(label.angle.abs() < 20.0, "{label:?}");
    assert_eq!((label.text.as_str(), label.line, label.elevation), ("250", 0, 250.0));
    assert_eq!(label.size, DVec2::new(33.0, 20.0));
}

#[test]
fn long_lines_have_more_labels_and_short_or_bent_ones_none() {
    let straight = |length: f64| line(10.0, vec![DVec2::ZERO, DVec2::new(length, 0.0)]);
    let count = |line: ContourLine| place_labels(&[line], &LabelParams::new(10.0)).len();
    assert_eq!([count(straight(5000.0)), count(straight(1250.0)), count(straight(100.0))], [10, 3, 1]);
    assert_eq!(count(straight(20.0)), 0);
    let zigzag = (0..500).map(|k| DVec2::new(f64::from(k) * 4.0, f64::from(k % 2) * 8.0)).collect();
    assert_eq!(count(line(10.0, zigzag)), 0);
    assert_eq!(count(line(10.0, vec![])), 0);
    assert_eq!(count(line(10.0, vec![DVec2::ONE; 9])), 0);
}

#[test]
fn a_text_from_bottom_to_top_is_turned_by_ninety_degrees() {
    for points in [[DVec2::ZERO, DVec2::new(0.0, 100.0)], [DVec2::new(0.0, 100.0), DVec2::ZERO]] {
        let labels = place_labels(&[line(5.0, points.to_vec())], &LabelParams::new(5.0));
        assert_eq!(labels.iter().map(|l| l.angle).collect::<Vec<_>>(), [90.0]);
    }
}

#[test]
fn other_lines_are_kept_clear_of_where_that_is_possible() {
    let mut lines = vec![line(100.0, vec![DVec2::ZERO, DVec2::new(400.0, 0.0)])];
    // Other lines cross it everywhere but in the last quarter.
    lines.extend((0..60).map(|k| {
        let x = f64::from(k) * 5.0;
        ContourLine { index: false, ..line(1.0, vec![DVec2::new(x, -50.0), DVec2::new(x, 50.0)]) }
    }));
    let labels = place_labels(&lines, &LabelParams::new(10.0));
    let [label] = labels.as_slice() else { panic!("{labels:?}") };
    assert!(label.position.x > 300.0, "{label:?}");
    // All are labelled: none of their labels lies on the level line.
    lines.iter_mut().for_each(|line| line.index = true);
    for label in place_labels(&lines, &LabelParams::new(10.0)) {
        assert!(
            label.line == 0
                || label.corners(0.0).iter().all(|p| p.y > 0.0)
                || label.corners(0.0).iter().all(|p| p.y < 0.0)
        );
    }
}

#[test]
fn labels_stay_within_an_area() {
    let within = Some([DVec2::new(600.0, -8.0), DVec2::new(660.0, 8.0)]);
    let params = LabelParams { within, ..LabelParams::new(10.0) };
    let lines = [line(100.0, vec![DVec2::ZERO, DVec2::new(1000.0, 0.0)])];
    let labels = place_labels(&lines, &params);
    assert!(labels.len() == 1 && (600.0..660.0).contains(&labels[0].position.x), "{labels:?}");
    let tight = LabelParams { within: Some([DVec2::new(600.0, -8.0), DVec2::new(610.0, 8.0)]), ..params };
    assert!(place_labels(&lines, &tight).is_empty());
}

#[test]
fn what_is_not_finite_is_passed_over() {
    let good = || ring(50.0, DVec2::ZERO, 300.0);
    let bad = [line(f64::NAN, good().points), line(1.0, vec![DVec2::ZERO, DVec2::NAN])];
    let lines: Vec<ContourLine> = bad.into_iter().chain([good()]).collect();
    assert_eq!(place_labels(&lines, &LabelParams::new(10.0)).iter().map(|l| l.line).collect::<Vec<_>>(), [2, 2, 2, 2]);
    for height in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        assert!(place_labels(&lines, &LabelParams::new(height)).is_empty());
    }
}

#[test]
fn texts_are_in_the_unit_asked_for() {
    assert_eq!(label_text(ElevationUnit::Foot.metres(1240.0), ElevationUnit::Foot), "1240");
    assert_eq!(
        [1240.0, 0.25, -0.0, -12.5].map(|z| label_text(z, ElevationUnit::Metre)),
        ["1240", "0.25", "0", "-12.5"]
    );
}

/// Whether two convex polygons share area, by cutting one along the edges of the other (Sutherland and Hodgman 1974):
/// nothing of the code under test.
fn overlap(a: &[DVec2; 4], b: &[DVec2; 4]) -> bool {
    let mut rest = a.to_vec();
    for k in 0..4 {
        let (from, to) = (b[k], b[(k + 1) % 4]);
        let inside = |p: DVec2| (to - from).perp_dot(p - from);
        let mut kept = Vec::new();
        for i in 0..rest.len() {
            let (p, q) = (rest[i], rest[(i + 1) % rest.len()]);
            if inside(p) >= 0.0 {
                kept.push(p);
            }
            if (inside(p) >= 0.0) != (inside(q) >= 0.0) {
                kept.push(p.lerp(q, inside(p) / (inside(p) - inside(q))));
            }
        }
        rest = kept;
    }
    let area: f64 = (0..rest.len()).map(|i| rest[i].perp_dot(rest[(i + 1) % rest.len()])).sum();
    area > 1e-6
}

/// The distance from a point to a line, by all of its segments.
fn distance(line: &[DVec2], p: DVec2) -> f64 {
    let to_segment = |w: &[DVec2]| {
        let along = w[1] - w[0];
        let share = if along == DVec2::ZERO { 0.0 } else { (p - w[0]).dot(along) / along.length_squared() };
        p.distance(w[0] + along * share.clamp(0.0, 1.0))
    };
    line.windows(2).map(to_segment).fold(f64::INFINITY, f64::min)
}

fn drawn_line() -> impl Strategy<Value = ContourLine> {
    let turns = prop::collection::vec(-0.5..0.5f64, 2..120);
    (turns, 0.0..6.3f64, (0.0..800.0f64, 0.0..800.0f64), 2.0..30.0f64, 0..6i32, prop::bool::weighted(0.7)).prop_map(
        |(turns, mut heading, (x, y), step, level, index)| {
            let mut points = vec![DVec2::new(x, y)];
            for turn in turns {
                heading += turn;
                points.push(points[points.len() - 1] + step * DVec2::from_angle(heading));
            }
            ContourLine { index, ..line(f64::from(level) * 10.0 - 20.0, points) }
        },
    )
}

proptest! {
    #![proptest_config(draws())]

    #[test]
    fn labels_lie_on_their_lines_apart_from_each_other_and_upright(
        lines in prop::collection::vec(drawn_line(), 1..40),
        height in 4.0..14.0f64,
    ) {
        let within = Some([DVec2::ZERO, DVec2::splat(800.0)]);
        let params = LabelParams { spacing: 12.0 * height, within, ..LabelParams::new(height) };
        let labels = place_labels(&lines, &params);
        prop_assert_eq!(&labels, &place_labels(&lines, &params));
        for (k, label) in labels.iter().enumerate() {
            let line = &lines[label.line];
            prop_assert!(line.index && label.elevation == line.elevation);
            prop_assert!(label.angle > -90.0 && label.angle <= 90.0);
            prop_assert!(distance(&line.points, label.position) < 1e-9);
            // The line is near the middle line of the text all along it.
            let axis = DVec2::from_angle(label.angle.to_radians());
            for share in [-0.5, -0.25, 0.25, 0.5] {
                let p = label.position + axis * (share * label.size.x);
                prop_assert!(distance(&line.points, p) <= 2.0 * STRAIGHT * height + 1e-9);
            }
            let corners = label.corners(params.clearance);
            prop_assert!(corners.iter().all(|p| p.cmpge(DVec2::ZERO).all() && p.cmple(DVec2::splat(800.0)).all()));
            for other in &labels[..k] {
                prop_assert!(!overlap(&corners, &other.corners(params.clearance)), "{:?} and {:?}", label, other);
            }
        }
    }
}
