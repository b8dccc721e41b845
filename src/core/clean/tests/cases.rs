//! One case for each thing that cleaning does.

use crate::base::error::Error;
use crate::clean::tests::*;
use crate::clean::validate;

#[test]
fn an_empty_map_stays_empty() {
    let report = cleaned(Vec::new(), 1.0);
    assert_eq!(report, Report { value: ContourMap::default(), findings: Vec::new() });
}

#[test]
fn sound_lines_are_untouched() {
    let lines = vec![
        line(3, 10.0, &[(0, 0), (4, 0), (4, 4), (0, 4), (0, 0)]),
        line(1, 10.0, &[(-9, 0), (-9, 5), (-8, 7)]),
        line(2, 20.0, &[(1, 1), (2, 3), (3, 1), (1, 1)]),
    ];
    let report = cleaned(lines.clone(), 0.0);
    assert!(report.findings.is_empty());
    assert_eq!(
        report.value.contours,
        [lines[1].clone(), line(3, 10.0, &[(0, 0), (0, 4), (4, 4), (4, 0), (0, 0)]), lines[2].clone()]
    );
}

#[test]
fn bad_points_are_dropped() {
    let mut lines = vec![
        line(1, 10.0, &[(0, 0), (1, 0), (1, 0), (1, 0), (2, 0)]),
        line(2, 10.0, &[(5, 5), (5, 5)]),
        line(3, f64::NAN, &[(7, 7), (8, 8)]),
        line(4, 20.0, &[(0, 3), (1, 3), (2, 3)]),
        line(5, 20.0, &[]),
        line(6, f64::INFINITY, &[]),
        // As some programs mark what they do not know.
        line(7, -1e30, &[(8, 8), (9, 9)]),
    ];
    lines[3].points[1].y = f64::NAN;
    let report = cleaned(lines, 0.0);
    assert_eq!(report.value.contours, [line(1, 10.0, &[(0, 0), (1, 0), (2, 0)]), line(4, 20.0, &[(0, 3), (2, 3)])]);
    use FindingKind::{MissingElevation, NonFinitePoint, PointLine, RepeatedPoint};
    let found: Vec<_> = report.findings.iter().map(|f| (f.kind, f.place.map(|p| (p.x, p.y)))).collect();
    assert_eq!(
        found,
        [
            (MissingElevation, None),
            (MissingElevation, Some((7.0, 7.0))),
            (MissingElevation, Some((8.0, 8.0))),
            (NonFinitePoint, Some((0.0, 3.0))),
            (RepeatedPoint, Some((1.0, 0.0))),
            (PointLine, None),
            (PointLine, Some((5.0, 5.0))),
        ]
    );
}

#[test]
fn absurd_coordinates_are_no_places() {
    let mut lines = vec![line(1, 10.0, &[(0, 0), (1, 0), (2, 0), (3, 1)]), line(2, 10.0, &[(0, 5), (0, 6)])];
    lines[0].points[1].x = f64::MAX;
    lines[0].points[2].y = f64::NEG_INFINITY;
    lines[1].points[0] = DVec2::NAN;
    let report = cleaned(lines, 0.0);
    assert_eq!(report.value.contours, [line(1, 10.0, &[(0, 0), (3, 1)])]);
    let tiny = [1e-300, 2e-300, -1e-308].map(|y| Contour {
        elevation: y,
        points: vec![DVec2::new(y, y), DVec2::new(1.0, y)],
        feature: 1.into(),
    });
    assert_eq!(cleaned(tiny.into(), 0.0).value.contours.len(), 1);
}

#[test]
fn coordinates_too_small_for_products_are_zero() {
    // As they stand, their products underflow, and the line seems to meet itself wherever it is looked at.
    let points = [(1.0, 0.0), (0.0, 0.0), (1e-320, -2.876694929374245e-94), (-0.0, 4.320544865689347e-154)];
    let points = points.map(|p| DVec2::new(p.0, p.1)).into();
    let report = cleaned(vec![Contour { elevation: 0.0, points, feature: 1.into() }], 0.0);
    assert_eq!(report.value.contours, [line(1, 0.0, &[(0, 0), (1, 0)])]);
}

