//! Break lines and spot heights with a standard error: the surface follows them as far as the contours allow.

use glam::{DVec2, DVec3};
use tokosen::base::error::{Finding, FindingKind};
use tokosen::break_lines::{Bend, BreakLine};
use tokosen::contour::{Contour, ContourMap, SoftSpot};
use tokosen::spline::{SplineParams, Wanted};
use tokosen::surface::{Given, Surface, SurfaceKind, SurfaceParams, build};

/// An even slope, `z = y / 10`, by its contours every 10 m from y = 0 to 600.
fn slope() -> ContourMap {
    let contour = |k: i32| {
        let points = (-10..=10).map(|i| DVec2::new(30.0 * f64::from(i), 100.0 * f64::from(k))).collect();
        Contour { elevation: 10.0 * f64::from(k), points, feature: 0.into() }
    };
    ContourMap { contours: (0..=6).map(contour).collect(), ..ContourMap::default() }
}

fn line(points: &[(f64, f64)], heights: &[f64], bend: Bend) -> BreakLine {
    BreakLine { points: points.iter().map(|&p| p.into()).collect(), heights: heights.into(), bend, feature: 7.into() }
}

fn built(map: ContourMap, break_lines: Vec<BreakLine>, kind: SurfaceKind) -> (Surface, Vec<Finding>) {
    let spline = SplineParams { wanted: Some(Wanted::Cell(5.0)), ..SplineParams::default() };
    let params = SurfaceParams { kind, spline, ..SurfaceParams::default() };
    let given = Given { break_lines, ..Given::default() };
    let report = build(map, &given, &params, &()).expect("a slope has a surface");
    (report.value, report.findings)
}

/// The height of the smooth surface.
fn at(surface: &Surface, x: f64, y: f64) -> f64 {
    let working = &surface.working.as_ref().expect("it is smooth").0[0];
    let place = working.grid.place(DVec2::new(x, y)).round();
    f64::from(working.heights[place.y as usize * working.grid.cols + place.x as usize])
}

#[test]
fn the_surface_passes_through_the_heights_of_a_break_line_and_bends_there() {
    // A ditch along the slope: its bottom is 3 m below the ground, its edges are on it.
    let x = [-150.0, 150.0];
    let along = |y: f64| x.map(|x| (x, y));
    let ditch = || {
        vec![
            line(&along(237.5), &[23.75; 2], Bend::Either),
            line(&along(247.5), &[22.0; 2], Bend::Valley),
            line(&along(257.5), &[25.75; 2], Bend::Either),
        ]
    };
    let (surface, findings) = built(slope(), ditch(), SurfaceKind::Spline);
    assert_eq!(findings, []);
    assert_eq!(surface.break_lines.len(), 3);
    let (plain, _) = built(slope(), Vec::new(), SurfaceKind::Spline);
    let grid = surface.working.as_ref().unwrap().0[0].grid;
    assert_eq!(grid, plain.working.as_ref().unwrap().0[0].grid);
    // The lines run through nodes, because cells lie on multiples of their size.
    assert!(grid.place(DVec2::new(0.0, 247.5)).y.fract().abs() < 1e-9);
    for x in [-97.5, 2.5, 97.5] {
        for (y, truth) in [(237.5, 23.75), (242.5, 22.875), (247.5, 22.0), (252.5, 23.875), (257.5, 25.75)] {
            let z = at(&surface, x, y);
            assert!((z - truth).abs() < 0.3, "{x} {y}: {z}, not {truth}");
            assert!((at(&plain, x, y) - y / 10.0).abs() < 0.3);
        }
        // Beside the ditch, the ground is nearly as before.
        for y in [207.5, 292.5] {
            assert!((at(&surface, x, y) - at(&plain, x, y)).abs() < 0.8, "{x} {y}: {}", at(&surface, x, y));
        }
    }
    // In the triangulation, the line is exact.
    let (skeleton, _) = built(slope(), ditch(), SurfaceKind::Skeleton);
    let on_line: Vec<f64> = (0..skeleton.tin.heights.len() as u32)
        .map(|v| skeleton.tin.point(v))
        .filter(|p| p.y == 247.5 && p.x.abs() < 150.0)
        .map(|p| p.z)
        .collect();
    assert!(on_line.len() > 3 && on_line.iter().all(|z| *z == 22.0), "{on_line:?}");
}

