//! Outputs that exist: layers of a GeoPackage stay, files of other programs are not replaced, and a script can run twice.

#![allow(clippy::unwrap_used, reason = "helpers of tests are tests too")]

use std::fs;
use std::path::Path;

use rusqlite::Connection;
use tempfile::TempDir;

use crate::running::{run, said, tokosen};

fn done(folder: &Path, line: &str) {
    let output = run(folder, line);
    assert!(output.status.success(), "{line}: {}", said(&output));
}

/// Runs a command that must be refused, and returns the message.
fn refused(folder: &Path, line: &str) -> String {
    let output = run(folder, line);
    assert_eq!(output.status.code(), Some(1), "{line}: {}", said(&output));
    said(&output)
}

/// A folder with a small map in it, in.geojson.
fn folder() -> TempDir {
    let dir = tempfile::tempdir().unwrap();
    let sample = Path::new(env!("CARGO_MANIFEST_DIR")).join("samples/fig1f_nested.geojson");
    fs::copy(sample, dir.path().join("in.geojson")).unwrap();
    dir
}

/// A GeoPackage as another program leaves it: a table of notes, a layer of its own with a style, and a table that no
/// standard knows.
fn project(path: &Path) {
    let db = Connection::open(path).unwrap();
    db.execute_batch(
        "PRAGMA application_id = 1196444487;
         CREATE TABLE gpkg_spatial_ref_sys (srs_name TEXT NOT NULL, srs_id INTEGER NOT NULL PRIMARY KEY,
            organization TEXT NOT NULL, organization_coordsys_id INTEGER NOT NULL, definition TEXT NOT NULL,
            description TEXT, definition_12_063 TEXT NOT NULL);
         INSERT INTO gpkg_spatial_ref_sys VALUES ('mine', 100000, 'NONE', 100000, 'LOCAL_CS[\"mine\"]', NULL, 'undefined');
         CREATE TABLE gpkg_contents (table_name TEXT NOT NULL PRIMARY KEY, data_type TEXT NOT NULL, identifier TEXT UNIQUE,
            description TEXT DEFAULT '', last_change DATETIME NOT NULL, min_x DOUBLE, min_y DOUBLE, max_x DOUBLE,
            max_y DOUBLE, srs_id INTEGER);
         CREATE TABLE gpkg_geometry_columns (table_name TEXT NOT NULL, column_name TEXT NOT NULL,
            geometry_type_name TEXT NOT NULL, srs_id INTEGER NOT NULL, z TINYINT NOT NULL, m TINYINT NOT NULL,
            CONSTRAINT pk_geom_cols PRIMARY KEY (table_name, column_name));
         CREATE TABLE gpkg_ogr_contents (table_name TEXT NOT NULL PRIMARY KEY, feature_count INTEGER);
         INSERT INTO gpkg_contents VALUES ('contours_5m', 'features', 'contours_5m', '', '2026-01-01T00:00:00.000Z',
            0, 0, 1, 1, 100000);
         INSERT INTO gpkg_geometry_columns VALUES ('contours_5m', 'shape', 'POINT', 100000, 0, 0);
         INSERT INTO gpkg_ogr_contents VALUES ('contours_5m', 1);
         CREATE TABLE contours_5m (fid INTEGER PRIMARY KEY, shape BLOB, note TEXT);
         INSERT INTO contours_5m VALUES (1, NULL, 'irreplaceable');
         CREATE TABLE layer_styles (f_table_name TEXT, styleQML TEXT);
         INSERT INTO layer_styles VALUES ('contours_5m', '<qgis/>');
         CREATE TABLE diary (day TEXT, text TEXT);
         INSERT INTO diary VALUES ('Monday', 'rain');",
    )
    .unwrap();
}

fn text(db: &Connection, sql: &str) -> String {
    db.query_row(sql, [], |row| row.get(0)).unwrap()
}