#[test]
fn a_line_turned_round_is_as_near_as_before() {
    // Rounding is larger than the distance here, and cleaning turns the pieces that it makes.
    let mut lines = vec![
        line(1, 0.0, &[(0, 0), (-1, 9)]),
        line(2, -1.0, &[(0, 1), (0, -1), (1, 0), (0, 9), (0, 0)]),
        line(3, 0.0, &[(0, 0), (-1, 0), (-1, -1)]),
    ];
    lines[0].points[1].y = 1e50;
    lines[1].points[3].y = 1e50;
    let params = CleanParams { snap: 0.0, separation: 1e-320 };
    let report = clean(map(lines), &params).expect("few conflicts");
    validate(&report.value, &params).expect("sound");
}

#[test]
fn on_a_large_map_lines_are_further_apart() {
    let line = |feature: u64, size: f64, y: f64| {
        let points = vec![DVec2::new(size, y), DVec2::new(2.0 * size, y)];
        Contour { elevation: feature as f64, points, feature: feature.into() }
    };
    let findings = |size: f64, apart: f64, separation: f64| {
        let params = CleanParams { snap: 0.0, separation };
        let map = map(vec![line(1, size, 0.0), line(2, size, apart)]);
        let found = clean(map.clone(), &params).expect("few conflicts").findings.len();
        assert_eq!(validate(&map, &params).is_err(), found > 0);
        found
    };
    assert_eq!(findings(100.0, 5e-6, 1e-6), 0);
    assert_ne!(findings(100_000.0, 2e-6, 1e-6), 0, "the frame is known to 0.2 mm");
    assert_eq!(findings(100_000.0, 3e-4, 1e-6), 0);
    assert_eq!(findings(100_000.0, 2e-6, 0.0), 0, "nothing but contact was asked for");
    assert_eq!(findings(1e12, 2e-3, 1e-6), 0, "however far away a single point is");
}

#[test]
fn negative_zero_is_zero() {
    let mut lines = vec![line(1, 0.0, &[(0, 0), (5, 0)]), line(2, -0.0, &[(5, 0), (0, 0)])];
    lines[1].points[1] = DVec2::new(-0.0, -0.0);
    let report = cleaned(lines, 0.0);
    assert_eq!(report.value.contours, [line(1, 0.0, &[(0, 0), (5, 0)])]);
    assert_eq!(kinds(&report), [FindingKind::DuplicateLine]);
}

#[test]
fn duplicates_are_found_in_any_direction_and_rotation() {
    let report = cleaned(
        vec![
            line(9, 10.0, &[(0, 0), (3, 1), (5, 0)]),
            line(2, 10.0, &[(5, 0), (3, 1), (0, 0)]),
            line(4, 20.0, &[(0, 5), (2, 5), (2, 7), (0, 5)]),
            line(5, 20.0, &[(2, 7), (0, 5), (2, 5), (2, 7)]),
            line(6, 20.0, &[(2, 5), (0, 5), (2, 7), (2, 5)]),
        ],
        0.0,
    );
    let features: Vec<_> = report.value.contours.iter().map(|c| c.feature).collect();
    assert_eq!(features, [2, 4]);
    assert_eq!(kinds(&report), [FindingKind::DuplicateLine; 3]);
}

#[test]
fn pieces_with_common_ends_are_joined() {
    let report = cleaned(
        vec![
            line(5, 10.0, &[(4, 0), (2, 1), (0, 0)]),
            line(3, 10.0, &[(4, 0), (6, 1), (8, 0)]),
            line(7, 10.0, &[(9, 5), (8, 0)]),
            // Another level's end at a free end is nothing to it.
            line(1, 20.0, &[(20, 0), (22, 0)]),
            line(2, 20.0, &[(24, 0), (22, 0), (22, 9)]),
        ],
        0.0,
    );
    assert_eq!(report.value.contours[0], line(3, 10.0, &[(0, 0), (2, 1), (4, 0), (6, 1), (8, 0), (9, 5)]));
    // Nothing is invented, so there is nothing to tell.
    assert!(report.findings.is_empty());
    assert_eq!(report.value.contours.len(), 3);
}

