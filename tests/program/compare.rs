//! `tokosen compare` as its users meet it, and that its figures are what they are said to be.

#![allow(clippy::unwrap_used, reason = "helpers of tests are tests too")]

use std::fs;
use std::process::Output;

use assert_cmd::cargo::cargo_bin_cmd;
use serde_json::Value;
use tokosen::io::raster::read_dem;

use crate::common;
use crate::guide_pages::{self, commands, inputs};
use crate::running::part;

/// These tests.
struct Here;

type Folder = common::Folder<Here>;

impl Folder {
    /// Writes an ESRI ASCII grid with its north-west corner at (1000, 2000 + 10 * rows).
    fn put_grid(&self, name: &str, west: f64, size: [usize; 2], height: impl Fn(usize, usize) -> f64) -> &Self {
        let [cols, rows] = size;
        let mut text =
            format!("ncols {cols}\nnrows {rows}\nxllcorner {west}\nyllcorner 2000\ncellsize 10\nNODATA_value -9999\n");
        for row in 0..rows {
            let heights: Vec<String> = (0..cols).map(|col| height(col, row).to_string()).collect();
            text.push_str(&heights.join(" "));
            text.push('\n');
        }
        fs::write(self.path(name), text).unwrap();
        self
    }

    fn run(&self, arguments: &str) -> Output {
        let output =
            cargo_bin_cmd!("tokosen").current_dir(self.0.path()).args(arguments.split_whitespace()).output().unwrap();
        assert!(!stderr(&output).contains("panicked"), "{arguments}: {}", stderr(&output));
        output
    }

    fn succeeds(&self, arguments: &str) -> String {
        let output = self.run(arguments);
        assert_eq!(output.status.code(), Some(0), "{arguments}: {}", stderr(&output));
        String::from_utf8(output.stdout).unwrap()
    }

    fn json(&self, arguments: &str) -> Value {
        serde_json::from_str(&self.succeeds(&format!("{arguments} --json"))).unwrap()
    }

    fn fails(&self, arguments: &str, status: i32, word: &str) {
        let output = self.run(arguments);
        let text = stderr(&output);
        assert_eq!(output.status.code(), Some(status), "{arguments}: {text}");
        assert!(text.contains("error: ") && text.contains(word), "{arguments}: no {word:?} in {text}");
    }
}

fn stderr(output: &Output) -> String {
    String::from_utf8(output.stderr.clone()).unwrap()
}

/// A folder with a part of the sample's contours, and the ground that they were cut from.
fn with_sample() -> Folder {
    let folder = Folder::new();
    fs::write(folder.path("in.gpkg"), part()).unwrap();
    fs::copy(concat!(env!("CARGO_MANIFEST_DIR"), "/samples/caryville_20m_truth.tif"), folder.path("truth.tif"))
        .unwrap();
    folder
}

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or_else(|| panic!("{value} is no number"))
}

#[test]
fn a_plane_and_the_same_plane_shifted() {
    let folder = Folder::new();
    let plane = |col: usize, row: usize| 100.0 + 2.5 * col as f64 + row as f64;
    folder.put_grid("b.asc", 1000.0, [12, 9], plane).put_grid("a.asc", 1000.0, [12, 9], |c, r| plane(c, r) - 1.25);
    let found = folder.json("compare a.asc b.asc --sigma 0.5 -o d.tif");
    let overall = &found["overall"];
    assert_eq!(overall["cells"], 108);
    for (key, value) in
        [("bias", -1.25), ("rmse", 1.25), ("rmse_debiased", 0.0), ("mae", 1.25), ("nmad", 0.0), ("le90", 1.25)]
    {
        assert_eq!(number(&overall[key]), value, "{key}");
    }
    assert_eq!(number(&found["slope"]["rmse"]), 0.0);
    assert_eq!(number(&found["significance"]["share"]), 1.0);
    assert_eq!(number(&found["significance"]["rmse_beyond"]), (1.25f64 * 1.25 - 0.25).sqrt());
    // atan(hypot(0.25, 0.1)) = 15.07 degrees.
    assert_eq!(found["by_slope"][2]["statistics"]["cells"], 108);
    assert!(found["by_slope"][0]["statistics"].is_null());
    let difference = read_dem(&folder.path("d.tif")).unwrap().value.dem;
    assert!(difference.values.len() == 108 && difference.values.iter().all(|d| *d == -1.25));
}

