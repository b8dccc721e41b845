//! FlatGeobuf and DXF: what only they have.

#![allow(clippy::unwrap_used, reason = "helpers of tests are tests too")]

use std::fs;
use std::path::{Path, PathBuf};

use flatgeobuf::geozero::{ColumnValue, FeatureProcessor, GeomProcessor, PropertyProcessor};
use flatgeobuf::{ColumnType, FgbReader, FgbWriter, FgbWriterOptions, GeometryType};
use glam::{DVec2, DVec3};
use tempfile::TempDir;
use tokosen::base::error::{FindingKind, Result};
use tokosen::contour::{Contour, ContourLayer, ContourLine, Source};
use tokosen::crs::Crs;
use tokosen::features::Role;
use tokosen::io::layer::{Cell, Column, Geometry, Kind, Layer, Row, Shape};
use tokosen::io::{ReadOptions, StagedOutput, read_area, read_contours, read_features, read_spot_heights};
use tokosen::io::{write_contours, write_layers};

fn write(path: &Path, layers: &[Layer<'_>]) {
    let staged = StagedOutput::create(path).unwrap();
    write_layers(&staged, layers, Some(&Crs::from_epsg(6677))).unwrap();
    staged.commit().unwrap();
}

fn read(path: &Path) -> Result<Vec<Contour>> {
    Ok(read_contours(path, &ReadOptions::default())?.value.contours)
}

fn read_layers(path: &Path, layers: &str) -> Result<Vec<Contour>> {
    let options = ReadOptions { layer: Some(layers.to_owned()), ..ReadOptions::default() };
    Ok(read_contours(path, &options)?.value.contours)
}

fn read_error(path: &Path) -> String {
    read(path).unwrap_err().to_string()
}

/// A few hundred lines of random bits, some of them closed, on two dozen levels.
fn lines() -> Vec<ContourLine> {
    let mut state = 7_u64;
    let mut any = move || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 11) as f64 / 2.0f64.powi(53)
    };
    let line = |i: usize| {
        let start = DVec2::new(1e5 * any() - 5e4, 1e5 * any());
        let mut points: Vec<DVec2> = (0..3 + i % 9).map(|_| start + DVec2::new(any(), any()) * 300.0).collect();
        if i.is_multiple_of(3) {
            points.push(points[0]);
        }
        let source = if i.is_multiple_of(2) { Source::Input } else { Source::Interpolated };
        ContourLine {
            elevation: (i % 24) as f64 * 0.1,
            points,
            source,
            index: i.is_multiple_of(5),
            kind: None,
            depression: false,
            expected: None,
        }
    };
    (0..300).map(line).collect()
}

fn write_lines(path: &Path, lines: Vec<ContourLine>) {
    let staged = StagedOutput::create(path).unwrap();
    let layer = ContourLayer { name: "contours_5m".to_owned(), lines, artefact_rings: 0, dead_ends: 0 };
    write_contours(&staged, &[layer], Some(&Crs::from_epsg(6677))).unwrap();
    staged.commit().unwrap();
}

/// Reads what 250 damaged files hold: bytes changed, a piece cut out, the end cut off.
fn read_damaged(path: &Path) {
    let whole = fs::read(path).unwrap();
    let mut state = 11_u64;
    let mut any = |below: usize| {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 33) as usize % below
    };
    let mut refused = 0;
    for i in 0..250 {
        let mut bytes = whole.clone();
        match i % 5 {
            0 => bytes.truncate(any(whole.len())),
            1 => {
                let from = any(whole.len() - 40);
                bytes.drain(from..from + 1 + any(39));
            }
            // The beginning holds what all the rest is read by.
            2 => (0..4).for_each(|_| bytes[any(1200)] = any(256) as u8),
            _ => (0..1 + i % 7).for_each(|_| bytes[any(whole.len())] = any(256) as u8),
        }
        fs::write(path, &bytes).unwrap();
        refused += u32::from(read(path).is_err());
        let _ = read_spot_heights(path, &ReadOptions::default());
        let _ = read_area(path, &ReadOptions::default());
        let _ = read_features(Role::Water, path, &ReadOptions::default());
    }
    assert!(refused > 50, "{refused}");
    for end in [0, 1, 7, 8, 11, 12, 40, whole.len() / 2, whole.len() - 400] {
        fs::write(path, &whole[..end]).unwrap();
        assert!(read(path).is_err(), "{end}");
    }
    fs::write(path, whole).unwrap();
}

#[test]
fn damage_is_an_error_or_harmless() {
    for name in ["out.fgb", "out.parquet", "out.dxf"] {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join(name);
        write_lines(&path, lines().split_off(250));
        assert_eq!(read(&path).unwrap().len(), 50);
        read_damaged(&path);
    }
}

// FlatGeobuf

const COLUMNS: &[Column] = &[
    Column { name: "class", kind: Kind::Text(16) },
    Column { name: "elev", kind: Kind::Real },
    Column { name: "count", kind: Kind::Int },
    Column { name: "is_flat", kind: Kind::Bool },
];

fn square(x: f64, y: f64, side: f64) -> Vec<DVec2> {
    [(0.0, 0.0), (side, 0.0), (side, side), (0.0, side), (0.0, 0.0)].map(|(u, v)| DVec2::new(x + u, y + v)).to_vec()
}

