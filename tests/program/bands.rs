//! `--bands`: areas between the lines, in files.

#![allow(clippy::unwrap_used, reason = "helpers of tests are tests too")]

use std::collections::HashSet;
use std::fs;

use rusqlite::Connection;
use serde_json::Value;

use crate::guide_pages::{commands, inputs, run};
use crate::running::{Running, folder_with_part};

#[test]
fn areas_are_written_beside_the_lines() {
    let folder = folder_with_part("in.gpkg");
    let said = folder.succeeds("densify in.gpkg -i 10,20 -o lines.gpkg --bands areas.gpkg --surface linear");
    assert!(said.contains("layer bands_10m (") && said.contains("layer bands_20m ("), "{said}");
    let db = Connection::open(folder.path("areas.gpkg")).unwrap();
    for (layer, step) in [("bands_10m", 10.0), ("bands_20m", 20.0)] {
        let sums = format!(
            "SELECT sum(share), min(elev_to - elev_from), min(area_m2), count(*) FROM {layer} WHERE kind = 'ground'"
        );
        let [share, least, area, count]: [f64; 4] = db
            .query_row(&sums, [], |row| Ok([row.get(0)?, row.get(1)?, row.get(2)?, row.get::<_, i64>(3)? as f64]))
            .unwrap();
        assert!(
            (share - 1.0).abs() < 1e-9 && least == step && area > 0.0 && count > 20.0,
            "{layer}: {share} {least} {count}"
        );
    }
    // In feet, and in another file for each interval.
    folder.succeeds("densify in.gpkg -i 100,200 --to-unit ft -o lines.shp --bands areas.geojson --surface linear");
    let text = fs::read_to_string(folder.path("areas_bands_100ft.geojson")).unwrap();
    let read: Value = serde_json::from_str(&text).unwrap();
    let first = &read["features"][0]["properties"];
    let [from, to, middle] = ["elev_from", "elev_to", "elev_mid"].map(|name| first[name].as_f64().unwrap());
    assert!(
        (to - from - 100.0).abs() < 1e-9 && (from / 100.0).fract() == 0.0 && (middle - from - 50.0).abs() < 1e-9,
        "{first}"
    );
    assert!(folder.path("areas_bands_200ft.geojson").exists());
}

#[test]
fn bands_have_the_tint_of_the_picture_in_a_style_and_in_the_picture() {
    let folder = folder_with_part("in.gpkg");
    let command = "densify in.gpkg -i 100 -o lines.gpkg --surface linear --overwrite";
    folder.succeeds(&format!("{command} --preview smooth.svg"));
    folder.succeeds(&format!("{command} --preview bands.svg --bands areas.gpkg"));
    // The legend has the colours of the tint.
    let colours = |name: &str| {
        let text = fs::read_to_string(folder.path(name)).unwrap();
        let is_colour = |rest: &&str| rest.bytes().all(|b| b.is_ascii_hexdigit());
        text.split('#').skip(1).filter_map(|rest| rest.get(..6)).filter(is_colour).collect::<HashSet<_>>().len()
    };
    assert!(colours("bands.svg") < 20 && colours("smooth.svg") > 50, "{}", colours("bands.svg"));
    let db = Connection::open(folder.path("areas.gpkg")).unwrap();
    let style: String = db.query_row("SELECT styleQML FROM layer_styles", [], |row| row.get(0)).unwrap();
    assert!(style.contains("create_ramp(map(0, '158,192,158'") && style.contains("fillColor"), "{style}");
}

#[test]
fn depths_stand_beside_heights() {
    let folder = folder_with_part("in.gpkg");
    folder.succeeds("densify in.gpkg -i 20 --surface linear --labels --to-depths -o lines.gpkg --bands areas.gpkg");
    let lines = Connection::open(folder.path("lines.gpkg")).unwrap();
    let count = |db: &Connection, sql: &str| db.query_row(sql, [], |row| row.get::<_, i64>(0)).unwrap();
    assert_eq!(count(&lines, "SELECT count(*) FROM contours_20m WHERE depth <> -elev"), 0);
    assert!(count(&lines, "SELECT count(*) FROM contours_20m WHERE depth < 0") > 10);
    assert!(count(&lines, "SELECT count(*) FROM labels WHERE CAST(text AS REAL) = depth AND depth = -elev") > 0);
    let areas = Connection::open(folder.path("areas.gpkg")).unwrap();
    let swapped = "SELECT count(*) FROM bands_20m WHERE depth_from = -elev_to AND depth_to = -elev_from AND depth_mid = -elev_mid";
    assert_eq!(count(&areas, swapped), count(&areas, "SELECT count(*) FROM bands_20m"));
    for output in ["lines.dxf", "lines.pmtiles"] {
        let said = folder.ends(&format!("densify in.gpkg -i 20 --to-depths -o {output}"), 2);
        assert!(said.contains("--to-depths adds attributes"), "{said}");
    }
}

#[test]
fn files_that_hold_no_areas_are_refused_before_the_work() {
    let folder = folder_with_part("in.gpkg");
    for (command, why) in [
        ("densify in.gpkg -i 10 -o lines.gpkg --bands areas.tif", "areas are written as"),
        ("densify in.gpkg -i 10 -o lines.gpkg --bands in.gpkg/x", "areas are written as"),
    ] {
        let said = folder.ends(command, 2);
        assert!(said.contains(why), "{command}: {said}");
    }
}

#[test]
fn the_commands_of_the_page_run() {
    let folder = inputs();
    run(&folder, "tokosen dem contours.gpkg --cell 20 -o dem.tif --surface linear");
    let commands = commands(include_str!("../../src/guide/bands.md"));
    assert_eq!(commands.len(), 2);
    commands.into_iter().for_each(|command| assert!(run(&folder, command).contains("areas")));
}
