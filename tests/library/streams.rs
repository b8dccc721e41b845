//! Streams: they agree with the contours, and the ground falls along them.

use std::cell::Cell;

use crate::common;
use crate::guarantees::{Refusal, Tally, check, check_dem, clean_map, map_of};
use glam::{DVec2, DVec3};
use proptest::prelude::*;
use tokosen::base::Grid;
use tokosen::base::error::{Error, Finding, FindingKind};
use tokosen::break_lines::{Bend, BreakLine};
use tokosen::contour::Target;
use tokosen::contour::{Contour, ContourMap, SoftSpot};
use tokosen::layers::{LayerParams, contour_layers};
use tokosen::streams::{RiverArea, Stream, StreamLine, Streams};
use tokosen::surface::{Given, Surface, SurfaceKind, SurfaceParams, build, heights, largest_stream_change};

/// A valley that falls to the south, `z = (y + 0.75 |x|) / 10`, by its contours every 10 m. Their tips are at x = 0.
fn valley() -> ContourMap {
    let contour = |k: i32| {
        let point = |i: i32| DVec2::new(20.0 * f64::from(i), 100.0 * f64::from(k) - 15.0 * f64::from(i.abs()));
        Contour { elevation: 10.0 * f64::from(k), points: (-10..=10).map(point).collect(), feature: 0.into() }
    };
    ContourMap { contours: (0..=6).map(contour).collect(), ..ContourMap::default() }
}

fn built(map: ContourMap, lines: &[&[(f64, f64)]], tolerance: Option<f64>) -> (Surface, Vec<Finding>) {
    let line = |(k, points): (usize, &&[(f64, f64)])| StreamLine {
        points: points.iter().map(|&p| p.into()).collect(),
        feature: (k as u64).into(),
    };
    let streams = Streams { lines: lines.iter().enumerate().map(line).collect(), ..Streams::default() };
    let given = Given { streams, ..Given::default() };
    let params = SurfaceParams { stream_tolerance: tolerance, ..SurfaceParams::default() };
    let report = build(map, &given, &params, &()).expect("a valley has a surface");
    (report.value, report.findings)
}

/// Parameters that take random lines as streams, although the contours contradict most of them.
fn of_any_place() -> SurfaceParams {
    let mut params = SurfaceParams::default();
    params.tuning.streams.elsewhere = 1.0;
    params
}

fn count(findings: &[Finding], kind: FindingKind) -> usize {
    findings.iter().filter(|finding| finding.kind == kind).count()
}

/// Every used piece falls, and stays level only where it must.
fn assert_falls(surface: &Surface, what: &str) {
    for stream in &surface.streams {
        assert!(stream.points.len() > 1, "{what}");
        let rise = stream.points.windows(2).find(|w| w[1].z > w[0].z);
        assert!(rise.is_none(), "{what}: {rise:?}");
    }
}

/// The largest rise from cell to cell along a line, read at the nearest cell.
fn rise(surface: &Surface, points: &[DVec3], cell: f64) -> f32 {
    let grid = Grid::on_multiples(DVec2::new(-200.0, -150.0), DVec2::new(200.0, 600.0), cell);
    let dem = heights(surface, &grid, &());
    let read = |p: DVec2| {
        let place = grid.place(p).round();
        dem.values[place.y as usize * grid.cols + place.x as usize]
    };
    let along = points.windows(2).flat_map(|w| (0..8).map(|k| w[0].lerp(w[1], f64::from(k) / 8.0).truncate()));
    let values: Vec<f32> = along.map(read).filter(|z| !z.is_nan()).collect();
    assert!(values.len() > 50);
    values.windows(2).map(|w| w[1] - w[0]).fold(0.0, f32::max)
}