#[test]
fn areas_and_attributes_of_a_flatgeobuf() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("out.fgb");
    let rings =
        [vec![square(10.1, 20.2, 100.0), square(20.0 / 3.0 + 10.0, 30.0, 10.0)], vec![square(500.0, 20.0, 7.0)]];
    let full = vec![Cell::Text("尾根".into()), Cell::Real(0.1 + 0.2), Cell::Int(-(1 << 53)), Cell::Bool(true)];
    let cells = [full, vec![Cell::Null; 4]];
    let rows = rings.iter().zip(cells).map(|(rings, cells)| Row { shape: Shape::Area(rings.clone()), cells }).collect();
    write(&path, &[Layer { name: "lakes", geometry: Geometry::Areas, columns: COLUMNS, rows }]);
    let (area, crs) = read_area(&path, &ReadOptions::default()).unwrap();
    assert_eq!(crs.and_then(|crs| crs.epsg), Some(6677));
    assert_eq!(area.0.iter().map(|polygon| polygon.interiors().len()).sum::<usize>(), 1);
    let mut found: Vec<[u64; 2]> = area
        .iter()
        .flat_map(|p| p.interiors().iter().chain([p.exterior()]))
        .flat_map(|ring| ring.coords().map(|c| [c.x.to_bits(), c.y.to_bits()]))
        .collect();
    let mut wanted: Vec<[u64; 2]> = rings.iter().flatten().flatten().map(|p| p.to_array().map(f64::to_bits)).collect();
    found.sort_unstable();
    wanted.sort_unstable();
    assert_eq!(found, wanted);
    let lakes = read_features(Role::Water, &path, &ReadOptions::default()).unwrap().value.features.lakes;
    let mut heights: Vec<Option<f64>> = lakes.iter().map(|lake| lake.height).collect();
    heights.sort_by(|a, b| a.partial_cmp(b).unwrap());
    assert_eq!(heights, [None, Some(0.1 + 0.2)]);
    let error = read_contours(&path, &ReadOptions { layer: Some("roads".into()), ..ReadOptions::default() });
    assert!(error.unwrap_err().to_string().contains("\"lakes\""));
    assert!(read_layers(&path, "lakes").unwrap_err().to_string().contains("found: 2 Polygon"));

    write(&path, &[Layer { name: "lakes", geometry: Geometry::Areas, columns: COLUMNS, rows: vec![] }]);
    assert!(read_error(&path).contains("there is no line"));
}

#[test]
fn a_flatgeobuf_is_found_by_its_index() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("out.fgb");
    let lines = lines();
    write_lines(&path, lines.clone());
    let reader = FgbReader::open(fs::File::open(&path).unwrap()).unwrap();
    assert_eq!((reader.header().features_count(), reader.header().has_z()), (300, true));
    let (low, high) = (DVec2::new(-1e4, 2e4), DVec2::new(3e4, 6e4));
    let inside = |line: &&ContourLine| {
        let (a, b) = line.points.iter().fold((line.points[0], line.points[0]), |(a, b), p| (a.min(*p), b.max(*p)));
        a.cmple(high).all() && b.cmpge(low).all()
    };
    let expected = lines.iter().filter(inside).count();
    let found = reader.select_bbox(low.x, low.y, high.x, high.y).unwrap().features_count().unwrap();
    assert_eq!(found, expected);
    assert!(found > 10 && found < 290);
}

