//! The program as its users meet it: what bad input and wrong usage say, and that good runs write what they should.

#![allow(clippy::unwrap_used, reason = "helpers of tests are tests too")]

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Output;

use assert_cmd::cargo::cargo_bin_cmd;
use rusqlite::Connection;

use crate::common;
use crate::running::part;

/// These tests.
struct Here;

type Folder = common::Folder<Here>;

/// Done, the input or the work failed, wrong usage.
const DONE: i32 = 0;
const FAILED: i32 = 1;
const USAGE: i32 = 2;

impl Folder {
    fn put(&self, name: &str, content: impl AsRef<[u8]>) -> &Self {
        fs::write(self.path(name), content).unwrap();
        self
    }

    /// Every file and folder below, hidden ones too, with its content.
    fn listing(&self) -> Vec<(PathBuf, Vec<u8>)> {
        let mut found = Vec::new();
        let mut folders = vec![self.0.path().to_owned()];
        while let Some(folder) = folders.pop() {
            for entry in fs::read_dir(&folder).unwrap() {
                let path = entry.unwrap().path();
                if path.is_dir() {
                    folders.push(path.clone());
                    found.push((path, Vec::new()));
                } else {
                    found.push((path.clone(), fs::read(&path).unwrap()));
                }
            }
        }
        found.sort();
        found
    }

    /// Runs the program in the folder.
    fn run(&self, arguments: &str) -> Output {
        let mut command = cargo_bin_cmd!("tokosen");
        command.current_dir(self.0.path()).args(arguments.split_whitespace());
        let output = command.output().unwrap();
        let text = stderr(&output);
        assert!(!text.contains("panicked"), "{arguments}: {text}");
        assert!(!text.contains(".tokosen-"), "{arguments}: {text}");
        output
    }

    /// Runs the program, which must fail with this status and a message that holds all words, and change nothing.
    fn fails(&self, arguments: &str, status: i32, words: &[&str]) {
        let before = self.listing();
        let output = self.run(arguments);
        let text = stderr(&output);
        assert_eq!(output.status.code(), Some(status), "{arguments}: {text}");
        assert!(text.starts_with("error: "), "{arguments}: {text}");
        for word in words {
            assert!(text.contains(word), "{arguments}: no {word:?} in {text}");
        }
        assert!(output.stdout.is_empty(), "{arguments}: {}", String::from_utf8_lossy(&output.stdout));
        assert!(self.listing() == before, "{arguments}: the folder is not as it was");
    }

    /// Runs the program, which must succeed and leave no hidden folder; gives its output and its messages.
    fn succeeds(&self, arguments: &str) -> (String, String) {
        let output = self.run(arguments);
        assert_eq!(output.status.code(), Some(DONE), "{arguments}: {}", stderr(&output));
        let hidden = |path: &Path| path.file_name().unwrap().to_string_lossy().starts_with('.');
        assert!(!self.listing().iter().any(|(path, _)| hidden(path)), "{arguments}: something hidden is left");
        (String::from_utf8(output.stdout.clone()).unwrap(), stderr(&output))
    }

    fn lines_of(&self, name: &str) -> Vec<Line> {
        lines(&serde_json::from_slice(&fs::read(self.path(name)).unwrap()).unwrap())
    }
}

fn stderr(output: &Output) -> String {
    String::from_utf8(output.stderr.clone()).unwrap()
}

/// Elevation, source and vertices of a line that was written.
type Line = (f64, String, Vec<[f64; 3]>);

fn lines(file: &serde_json::Value) -> Vec<Line> {
    let line = |feature: &serde_json::Value| {
        let points = serde_json::from_value(feature["geometry"]["coordinates"].clone()).unwrap();
        let properties = &feature["properties"];
        (properties["elev"].as_f64().unwrap(), properties["source"].as_str().unwrap().to_owned(), points)
    };
    file["features"].as_array().unwrap().iter().map(line).collect()
}

fn sample(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("samples").join(name)
}

/// A file of contours in a plane system. `lines`: the elevation as it stands in the file, and the vertices.
fn contours(lines: &[(&str, Vec<[f64; 2]>)]) -> String {
    let feature = |(elevation, points): &(&str, Vec<[f64; 2]>)| {
        let points = serde_json::to_string(points).unwrap();
        format!(
            r#"{{"type":"Feature","properties":{{"elev":{elevation},"name":"a"}},
                "geometry":{{"type":"LineString","coordinates":{points}}}}}"#
        )
    };
    let features: Vec<String> = lines.iter().map(feature).collect();
    format!(
        r#"{{"type":"FeatureCollection","crs":{{"type":"name","properties":{{"name":"EPSG:6677"}}}},"features":[{}]}}"#,
        features.join(",")
    )
}

/// A square ring around (1000, 2000).
fn ring(half: f64) -> Vec<[f64; 2]> {
    [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0), (-1.0, -1.0)]
        .map(|(x, y)| [1000.0 + x * half, 2000.0 + y * half])
        .to_vec()
}

/// A hill of three levels.
fn hill() -> String {
    contours(&[("10", ring(60.0)), ("20", ring(40.0)), ("30", ring(20.0))])
}

/// A folder with the hill as `hill.geojson`.
fn with_hill() -> Folder {
    let folder = Folder::new();
    folder.put("hill.geojson", hill());
    folder
}

/// A GeoPackage with a layer of polygons only.
fn polygons(path: &Path) {
    let db = Connection::open(path).unwrap();
    db.execute_batch(
        "CREATE TABLE gpkg_geometry_columns (table_name, column_name, geometry_type_name, srs_id, z, m);
         INSERT INTO gpkg_geometry_columns VALUES ('houses', 'geom', 'POLYGON', -1, 0, 0);
         CREATE TABLE houses (fid INTEGER PRIMARY KEY, geom BLOB);",
    )
    .unwrap();
}

