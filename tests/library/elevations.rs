//! How elevations are read: placeholders, units beside them, depths, polygons, texts, rounding, names of national maps.
//! Each case is drawn here, and compared with what its map means.
#![allow(clippy::unwrap_used, reason = "helpers of tests are tests too")]

use std::path::{Path, PathBuf};

use glam::DVec2;
use serde_json::{Value, json};
use tempfile::TempDir;
use tokosen::base::error::{Finding, FindingKind};
use tokosen::base::{ElevationUnit, FeatureId};
use tokosen::crs::Crs;
use tokosen::features::Role;
use tokosen::io::layer::{Cell, Column, Geometry, Kind, Layer, Row, Shape};
use tokosen::io::{ReadOptions, StagedOutput, read_contours, write_layers};
use tokosen::terrain::{Preparation, Repair};
use tokosen::{GridSpec, Input, InputOptions, Options, Terrain};

/// Coordinates of the maps' centre, and their system.
const CENTRE: [f64; 2] = [500_000.0, 5_000_000.0];
const SYSTEM: u32 = 32633;

/// A closed line of 36 vertices.
fn ring(radius: f64) -> Vec<[f64; 2]> {
    let at = |k: i32| f64::from(k % 36) * std::f64::consts::TAU / 36.0;
    (0..=36).map(|k| [CENTRE[0] + radius * at(k).cos(), CENTRE[1] + radius * at(k).sin()]).collect()
}

fn feature(kind: &str, coordinates: impl Into<Value>, properties: Value) -> Value {
    json!({"type": "Feature", "properties": properties, "geometry": {"type": kind, "coordinates": coordinates.into()}})
}

fn line(points: &[[f64; 2]], properties: Value) -> Value {
    feature("LineString", json!(points), properties)
}

/// Rings inside each other, one for each set of attributes.
fn rings(properties: impl IntoIterator<Item = Value>) -> Vec<Value> {
    let radius = |k: usize| 400.0 - 50.0 * k as f64;
    properties.into_iter().enumerate().map(|(k, properties)| line(&ring(radius(k)), properties)).collect()
}

/// Wavy contours from west to east in a square of a kilometre, and a square around them.
fn slope(levels: impl IntoIterator<Item = f64>) -> Vec<Value> {
    let course = |k: usize| -> Vec<[f64; 2]> {
        let y = |x: f64| 50.0 + 100.0 * k as f64 + 15.0 * (x / 110.0).sin();
        (0..=20).map(|i| 50.0 * f64::from(i)).map(|x| [CENTRE[0] + x, CENTRE[1] + y(x)]).collect()
    };
    levels.into_iter().enumerate().map(|(k, z)| line(&course(k), json!({"elev": z}))).collect()
}

fn square(away: f64, elevation: f64) -> Value {
    let (low, high) = (-away, 1000.0 + away);
    let corners = [[low, low], [high, low], [high, high], [low, high], [low, low]];
    line(&corners.map(|[x, y]| [CENTRE[0] + x, CENTRE[1] + y]), json!({"elev": elevation}))
}

fn write(folder: &TempDir, name: &str, features: &[Value]) -> PathBuf {
    let path = folder.path().join(name);
    let crs = json!({"type": "name", "properties": {"name": format!("urn:ogc:def:crs:EPSG::{SYSTEM}")}});
    let map = json!({"type": "FeatureCollection", "crs": crs, "features": features});
    std::fs::write(&path, map.to_string()).unwrap();
    path
}

fn read(features: &[Value], options: &InputOptions) -> tokosen::Result<Input> {
    let folder = tempfile::tempdir().unwrap();
    Input::read_with(&write(&folder, "map.geojson", features), options, &())
}

fn levels(input: &Input) -> Vec<f64> {
    input.map.contours.iter().map(|line| line.elevation).collect()
}

fn kinds(findings: &[Finding]) -> Vec<FindingKind> {
    findings.iter().map(|finding| finding.kind).collect()
}