/// A file of several types of geometry, with an attribute of every type, that knows its count or does not.
fn mixed(dir: &TempDir) -> PathBuf {
    let path = dir.path().join("mixed.fgb");
    let options =
        FgbWriterOptions { detect_type: false, promote_to_multi: false, has_z: true, ..FgbWriterOptions::default() };
    let mut out = FgbWriter::create_with_options("mixed", GeometryType::Unknown, options).unwrap();
    let values: [(ColumnType, ColumnValue<'_>); 15] = [
        (ColumnType::Byte, ColumnValue::Byte(-1)),
        (ColumnType::UByte, ColumnValue::UByte(1)),
        (ColumnType::Bool, ColumnValue::Bool(true)),
        (ColumnType::Short, ColumnValue::Short(-2)),
        (ColumnType::UShort, ColumnValue::UShort(2)),
        (ColumnType::Int, ColumnValue::Int(-3)),
        (ColumnType::UInt, ColumnValue::UInt(3)),
        (ColumnType::Long, ColumnValue::Long(-4)),
        (ColumnType::ULong, ColumnValue::ULong(4)),
        (ColumnType::Float, ColumnValue::Float(12.3)),
        (ColumnType::Double, ColumnValue::Double(45.6)),
        (ColumnType::String, ColumnValue::String("78.9")),
        (ColumnType::Json, ColumnValue::Json("[1]")),
        (ColumnType::DateTime, ColumnValue::DateTime("2020-01-01T00:00:00")),
        (ColumnType::Binary, ColumnValue::Binary(&[1, 2, 3])),
    ];
    for (i, (kind, _)) in values.iter().enumerate() {
        out.add_column(&format!("c{i}"), *kind, |_, _| {});
    }
    let vertex = |out: &mut FgbWriter<'_>, x: f64| out.coordinate(x, x + 1.0, Some(5.0), None, None, None, 0).unwrap();
    out.multilinestring_begin(2, 0).unwrap();
    for start in [0.0, 10.0] {
        out.linestring_begin(false, 2, 0).unwrap();
        (0..2).for_each(|i| vertex(&mut out, start + f64::from(i)));
        out.linestring_end(false, 0).unwrap();
    }
    out.multilinestring_end(0).unwrap();
    values.iter().enumerate().for_each(|(i, (_, value))| assert!(!out.property(i, "", value).unwrap()));
    out.feature_end(0).unwrap();
    out.point_begin(0).unwrap();
    vertex(&mut out, 3.0);
    out.point_end(0).unwrap();
    values.iter().enumerate().for_each(|(i, (_, value))| assert!(!out.property(i, "", value).unwrap()));
    out.feature_end(0).unwrap();
    out.write(fs::File::create(&path).unwrap()).unwrap();
    path
}

#[test]
fn geometries_and_attributes_of_every_type() {
    let dir = tempfile::tempdir().unwrap();
    let path = mixed(&dir);
    let expected =
        [-1.0, 1.0, 1.0, -2.0, 2.0, -3.0, 3.0, -4.0, 4.0, 12.3, 45.6, 78.9].into_iter().enumerate().collect::<Vec<_>>();
    for (i, elevation) in expected {
        let options = ReadOptions { elevation_field: Some(format!("C{i}")), ..ReadOptions::default() };
        let report = read_contours(&path, &options).unwrap();
        assert_eq!(report.value.contours.len(), 2);
        assert!(report.value.contours.iter().all(|contour| contour.elevation == elevation), "{i}");
        assert_eq!(report.value.contours[1].points, [DVec2::new(10.0, 11.0), DVec2::new(11.0, 12.0)]);
        assert_eq!(report.value.spots, [DVec3::new(3.0, 4.0, elevation)]);
        assert_eq!(report.findings[0].kind, FindingKind::UnknownCrs);
    }
    assert_eq!(read(&path).unwrap()[0].elevation, 5.0);
    for (i, words) in [(12, "not a number"), (13, "not a number"), (14, "not a number"), (15, "c0 (such as -1)")] {
        let options = ReadOptions { elevation_field: Some(format!("c{i}")), ..ReadOptions::default() };
        let error = read_contours(&path, &options).unwrap_err().to_string();
        assert!(error.contains(words), "{error}");
    }
}

#[test]
fn cut_flatgeobufs_are_told_apart() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("out.fgb");
    write_lines(&path, lines());
    let whole = fs::read(&path).unwrap();
    let told = |bytes: &[u8]| {
        fs::write(&path, bytes).unwrap();
        read_error(&path)
    };
    assert!(told(b"not a FlatGeobuf").contains("not a FlatGeobuf"));
    assert!(told(&whole[..30]).contains("within the header"));
    assert!(told(&whole[..3000]).contains("within its spatial index"));
    assert!(told(&whole[..whole.len() - 1]).contains("within feature 299"));
    assert!(told(&[&whole[..], &[0; 8]].concat()).contains("8 bytes after the last of 300 features"));
    // The last feature as a whole: its length stands before it.
    let cut = (whole.len() - 4000..whole.len() - 4).find(|&at| {
        let length = u32::from_le_bytes(whole[at..at + 4].try_into().unwrap()) as usize;
        length > 100 && at + 4 + length == whole.len()
    });
    assert!(told(&whole[..cut.unwrap()]).contains("after 299 of 300 features"));
    // A length that asks for four gigabytes.
    let mut long = whole.clone();
    long[cut.unwrap()..][..4].copy_from_slice(&u32::MAX.to_le_bytes());
    assert!(told(&long).contains("within feature 299"));
}

// DXF

/// Text of a DXF with these entities, each a list of codes and values on one line: `0 LINE 8 a 10 1`.
fn dxf(header: &str, entities: &[&str]) -> Vec<u8> {
    let mut text = String::new();
    let mut put = |line: &str| {
        let words: Vec<&str> = line.split(' ').filter(|word| !word.is_empty()).collect();
        words.chunks(2).for_each(|pair| text.push_str(&format!("  {}\r\n{}\r\n", pair[0], pair[1])));
    };
    put("999 comment 0 SECTION 2 HEADER");
    put(header);
    put("0 ENDSEC 0 SECTION 2 BLOCKS 0 LINE 8 inside 10 1 20 2 30 3 11 1 21 1 31 3 0 ENDSEC 0 SECTION 2 ENTITIES");
    entities.iter().for_each(|entity| put(entity));
    put("0 ENDSEC 0 EOF");
    text.into_bytes()
}

fn dxf_file(dir: &TempDir, header: &str, entities: &[&str]) -> PathBuf {
    let path = dir.path().join("in.dxf");
    fs::write(&path, dxf(header, entities)).unwrap();
    path
}