fn layers(path: &Path) -> Vec<String> {
    let db = Connection::open(path).unwrap();
    let mut names = db.prepare("SELECT table_name FROM gpkg_contents ORDER BY table_name").unwrap();
    names.query_map([], |row| row.get(0)).unwrap().collect::<Result<_, _>>().unwrap()
}

#[test]
fn a_geopackage_gets_layers_and_keeps_its_own() {
    let dir = folder();
    let path = dir.path().join("project.gpkg");
    project(&path);
    done(dir.path(), "densify in.geojson -i 2,1 -o project.gpkg -q");
    done(dir.path(), "regions in.geojson -o project.gpkg -q");
    assert_eq!(layers(&path), ["contours_1m", "contours_2m", "contours_5m", "regions"]);
    done(dir.path(), "densify in.geojson -i 2,1 -o alone.gpkg -q");
    let db = Connection::open(&path).unwrap();
    assert_eq!(text(&db, "SELECT note FROM contours_5m"), "irreplaceable");
    assert_eq!(text(&db, "SELECT text FROM diary"), "rain");
    assert_eq!(text(&db, "PRAGMA integrity_check"), "ok");
    // The layers are those of a new file, but for the id of the coordinate reference system.
    db.execute("ATTACH DATABASE ?1 AS alone", [dir.path().join("alone.gpkg").to_str().unwrap()]).unwrap();
    for layer in ["contours_1m", "contours_2m"] {
        let differing = format!(
            "SELECT count(*) || '' FROM main.{layer} AS a JOIN alone.{layer} AS b USING (fid)
             WHERE a.elev IS NOT b.elev OR substr(a.geom, 9) IS NOT substr(b.geom, 9)"
        );
        assert_eq!(text(&db, &differing), "0");
        let rows = |of: &str| text(&db, &format!("SELECT count(*) || '' FROM {of}"));
        assert_eq!(rows(&format!("main.{layer}")), rows(&format!("alone.{layer}")));
        assert_ne!(rows(&format!("main.{layer}")), "0");
        assert_eq!(rows(&format!("main.rtree_{layer}_geom")), rows(&format!("alone.rtree_{layer}_geom")));
        let id = format!("SELECT srs_id || '' FROM gpkg_geometry_columns WHERE table_name = '{layer}'");
        assert_eq!(text(&db, &id), text(&db, &id.replace("gpkg_geo", "alone.gpkg_geo")), "6677 is free in the project");
        let triggers =
            format!("SELECT count(*) || '' FROM sqlite_master WHERE type = 'trigger' AND tbl_name = '{layer}'");
        assert_eq!(text(&db, &triggers), "6");
    }
    // It is an input too, as long as no layer of it is replaced.
    done(dir.path(), "densify project.gpkg --layer contours_2m -i 0.5 -o project.gpkg -q");
    assert!(layers(&path).contains(&"contours_0.5m".to_owned()), "{:?}", layers(&path));
    let message = refused(dir.path(), "densify project.gpkg --layer contours_2m -i 2 -o project.gpkg -q --overwrite");
    assert!(message.contains("is an input"), "{message}");
}

