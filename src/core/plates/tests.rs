use super::*;
use crate::bands::BandKind;
use crate::slice::signed_area;

fn ring(points: &[(f64, f64)]) -> Vec<DVec2> {
    points.iter().chain(&points[..1]).map(|p| DVec2::from(*p)).collect()
}

fn square(low: (f64, f64), side: f64) -> Vec<DVec2> {
    let (x, y) = low;
    ring(&[(x, y), (x + side, y), (x + side, y + side), (x, y + side)])
}

fn turned(mut ring: Vec<DVec2>) -> Vec<DVec2> {
    ring.reverse();
    ring
}

fn band(from: f64, rings: Vec<Vec<DVec2>>) -> BandArea {
    BandArea { kind: BandKind::Ground, from: Some(from), to: Some(from + 10.0), rings, area: 0.0, share: 0.0 }
}

/// A map of 100 x 80 m with a terrace at its west side, on which there are a top and a rock of one metre.
fn terrace() -> Vec<BandArea> {
    let (top, rock) = (square((20.0, 20.0), 20.0), square((50.0, 50.0), 1.0));
    let low =
        [(0.0, 0.0), (100.0, 0.0), (100.0, 80.0), (0.0, 80.0), (0.0, 70.0), (60.0, 70.0), (60.0, 10.0), (0.0, 10.0)];
    vec![
        band(300.0, vec![ring(&low)]),
        band(310.0, vec![square((0.0, 10.0), 60.0), turned(top.clone()), turned(rock.clone())]),
        band(320.0, vec![top]),
        band(320.0, vec![rock]),
    ]
}

fn area(lines: &[Vec<DVec2>]) -> f64 {
    lines.iter().map(|ring| signed_area(ring)).sum()
}

#[test]
fn plates_lie_in_each_other_and_show_the_next_one() {
    let made = plates(&terrace(), Interval::every(10.0), 2.0, None).unwrap();
    assert_eq!((made.sheets.len(), made.size, made.left_out), (1, DVec2::new(200.0, 160.0), 1));
    let plates = &made.sheets[0].plates;
    assert_eq!(
        plates.iter().map(|plate| (plate.number, plate.level)).collect::<Vec<_>>(),
        [(1, 300.0), (2, 310.0), (3, 320.0)]
    );
    assert_eq!(plates.iter().map(|plate| area(&plate.cut)).collect::<Vec<_>>(), [32_000.0, 14_400.0, 1_600.0]);
    // What is cut anyway is not engraved. The rock is no hole and no outline.
    assert_eq!(plates.iter().map(|plate| plate.outline.len()).collect::<Vec<_>>(), [1, 1, 0]);
    assert_eq!(plates[0].outline[0].len(), 4);
    assert_eq!(plates[1].outline[0].len(), 5);
    assert_eq!(plates[1].cut.len(), 1);
    // The outline is the next plate, moved.
    let by = plates[2].cut[0].iter().map(|p| p.min_element()).fold(f64::INFINITY, f64::min);
    assert!(by >= 5.0);
    assert!((area(&plates[1].outline) - area(&plates[2].cut)).abs() < 1e-9);
    // Numbers lie inside the outline of the next plate, and in the highest one.
    for (plate, under) in [(0, &plates[0].outline), (1, &plates[1].outline), (2, &plates[2].cut)] {
        let bounds = Bounds::around(&under.concat());
        let strokes = &plates[plate].numbers;
        assert!(!strokes.is_empty());
        for p in strokes.iter().flatten() {
            assert!(bounds.min.cmplt(*p).all() && p.cmplt(bounds.max).all(), "{p} on plate {plate}");
        }
    }
}