#[test]
fn entities_of_every_kind() {
    let dir = tempfile::tempdir().unwrap();
    let path = dxf_file(
        &dir,
        "9 $ACADVER 1 AC1015 9 $INSUNITS 70 2",
        &[
            "0 LWPOLYLINE 5 1F 8 A 90 3 70 1 38 12.5 10 0 20 0 10 4 20 0 10 4 20 3 1001 ACAD 1010 9",
            "0 LWPOLYLINE 8 A 70 0 38 7 10 0.1 20 0.2 10 -5 20 1e-7",
            "0 POLYLINE 8 B 66 1 30 20 70 0 0 VERTEX 8 B 10 1 20 1 0 VERTEX 8 B 10 2 20 2 0 VERTEX 10 3 20 3 70 16 0 SEQEND",
            "0 POLYLINE 8 B 66 1 70 9 0 VERTEX 10 1 20 1 30 25 70 32 0 VERTEX 10 2 20 1 30 25 0 VERTEX 10 2 20 2 30 25 0 SEQEND",
            "0 POLYLINE 8 B 66 1 70 8 0 VERTEX 10 1 20 1 30 25 0 VERTEX 10 2 20 1 30 26 0 SEQEND",
            "0 POLYLINE 8 B 66 1 70 64 0 VERTEX 10 1 20 1 30 25 0 VERTEX 10 2 20 1 30 26 0 SEQEND",
            // Programs that write the elevation into the vertices only.
            "0 POLYLINE 8 B 66 1 30 0 70 0 0 VERTEX 10 1 20 1 30 40 0 VERTEX 10 2 20 2 30 40 0 SEQEND",
            "0 LINE 8 C 10 5 20 6 30 30 11 7 21 8 31 30",
            // Seen from below, tilted, on a layout.
            "0 LWPOLYLINE 8 A 38 -8 210 0 220 0 230 -1 10 1 20 0 10 2 20 0",
            "0 LWPOLYLINE 8 D 38 8 210 1 220 0 230 0 10 1 20 0 10 2 20 0",
            "0 LINE 8 C 67 1 10 5 20 6 30 30 11 7 21 8 31 30",
            "0 POINT 8 S 10 100 20 200 30 33.25",
            "0 INSERT 8 A 2 block 66 1 10 0 20 0 0 ATTRIB 8 A 0 SEQEND",
            "0 TEXT 8 T 1 25 10 0 20 0",
        ],
    );
    let report = read_contours(&path, &ReadOptions::default()).unwrap();
    let found: Vec<(f64, Vec<[f64; 2]>)> =
        report.value.contours.iter().map(|c| (c.elevation, c.points.iter().map(|p| p.to_array()).collect())).collect();
    let expected = [
        (12.5, vec![[0.0, 0.0], [4.0, 0.0], [4.0, 3.0], [0.0, 0.0]]),
        (7.0, vec![[0.1, 0.2], [-5.0, 1e-7]]),
        (20.0, vec![[1.0, 1.0], [2.0, 2.0]]),
        (25.0, vec![[1.0, 1.0], [2.0, 1.0], [2.0, 2.0], [1.0, 1.0]]),
        (40.0, vec![[1.0, 1.0], [2.0, 2.0]]),
        (30.0, vec![[5.0, 6.0], [7.0, 8.0]]),
        (8.0, vec![[-1.0, 0.0], [-2.0, 0.0]]),
    ];
    assert_eq!(found, expected);
    assert_eq!(report.value.spots, [DVec3::new(100.0, 200.0, 33.25)]);
    let told: Vec<String> = report.findings.iter().map(ToString::to_string).collect();
    let told = told.join("\n");
    for words in [
        "does not name its coordinate reference system; its unit is said to be feet",
        "1 references to blocks (INSERT)",
        "1 geometries of type TEXT",
        "1 geometries of type polyline in a tilted plane",
        "1 geometries of type entity of a layout",
        "1 geometries of type POLYLINE mesh",
        "its z varies from 25 to 26",
    ] {
        assert!(told.contains(words), "{words}: {told}");
    }
    // Closed lines are areas where areas are asked for.
    let (area, crs) = read_area(&path, &ReadOptions { layer: Some("a".into()), ..ReadOptions::default() }).unwrap();
    assert_eq!((area.0.len(), crs), (1, None));
    let spots = read_spot_heights(&path, &ReadOptions::default()).unwrap().value;
    assert_eq!(spots.points, [DVec3::new(100.0, 200.0, 33.25)]);
}

/// A drawing with these blocks, each its head and its entities, and these entities.
fn with_blocks(dir: &TempDir, blocks: &[&str], entities: &[&str]) -> PathBuf {
    let text = dxf("", entities);
    let at = text.windows(6).position(|w| w == b"BLOCKS").unwrap() + 8;
    let mut inner = String::new();
    for block in blocks {
        let words: Vec<&str> = block.split_whitespace().collect();
        words.chunks(2).for_each(|pair| inner.push_str(&format!("  {}\r\n{}\r\n", pair[0], pair[1])));
        inner.push_str("  0\r\nENDBLK\r\n");
    }
    let path = dir.path().join("in.dxf");
    fs::write(&path, [&text[..at], inner.as_bytes(), &text[at..]].concat()).unwrap();
    path
}

/// The elevation and the points of a line.
type Line = (f64, Vec<[f64; 2]>);

