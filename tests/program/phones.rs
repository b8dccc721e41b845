//! KML and KMZ for phones.

#![allow(clippy::unwrap_used, reason = "helpers of tests are tests too")]

use std::collections::BTreeSet;
use std::fs::{self, File};
use std::io::Read;

use tokosen::io::{ReadOptions, read_contours};

use crate::running::{Running, folder_with, folder_with_part};

/// A part of the sample that is quick to work on.
const PART: &str = "--extent 745000,4018500,747000,4020000 --surface linear";

/// What stands between a start and an end, each time.
fn between<'a>(text: &'a str, start: &str, end: &str) -> Vec<&'a str> {
    text.split(start).skip(1).map(|rest| &rest[..rest.find(end).unwrap()]).collect()
}

#[test]
fn contours_for_a_phone_are_named_by_their_elevation_and_lie_on_wgs_84() {
    let folder = folder_with_part("in.gpkg");
    let said = folder.succeeds(&format!("densify in.gpkg -i 10 -o phone.kml {PART}"));
    assert!(said.contains("phone.kml, layer contours_10m"), "{said}");
    let text = fs::read_to_string(folder.path("phone.kml")).unwrap();
    let folders = between(&text, "<Folder><name>", "</name>");
    let kinds = ["contours_10m", "index contours of the input", "index contours", "contours of the input", "contours"];
    assert_eq!(folders.iter().collect::<BTreeSet<_>>(), kinds.iter().collect::<BTreeSet<_>>());
    let names = between(&text, "<Placemark><name>", "</name>");
    let is_level = |name: &&&str| name.strip_suffix(" m").unwrap().parse::<f64>().unwrap() % 10.0 == 0.0;
    assert!(names.len() > 50 && names.iter().all(|name| is_level(&name)), "{names:?}");
    // Each style that is used is there.
    let styles: BTreeSet<&str> = between(&text, "<Style id=\"", "\"").into_iter().collect();
    let used: BTreeSet<&str> = between(&text, "<styleUrl>#", "<").into_iter().collect();
    assert_eq!(styles, used);
    assert!(!text.contains("<altitudeMode>absolute") && text.contains("<altitudeMode>clampToGround"));

    // The lines are those of a GeoJSON in longitudes and latitudes, within a centimetre.
    folder.succeeds(&format!("densify in.gpkg -i 10 -o same.geojson --to-crs EPSG:4326 {PART}"));
    let read = |name: &str| {
        let elevation_field = Some("elev".to_owned());
        let mut lines = read_contours(&folder.path(name), &ReadOptions { elevation_field, ..ReadOptions::default() })
            .unwrap()
            .value
            .contours;
        lines.sort_by(|a, b| {
            let key = |line: &tokosen::contour::Contour| (line.elevation, line.points.len(), line.points[0].x);
            key(a).partial_cmp(&key(b)).unwrap()
        });
        lines
    };
    let (kml, geojson) = (read("phone.kml"), read("same.geojson"));
    assert_eq!(kml.len(), geojson.len());
    for (a, b) in kml.iter().zip(&geojson) {
        assert_eq!((a.elevation, a.points.len()), (b.elevation, b.points.len()));
        assert!(a.points.iter().zip(&b.points).all(|(p, q)| p.distance(*q) < 1e-7));
    }
    // It is its own file, and may be replaced.
    folder.succeeds(&format!("densify in.gpkg -i 20 -o phone.kml {PART}"));
}

#[test]
fn an_archive_holds_the_same_document_and_is_much_smaller() {
    let folder = folder_with_part("in.gpkg");
    folder.succeeds(&format!("densify in.gpkg -i 20,10 --to-unit ft --labels=40 -o phone.kmz {PART}"));
    let mut archive = zip::ZipArchive::new(File::open(folder.path("phone.kmz")).unwrap()).unwrap();
    let mut text = String::new();
    archive.by_name("doc.kml").unwrap().read_to_string(&mut text).unwrap();
    let folders: BTreeSet<&str> = between(&text, "<Folder><name>", "</name>").into_iter().collect();
    // Several layers are in one file, labels beside them.
    assert!(
        folders.contains("contours_20ft") && folders.contains("contours_10ft") && folders.contains("labels_10ft"),
        "{folders:?}"
    );
    let names = between(&text, "<Placemark><name>", "</name>");
    assert!(names.iter().any(|name| name.ends_with(" ft")) && names.iter().any(|name| name.parse::<f64>().is_ok()));
    assert!(fs::metadata(folder.path("phone.kmz")).unwrap().len() * 3 < text.len() as u64);
    // The same bytes again, and no question before it is replaced.
    let bytes = || fs::read(folder.path("phone.kmz")).unwrap();
    let first = bytes();
    folder.succeeds(&format!("densify in.gpkg -i 20,10 --to-unit ft --labels=40 -o phone.kmz {PART}"));
    assert!(first == bytes());
}

#[test]
fn areas_and_ridges_are_for_phones_too_and_other_systems_are_not() {
    let folder = folder_with("fig3a_spur.geojson", "map.geojson");
    let said = folder.ends("densify map.geojson -i 5 -o phone.kml --to-crs EPSG:6677", 2);
    assert!(said.contains("KML is always in WGS 84"), "{said}");
    // Nobody knows where a drawing lies.
    folder.succeeds("densify map.geojson -i 10 -o drawing.dxf");
    let said = folder.ends("densify drawing.dxf -i 5 -o phone.kml", 1);
    assert!(said.contains("coordinate reference system of the contours is not known"), "{said}");
    for command in ["regions map.geojson", "skeleton map.geojson"] {
        folder.succeeds(&format!("{command} -o {}.kml", &command[..4]));
    }
    let text = fs::read_to_string(folder.path("regi.kml")).unwrap();
    assert!(text.contains("<outerBoundaryIs>") && text.contains("<SimpleData name=\"class\">"), "{text}");
    let text = fs::read_to_string(folder.path("skel.kml")).unwrap();
    assert!(text.contains("<Style id=\"ridge\">") && text.contains("<LineString>"), "{text}");
}
