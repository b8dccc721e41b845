//! Files that are not what they should be, targets that cannot be written, and a program that is stopped.

#![allow(clippy::unwrap_used, reason = "helpers of tests are tests too")]

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use tempfile::TempDir;

use crate::running::{part, run, said, tokosen};

fn sample(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("samples").join(name)
}

/// A folder with a small map in it, in.geojson.
fn folder() -> TempDir {
    let dir = tempfile::tempdir().unwrap();
    fs::copy(sample("fig1f_nested.geojson"), dir.path().join("in.geojson")).unwrap();
    dir
}

fn names(folder: &Path) -> Vec<String> {
    let mut names: Vec<String> =
        fs::read_dir(folder).unwrap().map(|e| e.unwrap().file_name().into_string().unwrap()).collect();
    names.sort();
    names
}

#[test]
fn a_geopackage_whose_column_names_are_no_text_is_read() {
    let dir = folder();
    assert!(run(dir.path(), "densify in.geojson -i 5 -o a.gpkg -q").status.success());
    let mut bytes = fs::read(dir.path().join("a.gpkg")).unwrap();
    let column = b", \"depression\" BOOLEAN";
    let at = bytes.windows(column.len()).position(|w| w == column).unwrap();
    bytes[at + 1] = 0xa0;
    fs::write(dir.path().join("b.gpkg"), bytes).unwrap();
    let output = run(dir.path(), "densify b.gpkg -i 5 -o c.gpkg -q");
    assert!(output.status.success(), "{}", said(&output));
}

#[test]
fn a_geopackage_that_is_cut_off_is_told_once() {
    let dir = folder();
    assert!(run(dir.path(), "densify in.geojson -i 5 -o a.gpkg -q").status.success());
    let bytes = fs::read(dir.path().join("a.gpkg")).unwrap();
    fs::write(dir.path().join("b.gpkg"), &bytes[..bytes.len() / 2]).unwrap();
    let output = run(dir.path(), "densify b.gpkg -i 5 -o c.gpkg -q");
    assert_eq!(output.status.code(), Some(1));
    assert_eq!(said(&output).matches("malformed").count(), 1, "{}", said(&output));
}

#[test]
fn more_cells_than_there_can_be_leave_the_earlier_file_and_nothing_else() {
    let dir = folder();
    for (line, target) in [
        ("dem in.geojson -o out.tif", "out.tif"),
        ("densify in.geojson -i 5 -o new.gpkg --dem out.tif", "out.tif"),
        ("derive in.geojson --slope out.tif", "out.tif"),
        ("compare in.geojson in.geojson --report out.html", "out.html"),
    ] {
        for cell in ["1e-5", "1e-300"] {
            fs::write(dir.path().join(target), "earlier").unwrap();
            let before = names(dir.path());
            let output = run(dir.path(), &format!("{line} --cell {cell} -q --overwrite"));
            assert_eq!(output.status.code(), Some(2), "{line} {cell}: {}", said(&output));
            assert!(said(&output).contains("cells: choose a larger cell"), "{line} {cell}: {}", said(&output));
            assert_eq!(fs::read_to_string(dir.path().join(target)).unwrap(), "earlier", "{line}");
            assert_eq!(names(dir.path()), before, "{line}");
        }
    }
}

#[cfg(unix)]
mod unix {
    use std::thread::sleep;
    use std::time::{Duration, Instant};

    use super::*;

    /// Runs a command line under a limit of the size of files, in blocks of 512 or 1024 bytes as the shell has it.
    fn limited(folder: &Path, blocks: u32, line: &str) -> Output {
        let program = assert_cmd::cargo::cargo_bin!("tokosen");
        let script = format!("ulimit -f {blocks}; exec '{}' {line}", program.display());
        Command::new("sh").current_dir(folder).args(["-c", &script]).output().unwrap()
    }

    #[test]
    fn a_disk_that_is_full_leaves_the_earlier_file_and_nothing_else() {
        let dir = folder();
        for target in ["a.gpkg", "a.geojson", "a.fgb", "a.parquet", "a.dxf", "a.shp"] {
            fs::write(dir.path().join(target), "earlier").unwrap();
            let before = names(dir.path());
            let output = limited(dir.path(), 2, &format!("densify in.geojson -i 1 -o {target} -q"));
            assert_eq!(output.status.code(), Some(1), "{target}: {}", said(&output));
            assert!(said(&output).contains(target.split('.').next().unwrap()), "{}", said(&output));
            assert_eq!(fs::read_to_string(dir.path().join(target)).unwrap(), "earlier", "{target}");
            assert_eq!(names(dir.path()), before, "{target}");
        }
        for target in ["a.tif", "a.asc", "a.exr", "a.png", "a.xyz"] {
            fs::write(dir.path().join(target), "earlier").unwrap();
            let before = names(dir.path());
            let output = limited(dir.path(), 2, &format!("dem in.geojson --cell 2 -o {target} -q"));
            assert_eq!(output.status.code(), Some(1), "{target}: {}", said(&output));
            assert_eq!(fs::read_to_string(dir.path().join(target)).unwrap(), "earlier", "{target}");
            assert_eq!(names(dir.path()), before, "{target}");
        }
        assert!(run(dir.path(), "dem in.geojson --cell 5 -o dem.tif -q").status.success());
        let steep = "derive dem.tif --steep-angle 1 --steep-height 0 --steep";
        for (verb, target) in [
            ("mesh in.geojson -o", "a.glb"),
            ("mesh in.geojson -o", "a.obj"),
            ("mesh in.geojson -o", "a.ply"),
            ("derive dem.tif --slope", "a.tif"),
            ("derive dem.tif --aspect", "a.asc"),
            ("derive dem.tif --hillshade", "a.png"),
            (steep, "a.gpkg"),
            (steep, "a.geojson"),
            (steep, "a.shp"),
            ("derive dem.tif --flow-direction", "a.tif"),
            ("derive dem.tif --catchments", "a.gpkg"),
            ("derive dem.tif --catchments", "a.asc"),
            ("compare in.geojson dem.tif -o", "a.tif"),
            ("compare in.geojson dem.tif --report", "a.html"),
            ("regions in.geojson -o", "a.gpkg"),
            ("regions in.geojson -o", "a.geojson"),
            ("skeleton in.geojson -o", "a.gpkg"),
            ("skeleton in.geojson -o", "a.geojson"),
            ("check in.geojson -o", "a.gpkg"),
            ("check in.geojson --repair safe -o", "a.geojson"),
            ("dem in.geojson --cell 400 -o small.asc --preview", "a.png"),
        ] {
            fs::write(dir.path().join(target), "earlier").unwrap();
            let before = names(dir.path());
            let output = limited(dir.path(), 2, &format!("{verb} {target} -q"));
            assert_eq!(output.status.code(), Some(1), "{verb} {target}: {}", said(&output));
            assert!(said(&output).contains(target), "{verb} {target}: {}", said(&output));
            assert_eq!(fs::read_to_string(dir.path().join(target)).unwrap(), "earlier", "{verb} {target}");
            assert_eq!(names(dir.path()), before, "{verb} {target}");
        }
    }