#[test]
fn the_reference_stays_as_it_is_on_other_grids() {
    let folder = Folder::new();
    let plane = |col: usize, row: usize| 3.0 * col as f64 - row as f64;
    folder.put_grid("b.asc", 1000.0, [12, 9], plane).put_grid("a.asc", 1015.0, [12, 9], |c, r| plane(c, r) + 4.5);
    // Columns 2 to 11 of B lie between the centres of A, one and a half cells further east.
    let found = folder.json("compare a.asc b.asc");
    assert_eq!(found["overall"]["cells"], 10 * 9);
    assert!(number(&found["overall"]["rmse"]) < 1e-6, "{}", found["overall"]);
    assert!(found["notes"][0].as_str().unwrap().contains("interpolated"), "{}", found["notes"]);
    assert_eq!((&found["b"]["precision"], &found["a"]["precision"]), (&"whole-metres".into(), &"tenths".into()));
    let text = folder.succeeds("compare a.asc b.asc");
    assert!(text.contains("All heights of A are tenths of a metre") && text.contains("RMSE"), "{text}");
}

#[test]
fn terraces_are_told_of_a_triangulation_and_of_nothing_else() {
    let folder = with_sample();
    // On the steep ground of the part, terraces are too narrow to be seen without the contours.
    fs::copy(concat!(env!("CARGO_MANIFEST_DIR"), "/samples/caryville_20m.gpkg"), folder.path("in.gpkg")).unwrap();
    let linear = folder.json("compare in.gpkg truth.tif --surface linear");
    let spline = folder.json("compare in.gpkg truth.tif");
    assert_eq!(linear["a"]["levels"]["terraced"], true, "{}", linear["a"]["levels"]);
    assert_eq!(linear["b"]["levels"]["terraced"], false, "{}", linear["b"]["levels"]);
    assert_eq!(spline["a"]["levels"]["terraced"], false, "{}", spline["a"]["levels"]);
    assert!(number(&spline["overall"]["rmse"]) < number(&linear["overall"]["rmse"]));
    // A height map made so betrays itself without its contours.
    folder.succeeds("dem in.gpkg --surface linear --like truth.tif -o tin.tif");
    let text = folder.succeeds("compare tin.tif truth.tif");
    assert!(text.contains("A has terraces") && text.contains("contours 20 m apart"), "{text}");
    assert!(!text.contains("B has terraces"), "{text}");
    // The figures are those of the height map at the same cells.
    let through_file = folder.json("compare tin.tif truth.tif");
    assert_eq!(through_file["overall"], linear["overall"]);
}

#[test]
fn the_keys_that_are_promised_are_there() {
    let folder = with_sample();
    let found = folder.json("compare in.gpkg truth.tif --surface linear --sigma 2");
    for key in [
        "sources",
        "notes",
        "size",
        "cell",
        "overall",
        "by_slope",
        "by_elevation",
        "by_distance",
        "slope",
        "significance",
        "bands",
        "a",
        "b",
        "findings",
    ] {
        assert!(!found[key].is_null(), "{key}");
    }
    for key in ["cells", "bias", "rmse", "rmse_debiased", "mae", "median", "nmad", "le90", "le95"] {
        assert!(found["overall"][key].is_number(), "{key}");
    }
    assert!(found["overall"]["lowest"]["place"][1].is_number());
    let cells = |classes: &Value| -> u64 {
        classes.as_array().unwrap().iter().filter_map(|c| c["statistics"]["cells"].as_u64()).sum()
    };
    for classes in ["by_slope", "by_elevation", "by_distance"] {
        assert_eq!(cells(&found[classes]), found["overall"]["cells"].as_u64().unwrap(), "{classes}");
    }
    // The contours were cut from this ground, so that hardly a cell of it is on the wrong side of one.
    assert!(number(&found["bands"]["share"]) < 0.02, "{}", found["bands"]);
    let one = folder.succeeds("compare in.gpkg truth.tif --surface linear --sigma 2 --json --threads 1");
    assert_eq!(serde_json::from_str::<Value>(&one).unwrap(), found);
}