#[test]
fn a_stream_drawn_upstream_beside_the_tips_is_turned_and_moved_into_them() {
    let drawn: Vec<(f64, f64)> = (0..=29).map(|k| (6.0, 20.0 * f64::from(k) + 3.0)).collect();
    let (surface, findings) = built(valley(), &[&drawn], Some(25.0));
    assert_eq!([FindingKind::StreamTurned, FindingKind::StreamMoved].map(|kind| count(&findings, kind)), [1, 1]);
    assert_eq!(count(&findings, FindingKind::StreamCut), 0);
    assert_falls(&surface, "moved");
    assert_eq!(surface.streams.len(), 1);
    let stream = &surface.streams[0];
    assert!(stream.turned && (5.0..8.0).contains(&stream.shift), "{stream:?}");
    for k in 1..=5 {
        let tip = DVec3::new(0.0, 100.0 * f64::from(k), 10.0 * f64::from(k));
        assert!(stream.points.contains(&tip), "{k}: {:?}", stream.points);
    }
    // Between the tips it lies in the valley. Beyond the outermost contours it has the heights of the surface without it.
    let (without, _) = built(valley(), &[], None);
    for p in &stream.points {
        let (between, wanted) = match (100.0..=500.0).contains(&p.y) {
            true => ("between", p.y / 10.0),
            false => {
                let corner = p.truncate() + DVec2::new(-0.5, 0.5);
                let grid = Grid { corner, cell: DVec2::ONE, cols: 1, rows: 1 };
                ("beyond", f64::from(heights(&without, &grid, &()).values[0]))
            }
        };
        assert!((p.z - wanted).abs() < 1.0, "{between} the contours: {p}, not {wanted}");
    }
    assert_eq!(rise(&surface, &stream.points, 10.0), 0.0);
    assert_eq!(rise(&surface, &stream.points, 7.0), 0.0);
}

#[test]
fn beyond_the_tolerance_a_stream_stays_where_it_is() {
    let drawn: Vec<(f64, f64)> = (0..=29).map(|k| (6.0, 20.0 * f64::from(29 - k) + 3.0)).collect();
    let (surface, findings) = built(valley(), &[&drawn], Some(1.0));
    assert_eq!(count(&findings, FindingKind::StreamMoved) + count(&findings, FindingKind::StreamTurned), 0);
    assert!(surface.streams[0].points.iter().all(|p| (p.x - 6.0).abs() < 1e-9));
    assert_falls(&surface, "not moved");
}

#[test]
fn only_a_stream_on_a_slope_is_told_to_run_beside_its_valley() {
    let beside = |map: ContourMap, x: f64| {
        let drawn: Vec<(f64, f64)> = (0..=50).map(|k| (x, 560.0 - 10.0 * f64::from(k))).collect();
        count(&built(map, &[&drawn], Some(8.0)).1, FindingKind::StreamBeside)
    };
    // The valley, and the ridge of its mirror image.
    let mut ridge = valley();
    ridge.contours.iter_mut().flat_map(|c| &mut c.points).for_each(|p| p.y += 1.5 * p.x.abs());
    assert_eq!([0.0, 5.0, 40.0, -70.0].map(|x| beside(valley(), x)), [0, 0, 1, 1]);
    assert_eq!(beside(ridge, 2.0), 1);
    // Straight contours tell nothing.
    let mut plane = valley();
    plane.contours.iter_mut().for_each(|c| {
        let y = c.points[10].y;
        c.points.iter_mut().for_each(|p| p.y = y);
    });
    assert_eq!(beside(plane, 40.0), 0);
}

#[test]
fn a_stream_that_crosses_a_contour_three_times_is_moved_along_it_or_cut() {
    // Down across the contour of 30 m, up again, and down.
    let drawn = [(0.0, 570.0), (0.0, 310.0), (-60.0, 230.0), (-60.0, 270.0), (-40.0, 230.0), (0.0, 60.0)];
    let (surface, findings) = built(valley(), &[&drawn], Some(40.0));
    assert_eq!(count(&findings, FindingKind::StreamCut), 0, "{findings:?}");
    assert_falls(&surface, "moved along");
    let (surface, findings) = built(valley(), &[&drawn], Some(0.5));
    let cut: Vec<&Finding> = findings.iter().filter(|f| f.kind == FindingKind::StreamCut).collect();
    assert_eq!(cut.len(), 1, "{findings:?}");
    assert_eq!(cut[0].elevations, [30.0]);
    assert!(surface.streams.len() == 2, "{:?}", surface.streams.len());
    assert_falls(&surface, "cut");
}