#[test]
fn two_halves_make_a_ring() {
    let halves = vec![line(2, 10.0, &[(0, 0), (1, 2), (3, 0)]), line(1, 10.0, &[(3, 0), (1, -2), (0, 0)])];
    let ring = line(1, 10.0, &[(0, 0), (1, -2), (3, 0), (1, 2), (0, 0)]);
    assert_eq!(cleaned(halves.clone(), 0.0).value.contours, std::slice::from_ref(&ring));
    // The same ring as one feature beside its halves is a duplicate.
    let report = cleaned([halves, vec![ring.clone()]].concat(), 0.0);
    assert_eq!(report.value.contours, [ring]);
    assert_eq!(kinds(&report), [FindingKind::DuplicateLine]);
}

#[test]
fn three_ends_are_left_alone() {
    let star =
        vec![line(1, 10.0, &[(0, 0), (5, 5)]), line(2, 10.0, &[(5, 5), (9, 4)]), line(3, 10.0, &[(5, 5), (5, 9)])];
    let report = cleaned(star.clone(), 1.0);
    assert_eq!(report.value.contours.len(), 3);
    assert!(report.findings.is_empty(), "{:?}", report.findings);
}

#[test]
fn gaps_within_snap_are_closed() {
    let gap = vec![line(1, 10.0, &[(0, 0), (10, 0)]), line(2, 10.0, &[(12, 0), (20, 3)])];
    assert_eq!(cleaned(gap.clone(), 1.9).value.contours.len(), 2);
    let report = cleaned(gap, 2.0);
    assert_eq!(report.value.contours, [line(1, 10.0, &[(0, 0), (10, 0), (12, 0), (20, 3)])]);
    assert_eq!(kinds(&report), [FindingKind::ClosedGap]);
    assert_eq!(report.findings[0].place, Some(DVec2::new(11.0, 0.0)));
}

#[test]
fn nearly_closed_lines_are_closed() {
    let open = vec![line(1, 10.0, &[(0, 0), (10, 0), (10, 10), (0, 10), (0, 1)])];
    assert_eq!(
        cleaned(open.clone(), 0.9).value.contours,
        [line(1, 10.0, &[(0, 0), (10, 0), (10, 10), (0, 10), (0, 1)])]
    );
    let report = cleaned(open, 1.0);
    assert_eq!(report.value.contours, [line(1, 10.0, &[(0, 0), (0, 1), (0, 10), (10, 10), (10, 0), (0, 0)])]);
    assert_eq!(kinds(&report), [FindingKind::ClosedGap]);
    // A short straight line is no ring, nor is a line of two points.
    let short = vec![line(1, 10.0, &[(0, 0), (1, 1), (2, 0)]), line(2, 20.0, &[(0, 5), (1, 5)])];
    let report = cleaned(short.clone(), 50.0);
    assert_eq!(report.value.contours, short);
}

#[test]
fn only_nearest_ends_are_joined() {
    // The middle one of three ends is nearest to the right one; the left one stays free.
    let report = cleaned(
        vec![
            line(1, 10.0, &[(0, 0), (10, 0)]),
            line(2, 10.0, &[(13, 0), (13, 50)]),
            line(3, 10.0, &[(15, 0), (40, 0)]),
        ],
        4.0,
    );
    assert_eq!(report.value.contours.len(), 2);
    assert_eq!(report.value.contours[0], line(1, 10.0, &[(0, 0), (10, 0)]));
}

#[test]
fn a_connection_in_the_way_is_taken_back() {
    let wall = line(3, 20.0, &[(11, -9), (11, 9)]);
    let lines = vec![line(1, 10.0, &[(0, 0), (10, 0)]), line(2, 10.0, &[(12, 0), (20, 3)]), wall];
    let report = cleaned(lines.clone(), 5.0);
    assert_eq!(report.value.contours, lines);
    assert!(report.findings.is_empty(), "{:?}", report.findings);
}