/// Elevations and vertices of the contours of a drawing, and its findings.
fn contours_of(path: &Path, options: &ReadOptions) -> (Vec<Line>, String) {
    let report = read_contours(path, options).unwrap();
    let rounded = |p: &DVec2| p.to_array().map(|c| (c * 1e9).round() / 1e9 + 0.0);
    let lines = report.value.contours.iter().map(|c| (c.elevation, c.points.iter().map(rounded).collect())).collect();
    (lines, report.findings.iter().map(ToString::to_string).collect::<Vec<_>>().join("\n"))
}

#[test]
fn the_height_of_a_flat_polyline_may_be_group_38() {
    let dir = tempfile::tempdir().unwrap();
    let path = dxf_file(
        &dir,
        "",
        &[
            "0 POLYLINE 66 1 8 contour 38 100 70 1 0 VERTEX 10 1 20 1 0 VERTEX 10 2 20 1 0 VERTEX 10 2 20 2 0 SEQEND",
            "0 POLYLINE 66 1 8 contour 30 0 38 105.5 70 0 0 VERTEX 10 1 20 1 30 0 0 VERTEX 10 2 20 1 30 0 0 SEQEND",
            "0 POLYLINE 66 1 8 contour 30 110 38 7 70 0 0 VERTEX 10 1 20 1 0 VERTEX 10 2 20 1 0 SEQEND",
            // Each vertex of a line in space has its own height.
            "0 POLYLINE 66 1 8 contour 38 7 70 8 0 VERTEX 10 1 20 1 30 115 0 VERTEX 10 2 20 1 30 115 0 SEQEND",
            "0 LINE 8 contour 38 120 10 5 20 6 11 7 21 8",
            "0 POINT 8 spot 38 123 10 5 20 6",
        ],
    );
    let (lines, _) = contours_of(&path, &ReadOptions::default());
    assert_eq!(lines.iter().map(|(z, _)| *z).collect::<Vec<_>>(), [100.0, 105.5, 110.0, 115.0, 120.0]);
    let spots = read_spot_heights(&path, &ReadOptions::default()).unwrap().value.points;
    assert_eq!(spots, [DVec3::new(5.0, 6.0, 123.0)]);
}

#[test]
fn blocks_are_placed_scaled_turned_and_nested() {
    let dir = tempfile::tempdir().unwrap();
    let line = "0 LWPOLYLINE 8 contour 38 100 10 1 20 2 10 3 20 2";
    let block = format!("0 BLOCK 8 0 2 TOPO 70 0 10 1 20 2 30 0 {line}");
    let of = |blocks: &[&str], insert: &str| {
        let path = with_blocks(&dir, blocks, &[insert]);
        contours_of(&path, &ReadOptions::default()).0
    };
    let one = |insert: &str| of(&[block.as_str()], insert);
    assert_eq!(one("0 INSERT 8 0 2 topo 10 0 20 0 30 0"), [(100.0, vec![[0.0, 0.0], [2.0, 0.0]])]);
    assert_eq!(one("0 INSERT 2 TOPO 10 10 20 20 30 5"), [(105.0, vec![[10.0, 20.0], [12.0, 20.0]])]);
    assert_eq!(one("0 INSERT 2 TOPO 10 10 20 20 41 3 42 2 43 2"), [(200.0, vec![[10.0, 20.0], [16.0, 20.0]])]);
    assert_eq!(one("0 INSERT 2 TOPO 10 10 20 20 50 90"), [(100.0, vec![[10.0, 20.0], [10.0, 22.0]])]);
    assert_eq!(one("0 INSERT 2 TOPO 10 10 20 20 41 2 50 30"), [(100.0, vec![[10.0, 20.0], [13.464101615, 22.0]])]);
    // Seen from below: x and z change their sign, also those of the place itself.
    let turned = "0 INSERT 2 TOPO 10 10 20 20 30 -150 43 -1 210 0 220 0 230 -1";
    assert_eq!(one(turned), [(250.0, vec![[-10.0, 20.0], [-12.0, 20.0]])]);
    // Two columns and two rows; the steps turn with the block and do not grow with it.
    let many = one("0 INSERT 2 TOPO 10 0 20 0 41 2 70 2 71 2 44 10 45 20 50 90");
    let starts: Vec<[f64; 2]> = many.iter().map(|(_, points)| points[0]).collect();
    assert_eq!(starts, [[0.0, 0.0], [-20.0, 0.0], [0.0, 10.0], [-20.0, 10.0]]);
    assert_eq!(many[0].1[1], [0.0, 4.0]);
    // A block in a block: the inner one is placed first.
    let outer = "0 BLOCK 2 OUTER 10 0 20 0 0 INSERT 2 TOPO 10 5 20 0 30 1 50 90";
    let nested = of(&[&block, outer], "0 INSERT 2 OUTER 10 100 20 0 41 2 42 2 43 2");
    assert_eq!(nested, [(202.0, vec![[110.0, 0.0], [110.0, 4.0]])]);
    // A tilted copy is no contour, and is told.
    let path = with_blocks(&dir, &[&block], &[&format!("{line} 10 9 20 9"), "0 INSERT 2 TOPO 50 90 210 1 220 0 230 0"]);
    let (lines, told) = contours_of(&path, &ReadOptions::default());
    assert!(lines.len() == 1 && told.contains("its z varies"), "{told}");
}