#[test]
fn a_start_below_a_ridge_is_cut_and_told_like_an_end_above_one() {
    // Up the valley and back beside it, further down than it came from. Upwards the stream crosses 30 m and 40 m.
    let over = [(0.0, 230.0), (0.0, 430.0), (60.0, 430.0), (60.0, 60.0)];
    let cuts = |drawn: &[(f64, f64)]| {
        let (surface, findings) = built(valley(), &[drawn], Some(0.5));
        assert_falls(&surface, "cut");
        let cut: Vec<&Finding> = findings.iter().filter(|f| f.kind == FindingKind::StreamCut).collect();
        assert_eq!(cut.len(), 1, "{findings:?}");
        assert_eq!(cut[0].elevations, [40.0]);
        assert_eq!(cut[0].features, [0]);
        assert!(cut[0].message.contains("170.0 map units"), "{}", cut[0].message);
        // Beside the cut the surface rises on, by more than half of the interval.
        assert_eq!(count(&findings, FindingKind::StreamClimbs), 1, "{findings:?}");
        let used: f64 = surface.streams.iter().map(Stream::length).sum();
        assert!((used + 170.0 + 30.0 - 630.0).abs() < 1.0, "{used}");
    };
    cuts(&over);
    // Drawn the other way round, the same is left out.
    let back: Vec<(f64, f64)> = over.iter().rev().copied().collect();
    cuts(&back);
}

/// A slope that falls to the south, with a valley in each of the columns `x = 200 k`, by its contours every 10 m.
fn valleys() -> ContourMap {
    let contour = |k: i32| {
        let point = |i: i32| {
            let off = f64::from((i + 5).rem_euclid(10) - 5).abs();
            DVec2::new(20.0 * f64::from(i), 100.0 * f64::from(k) - 12.0 * off)
        };
        Contour { elevation: 10.0 * f64::from(k), points: (-5..=125).map(point).collect(), feature: 0.into() }
    };
    ContourMap { contours: (0..=8).map(contour).collect(), ..ContourMap::default() }
}

#[test]
fn streams_of_another_place_are_one_error() {
    // In each valley a stream; `off` is how far to the east they are.
    let streams = |off: f64, tolerance: Option<f64>| {
        let line = |k: u64| StreamLine {
            points: (0..=66).map(|i| DVec2::new(200.0 * k as f64 + off, 720.0 - 10.0 * f64::from(i))).collect(),
            feature: k.into(),
        };
        let streams = Streams { lines: (0..12).map(line).collect(), ..Streams::default() };
        let params = SurfaceParams { stream_tolerance: tolerance, ..SurfaceParams::default() };
        build(valleys(), &Given { streams, ..Given::default() }, &params, &())
    };
    let beside = streams(3.0, None).unwrap();
    assert_eq!((beside.value.streams.len(), count(&beside.findings, FindingKind::StreamBeside)), (12, 0));
    let error = streams(60.0, None).unwrap_err();
    assert!(matches!(error, Error::StreamsElsewhere(_)), "{error}");
    assert!(error.to_string().contains("100 % of the"), "{error}");
    // Who wants them all the same gets them.
    assert_eq!(streams(60.0, Some(0.0)).unwrap().value.streams.len(), 12);
}

#[test]
fn a_stream_that_parts_is_told_of_unless_its_branches_meet_again() {
    let stem = [(0.0, 570.0), (0.0, 330.0)];
    let [west, east] = [-3.0, 3.0].map(|x| [(0.0, 330.0), (x, 280.0), (0.0, 230.0)]);
    let below = [(0.0, 230.0), (0.0, 60.0)];
    let parting = |lines: &[&[(f64, f64)]]| count(&built(valley(), lines, Some(8.0)).1, FindingKind::StreamParts);
    assert_eq!(parting(&[&stem, &west, &east, &below]), 0, "an island");
    let away = [(0.0, 330.0), (60.0, 200.0), (90.0, 40.0)];
    assert_eq!(parting(&[&stem, &west, &below, &away]), 1);
    assert_eq!(parting(&[&stem, &west, &below]), 0);
}

#[test]
fn a_stream_over_a_ridge_between_contours_is_told_of_and_no_height_changes_for_it() {
    // Between the contours of 40 and 30 m, spot heights show a hollow and a rise behind it.
    let spots = vec![DVec3::new(0.0, 370.0, 31.5), DVec3::new(0.0, 330.0, 39.0)];
    let with_spots = |drawn: &[(f64, f64)]| built(ContourMap { spots: spots.clone(), ..valley() }, &[drawn], Some(0.5));
    let climbs = |findings: &[Finding]| count(findings, FindingKind::StreamClimbs);
    let (surface, findings) = with_spots(&[(0.0, 395.0), (0.0, 60.0)]);
    assert_eq!((climbs(&findings), surface.streams.len()), (1, 2));
    assert_falls(&surface, "on both sides of the ridge");
    let change = largest_stream_change(&surface);
    assert!(change <= 5.0, "{change} m");
    // One height for the hollow and the ridge would lower the ridge by more than 3 m.
    let grid = Grid { corner: DVec2::new(-1.0, 331.0), cell: DVec2::splat(2.0), cols: 1, rows: 1 };
    let top = heights(&surface, &grid, &()).values[0];
    assert!((top - 39.0).abs() < 2.0, "{top}");
    assert_eq!(climbs(&with_spots(&[(0.0, 290.0), (0.0, 60.0)]).1), 0);
}