/// The levels of a file as read, and the kinds of its findings.
fn found(features: &[Value]) -> (Vec<f64>, Vec<FindingKind>) {
    let input = read(features, &InputOptions::default()).unwrap();
    (levels(&input), kinds(&input.findings))
}

fn prepared(features: &[Value], repair: Repair) -> Input {
    let mut input = read(features, &InputOptions::default()).unwrap();
    input.prepare(&Preparation { repair, ..Preparation::default() }, &()).unwrap();
    input
}

const REPAIRS: [Repair; 3] = [Repair::None, Repair::Safe, Repair::All];

#[test]
fn a_frame_without_an_elevation_changes_nothing() {
    let steps = || (0..10).map(|k| 300.0 + 20.0 * f64::from(k));
    let sound = slope(steps());
    for (z, away) in [(0.0, 50.0), (-9999.0, 20.0), (1e38, 20.0), (-32_768.0, 5.0), (f64::from(f32::MIN), 20.0)] {
        let framed = [sound.clone(), vec![square(away, z)]].concat();
        for repair in REPAIRS {
            let (clean, input) = (prepared(&sound, repair), prepared(&framed, repair));
            assert_eq!(input.map.contours, clean.map.contours, "{z} {repair:?}");
            assert_eq!(kinds(&input.findings), [FindingKind::ZeroElevation], "{z} {repair:?}");
            assert_eq!(input.findings[0].features, [FeatureId::from(10)]);
            assert!(input.findings[0].message.contains("was left out"), "{}", input.findings[0]);
        }
    }
    let heights = |features: &[Value]| {
        let grid = GridSpec::Cell(50.0);
        let options = Options { grid: Some(grid.clone()), ..Options::default() };
        let terrain = Terrain::build(read(features, &InputOptions::default()).unwrap(), &options).unwrap();
        terrain.dem(&grid).unwrap().values
    };
    let framed = [sound.clone(), vec![square(50.0, 0.0)]].concat();
    let bits = |values: Vec<f32>| values.into_iter().map(f32::to_bits).collect::<Vec<u32>>();
    assert_eq!(bits(heights(&framed)), bits(heights(&sound)));
}

#[test]
fn a_frame_at_zero_around_low_ground_is_no_coast() {
    let sound = slope((0..10).map(|k| 10.0 + 10.0 * f64::from(k)));
    let framed = [sound.clone(), vec![square(30.0, 0.0)]].concat();
    let input = prepared(&framed, Repair::All);
    assert_eq!(input.map.contours, prepared(&sound, Repair::All).map.contours);
    assert_eq!(kinds(&input.findings), [FindingKind::ZeroElevation]);
}

#[test]
fn a_coast_at_zero_stays() {
    let coast = rings((0..5).map(|k| json!({"elev": 10 * k})));
    let input = prepared(&coast, Repair::All);
    assert_eq!((levels(&input).len(), kinds(&input.findings)), (5, vec![]));
    // Below a cliff whose contours are left out, the coast must be named.
    let cliff = rings([0, 100, 110, 120, 130].map(|z| json!({"elev": z})));
    assert_eq!(levels(&prepared(&cliff, Repair::Safe)).len(), 4);
    let mut input = read(&cliff, &InputOptions::default()).unwrap();
    input.set_coast_level(0.0).unwrap();
    input.prepare(&Preparation::default(), &()).unwrap();
    assert_eq!((levels(&input).len(), kinds(&input.findings)), (5, vec![]));
    let mut input = read(&cliff, &InputOptions::default()).unwrap();
    input.expect_level(0.0);
    input.prepare(&Preparation::default(), &()).unwrap();
    assert_eq!(levels(&input).len(), 5);
}

