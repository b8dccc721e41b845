//! Every fault that a map's lines can have: a small map with just that fault, and what is told of it, from the file to the
//! triangulation.
//!
//! The map without faults is a slope of seven contours. To add a fault, add a row to `cases`: what is changed in the file,
//! and the codes of all findings, sorted.
#![allow(clippy::unwrap_used, reason = "a test may end at the first thing that is not as it should be")]

use std::collections::BTreeSet;

use serde_json::{Value, json};
use tokosen::base::error::{Finding, FindingKind};
use tokosen::check::{LineParams, correct, examine, first_causes, merged};
use tokosen::clean::{CleanParams, clean};
use tokosen::contour::ContourMap;
use tokosen::io::{ReadOptions, read_contours};
use tokosen::subdivision::subdivide;
use tokosen::subdomains::Frame;

/// Coordinates of the map's south-west corner.
const CORNER: [f64; 2] = [-20_000.0, -35_000.0];
const SNAP: f64 = 0.01;

/// A feature with a line through places that are given from the corner.
fn line(elevation: impl Into<Value>, points: &[[f64; 2]]) -> Value {
    let points: Vec<[f64; 2]> = points.iter().map(|p| [CORNER[0] + p[0], CORNER[1] + p[1]]).collect();
    json!({"type": "Feature", "properties": {"elev": elevation.into()},
           "geometry": {"type": "LineString", "coordinates": points}})
}

fn spot(elevation: f64, [x, y]: [f64; 2]) -> Value {
    json!({"type": "Feature", "properties": {"elev": elevation},
           "geometry": {"type": "Point", "coordinates": [CORNER[0] + x, CORNER[1] + y]}})
}

/// The places of the contour number `k`, from west to east, from `from` to `to`.
fn course(k: usize, from: usize, to: usize) -> Vec<[f64; 2]> {
    (from..=to).map(|i| [50.0 * i as f64, 100.0 * k as f64 + (i % 3) as f64]).collect()
}

/// A slope that rises to the north, by 10 m every 100 m.
fn slope() -> Vec<Value> {
    (0..7).map(|k| line(510 + 10 * k, &course(k as usize, 0, 20))).collect()
}

/// A ring of eight places around one on the slope, low enough to lie between two contours.
fn ring(elevation: i32, [x, y]: [f64; 2]) -> Value {
    let turn = [[30, 0], [21, 21], [0, 30], [-21, 21], [-30, 0], [-21, -21], [0, -30], [21, -21], [30, 0]];
    line(elevation, &turn.map(|[dx, dy]| [x + f64::from(dx), y + f64::from(dy)]))
}

fn points(feature: &mut Value) -> &mut Vec<Value> {
    feature["geometry"]["coordinates"].as_array_mut().unwrap()
}

fn collection(features: &[Value]) -> Value {
    let crs = json!({"type": "name", "properties": {"name": "urn:ogc:def:crs:EPSG::6677"}});
    json!({"type": "FeatureCollection", "crs": crs, "features": features})
}

/// A file with a fault.
struct Case {
    name: &'static str,
    file: Value,
    codes: &'static [&'static str],
}