#[test]
fn what_lies_outside_or_is_no_stream_is_told_with_its_length() {
    let down: Vec<(f64, f64)> = (0..=40).map(|k| (0.0, 700.0 - 20.0 * f64::from(k))).collect();
    let ring = [(30.0, 300.0), (50.0, 300.0), (50.0, 320.0), (30.0, 320.0), (30.0, 300.0)];
    let far = [(900.0, 0.0), (900.0, 50.0)];
    let copy: Vec<(f64, f64)> = down.iter().rev().copied().collect();
    let (surface, findings) = built(valley(), &[&down, &ring, &far, &copy], None);
    let told = |kind: FindingKind, feature: u64| {
        let found: Vec<&Finding> = findings.iter().filter(|f| f.kind == kind && f.features[0] == feature).collect();
        assert!(found.len() <= 1, "{found:?}");
        found.first().map(|f| f.message.clone())
    };
    assert_eq!(surface.streams.len(), 1);
    // The hull of the valley ends at 600 m in the north.
    let outside = told(FindingKind::StreamOutside, 0).unwrap();
    assert!(outside.contains("100.0 map units"), "{outside}");
    assert!(told(FindingKind::StreamLeftOut, 1).unwrap().contains("80.0 map units"));
    assert!(told(FindingKind::StreamOutside, 2).unwrap().contains("50.0 map units"));
    assert!(told(FindingKind::StreamLeftOut, 3).unwrap().contains("800.0 map units"));
}

#[test]
fn tributaries_meet_the_main_stream_at_its_height_and_orders_grow() {
    let main: Vec<(f64, f64)> = (0..=29).map(|k| (0.0, 580.0 - 20.0 * f64::from(k))).collect();
    let side = [(0.0, 240.0), (60.0, 300.0), (120.0, 380.0)];
    let (surface, findings) = built(valley(), &[&main, &side], None);
    assert_eq!(count(&findings, FindingKind::StreamTurned), 1, "{findings:?}");
    assert_falls(&surface, "tributary");
    let mut orders: Vec<u32> = surface.streams.iter().map(|s| s.order).collect();
    orders.sort_unstable();
    assert_eq!(orders, [1, 1, 2]);
    let ends: Vec<DVec3> = surface.streams.iter().filter(|s| s.order == 1).map(|s| *s.points.last().unwrap()).collect();
    assert_eq!(ends[0], ends[1]);
    let below = surface.streams.iter().find(|s| s.order == 2).unwrap();
    assert_eq!(below.points[0], ends[0]);
}

/// A river area in the valley or beside it, 40 wide.
fn river_area(x: f64, feature: u64) -> RiverArea {
    RiverArea { polygon: geo::Rect::new((x - 20.0, 130.0), (x + 20.0, 470.0)).to_polygon(), feature: feature.into() }
}

/// How much the ground at the banks of the river area in the valley lies above its middle, on the way between contours.
fn rise_across(surface: &Surface) -> f32 {
    let grid = Grid::on_multiples(DVec2::new(-200.0, -150.0), DVec2::new(200.0, 600.0), 10.0);
    let dem = heights(surface, &grid, &());
    let read = |x: f64, y: f64| {
        let place = grid.place(DVec2::new(x, y)).round();
        dem.values[place.y as usize * grid.cols + place.x as usize]
    };
    let at = |y: f64| read(-15.0, y).midpoint(read(15.0, y)) - read(5.0, y).midpoint(read(-5.0, y));
    [165.0, 255.0, 345.0, 455.0].map(at).into_iter().sum::<f32>() / 4.0
}

fn built_with_areas(lines: &[StreamLine], areas: Vec<RiverArea>) -> (Surface, Vec<Finding>) {
    let streams = Streams { lines: lines.to_vec(), areas };
    let given = Given { streams, ..Given::default() };
    let report = build(valley(), &given, &SurfaceParams::default(), &()).expect("a valley has a surface");
    (report.value, report.findings)
}