#[test]
fn a_layer_of_another_program_is_replaced_only_when_asked_and_own_layers_always() {
    let dir = folder();
    let path = dir.path().join("project.gpkg");
    project(&path);
    let message = refused(dir.path(), "densify in.geojson -i 5 -o project.gpkg -q");
    assert!(message.contains("contours_5m") && message.contains("--overwrite"), "{message}");
    assert_eq!(text(&Connection::open(&path).unwrap(), "SELECT note FROM contours_5m"), "irreplaceable");
    done(dir.path(), "densify in.geojson -i 5 -o project.gpkg -q --overwrite");
    done(dir.path(), "densify in.geojson -i 5 -o project.gpkg -q");
    let db = Connection::open(&path).unwrap();
    assert_eq!(text(&db, "SELECT text FROM diary"), "rain");
    assert_eq!(text(&db, "SELECT styleQML FROM layer_styles"), "<qgis/>");
    assert_eq!(text(&db, "SELECT column_name FROM gpkg_geometry_columns WHERE table_name = 'contours_5m'"), "geom");
    assert_eq!(text(&db, "SELECT count(*) || '' FROM gpkg_ogr_contents"), "0");
    assert_eq!(text(&db, "PRAGMA integrity_check"), "ok");
    let message = refused(dir.path(), "densify in.geojson --levels 12.5 -o project.gpkg -q --layer no");
    assert!(message.contains("layer"), "{message}");
    db.execute_batch("CREATE TABLE regions (a)").unwrap();
    drop(db);
    let message = refused(dir.path(), "regions in.geojson -o project.gpkg -q --overwrite");
    assert!(message.contains("no layer"), "{message}");
}

#[test]
fn layers_have_styles_and_those_of_the_user_are_kept() {
    let dir = folder();
    let path = dir.path().join("styled.gpkg");
    done(dir.path(), "densify in.geojson -i 5 -o styled.gpkg -q");
    done(dir.path(), "check in.geojson -o styled.gpkg -q");
    done(dir.path(), "regions in.geojson -o styled.gpkg -q");
    let db = Connection::open(&path).unwrap();
    let styled = "SELECT group_concat(f_table_name) FROM (SELECT f_table_name FROM layer_styles ORDER BY id)";
    assert_eq!(text(&db, styled), "contours_5m,findings");
    let style = |layer: &str| text(&db, &format!("SELECT styleQML FROM layer_styles WHERE f_table_name = '{layer}'"));
    assert!(style("contours_5m").contains("RuleRenderer") && style("contours_5m").contains("fieldName=\"elev\""));
    assert!(style("findings").contains("attr=\"severity\""));
    assert_eq!(text(&db, "SELECT f_geometry_column || useAsDefault FROM layer_styles LIMIT 1"), "geom1");
    db.execute_batch("UPDATE layer_styles SET styleQML = 'mine' WHERE f_table_name = 'contours_5m'").unwrap();
    done(dir.path(), "densify in.geojson -i 5,2 -o styled.gpkg -q");
    assert_eq!(style("contours_5m"), "mine");
    assert_eq!(text(&db, styled), "contours_5m,findings,contours_2m");
    // The style is no layer.
    assert_eq!(layers(&path), ["contours_2m", "contours_5m", "findings", "regions"]);
}

#[test]
fn a_geopackage_that_another_program_writes_to_stays_whole() {
    let dir = folder();
    let path = dir.path().join("project.gpkg");
    project(&path);
    let mut other = Connection::open(&path).unwrap();
    let edit = other.transaction_with_behavior(rusqlite::TransactionBehavior::Immediate).unwrap();
    edit.execute("INSERT INTO diary VALUES ('Tuesday', 'sun')", []).unwrap();
    let message = refused(dir.path(), "densify in.geojson -i 2 -o project.gpkg -q");
    assert!(message.contains("another program"), "{message}");
    edit.commit().unwrap();
    assert_eq!(layers(&path), ["contours_5m"]);
    assert_eq!(fs::read_dir(dir.path()).unwrap().count(), 2, "nothing else is left");
    done(dir.path(), "densify in.geojson -i 2 -o project.gpkg -q");
    assert_eq!(text(&other, "SELECT text FROM diary WHERE day = 'Tuesday'"), "sun");
}