#[test]
fn contours_may_stand_on_either_side_and_on_both() {
    let folder = with_sample();
    let ahead = folder.json("compare in.gpkg truth.tif --surface skeleton");
    let back = folder.json("compare truth.tif in.gpkg --surface skeleton");
    assert_eq!(number(&ahead["overall"]["rmse"]), number(&back["overall"]["rmse"]));
    assert_eq!(number(&ahead["overall"]["bias"]), -number(&back["overall"]["bias"]));
    let same = folder.json("compare in.gpkg in.gpkg --surface skeleton --cell 50");
    assert_eq!(number(&same["overall"]["rmse"]), 0.0);
    assert!(same["bands"].is_null());
}

#[test]
fn degrees_are_compared_where_they_are() {
    let folder = with_sample();
    folder.succeeds("dem in.gpkg --surface skeleton --cell-degrees 2s -o degrees.tif");
    let found = folder.json("compare in.gpkg degrees.tif --surface skeleton");
    assert!(number(&found["overall"]["highest"]["value"]) < 1e-3, "{}", found["overall"]);
    assert!(number(&found["bands"]["share"]) < 1e-3, "{}", found["bands"]);
    // Slopes are those of the ground, and not of metres over degrees.
    let steep = found["by_slope"][4]["statistics"]["cells"].as_u64().unwrap_or(0);
    assert!(steep * 5 < found["overall"]["cells"].as_u64().unwrap(), "{steep}");
}

#[test]
fn places_of_findings_are_told_in_the_coordinates_of_their_file() {
    let folder = Folder::new();
    let line = |points: &str, elev: u32| {
        format!(
            r#"{{"type":"Feature","properties":{{"elev":{elev}}},"geometry":{{"type":"LineString","coordinates":[{points}]}}}}"#
        )
    };
    let lines = [
        line("[137.64,36.33],[137.645,36.33],[137.645,36.33],[137.65,36.331]", 10),
        line("[137.64,36.34],[137.65,36.341]", 20),
    ];
    let file = format!(r#"{{"type":"FeatureCollection","features":[{}]}}"#, lines.join(","));
    fs::write(folder.path("degrees.geojson"), file).unwrap();
    folder.succeeds("dem degrees.geojson --surface linear --cell-degrees 2s -o like.tif");
    let found = folder.json("compare like.tif degrees.geojson --surface linear");
    let place = &found["findings"][0]["place"];
    assert!((number(&place[0]) - 137.645).abs() < 1e-9 && (number(&place[1]) - 36.33).abs() < 1e-9, "{place}");
    assert!(found["findings"][0]["message"].as_str().unwrap().starts_with("B: "), "{}", found["findings"]);
    let output = folder.run("compare like.tif degrees.geojson --surface linear");
    assert!(stderr(&output).contains("at 137.6450000 36.3300000"), "{}", stderr(&output));
}

#[test]
fn a_height_map_without_a_system_is_in_that_of_the_other_side() {
    let folder = with_sample();
    folder.succeeds("dem in.gpkg --surface linear --cell-degrees 2s -o named.tif");
    // The text format keeps no system; without the file beside it the grid names none.
    folder.succeeds("dem in.gpkg --surface linear --cell-degrees 2s -o degrees.asc");
    let prj = folder.path("degrees.prj");
    if prj.exists() {
        fs::remove_file(prj).unwrap();
    }
    let found = folder.json("compare degrees.asc named.tif");
    assert!(number(&found["slope"]["rmse"]) < 0.1, "{}", found["slope"]);
    let named = found["notes"].as_array().unwrap().iter().any(|n| n.as_str().unwrap().starts_with("A names no"));
    assert!(named, "{}", found["notes"]);
    folder.fails("compare degrees.asc degrees.asc", 1, "look like degrees");
    // Contours in degrees are processed in metres; the height map's numbers are those of the contours' file.
    fs::write(
        folder.path("degrees.geojson"),
        r#"{"type":"FeatureCollection","features":[
        {"type":"Feature","properties":{"elev":10},"geometry":{"type":"LineString","coordinates":[[138.0,36.0],[138.01,36.0]]}},
        {"type":"Feature","properties":{"elev":20},"geometry":{"type":"LineString","coordinates":[[138.0,36.01],[138.01,36.01]]}}]}"#,
    )
    .unwrap();
    folder.succeeds("dem degrees.geojson --surface linear --cell-degrees 2s -o plain.asc");
    let _ = fs::remove_file(folder.path("plain.prj"));
    let found = folder.json("compare degrees.geojson plain.asc --surface linear");
    assert!(number(&found["overall"]["rmse"]) < 0.01, "{}", found["overall"]);
    assert!(found["notes"][1].as_str().unwrap().starts_with("B names no"), "{}", found["notes"]);
}

