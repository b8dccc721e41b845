use glam::DVec2;

use crate::resample::sample::*;

fn line(elevation: f64, points: &[(f64, f64)]) -> Contour {
    Contour { elevation, points: points.iter().map(|&(x, y)| DVec2::new(x, y)).collect(), feature: 0.into() }
}

fn two_lines(apart: f64) -> ContourMap {
    let contours = vec![line(10.0, &[(0.0, 0.0), (100.0, 0.0)]), line(20.0, &[(0.0, apart), (100.0, apart)])];
    ContourMap { contours, ..ContourMap::default() }
}

fn sampled(map: ContourMap, ratio: f64, least: Option<f64>) -> Sampled {
    sample(map, &SampleParams { ratio, least, ..SampleParams::default() }, &CleanParams::default())
        .expect("clean")
        .value
}

#[test]
fn parallel_lines_get_even_pieces() {
    for (apart, ratio) in [(10.0, 0.5), (10.0, 0.01), (3.0, 0.999)] {
        let result = sampled(two_lines(apart), ratio, None);
        for c in &result.map.contours {
            let lengths: Vec<f64> = c.points.windows(2).map(|w| w[0].distance(w[1])).collect();
            let (short, long) = lengths.iter().fold((f64::INFINITY, 0.0f64), |m, &l| (m.0.min(l), m.1.max(l)));
            assert!(long <= ratio * apart * (1.0 + 1e-12) && short > 0.49 * long, "{short} {long}");
            assert!(lengths.len() as f64 <= 2.0 * 100.0 / (ratio * apart) + 2.0, "twice as many as needed");
        }
        assert_eq!((result.held, result.whole), (0, 0));
    }
}

#[test]
fn one_line_alone_stays_as_it_is() {
    let map = ContourMap { contours: vec![line(1.0, &[(0.0, 0.0), (1e6, 0.0)])], ..ContourMap::default() };
    assert_eq!(sampled(map.clone(), 0.001, None).map, map);
}

#[test]
fn the_lower_limit_holds() {
    let result = sampled(two_lines(0.001), 0.5, Some(2.0));
    assert!(result.held > 0 && result.least == 2.0);
    for c in &result.map.contours {
        assert!(c.points.windows(2).all(|w| w[0].distance(w[1]) >= 2.0) && c.points.len() > 25);
    }
}

#[test]
fn too_many_points_are_refused_before_they_are_made() {
    let params = SampleParams { ratio: 1e-12, least: Some(1e-12), ..SampleParams::default() };
    let error = sample(two_lines(1.0), &params, &CleanParams::default()).expect_err("1e14 points").to_string();
    assert!(error.contains("more than 100000000 points") && error.contains("larger ratio"), "{error}");
    let params = SampleParams { ratio: 0.1, most: 100, ..SampleParams::default() };
    assert!(matches!(sample(two_lines(1.0), &params, &CleanParams::default()), Err(Error::TooManyPoints { .. })));
}

#[test]
fn bad_parameters_are_refused() {
    for ratio in [0.0, 1.0, -0.5, 2.0, f64::NAN] {
        let params = SampleParams { ratio, ..SampleParams::default() };
        assert!(sample(two_lines(1.0), &params, &CleanParams::default()).is_err());
    }
    for least in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        let params = SampleParams { least: Some(least), ..SampleParams::default() };
        assert!(sample(two_lines(1.0), &params, &CleanParams::default()).is_err());
    }
}

#[test]
fn points_are_taken_back_by_piece() {
    let cuts = |segments: &[u32]| segments.iter().map(|&segment| Cut { segment, share: 0.5 }).collect::<Vec<_>>();
    // Pieces: 0 and 1 of segment 0, 2 of segment 1, 3 to 5 of segment 2, 6 of segment 3.
    let all = cuts(&[0, 2, 2]);
    for (pieces, left, taken) in
        [(vec![0], vec![2, 2], 1), (vec![1, 2], vec![2, 2], 1), (vec![3], vec![0], 1), (vec![1, 5], vec![], 2)]
    {
        let mut some = all.clone();
        assert_eq!(take_back(&mut some, pieces.into_iter(), false), taken);
        assert_eq!(some, cuts(&left));
    }
    for piece in [2, 6] {
        let mut some = all.clone();
        assert_eq!(take_back(&mut some, std::iter::once(piece), false), 0);
        assert_eq!(take_back(&mut some, std::iter::once(piece), true), 2);
    }
}
