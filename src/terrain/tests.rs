//! Tests of the facade as a whole.

use std::path::{Path, PathBuf};

use geo::{MultiPolygon, Rect};
use glam::{DVec2, DVec3};

use super::*;
use tokosen_core::base::Grid;
use tokosen_core::base::error::CrsNeed;
use tokosen_core::base::error::Error;
use tokosen_core::contour::{Contour, ContourMap, Interval, Lake};
use tokosen_core::crs::Crs;
use tokosen_core::features::Features;
use tokosen_core::mesh::MeshParams;
use tokosen_core::raster::Dem;
use tokosen_core::spline::Wanted;
use tokosen_core::subdomains::Frame;
use tokosen_core::surface::{SurfaceKind, Triangles, Uncertainty};
use tokosen_io::{ReadOptions, read_contours};

fn sample() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("samples/fig5cd_three_branches_basin.geojson")
}

fn ring(radius: f64, elevation: f64) -> Contour {
    let angle = |k: i32| f64::from(k % 60) * std::f64::consts::TAU / 60.0;
    Contour { elevation, points: (0..=60).map(|k| radius * DVec2::from_angle(angle(k))).collect(), feature: 0.into() }
}

fn hill() -> ContourMap {
    ContourMap { contours: vec![ring(200.0, 10.0), ring(80.0, 20.0)], ..ContourMap::default() }
}

fn input(map: ContourMap) -> Input {
    // Metres about a point, which could be degrees.
    Input::from_map(map, &InputOptions { crs: Some(Crs::from_epsg(6678)), ..InputOptions::default() })
        .expect("a projected system in metres")
}

/// The quick surface.
fn options() -> Options {
    Options { kind: SurfaceKind::Skeleton, ..Options::default() }
}

#[test]
fn lines_in_memory_give_the_contours_of_their_file() {
    let of_file = Terrain::build(Input::read(sample()).unwrap(), &options()).unwrap();
    let map = read_contours(&sample(), &ReadOptions::default()).unwrap().value;
    let mut arrays = RaggedLines { offsets: vec![0], ..RaggedLines::default() };
    for line in &map.contours {
        arrays.coords.extend(line.points.iter().map(|p| p.to_array()));
        arrays.offsets.push(arrays.coords.len());
        arrays.elevations.push(line.elevation);
    }
    arrays.validate().unwrap();
    let RaggedLines { coords, offsets, elevations } = &arrays;
    let params = InputOptions { crs: map.crs.clone(), ..InputOptions::default() };
    let of_arrays = Input::from_arrays(coords, offsets, elevations, &params).unwrap();
    let of_arrays = Terrain::build(of_arrays, &options()).unwrap();
    let layers = of_file.contours(&[Interval::every(2.0)]).unwrap();
    assert_eq!(layers, of_arrays.contours(&[Interval::every(2.0)]).unwrap());
    assert!(layers[0].lines.len() > map.contours.len());
    // Out in the coordinates of the input, which are those of the plane here.
    let out = layers[0].to_arrays_in(&of_file.to_output(None).unwrap()).unwrap();
    out.validate().unwrap();
    assert_eq!(out, layers[0].to_arrays());
    assert!(map.contours.iter().all(|line| (0..out.len()).any(|k| out.line(k).len() == line.points.len())));
}

#[test]
fn coordinates_in_degrees_come_back_bit_for_bit() {
    let degrees = |line: &Contour| {
        let points = line.points.iter().map(|p| DVec2::new(138.7, 35.3) + *p * 1e-5).collect();
        Contour { points, ..line.clone() }
    };
    let map = ContourMap { contours: hill().contours.iter().map(degrees).collect(), ..ContourMap::default() };
    assert!(matches!(Input::from_map(map.clone(), &InputOptions::default()), Err(Error::LooksLikeDegrees)));
    let params = InputOptions { crs: Some(Crs::from_epsg(6668)), ..InputOptions::default() };
    let terrain = Terrain::build(Input::from_map(map.clone(), &params).unwrap(), &options()).unwrap();
    let out = terrain.input_contours().unwrap().to_arrays_in(&terrain.to_output(None).unwrap()).unwrap();
    for line in &map.contours {
        let places = |k: usize| out.line(k).to_vec();
        let k = out.elevations.iter().position(|z| *z == line.elevation).unwrap();
        assert!(line.points.iter().all(|p| places(k).contains(&p.to_array())));
    }
    let dem = terrain.dem(&GridSpec::Degrees(1e-4)).unwrap();
    assert!(dem.crs.is_some_and(|crs| crs.is_geographic()) && dem.values.iter().any(|z| *z > 19.0));
}