#[test]
fn a_river_area_is_level_across_and_falls_along() {
    let stream = StreamLine { points: vec![DVec2::new(0.0, 580.0), DVec2::new(0.0, 10.0)], feature: 0.into() };
    let outside = river_area(4000.0, 2);
    let (without, _) = built_with_areas(std::slice::from_ref(&stream), Vec::new());
    let (with, findings) = built_with_areas(&[stream], vec![river_area(0.0, 1), outside]);
    let told: Vec<&Finding> = findings.iter().filter(|f| f.kind == FindingKind::StreamLeftOut).collect();
    assert!(told.len() == 1 && told[0].features[0] == 2, "{findings:?}");
    // The heights of the banks come from the stream, and no survey gives them.
    assert!(!with.break_lines.is_empty() && with.break_lines.iter().all(|bank| bank.surveyed_share() == 0.0));
    let [without, with] = [without, with].map(|surface| rise_across(&surface));
    assert!(without > 0.5 && with < 0.3 * without, "{with} {without}");
}

#[test]
fn height_maps_are_level_across_rivers_that_no_contour_crosses() {
    // A valley with a wide floor. The river runs beside its left slope, where the ground falls across it.
    let contour = |k: i32| {
        let side = 20.0 * f64::from(k);
        let legs = [(-100.0 - side, -1500.0), (-100.0 - side, 300.0 + side), (300.0 + side, 300.0 + side)];
        let points = legs.into_iter().chain([(300.0 + side, -1500.0)]).map(DVec2::from).collect();
        Contour { elevation: 30.0 + 10.0 * f64::from(k), points, feature: 0.into() }
    };
    let map = ContourMap { contours: (0..=6).map(contour).collect(), ..ContourMap::default() };
    let stream = StreamLine { points: vec![DVec2::new(0.0, 400.0), DVec2::new(0.0, -1480.0)], feature: 0.into() };
    let river = geo::Rect::new((-85.0, -1300.0), (35.0, 0.0)).to_polygon();
    let surface = |areas: Vec<RiverArea>| {
        let streams = Streams { lines: vec![stream.clone()], areas };
        let report = build(map.clone(), &Given { streams, ..Given::default() }, &SurfaceParams::default(), &());
        report.expect("a valley has a surface").value
    };
    let grid = Grid::on_multiples(DVec2::new(-300.0, -1500.0), DVec2::new(500.0, 500.0), 10.0);
    // How much the ground rises across the river, and how much it falls along it.
    let of_river = |surface: &Surface| {
        let dem = heights(surface, &grid, &());
        let row = |row: usize| {
            let cells = (0..grid.cols).filter(|col| (-85.0..35.0).contains(&grid.center(*col, row).x));
            cells.map(|col| dem.values[row * grid.cols + col]).collect::<Vec<_>>()
        };
        let rows = (0..grid.rows).filter(|row| (-1290.0..-10.0).contains(&grid.center(0, *row).y));
        let rows: Vec<Vec<f32>> = rows.map(row).collect();
        let span = |values: &[f32]| {
            values.iter().copied().fold(f32::NEG_INFINITY, f32::max)
                - values.iter().copied().fold(f32::INFINITY, f32::min)
        };
        let (first, last) = (&rows[0], &rows[rows.len() - 1]);
        assert!(rows.len() == 128 && rows.iter().flatten().all(|z| z.is_finite()));
        (rows.iter().map(|row| span(row)).fold(0.0, f32::max), first[8] - last[8])
    };
    let (without, _) = of_river(&surface(Vec::new()));
    let (with, fall) = of_river(&surface(vec![RiverArea { polygon: river, feature: 1.into() }]));
    assert!(without > 1.0 && with < 0.05 && fall > 0.0, "{with} {without} {fall}");
}

#[test]
fn the_middle_line_of_a_river_area_takes_the_place_of_a_stream() {
    let line = |points: &[(f64, f64)], feature: u64| StreamLine {
        points: points.iter().map(|&p| p.into()).collect(),
        feature: feature.into(),
    };
    let lines = [
        line(&[(0.0, 580.0), (0.0, 470.0)], 0),
        line(&[(0.0, 130.0), (0.0, 10.0)], 1),
        line(&[(120.0, 380.0), (20.0, 300.0)], 2),
    ];
    let (without, _) = built_with_areas(&lines, Vec::new());
    let (with, findings) = built_with_areas(&lines, vec![river_area(0.0, 9)]);
    let told: Vec<&Finding> = findings.iter().filter(|f| f.kind == FindingKind::RiverMiddle).collect();
    assert!(told.len() == 1 && told[0].features[0] == 9, "{findings:?}");
    assert_eq!(count(&findings, FindingKind::StreamLeftOut), 0);
    assert_falls(&with, "through the river");
    // Water from both streams runs on through the area to the lower one.
    let lower = with.streams.iter().find(|s| s.feature == 1).unwrap();
    assert_eq!(lower.order, 2);
    let before = with.streams.iter().find(|s| s.points.last() == lower.points.first()).unwrap();
    assert_eq!(before.feature, 9);
    assert!(without.streams.iter().all(|s| s.order == 1));
    let [without, with] = [without, with].map(|surface| rise_across(&surface));
    assert!(without > 0.3 && with < 0.1, "{with} {without}");
}