#[test]
fn spot_heights_without_an_elevation_are_left_out() {
    let point = |x: f64, z: f64| feature("Point", json!([CENTRE[0] + x, CENTRE[1] + 500.0]), json!({"elev": z}));
    let sound = [slope((0..10).map(|k| 300.0 + 20.0 * f64::from(k))), vec![point(100.0, 391.0)]].concat();
    let odd = [sound.clone(), vec![point(300.0, 0.0), point(5000.0, -9999.0), point(500.0, 99_999.0)]].concat();
    for repair in REPAIRS {
        let (clean, input) = (prepared(&sound, repair), prepared(&odd, repair));
        assert_eq!(input.map.spots, clean.map.spots);
        assert_eq!(kinds(&input.findings), [FindingKind::ZeroElevation; 3]);
    }
}

/// Contours of 8000 to 8160 with further attributes.
fn high(properties: &[(&str, Value)]) -> Vec<Value> {
    rings((0..5).map(|k| {
        let mut all = json!({"contourelevation": 8000 + 40 * k});
        properties.iter().for_each(|(name, value)| all[*name] = value.clone());
        all
    }))
}

#[test]
fn a_unit_beside_the_elevation_is_used() {
    let feet: Vec<f64> = (0..5).map(|k| ElevationUnit::Foot.metres(8000.0 + 40.0 * f64::from(k))).collect();
    assert_eq!(feet[0], 2438.4);
    for (name, value) in [
        ("contourunits", json!(1)),
        ("CONTOURUNI", json!("1")),
        ("ContourUnits", json!("Feet")),
        ("UNITS", json!("ft")),
        ("UOM", json!("urn:ogc:def:uom:EPSG::9002")),
        ("contourelevation_uom", json!("foot")),
        ("elev_unit", json!(9002)),
    ] {
        assert_eq!(found(&high(&[(name, value)])), (feet.clone(), vec![FindingKind::HeightUnit]), "{name}");
    }
    let metres: Vec<f64> = (0..5).map(|k| 8000.0 + 40.0 * f64::from(k)).collect();
    for value in [json!(2), json!("Meters"), json!(null)] {
        assert_eq!(found(&high(&[("contourunits", value)])), (metres.clone(), vec![]));
    }
    // What is not known is told.
    for (name, value) in [("contourunits", json!(7)), ("uom", json!("chains"))] {
        assert_eq!(found(&high(&[(name, value)])), (metres.clone(), vec![FindingKind::UnitDoubt]));
    }
    // The caller's unit comes first.
    let options = InputOptions { unit: Some(ElevationUnit::Metre), ..InputOptions::default() };
    let input = read(&high(&[("contourunits", json!(1))]), &options).unwrap();
    assert_eq!((levels(&input), kinds(&input.findings)), (metres, vec![FindingKind::UnitDoubt]));
}

#[test]
fn units_that_differ_from_line_to_line_are_converted() {
    let rows =
        [(328.083_989_501_312_3, json!("ft")), (110.0, json!("m")), (12_000.0, json!("cm")), (130_000.0, json!("mm"))];
    let mixed = rings(rows.clone().map(|(z, unit)| json!({"elev": z, "uom": unit})));
    let (found_levels, found_kinds) = found(&mixed);
    let rounded: Vec<f64> = found_levels.iter().map(|z| (z * 1e6).round() / 1e6).collect();
    assert_eq!((rounded, found_kinds), (vec![100.0, 110.0, 120.0, 130.0], vec![FindingKind::HeightUnit]));
    // Those without a unit, or with an unknown one, are left out.
    let odd = [mixed, rings([json!({"elev": 5, "uom": null}), json!({"elev": 6, "uom": "x"})])].concat();
    let (found_levels, found_kinds) = found(&odd);
    assert_eq!(found_levels.len(), 4);
    assert_eq!(found_kinds.iter().filter(|kind| **kind == FindingKind::MissingElevation).count(), 2);
    // All in millimetres; a name that says so; numbers of that name that can be metres.
    let of = |name: &str, step: i32| rings((1..5).map(|k| json!({name: step * k, "uom": "mm"})));
    assert_eq!(found(&of("elev", 5000)).0, [5.0, 10.0, 15.0, 20.0]);
    let finland = |step: i32| rings((1..5).map(|k| json!({"korkeusarvo": step * k})));
    assert_eq!(found(&finland(2500)), (vec![2.5, 5.0, 7.5, 10.0], vec![FindingKind::HeightUnit]));
    assert_eq!(found(&finland(5)), (vec![5.0, 10.0, 15.0, 20.0], vec![]));
    // The name of the field that the caller names.
    let named = InputOptions { elevation_field: Some("elev_dm".into()), ..InputOptions::default() };
    let input = read(&rings((1..4).map(|k| json!({"elev_dm": 50 * k}))), &named).unwrap();
    assert_eq!((levels(&input), kinds(&input.findings)), (vec![5.0, 10.0, 15.0], vec![FindingKind::HeightUnit]));
    // A number for no data has no unit.
    let with_gap = [of("elev", 5000), rings([json!({"elev": -9999, "uom": "mm"})])].concat();
    assert_eq!(levels(&prepared(&with_gap, Repair::Safe)), [5.0, 10.0, 15.0, 20.0]);
}