#[test]
fn cells_in_degrees_get_nodes_as_close_as_they_are() {
    let plane = input(hill());
    let cells = GridSpec::Degrees(1e-4).over(&plane.reprojection).unwrap();
    let Some(Wanted::Cell(side)) = cells.wanted(DVec2::ZERO) else { panic!("square cells on the plane") };
    // The origin of the zone lies at 40 degrees north. There, these cells are 8.54 x 11.10 m large.
    assert!((side - (8.54 * 11.10f64).sqrt()).abs() < 0.01, "{side}");
}

#[test]
fn parameters_out_of_range_are_told_apart() {
    let fails = |options: &Options| Terrain::build(input(hill()), options).unwrap_err();
    let wrong = |preparation: Preparation| fails(&Options { preparation, ..options() });
    let is = |error: &Error, wanted: &str| matches!(error, Error::OutOfRange { name, .. } if *name == wanted);
    assert!(is(&wrong(Preparation { snap: -1.0, ..Preparation::default() }), "snap distance"));
    assert!(is(&wrong(Preparation { fit: Some(0.0), ..Preparation::default() }), "fitting tolerance"));
    assert!(is(&wrong(Preparation { sample: Some(1.0), ..Preparation::default() }), "sampling ratio"));
    assert!(is(&fails(&Options { resolution: f64::NAN, ..options() }), "resolution parameter w"));
    assert!(is(&fails(&Options { tension: Some(-1.0), ..Options::default() }), "tension"));
    let error = fails(&Options { grid: Some(GridSpec::Cell(0.0)), ..options() });
    assert!(is(&error, "cell size") && error.is_about_parameters(), "{error}");
    let error = fails(&Options { grid: Some(GridSpec::Cell(1e-9)), ..options() });
    assert!(matches!(&error, Error::TooManyCells { in_degrees: false, .. }), "{error}");
    let terrain = Terrain::build(input(hill()), &options()).unwrap();
    assert!(is(&terrain.contours(&[Interval::every(0.0)]).unwrap_err(), "interval"));
}

#[test]
fn systems_that_do_not_serve_are_told_apart() {
    let take = |crs: Option<u32>, work: u32| {
        let [crs, work_crs] = [crs, Some(work)].map(|code| code.map(Crs::from_epsg));
        let far = |line: Contour| Contour { points: line.points.iter().map(|p| *p + 5e3).collect(), ..line };
        let map = ContourMap { contours: hill().contours.into_iter().map(far).collect(), ..ContourMap::default() };
        Input::from_map(map, &InputOptions { crs, work_crs, ..InputOptions::default() }).unwrap_err()
    };
    assert!(matches!(take(Some(6678), 6668), Error::NotProjectedInMetres { .. }));
    assert!(matches!(take(None, 6678), Error::UnknownCrs { needed_for: CrsNeed::WorkingCrs }));
    assert!(matches!(take(Some(6668), 6678), Error::NoPlace { .. }));
}

#[test]
fn maps_of_which_no_surface_can_be_made_are_told_apart() {
    let fails = |contours: Vec<Contour>, preparation: Preparation| {
        let mut input = input(ContourMap { contours, ..ContourMap::default() });
        let error = Terrain::build_with(&mut input, &Options { preparation, ..options() }, &()).unwrap_err();
        (error, input.findings.len())
    };
    let (error, _) = fails(Vec::new(), Preparation::default());
    assert!(matches!(error, Error::NoContours { in_polygon: false }), "{error}");
    let (error, _) = fails(vec![ring(100.0, 10.0)], Preparation::default());
    assert!(matches!(error, Error::TooFewLevels { lines: 1, elevation: 10.0, .. }), "{error}");
    // A contour twice: what was found stays with the input.
    let twice = || vec![ring(200.0, 10.0), ring(200.0, 10.0), ring(80.0, 20.0)];
    let (error, findings) = fails(twice(), Preparation { repair: Repair::None, ..Preparation::default() });
    assert!(matches!(error, Error::NeedsRepair { places: 1, .. }) && findings == 1, "{error}");
    let (error, findings) = fails(twice(), Preparation { strict: true, ..Preparation::default() });
    assert!(matches!(error, Error::Strict { findings: 1, .. }) && findings == 1, "{error}");
    // Errors about a file name it, and are the same below.
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("one.geojson");
    std::fs::write(
        &path,
        r#"{"type":"LineString","coordinates":[[5000,0,1],[5001,0,1]],"crs":{"type":"name","properties":{"name":"EPSG:6678"}}}"#,
    )
    .unwrap();
    let error = Terrain::build(Input::read(&path).unwrap(), &options()).unwrap_err();
    assert!(matches!(error.root(), Error::TooFewLevels { .. }) && error.to_string().contains("one.geojson"), "{error}");
}

