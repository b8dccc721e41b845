//! `tokosen check` and `--repair` as their users meet them.

#![allow(clippy::unwrap_used, reason = "helpers of tests are tests too")]

use std::fs;
use std::path::{Path, PathBuf};

use assert_cmd::cargo::cargo_bin_cmd;
use rusqlite::Connection;
use serde_json::{Value, json};
use tempfile::TempDir;

/// A line: elevation and vertices.
type Line = (f64, Vec<[f64; 2]>);

/// A square ring about the middle of a hill.
fn ring(elevation: f64, half: f64) -> Line {
    (
        elevation,
        [(-1, -1), (1, -1), (1, 1), (-1, 1), (-1, -1)].map(|(x, y)| [half * f64::from(x), half * f64::from(y)]).into(),
    )
}

/// Six levels from 100 m on, 10 m apart, whose rings are 20 m apart.
fn hill() -> Vec<Line> {
    (0..6).map(|k| ring(100.0 + 10.0 * f64::from(k), 120.0 - 20.0 * f64::from(k))).collect()
}

struct Folder(TempDir);

impl Folder {
    fn new() -> Self {
        Self(tempfile::tempdir().unwrap())
    }

    fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    /// Writes lines as GeoJSON; those of feature 0 first.
    fn put(&self, name: &str, lines: &[Line]) {
        let feature = |(number, (elevation, points)): (usize, &Line)| {
            let geometry = json!({ "type": "LineString", "coordinates": points });
            json!({ "type": "Feature", "id": number, "properties": { "elev": elevation }, "geometry": geometry })
        };
        let features: Vec<Value> = lines.iter().enumerate().map(feature).collect();
        let crs = json!({ "type": "name", "properties": { "name": "urn:ogc:def:crs:EPSG::6677" } });
        let all = json!({ "type": "FeatureCollection", "crs": crs, "features": features });
        fs::write(self.path(name), all.to_string()).unwrap();
    }

    /// Runs the program in the folder: its status, what it prints, what it says on standard error.
    fn run(&self, arguments: &str) -> (i32, String, String) {
        let mut command = cargo_bin_cmd!("tokosen");
        let output = command.current_dir(self.0.path()).args(arguments.split_whitespace()).output().unwrap();
        let text = |bytes: Vec<u8>| String::from_utf8(bytes).unwrap();
        (output.status.code().unwrap(), text(output.stdout), text(output.stderr))
    }

    /// The findings that `check --json` prints.
    fn findings(&self, arguments: &str) -> Vec<Value> {
        let (status, out, err) = self.run(&format!("check {arguments} --json"));
        assert_eq!(status, 0, "{err}");
        serde_json::from_str::<Value>(&out).unwrap()["findings"].as_array().unwrap().clone()
    }

    /// Their codes.
    fn codes(&self, arguments: &str) -> Vec<String> {
        self.findings(arguments).iter().map(|finding| finding["code"].as_str().unwrap().to_owned()).collect()
    }
}

/// Rows of a table in a GeoPackage, each as text.
fn rows(path: &Path, query: &str) -> Vec<Vec<String>> {
    let db = Connection::open(path).unwrap();
    let mut statement = db.prepare(query).unwrap();
    let count = statement.column_count();
    let text = |row: &rusqlite::Row<'_>, i: usize| match row.get_ref_unwrap(i) {
        rusqlite::types::ValueRef::Text(text) => String::from_utf8(text.to_vec()).unwrap(),
        rusqlite::types::ValueRef::Real(number) => number.to_string(),
        rusqlite::types::ValueRef::Integer(number) => number.to_string(),
        rusqlite::types::ValueRef::Blob(_) => "geometry".to_owned(),
        rusqlite::types::ValueRef::Null => "none".to_owned(),
    };
    let found = statement.query_map([], |row| Ok((0..count).map(|i| text(row, i)).collect())).unwrap();
    found.map(Result::unwrap).collect()
}

/// A hill with a crossing line, a line that is there twice and one that stutters.
fn faulty() -> Vec<Line> {
    let mut lines = hill();
    lines.push(lines[1].clone());
    let start = lines[2].1[0];
    lines[2].1.insert(1, start);
    lines.push((500.0, vec![[-130.0, 3.0], [-90.0, 3.0]]));
    lines
}

