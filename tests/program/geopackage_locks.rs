//! GeoPackages that another program holds or left half written, and runs that write into one at the same time.

#![allow(clippy::unwrap_used, reason = "helpers of tests are tests too")]

use std::fs;
use std::path::Path;
use std::process::Stdio;

use rusqlite::Connection;

use crate::common::Folder;
use crate::running::{Running, folder_with, said, tokosen};

const LOCKED: &str = "is locked by another program";

fn folder() -> Folder {
    folder_with("fig1f_nested.geojson", "in.geojson")
}

fn number(path: &Path, sql: &str) -> i64 {
    Connection::open(path).unwrap().query_row(sql, [], |row| row.get(0)).unwrap()
}

/// A GeoPackage with a layer of this program and notes of another one.
fn with_notes(folder: &Folder, name: &str) {
    folder.succeeds(&format!("densify in.geojson -i 10 -o {name} -q"));
    let db = Connection::open(folder.path(name)).unwrap();
    db.execute_batch("CREATE TABLE notes (text TEXT); INSERT INTO notes VALUES ('irreplaceable');").unwrap();
}

#[test]
fn a_locked_file_is_called_locked_and_stays_as_it_is() {
    let folder = folder();
    with_notes(&folder, "a.gpkg");
    let path = folder.path("a.gpkg");
    let before = fs::read(&path).unwrap();
    let other = Connection::open(&path).unwrap();
    other.execute_batch("BEGIN EXCLUSIVE").unwrap();
    // The waits of all of them take as long as that of one.
    let lines = [
        "densify in.geojson -i 5 -o a.gpkg -q",
        "densify in.geojson -i 5 -o a.gpkg -q --overwrite",
        "densify a.gpkg -i 5 -o b.gpkg -q",
        "dem in.geojson --cell 50 --streams a.gpkg -o b.tif -q",
    ];
    let children = lines.map(|line| {
        let mut command = tokosen();
        command.current_dir(folder.0.path()).args(line.split_whitespace()).stderr(Stdio::piped());
        command.spawn().unwrap()
    });
    for (line, child) in lines.into_iter().zip(children) {
        let output = child.wait_with_output().unwrap();
        assert_eq!(output.status.code(), Some(1), "{line}: {}", said(&output));
        assert!(said(&output).contains("a.gpkg") && said(&output).contains(LOCKED), "{line}: {}", said(&output));
    }
    other.execute_batch("ROLLBACK").unwrap();
    drop(other);
    assert_eq!(fs::read(&path).unwrap(), before);
    folder.succeeds("densify in.geojson -i 5 -o a.gpkg -q");
}

/// Makes the copy `to` of a GeoPackage as a program leaves it that is killed while it writes: half of its changes are in the
/// file, and the journal beside it has what was there before.
fn half_written(from: &Path, to: &Path) {
    let db = Connection::open(from).unwrap();
    db.execute_batch("PRAGMA cache_size = 2; BEGIN; DELETE FROM notes;").unwrap();
    for k in 0..3000 {
        db.execute("INSERT INTO notes VALUES (?1)", [format!("{k} {}", "note ".repeat(50))]).unwrap();
    }
    let journal = |path: &Path| format!("{}-journal", path.display());
    fs::copy(from, to).unwrap();
    fs::copy(journal(from), journal(to)).unwrap();
    assert!(fs::metadata(to).unwrap().len() > 100_000, "otherwise nothing of it is in the file");
}

#[test]
fn what_a_killed_program_left_half_written_is_taken_back_and_never_replaced() {
    let folder = folder();
    with_notes(&folder, "whole.gpkg");
    let path = folder.path("a.gpkg");
    for line in [
        "densify in.geojson -i 5 -o a.gpkg -q",
        "densify in.geojson -i 5 -o a.gpkg -q --overwrite",
        "densify a.gpkg --layer contours_10m -i 5 -o a.gpkg -q",
        "densify a.gpkg --layer contours_10m -i 5 -o b.gpkg -q",
    ] {
        half_written(&folder.path("whole.gpkg"), &path);
        folder.succeeds(line);
        assert_eq!(number(&path, "SELECT count(*) FROM notes WHERE text = 'irreplaceable'"), 1, "{line}");
        assert_eq!(number(&path, "SELECT count(*) FROM notes"), 1, "{line}");
        assert!(number(&path, "SELECT count(*) FROM contours_10m") > 0, "{line}");
        fs::remove_file(&path).unwrap();
    }
}

#[test]
fn layers_of_runs_at_the_same_time_are_all_there() {
    let folder = folder();
    for is_there in [false, true] {
        if is_there {
            with_notes(&folder, "a.gpkg");
        }
        let intervals = ["10", "5", "4", "2.5"];
        let children = intervals.map(|interval| {
            let mut command = tokosen();
            command.current_dir(folder.0.path()).args(["densify", "in.geojson", "-i", interval, "-o", "a.gpkg", "-q"]);
            command.stderr(Stdio::piped()).spawn().unwrap()
        });
        for child in children {
            let output = child.wait_with_output().unwrap();
            assert!(output.status.success(), "{}", said(&output));
        }
        for interval in intervals {
            let rows = number(&folder.path("a.gpkg"), &format!("SELECT count(*) FROM \"contours_{interval}m\""));
            assert!(rows > 0, "{interval}");
        }
        if is_there {
            assert_eq!(number(&folder.path("a.gpkg"), "SELECT count(*) FROM notes"), 1);
        }
        fs::remove_file(folder.path("a.gpkg")).unwrap();
    }
}
