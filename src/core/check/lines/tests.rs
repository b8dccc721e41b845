//! Each fault on a small map, the same map without it, and independence of the input's order.

use glam::DVec2;
use proptest::prelude::*;

use crate::base::error::Proposal;
use crate::check::lines::*;
use crate::check::{Correction, correct};
use crate::contour::Contour;
use crate::crs::Crs;

const PARAMS: LineParams = LineParams { snap: 0.01 };

fn line(feature: u64, elevation: f64, points: &[(f64, f64)]) -> Contour {
    Contour { elevation, points: points.iter().map(|&p| p.into()).collect(), feature: feature.into() }
}

/// A ring of 40 vertices.
fn ring(feature: u64, elevation: f64, centre: (f64, f64), radius: f64) -> Contour {
    let at =
        |k: i32| DVec2::from(centre) + radius * DVec2::from_angle(f64::from(k % 40) * std::f64::consts::TAU / 40.0);
    Contour { elevation, points: (0..=40).map(at).collect(), feature: feature.into() }
}

fn map(contours: Vec<Contour>) -> ContourMap {
    ContourMap { contours, ..ContourMap::default() }
}

fn found(contours: Vec<Contour>) -> Vec<Finding> {
    examine(&map(contours), &PARAMS).findings
}

fn kinds(findings: &[Finding]) -> Vec<FindingKind> {
    findings.iter().map(|f| f.kind).collect()
}

#[test]
fn an_empty_map_has_no_faults() {
    assert_eq!(found(Vec::new()), []);
    assert_eq!(found(vec![line(1, f64::NAN, &[]), line(2, 1.0, &[(f64::NAN, 0.0), (1.0, f64::INFINITY)])]), []);
}

#[test]
fn one_of_three_pieces_is_relabelled() {
    let pieces = vec![
        line(1, 10.0, &[(0.0, 0.0), (9.0, 0.0)]),
        line(2, 70.0, &[(9.0, 0.005), (50.0, 3.0), (90.0, 0.0)]),
        line(3, 10.0, &[(99.0, 0.0), (90.0, 0.0)]),
    ];
    let judged = examine(&map(pieces.clone()), &PARAMS);
    assert_eq!(kinds(&judged.findings), [FindingKind::LevelJump; 2]);
    for finding in &judged.findings {
        assert_eq!(finding.proposal, Some(Proposal::Relabel { from: 70.0, to: 10.0 }));
        assert_eq!((finding.features[0], &finding.elevations[..]), (2.into(), &[70.0, 10.0][..]));
    }
    assert_eq!(judged.findings[0].place, Some(DVec2::new(9.0, 0.0)));
    assert_eq!(judged.corrections, [Correction::Label { line: 1, elevation: 10.0 }]);
    let mended = correct(map(pieces), &judged.corrections).value;
    assert_eq!(examine(&mended, &PARAMS), Judged::default());
}

#[test]
fn of_two_pieces_nothing_tells_which_is_right() {
    let judged = examine(
        &map(vec![line(1, 10.0, &[(0.0, 0.0), (9.0, 0.0)]), line(2, 20.0, &[(9.0, 0.0), (99.0, 0.0)])]),
        &PARAMS,
    );
    assert_eq!(kinds(&judged.findings), [FindingKind::LevelJump]);
    assert_eq!((&judged.findings[0].proposal, judged.corrections.len()), (&None, 0));
    assert_eq!(judged.findings[0].elevations, [10.0, 20.0]);
    // Nor of a ring's halves, nor where count and length contradict each other.
    let halves = vec![
        line(1, 10.0, &[(0.0, 0.0), (5.0, 5.0), (9.0, 0.0)]),
        line(2, 20.0, &[(9.0, 0.0), (5.0, -5.0), (0.0, 0.0)]),
    ];
    let judged = examine(&map(halves), &PARAMS);
    assert_eq!((kinds(&judged.findings), judged.corrections.len()), (vec![FindingKind::LevelJump; 2], 0));
    let long = vec![
        line(1, 10.0, &[(0.0, 0.0), (900.0, 0.0)]),
        line(2, 20.0, &[(900.0, 0.0), (910.0, 0.0)]),
        line(3, 20.0, &[(910.0, 0.0), (920.0, 0.0)]),
    ];
    let judged = examine(&map(long), &PARAMS);
    assert_eq!((kinds(&judged.findings), judged.corrections.len()), (vec![FindingKind::LevelJump], 0));
}

