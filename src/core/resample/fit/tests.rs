use glam::DVec2;

use crate::resample::fit::*;

fn ring(radius: f64, wave: f64, elevation: f64, n: u32) -> Contour {
    let point = |k: u32| {
        let a = f64::from(k % n) / f64::from(n) * std::f64::consts::TAU;
        DVec2::new(500_000.0, 4e6) + (radius + wave * (7.0 * a).sin()) * DVec2::from_angle(a)
    };
    Contour { elevation, points: (0..=n).map(point).collect(), feature: 0.into() }
}

fn fitted(contours: Vec<Contour>, tolerance: f64) -> Fitted {
    let map = ContourMap { contours, ..ContourMap::default() };
    let map = clean::clean(map, &CleanParams::default()).expect("rings").value;
    fit(map, &FitParams { tolerance, sampling: None }, &CleanParams::default()).expect("a clean map").value
}

fn brute(a: &Contour, b: &Contour) -> f64 {
    let to = |p: &DVec2| b.points.windows(2).map(|w| vertices::distance(*p, w[0], w[1])).fold(f64::INFINITY, f64::min);
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
    let counts = [4.0, 0.5, 0.01].map(count);
    assert!(0 < counts[0] && counts[0] < counts[1] && counts[1] < counts[2], "{counts:?}");
}

#[test]
fn ends_stay_bit_for_bit() {
    let points: Vec<DVec2> =
        (0..300).map(|k| DVec2::new(f64::from(k) * 3.1, 40.0 * (f64::from(k) / 17.0).sin())).collect();
    let line = Contour { elevation: 5.0, points: points.clone(), feature: 0.into() };
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
        assert!(fit(ContourMap::default(), &FitParams { tolerance, sampling: None }, &CleanParams::default()).is_err());
    }
}

fn small_ring(at: DVec2, radius: f64, elevation: f64) -> Contour {
    let point = |k: u32| at + radius * DVec2::from_angle(f64::from(k % 12) / 12.0 * std::f64::consts::TAU);
    Contour { elevation, points: (0..=12).map(point).collect(), feature: 9.into() }
}

/// A long line with a narrow spike, and what lies in or beside it.
fn spiked(others: Vec<Contour>, spots: Vec<glam::DVec3>) -> (ContourMap, Fitted) {
    let mut points: Vec<DVec2> = (0..=400).map(|k| DVec2::new(f64::from(k), 0.0)).collect();
    for (k, y) in [(198, 1.0), (199, 2.5), (200, 3.0), (201, 2.5), (202, 1.0)] {
        points[k].y = y;
    }
    let mut contours = vec![Contour { elevation: 10.0, points, feature: 0.into() }];
    contours.extend(others);
    let map = ContourMap { contours, spots, ..ContourMap::default() };
    let map = clean::clean(map, &CleanParams::default()).expect("sound").value;
    let params = FitParams { tolerance: 4.0, sampling: None };
    (map.clone(), fit(map, &params, &CleanParams::default()).expect("a clean map").value)
}

/// Height of the line with the spike at an x.
fn height_at(map: &ContourMap, x: f64) -> f64 {
    let line = map.contours.iter().find(|c| c.elevation == 10.0).expect("the line");
    let on = line.points.windows(2).find(|w| w[0].x <= x && x < w[1].x).expect("runs along x");
    on[0].y + (on[1].y - on[0].y) * (x - on[0].x) / (on[1].x - on[0].x)
}

#[test]
fn no_line_passes_over_a_smaller_one() {
    let (_, free) = spiked(Vec::new(), Vec::new());
    assert!(height_at(&free.map, 200.0) < 1.4, "the spike has to go, or the test tests nothing");
    assert_eq!(free.narrowed, [0; 3]);
    let inside = DVec2::new(200.0, 2.0);
    let open = Contour { elevation: 20.0, points: vec![inside, inside + DVec2::new(0.2, 0.3)], feature: 3.into() };
    for other in [small_ring(inside, 0.3, 20.0), open] {
        let (_, result) = spiked(vec![other], Vec::new());
        assert!(height_at(&result.map, 200.0) > 1.9, "{result:?}");
        assert!(result.narrowed.iter().sum::<usize>() + result.unchanged > 1);
    }
}

#[test]
fn no_line_passes_over_a_spot_height() {
    let (map, result) = spiked(Vec::new(), vec![glam::DVec3::new(200.0, 2.0, 12.0)]);
    assert_eq!(map.spots, result.map.spots);
    assert!(height_at(&result.map, 200.0) > 2.0, "{result:?}");
}

#[test]
fn one_sharp_corner_does_not_set_the_density_of_a_line() {
    let mut points: Vec<DVec2> = (0..=2000).map(|k| DVec2::new(f64::from(k), 0.0)).collect();
    points.extend((1..=2000).map(|k| DVec2::new(2000.0, f64::from(k))));
    let result = fitted(vec![Contour { elevation: 5.0, points, feature: 0.into() }], 0.1);
    assert!(result.unchanged == 0 && result.vertices_after < 1000, "{} {}", result.vertices_after, result.unchanged);
}

#[test]
fn even_vertices_for_sampling() {
    let map = ContourMap {
        contours: vec![ring(100.0, 6.0, 10.0, 2000), ring(80.0, 6.0, 20.0, 2000)],
        ..ContourMap::default()
    };
    let near = CleanParams::default();
    let map = clean::clean(map, &near).expect("rings").value;
    let sampling = SampleParams { ratio: 0.1, ..SampleParams::default() };
    let result = fit(map.clone(), &FitParams { tolerance: 1.0, sampling: Some(sampling) }, &near).expect("clean").value;
    for (c, input) in result.map.contours.iter().zip(&map.contours) {
        assert!(brute(c, input) <= 1.0 && brute(input, c) <= 1.0);
        let lengths: Vec<f64> = c.points.windows(2).map(|w| w[0].distance(w[1])).collect();
        let (short, long) = lengths.iter().fold((f64::INFINITY, 0.0f64), |m, &l| (m.0.min(l), m.1.max(l)));
        assert!(short > 0.2 * long, "{short} {long}");
    }
    let settled = sample::sample(result.map.clone(), &sampling, &near).expect("clean").value;
    assert!(settled.added * 10 < result.vertices_after, "nearly all points lie on the curve: {}", settled.added);
}