#[test]
fn a_line_that_touches_itself_is_split() {
    let eight = line(1, 10.0, &[(0, 0), (2, 2), (4, 4), (4, 0), (2, 2), (0, 4), (0, 0)]);
    let report = cleaned(vec![eight], 0.0);
    assert_eq!(
        report.value.contours,
        [line(1, 10.0, &[(0, 0), (0, 4), (2, 2), (0, 0)]), line(1, 10.0, &[(2, 2), (4, 0), (4, 4), (2, 2)])]
    );
    assert!(report.findings.is_empty());
    let nine = line(1, 10.0, &[(0, 0), (5, 0), (5, 3), (2, 3), (5, 0)]);
    let report = cleaned(vec![nine], 0.0);
    assert_eq!(
        report.value.contours,
        [line(1, 10.0, &[(0, 0), (5, 0)]), line(1, 10.0, &[(2, 3), (5, 0), (5, 3), (2, 3)])]
    );
    assert!(report.findings.is_empty());
}

#[test]
fn spikes_are_left_out() {
    let report = cleaned(vec![line(1, 10.0, &[(0, 0), (5, 0), (5, 5), (6, 9), (5, 5), (5, 0), (9, 1)])], 0.0);
    assert_eq!(report.value.contours, [line(1, 10.0, &[(0, 0), (5, 0), (9, 1)])]);
    assert_eq!(kinds(&report), [FindingKind::Spike]);
    assert_eq!(report.findings[0].place, Some(DVec2::new(6.0, 9.0)));
    assert!(report.findings[0].message.contains("9.123 map units"), "{}", report.findings[0]);
    // Two from one point are two.
    let report = cleaned(vec![line(1, 10.0, &[(0, 0), (5, 0), (5, 5), (5, 0), (6, -4), (5, 0), (9, 1)])], 0.0);
    assert_eq!(report.value.contours, [line(1, 10.0, &[(0, 0), (5, 0), (9, 1)])]);
    assert_eq!(kinds(&report), [FindingKind::Spike; 2]);
    // A whole line there and back stays once, and so does a ring without area.
    let report = cleaned(vec![line(1, 10.0, &[(0, 0), (5, 1), (9, 0), (5, 1), (0, 0)])], 0.0);
    assert_eq!(report.value.contours, [line(1, 10.0, &[(0, 0), (5, 1), (9, 0)])]);
    assert_eq!(kinds(&report), [FindingKind::Spike]);
    // Those that do not come back to a vertex, short of one and beyond one.
    let report = cleaned(vec![line(1, 10.0, &[(0, 0), (9, 0), (4, 0), (4, 9)])], 0.0);
    assert_eq!(report.value.contours, [line(1, 10.0, &[(0, 0), (4, 0), (4, 9)])]);
    assert_eq!(kinds(&report), [FindingKind::Spike]);
    let report = cleaned(vec![line(1, 10.0, &[(0, 3), (2, 0), (9, 0), (-4, 0), (-4, 9)])], 0.0);
    assert_eq!(report.value.contours, [line(1, 10.0, &[(-4, 9), (-4, 0), (2, 0), (0, 3)])]);
}

#[test]
fn a_vertex_on_an_own_segment_splits_the_line_without_loss() {
    let ring = line(1, 10.0, &[(0, 0), (9, 0), (9, 9), (4, 0), (0, 9), (0, 0)]);
    let report = cleaned(vec![ring], 0.0);
    assert_eq!(
        report.value.contours,
        [line(1, 10.0, &[(0, 0), (0, 9), (4, 0), (0, 0)]), line(1, 10.0, &[(4, 0), (9, 0), (9, 9), (4, 0)])]
    );
    assert_eq!(kinds(&report), [FindingKind::SelfCross]);
    assert_eq!(report.findings[0].place, Some(DVec2::new(4.0, 0.0)));
    // Two lines that touch so and have a common end as well.
    let report = cleaned(vec![line(1, 10.0, &[(0, 0), (9, 0)]), line(2, 10.0, &[(9, 0), (9, 9), (4, 0), (0, 9)])], 0.0);
    assert_eq!(
        report.value.contours,
        [line(1, 10.0, &[(0, 0), (4, 0), (0, 9)]), line(1, 10.0, &[(4, 0), (9, 0), (9, 9), (4, 0)])]
    );
}