#[test]
fn what_needs_more_memory_than_the_budget_is_refused() {
    let limited = |kind, grid| Options { kind, grid, memory: Some(1000), ..Options::default() };
    let refused = |options: &Options| match Terrain::build(input(hill()), options).unwrap_err() {
        Error::OutOfMemory { what, available: 1000, .. } => what,
        error => panic!("{error}"),
    };
    assert!(refused(&limited(SurfaceKind::Spline, None)).starts_with("the smooth surface"));
    assert!(refused(&limited(SurfaceKind::Linear, Some(GridSpec::Cell(1.0)))).starts_with("a height map"));
    let terrain = Terrain::build(input(hill()), &limited(SurfaceKind::Linear, None)).unwrap();
    assert!(matches!(terrain.contours(&[Interval::every(0.1)]), Err(Error::OutOfMemory { .. })));
    let params = InputOptions { memory: Some(1000), ..InputOptions::default() };
    assert!(matches!(Input::read_with(&sample(), &params, &()), Err(Error::OutOfMemory { .. })));
}

#[test]
fn further_inputs_come_from_memory() {
    let mut input = input(hill());
    let to_degrees = tokosen_core::crs::Transform::between(&Crs::from_epsg(6678), &Crs::from_epsg(6668)).unwrap();
    let spot = to_degrees.forward(DVec2::new(1.0, 2.0)).unwrap().extend(25.0);
    input.add_spots([spot], Some(&Crs::from_epsg(6668))).unwrap();
    assert!(input.map.spots[0].distance(DVec3::new(1.0, 2.0, 25.0)) < 1e-4, "{}", input.map.spots[0]);
    let square = Rect::new((120.0, -10.0), (140.0, 10.0)).to_polygon();
    let lakes = vec![Lake { polygon: square, height: Some(14.0), feature: 1.into() }];
    input.add(Features { lakes, ..Features::default() }, None).unwrap();
    let sheet = Rect::new((-150.0, -150.0), (150.0, 150.0)).to_polygon();
    input.set_boundary(&MultiPolygon::new(vec![sheet]), None).unwrap();
    assert!(matches!(input.frame, Frame::Polygon(_)));
    let terrain = Terrain::build(input, &options()).unwrap();
    assert!(terrain.surface.regions.regions.iter().any(|region| region.water == Some(14.0)));
    let (grid, _) = terrain.cells(&GridSpec::Cell(10.0)).unwrap();
    assert_eq!((grid.cols, grid.rows), (30, 30));
    let dem = terrain.dem(&GridSpec::Cells { grid, crs: None, file: None }).unwrap();
    assert_eq!(dem, terrain.dem(&GridSpec::Cell(10.0)).unwrap());
    let far = Grid { corner: grid.corner + 1e4, ..grid };
    let error = terrain.dem(&GridSpec::Cells { grid: far, crs: None, file: None }).unwrap_err();
    assert!(matches!(error, Error::NoOverlap), "{error}");
    assert!(terrain.errors(&GridSpec::Cell(10.0)).unwrap().is_none());
    let mesh = terrain.mesh(&MeshParams { base: Some(0.0), ..MeshParams::default() }).unwrap();
    let first = mesh.vertices[0] + mesh.origin;
    let arrays = mesh.clone().into_arrays();
    assert_eq!((arrays.vertices[0], arrays.vertices.len()), (first.to_array(), mesh.vertices.len()));
    assert_eq!(arrays.triangles, mesh.triangles);
}