#[test]
fn arcs_in_blocks_stay_close_where_they_are_placed() {
    let dir = tempfile::tempdir().unwrap();
    let block = "0 BLOCK 2 RING 10 0 20 0 0 LWPOLYLINE 8 c 70 1 38 5 10 1 20 0 42 1 10 -1 20 0 42 1";
    let path = with_blocks(&dir, &[block], &["0 INSERT 2 RING 41 1000 42 1000"]);
    let (lines, _) = contours_of(&path, &ReadOptions::default());
    let points: Vec<DVec2> = lines[0].1.iter().map(|&p| p.into()).collect();
    assert!(points.windows(2).all(|w| ((w[0] + w[1]) / 2.0).length() > 1000.0 - 0.0101), "{}", points.len());
}

#[test]
fn layers_in_blocks_are_their_own_or_that_of_the_reference() {
    let dir = tempfile::tempdir().unwrap();
    let block =
        "0 BLOCK 2 B 10 0 20 0 0 LINE 8 0 10 1 20 1 30 20 11 2 21 1 31 20 0 LINE 8 own 10 1 20 1 30 30 11 2 21 1 31 30";
    let path = with_blocks(&dir, &[block], &["0 INSERT 8 given 2 B"]);
    let levels = |layer: &str| {
        let options = ReadOptions { layer: Some(layer.into()), ..ReadOptions::default() };
        contours_of(&path, &options).0.iter().map(|(z, _)| *z).collect::<Vec<_>>()
    };
    assert_eq!((levels("given"), levels("own"), levels("own,given")), (vec![20.0], vec![30.0], vec![20.0, 30.0]));
}

#[test]
fn symbols_and_borders_in_blocks_are_no_contours_at_sea_level() {
    let dir = tempfile::tempdir().unwrap();
    let frame = "0 BLOCK 2 FRAME 10 0 20 0 0 LINE 8 sheet 10 0 20 0 11 9 21 0 0 LINE 8 0 10 0 20 0 11 9 21 0 0 POINT 8 0 10 4 20 4";
    let line = "0 LINE 8 contour 10 5 20 6 30 30 11 7 21 8 31 30";
    let spot = "0 POINT 8 spot 10 5 20 6 30 33";
    let path = with_blocks(&dir, &[frame], &[line, spot, "0 INSERT 8 contour 2 FRAME"]);
    let (lines, told) = contours_of(&path, &ReadOptions::default());
    assert_eq!(lines.iter().map(|(z, _)| *z).collect::<Vec<_>>(), [30.0]);
    assert!(told.contains("3 lines and points of blocks left out"), "{told}");
    let spots = read_spot_heights(&path, &ReadOptions::default()).unwrap().value.points;
    assert_eq!(spots, [DVec3::new(5.0, 6.0, 33.0)]);
    // The coast among contours in blocks stays.
    let coast = "0 BLOCK 2 C 10 0 20 0 0 LINE 8 c 10 0 20 0 11 9 21 0 0 LINE 8 c 10 0 20 0 30 5 11 9 21 0 31 5";
    let (lines, _) = contours_of(&with_blocks(&dir, &[coast], &["0 INSERT 2 C"]), &ReadOptions::default());
    assert_eq!(lines.iter().map(|(z, _)| *z).collect::<Vec<_>>(), [0.0, 5.0]);
    // A drawing whose lines all lie at 0 has no elevations, in blocks or not.
    let error = read_error(&with_blocks(&dir, &[frame], &["0 INSERT 2 FRAME"]));
    assert!(error.contains("no elevations in this drawing"), "{error}");
}

#[test]
fn blocks_that_lead_nowhere_or_everywhere_are_refused() {
    let dir = tempfile::tempdir().unwrap();
    let line = "0 LINE 8 c 10 0 20 0 30 5 11 9 21 0 31 5";
    let with = |blocks: &[&str], insert: &str| with_blocks(&dir, blocks, &[line, insert]);
    let circle = ["0 BLOCK 2 A 0 INSERT 2 B", "0 BLOCK 2 B 0 INSERT 2 A"];
    let (lines, told) = contours_of(&with(&circle, "0 INSERT 2 A"), &ReadOptions::default());
    assert!(lines.len() == 1 && told.contains("\"A\" contains itself"), "{told}");
    let (_, told) = contours_of(&with(&["0 BLOCK 2 X 70 4"], "0 INSERT 2 X"), &ReadOptions::default());
    assert!(told.contains("\"X\" is another drawing"), "{told}");
    let (_, told) = contours_of(&with(&[], "0 INSERT 2 X"), &ReadOptions::default());
    assert!(told.contains("1 references to blocks (INSERT) left out: the block \"X\" is not in the drawing"), "{told}");
    // Each block has the next one ten times: the drawing would have ten to the power of twenty lines.
    let tens: Vec<String> =
        (0..20).map(|k| format!("0 BLOCK 2 B{k} 0 INSERT 2 B{} 70 10 44 1 {line}", k + 1)).collect();
    let tens: Vec<&str> = tens.iter().map(String::as_str).collect();
    assert!(read_error(&with(&tens, "0 INSERT 2 B0")).contains("repeated so often"));
    let array = "0 BLOCK 2 A 10 0 20 0";
    assert!(read_error(&with(&[array], "0 INSERT 2 A 70 32767 71 32767")).contains("repeated so often"));
    let chain: Vec<String> = (0..40).map(|k| format!("0 BLOCK 2 B{k} 0 INSERT 2 B{}", k + 1)).collect();
    let chain: Vec<&str> = chain.iter().map(String::as_str).collect();
    assert!(read_error(&with(&chain, "0 INSERT 2 B0")).contains("nested too deep"));
}