#[test]
fn spot_heights_have_units_of_their_own() {
    let point = |z: f64, unit: &str| feature("Point", json!(CENTRE), json!({"elev": z, "units": unit}));
    let lines = || rings((0..3).map(|k| json!({"elev": 100 + 40 * k, "units": "feet"})));
    let spots = |features: Vec<Value>| read(&features, &InputOptions::default()).unwrap().map.spots[0].z;
    assert_eq!(spots([lines(), vec![point(200.0, "feet")]].concat()), ElevationUnit::Foot.metres(200.0));
    assert_eq!(spots([lines(), vec![point(60.0, "m")]].concat()), 60.0);
    let folder = tempfile::tempdir().unwrap();
    let file = write(&folder, "points.geojson", &[point(200.0, "feet")]);
    let mut input = read(&rings((0..3).map(|k| json!({"elev": 30 + 10 * k}))), &InputOptions::default()).unwrap();
    input.read_spots(&(&file).into(), None, &()).unwrap();
    assert_eq!(input.map.spots[0].z, ElevationUnit::Foot.metres(200.0));
    assert_eq!(kinds(&input.findings), [FindingKind::HeightUnit]);
}

#[test]
fn lakes_and_coasts_have_units_of_their_own() {
    let folder = tempfile::tempdir().unwrap();
    let area = |z: f64, unit: &str| feature("Polygon", json!([ring(50.0)]), json!({"elev": z, "units": unit}));
    let lakes = write(&folder, "lakes.geojson", &[area(200.0, "feet")]);
    let coast = write(&folder, "coast.geojson", &[line(&ring(450.0), json!({"elev": 10, "units": "feet"}))]);
    let mut input = read(&rings((0..3).map(|k| json!({"elev": 30 + 10 * k}))), &InputOptions::default()).unwrap();
    input.read_features(Role::Water, &(&lakes).into()).unwrap();
    input.read_features(Role::Coast, &(&coast).into()).unwrap();
    assert_eq!(input.features.lakes[0].height, Some(ElevationUnit::Foot.metres(200.0)));
    assert_eq!(input.coast, [ElevationUnit::Foot.metres(10.0)]);
    assert_eq!(kinds(&input.findings), [FindingKind::HeightUnit; 2]);
}