#[test]
fn check_points_check_and_are_not_built_in() {
    let folder = with_sample();
    let plane = |col: usize, row: usize| 100.0 + 2.0 * col as f64 + row as f64;
    folder.put_grid("b.asc", 1000.0, [12, 9], plane).put_grid("a.asc", 1000.0, [12, 9], |c, r| plane(c, r) + 1.0);
    let point = |x: f64, y: f64, z: f64| {
        format!(
            r#"{{"type":"Feature","properties":{{"elev":{z}}},"geometry":{{"type":"Point","coordinates":[{x},{y}]}}}}"#
        )
    };
    // On the centre of column 3, row 8, and between columns 3 and 4; the third lies outside.
    let points = [point(1035.0, 2005.0, 113.0), point(1040.0, 2005.0, 115.5), point(9000.0, 9000.0, 1.0)];
    let file = format!(r#"{{"type":"FeatureCollection","features":[{}]}}"#, points.join(","));
    fs::write(folder.path("points.geojson"), &file).unwrap();
    let found = folder.json("compare a.asc b.asc --points points.geojson");
    let (a, b) = (&found["a"]["points"], &found["b"]["points"]);
    // A is 115 and 116 there, B a metre less.
    assert_eq!((&a["cells"], number(&a["bias"]), number(&a["highest"]["value"])), (&2.into(), 1.25, 2.0));
    assert_eq!((number(&b["bias"]), number(&b["lowest"]["value"])), (0.25, -0.5));
    let told = found["findings"].to_string();
    assert!(told.contains("points.geojson: 1 of 3 check points are not where A and B have heights"), "{told}");
    // In feet they are lower: 115 and 116 against a third of 113 and 115.5.
    let found = folder.json("compare a.asc b.asc --points points.geojson --unit ft");
    assert!(
        (number(&found["a"]["points"]["bias"]) - (115.5 - 0.3048 * 114.25)).abs() < 1e-9,
        "{}",
        found["a"]["points"]
    );
    let far = format!(r#"{{"type":"FeatureCollection","features":[{}]}}"#, point(9000.0, 9000.0, 1.0));
    fs::write(folder.path("far.geojson"), far).unwrap();
    folder.fails("compare a.asc b.asc --points far.geojson", 1, "no check point");

    // A surface must not know the points that it is checked at.
    let truth = read_dem(&folder.path("truth.tif")).unwrap().value.dem;
    let (cols, rows) = (truth.grid.cols, truth.grid.rows);
    let points: Vec<String> = (1..100)
        .map(|k| (cols * (k % 10) / 10, rows * (k / 10) / 10))
        .map(|(col, row)| (truth.grid.center(col, row), truth.values[row * cols + col]))
        .map(|(p, z)| point(p.x, p.y, z.into()))
        .collect();
    let file = format!(r#"{{"type":"FeatureCollection","features":[{}]}}"#, points.join(","));
    fs::write(folder.path("points.geojson"), file).unwrap();
    let plain = folder.json("compare in.gpkg truth.tif --surface linear");
    let found = folder.json("compare in.gpkg truth.tif --surface linear --points points.geojson");
    assert_eq!(found["overall"], plain["overall"]);
    assert!(number(&found["a"]["points"]["rmse"]) > 0.5, "{}", found["a"]);
    assert!(number(&found["b"]["points"]["rmse"]) < 1e-3, "{}", found["b"]);
}

#[test]
fn the_page_needs_nothing_else() {
    let folder = Folder::new();
    folder.put_grid("b&b.asc", 1000.0, [12, 9], |c, r| (c * r) as f64);
    folder.put_grid("a<i>.asc", 1000.0, [12, 9], |c, r| if c == 4 { -9999.0 } else { (c + r) as f64 });
    folder.succeeds("compare a<i>.asc b&b.asc --report page.html");
    let page = fs::read_to_string(folder.path("page.html")).unwrap();
    assert!(page.contains("a&lt;i&gt;.asc") && page.contains("b&amp;b.asc") && !page.contains("<i>"));
    assert!(page.matches("<svg").count() >= 6 && page.contains("data:image/png;base64,"));
    assert!(!page.contains("<script") && !page.contains("<link"));
    assert_eq!(page.matches("http").count(), page.matches("xmlns=\"http://www.w3.org/2000/svg\"").count());
}

/// The data of a page in 3-D.
fn data_of(page: &str) -> Value {
    let data = page.split("id=\"data\">").nth(1).and_then(|rest| rest.split("</script>").next()).unwrap();
    serde_json::from_str(data).unwrap()
}

#[test]
fn differences_are_shown_on_the_terrain() {
    let folder = with_sample();
    let plane = |c: usize, r: usize| 100.0 + 2.0 * (c + r) as f64;
    let odd = |c: usize, r: usize| if (c, r) == (8, 3) { 12.0 } else { 0.25 };
    folder.put_grid("a.asc", 1000.0, [40, 30], plane);
    folder.put_grid("b.asc", 1000.0, [40, 30], |c, r| if c < 5 { -9999.0 } else { plane(c, r) - odd(c, r) });
    let said = folder.succeeds("compare a.asc b.asc --page page.html -o difference.tif");
    assert!(said.contains("written    page.html"), "{said}");
    let data = data_of(&fs::read_to_string(folder.path("page.html")).unwrap());
    assert_eq!((&data["title"], number(&data["limit"])), (&"a.asc − b.asc".into(), 0.5));
    let grid = &data["grid"];
    assert_eq!((&grid["cols"], &grid["rows"], number(&grid["cell"])), (&35.into(), &30.into(), 10.0));
    let largest = &data["findings"][0];
    assert_eq!((&largest["message"], &largest["severity"]), (&"+12.00 m".into(), &"note".into()));
    let place = |k: usize| number(&largest["place"][k]) + number(&data["origin"][k]);
    assert_eq!([place(0), place(1)], [1085.0, 2265.0]);
    assert!(data["packed"]["differences"].is_string() && data["lines"].as_object().unwrap().is_empty());

    // On the plane of the contours, with these; the height map is in degrees.
    folder.succeeds("dem in.gpkg --surface linear --cell-degrees 2s -o degrees.tif");
    folder.succeeds("compare in.gpkg degrees.tif --surface skeleton --page metres.html");
    let data = data_of(&fs::read_to_string(folder.path("metres.html")).unwrap());
    assert!(data["crs"].as_str().unwrap().contains("UTM zone 16N") && data["lines"]["input"].is_string());
    let cell = number(&data["grid"]["cell"]);
    assert!((50.0..65.0).contains(&cell), "{cell}");
    assert!((number(&data["origin"][0]) - 747_000.0).abs() < 3000.0, "{}", data["origin"]);
    // Two height maps in degrees, one of which names no system; and contours as B.
    folder.succeeds("dem in.gpkg --surface linear --cell-degrees 2s -o nameless.asc");
    let _ = fs::remove_file(folder.path("nameless.prj"));
    folder.succeeds("compare nameless.asc degrees.tif --page again.html");
    let again = data_of(&fs::read_to_string(folder.path("again.html")).unwrap());
    assert!(again["crs"].as_str().unwrap().contains("UTM zone 16N") && again["lines"].get("input").is_none());
    folder.succeeds("compare degrees.tif in.gpkg --surface skeleton --page turned.html");
    let turned = data_of(&fs::read_to_string(folder.path("turned.html")).unwrap());
    assert_eq!(turned["grid"], data["grid"]);
    folder.fails("compare a.asc b.asc --page page.pdf", 2, "pages are written as .html, .htm");
}

#[test]
fn the_commands_of_the_guide_compare() {
    let folder = inputs();
    std::fs::copy(folder.path("published_dem.tif"), folder.path("mine.tif")).unwrap();
    for (from, to) in [("contours.gpkg", "old_contours.gpkg"), ("contours.gpkg", "new_contours.gpkg")] {
        std::fs::copy(folder.path(from), folder.path(to)).unwrap();
    }
    let commands = commands(include_str!("../../src/guide/comparing.md"));
    assert_eq!(commands.len(), 5);
    commands.into_iter().for_each(|command| assert!(!guide_pages::run(&folder, command).is_empty()));
    assert!(folder.path("differences.html").exists() && folder.path("differences.pdf").exists());
}

#[test]
fn denser_contours_and_the_comparison_come_from_one_run() {
    let folder = with_sample();
    let text = folder.succeeds("densify in.gpkg -i 10 -o o.gpkg --compare truth.tif --report page.html");
    assert!(folder.path("o.gpkg").exists() && folder.path("page.html").exists());
    let alone = folder.succeeds("compare in.gpkg truth.tif");
    // The smooth surface is on its own grid there, and on that of the height map here.
    let cells = |text: &str| text.lines().find(|line| line.starts_with("all cells")).unwrap().to_owned();
    let (here, there) = (cells(&text), cells(&alone));
    assert_eq!(here.split_whitespace().nth(2), there.split_whitespace().nth(2), "{here} {there}");
    folder.fails("densify in.gpkg -i 10 -o p.gpkg --compare in.gpkg", 1, "holds contours");
    folder.fails("densify in.gpkg -i 10 -o p.gpkg --report q.html", 2, "--compare");
    assert!(!folder.path("p.gpkg").exists());
}

#[test]
fn what_cannot_be_compared_is_told() {
    let folder = with_sample();
    folder.put_grid("a.asc", 1000.0, [4, 4], |c, _| c as f64).put_grid("far.asc", 9000.0, [4, 4], |c, _| c as f64);
    folder.put_grid("void.asc", 1000.0, [4, 4], |_, _| -9999.0);
    folder.fails("compare a.asc far.asc", 1, "overlap");
    folder.fails("compare a.asc void.asc", 1, "");
    folder.fails("compare a.asc missing.tif", 1, "missing.tif");
    fs::write(folder.path("notes.txt"), "x").unwrap();
    folder.fails("compare a.asc notes.txt", 1, "neither a height map");
    folder.fails("compare in.gpkg in.gpkg", 2, "--cell");
    folder.fails("compare a.asc a.asc --cell 5", 2, "--cell");
    folder.fails("compare a.asc a.asc --surface linear", 2, "--surface applies to contours");
    folder.fails("compare a.asc a.asc --unit ft", 2, "--unit applies to contours");
    folder.fails("compare a.asc a.asc -o d.png --png-encoding gsi", 2, "--png-encoding");
    folder.fails("compare a.asc a.asc --sigma 0", 2, "--sigma");
    folder.fails("compare a.asc a.asc --interval -1", 2, "--interval");
    folder.fails("compare a.asc a.asc --report page.pdf", 2, ".html");
    folder.fails("compare a.asc a.asc -o a.asc", 2, "is an input");
    folder.fails("compare a.asc", 2, "<B>");
    assert!(!folder.path("page.pdf").exists());
}
