//! A job in feet: what the program says is in the unit and the coordinates of the input, with sensible digits.

#![allow(clippy::unwrap_used, reason = "helpers of tests are tests too")]

use std::fs;

use serde_json::{Value, json};

use crate::common;
use crate::running::{Running, folder_with, part};

/// These tests.
struct Here;

type Folder = common::Folder<Here>;

/// NAD83 / Arizona East (ft) + NAVD88 height (ft).
const FEET: u32 = 8700;

/// Lines from west to east, each at a y and a height, with a hole between two ends in the third of many.
fn slope(crs: u32, heights: &[f64]) -> Value {
    let line = |(k, z): (usize, &f64)| {
        let y = 1_200_000.0 + 300.0 * k as f64;
        let ends = if k == 2 && heights.len() > 4 { vec![(0.0, 900.0), (1000.0, 2400.0)] } else { vec![(0.0, 2400.0)] };
        ends.into_iter()
            .map(|(from, to)| {
                let points: Vec<Value> =
                    (0..=8).map(|i| json!([700_000.0 + from + (to - from) * f64::from(i) / 8.0, y])).collect();
                let geometry = json!({ "type": "LineString", "coordinates": points });
                json!({ "type": "Feature", "properties": { "elev": z }, "geometry": geometry })
            })
            .collect::<Vec<Value>>()
    };
    let features: Vec<Value> = heights.iter().enumerate().flat_map(line).collect();
    let name = json!({ "type": "name", "properties": { "name": format!("urn:ogc:def:crs:EPSG::{crs}") } });
    json!({ "type": "FeatureCollection", "crs": name, "features": features })
}

impl Folder {
    fn put(&self, name: &str, content: &Value) -> &Self {
        fs::write(self.path(name), content.to_string()).unwrap();
        self
    }
}

/// Whether a text says anything in metres.
fn says_metres(text: &str) -> bool {
    text.split_whitespace().any(|word| matches!(word.trim_end_matches([',', ';', ')', '.']), "m" | "metres" | "km"))
}

#[test]
fn proposals_are_in_the_coordinates_and_the_unit_of_the_input() {
    let folder = Folder::new();
    let mut map = slope(FEET, &[40.0, 80.0, 120.0, 160.0, 200.0, 240.0]);
    // The fifth line has the height of no line.
    map["features"][5]["properties"]["elev"] = json!(1600.0);
    folder.put("feet.geojson", &map);
    let said = folder.succeeds("check feet.geojson -v");
    assert!(said.contains("proposed: join 700900.000 1200600.000 and 701000.000 1200600.000"), "{said}");
    assert!(said.contains("proposed: elevation 200 ft instead of 1600 ft"), "{said}");
    assert!(!says_metres(&said), "{said}");
    folder.succeeds("check feet.geojson -o found.geojson");
    let found = fs::read_to_string(folder.path("found.geojson")).unwrap();
    assert!(found.contains("join 700900.000 1200600.000 and 701000.000 1200600.000"), "{found}");
}

#[test]
fn sides_of_profiles_and_volumes_have_their_interval_in_feet() {
    let folder = Folder::new();
    folder.put("feet.geojson", &slope(FEET, &[40.0, 80.0, 120.0, 160.0]));
    let line = json!({ "type": "LineString", "coordinates": [[700_500.0, 1_200_050.0], [701_500.0, 1_200_800.0]] });
    let feature = json!({ "type": "Feature", "properties": {}, "geometry": line });
    let name = json!({ "type": "name", "properties": { "name": "urn:ogc:def:crs:EPSG::8700" } });
    folder.put("road.geojson", &json!({ "type": "FeatureCollection", "crs": name, "features": [feature] }));
    for command in [
        "profile feet.geojson --line road.geojson --to-unit ft -o p.csv",
        "volume feet.geojson --cell 5 --level 100 --to-unit ft",
    ] {
        let said = folder.succeeds(command);
        assert!(said.contains("interval 40 ft") && !says_metres(&said), "{said}");
    }
    // Without the option the results are in metres, and the option is named.
    let said = folder.succeeds("volume feet.geojson --cell 5 --level 30");
    assert!(said.contains("--to-unit ft or --to-unit us-ft writes them in feet"), "{said}");
}

#[test]
fn heights_come_back_as_the_very_numbers_of_the_file() {
    let folder = Folder::new();
    // Levels every 20 m, in US survey feet as other programs compute them.
    let feet = |level: f64| level * 3937.0 / 1200.0;
    let given: Vec<f64> = (10..60).map(|k| feet(20.0 * f64::from(k))).collect();
    let given: Vec<f64> = given.iter().flat_map(|z| [z.next_down(), *z, z.next_up()]).step_by(4).collect();
    folder.put("odd.geojson", &slope(26912, &given));
    folder.succeeds("densify odd.geojson --unit us-ft -i 1000000 --keep-input --to-unit us-ft -o out.geojson");
    let text = fs::read_to_string(folder.path("out.geojson")).unwrap();
    let out: Value = serde_json::from_str(&text).unwrap();
    let mut found: Vec<f64> = Vec::new();
    for feature in out["features"].as_array().unwrap() {
        let (elevation, z) = (&feature["properties"]["elev"], &feature["geometry"]["coordinates"][0][2]);
        assert_eq!(elevation, z);
        found.push(elevation.as_f64().unwrap());
    }
    found.sort_by(f64::total_cmp);
    found.dedup();
    assert_eq!(found, given);
    let said = folder.succeeds("check odd.geojson --unit us-ft -v");
    let is_long =
        |word: &str| word.split_once('.').is_some_and(|(_, decimals)| decimals.trim_end_matches(')').len() > 4);
    let numbers = |word: &&str| word.starts_with(|c: char| c.is_ascii_digit());
    assert!(!said.split_whitespace().filter(numbers).any(is_long), "{said}");
}