#[test]
fn crossing_levels_lose_one_segment() {
    let report =
        cleaned(vec![line(1, 10.0, &[(-20, 0), (-2, 0), (2, 0), (20, 0)]), line(2, 20.0, &[(0, -20), (0, 20)])], 0.0);
    assert_eq!(
        report.value.contours,
        [line(1, 10.0, &[(-20, 0), (-2, 0)]), line(1, 10.0, &[(2, 0), (20, 0)]), line(2, 20.0, &[(0, -20), (0, 20)])]
    );
    assert_eq!(kinds(&report), [FindingKind::LevelsCross]);
    assert_eq!(report.findings[0].place, Some(DVec2::ZERO));
    assert_eq!(report.value.mended, [DVec2::ZERO]);
    let message = &report.findings[0].message;
    let parts = ["10 m (feature 1) crosses the contour 20 m (feature 2)", "one segment of it, 4.000 map units long"];
    assert!(parts.iter().all(|part| message.contains(part)), "{message}");
    assert_eq!(
        (&report.findings[0].features[..], &report.findings[0].elevations[..]),
        (&[1.into(), 2.into()][..], &[10.0, 20.0][..])
    );
}

#[test]
fn every_crossing_of_two_lines_is_reported() {
    let straight = line(1, 10.0, &[(-5, 0), (100, 0)]);
    // So many vertices on each side that none strays.
    let side = |from: i32, y: i32| (from..from + 5).map(move |x| (x, y));
    let wave: Vec<(i32, i32)> = [(0, 9)].into_iter().chain(side(10, -9)).chain(side(24, 9)).chain([(38, -9)]).collect();
    let wave = line(2, 20.0, &wave);
    let report = cleaned(vec![straight, wave.clone()], 0.0);
    assert_eq!(report.value.contours, [wave]);
    let places: Vec<_> = report.findings.iter().map(|f| (f.kind, f.place)).collect();
    assert_eq!(places, [5.0, 19.0, 33.0].map(|x| (FindingKind::LevelsCross, Some(DVec2::new(x, 0.0)))));
}

#[test]
fn of_two_long_segments_that_cross_the_shorter_goes() {
    for (long, short) in [(1, 2), (2, 1)] {
        let (a, b) = (line(long, 10.0, &[(-200, 0), (200, 0)]), line(short, 20.0, &[(0, -90), (0, 100), (50, 150)]));
        let report = cleaned(vec![a.clone(), b], 0.0);
        assert_eq!(report.value.contours, [a, line(short, 20.0, &[(0, 100), (50, 150)])]);
        assert_eq!(kinds(&report), [FindingKind::LevelsCross]);
        assert!(report.findings[0].message.contains("190.000 map units long"), "{}", report.findings[0]);
    }
}

#[test]
fn a_shared_vertex_of_two_levels_goes_from_one_line() {
    let report = cleaned(
        vec![
            line(1, 10.0, &[(-20, -9), (-3, -2), (0, 0), (3, -2), (20, -9)]),
            line(2, 20.0, &[(-5, 5), (0, 0), (5, 5)]),
        ],
        0.0,
    );
    assert_eq!(
        report.value.contours,
        [line(1, 10.0, &[(-20, -9), (-3, -2), (3, -2), (20, -9)]), line(2, 20.0, &[(-5, 5), (0, 0), (5, 5)])]
    );
    assert_eq!(kinds(&report), [FindingKind::LevelsCross]);
    let message = &report.findings[0].message;
    assert!(message.contains("touches the contour 20 m") && message.contains("a vertex of it, 2.000"), "{message}");
    let through =
        cleaned(vec![line(1, 10.0, &[(-5, 0), (0, 0), (5, 1)]), line(2, 20.0, &[(-5, 5), (0, 0), (5, -5)])], 0.0);
    assert_eq!(kinds(&through), [FindingKind::LevelsCross]);
    assert!(through.findings[0].message.contains("crosses the contour"), "{}", through.findings[0]);
}

#[test]
fn a_line_that_touches_another_level_twice_has_two_faults() {
    let report = cleaned(
        vec![line(1, 10.0, &[(-50, 0), (50, 0)]), line(2, 20.0, &[(-9, 9), (-5, 0), (0, 8), (5, 0), (9, 9)])],
        0.0,
    );
    assert_eq!(kinds(&report), [FindingKind::LevelsCross; 2]);
}

