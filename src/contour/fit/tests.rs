use glam::DVec2;

use super::*;

fn ring(radius: f64, wave: f64, elevation: f64, n: u32) -> Contour {
    let point = |k: u32| {
        let a = f64::from(k % n) / f64::from(n) * std::f64::consts::TAU;
        DVec2::new(500_000.0, 4e6) + (radius + wave * (7.0 * a).sin()) * DVec2::from_angle(a)
    };
    Contour { elevation, points: (0..=n).map(point).collect(), feature: 0 }
}

fn fitted(contours: Vec<Contour>, tolerance: f64) -> Fitted {
    let map = ContourMap { contours, ..ContourMap::default() };
    let map = clean::clean(map, &CleanParams::default()).expect("rings").value;
    fit(map, &FitParams { tolerance }, &CleanParams::default()).expect("a clean map").value
}

fn brute(a: &Contour, b: &Contour) -> f64 {
    let to = |p: &DVec2| b.points.windows(2).map(|w| spline::distance(*p, w[0], w[1])).fold(f64::INFINITY, f64::min);
    a.points.iter().map(to).fold(0.0, f64::max)
}

#[test]
fn a_circle_needs_few_control_points() {
    let circle = ring(100.0, 0.0, 10.0, 1000);
    let result = fitted(vec![circle.clone()], 0.5);
    assert!(result.control_points <= 12 && result.control_points > 0, "{result:?}");
    let line = &result.map.contours[0];
    let deviation = brute(line, &circle).max(brute(&circle, line));
    assert!(deviation <= 0.5 && deviation <= result.deviation + 1e-9, "{deviation} {}", result.deviation);
}

#[test]
fn half_the_tolerance_takes_more_control_points() {
    let count = |t: f64| fitted(vec![ring(100.0, 20.0, 10.0, 2000)], t).control_points;
    assert!(count(4.0) < count(0.5) && count(0.5) < count(0.01));
}

#[test]
fn ends_stay_bit_for_bit() {
    let points: Vec<DVec2> =
        (0..300).map(|k| DVec2::new(f64::from(k) * 3.1, 40.0 * (f64::from(k) / 17.0).sin())).collect();
    let line = Contour { elevation: 5.0, points: points.clone(), feature: 0 };
    let result = fitted(vec![line.clone()], 1.0);
    let out = &result.map.contours[0];
    assert!(result.unchanged == 0 && out.points.len() < 300);
    assert_eq!((out.points[0], out.points[out.points.len() - 1]), (points[0], points[299]));
    assert!(brute(&line, out) <= 1.0 && brute(out, &line) <= 1.0);
}

#[test]
fn rings_that_would_cross_fall_back() {
    let result = fitted(vec![ring(100.0, 6.0, 10.0, 2000), ring(101.0, 6.0, 20.0, 2000), ring(90.0, 0.0, 0.0, 9)], 8.0);
    assert!(result.narrowed.iter().sum::<usize>() + result.unchanged > 0, "{result:?}");
    clean::validate(&result.map, &CleanParams::default()).expect("no crossing");
}

#[test]
fn no_tolerance_is_refused() {
    for tolerance in [0.0, -1.0, f64::NAN] {
        assert!(fit(ContourMap::default(), &FitParams { tolerance }, &CleanParams::default()).is_err());
    }
}
