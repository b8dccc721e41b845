//! Runs that are saved with `--save-run` and repeated with `--run`.

#![allow(clippy::unwrap_used, reason = "helpers of tests are tests too")]

use std::fs;
use std::path::Path;

use serde_json::{Value, json};

use crate::common::Folder;
use crate::running::{Running, folder_with, run, said, tokosen};

fn saved(folder: &Folder, name: &str) -> Value {
    serde_json::from_str(&fs::read_to_string(folder.path(name)).unwrap()).unwrap()
}

/// Changes a saved run.
fn change(folder: &Folder, name: &str, change: impl FnOnce(&mut Value)) {
    let mut run = saved(folder, name);
    change(&mut run);
    fs::write(folder.path(name), run.to_string()).unwrap();
}

const DEM: &str = "dem in.geojson --cell 5 -o out.tif --save-run run.json";

fn folder() -> Folder {
    folder_with("fig1f_nested.geojson", "in.geojson")
}

#[test]
fn a_repeated_run_writes_the_same_bytes_from_any_folder() {
    let folder = folder();
    for (line, outputs) in [
        (DEM, &["out.tif"][..]),
        (
            "densify in.geojson -i 2 -o out.gpkg --dem dense.tif --cell 5 --save-run=run.json",
            &["out.gpkg", "dense.tif"],
        ),
        ("--save-run run.json -q derive in.geojson --cell 5 --slope slope.tif", &["slope.tif"]),
        ("contour out.tif -i 5 -o lines.geojson --save-run run.json", &["lines.geojson"]),
        ("mesh in.geojson -o out.glb --save-run run.json --threads 1", &["out.glb"]),
        ("check in.geojson -o out.geojson --save-run run.json", &["out.geojson"]),
        ("check in.geojson --json --save-run run.json", &[]),
        ("compare in.geojson out.tif --report out.html --save-run run.json", &["out.html"]),
        ("regions in.geojson -o regions.geojson --save-run run.json", &["regions.geojson"]),
        ("skeleton in.geojson -o skeleton.geojson --save-run run.json", &["skeleton.geojson"]),
    ] {
        let first_said = run(folder.0.path(), line);
        assert!(first_said.status.success(), "{line}: {}", said(&first_said));
        let first: Vec<Vec<u8>> = outputs.iter().map(|name| fs::read(folder.path(name)).unwrap()).collect();
        outputs.iter().for_each(|name| fs::remove_file(folder.path(name)).unwrap());
        let elsewhere = tempfile::tempdir().unwrap();
        let output =
            tokosen().current_dir(elsewhere.path()).arg("--run").arg(folder.path("run.json")).output().unwrap();
        assert!(output.status.success(), "{line}: {}", said(&output));
        assert!(!said(&output).contains("warning:"), "{line}: {}", said(&output));
        assert!(outputs.iter().map(|name| fs::read(folder.path(name)).unwrap()).eq(first), "{line}");
        assert_eq!(fs::read_dir(elsewhere.path()).unwrap().count(), 0);
        if line.contains("--json") {
            assert_eq!(output.stdout, first_said.stdout);
            serde_json::from_slice::<Value>(&output.stdout).unwrap();
        }
    }
}

#[test]
fn the_file_holds_what_the_run_was() {
    let folder = folder();
    folder.succeeds(DEM);
    let run = saved(&folder, "run.json");
    assert_eq!(run["arguments"], json!(["dem", "in.geojson", "--cell", "5", "-o", "out.tif"]));
    assert_eq!(run["version"], env!("CARGO_PKG_VERSION"));
    assert_eq!(Path::new(run["folder"].as_str().unwrap()), folder.path("").canonicalize().unwrap());
    let size = fs::metadata(folder.path("in.geojson")).unwrap().len();
    assert_eq!((&run["inputs"][0]["file"], &run["inputs"][0]["bytes"]), (&json!("in.geojson"), &json!(size)));
    assert_eq!(run["inputs"].as_array().unwrap().len(), 1);
    assert!(run["chosen"]["tension"].is_f64() && run["chosen"]["interval"] == 10.0, "{run}");

    // What was chosen is what the summary tells.
    let told = folder.succeeds("dem in.geojson --cell 5 -o out.tif -v");
    let tension = format!("tension {:.2}", run["chosen"]["tension"].as_f64().unwrap());
    assert!(told.contains(&tension), "{told}");
}

#[test]
fn changed_inputs_are_told_and_missing_ones_are_an_error() {
    let folder = folder();
    fs::copy(folder.path("in.geojson"), folder.path("kept.geojson")).unwrap();
    folder.succeeds(DEM);
    let first = fs::read(folder.path("out.tif")).unwrap();
    let text = fs::read_to_string(folder.path("in.geojson")).unwrap();
    fs::write(folder.path("in.geojson"), text.clone() + "\n").unwrap();
    let told = folder.succeeds("--run run.json");
    assert!(told.contains("warning: the input in.geojson has changed"), "{told}");
    // The same size with other content.
    fs::write(folder.path("in.geojson"), text.replacen(' ', "\n", 1)).unwrap();
    let told = folder.succeeds("--run run.json");
    assert!(told.contains("other content"), "{told}");
    assert_eq!(fs::read(folder.path("out.tif")).unwrap(), first);
    assert_eq!(folder.succeeds("--run run.json -q"), "");

    fs::remove_file(folder.path("in.geojson")).unwrap();
    let told = folder.ends("--run run.json", 1);
    assert!(told.contains("run.json") && told.contains("missing: in.geojson"), "{told}");
}

