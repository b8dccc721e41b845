//! Pipes, devices and files of gigabytes as inputs, as files beside them, as outputs and as saved runs: they are refused at
//! once. To open a pipe would mean to wait for ever.

#![cfg(unix)]
#![allow(clippy::unwrap_used, reason = "helpers of tests are tests too")]

use std::fs::{self, File};
use std::os::unix::fs::symlink;
use std::path::Path;
use std::process::{Command, Output, Stdio};
use std::thread::sleep;
use std::time::{Duration, Instant};

use crate::common::Folder;
use crate::running::{Running, folder_with, said, tokosen};

const ORDINARY: &str = "is not an ordinary file";
const PATIENCE: Duration = Duration::from_secs(60);

fn pipe(path: &Path) {
    assert!(Command::new("mkfifo").arg(path).status().unwrap().success());
}

/// Runs the program, which must end by itself.
fn ends_by_itself(folder: &Folder, arguments: &str) -> Output {
    let mut command = tokosen();
    command.current_dir(folder.0.path()).args(arguments.split_whitespace());
    let mut child = command.stdout(Stdio::null()).stderr(Stdio::piped()).spawn().unwrap();
    let start = Instant::now();
    while child.try_wait().unwrap().is_none() {
        if start.elapsed() > PATIENCE {
            child.kill().unwrap();
            child.wait().unwrap();
            panic!("{arguments} waits");
        }
        sleep(Duration::from_millis(2));
    }
    child.wait_with_output().unwrap()
}

fn is_refused(folder: &Folder, arguments: &str, words: &[&str]) {
    let output = ends_by_itself(folder, arguments);
    assert!(matches!(output.status.code(), Some(1 | 2)), "{arguments}: {}", said(&output));
    for word in words {
        assert!(said(&output).contains(word), "{arguments}: {word:?} is missing in {}", said(&output));
    }
}

fn folder() -> Folder {
    folder_with("fig1f_nested.geojson", "in.geojson")
}

#[test]
fn inputs_of_every_format_and_role_are_ordinary_files() {
    let folder = folder();
    for name in ["a.geojson", "a.gpkg", "a.fgb", "a.parquet", "a.dxf", "a.shp", "a.xml", "a.zip"] {
        pipe(&folder.path(name));
        is_refused(&folder, &format!("densify {name} -i 5 -o out.gpkg"), &[name, ORDINARY]);
    }
    for name in ["a.tif", "a.exr", "a.png", "a.asc"] {
        pipe(&folder.path(name));
        is_refused(&folder, &format!("derive {name} --slope out.tif"), &[name, ORDINARY]);
        is_refused(&folder, &format!("dem in.geojson --like {name} -o out.tif"), &[name, ORDINARY]);
        is_refused(&folder, &format!("dem in.geojson --cell 5 --base {name} -o out.tif"), &[name, ORDINARY]);
    }
    pipe(&folder.path("a.csv"));
    symlink("/dev/zero", folder.path("zero.gpkg")).unwrap();
    symlink("/dev/zero", folder.path("zero.csv")).unwrap();
    for role in ["--points a.csv", "--points zero.csv", "--streams a.gpkg", "--cliffs zero.gpkg", "--exclude a.dxf"] {
        is_refused(&folder, &format!("dem in.geojson --cell 5 {role} -o out.tif"), &[ORDINARY]);
    }
    assert!(!folder.path("out.tif").exists() && !folder.path("out.gpkg").exists());
}

#[test]
fn files_beside_an_input_are_ordinary_and_small() {
    let folder = folder();
    folder.succeeds("check in.geojson --repair safe -o a.shp -q");
    folder.succeeds("dem in.geojson --cell 50 -o a.asc -q");
    for (name, line) in [
        ("a.dbf", "densify a.shp -i 5 -o out.gpkg"),
        ("a.shx", "densify a.shp -i 5 -o out.gpkg"),
        ("a.cpg", "densify a.shp -i 5 -o out.gpkg"),
        ("a.CPG", "densify a.shp -i 5 -o out.gpkg"),
        ("a.prj", "densify a.shp -i 5 -o out.gpkg"),
        ("a.prj", "derive a.asc --slope out.tif"),
        ("a.asc.aux.xml", "derive a.asc --slope out.tif"),
    ] {
        let kept = folder.path("kept");
        let is_there = fs::rename(folder.path(name), &kept).is_ok();
        pipe(&folder.path(name));
        is_refused(&folder, line, &[name, ORDINARY]);
        fs::remove_file(folder.path(name)).unwrap();
        if !name.ends_with("dbf") && !name.ends_with("shx") {
            // Sparse: it takes no space on the disk.
            File::create(folder.path(name)).unwrap().set_len(4 << 30).unwrap();
            is_refused(&folder, line, &[name, "is too large"]);
            fs::remove_file(folder.path(name)).unwrap();
        }
        if is_there {
            fs::rename(&kept, folder.path(name)).unwrap();
        }
    }
    folder.succeeds("densify a.shp -i 5 -o out.gpkg -q");
}

#[test]
fn outputs_are_ordinary_files_and_what_is_none_stays() {
    use std::os::unix::fs::FileTypeExt;
    let folder = folder();
    folder.succeeds("dem in.geojson --cell 50 -o truth.tif -q");
    for (name, line) in [
        ("out.gpkg", "densify in.geojson -i 5 -o out.gpkg"),
        ("out.geojson", "densify in.geojson -i 5 -o out.geojson"),
        ("out.dxf", "densify in.geojson -i 5 -o out.dxf"),
        ("out.fgb", "densify in.geojson -i 5 -o out.fgb"),
        ("out.parquet", "densify in.geojson -i 5 -o out.parquet"),
        ("out.shp", "densify in.geojson -i 5 -o out.shp"),
        ("out.dbf", "densify in.geojson -i 5 -o out.shp"),
        ("out.tif", "dem in.geojson --cell 50 -o out.tif"),
        ("out.asc", "dem in.geojson --cell 50 -o out.asc"),
        ("out.png", "dem in.geojson --cell 50 -o new.tif --preview out.png"),
        ("out.glb", "mesh in.geojson -o out.glb"),
        ("out.html", "compare in.geojson truth.tif --report out.html"),
        ("out.json", "check in.geojson --save-run out.json"),
    ] {
        pipe(&folder.path(name));
        for overwrite in ["", " --overwrite"] {
            is_refused(&folder, &format!("{line}{overwrite}"), &[name, ORDINARY]);
            assert!(fs::metadata(folder.path(name)).unwrap().file_type().is_fifo(), "{line}");
        }
        fs::remove_file(folder.path(name)).unwrap();
    }
    fs::create_dir(folder.path("out.tif")).unwrap();
    is_refused(&folder, "dem in.geojson --cell 50 -o out.tif --overwrite", &["out.tif", "is a folder"]);
}

#[test]
fn a_saved_run_is_a_small_file_and_so_are_its_inputs_ordinary() {
    let folder = folder();
    pipe(&folder.path("pipe.json"));
    is_refused(&folder, "--run pipe.json", &["pipe.json", ORDINARY]);
    is_refused(&folder, "--run /dev/zero", &[ORDINARY]);
    File::create(folder.path("large.json")).unwrap().set_len(4 << 30).unwrap();
    is_refused(&folder, "--run large.json", &["large.json", "is too large for a saved run"]);
    folder.succeeds("dem in.geojson --cell 50 -o out.tif --save-run run.json -q");
    fs::remove_file(folder.path("in.geojson")).unwrap();
    pipe(&folder.path("in.geojson"));
    is_refused(&folder, "--run run.json", &["in.geojson", ORDINARY]);
}