#[test]
fn a_cut_ring_is_one_open_line() {
    let ring = line(1, 10.0, &[(0, 0), (0, 4), (4, 4), (6, 2), (4, 0), (0, 0)]);
    let report = cleaned(vec![ring, line(2, 20.0, &[(2, -9), (2, 2)])], 0.0);
    let of_ring: Vec<_> = report.value.contours.iter().filter(|c| c.feature == 1).collect();
    assert_eq!(of_ring, [&line(1, 10.0, &[(0, 0), (0, 4), (4, 4), (6, 2), (4, 0)])]);
    assert_eq!(kinds(&report), [FindingKind::LevelsCross]);
}

#[test]
fn a_vertex_that_strays_over_another_line_goes_instead_of_a_piece_of_that() {
    let row = |y: i32| (0..11).map(|x| (2 * x, y)).collect::<Vec<_>>();
    let sound = line(2, 20.0, &row(4));
    let with = |moved: &[(usize, (i32, i32))]| {
        let mut points = row(0);
        moved.iter().for_each(|&(k, p)| points[k] = p);
        line(1, 10.0, &points)
    };
    let without = |gone: &[usize]| {
        let rest = row(0).into_iter().enumerate().filter(|(k, _)| !gone.contains(k));
        line(1, 10.0, &rest.map(|(_, p)| p).collect::<Vec<_>>())
    };
    let report = cleaned(vec![with(&[(4, (9, 7))]), sound.clone()], 0.0);
    assert_eq!(report.value.contours, [without(&[4]), sound.clone()]);
    assert_eq!(kinds(&report), [FindingKind::LevelsCross]);
    let message = &report.findings[0].message;
    let parts =
        ["10 m (feature 1) crosses the contour 20 m (feature 2)", "a vertex of it, 7.000 map units off its course"];
    assert!(parts.iter().all(|part| message.contains(part)), "{message}");
    // Two in a row, and one that makes the line cross itself.
    let report = cleaned(vec![with(&[(3, (5, 9)), (4, (9, 7))]), sound.clone()], 0.0);
    assert_eq!(report.value.contours, [without(&[3, 4]), sound.clone()]);
    assert!(report.findings[0].message.contains("2 vertices of it, up to 9.000"), "{}", report.findings[0]);
    let report = cleaned(vec![with(&[(4, (1, 1)), (1, (2, 3))])], 0.0);
    assert_eq!(kinds(&report), [FindingKind::SelfCross]);
    // One within another, which is in its way and meets nothing itself before that one goes.
    let mut outer = sound;
    outer.points[4] = DVec2::new(8.0, -4.0);
    let mut inner = line(3, 30.0, &row(8));
    inner.points[4] = DVec2::new(8.0, 2.0);
    let report = cleaned(vec![without(&[]), outer, inner], 0.0);
    assert_eq!(report.value.contours.iter().map(|c| c.points.len()).collect::<Vec<_>>(), [11, 10, 10]);
}

#[test]
fn of_several_vertices_the_one_that_changes_the_ground_least_goes() {
    // A line that runs back along itself for a little, and then crosses itself.
    let crossing = [(-60, -300), (0, -100), (0, 0), (0, 74), (-28, 103), (62, -3), (102, 105), (60, 160), (0, 300)];
    let turned = |turn: fn((i32, i32)) -> (i32, i32)| crossing.map(turn);
    for points in [crossing, turned(|(x, y)| (y, x)), turned(|(x, y)| (-x, -y)), turned(|(x, y)| (y, -x))] {
        for reversed in [false, true] {
            let (mut all, mut rest) = (points.to_vec(), points.to_vec());
            rest.remove(4);
            if reversed {
                all.reverse();
            }
            let report = cleaned(vec![line(1, 15.0, &all)], 0.01);
            assert_eq!(report.value.contours, cleaned(vec![line(1, 15.0, &rest)], 0.01).value.contours);
            assert_eq!((kinds(&report), report.value.contours.len()), (vec![FindingKind::SelfCross], 1));
        }
    }
    // Of two lines that cross with one vertex each, the one with the smaller bulge is straightened.
    let row = |y: i32, moved: &[(usize, (i32, i32))]| {
        let mut points: Vec<(i32, i32)> = (0..11).map(|x| (20 * x, y)).collect();
        moved.iter().for_each(|&(k, p)| points[k] = p);
        points
    };
    let (low, high) = (row(0, &[(5, (100, 30))]), row(40, &[(5, (100, 25))]));
    let report = cleaned(vec![line(1, 10.0, &low), line(2, 20.0, &high)], 0.0);
    assert_eq!(report.value.contours[0], line(1, 10.0, &low));
    assert_eq!(report.value.contours[1].points.len(), 10);
    // Two vertices of a narrow spike, and not one of the wide bulge that it meets.
    let mut spike: Vec<(i32, i32)> = (0..21).map(|x| (10 * x, 40)).collect();
    spike.splice(10..11, [(98, 5), (102, 5)]);
    let report = cleaned(vec![line(1, 10.0, &low), line(2, 20.0, &spike)], 0.0);
    assert_eq!(report.value.contours[0], line(1, 10.0, &low));
    assert_eq!(report.value.contours[1].points.len(), 20);
    assert!(report.findings[0].message.contains("2 vertices of it, up to 35.000"), "{}", report.findings[0]);
}