#[test]
fn depths_are_told_and_read_as_negative_elevations() {
    let bed = |name: &str| rings((0..4).map(|k| json!({name: 10 * k})));
    let options = |field: Option<&str>, depths| InputOptions {
        elevation_field: field.map(str::to_owned),
        depths,
        ..InputOptions::default()
    };
    let of = |name: &str, field: Option<&str>, depths: bool| {
        let input = read(&bed(name), &options(field, depths)).unwrap();
        (levels(&input), kinds(&input.findings))
    };
    let (up, down) = (vec![0.0, 10.0, 20.0, 30.0], vec![0.0, -10.0, -20.0, -30.0]);
    assert_eq!(of("depth", Some("depth"), false), (up.clone(), vec![FindingKind::Depths]));
    assert_eq!(of("VALDCO", None, true), (down.clone(), vec![]));
    assert_eq!(of("水深", None, true), (down.clone(), vec![]));
    assert_eq!(of("soundings_of_1905", Some("soundings_of_1905"), true), (down, vec![]));
    assert_eq!(of("elev", None, true), (up, vec![FindingKind::Depths]));
    let (_, told) = of("depth_ft", Some("depth_ft"), false);
    assert_eq!(told, [FindingKind::Depths, FindingKind::UnitDoubt]);
    let error = read(&bed("depth"), &options(None, false)).unwrap_err().to_string();
    assert!(error.contains("\"depth\" seems to hold depths"), "{error}");
}

#[test]
fn heights_of_no_ground_are_a_warning() {
    let told = |from: f64, step: f64| {
        let input = prepared(&rings((0..4).map(|k| json!({"elev": from + step * f64::from(k)}))), Repair::Safe);
        kinds(&input.findings)
    };
    assert_eq!(told(102_500.0, 2500.0), [FindingKind::ImplausibleElevation]);
    assert_eq!(told(-1200.0, 20.0), [FindingKind::ImplausibleElevation]);
    assert_eq!(told(8000.0, 20.0), []);
}

const ELEV: &[Column] = &[Column { name: "ELEV", kind: Kind::Real }];
const BAND: &[Column] = &[Column { name: "ELEV_MIN", kind: Kind::Real }, Column { name: "ELEV_MAX", kind: Kind::Real }];
const TEXT: &[Column] = &[Column { name: "ELEV", kind: Kind::Text(16) }];

fn places(radius: f64) -> Vec<DVec2> {
    ring(radius).into_iter().map(DVec2::from).collect()
}

fn write_rows(path: &Path, geometry: Geometry, columns: &'static [Column], rows: Vec<Row<'_>>) {
    let staged = StagedOutput::create(path).unwrap();
    write_layers(&staged, &[Layer { name: "map", geometry, columns, rows }], Some(&Crs::from_epsg(SYSTEM))).unwrap();
    staged.commit().unwrap();
}

const VECTOR: [&str; 5] = ["geojson", "gpkg", "fgb", "parquet", "shp"];

#[test]
fn polygons_at_one_elevation_are_contours_in_every_format() {
    let folder = tempfile::tempdir().unwrap();
    for extension in VECTOR {
        let path = folder.path().join(format!("areas.{extension}"));
        // A plateau around a hollow: the hole is the same level.
        let row = |z: f64, radii: &[f64]| Row {
            shape: Shape::Area(radii.iter().map(|r| places(*r)).collect()),
            cells: vec![Cell::Real(z)],
        };
        write_rows(&path, Geometry::Areas, ELEV, vec![row(100.0, &[300.0]), row(105.0, &[200.0, 50.0])]);
        let input = Input::read(&path).unwrap();
        assert_eq!(levels(&input), [100.0, 105.0, 105.0], "{extension}");
        assert_eq!(kinds(&input.findings), [FindingKind::PolygonContour], "{extension}");
        let closed = input.map.contours.iter().all(|line| line.is_closed() && line.points.len() == 37);
        assert!(closed, "{extension}");

        let path = folder.path().join(format!("bands.{extension}"));
        let cells = || vec![Cell::Real(100.0), Cell::Real(105.0)];
        let band = Row { shape: Shape::Area(vec![places(300.0)]), cells: cells() };
        write_rows(&path, Geometry::Areas, BAND, vec![band]);
        let error = Input::read(&path).unwrap_err().to_string();
        assert!(error.contains("ELEV_MIN") && error.contains("areas between two levels"), "{extension}: {error}");
    }
}