#[test]
fn a_clean_map_shows_nothing() {
    let folder = Folder::new();
    folder.put("hill.geojson", &hill());
    let (status, out, err) = folder.run("check hill.geojson --strict");
    assert_eq!((status, err.as_str()), (0, ""));
    assert!(out.contains("findings   0 errors, 0 warnings, 0 notes"), "{out}");
    assert!(out.contains("6 lines, 6 levels from 100 to 150 m, vertical interval 10 m"), "{out}");
    let (_, out, _) = folder.run("check hill.geojson --json");
    let told: Value = serde_json::from_str(&out).unwrap();
    assert_eq!(told["counts"], json!({ "error": 0, "warning": 0, "note": 0 }));
    assert_eq!(told["levels"], json!({ "lowest": 100.0, "highest": 150.0, "count": 6 }));
    assert_eq!((&told["interval"], &told["lines"]), (&json!(10.0), &json!(6)));
}

#[test]
fn findings_have_code_place_features_and_a_file() {
    let folder = Folder::new();
    folder.put("map.geojson", &faulty());
    let found = folder.findings("map.geojson");
    let of = |code: &str| found.iter().find(|f| f["code"] == code).unwrap_or_else(|| panic!("no {code}: {found:?}"));
    assert_eq!(of("repeated-point")["place"], json!([-80.0, -80.0]));
    assert_eq!(of("repeated-point")["severity"], "note");
    assert_eq!(of("levels-cross")["severity"], "error");
    for elevation in [100.0, 500.0] {
        let crossing =
            |f: &&Value| f["code"] == "levels-cross" && f["elevations"].as_array().unwrap().contains(&json!(elevation));
        assert!(found.iter().any(|f| crossing(&f)), "{elevation}: {found:?}");
    }
    assert!(of("duplicate-line")["features"].as_array().unwrap().contains(&json!(1)));

    let (status, out, err) = folder.run("check map.geojson -o findings.gpkg");
    assert_eq!(status, 0, "{err}");
    assert!(out.contains(&format!("written    findings.gpkg ({} findings)", found.len())), "{out}");
    let table = rows(&folder.path("findings.gpkg"), "SELECT geom, code, severity, message FROM findings");
    assert_eq!(table.len(), found.len());
    for (row, finding) in table.iter().zip(&found) {
        assert_eq!(
            row[1..],
            [&finding["code"], &finding["severity"], &finding["message"]].map(|v| v.as_str().unwrap().to_owned())
        );
        assert_eq!(row[0] == "none", finding["place"].is_null());
    }
    folder.run("check map.geojson -o findings.geojson");
    let text = fs::read_to_string(folder.path("findings.geojson")).unwrap();
    let written: Value = serde_json::from_str(&text).unwrap();
    assert_eq!(written["features"].as_array().unwrap().len(), found.len());
}

#[test]
fn findings_without_a_place_are_features_without_geometry() {
    let folder = Folder::new();
    let text = r#"{"type":"FeatureCollection","crs":null,"features":[
        {"type":"Feature","properties":{"elev":10},"geometry":{"type":"LineString","coordinates":[[0,0],[900,0],[900,900]]}},
        {"type":"Feature","properties":{"elev":20},"geometry":{"type":"LineString","coordinates":[[0,500],[400,500],[400,900]]}}]}"#;
    fs::write(folder.path("map.geojson"), text).unwrap();
    let (status, _, err) = folder.run("check map.geojson -o f.gpkg --strict");
    assert_eq!(status, 0, "an unknown system is a note: {err}");
    let table = rows(&folder.path("f.gpkg"), "SELECT code, geom FROM findings");
    assert_eq!(table, [["unknown-crs", "none"]]);
}

#[test]
fn strict_is_about_errors_and_warnings() {
    let folder = Folder::new();
    folder.put("map.geojson", &faulty());
    let (status, _, err) = folder.run("check map.geojson --strict -q");
    assert_eq!(status, 1);
    assert!(
        err.starts_with("error: map.geojson has ") && err.contains(" errors and warnings, and --strict allows none"),
        "{err}"
    );
    let mut lines = hill();
    let start = lines[2].1[0];
    lines[2].1.insert(1, start);
    folder.put("stutter.geojson", &lines);
    assert_eq!(folder.run("check stutter.geojson --strict").0, 0, "a note is nothing wrong");
    assert_eq!(folder.codes("stutter.geojson"), ["repeated-point"]);
}

#[test]
fn a_repaired_map_needs_no_repair() {
    let folder = Folder::new();
    folder.put("map.geojson", &faulty());
    let (status, out, err) = folder.run("check map.geojson --repair safe -o fixed.gpkg");
    assert_eq!(status, 0, "{err}");
    assert!(out.contains("written    fixed.gpkg") && out.contains("repairs)"), "{out}");
    let repaired = |arguments: &str| folder.findings(arguments).iter().filter(|f| f["repaired"] == true).count();
    assert!(repaired("map.geojson") >= 3);
    assert_eq!(repaired("fixed.gpkg"), 0);
    assert_eq!(folder.run("densify fixed.gpkg --repair none -i 5 -o out.gpkg").0, 0);
}