/// The height of a stream where it is nearest to a place, metres, and how far that is.
fn own_height(streams: &[Stream], place: DVec2) -> (f64, f64) {
    let segments = streams.iter().flat_map(|stream| stream.points.windows(2));
    let nearest = segments.map(|w| {
        let (from, way) = (w[0].truncate(), w[1].truncate() - w[0].truncate());
        let share = ((place - from).dot(way) / way.length_squared()).clamp(0.0, 1.0);
        (w[0].z + share * (w[1].z - w[0].z), place.distance(from + share * way))
    });
    nearest.min_by(|a, b| a.1.total_cmp(&b.1)).unwrap_or((f64::NAN, f64::INFINITY))
}

#[test]
fn a_stream_on_a_slope_gets_its_height_and_no_trench() {
    // Beside the valley the ground falls to its middle, away from the stream.
    let drawn: Vec<(f64, f64)> = (0..=50).map(|k| (60.0, 560.0 - 10.0 * f64::from(k))).collect();
    let (with, findings) = built(valley(), &[&drawn], Some(0.1));
    let beside: Vec<&Finding> = findings.iter().filter(|f| f.kind == FindingKind::StreamBeside).collect();
    assert!(beside.len() == 1 && beside[0].message.contains("on slopes"), "{findings:?}");
    let (without, _) = built(valley(), &[], None);
    let grid = Grid::on_multiples(DVec2::new(-200.0, -150.0), DVec2::new(200.0, 600.0), 4.0);
    let [before, after] = [&without, &with].map(|surface| heights(surface, &grid, &()).values);
    // The surface bends a little beside the stream.
    let beside = (0..grid.len()).filter(|i| {
        let p = grid.center(i % grid.cols, i / grid.cols);
        (p.x - 60.0).abs() < 12.0 && (100.0..500.0).contains(&p.y)
    });
    let deepest = beside.map(|i| before[i] - after[i]).fold(0.0, f32::max);
    assert!(deepest < 0.6, "{deepest}");
}

#[test]
fn no_canal_in_a_flat_valley_floor() {
    // Contours every 20 m around a floor that is 400 m wide and 1.8 km long. No contour crosses it.
    let contour = |k: i32| {
        let side = 40.0 * f64::from(k);
        let legs = [(-200.0 - side, -1500.0), (-200.0 - side, 300.0 + side), (200.0 + side, 300.0 + side)];
        let points = legs.into_iter().chain([(200.0 + side, -1500.0)]).map(DVec2::from).collect();
        Contour { elevation: 40.0 + 20.0 * f64::from(k), points, feature: 0.into() }
    };
    let map = ContourMap { contours: (0..=5).map(contour).collect(), ..ContourMap::default() };
    let drawn: Vec<(f64, f64)> =
        (0..=95).map(|k| (60.0 * (f64::from(k) * 0.2).sin(), 420.0 - 20.0 * f64::from(k))).collect();
    let (surface, _) = built(map, &[&drawn], None);
    let grid = Grid::on_multiples(DVec2::new(-300.0, -1400.0), DVec2::new(300.0, 200.0), 10.0);
    let dem = heights(&surface, &grid, &());
    let (mut on_stream, mut beside) = (0, 0);
    for (n, z) in dem.values.iter().enumerate() {
        let place = grid.center(n % grid.cols, n / grid.cols);
        let (own, distance) = own_height(&surface.streams, place);
        // The cells of the stream, and the floor beside it.
        if distance < 35.0 {
            assert!((f64::from(*z) - own).abs() <= 1.0, "{place}: {z} instead of {own}");
        }
        on_stream += usize::from(distance < 5.0);
        beside += usize::from((5.0..35.0).contains(&distance));
    }
    assert!(on_stream > 100 && beside > 600, "{on_stream} {beside}");
}

