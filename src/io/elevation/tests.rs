//! Tests the rules that find the elevation, with tables made by hand.

use crate::elevation::*;
use crate::table::{Feature, Purpose, Request};

/// A table with one straight line per row: the values of the fields, and its z.
fn table(named: Option<&str>, names: &[&str], rows: &[(&[Value], Option<[f64; 2]>)]) -> Table {
    let mut table = Table::new(&Request {
        elevation_field: named,
        layer: None,
        purpose: Purpose::Contours,
        within: None,
        memory: None,
    });
    for (number, (values, z)) in (0..).zip(rows) {
        let mut feature = Feature { number, ..Feature::default() };
        for (name, value) in names.iter().zip(*values) {
            let field = table.field(name);
            table.note(&mut feature.values, field, value.clone());
        }
        let points = vec![DVec2::new(number as f64, 0.0), DVec2::new(number as f64, 1.0)];
        feature.lines.push(Line { points, z: *z, heights: Vec::new(), is_ring: false });
        table.push(feature);
    }
    table
}

fn read(named: Option<&str>, names: &[&str], rows: &[(&[Value], Option<[f64; 2]>)]) -> Result<Report<ContourMap>> {
    contour_map(Path::new("in.x"), table(named, names, rows), &options(named))
}

fn options(named: Option<&str>) -> ReadOptions {
    ReadOptions { elevation_field: named.map(str::to_owned), ..ReadOptions::default() }
}

fn elevations(report: Result<Report<ContourMap>>) -> Vec<f64> {
    report.unwrap().value.contours.iter().map(|c| c.elevation).collect()
}

fn message(report: Result<Report<ContourMap>>) -> String {
    report.unwrap_err().to_string()
}

fn num(n: f64) -> Value {
    Value::Number(n)
}

fn text(t: &str) -> Value {
    Value::Text(t.to_owned())
}

#[test]
fn known_names_in_any_case_and_with_metres() {
    for name in
        ["elev", "ELEV", "Elevation", "Z", "HOEHE", "Höhe", "HØYDE", "標高", "等高線", "ELEV_M", "alti", "height (m)"]
    {
        assert!(is_elevation_name(name), "{name}");
        assert_eq!(elevations(read(None, &["ID", name], &[(&[num(1.0), num(120.0)], None)])), [120.0], "{name}");
    }
    for name in ["elev_ft", "id", "objtype", "shape_leng", "elevator", ""] {
        assert!(!is_elevation_name(name), "{name}");
    }
}

#[test]
fn a_named_field_wins_and_a_missing_one_lists_the_others() {
    let rows: &[(&[Value], _)] = &[(&[num(10.0), num(20.0)], Some([30.0, 30.0]))];
    assert_eq!(elevations(read(Some("Foo"), &["elev", "foo"], rows)), [20.0]);
    assert_eq!(elevations(read(Some("FOO"), &["FOO", "foo"], rows)), [10.0]);
    assert_eq!(elevations(read(Some("foo"), &["FOO", "foo"], rows)), [20.0]);
    assert_eq!(elevations(read(Some("Z"), &["elev", "foo"], rows)), [30.0]);
    let error = message(read(Some("bar"), &["elev", "foo"], rows));
    assert!(
        error.contains("in.x") && error.contains("\"bar\"") && error.contains("elev (such as 10), foo (such as 20)"),
        "{error}"
    );
}

#[test]
fn fields_that_disagree_are_in_doubt_and_fields_that_agree_are_not() {
    let doubt =
        message(read(None, &["elev", "height"], &[(&[num(10.0), num(10.0)], None), (&[num(20.0), num(3.0)], None)]));
    assert!(doubt.contains("in feature 1; its fields are") && doubt.contains("height (such as 10)"), "{doubt}");
    assert_eq!(elevations(read(None, &["elev", "height"], &[(&[num(10.0), text("10.00")], None)])), [10.0]);
    // A field with a known name but without a number is not a candidate.
    assert_eq!(elevations(read(None, &["level", "height"], &[(&[text("minor"), num(7.0)], None)])), [7.0]);
    assert_eq!(elevations(read(None, &["level", "height"], &[(&[Value::Null, num(7.0)], None)])), [7.0]);
}

#[test]
fn z_is_used_without_a_field_and_checked_with_one() {
    assert_eq!(
        elevations(read(None, &["id"], &[(&[num(1.0)], Some([5.0, 5.0])), (&[num(2.0)], Some([0.0, 0.0]))])),
        [5.0, 0.0]
    );
    assert_eq!(elevations(read(None, &[], &[(&[], Some([5.0, 5.0]))])), [5.0]);
    assert_eq!(elevations(read(None, &["elev"], &[(&[num(5.0)], Some([5.0, 5.0]))])), [5.0]);
    assert_eq!(elevations(read(None, &["elev"], &[(&[num(5.004)], Some([5.0, 5.0]))])), [5.004]);
    assert_eq!(elevations(read(None, &["elev"], &[(&[num(5.0)], Some([0.0, 0.0]))])), [5.0]);
    let doubt = message(read(None, &["elev"], &[(&[num(5.0)], Some([6.0, 6.0]))]));
    assert!(doubt.contains("z coordinate (6)") && doubt.contains("elev (such as 5)"), "{doubt}");
    // Lines draped over a terrain: z is not the elevation.
    let draped: &[(&[Value], _)] = &[(&[num(5.0)], Some([4.0, 6.0])), (&[num(5.0)], Some([4.0, 4.0]))];
    assert_eq!(elevations(read(None, &["elev"], draped)), [5.0, 5.0]);
}