#[test]
fn without_repair_the_work_stops_where_lines_must_be_cut() {
    let folder = Folder::new();
    folder.put("map.geojson", &faulty());
    folder.put("hill.geojson", &hill());
    let (status, _, err) = folder.run("densify map.geojson --repair none -i 5 -o out.gpkg");
    assert_eq!(status, 1);
    assert!(err.contains("need repair") && err.contains("--repair safe"), "{err}");
    assert!(!folder.path("out.gpkg").exists());
    assert_eq!(folder.run("densify hill.geojson --repair none -i 5 -o out.gpkg").0, 0);
    assert_eq!(folder.codes("map.geojson --repair none"), folder.codes("map.geojson"));
}

#[test]
fn a_wrong_label_is_proposed_and_repaired() {
    let folder = Folder::new();
    let mut lines = hill();
    lines[2].0 = 210.0;
    folder.put("map.geojson", &lines);
    let found = folder.findings("map.geojson");
    assert_eq!(found.len(), 1, "{found:?}");
    assert_eq!((&found[0]["code"], &found[0]["features"]), (&json!("wrong-label"), &json!([2])));
    assert_eq!(found[0]["proposal"], json!({ "do": "relabel", "from": 210.0, "to": 120.0 }));
    let (status, out, err) = folder.run("check map.geojson --repair all -o fixed.gpkg");
    assert_eq!(status, 0, "{err}");
    assert!(out.contains("relabelled"), "{out}");
    assert_eq!(folder.codes("fixed.gpkg"), [""; 0]);
    let levels = rows(&folder.path("fixed.gpkg"), "SELECT elev FROM contours ORDER BY elev");
    assert_eq!(levels, [["100"], ["110"], ["120"], ["130"], ["140"], ["150"]]);
    // The other verbs mend it on the way.
    let (status, _, err) = folder.run("dem map.geojson --repair all --cell 5 -o dem.tif");
    assert_eq!(status, 0, "{err}");
    assert!(err.contains("elevations corrected: 1"), "{err}");
}

#[test]
fn a_map_of_one_level_is_told_with_all_else_that_is_wrong() {
    let folder = Folder::new();
    let mut lines = vec![ring(100.0, 60.0), ring(100.0, 20.0)];
    let first = lines[0].1[0];
    lines[0].1.insert(0, first);
    folder.put("map.geojson", &lines);
    assert_eq!(folder.codes("map.geojson"), ["too-few-levels", "repeated-point"]);
    let (status, out, err) = folder.run("check map.geojson -o findings.gpkg");
    assert_eq!(status, 0, "{err}");
    assert!(out.contains("all 2 contour lines have the elevation 100"), "{out}");
    assert_eq!(folder.run("check map.geojson --strict").0, 1);
    assert_eq!(folder.run("check map.geojson --repair safe -o fixed.gpkg").0, 0);
    assert_eq!(rows(&folder.path("fixed.gpkg"), "SELECT elev FROM contours"), [["100"], ["100"]]);
    let (status, _, err) = folder.run("dem map.geojson --cell 5 -o dem.tif");
    assert_eq!(status, 1, "{err}");
}

#[test]
fn wrong_usage_is_told() {
    let folder = Folder::new();
    folder.put("map.geojson", &hill());
    for (arguments, word) in [
        ("check map.geojson -o findings.shp", "findings are written as .gpkg, .geojson or .parquet"),
        ("check map.geojson --repair safe -o fixed.tif", "contours are written as"),
        ("check map.geojson --repair none -o fixed.gpkg", "changes nothing"),
        ("check map.geojson --to-crs EPSG:6668", "add -o FILE"),
        ("check map.geojson --repair much", "possible values: none, safe, all"),
    ] {
        let (status, _, err) = folder.run(arguments);
        assert_eq!(status, 2, "{arguments}: {err}");
        assert!(err.contains(word), "{arguments}: {err}");
    }
    let (status, _, err) = folder.run("check map.geojson --repair safe -o map.geojson");
    assert_ne!(status, 0, "{err}");
}

#[test]
fn contours_on_one_straight_line_have_no_ground() {
    let folder = Folder::new();
    let line = |x: f64| vec![[x, 5.0], [x + 10.0, 5.0]];
    folder.put("map.geojson", &[(10.0, line(0.0)), (20.0, line(20.0))]);
    let (status, _, err) = folder.run("dem map.geojson --cell 1 -o dem.tif");
    assert_eq!(status, 1, "{err}");
    assert!(err.contains("all points lie on one line"), "{err}");
}