#[test]
fn layers_named_by_numbers_are_told_of_where_there_are_no_heights() {
    let dir = tempfile::tempdir().unwrap();
    let error =
        read_error(&dxf_file(&dir, "", &["0 LINE 8 125 10 5 20 6 11 7 21 8", "0 LINE 8 road 10 5 20 6 11 7 21 8"]));
    assert!(error.contains("names of layers are numbers, such as \"125\""), "{error}");
    let error = read_error(&dxf_file(&dir, "", &["0 LINE 8 road 10 5 20 6 11 7 21 8"]));
    assert!(!error.contains("numbers"), "{error}");
    // The CAD's own layer "0" is no elevation.
    let error = read_error(&dxf_file(&dir, "", &["0 LINE 8 0 10 5 20 6 11 7 21 8"]));
    assert!(!error.contains("numbers"), "{error}");
}

#[test]
fn arcs_become_chords() {
    let dir = tempfile::tempdir().unwrap();
    let path = dxf_file(&dir, "", &["0 LWPOLYLINE 8 A 70 1 38 5 10 10 20 0 42 1 10 -10 20 0 42 1"]);
    let contours = read(&path).unwrap();
    let points = &contours[0].points;
    assert_eq!((points.first(), points.last()), (Some(&DVec2::new(10.0, 0.0)), Some(&DVec2::new(10.0, 0.0))));
    assert!(points.contains(&DVec2::new(-10.0, 0.0)) && points.len() > 60, "{}", points.len());
    assert!(points.windows(2).all(|w| ((w[0] + w[1]) / 2.0).length() > 9.99 - 1e-9));
    assert!(points.iter().all(|p| (p.length() - 10.0).abs() < 1e-9));
    // A single arc must not ask for more memory than the file is worth.
    let path = dxf_file(&dir, "", &["0 LWPOLYLINE 8 A 70 1 38 5 10 1e17 20 0 42 1 10 -1e17 20 0 42 1"]);
    assert!(read_error(&path).contains("arcs that are too large"));
}

#[test]
fn layers_of_a_dxf_choose_the_lines() {
    let dir = tempfile::tempdir().unwrap();
    let line = |layer: &str, z: f64| format!("0 LINE 8 {layer} 10 5 20 6 30 {z} 11 7 21 8 31 {z}");
    let (hill, index, road) = (line("HILL", 10.0), line("hill_index", 50.0), line("ROAD", 0.0));
    let all = [hill.as_str(), index.as_str(), road.as_str()];
    let path = dxf_file(&dir, "", &all);
    let error = read_error(&path);
    assert!(
        error.contains("\"ROAD\"") && error.contains("\"HILL\" (1 lines)") && error.contains("all lie at 0"),
        "{error}"
    );
    let levels = |layers: &str| read_layers(&path, layers).unwrap().iter().map(|c| c.elevation).collect::<Vec<_>>();
    assert_eq!(levels("hill"), [10.0]);
    assert_eq!(levels("HILL, HILL_INDEX"), [10.0, 50.0]);
    assert_eq!(levels("HILL,road"), [10.0, 0.0]);
    let error = read_layers(&path, "HILL,nope").unwrap_err().to_string();
    assert!(error.contains("\"nope\"") && error.contains("\"ROAD\" (1 lines)"), "{error}");
    assert!(read_layers(&path, "road").unwrap_err().to_string().contains("on the layers that were named"));
    // The layer is an attribute too, if one asks for it.
    let named = line("125", 0.0);
    let path = dxf_file(&dir, "", &[named.as_str()]);
    let options = ReadOptions { elevation_field: Some("Layer".into()), ..ReadOptions::default() };
    assert_eq!(read_contours(&path, &options).unwrap().value.contours[0].elevation, 125.0);

    let path = dxf_file(&dir, "", &[road.as_str(), "0 TEXT 8 T 1 25 10 0 20 0"]);
    let error = read_error(&path);
    assert!(error.contains("no elevations in this drawing") && error.contains("the 1 texts"), "{error}");
    let options = ReadOptions { elevation_field: Some("z".into()), ..ReadOptions::default() };
    assert_eq!(read_contours(&path, &options).unwrap().value.contours[0].elevation, 0.0);
}

#[test]
fn layers_are_named_in_the_code_page_of_the_drawing() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("in.dxf");
    let entities = ["0 LINE 8 XX 10 5 20 6 30 3 11 7 21 8 31 3"];
    let with = |header: &str, name: &[u8]| {
        let text = dxf(header, &entities);
        let at = text.windows(2).position(|w| w == b"XX").unwrap();
        fs::write(&path, [&text[..at], name, &text[at + 2..]].concat()).unwrap();
        read_layers(&path, "等高線").unwrap().len()
    };
    assert_eq!(with("9 $ACADVER 1 AC1015 9 $DWGCODEPAGE 3 ANSI_932", b"\x93\x99\x8D\x82\x90\xFC"), 1);
    assert_eq!(with("9 $ACADVER 1 AC1027 9 $DWGCODEPAGE 3 ANSI_932", "等高線".as_bytes()), 1);
    assert_eq!(with("9 $ACADVER 1 AC1015", b"\\U+7B49\\U+9AD8\\U+7DDA"), 1);
}