#[test]
fn polygons_beside_lines() {
    let polygon = |radius: f64, properties: Value| feature("Polygon", json!([ring(radius)]), properties);
    let lines = rings([json!({"elev": 100}), json!({"elev": 105})]);
    let mixed =
        [lines.clone(), (0..3).map(|k| polygon(200.0 - 50.0 * f64::from(k), json!({"elev": 110 + 5 * k}))).collect()];
    assert_eq!(found(&mixed.concat()), (vec![100.0, 105.0, 110.0, 115.0, 120.0], vec![FindingKind::PolygonContour]));
    // Polygons of something else, of several parts, and areas that share their edges.
    let wood = [lines.clone(), vec![polygon(70.0, json!({"kind": "wood"}))]].concat();
    assert_eq!(found(&wood), (vec![100.0, 105.0], vec![FindingKind::SkippedFeature]));
    let parts = feature("MultiPolygon", json!([[ring(20.0)], [ring(30.0), ring(10.0)]]), json!({"elev": 110}));
    assert_eq!(found(&[lines.clone(), vec![parts]].concat()).0.len(), 5);
    let band =
        |outer: f64, inner: f64, z: f64| feature("Polygon", json!([ring(outer), ring(inner)]), json!({"elev": z}));
    let bands = [lines, vec![band(200.0, 150.0, 110.0), band(150.0, 100.0, 115.0), band(100.0, 50.0, 120.0)]].concat();
    assert_eq!(found(&bands), (vec![100.0, 105.0], vec![FindingKind::SkippedFeature]));
    // z of a polygon.
    let high: Vec<Value> = ring(90.0).iter().map(|[x, y]| json!([x, y, 107.5])).collect();
    let low: Vec<Value> = ring(190.0).iter().map(|[x, y]| json!([x, y, 105.0])).collect();
    let with_z = [feature("Polygon", json!([high]), json!({})), feature("LineString", json!(low), json!({}))];
    assert_eq!(found(&with_z).0, [107.5, 105.0]);
}

#[test]
fn elevations_as_text_are_read_where_they_are_certain() {
    let of = |texts: &[&str]| found(&rings(texts.iter().map(|text| json!({"elev": text}))));
    assert_eq!(of(&["100", "105", "110"]), (vec![100.0, 105.0, 110.0], vec![]));
    assert_eq!(of(&["100,0", "102,5", "105,0"]), (vec![100.0, 102.5, 105.0], vec![]));
    assert_eq!(of(&["100 m", "105 m"]), (vec![100.0, 105.0], vec![]));
    assert_eq!(of(&["EL 100", "EL 105"]), (vec![100.0, 105.0], vec![]));
    assert_eq!(of(&["328 ft", "368 ft"]).0, [328.0, 368.0].map(|z| ElevationUnit::Foot.metres(z)));
    assert_eq!(of(&["980", "1,000", "1,020"]).0, [980.0, 1000.0, 1020.0]);
    let error = read(&rings(["1,000", "1,020"].map(|text| json!({"elev": text}))), &InputOptions::default());
    let error = error.unwrap_err().to_string();
    assert!(error.contains("\"1,000\"") && error.contains("comma"), "{error}");
    // In the attribute table of a shapefile.
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("texts.shp");
    let places: Vec<Vec<DVec2>> = [300.0, 200.0].map(places).to_vec();
    let rows = places
        .iter()
        .zip(["100,0", "105,0"])
        .map(|(points, text)| Row { shape: Shape::Contour(points, 0.0), cells: vec![Cell::Text(text.into())] });
    write_rows(&path, Geometry::Lines, TEXT, rows.collect());
    assert_eq!(levels(&Input::read(&path).unwrap()), [100.0, 105.0]);
}