#[test]
fn plates_do_not_meet_on_their_sheets() {
    for (sheet, count) in [(None, 1), (Some(DVec2::new(210.0, 170.0)), 2), (Some(DVec2::new(600.0, 400.0)), 1)] {
        let made = plates(&terrace(), Interval::every(10.0), 2.0, sheet).unwrap();
        assert_eq!(made.sheets.len(), count, "{sheet:?}");
        for Sheet { size, plates } in &made.sheets {
            assert_eq!(*size, sheet.unwrap_or(*size));
            let boxes: Vec<Bounds> = plates.iter().map(|plate| Bounds::around(&plate.cut.concat())).collect();
            for (k, own) in boxes.iter().enumerate() {
                assert!(own.min.min_element() > 4.999 && (*size - own.max).min_element() > 4.999);
                assert!(boxes[..k].iter().all(|other| !other.meets(&own.grown(4.999))), "{sheet:?}");
            }
        }
    }
    let error = plates(&terrace(), Interval::every(10.0), 2.0, Some(DVec2::new(300.0, 165.0))).unwrap_err();
    assert!(error.to_string().contains("plate 1 has 200.0 x 160.0 mm, which do not fit"), "{error}");
}

#[test]
fn what_gives_no_plates_is_refused() {
    let refused = |step: f64, scale: f64, words: &str| {
        let error = plates(&terrace(), Interval::every(step), scale, None).unwrap_err().to_string();
        assert!(error.contains(words), "{error}");
    };
    refused(500.0, 2.0, "there is one plate alone");
    refused(0.01, 2.0, "there are 2001 plates, more than 999");
    refused(10.0, 0.04, "are narrower than 3 mm");
    assert!(plates(&[], Interval::every(10.0), 2.0, None).is_err());
    // Ground that no line bounds belongs to the lowest plate.
    let mut areas = terrace();
    areas[0].from = None;
    let made = plates(&areas, Interval::every(10.0), 2.0, None).unwrap();
    assert_eq!(area(&made.sheets[0].plates[0].cut), 32_000.0);
}

#[test]
fn interval_and_factor_follow_from_each_other() {
    let params = |rise| PlateParams { thickness: 3.0, size: 300.0, rise, sheet: None };
    // One to ten thousand: 3 mm are 30 m.
    let scale = 0.1;
    assert_eq!(params(Rise::Exaggeration(1.5)).steps(scale).unwrap(), (Interval::every(3.0 / 0.1 / 1.5), 1.5));
    let (interval, factor) = params(Rise::Interval(20.0)).steps(scale).unwrap();
    assert!(interval == Interval::every(20.0) && (factor - 1.5).abs() < 1e-12);
    for rise in [Rise::Interval(0.0), Rise::Exaggeration(f64::NAN)] {
        assert!(params(rise).steps(scale).is_err());
    }
}

#[test]
fn the_widest_circle_is_found() {
    let shape = |rings: &[Vec<DVec2>]| Shape::new(rings).widest(0.1);
    let plain = shape(&[square((0.0, 0.0), 10.0)]);
    assert!((plain.radius - 5.0).abs() < 0.11, "{plain:?}");
    // In the wider arm of an angle.
    let angle = shape(&[ring(&[(0.0, 0.0), (40.0, 0.0), (40.0, 2.0), (8.0, 2.0), (8.0, 30.0), (0.0, 30.0)])]);
    assert!(angle.radius > 3.9 && angle.radius <= 4.9, "{angle:?}");
    // Beside a hole in the middle: in a corner.
    let hole = shape(&[square((0.0, 0.0), 10.0), turned(square((3.0, 3.0), 4.0))]);
    let expected = 3.0 * 2.0_f64.sqrt() / (1.0 + 2.0_f64.sqrt());
    assert!((hole.radius - expected).abs() < 0.06, "{hole:?} {expected}");
    // What is too narrow is told soon.
    let narrow = ring(&[(0.0, 0.0), (1000.0, 0.0), (1000.0, 0.5), (0.0, 0.5)]);
    assert!(Shape::new(&[narrow]).widest(1.5).radius < 1.5);
}

#[test]
fn numbers_fit_into_their_circle() {
    for (number, radius) in [(1, 1.5), (88, 1.5), (999, 1.5), (7, 200.0)] {
        let circle = Circle { middle: DVec2::new(50.0, -20.0), radius };
        let strokes = numeral(number, circle);
        let points = || strokes.iter().flatten();
        assert!(points().all(|p| p.distance(circle.middle) < radius), "{number}");
        let bounds = Bounds::around(&points().copied().collect::<Vec<_>>());
        assert!(bounds.max.y - bounds.min.y <= 5.0 * 1.3 + 1e-9);
    }
}