#[test]
fn broken_drawings_are_told_apart() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("in.dxf");
    let told = |bytes: &[u8]| {
        fs::write(&path, bytes).unwrap();
        read_error(&path)
    };
    assert!(told(b"AutoCAD Binary DXF\r\n\x1a\0").contains("binary DXF"));
    assert!(told(b"AC1032\0\0\0").contains("DWG"));
    assert!(told(b"hello\nworld\n").contains("line 1: \"hello\" is not a group code"));
    assert!(told(b"  0\nEOF\n").contains("no section of entities"));
    let whole = dxf("", &["0 LWPOLYLINE 8 A 38 5 10 1 20 2 10 3 20 4"]);
    assert_eq!(
        told(&whole[..whole.len() - 30]).split(": ").nth(1),
        Some("the file ends within its entities; it is not complete")
    );
    let comma = String::from_utf8(whole).unwrap().replace("\r\n5\r\n", "\r\n5,5\r\n");
    let error = told(comma.as_bytes());
    assert!(error.contains("\"5,5\" is not a number for the group 38") && error.contains("line "), "{error}");
    // Line feeds alone, a mark of UTF-8, and blank lines at the end do no harm.
    let text = format!("\u{feff}{}\n\n", comma.replace("5,5", "5").replace("\r\n", "\n"));
    fs::write(&path, text).unwrap();
    assert_eq!(read(&path).unwrap().len(), 1);
}

#[test]
fn a_dxf_tells_source_and_index_by_its_layers() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("out.dxf");
    let all = lines();
    write_lines(&path, all.clone());
    let counts = |layers: &str| read_layers(&path, layers).unwrap().len();
    let expected = |source, index| all.iter().filter(|line| line.source == source && line.index == index).count();
    assert_eq!(counts("CONTOUR-INPUT"), expected(Source::Input, false));
    assert_eq!(counts("CONTOUR-INPUT-INDEX"), expected(Source::Input, true));
    assert_eq!(counts("CONTOUR-INTERPOLATED"), expected(Source::Interpolated, false));
    assert_eq!(counts("CONTOUR-INTERPOLATED-INDEX"), expected(Source::Interpolated, true));
    let text = fs::read_to_string(&path).unwrap();
    assert!(text.contains("$INSUNITS\n 70\n6\n") && text.contains("$ACADVER\n  1\nAC1015\n"));
    // No two objects have one handle, and the next free one is above them all.
    let pairs: Vec<&str> = text.lines().collect();
    let handle = |pair: &[&str]| u64::from_str_radix(pair[1], 16).unwrap();
    let handles: Vec<u64> = pairs.chunks(2).filter(|pair| matches!(pair[0].trim(), "5" | "105")).map(handle).collect();
    let mut distinct = handles[1..].to_vec();
    distinct.sort_unstable();
    distinct.dedup();
    assert_eq!(distinct.len(), handles.len() - 1);
    assert!(distinct.iter().all(|&used| used < handles[0]));
}

#[test]
fn lines_that_climb_and_areas_in_a_dxf() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("out.dxf");
    let climbing = [DVec3::new(1.0 / 3.0, 2.0, 30.1 + 0.2), DVec3::new(10.0, 20.0, 20.0 / 3.0)];
    let level = [DVec3::new(0.1, 0.2, 0.1 + 0.2), DVec3::new(10.0, 20.0, 0.1 + 0.2)];
    const KIND: &[Column] = &[Column { name: "kind", kind: Kind::Text(8) }];
    let row = |line, kind: &'static str| Row { shape: Shape::Line(line), cells: vec![Cell::Text(kind.into())] };
    let rows = vec![row(&climbing, "ridge"), row(&level, "canyon")];
    write(&path, &[Layer { name: "skeleton", geometry: Geometry::Lines, columns: KIND, rows }]);
    let contours = read_layers(&path, "SKELETON-CANYON").unwrap();
    assert_eq!((contours.len(), contours[0].elevation), (1, 0.1 + 0.2));
    assert_eq!(contours[0].points, level.map(|p| p.truncate()));
    let report = read_contours(&path, &ReadOptions::default()).unwrap();
    assert_eq!(report.value.contours.len(), 1);
    assert!(report.findings.iter().any(|f| f.message.contains("varies from 6.66") && f.message.contains("to 30.3")));

    let rings = vec![square(0.0, 0.0, 10.0), square(20.0, 0.0, 3.3)];
    let rows = vec![Row { shape: Shape::Area(rings), cells: vec![Cell::Text("top 1/2".into())] }];
    write(&path, &[Layer { name: "regions", geometry: Geometry::Areas, columns: KIND, rows }]);
    let options = ReadOptions { layer: Some("REGIONS-TOP_1_2".into()), ..ReadOptions::default() };
    assert_eq!(read_area(&path, &options).unwrap().0.0.len(), 2);
}