#[test]
fn the_surface_of_noisy_contours_passes_through_surveyed_heights_too() {
    // The bottom of a ditch, 3 m below the ground, midway between two contours.
    let ditch = line(&[(-150.0, 247.5), (150.0, 247.5)], &[22.0; 2], Bend::Valley);
    let spline = SplineParams { wanted: Some(Wanted::Cell(5.0)), noise: Some(1.0), ..SplineParams::default() };
    let given = Given { break_lines: vec![ditch], ..Given::default() };
    let params = SurfaceParams { spline, ..SurfaceParams::default() };
    let surface = build(slope(), &given, &params, &()).expect("a slope has a surface").value;
    for x in [-97.5, 2.5, 97.5] {
        let z = at(&surface, x, 247.5);
        assert!((z - 22.0).abs() < 0.1, "{x}: {z}");
    }
}

#[test]
fn the_nodes_are_close_enough_for_lines_beside_each_other() {
    // A ditch that is narrower than two cells. Its bottom is 3 m below the ground.
    let x = [-150.0, 150.0];
    let ditch = || {
        [(243.5, 24.35), (248.5, 21.85), (253.5, 25.35)].map(|(y, z)| line(&x.map(|x| (x, y)), &[z; 2], Bend::Either))
    };
    let errors = |nodes_per_line_spacing: f64| {
        let spline = SplineParams { wanted: Some(Wanted::Cell(5.0)), ..SplineParams::default() };
        let mut params = SurfaceParams { spline, ..SurfaceParams::default() };
        params.tuning.break_lines.nodes_per_line_spacing = nodes_per_line_spacing;
        let given = Given { break_lines: ditch().into(), ..Given::default() };
        let surface = build(slope(), &given, &params, &()).expect("a slope has a surface").value;
        // Both sides of the ditch are planes.
        let truth = [(247.5, 21.85 + 0.5 * 1.0), (252.5, 21.85 + 0.7 * 4.0)];
        let places = [-97.5, 2.5, 97.5].into_iter().flat_map(|x| truth.map(|(y, z)| (x, y, z)));
        let worst = places.map(|(x, y, z)| (at(&surface, x, y) - z).abs()).fold(0.0, f64::max);
        (surface.working.expect("it is smooth").0[0].grid.cell.x, worst)
    };
    let ((coarse, before), (fine, after)) = (errors(0.01), errors(2.0));
    assert_eq!((coarse, fine), (5.0, 5.0 / 3.0));
    assert!(after < 0.3 && after < 0.5 * before, "{before} m, with more nodes {after} m");
}

#[test]
fn contours_win_over_heights_of_break_lines_and_that_is_told() {
    // Across the contours of 20 and 30 m, 4 m too high between them.
    let across = line(&[(0.0, 150.0), (0.0, 250.0), (0.0, 350.0)], &[15.0, 34.0, 35.0], Bend::Ridge);
    let (surface, findings) = built(slope(), vec![across], SurfaceKind::Spline);
    let told: Vec<&Finding> = findings.iter().filter(|f| f.kind == FindingKind::BreakLineConflict).collect();
    assert_eq!(told.len(), 1, "{findings:?}");
    assert!(told[0].message.contains("above") && told[0].features[0] == 7, "{told:?}");
    let line = &surface.break_lines[0];
    for level in [20.0, 30.0] {
        assert!(line.points.contains(&DVec3::new(0.0, 10.0 * level, level)), "{:?}", line.points);
    }
    assert!(line.points.iter().filter(|p| p.y > 200.0 && p.y < 300.0).all(|p| p.z > 20.0 && p.z < 30.0));
}