#[test]
fn the_stream_of_a_valley_that_drains_makes_its_height_map_no_worse() {
    let drawn: Vec<(f64, f64)> = (0..=58).map(|k| (0.0, 590.0 - 10.0 * f64::from(k))).collect();
    let grid = Grid::on_multiples(DVec2::new(-150.0, 20.0), DVec2::new(150.0, 480.0), 5.0);
    let error = |lines: &[&[(f64, f64)]]| {
        let dem = heights(&built(valley(), lines, None).0, &grid, &());
        let squares = dem.values.iter().enumerate().map(|(n, z)| {
            let p = grid.center(n % grid.cols, n / grid.cols);
            (f64::from(*z) - (p.y + 0.75 * p.x.abs()) / 10.0).powi(2)
        });
        let squares: Vec<f64> = squares.filter(|square| square.is_finite()).collect();
        assert!(squares.len() > 4000, "{}", squares.len());
        (squares.iter().sum::<f64>() / squares.len() as f64).sqrt()
    };
    let (without, with) = (error(&[]), error(&[&drawn]));
    assert!(with <= without, "{with} {without}");
}

#[test]
fn beyond_the_cells_of_streams_heights_stay() {
    let mut changed = 0;
    for seed in 0..6 {
        let map = clean_map(map_of(&common::hills(seed, 60, 50).contours()));
        let streams = Streams { lines: random_streams(&map, seed), ..Streams::default() };
        let given = Given { streams, ..Given::default() };
        let surface = build(map, &given, &of_any_place(), &()).unwrap().value;
        let working = &surface.working.as_ref().unwrap().0[0];
        let dem = heights(&surface, &working.grid, &());
        for (n, (after, before)) in dem.values.iter().zip(&working.heights).enumerate() {
            let place = working.grid.center(n % working.grid.cols, n / working.grid.cols);
            let (_, distance) = own_height(&surface.streams, place);
            let is_beyond = distance > 0.75 * working.grid.cell.max_element();
            assert!(!is_beyond || before.is_nan() || after == before, "{place}: {after} {before}");
            changed += usize::from(after != before && !before.is_nan());
        }
    }
    assert!(changed > 20, "{changed} nodes");
}

#[test]
fn new_contours_cross_a_stream_once() {
    let main: Vec<(f64, f64)> =
        (0..=58).map(|k| (8.0 * (f64::from(k) * 0.4).sin(), 580.0 - 10.0 * f64::from(k))).collect();
    let (surface, _) = built(valley(), &[&main], None);
    assert_falls(&surface, "winding");
    let targets = vec![Target::Interval { step: 1.0, base: 0.0 }];
    let layers = contour_layers(&surface, &LayerParams { targets, ..LayerParams::default() }, &()).unwrap();
    let side = |a: DVec2, b: DVec2, p: DVec2| (b - a).perp_dot(p - a) > 0.0;
    let mut crossed = 0;
    for line in &layers[0].lines {
        let segments = || line.points.windows(2);
        let crosses = |w: &[DVec3]| {
            let (a, b) = (w[0].truncate(), w[1].truncate());
            segments()
                .filter(|s| side(a, b, s[0]) != side(a, b, s[1]) && side(s[0], s[1], a) != side(s[0], s[1], b))
                .count()
        };
        let times: usize = surface.streams.iter().flat_map(|s| s.points.windows(2)).map(crosses).sum();
        assert!(times <= 1, "{} m: {times}", line.elevation);
        crossed += times;
    }
    assert!(crossed > 40, "{crossed}");
}

/// Random terrain may have one contour or one level only; then there is no surface. Nothing else may go wrong.
const ALLOWED: [Refusal; 3] = [Refusal::NoContour, Refusal::OneContour, Refusal::OneLevel];

/// Lines anywhere on a map, some of them through vertices of contours.
fn random_streams(map: &ContourMap, seed: u64) -> Vec<StreamLine> {
    let vertices: Vec<DVec2> = map.contours.iter().flat_map(|c| c.points.iter().copied()).collect();
    let mut state = seed;
    let mut draw = move |most: usize| {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 33) as usize % most
    };
    let mut line = |k: u64| {
        let mut place = || {
            let (p, q) = (vertices[draw(vertices.len())], vertices[draw(vertices.len())]);
            if draw(4) == 0 { p } else { p.lerp(q, 0.1 * draw(11) as f64) }
        };
        let (a, b, c) = (place(), place(), place());
        let points = (0..=12).map(|k| {
            let t = f64::from(k) / 12.0;
            a.lerp(b, t).lerp(b.lerp(c, t), t)
        });
        StreamLine { points: points.collect(), feature: k.into() }
    };
    (0..8).map(&mut line).collect()
}