    #[test]
    fn a_program_that_is_interrupted_leaves_nothing_behind() {
        let dir = folder();
        fs::copy(sample("caryville_20m.gpkg"), dir.path().join("big.gpkg")).unwrap();
        fs::write(dir.path().join("out.gpkg"), "earlier").unwrap();
        let before = names(dir.path());
        // A terminal that hangs up stops it where the system tells that this is not ignored; the tests may have been started
        // so that it is.
        let status = fs::read_to_string("/proc/self/status").unwrap_or_default();
        let ignored =
            status.lines().find_map(|line| u64::from_str_radix(line.strip_prefix("SigIgn:")?.trim(), 16).ok());
        let hang_up = ignored.is_some_and(|mask| mask & 1 == 0).then_some("HUP");
        for signal in ["INT", "TERM"].into_iter().chain(hang_up) {
            let line = "densify big.gpkg -i 1 -o out.gpkg --dem out.tif --cell 2 -q --overwrite";
            let mut child = tokosen().current_dir(dir.path()).args(line.split_whitespace()).spawn().unwrap();
            let start = Instant::now();
            // The hidden folders are made before anything is read.
            while names(dir.path()) == before && start.elapsed() < Duration::from_secs(60) {
                sleep(Duration::from_millis(2));
            }
            Command::new("kill").args([format!("-{signal}"), child.id().to_string()]).status().unwrap();
            let status = child.wait().unwrap();
            assert_eq!(status.code(), Some(130), "{signal}");
            assert_eq!(names(dir.path()), before, "{signal}");
            assert_eq!(fs::read_to_string(dir.path().join("out.gpkg")).unwrap(), "earlier", "{signal}");
        }
    }

    #[test]
    fn a_program_that_shall_outlive_its_terminal_does() {
        let dir = folder();
        fs::write(dir.path().join("part.gpkg"), part()).unwrap();
        let before = names(dir.path());
        let line = format!(
            "trap '' HUP; exec {} densify part.gpkg -i 5 -o out.gpkg -q",
            tokosen().get_program().to_string_lossy()
        );
        let mut child = Command::new("sh").current_dir(dir.path()).args(["-c", &line]).spawn().unwrap();
        let start = Instant::now();
        while names(dir.path()) == before && start.elapsed() < Duration::from_secs(60) {
            sleep(Duration::from_millis(2));
        }
        Command::new("kill").args(["-HUP", &child.id().to_string()]).status().unwrap();
        assert_eq!(child.wait().unwrap().code(), Some(0));
        assert!(names(dir.path()).contains(&"out.gpkg".to_owned()));
    }

    #[test]
    fn what_a_killed_run_left_disturbs_no_other() {
        let dir = folder();
        let left = dir.path().join(".tokosen-abc123");
        fs::create_dir(&left).unwrap();
        fs::write(left.join("out.gpkg"), "half").unwrap();
        let output = run(dir.path(), "densify in.geojson -i 5 -o out.gpkg -q");
        assert!(output.status.success(), "{}", said(&output));
        assert_eq!(names(dir.path()), [".tokosen-abc123", "in.geojson", "out.gpkg"]);
    }

    #[test]
    fn an_output_in_the_place_of_its_input_is_whole() {
        let dir = folder();
        std::os::unix::fs::symlink("in.geojson", dir.path().join("link.geojson")).unwrap();
        fs::hard_link(dir.path().join("in.geojson"), dir.path().join("hard.geojson")).unwrap();
        for target in ["hard.geojson", "link.geojson", "./in.geojson"] {
            let output = run(dir.path(), &format!("densify in.geojson -i 5 -o {target} -q --overwrite"));
            // Either is right: a plain word, or the whole of it.
            if output.status.success() {
                let text = fs::read_to_string(dir.path().join(target)).unwrap();
                assert!(serde_json::from_str::<serde_json::Value>(&text).is_ok(), "{target}");
            } else {
                assert!(said(&output).contains("is an input"), "{target}: {}", said(&output));
            }
        }
    }
}