#[test]
fn what_lies_outside_is_told_with_its_length() {
    let inside = line(&[(0.0, 550.0), (0.0, 700.0)], &[], Bend::Either);
    let far = BreakLine { feature: 8.into(), ..line(&[(900.0, 0.0), (950.0, 0.0)], &[1.0, 2.0], Bend::Either) };
    let (surface, findings) = built(slope(), vec![inside, far], SurfaceKind::Spline);
    assert_eq!(surface.break_lines.len(), 1);
    let told: Vec<&str> = findings.iter().map(|f| f.message.as_str()).collect();
    assert!(told.len() == 2 && told[0].starts_with("100.0 map") && told[1].starts_with("50.0 map"), "{told:?}");
}

#[test]
fn a_line_without_heights_lets_the_surface_bend_the_way_that_it_says() {
    // A valley with straight sides, `z = (y + 0.75 |x|) / 10`.
    let contour = |k: i32| {
        let point = |i: i32| DVec2::new(20.0 * f64::from(i), 100.0 * f64::from(k) - 15.0 * f64::from(i.abs()));
        Contour { elevation: 10.0 * f64::from(k), points: (-10..=10).map(point).collect(), feature: 0.into() }
    };
    let valley = || ContourMap { contours: (0..=6).map(contour).collect(), ..ContourMap::default() };
    // How much too high the middle of the valley is, half-way between contours.
    let error = |bend: Option<Bend>| {
        let lines = bend.map(|bend| line(&[(0.0, 10.0), (0.0, 590.0)], &[], bend)).into_iter().collect();
        let (surface, findings) = built(valley(), lines, SurfaceKind::Spline);
        assert_eq!(findings, []);
        at(&surface, 0.0, 250.0) - 25.0
    };
    let [ridge, valley, edge] = [Bend::Ridge, Bend::Valley, Bend::Either].map(|bend| error(Some(bend)));
    assert!(valley.abs() < 0.6 && (valley - edge).abs() < 0.05, "{valley} {edge}");
    assert!(ridge > valley + 0.2, "{ridge} {valley}");
    assert!((ridge - error(None)).abs() < 0.1, "a ridge line does not make a valley sharper");
}

#[test]
fn the_surface_comes_near_spot_heights_as_far_as_their_standard_error_says() {
    let spot = |sigma: f64| SoftSpot { place: DVec3::new(0.0, 250.0, 28.0), sigma };
    let height = |spots: Vec<SoftSpot>| {
        let (surface, findings) = built(ContourMap { soft_spots: spots, ..slope() }, Vec::new(), SurfaceKind::Spline);
        assert_eq!(findings, []);
        at(&surface, 0.0, 250.0)
    };
    let [without, loose, near, exact] =
        [height(vec![]), height(vec![spot(10.0)]), height(vec![spot(0.3)]), height(vec![spot(0.01)])];
    assert!(without < 25.6 && loose < without + 0.3, "{without} {loose}");
    assert!(near > loose + 0.5 && exact > near + 0.3 && exact > 27.0, "{loose} {near} {exact}");
}

#[test]
fn a_spot_height_far_outside_its_contours_is_left_out_with_a_finding() {
    let spots = [(28.0, 1.0), (31.0, 1.0), (40.0, 1.0)]
        .map(|(z, sigma)| SoftSpot { place: DVec3::new(10.0 * z, 250.0, z), sigma });
    let map = || ContourMap {
        soft_spots: spots.map(|s| SoftSpot { place: s.place - DVec3::new(280.0, 0.0, 0.0), ..s }).into(),
        ..slope()
    };
    let (_, findings) = built(map(), Vec::new(), SurfaceKind::Spline);
    assert_eq!(findings.len(), 1, "{findings:?}");
    assert!(findings[0].kind == FindingKind::SpotOutsideBand && findings[0].message.contains("40 m ± 1 m"));
    let (_, findings) = built(map(), Vec::new(), SurfaceKind::Skeleton);
    assert!(findings.len() == 1 && findings[0].message.contains("only the smooth surface"), "{findings:?}");
}
