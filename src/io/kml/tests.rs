//! Placemarks of every kind.

use glam::{DVec2, DVec3};

use super::*;
use crate::{ReadOptions, read_contours, read_spot_heights, read_water};

const START: &str = "<?xml version=\"1.0\"?><kml xmlns=\"http://www.opengis.net/kml/2.2\"><Document>";

fn file(folder: &Path, placemarks: &str) -> std::path::PathBuf {
    let path = folder.join("in.kml");
    std::fs::write(&path, format!("{START}{placemarks}</Document></kml>")).expect("a file");
    path
}

fn line(more: &str, coordinates: &str) -> String {
    format!("<Placemark>{more}<LineString><coordinates>{coordinates}</coordinates></LineString></Placemark>")
}

fn elevations(path: &Path, field: Option<&str>) -> Result<(Vec<f64>, String)> {
    let options = ReadOptions { elevation_field: field.map(str::to_owned), ..ReadOptions::default() };
    let report = read_contours(path, &options)?;
    let told: Vec<String> = report.findings.iter().map(ToString::to_string).collect();
    Ok((report.value.contours.iter().map(|c| c.elevation).collect(), told.join("\n")))
}

#[test]
fn elevations_stand_in_extended_data_names_and_descriptions() {
    let dir = tempfile::tempdir().expect("a folder");
    let data = "<ExtendedData><SchemaData><SimpleData name=\"ELEV\">125.5</SimpleData></SchemaData></ExtendedData>";
    let value =
        "<ExtendedData><Data name=\"elev\"><displayName>x</displayName><value> 10 </value></Data></ExtendedData>";
    let html = "<description><![CDATA[<table><tr><td>Elev</td><td>30</td></tr></table>]]></description>";
    for (more, field, elevation) in [
        (data, None, 125.5),
        (value, None, 10.0),
        (html, None, 30.0),
        ("<name>40</name>", Some("name"), 40.0),
        ("<description>50</description>", Some("Description"), 50.0),
    ] {
        let path = file(dir.path(), &line(more, "138.5,35.25\n 138.6,35.5"));
        assert_eq!(elevations(&path, field).expect("a line").0, [elevation], "{more}");
    }
    let path = file(dir.path(), &line("<name>hill</name>", "1,2 3,4"));
    let error = elevations(&path, None).expect_err("no elevation").to_string();
    assert!(error.contains("name (such as \"hill\")"), "{error}");
    let map = read_contours(&file(dir.path(), &line(data, "138.5,35.25,9 138.6,35.5,8")), &ReadOptions::default());
    let map = map.expect("a line").value;
    assert_eq!(map.contours[0].points, [DVec2::new(138.5, 35.25), DVec2::new(138.6, 35.5)]);
    assert_eq!(map.crs.and_then(|crs| crs.epsg), Some(4326));
}

#[test]
fn z_is_an_elevation_only_if_it_is_absolute() {
    let dir = tempfile::tempdir().expect("a folder");
    let with = |mode: &str| {
        let mode = if mode.is_empty() { String::new() } else { format!("<altitudeMode>{mode}</altitudeMode>") };
        file(
            dir.path(),
            &format!("<Placemark><LineString>{mode}<coordinates>1,2,30 3,4,30</coordinates></LineString></Placemark>"),
        )
    };
    assert_eq!(elevations(&with("absolute"), None).expect("a line"), (vec![30.0], String::new()));
    for mode in ["", "clampToGround", "relativeToGround"] {
        let error = elevations(&with(mode), None).expect_err("no elevation").to_string();
        assert!(error.contains("altitude mode"), "{error}");
        let (found, told) = elevations(&with(mode), Some("z")).expect("a line");
        assert!(found == [30.0] && told.is_empty(), "{told}");
    }
}

#[test]
fn points_and_polygons() {
    let dir = tempfile::tempdir().expect("a folder");
    let ring = |text: &str| format!("<LinearRing><coordinates>{text}</coordinates></LinearRing>");
    let placemarks = format!(
        "<Folder><Placemark><Point><altitudeMode>absolute</altitudeMode><coordinates>5,6,70</coordinates></Point></Placemark>\
         <Placemark><ExtendedData><Data name=\"elev\"><value>12</value></Data></ExtendedData><MultiGeometry><Polygon>\
         <outerBoundaryIs>{}</outerBoundaryIs><innerBoundaryIs>{}</innerBoundaryIs></Polygon></MultiGeometry></Placemark>\
         <Placemark><name>nothing</name></Placemark></Folder>",
        ring("0,0 9,0 9,9 0,0"),
        ring("6,1 8,1 8,2 6,1")
    );
    let path = file(dir.path(), &placemarks);
    let spots = read_spot_heights(&path, &ReadOptions::default()).expect("a point").value;
    assert_eq!(spots.points, [DVec3::new(5.0, 6.0, 70.0)]);
    let (lakes, crs) = read_water(&path, &ReadOptions::default()).expect("a lake").value;
    assert_eq!((lakes.len(), lakes[0].height, crs.and_then(|crs| crs.epsg)), (1, Some(12.0), Some(4326)));
    let error = elevations(&path, None).expect_err("no line").to_string();
    assert!(error.contains("1 Polygon") && error.contains("1 no geometry"), "{error}");
}

#[test]
fn a_kmz_holds_one_kml_or_several() {
    let dir = tempfile::tempdir().expect("a folder");
    let data = "<ExtendedData><Data name=\"elev\"><value>10</value></Data></ExtendedData>";
    let text = format!("{START}{}</Document></kml>", line(data, "1,2 3,4"));
    let path = dir.path().join("in.kmz");
    let mut archive = zip::ZipWriter::new(std::fs::File::create(&path).expect("a file"));
    let link = "<kml><Document><NetworkLink><href>layers/contours.kml</href></NetworkLink></Document></kml>";
    for (name, text) in [("doc.kml", link), ("layers/contours.kml", text.as_str())] {
        archive.start_file(name, zip::write::SimpleFileOptions::default()).expect("an entry");
        std::io::Write::write_all(&mut archive, text.as_bytes()).expect("its text");
    }
    archive.finish().expect("an archive");
    assert_eq!(elevations(&path, None).expect("a line"), (vec![10.0], String::new()));
}

#[test]
fn what_is_broken_is_an_error_with_its_place() {
    let dir = tempfile::tempdir().expect("a folder");
    for (placemarks, words) in [
        (line("", "1,2 x,4"), "placemark 0: its coordinates hold x,4"),
        (line("", "1 2"), "placemark 0"),
        (line("", "35.5,138.5 35.6,138.6"), "the longitude first"),
        ("<Placemark>".to_owned(), "broken"),
        ("<a>".repeat(200), "too deep"),
    ] {
        let error = elevations(&file(dir.path(), &placemarks), None).expect_err("an error").to_string();
        assert!(error.contains("in.kml") && error.contains(words), "{error}");
    }
    let path = dir.path().join("other.kml");
    std::fs::write(&path, "<gpx></gpx>").expect("a file");
    assert!(elevations(&path, None).expect_err("an error").to_string().contains("it is not KML"));
}