#[test]
fn errors_and_comparisons_are_in_feet() {
    let folder = Folder::new();
    folder.put("one.geojson", &slope(FEET, &[40.0, 40.0, 40.0]));
    let said = folder.ends("dem one.geojson --cell 10 -o dem.tif", 1);
    assert!(said.contains("have the elevation 40 ft"), "{said}");
    folder.put("feet.geojson", &slope(FEET, &[40.0, 80.0, 120.0, 160.0]));
    let said = folder.ends("dem feet.geojson --cell 10 --extent 0,0,10,10 -o dem.tif", 1);
    // Places are in feet, as the coordinates of the input are.
    assert!(said.contains("outside of the contours (x 69999") && said.contains(", y 1200000."), "{said}");

    folder.succeeds("dem feet.geojson --cell 10 --surface linear -o dem.tif");
    let said = folder.succeeds("compare feet.geojson dem.tif --sigma 0.5 --report page.html");
    assert!(said.contains("differences A − B in feet") && said.contains("interval 40 ft"), "{said}");
    assert!(said.contains("by elevation of B") && said.contains("0 to 60 ft") | said.contains("ft and more"), "{said}");
    assert!(!says_metres(&said), "{said}");
    let page = fs::read_to_string(folder.path("page.html")).unwrap();
    assert!(
        page.contains("A − B [ft]") && page.contains("<th>feet</th>") && !page.contains("[m]"),
        "units of the page"
    );
    // The figures are those in metres, in another unit.
    let text = folder.succeeds("compare feet.geojson dem.tif --json -q");
    let json: Value = serde_json::from_str(&text).unwrap();
    let rmse = json["overall"]["rmse"].as_f64().unwrap() / 0.3048;
    let row = said.lines().find(|line| line.starts_with("all cells")).unwrap();
    let printed: f64 = row.split_whitespace().nth(4).unwrap().parse().unwrap();
    assert!((printed - rmse).abs() <= 0.0051 * rmse.max(1.0), "{printed} {rmse}: {row}");
}

#[test]
fn errors_of_a_clip_name_its_file_and_a_polygon() {
    let folder = folder_with("fig3a_spur.geojson", "map.geojson");
    let line = json!({ "type": "LineString", "coordinates": [[0.0, 0.0], [1.0, 1.0]] });
    let collection = |geometry: Value| json!({ "type": "FeatureCollection", "features": [{ "type": "Feature", "properties": {}, "geometry": geometry }] });
    fs::write(folder.path("line.geojson"), collection(line).to_string()).unwrap();
    for command in ["dem map.geojson --cell 10 -o dem.tif", "volume map.geojson --cell 10 --level 100"] {
        let said = folder.ends(&format!("{command} --clip line.geojson"), 1);
        assert!(said.contains("line.geojson") && said.contains("polygon") && !said.contains("frame"), "{said}");
    }
}

#[test]
fn plans_say_what_they_remove_and_how_large_tiles_are() {
    let folder = Folder::new();
    fs::write(folder.path("all.gpkg"), part()).unwrap();
    folder.succeeds("densify all.gpkg -i 20 --extent 745000,4018500,747000,4020000 -o in.gpkg --surface linear");
    folder.succeeds("plan in.gpkg --cell 20 --tile-side 800 -o plan");
    folder.succeeds("work plan");
    let said = folder.ends("join plan", 2);
    assert!(said.contains("-o FILE for the lines, --dem FILE for the height map"), "{said}");
    let said = folder.succeeds("plan in.gpkg --cell 20 --tile-side 100 -o plan");
    assert!(
        said.contains("sides of tiles are up to") && said.contains("not 100 m: a tile has at least 16 cells"),
        "{said}"
    );
    assert!(
        said.contains("removed    results of 9 tiles of the former plan, which the new one does not have"),
        "{said}"
    );
    assert!(
        !folder.succeeds("plan in.gpkg --cell 20 --tile-side 100 -o plan").contains("removed"),
        "nothing was done yet"
    );
}

#[test]
fn volumes_and_profiles_read_the_error_band_of_a_height_map() {
    let folder = folder_with("fig3a_spur.geojson", "map.geojson");
    folder.succeeds("dem map.geojson --cell 10 --uncertainty -o with_errors.tif");
    folder.succeeds("dem map.geojson --cell 10 -o without.tif");
    let said = folder.succeeds("volume with_errors.tif --level 0");
    assert!(said.contains("errors: cut ±") || said.contains("errors: cut ± at most"), "{said}");
    assert!(!said.contains("no error is known"), "{said}");
    assert!(folder.succeeds("volume without.tif --level 0").contains("no error is known"));
    // A stated error counts more than that of the file.
    let most = |command: &str| folder.succeeds(command).lines().find(|l| l.contains("errors: cut")).unwrap().to_owned();
    assert_ne!(most("volume with_errors.tif --level 0"), most("volume with_errors.tif --level 0 --sigma 7"));
    assert_eq!(most("volume with_errors.tif --level 0 --sigma 7"), most("volume without.tif --level 0 --sigma 7"));
}