/// Break lines anywhere on a map: with heights that fit the ground or do not, and without.
fn random_break_lines(map: &ContourMap, seed: u64) -> Vec<BreakLine> {
    let levels = |k: usize| map.contours[k % map.contours.len()].elevation;
    let line = |(k, line): (usize, StreamLine)| {
        let heights = match k {
            0 => Vec::new(),
            _ => (0..line.points.len()).map(|i| levels(k) + (i * k) as f64).collect(),
        };
        let bend = [Bend::Either, Bend::Ridge, Bend::Valley][k % 3];
        BreakLine { points: line.points, heights, bend, feature: (100 + k as u64).into() }
    };
    random_streams(map, seed ^ 0x5eed).into_iter().take(4).enumerate().map(line).collect()
}

#[test]
fn the_guarantees_hold_with_any_streams_break_lines_and_spot_heights() {
    let tally = Tally::default();
    let cases = if std::env::var_os("PROPTEST_CASES").is_some() {
        common::draws()
    } else {
        ProptestConfig { cases: 2, ..common::draws() }
    };
    let (used, creased) = (Cell::new(0), Cell::new(0));
    proptest!(cases, |(seed in any::<u64>())| {
        for terrain in common::all_kinds(seed) {
            let map = clean_map(map_of(&terrain.contours()));
            if map.contours.is_empty() {
                continue;
            }
            for kind in [SurfaceKind::Skeleton, SurfaceKind::Spline] {
                let what = format!("{} {kind:?} {seed}", terrain.kind);
                let streams = Streams { lines: random_streams(&map, seed), ..Streams::default() };
                let break_lines = random_break_lines(&map, seed);
                let params = SurfaceParams { kind, ..of_any_place() };
                let given = Given { streams, break_lines, ..Given::default() };
                let spots = map.contours.iter().filter_map(|c| Some((c.points.first()?, c.elevation)));
                let soft = |(p, z): (&DVec2, f64)| SoftSpot { place: p.extend(z + 3.0), sigma: 2.0 };
                let map = ContourMap { soft_spots: spots.map(soft).collect(), ..map.clone() };
                let Some(report) = tally.take(build(map, &given, &params, &()), &ALLOWED, &what) else { continue };
                let surface = report.value;
                tally.add_lines(check(&surface.map, &surface, terrain.interval / 5.0, &what));
                check_dem(&surface, terrain.cell, &what);
                assert_falls(&surface, &what);
                used.set(used.get() + surface.streams.len());
                creased.set(creased.get() + surface.break_lines.len());
                // No input line is lost without a word.
                let mut told: Vec<u64> = surface.streams.iter().map(|s| s.feature.number()).collect();
                told.extend(surface.break_lines.iter().map(|c| c.feature.number()));
                told.extend(report.findings.iter().flat_map(|f| &f.features).map(|f| f.number()));
                assert!((0..8).chain(100..104).all(|k| told.contains(&k)), "{what}: {told:?}");
            }
        }
    });
    tally.assert_share(0.95, 50.0);
    assert!(used.get() > 100, "{} pieces of streams", used.get());
    assert!(creased.get() > 50, "{} pieces of break lines", creased.get());
}

#[test]
fn threads_do_not_change_streams() {
    let terrain = common::hills(5, 60, 50);
    let map = clean_map(map_of(&terrain.contours()));
    let streams = Streams { lines: random_streams(&map, 5), ..Streams::default() };
    let break_lines = random_break_lines(&map, 5);
    let given = Given { streams, break_lines, ..Given::default() };
    let in_threads = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| build(map.clone(), &given, &of_any_place(), &()).unwrap().value)
    };
    let (one, two) = (in_threads(1), in_threads(2));
    assert!(!one.streams.is_empty());
    assert_eq!(one.streams, two.streams);
    assert_eq!(one.break_lines, two.break_lines);
    let bits = |surface: &Surface| {
        let values = surface.working.as_ref().unwrap().0[0].heights.iter().map(|z| z.to_bits());
        values.collect::<Vec<u32>>()
    };
    assert_eq!(bits(&one), bits(&two));
}