#[test]
fn files_that_hold_no_contours() {
    let folder = Folder::new();
    let noise: Vec<u8> = (0..5000_u32).map(|i| (i.wrapping_mul(2_654_435_761) >> 24) as u8).collect();
    folder.put("empty.geojson", "").put("empty.gpkg", "").put("empty.shp", "").put("noise.geojson", &noise);
    folder
        .put("noise.zip", &noise)
        .put("noise.xml", &noise)
        .put("noise.gpkg", &noise)
        .put("noise.shp", &noise)
        .put("text.txt", "contours");
    folder.put("picture.gpkg", fs::read(sample("shapes.png")).unwrap());
    folder.put("half.geojson", &hill()[..400]).put("other.geojson", r#"{"type":"Topology"}"#);
    folder.put("points.geojson", r#"{"type":"Point","coordinates":[1000,2000]}"#);
    polygons(&folder.path("houses.gpkg"));
    for (name, words) in [
        ("empty.geojson", "the file is empty; copy or download it again"),
        ("empty.gpkg", "the file is empty"),
        ("empty.shp", "the file is empty"),
        ("noise.geojson", "is not text"),
        ("noise.gpkg", "not a GeoPackage"),
        ("noise.shp", "not a shapefile"),
        ("picture.gpkg", "not a GeoPackage"),
        ("half.geojson", "not complete"),
        ("other.geojson", "not GeoJSON"),
        ("points.geojson", "there is no line in it (found: 1 points)"),
        ("houses.gpkg", "there is no layer of lines; its layers are \"houses\""),
        ("text.txt", "known are .geojson"),
        ("missing.gpkg", "cannot read"),
        ("missing.gpkg", "check the name and the folder"),
        (".", "is a folder without files of 基盤地図情報"),
        ("noise.zip", "not a zip archive"),
        ("noise.xml", "noise.xml"),
    ] {
        folder.fails(&format!("densify {name} -i 5 -o out.gpkg"), FAILED, &[name, words]);
        folder.fails(&format!("dem {name} --cell 5 -o out.tif"), FAILED, &[name, words]);
    }
}

#[test]
fn what_was_left_out_is_told_even_when_the_work_fails() {
    let folder = Folder::new();
    let line = |x: u32, elev: &str| {
        let points = format!("[[500{x},600],[510{x},700],[520{x},600]]");
        let geometry = format!(r#"{{"type":"LineString","coordinates":{points}}}"#);
        format!(r#"{{"type":"Feature","properties":{{"elev":{elev}}},"geometry":{geometry}}}"#)
    };
    let features = [line(1, "10"), line(2, "null")].join(",");
    folder.put("half.geojson", format!(r#"{{"type":"FeatureCollection","features":[{features}]}}"#));
    let output = folder.run("densify half.geojson -i 2 -o out.gpkg");
    assert_eq!(output.status.code(), Some(FAILED));
    let text = stderr(&output);
    assert!(
        text.contains("features without an elevation left out: 1") && text.contains("one contour line only"),
        "{text}"
    );
}

#[test]
fn elevations_that_are_none() {
    let folder = Folder::new();
    let two = |a: &str, b: &str| contours(&[(a, ring(60.0)), (b, ring(40.0))]);
    folder.put("none.geojson", two("null", "null")).put("text.geojson", two("10", "\"high\""));
    folder.put("nan.geojson", two("\"NaN\"", "\"nan\"")).put("one.geojson", contours(&[("10", ring(60.0))]));
    folder.put("flat.geojson", two("10", "10")).put("unknown.geojson", hill().replace("elev", "thing"));
    folder.put("infinite.geojson", two("\"inf\"", "\"-inf\""));
    for (name, words) in [
        ("none.geojson", "always empty"),
        ("text.geojson", "feature 1: the field \"elev\" holds \"high\", which is not a number"),
        ("nan.geojson", "-a/--elevation-field"),
        ("infinite.geojson", "-a/--elevation-field"),
        ("one.geojson", "one.geojson: there is one contour line only (elevation 10 m)"),
        ("flat.geojson", "flat.geojson: all 2 contour lines have the elevation 10"),
        ("unknown.geojson", "its fields are thing (such as 10), name (such as \"a\"); choose one with -a"),
    ] {
        folder.fails(&format!("densify {name} -i 5 -o out.gpkg"), FAILED, &[words]);
    }
    folder.fails("densify none.geojson -a elev -i 5 -o out.gpkg", FAILED, &["no line has an elevation", "is empty"]);
    folder.fails("densify nan.geojson -a elev -i 5 -o out.gpkg", FAILED, &["no line has an elevation", "is NaN"]);
    folder.fails(
        "densify text.geojson -a ELEVATION -i 5 -o out.gpkg",
        FAILED,
        &["no field \"ELEVATION\"", "elev (such"],
    );
    folder.fails("densify text.geojson --layer roads -i 5 -o out.gpkg", FAILED, &["there is no layer \"roads\""]);
    let gpkg = sample("caryville_20m.gpkg");
    folder.fails(
        &format!("densify {} --layer roads -i 5 -o out.gpkg", gpkg.display()),
        FAILED,
        &["there is no layer \"roads\"; its layers are \"contours\""],
    );
    // One line without an elevation is left out, the others go on.
    folder.put("some.geojson", contours(&[("10", ring(60.0)), ("\"NaN\"", ring(50.0)), ("20", ring(40.0))]));
    let (_, notes) = folder.succeeds("densify some.geojson -i 5 -o some_5m.geojson");
    assert!(
        notes.contains("features without an elevation left out: 1\n    line 1 left out: its field \"elev\" is NaN at 950.000 1950.000"),
        "{notes}"
    );
}

#[test]
fn degrees_of_no_known_system_are_refused() {
    let folder = Folder::new();
    let degrees = |half: f64| ring(half).iter().map(|[x, y]| [x / 1e5 + 138.0, y / 1e5 + 36.0]).collect::<Vec<_>>();
    let file = contours(&[("10", degrees(60.0)), ("20", degrees(40.0))]);
    folder.put("unknown.geojson", file.replace("EPSG:6677", "my own grid"));
    folder.fails(
        "densify unknown.geojson -i 5 -o out.gpkg",
        FAILED,
        &["unknown.geojson", "look like degrees", "--crs EPSG:4326"],
    );
    folder.succeeds("densify unknown.geojson -i 5 -o out.gpkg --crs EPSG:6668");
    for flag in ["--crs EPSG:1", "--crs here", "--work-crs EPSG:6668", "--work-crs EPSG:2229", "--to-crs 0"] {
        folder.fails(&format!("densify unknown.geojson -i 5 -o out2.gpkg {flag}"), USAGE, &["-crs"]);
    }
}

#[test]
fn outputs_that_cannot_be_written() {
    let folder = with_hill();
    folder.put("hill_5m.geojson", hill());
    fs::create_dir(folder.path("sub.gpkg")).unwrap();
    for (arguments, status, words) in [
        ("densify hill.geojson -i 5 -o no/such/out.gpkg", FAILED, "cannot create a file in no/such"),
        ("densify hill.geojson -i 5 -o no/such/out.gpkg", FAILED, "make its folder first"),
        ("densify hill.geojson -i 5 -o out.gpkg --dem no/d.tif --cell 5", FAILED, "cannot create a file in no"),
        ("densify hill.geojson -i 5 -o out.gpkg --preview no/p.png", FAILED, "cannot create a file in no"),
        ("dem hill.geojson --cell 5 -o no/d.tif", FAILED, "cannot create a file in no"),
        ("densify hill.geojson -i 5 -o sub.gpkg", FAILED, "is a folder"),
        ("densify hill.geojson -i 5 -o hill.geojson", USAGE, "hill.geojson is an input"),
        ("densify hill.geojson -i 5 -o ./hill.geojson", USAGE, "hill.geojson is an input"),
        ("densify hill_5m.geojson -i 5,2 -o hill.geojson", USAGE, "hill_5m.geojson is an input"),
        ("densify hill.geojson -i 5 -o hill_5m.geojson --frame hill_5m.geojson", USAGE, "hill_5m.geojson is an input"),
        ("dem hill.geojson --cell 5 -o p.png --preview ./p.png", USAGE, "p.png is the name of two outputs"),
        ("densify hill.geojson -i 5,5.0 -o out.gpkg", USAGE, "two layers would be called \"contours_5m\""),
        ("densify hill.geojson -i 5 -o out.gml", USAGE, ".geojson, .gpkg, .fgb, .parquet, .dxf, .shp, .kml or .kmz"),
        ("densify hill.geojson -i 5 -o out", USAGE, ".geojson, .gpkg, .fgb, .parquet, .dxf, .shp, .kml or .kmz"),
        ("densify hill.geojson -i 5 -o out.gpkg --dem d.jpg --cell 5", USAGE, ".tif, .tiff, .exr, .png"),
        ("dem hill.geojson --cell 5 -o d.xyzt", USAGE, ".tif, .tiff, .exr, .png"),
        ("dem hill.geojson --cell 5 -o d.tif --preview p.jpg", USAGE, "written as .png"),
    ] {
        folder.fails(arguments, status, &[words]);
    }
}

#[cfg(unix)]
#[test]
fn a_folder_that_must_not_be_written_to() {
    use std::os::unix::fs::PermissionsExt;
    let folder = with_hill();
    let locked = folder.path("locked");
    fs::create_dir(&locked).unwrap();
    fs::set_permissions(&locked, fs::Permissions::from_mode(0o555)).unwrap();
    // The administrator may write everywhere.
    if fs::write(locked.join("probe"), "").is_err() {
        folder.fails("densify hill.geojson -i 5 -o locked/out.gpkg", FAILED, &["cannot create a file in locked"]);
    }
}

#[test]
fn numbers_out_of_range() {
    let folder = with_hill();
    for (arguments, words) in [
        ("densify hill.geojson -i 0 -o out.gpkg", "--interval is 0, it must be more than 0"),
        ("densify hill.geojson -i -5 -o out.gpkg", "--interval is -5, it must be more than 0"),
        ("densify hill.geojson -i 5,nan -o out.gpkg", "--interval is NaN, it must be more than 0"),
        ("densify hill.geojson -i 1e-9 -o out.gpkg", "choose a larger one"),
        ("densify hill.geojson -i five -o out.gpkg", "invalid value 'five'"),
        ("densify hill.geojson -o out.gpkg", "--interval"),
        ("densify hill.geojson -i 5", "--output"),
        ("densify hill.geojson -i 5 --levels 12 -o out.gpkg", "cannot be used with"),
        ("densify hill.geojson --levels nan -o out.gpkg", "NaN is no elevation"),
        ("densify hill.geojson -i 5 --base-level inf -o out.gpkg", "inf is no elevation"),
        ("dem hill.geojson --cell 5 --frame hull --no-extend -o out.tif", "--no-extend is for a polygon"),
        ("densify hill.geojson --levels 12 --base-level 2 -o out.gpkg", "cannot be used with"),
        (
            "densify hill.geojson -i 5 -o out.gpkg --dem d.tif",
            "needs --cell SIZE, --cell-degrees SIZE or --like RASTER",
        ),
        ("densify hill.geojson -i 5 -o out.gpkg --cell 5", "needs --dem FILE"),
        ("dem hill.geojson -o d.tif", "needs --cell SIZE, --cell-degrees SIZE or --like RASTER"),
        ("dem hill.geojson --cell 0 -o d.tif", "--cell is 0, it must be more than 0"),
        ("dem hill.geojson --cell -5 -o d.tif", "--cell is -5, it must be more than 0"),
        ("dem hill.geojson --cell inf -o d.tif", "--cell is inf, it must be more than 0"),
        ("dem hill.geojson --cell 1e-5 -o d.tif", "choose a larger cell"),
        ("dem hill.geojson --cell 5 --like d.tif -o e.tif", "cannot be used with"),
        ("dem hill.geojson --cell 5 --snap -1 -o d.tif", "--snap is -1, it must be 0 or more"),
        ("dem hill.geojson --cell 5 --sample 0 -o d.tif", "more than 0 and less than 1"),
        ("dem hill.geojson --cell 5 --sample 1 -o d.tif", "more than 0 and less than 1"),
        ("mesh hill.geojson --sample -0.5 -o d.ply", "more than 0 and less than 1"),
        ("densify hill.geojson -i 5 --sample nan -o out.gpkg", "more than 0 and less than 1"),
        ("densify hill.geojson -i 5 --sample 1e-9 -o out.gpkg", "take a larger ratio"),
        ("dem hill.geojson --cell 5 --resolution -1 -o d.tif", "w is -1, it must be 0 or more"),
        (
            "dem hill.geojson --cell 5 --surface linear --tension 1 -o d.tif",
            "--tension has no meaning for --surface linear",
        ),
        ("mesh hill.geojson --surface skeleton --noise 0 -o d.ply", "--noise has no meaning for --surface skeleton"),
        ("densify hill.geojson -i 5 --surface linear --resolution 2 -o out.gpkg", "--resolution has no meaning"),
        ("dem hill.geojson --cell 5 --threads 0 -o d.tif", "0 is not in 1..=1024"),
        ("dem hill.geojson --cell 5 --surface cubic -o d.tif", "invalid value 'cubic'"),
        ("densify", "required"),
        ("sharpen hill.geojson", "unrecognized subcommand"),
    ] {
        folder.fails(arguments, USAGE, &[words]);
    }
}

#[test]
fn rasters_whose_grid_cannot_be_taken() {
    let folder = with_hill();
    folder.put("notes.tif", "no raster").put("empty.tif", "");
    folder.put("elsewhere.geojson", hill().replace("EPSG:6677", "EPSG:26718"));
    folder.succeeds("dem elsewhere.geojson --cell 5 -o elsewhere.tif -q");
    folder.succeeds("dem hill.geojson --cell 5 -o like.tif -q");
    for (raster, words) in [
        ("notes.tif", "is not a TIFF file"),
        ("empty.tif", "is not a TIFF file"),
        ("missing.tif", "cannot read"),
        ("hill.geojson", "not a height map format"),
        ("elsewhere.tif", "the shift from the datum of NAD27 / UTM zone 18N (EPSG:26718) needs a grid file"),
    ] {
        folder.fails(&format!("dem hill.geojson --like {raster} -o d.tif"), FAILED, &[raster, words]);
        folder.fails(&format!("densify hill.geojson -i 5 -o o.gpkg --dem d.tif --like {raster}"), FAILED, &[words]);
    }
    // A grid that lies beside the contours would give a height map of nothing.
    fs::write(folder.path("beside.asc"), "ncols 2\nnrows 2\nxllcorner 90000\nyllcorner 0\ncellsize 5\n1 2\n3 4\n")
        .unwrap();
    folder.fails("dem hill.geojson --like beside.asc -o d.tif", FAILED, &["beside.asc", "do they overlap"]);
    folder.fails("densify hill.geojson -i 5 -o o.gpkg --dem d.tif --like beside.asc", FAILED, &["do they overlap"]);
    assert!(!folder.path("o.gpkg").exists() && !folder.path("d.tif").exists());
    folder.fails("densify hill.geojson -i 5 -o o.gpkg --png-encoding gsi", USAGE, &["--dem FILE"]);
    folder.fails("dem hill.geojson --like like.tif -o like.tif", USAGE, &["like.tif is an input"]);
    folder.succeeds("dem hill.geojson --like like.tif -o same.tif");
    assert_eq!(fs::read(folder.path("same.tif")).unwrap(), fs::read(folder.path("like.tif")).unwrap());
}

#[test]
fn frames() {
    let folder = with_hill();
    let area = |points: &[[f64; 2]]| {
        contours(&[("0", Vec::new())])
            .replace("LineString", "Polygon")
            .replace("\"coordinates\":[]", &format!("\"coordinates\":[{}]", serde_json::to_string(points).unwrap()))
    };
    let square = area(&ring(50.0));
    folder.put("half.geojson", &square).put("far.geojson", area(&ring(50.0).map_by(5000.0)));
    folder.put("bow.geojson", area(&[[0.0, 0.0], [9.0, 9.0], [9.0, 0.0], [0.0, 9.0], [0.0, 0.0]]));
    folder
        .put("elsewhere.geojson", square.replace("6677", "26718"))
        .put("zone.geojson", square.replace("6677", "6678"));
    for (frame, words) in [
        ("hill.geojson", "there is no polygon in it (found: 3 lines)"),
        ("bow.geojson", "crosses itself at 4.500 4.500"),
        ("elsewhere.geojson", "the shift from the datum of NAD27 / UTM zone 18N (EPSG:26718) needs a grid file"),
        ("zone.geojson", "there is no contour line inside the frame polygon"),
        ("far.geojson", "there is no contour line inside the frame polygon"),
        ("missing.geojson", "cannot read"),
        ("convex", "extension does not name a vector format"),
    ] {
        folder.fails(&format!("densify hill.geojson -i 5 -o o.gpkg --frame {frame}"), FAILED, &[words]);
    }
    let (told, _) = folder.succeeds("densify hill.geojson -i 5 -o o.geojson --frame half.geojson");
    assert!(told.contains("contours   2 lines"), "{told}");
    for (_, _, points) in folder.lines_of("o.geojson") {
        assert!(points.iter().all(|p| (p[0] - 1000.0).abs() <= 50.0 && (p[1] - 2000.0).abs() <= 50.0));
    }
}

/// Moves points to the east.
trait MapBy {
    fn map_by(self, east: f64) -> Self;
}

impl MapBy for Vec<[f64; 2]> {
    fn map_by(self, east: f64) -> Self {
        self.into_iter().map(|[x, y]| [x + east, y]).collect()
    }
}

#[test]
fn several_intervals_are_layers_or_files() {
    let folder = with_hill();
    let (told, _) = folder.succeeds("densify hill.geojson -i 5,2,1 -o dense.gpkg");
    for layer in ["contours_5m", "contours_2m", "contours_1m"] {
        assert!(told.contains(&format!("written    dense.gpkg, layer {layer} (3 input lines, ")), "{told}");
    }
    let db = Connection::open(folder.path("dense.gpkg")).unwrap();
    let count = |what: &str| -> i64 { db.query_row(&format!("SELECT count({what}"), [], |row| row.get(0)).unwrap() };
    for (layer, levels) in [("contours_5m", 5), ("contours_2m", 11), ("contours_1m", 21)] {
        assert_eq!(count(&format!("DISTINCT elev) FROM {layer} WHERE elev <= 30")), levels, "{layer}");
    }
    let lines = count("*) FROM contours_5m");
    drop(db);

    for extension in ["geojson", "shp"] {
        let (told, _) = folder.succeeds(&format!("densify hill.geojson -i 5,2,1 -o dense.{extension}"));
        for step in [5, 2, 1] {
            let name = format!("dense_{step}m.{extension}");
            assert!(folder.path(&name).is_file(), "{name}");
            assert!(told.contains(&name), "{told}");
        }
        assert!(!folder.path(&format!("dense.{extension}")).exists());
    }
    assert!(folder.path("dense_2m.dbf").is_file() && folder.path("dense_2m.prj").is_file());
    assert_eq!(folder.lines_of("dense_5m.geojson").len() as i64, lines);

    // What was written is read again, from every format.
    for name in ["dense_5m.shp", "dense_5m.geojson"] {
        folder.succeeds(&format!("densify {name} -i 5 -o again.geojson"));
        assert_eq!(folder.lines_of("again.geojson").len() as i64, lines, "{name}");
    }
    folder.fails("densify dense.gpkg -i 1 -o again.gpkg", FAILED, &["several layers of lines", "--layer"]);
    folder.succeeds("densify dense.gpkg --layer contours_5m -i 5 -o again.gpkg");
}

#[test]
fn input_lines_come_out_bit_for_bit() {
    let folder = Folder::new();
    let path = sample("fig1e_three_branches.geojson");
    folder.succeeds(&format!("densify {} -i 2 -o out.geojson", path.display()));
    let file: serde_json::Value = serde_json::from_slice(&fs::read(&path).unwrap()).unwrap();
    let written = folder.lines_of("out.geojson");
    let flat = |points: &[[f64; 3]]| points.iter().map(|p| [p[0].to_bits(), p[1].to_bits()]).collect::<Vec<_>>();
    let kept: Vec<_> = written.iter().filter(|l| l.1 == "input").map(|l| (l.0, flat(&l.2))).collect();
    let features = file["features"].as_array().unwrap();
    assert_eq!(kept.len(), features.len());
    for feature in features {
        let points: Vec<[f64; 2]> = serde_json::from_value(feature["geometry"]["coordinates"].clone()).unwrap();
        let mut points: Vec<[u64; 2]> = points.iter().map(|p| p.map(f64::to_bits)).collect();
        // A ring may start elsewhere and run the other way.
        points.pop();
        points.sort_unstable();
        let elevation = feature["properties"]["elev"].as_f64().unwrap();
        let same = |(z, line): &(f64, Vec<[u64; 2]>)| {
            let mut line = line[1..].to_vec();
            line.sort_unstable();
            *z == elevation && line == points
        };
        assert!(kept.iter().any(same), "a line of {elevation} is missing");
    }
}

#[test]
fn levels_and_base() {
    let folder = with_hill();
    let levels = |arguments: &str| {
        folder.succeeds(&format!("densify hill.geojson {arguments} -o out.geojson"));
        let mut levels: Vec<f64> =
            folder.lines_of("out.geojson").into_iter().filter(|l| l.1 == "interpolated").map(|l| l.0).collect();
        levels.dedup();
        // How high the top is, is no matter here.
        levels.retain(|level| *level < 30.0);
        levels
    };
    assert_eq!(levels("--levels 12.5,13,25,-4,20"), [12.5, 13.0, 25.0]);
    assert_eq!(levels("-i 5"), [15.0, 25.0]);
    assert_eq!(levels("-i 5 --base-level 2"), [12.0, 17.0, 22.0, 27.0]);
    assert_eq!(levels("-i 5 --base -1.5"), [13.5, 18.5, 23.5, 28.5]);
}

#[test]
fn what_is_told_and_what_is_not() {
    let folder = with_hill();
    let (told, notes) = folder.succeeds("densify hill.geojson -i 5 -o out.gpkg --dem d.tif --cell 5 --preview p.png");
    for word in
        ["input      hill.geojson", "vertical interval 10 m", "written    d.tif", "written    p.png", "findings   none"]
    {
        assert!(told.contains(word), "no {word:?} in {told}");
    }
    assert!(notes.is_empty(), "{notes}");
    // No progress bars where nobody watches.
    assert!(!told.contains(['\u{1b}', '\r', '\u{8}']), "{told:?}");
    assert!(fs::read(folder.path("p.png")).unwrap().starts_with(b"\x89PNG"));

    folder.put("crossed.geojson", crossed());
    for arguments in ["densify hill.geojson -i 5 -o out.gpkg -q", "--quiet dem crossed.geojson --cell 5 -o d.tif"] {
        assert_eq!(folder.succeeds(arguments), (String::new(), String::new()), "{arguments}");
    }
    folder.fails("densify hill.geojson -i 5 -o out.gpkg -q --dem no/d.tif --cell 5", FAILED, &["cannot create"]);
}

/// The hill with a line through its ring of 20, from (1040, 2005) on.
fn crossed() -> String {
    contours(&[
        ("10", ring(60.0)),
        ("20", ring(40.0)),
        ("30", ring(20.0)),
        ("15", vec![[1050.0, 2005.0], [1045.0, 2005.0], [1035.0, 2005.0], [1030.0, 2005.0]]),
    ])
}

#[test]
fn findings_are_named_and_end_the_work_only_if_they_should() {
    let folder = Folder::new();
    folder.put("crossed.geojson", crossed());
    let (told, notes) = folder.succeeds("densify crossed.geojson -i 5 -o out.gpkg");
    assert!(notes.contains("lines of different level that cross or touch: 1"), "{notes}");
    assert!(notes.contains("at 1040.000 2005.000"), "{notes}");
    assert!(!told.contains("findings   none"), "{told}");
    fs::remove_file(folder.path("out.gpkg")).unwrap();

    let before = folder.listing();
    let output = folder.run("densify crossed.geojson -i 5 -o out.gpkg --strict");
    assert_eq!(output.status.code(), Some(FAILED));
    let text = stderr(&output);
    assert!(text.contains("at 1040.000 2005.000"), "{text}");
    assert!(text.contains("error: crossed.geojson has 1 error or warning, and --strict allows none"), "{text}");
    assert!(folder.listing() == before);
}

#[test]
fn the_number_of_threads_changes_no_byte() {
    let folder = Folder::new();
    let input = sample("fig5cd_three_branches_basin.geojson");
    for threads in [1, 2] {
        fs::create_dir(folder.path(&threads.to_string())).unwrap();
        let input = input.display();
        let run = |what: &str| folder.succeeds(&format!("{what} -q --threads {threads}"));
        run(&format!(
            "densify {input} -i 5,1 -o {threads}/o.gpkg --dem {threads}/d.tif --cell 5 --preview {threads}/p.png"
        ));
        run(&format!("densify {input} -i 2 -o {threads}/o.geojson --dem {threads}/d.exr --cell 5"));
        run(&format!("densify {input} -i 2 -o {threads}/o.shp --dem {threads}/d.png --cell 5"));
    }
    let of = |threads: &str| {
        let inside: Vec<(PathBuf, Vec<u8>)> = folder.listing();
        let folder = folder.path(threads);
        let inside = inside.into_iter().filter(|(path, _)| path.starts_with(&folder) && *path != folder);
        inside.map(|(path, bytes)| (path.file_name().unwrap().to_owned(), bytes)).collect::<Vec<_>>()
    };
    let (one, two) = (of("1"), of("2"));
    assert!(one.len() >= 14, "{:?}", one.iter().map(|f| &f.0).collect::<Vec<_>>());
    for (a, b) in one.iter().zip(&two) {
        assert!(a == b, "{:?} and {:?} differ", a.0, b.0);
    }
    assert_eq!(one.len(), two.len());
}

#[test]
fn an_older_output_is_replaced_only_by_a_whole_one() {
    let folder = with_hill();
    folder.put("out.gpkg", "older").put("flat.geojson", contours(&[("10", ring(60.0))]));
    folder.fails("densify flat.geojson -i 5 -o out.gpkg --overwrite", FAILED, &["one contour line only"]);
    assert_eq!(fs::read(folder.path("out.gpkg")).unwrap(), b"older");
    folder.succeeds("densify hill.geojson -i 5 -o out.gpkg --overwrite");
    assert!(fs::read(folder.path("out.gpkg")).unwrap().starts_with(b"SQLite format 3"));
}

#[cfg(target_os = "linux")]
#[test]
fn help_and_version_are_there_and_a_closed_pipe_is_no_error() {
    let folder = with_hill();
    let (told, _) = folder.succeeds("--help");
    assert!(told.contains("densify") && told.contains("dem"));
    let (told, _) = folder.succeeds("densify --help");
    assert!(told.contains("--interval") && told.contains("Examples:"));
    assert!(folder.succeeds("--version").0.starts_with("tokosen "));
    let mut command = std::process::Command::new(assert_cmd::cargo::cargo_bin!("tokosen"));
    command
        .current_dir(folder.0.path())
        .args(["densify", "hill.geojson", "-i", "5", "-o", "out.gpkg"])
        .stdout(std::process::Stdio::piped());
    let mut child = command.spawn().unwrap();
    drop(child.stdout.take());
    assert_eq!(child.wait().unwrap().code(), Some(DONE));
}

#[test]
fn sampling_adds_vertices_and_keeps_the_input() {
    let folder = with_hill();
    folder.succeeds("densify hill.geojson -i 5 -o plain.geojson");
    let (said, _) = folder.succeeds("densify hill.geojson -i 5 --sample 0.1 -o sampled.geojson");
    assert!(said.contains("sampled    "), "{said}");
    let input = |name: &str| folder.lines_of(name).into_iter().filter(|l| l.1 == "input").collect::<Vec<_>>();
    let (plain, sampled) = (input("plain.geojson"), input("sampled.geojson"));
    assert_eq!(plain.len(), sampled.len());
    for (old, new) in plain.iter().zip(&sampled) {
        assert_eq!(old.0, new.0);
        assert!(new.2.len() > 2 * old.2.len());
        assert!(old.2.iter().all(|p| new.2.contains(p)), "a vertex is gone");
    }
    let (said, _) = folder.succeeds("densify hill.geojson -i 5 --fit 1 --sample 0.2 -o both.geojson");
    assert!(said.contains("fitted     ") && said.contains("sampled    "), "{said}");
}

/// Properties of the areas in a GeoJSON file.
fn areas_of(folder: &Folder, name: &str) -> Vec<serde_json::Value> {
    let file: serde_json::Value = serde_json::from_slice(&fs::read(folder.path(name)).unwrap()).unwrap();
    let features = file["features"].as_array().unwrap();
    assert!(features.iter().all(|f| f["geometry"]["type"] == "Polygon"));
    features.iter().map(|f| f["properties"].clone()).collect()
}

#[test]
fn regions_are_written_in_every_format_with_a_picture() {
    let folder = Folder::new();
    let input = sample("fig1f_nested.geojson").display().to_string();
    let (said, told) = folder.succeeds(&format!("regions {input} -o areas.geojson --preview look.png"));
    assert!(told.is_empty(), "{told}");
    for words in
        ["8 sub-domains: 1 peak, 2 bottom of a basin, 1 tableland, 2 basin, 1 ridge-peak, 1 branching", "nesting    3"]
    {
        assert!(said.contains(words), "no {words:?} in {said}");
    }
    let areas = areas_of(&folder, "areas.geojson");
    assert_eq!(areas.len(), 8);
    let branching = areas.iter().find(|a| a["class"] == "branching").unwrap();
    assert_eq!(branching["mixture"], "tableland 2, ridge-peak 1");
    assert_eq!((&branching["parent"], &branching["n_ib"], &branching["depth"]), (&().into(), &3.into(), &0.into()));
    let peak = areas.iter().find(|a| a["class"] == "peak").unwrap();
    assert_eq!((peak["band_lo"].as_f64(), peak["band_hi"].as_f64()), (Some(120.0), Some(130.0)));
    let around = &areas[peak["parent"].as_u64().unwrap() as usize];
    assert_eq!((&around["class"], &around["parent"]), (&"tableland".into(), &branching["id"]));
    assert!(areas.iter().all(|a| a["is_open"] == false && a["area"].as_f64().unwrap() > 0.0));
    assert!(fs::read(folder.path("look.png")).unwrap().starts_with(b"\x89PNG"));

    folder.succeeds(&format!("regions {input} -o areas.shp"));
    folder.succeeds(&format!("regions {input} -o areas.gpkg"));
    let db = Connection::open(folder.path("areas.gpkg")).unwrap();
    let count = "SELECT count(*) FROM regions WHERE class = 'bottom of a basin' AND parent IS NOT NULL";
    assert_eq!(db.query_row(count, [], |row| row.get::<_, i64>(0)).unwrap(), 2);
    folder.fails(&format!("regions {input} -o areas.tif"), USAGE, &["areas are written as"]);
    folder.fails("regions areas.shp -o areas.shp", USAGE, &["is an input"]);
}

#[test]
fn depression_marks_of_other_programs_are_checked_and_our_own_agree() {
    let folder = Folder::new();
    folder.put("in.gpkg", part()).succeeds("densify in.gpkg -i 10 -o dense.geojson");
    let (said, told) = folder.succeeds("regions dense.geojson -o areas.geojson");
    assert!(said.contains("findings   none\n") && told.is_empty(), "{said}{told}");

    let square = |z: f64, h: f64, kind: &str| {
        format!(
            r#"{{"type":"Feature","properties":{{"alti":{z},"type":"{kind}"}},"geometry":{{"type":"LineString","coordinates":[[{0},{0}],[{h},{0}],[{h},{h}],[{0},{h}],[{0},{0}]]}}}}"#,
            -h
        )
    };
    let (plain, hollow) = ("一般等高線", "凹地等高線");
    let crs = r#""crs":{"type":"name","properties":{"name":"urn:ogc:def:crs:EPSG::6677"}}"#;
    let file = |third: &str, second: &str| {
        let lines = [square(100.0, 900.0, plain), square(110.0, 800.0, second), square(110.0, 500.0, third)];
        format!(r#"{{"type":"FeatureCollection",{crs},"features":[{}]}}"#, lines.join(","))
    };
    folder.put("right.geojson", file(hollow, plain)).put("wrong.geojson", file(hollow, hollow));
    let (_, told) = folder.succeeds("regions right.geojson -o areas.geojson");
    assert!(told.is_empty(), "{told}");
    let (_, told) = folder.succeeds("regions wrong.geojson -o areas.geojson");
    assert!(told.contains("depression marks") && told.contains("feature 1) is marked"), "{told}");
}

/// Polygons of water in the contours' system; the attribute as it stands in the file.
fn lakes(areas: &[(&str, Vec<[f64; 2]>)]) -> String {
    let feature = |(attributes, ring): &(&str, Vec<[f64; 2]>)| {
        let ring = serde_json::to_string(ring).unwrap();
        format!(
            r#"{{"type":"Feature","properties":{{{attributes}}},
                "geometry":{{"type":"Polygon","coordinates":[{ring}]}}}}"#
        )
    };
    let features: Vec<String> = areas.iter().map(feature).collect();
    format!(
        r#"{{"type":"FeatureCollection","crs":{{"type":"name","properties":{{"name":"EPSG:6677"}}}},"features":[{}]}}"#,
        features.join(",")
    )
}

#[test]
fn lakes_are_level_in_every_verb() {
    let folder = Folder::new();
    folder.put("c.geojson", contours(&[("30", ring(60.0)), ("20", ring(40.0)), ("10", ring(20.0))]));
    folder.put("told.geojson", lakes(&[(r#""name":"pond","elev":8.5"#, ring(10.0))]));
    folder.put("shore.geojson", lakes(&[(r#""name":"pond""#, ring(20.0))]));
    let (messages, _) = folder.succeeds("densify c.geojson -i 0.5 -o lines.geojson --water told.geojson");
    assert!(messages.contains("water      1 areas, height 8.5 m"), "{messages}");
    let in_lake = |p: &[f64; 3]| (p[0] - 1000.0).abs() < 9.999 && (p[1] - 2000.0).abs() < 9.999;
    let lines = folder.lines_of("lines.geojson");
    assert!(lines.iter().all(|(.., points)| !points.iter().any(in_lake)));
    assert!(lines.iter().any(|(z, ..)| *z == 9.5) && lines.iter().all(|(z, ..)| *z > 8.5));

    for (water, level) in [("told", 8.5), ("shore", 10.0)] {
        folder.succeeds(&format!("dem c.geojson --cell 2 -o dem.tif --water {water}.geojson --preview p.png"));
        let (grid, values) = dem_of(&folder.path("dem.tif"));
        let reach = if water == "told" { 10.0 } else { 20.0 };
        let inside = |x: f64, y: f64| (x - 1000.0).abs() < reach && (y - 2000.0).abs() < reach;
        let cells = (0..values.len()).filter(|&k| {
            let (x, y) = (
                grid[0] + 2.0 * (0.5 + (k % grid[2] as usize) as f64),
                grid[1] - 2.0 * (0.5 + (k / grid[2] as usize) as f64),
            );
            inside(x, y)
        });
        let heights: Vec<f32> = cells.map(|k| values[k]).collect();
        assert!(heights.len() >= 100 && heights.iter().all(|&z| z == level), "{heights:?}");
    }
    folder.succeeds("mesh c.geojson -o m.ply --water told.geojson");
    folder.succeeds("skeleton c.geojson -o s.geojson --water told.geojson");
    folder.succeeds("regions c.geojson -o r.geojson --water told.geojson");
    let classes: Vec<serde_json::Value> =
        areas_of(&folder, "r.geojson").iter().map(|area| area["class"].clone()).collect();
    assert_eq!(classes.iter().filter(|class| *class == "water").count(), 1, "{classes:?}");
}

/// West and north border and number of columns of a height map with cells of 2, and its values.
fn dem_of(path: &Path) -> ([f64; 3], Vec<f32>) {
    let mut decoder = tiff::decoder::Decoder::new(fs::File::open(path).unwrap()).unwrap();
    let tie = decoder.get_tag_f64_vec(tiff::tags::Tag::ModelTiepointTag).unwrap();
    let (cols, _) = decoder.dimensions().unwrap();
    let tiff::decoder::DecodingResult::F32(values) = decoder.read_image().unwrap() else { panic!("no floats") };
    ([tie[3], tie[4], f64::from(cols)], values)
}

#[test]
fn water_that_cannot_be_used() {
    let folder = with_hill();
    folder.put("w.geojson", lakes(&[(r#""elev":"deep""#, ring(5.0))]));
    folder.fails(
        "dem hill.geojson --cell 5 -o d.tif --water w.geojson",
        FAILED,
        &["w.geojson", "deep", "not a number"],
    );
    folder.put("w.geojson", lakes(&[("", ring(5.0))]).replace("6677", "26718"));
    folder.fails(
        "dem hill.geojson --cell 5 -o d.tif --water w.geojson",
        FAILED,
        &["w.geojson", "the shift from the datum of"],
    );
    folder.fails("dem hill.geojson --cell 5 -o d.tif --water hill.geojson", FAILED, &["no polygon"]);
    folder.fails("dem hill.geojson --cell 5 -o d.tif --water none.gpkg", FAILED, &["none.gpkg"]);
    folder.fails("dem hill.geojson --cell 5 -o d.tif --sea 0", USAGE, &["level of the sea, 0 m", "10 m, 20 m, 30 m"]);
    folder.put("w.geojson", lakes(&[(r#""elev":55"#, ring(5.0))]));
    let (_, messages) = folder.succeeds("dem hill.geojson --cell 5 -o d.tif --water w.geojson");
    assert!(
        messages.contains("lakes left out: 1") && messages.contains("between the levels 30 m and 40 m"),
        "{messages}"
    );
    let output = folder.run("dem hill.geojson --cell 5 -o e.tif --strict --water w.geojson");
    assert_eq!(output.status.code(), Some(FAILED));
    let (messages, _) = folder.succeeds("dem hill.geojson --cell 5 -o d.tif --sea 10");
    assert!(!messages.contains("water  "), "there is no ground below the coast: {messages}");
}

#[test]
fn the_summary_tells_how_the_smooth_surface_was_drawn() {
    let folder = Folder::new();
    folder.put("in.gpkg", part());
    let dem = "dem in.gpkg --cell 20 -o dem.tif";
    let (plain, _) = folder.succeeds(dem);
    for words in ["smooth; smoothness chosen automatically", "expected error of heights: about ", " m (RMSE); 90 % of"]
    {
        assert!(plain.contains(words), "no {words:?} in {plain}");
    }
    assert!(!plain.contains("tension") && plain.lines().count() <= 10, "{plain}");
    let (chosen, _) = folder.succeeds(&format!("{dem} -v"));
    for words in [
        ", crease threshold 0.",
        ", curvature gain 0.",
        "chosen by cross-validation on hidden levels",
        "LE90",
        "with contours 40 m apart",
        "these are 20 m apart",
    ] {
        assert!(chosen.contains(words), "no {words:?} in {chosen}");
    }
    let (given, _) = folder.succeeds(&format!("{dem} --tension 5 --noise 1 -v"));
    assert!(given.contains("tension 5.00, as given; noise 1") && !given.contains("accuracy"), "{given}");
    fs::remove_file(folder.path("dem.tif")).unwrap();
    folder.fails(&format!("{dem} --tension -1"), USAGE, &["tension is -1"]);

    let ring = |z: f64, r: f64| {
        format!(
            "{{\"type\":\"Feature\",\"properties\":{{\"elev\":{z}}},\"geometry\":{{\"type\":\"LineString\",\"coordinates\":[[-{r},-{r}],[{r},-{r}],[{r},{r}],[-{r},{r}],[-{r},-{r}]]}}}}"
        )
    };
    let crs = r#""crs":{"type":"name","properties":{"name":"urn:ogc:def:crs:EPSG::6677"}}"#;
    let rings = [ring(0.0, 90.0), ring(10.0, 60.0), ring(20.0, 30.0)].join(",");
    folder.put("few.geojson", format!("{{\"type\":\"FeatureCollection\",{crs},\"features\":[{rings}]}}"));
    let (few, _) = folder.succeeds("dem few.geojson --cell 5 -o few.tif -v");
    assert!(few.contains("tension 3.50, the default: there are too few levels"), "{few}");
}

#[test]
fn uncertainty_is_written_where_there_is_room_for_it() {
    let folder = with_hill();
    for name in ["dem.asc", "dem.png", "dem.xyz"] {
        folder.fails(&format!("dem hill.geojson --cell 5 --uncertainty -o {name}"), USAGE, &["--uncertainty", ".tif"]);
    }
    let plain = "densify hill.geojson -i 5 -o plain.geojson";
    folder.succeeds(plain);
    let (told, _) = folder.succeeds("densify hill.geojson -i 5 --uncertainty -o lines.geojson --preview look.png");
    assert!(told.contains("usual terrain"), "{told}");
    let read =
        |name: &str| -> serde_json::Value { serde_json::from_slice(&fs::read(folder.path(name)).unwrap()).unwrap() };
    assert!(read("plain.geojson")["features"][0]["properties"].get("err_v").is_none());
    let (lines, mut new) = (read("lines.geojson"), 0);
    for feature in lines["features"].as_array().unwrap() {
        let of = |name: &str| &feature["properties"][name];
        let errors = [of("err_v"), of("err_h")].map(|error| error.as_f64().unwrap());
        if of("source") == "input" {
            assert!(errors == [0.0; 2] && of("inferred") == false, "{feature}");
        } else {
            assert!(errors.iter().all(|error| *error > 0.0), "{feature}");
            assert_eq!(of("inferred").as_bool(), Some(of("elev").as_f64().unwrap() > 30.0), "{feature}");
            new += 1;
        }
    }
    assert!(new > 1);
    folder.succeeds("dem hill.geojson --cell 5 --uncertainty -o dem.tif");
    let errors = tokosen::io::raster::read_standard_errors(&folder.path("dem.tif")).unwrap().unwrap();
    assert!(errors.values.iter().any(|error| *error > 0.0));
}

#[test]
fn tuned_numbers_are_set_by_name() {
    let folder = with_hill();
    let dem = |name: &str, tuned: &str| format!("dem hill.geojson --cell 5 -o {name} {tuned}");
    folder.succeeds(&dem("usual.tif", ""));
    folder.succeeds(&dem("same.tif", "--tune spline.crease_weight=0.7"));
    folder.succeeds(&dem("other.tif", "--tune trials.usual_tension=9 --tune spline.steps.1=61"));
    let read = |name: &str| fs::read(folder.path(name)).unwrap();
    assert_eq!(read("usual.tif"), read("same.tif"));
    assert_ne!(read("usual.tif"), read("other.tif"));
    folder.fails(
        &dem("none.tif", "--tune spline.crease=1"),
        USAGE,
        &["spline.crease_weight = 0.7", "spline.steps.1 = 60"],
    );
    folder.fails(&dem("none.tif", "--tune spline.crease_weight=-1"), USAGE, &["spline.crease_weight", "0 or more"]);
}

#[test]
fn one_run_writes_the_same_heights_in_several_formats() {
    let folder = with_hill();
    let (said, _) = folder.succeeds("dem hill.geojson --cell 5 -o a.tif -o b.exr -o c.asc");
    assert_eq!(said.matches("written    ").count(), 3, "{said}");
    let heights = |name: &str| tokosen::io::raster::read_dem(&folder.path(name)).unwrap().value.dem;
    let first = heights("a.tif");
    assert!(first.values.iter().any(|height| height.is_finite()));
    for name in ["b.exr", "c.asc"] {
        let other = heights(name);
        assert_eq!(other.grid, first.grid, "{name}");
        let is_same = |(a, b): (&f32, &f32)| (a.is_nan() && b.is_nan()) || (a - b).abs() < 1e-3;
        assert!(first.values.iter().zip(&other.values).all(is_same), "{name}");
    }
    folder.fails("dem hill.geojson --cell 5 -o a.tif -o a.tif", USAGE, &["a.tif"]);
}
