//! Features of several versions of GML.

use std::path::PathBuf;

use glam::{DVec2, DVec3};

use super::*;
use crate::{ReadOptions, read_contours, read_spot_heights, read_water};

fn file(folder: &Path, members: &str) -> PathBuf {
    let path = folder.join("in.gml");
    let start = "<?xml version=\"1.0\"?><ogr:FeatureCollection xmlns:ogr=\"http://ogr.maptools.org/\" \
                 xmlns:gml=\"http://www.opengis.net/gml\">";
    std::fs::write(&path, format!("{start}{members}</ogr:FeatureCollection>")).expect("a file");
    path
}

fn feature(kind: &str, inner: &str) -> String {
    format!("<gml:featureMember><ogr:{kind} gml:id=\"a.0\">{inner}</ogr:{kind}></gml:featureMember>")
}

/// Elevation and vertices of each contour, the code of the system, and the findings.
type Found = (Vec<(f64, Vec<DVec2>)>, Option<u32>, String);

fn contours(path: &Path, layer: Option<&str>) -> Result<Found> {
    let options = ReadOptions { layer: layer.map(str::to_owned), ..ReadOptions::default() };
    let report = read_contours(path, &options)?;
    let told: Vec<String> = report.findings.iter().map(ToString::to_string).collect();
    let lines = report.value.contours.into_iter().map(|c| (c.elevation, c.points)).collect();
    Ok((lines, report.value.crs.and_then(|crs| crs.epsg), told.join("\n")))
}

fn line(srs: &str, positions: &str) -> String {
    format!(
        "<ogr:geom><gml:LineString srsName=\"{srs}\"><gml:posList>{positions}</gml:posList></gml:LineString></ogr:geom>\
         <ogr:elev>12.5</ogr:elev>"
    )
}

#[test]
fn lines_of_several_versions() {
    let dir = tempfile::tempdir().expect("a folder");
    let expected = vec![(12.5, vec![DVec2::new(500.0, 20.0), DVec2::new(510.5, 30.0)])];
    let utm = "urn:ogc:def:crs:EPSG::25832";
    for inner in [
        line(utm, "500 20 510.5 30"),
        format!(
            "<ogr:elev>12.5</ogr:elev><gml:curveProperty><gml:Curve srsName=\"{utm}\" srsDimension=\"3\"><gml:segments>\
             <gml:LineStringSegment><gml:posList>500 20 12.5 510.5 30 12.5</gml:posList></gml:LineStringSegment></gml:segments>\
             </gml:Curve></gml:curveProperty>"
        ),
        format!(
            "<ogr:elev>12.5</ogr:elev><g><gml:MultiLineString srsName=\"{utm}\"><gml:lineStringMember><gml:LineString>\
             <gml:coordinates>500,20 510.5,30</gml:coordinates></gml:LineString></gml:lineStringMember></gml:MultiLineString></g>"
        ),
        format!(
            "<gml:boundedBy><gml:Envelope><gml:lowerCorner>1 2</gml:lowerCorner></gml:Envelope></gml:boundedBy>\
             <ogr:elev>12.5</ogr:elev><g><gml:LineString srsName=\"{utm}\"><gml:pos>500 20</gml:pos><gml:pos>510.5 30</gml:pos>\
             </gml:LineString></g>"
        ),
        format!(
            "<ogr:elev>12.5</ogr:elev><g><gml:LineString srsName=\"{utm}\"><gml:coord><gml:X>500</gml:X><gml:Y>20</gml:Y></gml:coord>\
             <gml:coord><gml:X>510.5</gml:X><gml:Y>30</gml:Y></gml:coord></gml:LineString></g>"
        ),
    ] {
        let (found, crs, told) = contours(&file(dir.path(), &feature("Contour", &inner)), None).expect("a line");
        assert_eq!((found, crs, told.as_str()), (expected.clone(), Some(25832), ""), "{inner}");
    }
}

#[test]
fn pieces_of_a_curve_are_one_line_and_arcs_are_left_out() {
    let dir = tempfile::tempdir().expect("a folder");
    let segment = |text: &str| format!("<LineStringSegment><posList>{text}</posList></LineStringSegment>");
    let curve = |inner: &str| {
        format!("<elev>5</elev><g><Curve srsName=\"EPSG:25832\"><segments>{inner}</segments></Curve></g>")
    };
    let whole = curve(&(segment("0 0 1 0") + &segment("1 0 1 1")));
    let (found, ..) = contours(&file(dir.path(), &feature("C", &whole)), None).expect("a line");
    assert_eq!(found[0].1, [DVec2::ZERO, DVec2::X, DVec2::ONE]);
    let arc = curve(&(segment("0 0 1 0") + "<Arc><posList>1 0 2 1 3 0</posList></Arc>"));
    let both = feature("C", &whole) + &feature("C", &arc);
    let (found, _, told) = contours(&file(dir.path(), &both), None).expect("a line");
    assert!(found.len() == 1 && told.contains("1 geometries of type Arc"), "{told}");
}

