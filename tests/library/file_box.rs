//! A box after a file: an index finds what meets it, and the rest is not read.

#![allow(clippy::unwrap_used, reason = "helpers of tests are tests too")]

use std::fs;
use std::path::{Path, PathBuf};

use glam::DVec2;
use rusqlite::Connection;
use tempfile::TempDir;
use tokosen::base::error::{FindingKind, Report, Result};
use tokosen::contour::{ContourLayer, ContourLine, ContourMap, Source};
use tokosen::io::{StagedOutput, VectorSource, read_contours, write_contours};

/// Places of lines along a side. The box of the tests meets those at the first three.
const SIDE: usize = 12;
const BOX: &str = "-5,-5,220,40";

/// Lines of three vertices at the places of a square, 100 m apart.
fn written(folder: &TempDir, extension: &str) -> PathBuf {
    let line = |k: usize| {
        let corner = 100.0 * DVec2::new((k % SIDE) as f64, (k / SIDE) as f64);
        ContourLine {
            elevation: 10.0 * k as f64,
            points: [[0.0, 0.0], [30.0, 10.0], [40.0, 40.0]].map(|[x, y]| corner + DVec2::new(x, y)).to_vec(),
            source: Source::Input,
            index: false,
            kind: None,
            depression: false,
            expected: None,
        }
    };
    let layer = ContourLayer {
        name: "contours".into(),
        lines: (0..SIDE * SIDE).map(line).collect(),
        ..ContourLayer::default()
    };
    let path = folder.path().join(format!("lines.{extension}"));
    let staged = StagedOutput::create(&path).unwrap();
    write_contours(&staged, &[layer], None).unwrap();
    staged.commit().unwrap();
    path
}

fn read(path: &Path, sides: &str) -> Result<Report<ContourMap>> {
    let source = VectorSource::from_text(&format!("{}|bbox={sides}", path.display())).unwrap();
    read_contours(&source.path, &source.reading())
}

/// The elevations of what meets the box, in the order of the file, and the numbers of the features.
fn found(path: &Path) -> Vec<(f64, u64)> {
    let map = read(path, BOX).unwrap().value;
    map.contours.iter().map(|line| (line.elevation, line.feature.number())).collect()
}

/// Breaks the geometry of features, as a program does that does not know the index.
fn break_features(path: &Path, which: &str) {
    let db = Connection::open(path).unwrap();
    let mut triggers = db.prepare("SELECT name FROM sqlite_master WHERE type = 'trigger'").unwrap();
    let names: Vec<String> =
        triggers.query_map([], |row| row.get(0)).unwrap().map(std::result::Result::unwrap).collect();
    names.iter().for_each(|name| db.execute_batch(&format!("DROP TRIGGER {name}")).unwrap());
    let broken = "UPDATE contours SET geom = substr(geom, 1, length(geom) - 20)";
    db.execute_batch(&format!("{broken} WHERE {which}")).unwrap();
}

#[test]
fn a_geopackage_is_read_by_its_index() {
    let folder = tempfile::tempdir().unwrap();
    let path = written(&folder, "gpkg");
    let expected = vec![(0.0, 1), (10.0, 2), (20.0, 3)];
    assert_eq!(found(&path), expected);
    // Features elsewhere are not even looked at.
    break_features(&path, "fid > 3");
    assert_eq!(found(&path), expected);
    assert!(read(&path, "-5,-5,320,40").is_err_and(|e| e.to_string().contains("feature 4")));
    // What has no geometry meets no box, and the index has no entry for it.
    Connection::open(&path).unwrap().execute_batch("INSERT INTO contours (elev) VALUES (5)").unwrap();
    assert_eq!(found(&path), expected);
    let about_it = |path: &Path| {
        let findings = read(path, BOX).unwrap().findings;
        findings.iter().any(|finding| finding.kind == FindingKind::SkippedFeature)
    };
    assert!(!about_it(&path));
    Connection::open(&path).unwrap().execute_batch("DROP TABLE rtree_contours_geom").unwrap();
    Connection::open(&path).unwrap().execute_batch("UPDATE contours SET geom = NULL WHERE fid > 3").unwrap();
    assert!(found(&path) == expected && !about_it(&path), "nor if the whole table is read");
}

#[test]
fn an_index_that_cannot_be_trusted_is_not_used() {
    let index = "rtree_contours_geom";
    let changes = [
        // There is none, or it is empty, or lacks a feature, or belongs to another table.
        format!("DROP TABLE {index}"),
        format!("DELETE FROM {index}"),
        format!("DELETE FROM {index} WHERE id = 2"),
        format!("DROP TABLE {index}; CREATE TABLE {index} (id, a); CREATE TABLE {index}_rowid (b)"),
        // It is damaged: a leaf's bytes, the box around a leaf, a place in the table of leaves.
        format!("UPDATE {index}_node SET data = zeroblob(length(data)) WHERE nodeno = 3"),
        format!("UPDATE {index}_node SET data = substr(data, 1, 16) || zeroblob(length(data) - 16) WHERE nodeno = 1"),
        format!("UPDATE {index}_rowid SET nodeno = 99 WHERE rowid = 2"),
    ];
    for change in changes {
        let folder = tempfile::tempdir().unwrap();
        let path = written(&folder, "gpkg");
        Connection::open(&path).unwrap().execute_batch(&change).unwrap();
        assert_eq!(found(&path), [(0.0, 1), (10.0, 2), (20.0, 3)], "{change}");
        break_features(&path, "fid > 3");
        assert!(read(&path, BOX).is_err(), "the whole table is read: {change}");
    }
}

#[test]
fn a_flatgeobuf_is_read_by_its_index() {
    let folder = tempfile::tempdir().unwrap();
    let path = written(&folder, "fgb");
    let mut whole = read(&path, "-9e9,-9e9,9e9,9e9").unwrap().value.contours;
    assert_eq!(whole.len(), SIDE * SIDE);
    whole.retain(|line| [0.0, 10.0, 20.0].contains(&line.elevation));
    let expected: Vec<_> = whole.iter().map(|line| (line.elevation, line.feature.number())).collect();
    assert_eq!((found(&path), expected.len()), (expected.clone(), 3));
    // The last line of the square is not needed: its bytes may be wrong.
    let bytes = fs::read(&path).unwrap();
    let corner = 1100.0_f64.to_le_bytes();
    let place = bytes.windows(16).rposition(|pair| pair == [corner, corner].concat()).unwrap();
    let mut broken = bytes.clone();
    broken[place - 40..place].fill(0xff);
    fs::write(&path, &broken).unwrap();
    assert_eq!(found(&path), expected);
    assert!(read(&path, "-9e9,-9e9,9e9,9e9").is_err());
    // An index whose places are not in the order of the file is not used.
    let entry = first_entry(&bytes) + 32;
    let mut shifted = bytes;
    shifted[entry..entry + 8].copy_from_slice(&u64::MAX.to_le_bytes());
    fs::write(&path, &shifted).unwrap();
    assert_eq!(found(&path), expected);
}

/// Where the index has the entry of the first feature: its place is 0, and the next one follows.
fn first_entry(bytes: &[u8]) -> usize {
    let header = 12 + u32::from_le_bytes(bytes[8..12].try_into().unwrap()) as usize;
    // 144 features in nodes of 16: one root and nine nodes lie before them.
    header + 40 * (1 + SIDE * SIDE / 16)
}