#[test]
fn a_line_upon_another_level_goes_as_one() {
    // Along a cliff the two levels run on the same vertices.
    let cliff: Vec<(i32, i32)> = (0..30).map(|i| (3 * i, (i * i) % 7)).collect();
    let lower = [&[(-5, -9), (-3, -4)], &cliff[..], &[(95, -9)]].concat();
    let upper = [&[(-5, 9), (-3, 7)], &cliff[..], &[(95, 9)]].concat();
    let report = cleaned(vec![line(1, 10.0, &lower), line(2, 20.0, &upper)], 0.0);
    let whole = report.value.contours.iter().filter(|c| c.points.len() > 30).count();
    assert_eq!(whole, 1, "one of the two levels stays whole");
    assert_eq!(kinds(&report), [FindingKind::OverlappingLines]);
    let (finding, length) = (&report.findings[0], line(0, 0.0, &cliff).length());
    let parts = [format!("for {length:.3} map units"), "87.000 east and 1.000 north".into(), "31 segments".into()];
    assert!(parts.iter().all(|part| finding.message.contains(part)), "{finding}");
    assert_eq!(finding.place, Some(DVec2::ZERO));
    // The same along a part of a ring, over its start.
    let ring = line(1, 10.0, &[(0, 0), (0, 9), (9, 9), (20, 5), (9, 0), (0, 0)]);
    let report = cleaned(vec![ring, line(2, 20.0, &[(-5, 9), (0, 9), (0, 0), (9, 0), (9, -9)])], 0.0);
    assert_eq!(kinds(&report), [FindingKind::OverlappingLines]);
    assert!(report.findings[0].message.contains("for 18.000 map units"), "{}", report.findings[0]);
}

#[test]
fn near_levels_count_as_touching() {
    let beside =
        |y: f64| Contour { elevation: 20.0, points: vec![DVec2::new(2.0, y), DVec2::new(3.0, 9.0)], feature: 2.into() };
    let base = line(1, 10.0, &[(0, 0), (9, 0)]);
    let near = cleaned(vec![base.clone(), beside(1e-7)], 0.0);
    assert_eq!(kinds(&near), [FindingKind::LevelsCross]);
    assert!(near.findings[0].message.contains("comes nearer than 0.000004"), "{}", near.findings[0]);
    assert!(cleaned(vec![base.clone(), beside(1e-5)], 0.0).findings.is_empty());
    // Of one level they may be as near as they like.
    let same = Contour { elevation: 10.0, ..beside(1e-7) };
    assert!(cleaned(vec![base, same], 0.0).findings.is_empty());
}

#[test]
fn lines_of_one_level_may_touch_and_not_cross() {
    let base = line(1, 10.0, &[(0, 0), (9, 0)]);
    let touching = vec![base.clone(), line(2, 10.0, &[(4, 0), (4, 9)]), line(3, 10.0, &[(7, 8), (9, 0), (12, 8)])];
    assert!(cleaned(touching, 0.0).findings.is_empty());
    let crossing = cleaned(vec![base.clone(), line(2, 10.0, &[(4, -1), (4, 2)])], 0.0);
    assert_eq!(crossing.value.contours, std::slice::from_ref(&base));
    assert_eq!(kinds(&crossing), [FindingKind::SelfCross]);
    let upon = cleaned(vec![base, line(2, 10.0, &[(2, 5), (2, 0), (5, 0), (5, 5)])], 0.0);
    assert_eq!(kinds(&upon), [FindingKind::OverlappingLines]);
    assert!(upon.findings[0].message.contains("for 3.000 map units"), "{}", upon.findings[0]);
    assert_eq!(upon.value.contours.len(), 3);
}