#[test]
fn the_name_of_the_system_gives_the_order() {
    let dir = tempfile::tempdir().expect("a folder");
    let of = |srs: &str, positions: &str| contours(&file(dir.path(), &feature("C", &line(srs, positions))), None);
    let place = |found: &Found| found.0[0].1[0];
    let long = of("urn:ogc:def:crs:EPSG::4326", "35.5 138.5 35.6 138.6").expect("a line");
    assert_eq!((place(&long), long.1, long.2.as_str()), (DVec2::new(138.5, 35.5), Some(4326), ""));
    let short = of("EPSG:4326", "138.5 35.5 138.6 35.6").expect("a line");
    assert!(
        place(&short) == DVec2::new(138.5, 35.5) && short.2.contains("longitude is taken to come first"),
        "{}",
        short.2
    );
    let plane = of("urn:ogc:def:crs:EPSG::6677", "-4000 100 -4001 101").expect("a line");
    assert!(place(&plane) == DVec2::new(100.0, -4000.0) && plane.2.contains("northing first"), "{}", plane.2);
    for (srs, positions) in
        [("urn:ogc:def:crs:EPSG::4326", "138.5 35.5 138.6 35.6"), ("EPSG:4326", "35.5 138.5 35.6 138.6")]
    {
        let error = of(srs, positions).expect_err("a latitude beyond 90").to_string();
        assert!(error.contains("comes first, but then a place is at"), "{error}");
    }
    let unnamed = of("my grid", "1 2 3 4").expect("a line");
    assert!(unnamed.1.is_none() && unnamed.2.contains("\"my grid\" is not known"), "{}", unnamed.2);
    let mixed = feature("C", &line("EPSG:25832", "1 2 3 4")) + &feature("C", &line("EPSG:25833", "1 2 3 4"));
    let error = contours(&file(dir.path(), &mixed), None).expect_err("two systems").to_string();
    assert!(error.contains("several coordinate reference systems"), "{error}");
}

#[test]
fn the_collection_may_name_the_system() {
    let dir = tempfile::tempdir().expect("a folder");
    let start = "<gml:boundedBy><gml:Envelope srsName=\"urn:ogc:def:crs:EPSG::4326\" srsDimension=\"3\"><gml:lowerCorner>0 0 0\
                 </gml:lowerCorner></gml:Envelope></gml:boundedBy>";
    let inner = "<elev>9</elev><g><gml:LineString><gml:posList>35 138 9 36 139 9</gml:posList></gml:LineString></g>";
    let (found, crs, _) =
        contours(&file(dir.path(), &(start.to_owned() + &feature("C", inner))), None).expect("a line");
    assert_eq!((found[0].1[1], crs), (DVec2::new(139.0, 36.0), Some(4326)));
}

#[test]
fn types_of_features_are_layers() {
    let dir = tempfile::tempdir().expect("a folder");
    let both = feature("Contour", &line("EPSG:25832", "1 2 3 4")) + &feature("Shore", &line("EPSG:25832", "5 6 7 8"));
    let path = file(dir.path(), &both);
    let error = contours(&path, None).expect_err("two types").to_string();
    assert!(error.contains("\"Contour\"") && error.contains("\"Shore\""), "{error}");
    assert_eq!(contours(&path, Some("Shore")).expect("a line").0[0].1[0], DVec2::new(5.0, 6.0));
    let error = contours(&path, Some("Road")).expect_err("no such type").to_string();
    assert!(error.contains("\"Road\"") && error.contains("\"Shore\""), "{error}");
}

#[test]
fn points_and_polygons() {
    let dir = tempfile::tempdir().expect("a folder");
    let ring = |text: &str| format!("<LinearRing><posList>{text}</posList></LinearRing>");
    let members = feature("Spot", "<g><Point srsName=\"EPSG:25832\"><pos>5 6 70</pos></Point></g>")
        + &feature(
            "Lake",
            &format!(
                "<elev>12</elev><g><MultiSurface srsName=\"EPSG:25832\"><surfaceMember><Polygon><exterior>{}</exterior><interior>{}\
                 </interior></Polygon></surfaceMember></MultiSurface></g>",
                ring("0 0 9 0 9 9 0 0"),
                ring("5 1 8 1 8 2 5 1")
            ),
        );
    let path = file(dir.path(), &members);
    let spots = read_spot_heights(&path, &ReadOptions::default()).expect("a point").value;
    assert_eq!(spots.points, [DVec3::new(5.0, 6.0, 70.0)]);
    let (lakes, _) = read_water(&path, &ReadOptions::default()).expect("a lake").value;
    assert_eq!((lakes.len(), lakes[0].height), (1, Some(12.0)));
    let error = contours(&path, None).expect_err("no line").to_string();
    assert!(error.contains("1 Polygon"), "{error}");
}

#[test]
fn what_is_broken_is_an_error_with_its_place() {
    let dir = tempfile::tempdir().expect("a folder");
    let of = |inner: &str| contours(&file(dir.path(), &feature("C", inner)), None).expect_err("an error").to_string();
    assert!(of(&line("EPSG:25832", "1 2 x 4")).contains("feature 0: its positions hold x"));
    assert!(of(&line("EPSG:25832", "1 2 3 4 5")).contains("feature 0"));
    assert!(of(&"<a>".repeat(200)).contains("too deep"));
    let error = contours(&file(dir.path(), "<x/>"), None).expect_err("an error").to_string();
    assert!(error.contains("ogr2ogr"), "{error}");
}
