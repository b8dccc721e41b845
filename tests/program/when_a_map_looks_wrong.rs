//! The page of the guide that leads from a symptom to its cause: its commands run, its codes exist, and faults of the kinds
//! that it describes get the codes that it names.

#![allow(clippy::unwrap_used, reason = "helpers of tests are tests too")]

use std::collections::BTreeSet;
use std::fs;

use serde_json::{Value, json};
use tokosen::base::error::{FindingKind, Severity};

use crate::common::Folder;
use crate::guide_pages::{commands, inputs, run};
use crate::running::{Running, run as run_in, said};

const PAGE: &str = include_str!("../../src/guide/when_a_map_looks_wrong.md");

/// Lines in the system of the sample, as GeoJSON.
fn lines(lines: &[(Value, Value)]) -> String {
    let feature = |(properties, points): &(Value, Value)| {
        json!({ "type": "Feature", "properties": properties,
            "geometry": { "type": "LineString", "coordinates": points } })
    };
    json!({ "type": "FeatureCollection", "crs": { "type": "name", "properties": { "name": "EPSG:32616" } },
        "features": lines.iter().map(feature).collect::<Vec<_>>() })
    .to_string()
}

/// The words in the page that look like codes of findings: lower-case words with hyphens between them.
fn codes() -> BTreeSet<&'static str> {
    let is_code = |text: &str| {
        text.contains('-')
            && text.split('-').all(|word| !word.is_empty() && word.chars().all(|c| c.is_ascii_lowercase()))
    };
    let quoted = PAGE.split('`').skip(1).step_by(2);
    quoted.filter(|text| is_code(text) || matches!(*text, "gap" | "spike" | "excluded")).collect()
}

#[test]
fn every_command_of_the_page_runs() {
    let folder = inputs();
    let line = |points| lines(&[(json!({}), points)]);
    let rivers = line(json!([[746_000, 4_019_000], [747_000, 4_020_000], [748_000, 4_020_500]]));
    fs::write(folder.path("rivers.geojson"), rivers).unwrap();
    fs::write(folder.path("cliffs.geojson"), line(json!([[747_000, 4_019_000], [747_100, 4_019_200]]))).unwrap();
    run(&folder, "tokosen densify contours.gpkg -i 100 -o index_contours.gpkg");
    let commands = commands(PAGE);
    assert!(commands.len() >= 25, "{commands:?}");
    for command in commands {
        // With --strict, the status says whether there are findings.
        if command.contains("--strict") {
            let output = run_in(folder.0.path(), command.strip_prefix("tokosen ").unwrap());
            assert!(matches!(output.status.code(), Some(0 | 1)), "{command}: {}", said(&output));
            continue;
        }
        run(&folder, command);
    }
}

#[test]
fn the_codes_of_the_page_exist_and_all_errors_are_on_it() {
    let known: BTreeSet<_> = FindingKind::ALL.iter().map(|kind| kind.code()).collect();
    let unknown: Vec<_> = codes().into_iter().filter(|code| !known.contains(code)).collect();
    assert!(unknown.is_empty(), "no finding has these codes: {unknown:?}");
    let errors = FindingKind::ALL.iter().filter(|kind| kind.severity() == Severity::Error);
    let missing: Vec<_> = errors.map(|kind| kind.code()).filter(|code| !codes().contains(code)).collect();
    assert!(missing.is_empty(), "src/guide/when_a_map_looks_wrong.md does not say what to do about {missing:?}");
}

#[test]
fn links_within_the_page_lead_to_its_headings() {
    let anchor = |heading: &str| heading.to_lowercase().replace(' ', "-");
    let headings: BTreeSet<_> = PAGE.lines().filter_map(|line| line.strip_prefix("## ")).map(anchor).collect();
    let links: Vec<_> = PAGE.split("](#").skip(1).filter_map(|rest| rest.split(')').next()).collect();
    assert!(links.len() >= 15, "{links:?}");
    for link in links {
        assert!(headings.contains(link), "{link}");
    }
}

/// Rings around a hill, every 10 m from 100 m on.
fn hill() -> Vec<(Value, Value)> {
    (0..6).map(|k| ring(100 + 10 * k, f64::from(120 - 20 * k))).collect()
}

fn ring(elevation: i32, half: f64) -> (Value, Value) {
    let (x, y) = (745_000.0, 4_020_000.0);
    let points = [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0), (-1.0, -1.0)];
    (json!({ "elev": elevation }), json!(points.map(|(dx, dy)| [x + half * dx, y + half * dy])))
}

/// The codes that `check` gives.
fn found(map: &[(Value, Value)]) -> BTreeSet<String> {
    let folder: Folder = Folder::new();
    fs::write(folder.path("in.geojson"), lines(map)).unwrap();
    let said = folder.succeeds("check in.geojson --json -q");
    let said: Value = serde_json::from_str(&said).unwrap();
    said["findings"].as_array().unwrap().iter().map(|f| f["code"].as_str().unwrap().to_owned()).collect()
}

#[test]
fn faults_get_the_codes_that_the_page_names() {
    assert!(found(&hill()).is_empty(), "{:?}", found(&hill()));
    let without_one = [&hill()[..2], &hill()[3..]].concat();
    let far = [hill(), vec![(json!({ "elev": 120 }), json!([[100_000, 100_000], [100_100, 100_000]]))]].concat();
    let placeholder = [hill(), vec![ring(-9999, 140.0)]].concat();
    let mut wrong = hill();
    wrong[2].0 = json!({ "elev": 170 });
    let mut twice = hill();
    twice.push(twice[3].clone());
    let mut open = hill();
    open[2].1.as_array_mut().unwrap().pop();
    open[2].1.as_array_mut().unwrap().pop();
    let mut swapped = hill();
    for place in swapped.iter_mut().flat_map(|(_, points)| points.as_array_mut().unwrap()) {
        place.as_array_mut().unwrap().reverse();
    }
    for (code, map) in [
        ("axes-swapped", swapped),
        ("skipped-level", without_one),
        ("far-away", far),
        ("zero-elevation", placeholder),
        ("wrong-label", wrong),
        ("duplicate-line", twice),
        ("open-end", open),
    ] {
        assert!(found(&map).contains(code), "{code}: {:?}", found(&map));
        assert!(codes().contains(code), "{code} is not on the page");
    }
}
