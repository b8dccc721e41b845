//! Lines whose end runs on over themselves.

use crate::clean::tests::*;

/// A ring of 24 vertices in centimetres, with others before and after them: the numbers of its vertices.
fn overrun(numbers: impl Iterator<Item = i32>) -> Contour {
    let at = |k: i32| {
        let p = 75.0 * DVec2::from_angle(f64::from(k.rem_euclid(24)) * std::f64::consts::TAU / 24.0);
        DVec2::new(500_000.0, 5_000_000.0) + (100.0 * p).round() / 100.0
    };
    Contour { elevation: 110.0, points: numbers.map(at).collect(), feature: 4.into() }
}

#[test]
fn a_ring_whose_end_overruns_it_is_closed() {
    let ring = cleaned(vec![overrun(0..25)], 0.01).value.contours;
    assert_eq!(ring[0].points.len(), 25);
    let half_way = |mut line: Contour, from: i32, to: i32| {
        let [a, b] = [from, to].map(|k| overrun(k..k + 1).points[0]);
        line.points.push((100.0 * a.midpoint(b)).round() / 100.0);
        line
    };
    let cases = [
        ("back", overrun((0..25).chain([23, 22, 21]))),
        ("forward", overrun(0..28)),
        ("back at the start", overrun([3, 2, 1].into_iter().chain(0..25))),
        ("forward at both ends", overrun(-4..30)),
        ("twice round and on", overrun(0..55)),
        ("back into a segment", half_way(overrun((0..25).chain([23, 22])), 22, 21)),
        ("forward into a segment", half_way(overrun(0..27), 2, 3)),
        ("forward into the first segment", half_way(overrun(0..25), 0, 1)),
    ];
    for (name, line) in cases {
        for reversed in [false, true] {
            let mut line = line.clone();
            if reversed {
                line.points.reverse();
            }
            let report = cleaned(vec![line], 0.01);
            assert_eq!(report.value.contours, ring, "{name}");
            assert!(!kinds(&report).is_empty(), "{name}");
            assert!(kinds(&report).iter().all(|kind| *kind == FindingKind::OverlappingLines), "{name}: {report:?}");
        }
    }
    // Drawn exactly twice.
    let report = cleaned(vec![overrun(0..49)], 0.01);
    assert_eq!((report.value.contours.clone(), kinds(&report)), (ring, vec![FindingKind::DuplicateLine]));
    // Both ends between the same two vertices.
    let mut line = overrun(1..24);
    let [a, b] = [0, 1].map(|k| overrun(k..k + 1).points[0]);
    line.points.insert(0, overrun(0..1).points[0]);
    line.points[0] = a.lerp(b, 0.3);
    line.points.push(a);
    line.points.push(a.lerp(b, 0.7));
    let report = cleaned(vec![line], 0.01);
    assert_eq!((report.value.contours.len(), kinds(&report)), (1, vec![FindingKind::OverlappingLines]));
    assert!(report.value.contours[0].is_closed() && report.value.contours[0].points.len() == 26);
}

#[test]
fn an_open_line_whose_end_runs_back_keeps_its_end() {
    let course: Vec<(i32, i32)> = (0..9).map(|k| (10 * k, k * k % 5)).collect();
    let whole = line(1, 10.0, &course);
    for back in 1..4 {
        let run = |course: &[(i32, i32)]| course.iter().rev().skip(1).take(back).copied().collect::<Vec<_>>();
        let end = [&course[..], &run(&course)].concat();
        let from_end: Vec<(i32, i32)> = course.iter().rev().copied().collect();
        let both = [&run(&from_end).into_iter().rev().collect::<Vec<_>>()[..], &end].concat();
        for (points, ends) in [(end, 1), (both, 2)] {
            let report = cleaned(vec![line(1, 10.0, &points)], 0.0);
            assert_eq!(report.value.contours, std::slice::from_ref(&whole));
            assert_eq!(kinds(&report), vec![FindingKind::OverlappingLines; ends]);
            assert!(report.findings[0].message.contains("only one of the two runs was kept"), "{report:?}");
        }
    }
}