#[test]
fn a_copy_of_the_map_at_other_heights_is_cut_away() {
    let walk: Vec<(i32, i32)> = (0..5000).map(|i| (i % 70 * 3 + i / 70, i / 70 * 5 + i % 3)).collect();
    let report = cleaned(vec![line(1, 10.0, &walk), line(2, 20.0, &walk)], 0.0);
    assert!(report.value.vertex_count() >= 4900);
}

#[test]
fn a_tangle_is_refused() {
    // Every line crosses every other.
    let n = 4600;
    let lines = (0..n).map(|i| line(i as u64, f64::from(i), &[(0, i), (1_000_000, n - i)])).collect();
    let error = clean(map(lines), &CleanParams::default()).expect_err("no contour lines");
    assert!(matches!(error, Error::Data(_)) && error.to_string().contains("do not look like contour lines"), "{error}");
}

#[test]
fn distances_must_be_numbers() {
    for (snap, separation) in [(-1.0, 0.0), (f64::NAN, 0.0), (0.0, f64::INFINITY), (0.0, -1e-9)] {
        let error = clean(ContourMap::default(), &CleanParams { snap, separation }).expect_err("bad distance");
        assert!(matches!(error, Error::OutOfRange { .. }));
    }
}

#[test]
fn validate_finds_each_fault() {
    let faults = [
        vec![line(1, 10.0, &[(0, 0)])],
        vec![line(1, f64::NAN, &[(0, 0), (1, 0)])],
        vec![line(1, 10.0, &[(0, 0), (0, 0)])],
        vec![line(1, 10.0, &[(0, 0), (1, 0), (1, 1), (0, 0), (0, 1)])],
        vec![line(1, 10.0, &[(0, 0), (2, 2), (2, 0), (0, 2)])],
        vec![line(1, 10.0, &[(0, 0), (2, 2)]), line(2, 20.0, &[(2, 2), (3, 3)])],
    ];
    for fault in faults {
        assert!(validate(&map(fault.clone()), &CleanParams::default()).is_err(), "{fault:?}");
    }
}

#[test]
fn spot_heights_off_the_lines_stay() {
    let report =
        with_spots(vec![line(1, 10.0, &[(0, 0), (9, 3)])], &[[5.0, 5.0, 14.0], [1.0, 1.0, 12.0], [5.0, 5.0, 14.0]]);
    assert_eq!(report.value.spots, [DVec3::new(1.0, 1.0, 12.0), DVec3::new(5.0, 5.0, 14.0)]);
    assert!(report.findings.is_empty());
}

#[test]
fn spot_heights_on_lines_and_on_each_other_go() {
    let report = with_spots(
        vec![line(1, 10.0, &[(0, 0), (9, 3), (9, 30)])],
        &[
            [3.0, 1.0, 10.0],       // on the line, and right
            [6.0, 2.0, 11.0],       // on the line, and wrong
            [9.0, 3.0 + 1e-8, 7.0], // at a vertex, and wrong
            [4.0, 8.0, 13.0],
            [4.0, 8.0, 12.0],
            [4.0 + 1e-8, 8.0, 12.0],
            [f64::NAN, 0.0, 1.0],
            [0.0, 9.0, f64::INFINITY],
            [12.0, 4.0, 5.0], // on the first segment's line, beyond its end
        ],
    );
    assert_eq!(report.value.spots, [DVec3::new(4.0, 8.0, 12.0), DVec3::new(12.0, 4.0, 5.0)]);
    use FindingKind::{NonFinitePoint, SpotOnLine};
    assert_eq!(kinds(&report), [NonFinitePoint, NonFinitePoint, SpotOnLine, SpotOnLine, SpotOnLine]);
}