#[test]
fn no_elevation_at_all_is_an_error_that_lists_the_fields() {
    for (z, word) in [(None, "no z"), (Some([0.0, 0.0]), "every z is 0"), (Some([1.0, 2.0]), "varies")] {
        let error = message(read(None, &["id", "kind"], &[(&[num(17.0), text("index")], z)]));
        assert!(error.contains(word) && error.contains("no field is known to hold elevations"), "{error}");
        assert!(error.contains("id (such as 17), kind (such as \"index\")"), "{error}");
    }
    assert_eq!(elevations(read(Some("z"), &["id"], &[(&[num(17.0)], Some([0.0, 0.0]))])), [0.0]);
    let empty = message(contour_map(Path::new("in.x"), table(None, &[], &[]), &options(None)));
    assert!(empty.contains("there is no line"), "{empty}");
}

#[test]
fn a_line_whose_z_varies_is_left_out_with_its_place() {
    let report = read(None, &[], &[(&[], Some([5.0, 5.0])), (&[], Some([5.0, 6.0])), (&[], None)]).unwrap();
    assert_eq!(report.value.contours.len(), 1);
    let skipped: Vec<_> = report.findings.iter().filter(|f| f.kind == FindingKind::MissingElevation).collect();
    assert_eq!(skipped.len(), 2);
    assert_eq!(skipped[0].place, Some(DVec2::new(1.0, 0.0)));
    assert!(skipped[0].message.contains("varies from 5 to 6"), "{}", skipped[0].message);
}

#[test]
fn text_is_taken_if_it_is_a_number() {
    let rows: &[(&[Value], _)] = &[(&[text("120")], None), (&[text(" 120.5 ")], None), (&[text("-1e2")], None)];
    assert_eq!(elevations(read(None, &["elev"], rows)), [120.0, 120.5, -100.0]);
    let error = message(read(None, &["elev"], &[(&[text("120")], None), (&[text("120 up")], None)]));
    assert!(error.contains("in.x") && error.contains("feature 1") && error.contains("\"120 up\""), "{error}");
    let rows: &[(&[Value], _)] = &[(&[text("120")], None), (&[text("n/a")], None), (&[num(130.0)], None)];
    let report = read(None, &["elev"], rows).unwrap();
    assert_eq!(report.value.contours.len(), 2);
    let missing = report.findings.iter().find(|f| f.kind == FindingKind::MissingElevation).unwrap();
    assert_eq!((&missing.features[..], missing.place), (&[1.into()][..], Some(DVec2::new(1.0, 0.0))));
    assert!(missing.message.contains("\"n/a\""), "{missing}");
    let error = message(read(Some("kind"), &["kind"], &[(&[text("index")], None)]));
    assert!(error.contains("\"index\""), "{error}");
}

#[test]
fn empty_and_infinite_elevations_are_left_out() {
    let rows: &[(&[Value], _)] = &[
        (&[num(1.0)], None),
        (&[Value::Null], None),
        (&[num(f64::NAN)], None),
        (&[num(f64::INFINITY)], None),
        (&[text("NaN")], None),
        (&[text("")], None),
        (&[], None),
    ];
    let report = read(None, &["elev"], rows).unwrap();
    assert_eq!(report.value.contours.len(), 1);
    let skipped: Vec<_> = report.findings.iter().filter(|f| f.kind == FindingKind::MissingElevation).collect();
    assert_eq!(skipped.len(), 6);
    assert!(skipped.iter().all(|f| f.place.is_some()));
    let error = message(read(Some("elev"), &["elev"], &[(&[Value::Null], None)]));
    assert!(error.contains("no line has an elevation") && error.contains("is empty"), "{error}");
}

#[test]
fn vertices_that_are_not_finite_are_left_out() {
    let mut table = table(None, &["elev"], &[(&[num(1.0)], None), (&[num(2.0)], None)]);
    table.features[0].lines[0].points.insert(1, DVec2::new(f64::NAN, 0.5));
    table.features[1].lines[0].points = vec![DVec2::splat(f64::INFINITY)];
    let report = contour_map(Path::new("in.x"), table, &options(None)).unwrap();
    assert_eq!(report.value.contours.len(), 1);
    assert_eq!(report.value.contours[0].points.len(), 2);
    assert_eq!(report.findings.iter().filter(|f| f.kind == FindingKind::NonFinitePoint).count(), 2);
}

#[test]
fn points_beside_lines_are_spot_heights_or_a_finding() {
    let with_points = |name: &str, value: Value, named: Option<&str>, z: Option<f64>| {
        let mut table = table(named, &["elev"], &[(&[num(10.0)], None)]);
        let mut feature = Feature { number: 9, ..Feature::default() };
        let field = table.field(name);
        table.note(&mut feature.values, field, value);
        feature.spots.push(Spot { place: DVec2::new(3.0, 4.0), z });
        table.push(feature);
        contour_map(Path::new("in.x"), table, &options(named)).unwrap()
    };
    let spot = vec![DVec3::new(3.0, 4.0, 12.5)];
    assert_eq!(with_points("elev", num(12.5), None, None).value.spots, spot);
    assert_eq!(with_points("height", text("12.5"), Some("elev"), None).value.spots, spot);
    assert_eq!(with_points("id", num(1.0), Some("elev"), Some(12.5)).value.spots, spot);
    for report in [with_points("id", num(1.0), None, None), with_points("elev", text("top"), None, None)] {
        assert!(report.value.spots.is_empty());
        assert!(report.findings.iter().any(|f| f.message.contains("1 points left out")), "{:?}", report.findings);
    }
}