#[test]
fn files_beside_an_input_and_in_a_folder_count() {
    let folder = folder();
    folder.succeeds("check in.geojson --repair safe -o lines.shp");
    folder.succeeds("dem lines.shp --cell 5 -o out.tif --save-run run.json");
    let names = |run: &Value| -> Vec<String> {
        run["inputs"].as_array().unwrap().iter().map(|i| i["file"].as_str().unwrap().to_owned()).collect()
    };
    let files = names(&saved(&folder, "run.json"));
    assert!(
        ["lines.shp", "lines.dbf", "lines.shx"].iter().all(|name| files.iter().any(|file| file == name)),
        "{files:?}"
    );

    fs::create_dir(folder.path("sheets")).unwrap();
    fs::copy(folder.path("in.geojson"), folder.path("sheets/a.geojson")).unwrap();
    folder.succeeds("dem sheets --cell 5 -o out.tif --save-run run.json");
    assert_eq!(names(&saved(&folder, "run.json")), ["sheets/a.geojson"]);
    fs::copy(folder.path("in.geojson"), folder.path("sheets/b.geojson")).unwrap();
    let told = folder.succeeds("--run run.json");
    assert!(told.contains("sheets/b.geojson was not there"), "{told}");
}

#[test]
fn other_files_are_no_saved_runs() {
    let folder = folder();
    folder.succeeds(DEM);
    let whole = fs::read_to_string(folder.path("run.json")).unwrap();
    fs::write(folder.path("empty.json"), "").unwrap();
    fs::write(folder.path("half.json"), &whole[..whole.len() / 2]).unwrap();
    fs::write(folder.path("deep.json"), "[".repeat(100_000)).unwrap();
    for name in ["in.geojson", "empty.json", "half.json", "deep.json"] {
        let told = folder.ends(&format!("--run {name}"), 1);
        assert!(told.contains(name) && told.contains("is no run that"), "{told}");
    }
    assert!(folder.ends("--run missing.json", 1).contains("missing.json"));
    let changed = |change_of: fn(&mut Value)| {
        fs::write(folder.path("other.json"), &whole).unwrap();
        change(&folder, "other.json", change_of);
    };
    changed(|run| run["layout"] = json!(99));
    let told = folder.ends("--run other.json", 1);
    assert!(told.contains("layout 99 of another version"), "{told}");
    changed(|run| run["arguments"] = json!("dem"));
    assert!(folder.ends("--run other.json", 1).contains("is broken"));
    changed(|run| run["folder"] = json!("/no/such/folder"));
    assert!(folder.ends("--run other.json", 1).contains("/no/such/folder"));
    for wrong in [json!([]), json!(["dem", "--new-flag"]), json!(["--help"]), json!(["--run", "run.json"])] {
        fs::write(folder.path("other.json"), &whole).unwrap();
        change(&folder, "other.json", |run| run["arguments"] = wrong);
        let told = folder.ends("--run other.json", 2);
        assert!(told.contains("do not fit this version"), "{told}");
    }
    changed(|run| run["version"] = json!("0.0.1"));
    let told = folder.succeeds("--run other.json");
    assert!(told.contains("warning: the run was saved by version 0.0.1"), "{told}");
}

#[test]
fn only_the_options_of_every_verb_go_with_a_run() {
    let folder = folder();
    folder.succeeds("dem in.geojson --cell 5 -o out.xyz --save-run run.json");
    for wrong in
        ["--run run.json -o other.tif", "dem --run run.json in.geojson", "--run", "--run run.json --save-run a.tif"]
    {
        folder.ends(wrong, 2);
    }
    // A file without a place for the name of its program is not replaced.
    let told = folder.ends("--run run.json", 1);
    assert!(told.contains("out.xyz exists"), "{told}");
    folder.succeeds("--run run.json --overwrite -v --threads 2");
    // A repeated run can be saved again, also over its own file.
    let first = saved(&folder, "run.json");
    folder.succeeds("--run run.json --overwrite --save-run again.json");
    assert_eq!(saved(&folder, "again.json"), first);
    folder.succeeds("--run run.json --overwrite --save-run run.json");
    assert_eq!(saved(&folder, "run.json"), first);
}

#[test]
fn the_file_appears_whole_or_not_at_all_and_replaces_its_own_kind_only() {
    let folder = folder();
    let names = || {
        let mut names: Vec<_> = fs::read_dir(folder.path("")).unwrap().map(|e| e.unwrap().file_name()).collect();
        names.sort();
        names
    };
    // A run that fails saves nothing.
    folder.ends("dem in.geojson --cell 5000 -o out.tif --save-run run.json", 2);
    assert_eq!(names(), ["in.geojson"]);
    assert!(folder.ends("dem in.geojson --cell 5 -o out.tif --save-run run.txt", 2).contains(".json"));
    assert!(folder.ends("dem in.geojson --cell 5 -o out.tif --save-run no/run.json", 1).contains("no"));
    let told = folder.ends("densify in.geojson -i 2 -o out.json --save-run out.json", 2);
    assert!(told.contains("two outputs"), "{told}");
    let told = folder.ends("dem in.geojson --cell 5 -o out.tif --save-run in.geojson", 2);
    assert!(told.contains(".json"), "{told}");
    fs::copy(folder.path("in.geojson"), folder.path("in.json")).unwrap();
    let told = folder.ends("dem in.json --cell 5 -o out.tif --save-run in.json", 2);
    assert!(told.contains("is an input"), "{told}");
    fs::remove_file(folder.path("in.json")).unwrap();

    fs::write(folder.path("run.json"), "{\"mine\": true}").unwrap();
    assert!(folder.ends(DEM, 1).contains("run.json exists"));
    assert_eq!(names(), ["in.geojson", "run.json"]);
    folder.succeeds(&format!("{DEM} --overwrite"));
    folder.succeeds(DEM);
    let status = run(folder.0.path(), "--run run.json").status;
    assert!(status.success());
}