#[test]
fn errors_are_a_raster_like_the_heights() {
    let grid = GridSpec::Cell(20.0);
    let options = Options {
        grid: Some(grid.clone()),
        triangles: Triangles::Reference,
        uncertainty: Uncertainty::Learnt,
        ..Options::default()
    };
    let terrain = Terrain::build(input(hill()), &options).unwrap();
    let (dem, errors) = (terrain.dem(&grid).unwrap(), terrain.errors(&grid).unwrap().unwrap());
    assert_eq!(dem.grid, errors.grid);
    assert!(dem.values.iter().zip(&errors.values).all(|(z, e)| z.is_nan() == e.is_nan() && (e.is_nan() || *e >= 0.0)));
}

#[test]
fn a_base_gives_the_heights_outside_and_no_standard_errors() {
    let options = Options { uncertainty: Uncertainty::Learnt, ..Options::default() };
    let grid = GridSpec::Cell(10.0);
    let plain = Terrain::build(input(hill()), &options).unwrap().height_map(&grid, &()).unwrap().value;

    let cells = Grid { corner: DVec2::new(-600.0, 500.0), cell: DVec2::splat(25.0), cols: 48, rows: 40 };
    let flat = Dem { grid: cells, values: vec![7.0; cells.len()], crs: None };
    let mut with_base = input(hill());
    with_base.set_base(flat.clone(), Path::new("flat.tif")).unwrap();
    let terrain = Terrain::build(with_base, &options).unwrap();
    let found = terrain.height_map(&grid, &()).unwrap().value;
    assert_eq!(terrain.cells(&grid).unwrap().0, found.dem.grid);
    let place = |k: usize, grid: &Grid| grid.center(k % grid.cols, k / grid.cols);
    let (errors, join) = (found.errors.unwrap(), found.base.unwrap().join);
    assert!(found.dem.grid.cols > 110 && found.dem.grid.rows > 90, "{:?}", found.dem.grid);
    let (mut inside, mut outside) = (0, 0);
    for (k, height) in found.dem.values.iter().enumerate() {
        let p = plain.dem.grid.place(place(k, &found.dem.grid)).round();
        let is_there = p.min_element() >= 0.0 && p.x < plain.dem.grid.cols as f64 && p.y < plain.dem.grid.rows as f64;
        let own = if is_there { plain.dem.values[p.y as usize * plain.dem.grid.cols + p.x as usize] } else { f32::NAN };
        if own.is_nan() {
            assert!(errors[k].is_nan() && (height.is_nan() || (6.9..11.5).contains(height)), "{height}");
            outside += usize::from(!height.is_nan());
        } else {
            assert_eq!(*height, own);
            assert!(errors[k].is_finite());
            inside += 1;
        }
    }
    assert!(inside > 1000 && outside == join.filled && outside > 8000, "{inside} {outside}");
    assert!((2.5..4.5).contains(&join.median), "{join:?}");

    // Elsewhere it is an error, as is a fade that is no distance.
    let mut apart = input(hill());
    let moved = Grid { corner: DVec2::splat(9000.0), ..cells };
    apart.set_base(Dem { grid: moved, ..flat.clone() }, Path::new("flat.tif")).unwrap();
    assert!(matches!(Terrain::build(apart, &options).unwrap_err().root(), Error::NoOverlap));
    let wrong = Options { base_fade: Some(f64::INFINITY), ..Options::default() };
    assert!(matches!(Terrain::build(input(hill()), &wrong), Err(Error::OutOfRange { .. })));
}

#[test]
fn an_extent_smaller_than_coordinates_are_exact_is_refused() {
    let mut input = input(hill());
    // A part without width has no window that could grow from it.
    let found = input.set_extent([1.0, 1.0, 1.0 + 1e-9, 1.0 + 1e-9], None).unwrap_err().to_string();
    assert!(found.contains("has no area"), "{found}");
    input.set_extent([1.0, 1.0, 1.001, 1.001], None).unwrap();
}

#[test]
fn a_frame_of_very_many_vertices_keeps_those_that_show_it() {
    let mut input = input(hill());
    let count = 200_000;
    let at = |k: u32| 150.0 * DVec2::from_angle(f64::from(k % count) / f64::from(count) * std::f64::consts::TAU);
    let circle: geo::LineString<f64> = (0..=count).map(|k| (at(k).x, at(k).y)).collect();
    input.set_boundary(&geo::Polygon::new(circle, Vec::new()).into(), None).unwrap();
    let Frame::Polygon(area) = &input.frame else { panic!("a polygon") };
    let kept = area.0[0].exterior().0.len();
    assert!((10_000..100_000).contains(&kept), "{kept}");
}