#[test]
fn rounding_makes_no_new_levels() {
    let half = |radius: f64, z: f64, first: bool| {
        let points = ring(radius);
        line(if first { &points[..=18] } else { &points[18..] }, json!({"elev": z}))
    };
    let halves: Vec<Value> = (0..4)
        .flat_map(|k| {
            let (radius, z) = (400.0 - 50.0 * f64::from(k), 100.0 + 5.0 * f64::from(k));
            [half(radius, z + 1.5e-6, true), half(radius, z - 1.5e-6, false)]
        })
        .collect();
    let input = prepared(&halves, Repair::Safe);
    assert_eq!(levels(&input), [100.0, 105.0, 110.0, 115.0]);
    assert!(input.map.contours.iter().all(|line| line.is_closed()));
    assert_eq!(kinds(&input.findings)[0], FindingKind::SameLevel);
    // z that varies by a millimetre, and by more.
    let noisy = |radius: f64, z: f64, noise: f64| {
        let places = ring(radius).into_iter().enumerate();
        let points: Vec<Value> = places.map(|(k, [x, y])| json!([x, y, z + noise * (k as f64).sin()])).collect();
        feature("LineString", json!(points), json!({}))
    };
    let (noisy_levels, told) =
        found(&[noisy(300.0, 100.0, 0.001), noisy(200.0, 105.0, 0.0005), noisy(100.0, 110.0, 0.0)]);
    assert_eq!((noisy_levels, told), (vec![100.0, 105.0, 110.0], vec![FindingKind::SameLevel]));
    let (sloping, told) = found(&[noisy(300.0, 100.0, 0.1), noisy(200.0, 105.0, 0.0)]);
    assert_eq!((sloping, told), (vec![105.0], vec![FindingKind::MissingElevation]));
}

#[test]
fn names_of_national_maps_are_known() {
    for name in [
        "ELV",
        "KOT",
        "TINGGI",
        "NIVEL",
        "QUOTE",
        "COTA",
        "CURVA",
        "ALTURA",
        "KORARV",
        "hoehe",
        "VALKNT",
        "CV_LIV_Q",
        "hojdvarde",
        "PROP_VALUE",
        "등고수치",
        "Высота",
        "ALTITUD",
        "KOTA_M",
        "augstums",
    ] {
        assert_eq!(
            found(&rings([json!({name: 100, "id": 7}), json!({name: 105, "id": 8})])).0,
            [100.0, 105.0],
            "{name}"
        );
    }
    // Of names that may mean something else, an elevation with a plain name or in z comes first.
    let open = rings([json!({"CURVA": 1, "COTA": 100}), json!({"CURVA": 2, "COTA": 105})]);
    assert_eq!(found(&open).0, [100.0, 105.0]);
    let with_z = |z: f64| feature("LineString", json!([[0.0, 0.0, z], [9.0, 9.0, z]]), json!({"NIVEL": 2}));
    assert_eq!(found(&[with_z(100.0), with_z(105.0)]).0, [100.0, 105.0]);
    // An unclear choice is an error that lists the fields; a number for no data is none.
    let unclear = rings([json!({"KOTA": 100, "TINGGI": 7})]);
    let error = read(&unclear, &InputOptions::default()).unwrap_err().to_string();
    assert!(error.contains("KOTA (such as 100)") && error.contains("TINGGI (such as 7)"), "{error}");
    let filler = rings([json!({"HEIGHT": -9999, "ELV": 100}), json!({"HEIGHT": -9999, "ELV": 105})]);
    assert_eq!(found(&filler).0, [100.0, 105.0]);
}

#[test]
fn what_a_reader_states_about_units_is_in_the_map() {
    let folder = tempfile::tempdir().unwrap();
    let path = write(&folder, "feet.geojson", &high(&[("contourunits", json!(1))]));
    let map = read_contours(&path, &ReadOptions::default()).unwrap().value;
    let stated = map.stated_unit.unwrap();
    assert_eq!((stated.unit, map.contours[0].elevation), (ElevationUnit::Foot, 8000.0));
    assert_eq!(stated.says, "the field \"contourunits\" states feet");
}