/// The slope after a change to its features.
fn changed(name: &'static str, change: impl FnOnce(&mut Vec<Value>), codes: &'static [&'static str]) -> Case {
    let mut features = slope();
    change(&mut features);
    Case { name, file: collection(&features), codes }
}

fn cases() -> Vec<Case> {
    let unknown_crs = {
        let mut file = collection(&slope());
        file["crs"] = json!({"type": "name", "properties": {"name": "nowhere"}});
        Case { name: "a system that is not known", file, codes: &["unknown-crs"] }
    };
    vec![
        changed("nothing wrong", |_| (), &[]),
        unknown_crs,
        changed(
            "no geometry",
            |map| map.push(json!({"type": "Feature", "properties": {"elev": 520}, "geometry": null})),
            &["skipped-feature"],
        ),
        changed(
            "no elevation",
            |map| map.push(line(Value::Null, &[[100.0, 50.0], [200.0, 50.0]])),
            &["missing-elevation"],
        ),
        changed(
            "an elevation that is no number",
            |map| map.push(line("n/a", &[[100.0, 50.0], [200.0, 50.0]])),
            &["missing-elevation"],
        ),
        changed(
            "a line in degrees",
            |map| {
                let mut degrees = line(540, &[]);
                *points(&mut degrees) = vec![json!([139.7, 35.6]), json!([139.701, 35.601])];
                map.push(degrees);
            },
            &["looks-like-degrees"],
        ),
        changed(
            "a line in another zone",
            |map| map.push(line(540, &[[200_000.0, 350.0], [200_050.0, 350.0]])),
            &["far-away"],
        ),
        changed(
            "a slip in a coordinate",
            |map| points(&mut map[6])[7] = json!([CORNER[0] + 350.0, CORNER[1] + 100_600.0]),
            &["far-away"],
        ),
        changed(
            "a vertex off its line",
            |map| points(&mut map[6])[7] = json!([CORNER[0] + 350.0, CORNER[1] + 770.0]),
            &["stray-vertex"],
        ),
        changed(
            "a vertex off its line, across the next",
            |map| points(&mut map[3])[7] = json!([CORNER[0] + 350.0, CORNER[1] + 470.0]),
            &["levels-cross"],
        ),
        changed(
            "a point twice",
            |map| {
                let again = points(&mut map[3])[5].clone();
                points(&mut map[3]).insert(5, again);
            },
            &["repeated-point"],
        ),
        changed("a line that is a point", |map| map.push(line(520, &[[100.0, 150.0]; 2])), &["point-line"]),
        changed(
            "a ring without area",
            |map| map.push(line(540, &[[100.0, 320.0], [150.0, 320.0], [150.0, 320.0 + 1e-7], [100.0, 320.0]])),
            &["short-line"],
        ),
        changed("a line twice", |map| map.push(map[2].clone()), &["duplicate-line"]),
        changed(
            "a spike",
            |map| {
                let root = points(&mut map[3])[5].clone();
                let tip = json!([CORNER[0] + 250.0, CORNER[1] + 340.0]);
                points(&mut map[3]).splice(6..6, [tip, root]);
            },
            &["spike"],
        ),
        changed(
            "lines of one level that run along each other",
            |map| map.push(line(520, &[&[[240.0, 150.0]], &course(1, 5, 9)[..], &[[460.0, 150.0]]].concat())),
            &["open-end", "open-end", "overlapping-lines"],
        ),
        changed(
            "lines of two levels that run along each other",
            |map| map.push(line(530, &course(1, 5, 9))),
            &["gap", "overlapping-lines", "wrong-label"],
        ),
        changed(
            "a line that crosses itself",
            |map| map.push(line(520, &[[100.0, 150.0], [140.0, 150.0], [120.0, 170.0], [120.0, 130.0]])),
            &["self-cross"],
        ),
        changed("levels that cross", |map| map.push(line(530, &[[120.0, 90.0], [120.0, 110.0]])), &["levels-cross"]),
        changed(
            "an elevation that jumps",
            |map| {
                map.remove(3);
                map.extend([line(540, &course(3, 0, 7)), line(550, &course(3, 7, 12)), line(540, &course(3, 12, 20))]);
            },
            &["level-jump", "level-jump"],
        ),
        changed(
            "a gap under the snap distance",
            |map| {
                let mut east = course(3, 9, 20);
                east[0][1] += 0.005;
                map[3] = line(540, &course(3, 0, 9));
                map.push(line(540, &east));
            },
            &["closed-gap"],
        ),
        changed("a ring of 0", |map| map.push(ring(0, [300.0, 350.0])), &["zero-elevation"]),
        changed("a spot height on a contour", |map| map.push(spot(533.0, [100.0, 202.0])), &["spot-on-line"]),
        changed("a spot height outside its band", |map| map.push(spot(700.0, [100.0, 250.0])), &["spot-outside-band"]),
        changed(
            "a hill that is marked as a depression",
            |map| {
                map.push(ring(550, [300.0, 350.0]));
                map[7]["properties"]["depression"] = json!(1);
            },
            &["depression-mark"],
        ),
    ]
}

fn read(file: &Value) -> (ContourMap, Vec<Finding>) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("map.geojson");
    std::fs::write(&path, file.to_string()).unwrap();
    let mut findings = Vec::new();
    let map = read_contours(&path, &ReadOptions::default()).unwrap().collect(&mut findings);
    (map, findings)
}

/// All that is told of a map, from the lines to the triangulation.
fn told(map: ContourMap) -> Vec<Finding> {
    let lines = examine(&map, &LineParams { snap: SNAP }).findings;
    let mut cleaning = Vec::new();
    let map = clean(map, &CleanParams { snap: SNAP, ..CleanParams::default() }).unwrap().collect(&mut cleaning);
    let mut findings = merged(lines, cleaning, SNAP);
    subdivide(map, &Frame::Hull, &()).unwrap().collect(&mut findings);
    first_causes(findings)
}

fn codes(findings: &[Finding]) -> Vec<&'static str> {
    let mut codes: Vec<&str> = findings.iter().map(|finding| finding.kind.code()).collect();
    codes.sort_unstable();
    codes
}

#[test]
fn each_fault_is_told_and_nothing_else() {
    let mut wrong = Vec::new();
    for Case { name, file, codes: expected } in cases() {
        let (map, mut findings) = read(&file);
        findings.extend(told(map));
        if codes(&findings) != expected {
            let all: Vec<String> = findings.iter().map(|f| format!("    {}: {f}", f.kind.code())).collect();
            wrong.push(format!("{name}: expected {expected:?}, found\n{}", all.join("\n")));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn every_finding_about_lines_names_them() {
    use FindingKind::{LooksLikeDegrees, SkippedFeature, SkippedLevel, UnknownCrs};
    let mut seen = BTreeSet::new();
    for Case { name, file, .. } in cases() {
        let (map, mut findings) = read(&file);
        findings.extend(told(map));
        for finding in findings {
            let is_general = [SkippedFeature, SkippedLevel, UnknownCrs].contains(&finding.kind);
            let named = !finding.features.is_empty() || !finding.elevations.is_empty();
            assert!(is_general || (named && finding.place.is_some()), "{name}: {finding:?}");
            seen.insert(finding.kind);
        }
    }
    assert!(seen.len() >= 19 && seen.contains(&LooksLikeDegrees), "{seen:?}");
}

#[test]
fn a_map_is_sound_after_its_corrections() {
    let mut corrected = 0;
    for Case { name, file, .. } in cases() {
        let (map, _) = read(&file);
        let judged = examine(&map, &LineParams { snap: SNAP });
        if judged.corrections.is_empty() {
            continue;
        }
        let report = correct(map, &judged.corrections);
        let made = codes(&report.findings);
        assert!(made == ["relabelled"] || made == ["straightened"], "{name}: {made:?}");
        assert_eq!(told(report.value), [], "{name}");
        corrected += 1;
    }
    assert_eq!(corrected, 4);
}