#[test]
fn most_pieces_of_a_ring_tell_its_elevation() {
    let corners = [(0.0, 0.0), (10.0, 0.0), (14.0, 8.0), (8.0, 14.0), (0.0, 10.0)];
    for wrong in 0..5 {
        let piece = |i: usize| {
            let elevation = if i == wrong { 990.0 } else { 10.0 };
            line(i as u64, elevation, &[corners[i], corners[(i + 1) % 5]])
        };
        let judged = examine(&map((0..5).map(piece).collect()), &PARAMS);
        assert_eq!(kinds(&judged.findings), [FindingKind::LevelJump; 2]);
        assert_eq!(judged.corrections, [Correction::Label { line: wrong as u32, elevation: 10.0 }]);
    }
}

#[test]
fn ends_that_meet_by_right_are_no_jumps() {
    let base = line(1, 10.0, &[(0.0, 0.0), (9.0, 0.0)]);
    // Ends of one level; ends further apart than the snap distance; three ends at one point; a vertex that is no end.
    for others in [
        vec![line(2, 10.0, &[(9.0, 0.0), (20.0, 0.0)])],
        vec![line(2, 20.0, &[(9.0, 0.02), (20.0, 0.0)])],
        vec![line(2, 10.0, &[(9.0, 0.0), (20.0, 0.0)]), line(3, 20.0, &[(9.0, 0.0), (9.0, 9.0)])],
        vec![line(2, 20.0, &[(9.0, -9.0), (9.0, 0.0), (9.0, 9.0)])],
    ] {
        let findings = found([vec![base.clone()], others].concat());
        assert_eq!(findings, []);
    }
}

#[test]
fn a_jump_and_what_cleaning_tells_of_it_are_one_fault() {
    let contours = vec![
        line(1, 10.0, &[(0.0, 0.0), (9.0, 0.0)]),
        line(2, 20.0, &[(9.0, 0.0), (99.0, 0.0)]),
        line(3, 30.0, &[(5.0, -5.0), (5.0, 5.0)]),
    ];
    let reported = found(contours.clone());
    let cleaning = crate::clean::clean(map(contours), &crate::clean::CleanParams::default()).unwrap().findings;
    assert_eq!(kinds(&cleaning), [FindingKind::LevelsCross; 2]);
    let all = merged(reported, cleaning, PARAMS.snap);
    assert_eq!(kinds(&all), [FindingKind::LevelJump, FindingKind::LevelsCross]);
    assert!(all[0].message.contains("was left out") && all[1].elevations == [10.0, 30.0], "{all:?}");
}

#[test]
fn a_vertex_far_away_is_reported_and_its_line_stays_near() {
    for at in [0, 7] {
        let mut lines = vec![ring(1, 10.0, (1000.0, 2000.0), 100.0), ring(2, 20.0, (1000.0, 2000.0), 50.0)];
        lines[0].points[at].y += 100_000.0;
        lines[0].points[40] = lines[0].points[0];
        let findings = found(lines.clone());
        assert_eq!(kinds(&findings), [FindingKind::FarAway]);
        assert_eq!((findings[0].place, &findings[0].features[..]), (Some(lines[0].points[at]), &[1.into()][..]));
    }
    // A long way out and back over many vertices is none, nor a narrow inlet on a line that has such steps.
    let inlet = [(0.0, 0.0), (400.0, 0.0), (800.0, 0.0), (810.0, 9000.0), (820.0, 0.0), (1200.0, 0.0), (1600.0, 0.0)];
    assert_eq!(found(vec![line(1, 10.0, &inlet)]), []);
}

