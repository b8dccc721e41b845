//! The page for map tiles: which sets it shows, what it says of them, and wrong usage. `scripts/checks/check_viewer.py` opens it
//! in a browser.

#![allow(clippy::unwrap_used, reason = "helpers of tests are tests too")]

use std::fs;

use crate::common::Folder;
use crate::running::{Running, folder_with_part};

/// Status of wrong usage.
const USAGE: i32 = 2;
/// Status of work that failed.
const FAILED: i32 = 1;

/// What a page knows: its title, and the names of its sets with the extension of their tiles.
fn page(folder: &Folder, name: &str) -> (String, Vec<String>) {
    let page = fs::read_to_string(folder.path(name)).unwrap();
    let data = page.split("id=\"data\">").nth(1).and_then(|rest| rest.split("</script>").next()).unwrap();
    let data: serde_json::Value = serde_json::from_str(data).unwrap();
    let set = |set: &serde_json::Value| {
        let [name, extension] = ["name", "extension"].map(|key| set[key].as_str().unwrap_or_default());
        format!("{name} {extension}").trim().to_owned()
    };
    (data["title"].as_str().unwrap().to_owned(), data["sets"].as_array().unwrap().iter().map(set).collect())
}

#[test]
fn a_page_shows_the_sets_of_its_folder() {
    let folder = folder_with_part("hills.gpkg");
    fs::create_dir(folder.path("map")).unwrap();
    fs::write(folder.path("map/foreign.pmtiles"), "PMTiles\x03 of another program").unwrap();
    folder.succeeds("densify hills.gpkg -i 20 -o map/a/{z}/{x}/{y}.pbf");
    let said = folder.succeeds("densify hills.gpkg -i 10 -o map/lines.pmtiles --viewer map/index.html");
    assert!(said.contains("index.html (shows lines.pmtiles, a;") && said.contains("range requests"), "{said}");
    assert_eq!(page(&folder, "map/index.html"), ("hills".into(), vec!["lines.pmtiles".into(), "a pbf".into()]));
    // A page of this program is replaced. The sets of the run come first.
    folder.succeeds("dem hills.gpkg --max-zoom 11 -o map/heights.pmtiles --viewer map/index.html");
    assert_eq!(page(&folder, "map/index.html").1, ["heights.pmtiles", "a pbf", "lines.pmtiles"]);
    folder.succeeds("densify hills.gpkg -i 10 -o c.gpkg --dem t.pmtiles --max-zoom 10 --viewer ./t.htm");
    assert_eq!(page(&folder, "t.htm").1, ["t.pmtiles"]);
}

#[test]
fn a_source_is_in_the_tiles() {
    let folder = folder_with_part("in.gpkg");
    folder.succeeds("densify in.gpkg -i 20 -o a/{z}/{x}/{y}.pbf --attribution <i>Survey</i>");
    folder.succeeds("dem in.gpkg --max-zoom 10 -o b/{z}/{x}/{y}.png --attribution <i>Survey</i>");
    folder.succeeds("dem in.gpkg --max-zoom 10 -o c/{z}/{x}/{y}.png");
    let source = |set: &str| {
        let about = fs::read(folder.path(&format!("{set}/metadata.json"))).unwrap();
        serde_json::from_slice::<serde_json::Value>(&about).unwrap()["attribution"].clone()
    };
    assert_eq!(["a", "b"].map(source), ["<i>Survey</i>"; 2]);
    assert!(source("c").is_null());
}

#[test]
fn wrong_usage_is_refused_before_the_work() {
    let folder = folder_with_part("in.gpkg");
    fs::create_dir(folder.path("map")).unwrap();
    for (line, expected) in [
        ("densify in.gpkg -i 5 -o a.gpkg --viewer index.html", "--viewer applies to map tiles"),
        ("dem in.gpkg --cell 10 -o a.tif --attribution me", "--attribution applies to map tiles"),
        ("densify in.gpkg -i 5 -o a.mbtiles --viewer index.html", "a page cannot read a.mbtiles"),
        ("densify in.gpkg -i 5 -o map/a.pmtiles --viewer index.html", "in the folder of the tiles: map/index.html"),
        (
            "densify in.gpkg -i 5 -o map/{z}/{x}/{y}.pbf --viewer map/index.html",
            "in the folder of the tiles: index.html",
        ),
        ("densify in.gpkg -i 5 -o a.pmtiles --viewer index.png", ".html"),
    ] {
        assert!(folder.ends(line, USAGE).contains(expected), "{line}");
    }
    fs::write(folder.path("index.html"), "<!doctype html><title>mine</title>").unwrap();
    let said = folder.ends("densify in.gpkg -i 5 -o a.pmtiles --viewer index.html", FAILED);
    assert!(said.contains("--overwrite"), "{said}");
    assert!(!folder.path("a.pmtiles").exists());
}