#[test]
fn every_format_is_written_twice_and_foreign_files_only_when_asked() {
    let dir = folder();
    // Formats without a place for the program's name need the option the second time too.
    for (line, target, names_program) in [
        ("densify in.geojson -i 5 -o out.geojson", "out.geojson", true),
        ("densify in.geojson -i 5 -o out.fgb", "out.fgb", true),
        ("densify in.geojson -i 5 -o out.parquet", "out.parquet", true),
        ("densify in.geojson -i 5 -o out.dxf", "out.dxf", true),
        ("densify in.geojson -i 5 -o out.shp", "out.shp", false),
        ("dem in.geojson --cell 10 -o out.tif", "out.tif", true),
        ("dem in.geojson --cell 10 -o out.exr", "out.exr", true),
        ("dem in.geojson --cell 10 -o out.png", "out.png", true),
        ("dem in.geojson --cell 10 -o gsi.png --png-encoding gsi", "gsi.png", true),
        ("dem in.geojson --cell 10 -o out.asc", "out.asc", false),
        ("dem in.geojson --cell 10 -o out.xyz", "out.xyz", false),
        ("dem in.geojson --cell 10 -o a.tif --preview look.png", "look.png", true),
        ("derive in.geojson --cell 10 --hillshade shade.png", "shade.png", true),
        ("mesh in.geojson -o out.glb", "out.glb", true),
        ("mesh in.geojson -o out.obj", "out.obj", true),
        ("mesh in.geojson -o out.ply", "out.ply", true),
        ("mesh in.geojson -o out.stl", "out.stl", true),
        ("mesh in.geojson -o out.3mf", "out.3mf", true),
        ("mesh in.geojson -o page.html", "page.html", true),
        ("compare in.geojson a.tif --report out.html", "out.html", true),
        ("check in.geojson -o findings.geojson", "findings.geojson", true),
    ] {
        let path = dir.path().join(target);
        fs::write(&path, "of another program").unwrap();
        let message = refused(dir.path(), &format!("{line} -q"));
        assert!(message.contains(target) && message.contains("--overwrite"), "{message}");
        assert_eq!(fs::read_to_string(&path).unwrap(), "of another program");
        done(dir.path(), &format!("{line} -q --overwrite"));
        assert_eq!(run(dir.path(), &format!("{line} -q")).status.success(), names_program, "{line}");
        // As a tool for temporary files leaves it.
        fs::write(&path, "").unwrap();
        assert_eq!(run(dir.path(), &format!("{line} -q")).status.success(), target != "out.shp", "{line}");
    }
}

#[test]
fn a_table_beside_a_shapefile_that_is_not_there_yet_is_not_replaced() {
    let dir = folder();
    fs::write(dir.path().join("wells.dbf"), "a table of wells").unwrap();
    let message = refused(dir.path(), "densify in.geojson -i 5 -o wells.shp -q");
    assert!(message.contains("wells.dbf"), "{message}");
    let message = refused(dir.path(), "densify in.geojson -i 2 -o wells.gpkg --dem in.tif --cell 2 -q --layer x");
    assert!(message.contains("layer"), "{message}");
}

#[test]
fn a_file_that_is_no_geopackage_is_replaced_only_when_asked() {
    let dir = folder();
    fs::write(dir.path().join("a.gpkg"), "of another program").unwrap();
    let message = refused(dir.path(), "densify in.geojson -i 5 -o a.gpkg -q");
    assert!(message.contains("--overwrite"), "{message}");
    done(dir.path(), "densify in.geojson -i 5 -o a.gpkg -q --overwrite");
    assert_eq!(layers(&dir.path().join("a.gpkg")), ["contours_5m"]);
}

#[cfg(target_os = "linux")]
#[test]
fn text_that_cannot_be_printed_is_a_failure() {
    let dir = folder();
    for line in ["check in.geojson --json", "check in.geojson", "densify in.geojson -i 5 -o a.gpkg"] {
        let full = fs::OpenOptions::new().write(true).open("/dev/full").unwrap();
        let output = tokosen().current_dir(dir.path()).args(line.split_whitespace()).stdout(full).output().unwrap();
        assert_eq!(output.status.code(), Some(1), "{line}");
        assert!(said(&output).contains("cannot write standard output"), "{line}: {}", said(&output));
    }
}