#[test]
fn a_sheet_of_another_zone_is_far_away() {
    let sheet = |east: f64, from: u64| -> Vec<Contour> {
        (0..6).map(|k| ring(from + k, 10.0 * k as f64, (east + 300.0 * (k % 3) as f64, 5e6), 80.0)).collect()
    };
    let at = |east: f64| found([sheet(500_000.0, 0), sheet(501_000.0, 10), sheet(east, 20)].concat());
    assert_eq!(at(502_000.0), []);
    let findings = at(-100_000.0);
    assert_eq!(kinds(&findings), [FindingKind::FarAway]);
    assert_eq!(findings[0].features, (20..26).collect::<Vec<u64>>());
    // Two such sheets at different places are two findings.
    assert_eq!(
        kinds(&found([sheet(5e5, 0), sheet(5.01e5, 10), sheet(5.02e5, 20), sheet(9e5, 30), sheet(3e6, 40)].concat()))
            .len(),
        2
    );
    // Two islands, one much smaller.
    assert_eq!(found([sheet(0.0, 0), vec![ring(9, 10.0, (6000.0, 5e6), 30.0)]].concat()), []);
}

#[test]
fn degrees_are_reported_where_a_projected_system_is_given() {
    let degrees = |k: u64| ring(k, 10.0 * k as f64, (135.0, 35.0), 0.001 * k as f64);
    let metres = |k: u64| ring(k, 10.0 * k as f64, (5e5, 4e6), 50.0 * k as f64);
    let (small, large): (Vec<_>, Vec<_>) = (1..4).map(|k| (degrees(k), metres(k))).unzip();
    let with = |contours: &[Contour], crs| ContourMap { crs, ..map(contours.to_vec()) };
    let kinds_of = |map: ContourMap| kinds(&examine(&map, &PARAMS).findings);
    let (utm, wgs84) = (Some(Crs::from_epsg(32653)), Some(Crs::wgs84()));
    assert_eq!(kinds_of(with(&small, utm.clone())), [FindingKind::LooksLikeDegrees]);
    assert_eq!(kinds_of(with(&small, None)), [FindingKind::LooksLikeDegrees]);
    assert_eq!(kinds_of(with(&small, wgs84.clone())), []);
    assert_eq!(kinds_of(with(&large, utm.clone())), []);
    assert_eq!(kinds_of(with(&large, wgs84)), [FindingKind::LooksLikeDegrees]);
    // Some lines only.
    let mixed = [&large[..], &small[..1]].concat();
    let findings = examine(&with(&mixed, utm), &PARAMS).findings;
    assert_eq!(kinds(&findings), [FindingKind::LooksLikeDegrees]);
    assert_eq!((&findings[0].features[..], &findings[0].elevations[..]), (&[1.into()][..], &[10.0][..]));
    assert_eq!(kinds_of(with(&[&large[..1], &small[..]].concat(), None)), [FindingKind::LooksLikeDegrees]);
    // A small plan near the origin.
    assert_eq!(kinds_of(map(vec![ring(1, 1.0, (50.0, 50.0), 30.0)])), []);
}

#[test]
fn levels_that_stand_for_no_data_are_reported() {
    let hill = |odd: &[f64]| -> Vec<Contour> {
        let levels = (1..8).map(|k| 300.0 + 10.0 * f64::from(k)).chain(odd.iter().copied());
        (0u64..).zip(levels).map(|(i, z)| ring(i, z, (0.0, 0.0), 100.0 + 10.0 * i as f64)).collect()
    };
    assert_eq!(found(hill(&[])), []);
    let findings = found(hill(&[0.0, -9999.0, -9999.0 * 0.3048, 1e38, 0.0]));
    assert_eq!(kinds(&findings), [FindingKind::ZeroElevation; 5]);
    let features: Vec<FeatureId> = findings.iter().flat_map(|f| f.features.clone()).collect();
    assert_eq!(features.len(), 5);
    // A wrong number that stands for nothing, and a coast.
    assert_eq!(found(hill(&[40.0])), []);
    let coast = (0..8).map(|k| ring(k, 10.0 * k as f64, (0.0, 0.0), 500.0 - 10.0 * k as f64)).collect();
    assert_eq!(found(coast), []);
    // Many zeros are the map's own.
    assert_eq!(found(hill(&[0.0; 9])), []);
}

#[test]
fn lines_of_almost_no_length_are_reported() {
    let base = ring(1, 10.0, (0.0, 0.0), 100.0);
    let dot = line(2, 20.0, &[(0.0, 0.0), (0.001, 0.0)]);
    assert_eq!(kinds(&found(vec![base.clone(), dot.clone()])), [FindingKind::ShortLine]);
    let speck = ring(3, 20.0, (0.0, 0.0), 1e-4);
    let flat = line(4, 20.0, &[(0.0, 0.0), (50.0, 0.0), (50.0, 1e-9), (0.0, 0.0)]);
    assert_eq!(kinds(&found(vec![base.clone(), flat])), [FindingKind::ShortLine]);
    assert_eq!(kinds(&found(vec![base.clone(), ring(7, 10.0, (50.0, 0.0), 9.0), speck])), [FindingKind::ShortLine]);
    // A piece of a line that was cut there, and a line that runs back to its start.
    let rest = line(5, 20.0, &[(0.001, 0.0), (9.0, 0.0)]);
    assert_eq!(found(vec![base.clone(), dot, rest]), []);
    assert_eq!(found(vec![base, line(6, 20.0, &[(0.0, 0.0), (50.0, 0.0), (40.0, 0.0), (0.0, 0.0)])]), []);
}

/// Numbers of all sizes, and none.
fn wild() -> impl Strategy<Value = f64> {
    prop_oneof![
        4 => (-4i32..4).prop_map(f64::from),
        1 => prop::num::f64::ANY,
        1 => prop::sample::select(vec![0.0, -0.0, 1e-320, 1e50, -9999.0, 1e300, 4e6]),
    ]
}

proptest! {
    #![proptest_config(crate::draws::draws())]

    #[test]
    fn nothing_panics_and_the_order_does_not_matter(
        rows in prop::collection::vec((prop::collection::vec((wild(), wild()), 0..7), wild()), 0..9),
        snap in prop::sample::select(vec![0.0, 0.01, 2.0, f64::NAN, f64::INFINITY]),
    ) {
        let lines = (0u64..).zip(&rows).map(|(i, (points, z))| line(i, *z, points));
        let one = map(lines.collect());
        let mut other = one.clone();
        other.contours.reverse();
        let judged = examine(&one, &LineParams { snap });
        let again = examine(&other, &LineParams { snap });
        prop_assert_eq!(format!("{:?}", &judged.findings), format!("{:?}", again.findings));
        prop_assert_eq!(judged.corrections.len(), again.corrections.len());
        let _ = correct(one, &judged.corrections);
    }
}

#[test]
fn a_vertex_off_its_line_is_reported_and_left_out() {
    let sound = ring(1, 10.0, (0.0, 0.0), 50.0);
    for vertex in [0, 7, 39] {
        let mut moved = sound.clone();
        moved.points[vertex] *= 0.5;
        moved.points[40] = moved.points[0];
        let place = moved.points[vertex];
        let map = map(vec![moved]);
        let judged = examine(&map, &PARAMS);
        assert_eq!(kinds(&judged.findings), [FindingKind::StrayVertex]);
        assert_eq!((judged.findings[0].place, &judged.findings[0].proposal), (Some(place), &Some(Proposal::LeaveOut)));
        let mended = correct(map, &judged.corrections).value;
        assert_eq!(mended.contours[0].points.len(), 40);
        assert!(examine(&mended, &PARAMS).findings.is_empty());
    }
}

#[test]
fn a_vertex_that_cleaning_left_out_is_reported_once() {
    let place = DVec2::new(3.0, 4.0);
    let reported = vec![Finding::at(FindingKind::StrayVertex, place, "stands out")];
    let crossing = Finding::at(FindingKind::LevelsCross, place, "crosses");
    assert_eq!(merged(reported.clone(), vec![crossing.clone()], 0.0), [crossing]);
    assert_eq!(merged(reported.clone(), Vec::new(), 0.0), reported);
}
