//! Vector files as a whole: what is written comes back, and what is broken is said.

#![allow(clippy::unwrap_used, reason = "helpers of tests are tests too")]

use std::fs;
use std::path::{Path, PathBuf};

use glam::{DVec2, DVec3};
use tempfile::TempDir;
use tokosen::base::error::{FindingKind, Report, Result};
use tokosen::contour::{ContourLayer, ContourLine, ContourMap, Source};
use tokosen::crs::Crs;
use tokosen::io::{ReadOptions, StagedOutput, read_contours, read_spot_heights, write_contours};

const FORMATS: [&str; 6] = ["dxf", "fgb", "geojson", "gpkg", "parquet", "shp"];

/// Numbers whose decimal form is easily cut short.
fn nasty_lines() -> Vec<ContourLine> {
    let points = vec![
        DVec2::new(0.1 + 0.2, 1e7 + 1e-9),
        DVec2::new(-0.0, 5e-324),
        DVec2::new(436_265.680_000_000_05, 6_444_375.560_000_000_5),
        DVec2::new(f64::MAX, f64::MIN_POSITIVE),
        DVec2::new(1.0 / 3.0, -2.0f64.powi(60) - 1024.0),
    ];
    let ring = vec![DVec2::new(1e6, 2e6), DVec2::new(1e6 + 0.1, 2e6), DVec2::new(1e6, 2e6 + 0.7), DVec2::new(1e6, 2e6)];
    // Numbers of any bits: a reader that is off by one in the last place is caught by some of a few thousand.
    let mut state = 1_u64;
    let mut any = || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        1e7 * (state >> 11) as f64 / 2.0f64.powi(53)
    };
    let many = (0..5000).map(|_| DVec2::new(any(), any())).collect();
    vec![
        ContourLine {
            elevation: 0.1 + 0.2,
            points,
            source: Source::Input,
            index: true,
            kind: None,
            depression: false,
            expected: None,
        },
        ContourLine {
            elevation: 1.0 / 3.0,
            points: many,
            source: Source::Input,
            index: false,
            kind: None,
            depression: false,
            expected: None,
        },
        ContourLine {
            elevation: -412.5,
            points: ring,
            source: Source::Interpolated,
            index: false,
            kind: None,
            depression: true,
            expected: None,
        },
    ]
}

fn layer(name: &str, lines: Vec<ContourLine>) -> ContourLayer {
    ContourLayer { name: name.to_owned(), lines, artefact_rings: 0, dead_ends: 0 }
}

fn write(path: &Path, layers: &[ContourLayer], crs: Option<&Crs>) -> Result<Vec<PathBuf>> {
    let staged = StagedOutput::create(path)?;
    let written = write_contours(&staged, layers, crs)?;
    staged.commit()?;
    Ok(written)
}

fn read(path: &Path) -> Report<ContourMap> {
    read_contours(path, &ReadOptions::default()).unwrap()
}

fn read_error(path: &Path) -> String {
    let error = read_contours(path, &ReadOptions::default()).unwrap_err();
    let mut text = error.to_string();
    let mut source = std::error::Error::source(&error);
    while let Some(cause) = source {
        text = format!("{text}: {cause}");
        source = cause.source();
    }
    assert!(text.contains(path.to_str().unwrap()), "the message names the file: {text}");
    text
}

fn bits(points: &[DVec2]) -> Vec<[u64; 2]> {
    points.iter().map(|p| [p.x.to_bits(), p.y.to_bits()]).collect()
}

fn names_in(dir: &TempDir) -> Vec<String> {
    let entries = fs::read_dir(dir.path()).unwrap();
    let mut names: Vec<String> = entries.map(|e| e.unwrap().file_name().into_string().unwrap()).collect();
    names.sort();
    names
}

#[test]
fn every_format_gives_back_every_bit() {
    for format in FORMATS {
        for crs in [Some(Crs::from_epsg(25832)), Some(Crs::from_epsg(6677)), Some(Crs::wgs84()), None] {
            let dir = tempfile::tempdir().unwrap();
            let path = dir.path().join("out").with_extension(format);
            let mut lines = nasty_lines();
            if crs == Some(Crs::wgs84()) {
                lines
                    .iter_mut()
                    .for_each(|line| line.points.iter_mut().for_each(|p| *p = p.map(|v| v.rem_euclid(90.0))));
            }
            let written = write(&path, &[layer("contours_5m", lines.clone())], crs.as_ref()).unwrap();
            assert_eq!(written, std::slice::from_ref(&path));
            let mut report = read(&path);
            assert_eq!(report.value.contours.len(), lines.len());
            // A FlatGeobuf has its features in the order of its spatial index, a GeoParquet along a curve.
            report.value.contours.sort_by(|a, b| a.elevation.total_cmp(&b.elevation));
            lines.sort_by(|a, b| a.elevation.total_cmp(&b.elevation));
            // A DXF cannot name its system.
            let crs = crs.filter(|_| format != "dxf");
            for (got, line) in report.value.contours.iter().zip(&lines) {
                assert_eq!(got.elevation.to_bits(), line.elevation.to_bits(), "{format}");
                assert_eq!(bits(&got.points), bits(&line.points), "{format}");
            }
            assert_eq!(report.value.crs.as_ref().and_then(|crs| crs.epsg), crs.as_ref().and_then(|crs| crs.epsg));
            let unknown = report.findings.iter().filter(|f| f.kind == FindingKind::UnknownCrs).count();
            assert_eq!(unknown, usize::from(crs.is_none()), "{format}: {:?}", report.findings);
        }
    }
}

#[test]
fn a_system_without_a_code_survives() {
    let wkt = r#"PROJCS["town grid",GEOGCS["t",DATUM["t",SPHEROID["t",6378137,298.25]],PRIMEM["Greenwich",0],UNIT["degree",0.0174532925199433]],PROJECTION["Transverse_Mercator"],UNIT["metre",1]]"#;
    for format in FORMATS.into_iter().filter(|&format| format != "dxf") {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("out").with_extension(format);
        write(&path, &[layer("a", nasty_lines())], Some(&Crs::from_wkt(wkt))).unwrap();
        let crs = read(&path).value.crs.unwrap();
        assert_eq!((crs.epsg, crs.wkt.as_deref()), (None, Some(wkt)), "{format}");
    }
}

#[test]
fn the_same_lines_give_the_same_bytes() {
    for format in FORMATS {
        let dir = tempfile::tempdir().unwrap();
        let mut contents = Vec::new();
        for stem in ["a", "b"] {
            let path = dir.path().join(stem).with_extension(format);
            write(&path, &[layer("lines", nasty_lines())], Some(&Crs::from_epsg(2193))).unwrap();
            let companions = ["shx", "dbf", "prj", "cpg"].iter().map(|ext| path.with_extension(ext));
            let all = std::iter::once(path.clone()).chain(companions).filter(|p| p.exists());
            contents.push(all.map(|p| fs::read(p).unwrap()).collect::<Vec<_>>());
        }
        assert_eq!(contents[0], contents[1], "{format}");
    }
}

#[test]
fn several_layers_go_into_one_geopackage_and_into_one_file_each_elsewhere() {
    let lines = nasty_lines();
    let layers = [layer("contours_2m", lines[..1].to_vec()), layer("contours_1m", lines[1..].to_vec())];

    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("out.gpkg");
    assert_eq!(write(&path, &layers, None).unwrap(), std::slice::from_ref(&path));
    assert_eq!(names_in(&dir), ["out.gpkg"]);
    let error = read_error(&path);
    assert!(error.contains("\"contours_1m\", \"contours_2m\"") && error.contains("several layers of lines"), "{error}");
    for layer in &layers {
        let options = ReadOptions { layer: Some(layer.name.to_uppercase()), ..ReadOptions::default() };
        let map = read_contours(&path, &options).unwrap().value;
        assert_eq!(map.contours[0].elevation, layer.lines[0].elevation);
    }
    let options = ReadOptions { layer: Some("nope".into()), ..ReadOptions::default() };
    let error = read_contours(&path, &options).unwrap_err().to_string();
    assert!(error.contains("\"nope\"") && error.contains("contours_2m"), "{error}");

    for format in FORMATS.into_iter().filter(|&format| format != "gpkg") {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("out").with_extension(format);
        let written = write(&path, &layers, None).unwrap();
        let expected = ["out_2m", "out_1m"].map(|stem| dir.path().join(stem).with_extension(format));
        assert_eq!(written, expected);
        assert!(!path.exists());
        for (path, layer) in written.iter().zip(&layers) {
            let contours = read(path).value.contours;
            assert!(contours.iter().any(|contour| contour.elevation == layer.lines[0].elevation));
            assert_eq!(contours.len(), layer.lines.len());
        }
        let error = write(&path, &[layer("contours_1m", vec![]), layer("1m", vec![])], None).unwrap_err().to_string();
        assert!(error.contains("two layers"), "{error}");
    }
}

#[test]
fn layers_without_lines_and_odd_names_can_be_written() {
    for format in FORMATS {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("out").with_extension(format);
        write(&path, &[layer("it's \"odd\" 等高線/..", vec![])], Some(&Crs::from_epsg(6677))).unwrap();
        assert!(read_error(&path).contains("there is no line"), "{format}");
        write(&path, &[layer("a/b", nasty_lines()), layer("it's \"odd\"", nasty_lines())], None).unwrap();
    }
}

#[test]
fn lines_that_no_format_can_hold_are_refused() {
    let line = |points: Vec<DVec2>, elevation| {
        vec![ContourLine {
            elevation,
            points,
            source: Source::Input,
            index: false,
            kind: None,
            depression: false,
            expected: None,
        }]
    };
    for format in FORMATS {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("out").with_extension(format);
        for lines in [
            line(vec![], 1.0),
            line(vec![DVec2::ZERO], 1.0),
            line(vec![DVec2::ZERO, DVec2::NAN], 1.0),
            line(vec![DVec2::ZERO, DVec2::ONE], f64::INFINITY),
        ] {
            assert!(write(&path, &[layer("a", lines)], None).is_err());
        }
        assert!(write(&path, &[], None).is_err());
        assert!(names_in(&dir).is_empty(), "{:?}", names_in(&dir));
    }
}

#[test]
fn an_unknown_extension_lists_the_known_ones() {
    let dir = tempfile::tempdir().unwrap();
    for name in ["a.tab", "a", ".gpkg"] {
        let path = dir.path().join(name);
        fs::write(&path, "x").unwrap();
        let error = read_error(&path);
        assert!(FORMATS.iter().all(|format| error.contains(&format!(".{format}"))), "{error}");
        assert!(write(&path, &[layer("a", nasty_lines())], None).is_err());
    }
}

fn geojson(dir: &TempDir, text: &str) -> PathBuf {
    let path = dir.path().join("in.geojson");
    fs::write(&path, text).unwrap();
    path
}

const LINE: &str =
    r#"{"type":"Feature","properties":{"elev":10},"geometry":{"type":"LineString","coordinates":[[0,0],[1,1]]}}"#;

#[test]
fn geojson_in_every_shape() {
    let dir = tempfile::tempdir().unwrap();
    let text = format!(
        "\u{feff}{{\"features\":[{LINE},
          {{\"geometry\":{{\"coordinates\":[[[0,1],[1,2]],[[5,5,20],[6,6,20]]],\"type\":\"MultiLineString\"}},\"properties\":{{\"elev\":\"20\"}},\"type\":\"Feature\"}},
          {{\"type\":\"Feature\",\"properties\":null,\"geometry\":null}},
          {{\"type\":\"Feature\",\"properties\":{{\"elev\":30.5,\"x\":{{\"y\":[1]}}}},\"geometry\":{{\"type\":\"GeometryCollection\",\"geometries\":[
             {{\"type\":\"LineString\",\"coordinates\":[[2,2],[3,3]]}},{{\"type\":\"Point\",\"coordinates\":[4,4]}},
             {{\"type\":\"Polygon\",\"coordinates\":[[[0,0],[1,0],[1,1],[0,0]]]}}]}}}},
          {{\"type\":\"Feature\",\"properties\":{{\"elev\":40}},\"geometry\":{{\"type\":\"MultiPoint\",\"coordinates\":[[7,7],[8,8]]}}}}
        ],\"bbox\":[0,0,1,1],\"crs\":{{\"type\":\"name\",\"properties\":{{\"name\":\"urn:ogc:def:crs:EPSG::25832\"}}}},\"type\":\"FeatureCollection\"}}"
    );
    let report = read(&geojson(&dir, &text));
    let map = report.value;
    let got: Vec<_> = map.contours.iter().map(|c| (c.feature.number(), c.elevation, c.points.len())).collect();
    assert_eq!(got, [(0, 10.0, 2), (1, 20.0, 2), (1, 20.0, 2), (3, 30.5, 2)]);
    assert_eq!(map.spots, [DVec3::new(4.0, 4.0, 30.5), DVec3::new(7.0, 7.0, 40.0), DVec3::new(8.0, 8.0, 40.0)]);
    assert_eq!(map.crs.unwrap().epsg, Some(25832));
    let messages: Vec<_> = report.findings.iter().map(|f| f.message.as_str()).collect();
    assert_eq!(messages.len(), 2, "{messages:?}");
    assert!(
        messages[0].contains("1 geometries of type Polygon") && messages[1].contains("1 features without geometry")
    );

    for text in [LINE.to_owned(), r#"{"type":"LineString","coordinates":[[0,0,10],[1,1,10]]}"#.to_owned()] {
        let map = read(&geojson(&dir, &text)).value;
        assert_eq!(map.contours[0].elevation, 10.0);
        assert_eq!(map.crs.unwrap().epsg, Some(4326));
    }
}

#[test]
fn geojson_systems() {
    let dir = tempfile::tempdir().unwrap();
    let with = |crs: &str, x: &str| {
        let line = LINE.replace("[1,1]", &format!("[{x},1]"));
        read(&geojson(&dir, &format!("{{\"type\":\"FeatureCollection\",{crs}\"features\":[{line}]}}")))
    };
    let named = |name: &str| format!(r#""crs":{{"type":"name","properties":{{"name":"{name}"}}}},"#);
    assert_eq!(with("", "1").value.crs.unwrap().epsg, Some(4326));
    assert_eq!(with(&named("urn:ogc:def:crs:OGC:1.3:CRS84"), "1").value.crs.unwrap().epsg, Some(4326));
    assert_eq!(with(&named("EPSG:6677"), "1").value.crs.unwrap().epsg, Some(6677));
    assert_eq!(with(r#""crs":{"type":"EPSG","properties":{"code":2193}},"#, "1").value.crs.unwrap().epsg, Some(2193));
    for (crs, x) in [("", "181"), (r#""crs":null,"#, "1"), (&named("town grid"), "1"), (r#""crs":7,"#, "1")] {
        let report = with(crs, x);
        assert_eq!(report.value.crs, None, "{crs}");
        let unknown = report.findings.iter().filter(|f| f.kind == FindingKind::UnknownCrs).count();
        assert_eq!(unknown, 1, "{crs}");
        assert_eq!(report.value.looks_like_degrees(), x == "1");
    }
    assert!(!ContourMap::default().looks_like_degrees());
}

#[test]
fn broken_geojson_is_told_apart() {
    let dir = tempfile::tempdir().unwrap();
    let collection = format!("{{\"type\":\"FeatureCollection\",\"features\":[{LINE}]}}");
    for (text, word) in [
        ("", "empty"),
        ("  \n", "empty"),
        (&collection[..collection.len() - 20], "not complete"),
        ("elev,x,y\n1,2,3\n", "not JSON"),
        ("[1,2,3]", "not GeoJSON"),
        ("17", "not GeoJSON"),
        ("{}", "type member is missing"),
        (r#"{"type":"Topology","objects":{}}"#, "Topology"),
        (r#"{"type":"FeatureCollection"}"#, "no features"),
        (r#"{"type":"FeatureCollection","features":[]}"#, "there is no line"),
        (r#"{"type":"FeatureCollection","features":{}}"#, "not GeoJSON"),
        (
            r#"{"type":"FeatureCollection","features":[{"type":"Feature","properties":{},"geometry":{"type":"Polygon","coordinates":[[[0,0],[1,1],[1,0],[0,0]]]}}]}"#,
            "1 Polygon",
        ),
        (r#"{"type":"LineString","coordinates":[[0],[1]]}"#, "position has one number"),
        (r#"{"type":"LineString","coordinates":[[0,0],7]}"#, "mix"),
        (r#"{"type":"LineString","coordinates":["a","b"]}"#, "line 1"),
        (r#"{"type":"LineString","coordinates":5}"#, "bare number"),
        (r#"{"type":"LineString","coordinates":[[1e999,0],[1,1]]}"#, "number out of range"),
        (&format!("{collection}{collection}"), "trailing"),
        (&"[".repeat(100_000), "GeoJSON"),
        (&format!("{{\"type\":\"LineString\",\"coordinates\":{}", "[".repeat(100_000)), "recursion"),
    ] {
        let error = read_error(&geojson(&dir, text));
        assert!(error.contains(word), "{word}: {error}");
    }
    assert!(read_error(&dir.path().join("missing.geojson")).contains("cannot read"));
    fs::create_dir(dir.path().join("folder.shp")).unwrap();
    assert!(read_error(&dir.path().join("folder.shp")).contains("folder"));
    let options = ReadOptions { layer: Some("x".into()), ..ReadOptions::default() };
    assert!(read_contours(&geojson(&dir, LINE), &options).unwrap_err().to_string().contains("no layers"));
}

#[test]
fn spot_heights_from_a_file_of_points() {
    let dir = tempfile::tempdir().unwrap();
    let point = |x: f64, elev: &str| {
        format!(
            r#"{{"type":"Feature","properties":{{"H":{elev}}},"geometry":{{"type":"Point","coordinates":[{x},2]}}}}"#
        )
    };
    let text =
        format!(r#"{{"type":"FeatureCollection","features":[{},{},{LINE}]}}"#, point(1.0, "5.5"), point(3.0, "null"));
    let path = geojson(&dir, &text);
    let options = ReadOptions { elevation_field: Some("h".into()), ..ReadOptions::default() };
    let report = read_spot_heights(&path, &options).unwrap();
    assert_eq!(report.value.points, [DVec3::new(1.0, 2.0, 5.5)]);
    assert_eq!(report.value.crs.unwrap().epsg, Some(4326));
    assert_eq!(report.findings.len(), 2, "{:?}", report.findings);
    let error = read_spot_heights(&path, &ReadOptions::default()).unwrap_err().to_string();
    assert!(error.contains("H (such as 5.5)"), "{error}");
    let error = read_spot_heights(&geojson(&dir, LINE), &options).unwrap_err().to_string();
    assert!(error.contains("there is no point"), "{error}");
}

#[test]
fn a_geopackage_with_lines_and_points() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("in.gpkg");
    write(&path, &[layer("lines", nasty_lines())], Some(&Crs::from_epsg(25832))).unwrap();
    let db = rusqlite::Connection::open(&path).unwrap();
    let point = |x: f64, big: bool| {
        let mut blob = b"GP\0\x01\0\0\0\0".to_vec();
        blob.push(u8::from(!big));
        blob.extend(if big { 1_u32.to_be_bytes() } else { 1_u32.to_le_bytes() });
        for n in [x, 2.0] {
            blob.extend(if big { n.to_be_bytes() } else { n.to_le_bytes() });
        }
        blob
    };
    db.execute_batch(
        "CREATE TABLE summits (fid INTEGER PRIMARY KEY, shape BLOB, name TEXT, height REAL);
         INSERT INTO gpkg_contents (table_name, data_type, srs_id) VALUES ('summits', 'features', 25832);
         INSERT INTO gpkg_geometry_columns VALUES ('summits', 'shape', 'GEOMETRY', 25832, 0, 0);",
    )
    .unwrap();
    for (fid, x, big) in [(7, 1.5, true), (8, 2.5, false)] {
        db.execute("INSERT INTO summits VALUES (?1, ?2, 'top', ?3)", rusqlite::params![fid, point(x, big), x * 100.0])
            .unwrap();
    }
    db.execute("INSERT INTO summits VALUES (9, NULL, NULL, NULL)", []).unwrap();
    drop(db);
    let report = read(&path);
    assert_eq!(report.value.contours.len(), nasty_lines().len());
    assert_eq!(report.value.spots, [DVec3::new(1.5, 2.0, 150.0), DVec3::new(2.5, 2.0, 250.0)]);
    assert_eq!(report.value.crs.unwrap().epsg, Some(25832));
    assert_eq!(read_spot_heights(&path, &ReadOptions::default()).unwrap().value.points.len(), 2);

    let db = rusqlite::Connection::open(&path).unwrap();
    db.execute("UPDATE gpkg_geometry_columns SET srs_id = 4326 WHERE table_name = 'summits'", []).unwrap();
    drop(db);
    let report = read(&path);
    assert!(report.value.spots.is_empty());
    assert!(report.findings.iter().any(|f| f.message.contains("summits")), "{:?}", report.findings);

    let db = rusqlite::Connection::open(&path).unwrap();
    db.execute("UPDATE lines SET geom = x'4750' WHERE fid = 2", []).unwrap_err();
    db.execute_batch("DROP TRIGGER rtree_lines_geom_update1; DROP TRIGGER rtree_lines_geom_update2; DROP TRIGGER rtree_lines_geom_update3; DROP TRIGGER rtree_lines_geom_update4").unwrap();
    db.execute("UPDATE lines SET geom = x'4750' WHERE fid = 2", []).unwrap();
    drop(db);
    let error = read_error(&path);
    assert!(error.contains("\"lines\", feature 2"), "{error}");
}

#[test]
fn broken_geopackages_are_told_apart() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("in.gpkg");
    fs::write(&path, "").unwrap();
    assert!(read_error(&path).contains("empty"));
    fs::write(&path, "S").unwrap();
    assert!(read_error(&path).contains("too short for a GeoPackage"));
    fs::write(&path, "this is no database, however long the text goes on, really ".repeat(50)).unwrap();
    assert!(read_error(&path).contains("not a GeoPackage"));
    fs::remove_file(&path).unwrap();
    rusqlite::Connection::open(&path).unwrap().execute_batch("CREATE TABLE a (b)").unwrap();
    assert!(read_error(&path).contains("not a GeoPackage"));

    write(&path, &[layer("lines", nasty_lines())], None).unwrap();
    let whole = fs::read(&path).unwrap();
    for end in (1..whole.len()).step_by(997) {
        fs::write(&path, &whole[..end]).unwrap();
        let _ = read_contours(&path, &ReadOptions::default());
    }
    fs::write(&path, &whole[..whole.len() / 2]).unwrap();
    read_error(&path);
}

#[test]
fn column_names_that_are_no_utf8_are_read() {
    let dir = TempDir::new().unwrap();
    let path = dir.path().join("lines.gpkg");
    write(&path, &[layer("contours_10m", nasty_lines())], None).unwrap();
    let count = read(&path).value.contours.len();
    let mut bytes = std::fs::read(&path).unwrap();
    let column = b"\"source\" TEXT";
    let at = bytes.windows(column.len()).position(|w| w == column).unwrap();
    bytes[at + 1] = 0xff;
    std::fs::write(&path, bytes).unwrap();
    assert_eq!(read(&path).value.contours.len(), count);
}

/// A `.dbf` of one field and one record a value.
fn dbf(name: &[u8], kind: u8, width: u8, language: u8, values: &[&str], deleted: Option<usize>) -> Vec<u8> {
    let mut bytes = vec![3, 100, 1, 1];
    bytes.extend((values.len() as u32).to_le_bytes());
    bytes.extend(65_u16.to_le_bytes());
    bytes.extend((u16::from(width) + 1).to_le_bytes());
    bytes.extend([0; 20]);
    bytes[29] = language;
    let mut descriptor = [0; 32];
    descriptor[..name.len()].copy_from_slice(name);
    (descriptor[11], descriptor[16]) = (kind, width);
    bytes.extend(descriptor);
    bytes.push(b'\r');
    for (i, value) in values.iter().enumerate() {
        bytes.push(if deleted == Some(i) { b'*' } else { b' ' });
        bytes.extend(format!("{value:>0$}", usize::from(width)).bytes());
    }
    bytes.push(0x1a);
    bytes
}

/// A shapefile of flat lines, one a value of its single attribute.
fn flat_shapefile(dir: &TempDir, dbf: &[u8], count: usize) -> PathBuf {
    let path = dir.path().join("in.shp");
    let mut writer = shapefile::ShapeWriter::from_path(&path).unwrap();
    for i in 0..count {
        let point = |y: f64| shapefile::Point::new(i as f64, y);
        writer.write_shape(&shapefile::Polyline::with_parts(vec![vec![point(0.0), point(1.0)]])).unwrap();
    }
    drop(writer);
    fs::write(path.with_extension("dbf"), dbf).unwrap();
    path
}

#[test]
fn shapefile_attributes_in_japanese_and_german() {
    for (name, language, label) in [
        (&b"\x95\x57\x8d\x82"[..], 0, Some("932")),
        (b"\x95\x57\x8d\x82", 0, Some("Shift_JIS")),
        (b"\x95\x57\x8d\x82", 0x13, None),
        (b"\x95\x57\x8d\x82", 0, None),
        ("標高".as_bytes(), 0, Some("UTF-8")),
        ("標高".as_bytes(), 0, None),
        (b"H\xf6he", 0x57, None),
        (b"H\xf6he", 0, Some("ISO 88591")),
    ] {
        let dir = tempfile::tempdir().unwrap();
        let path = flat_shapefile(&dir, &dbf(name, b'N', 8, language, &["10", "20.5"], None), 2);
        if let Some(label) = label {
            fs::write(path.with_extension("cpg"), label).unwrap();
        }
        let map = read(&path).value;
        assert_eq!(map.contours.iter().map(|c| c.elevation).collect::<Vec<_>>(), [10.0, 20.5], "{name:?} {label:?}");
    }
}

#[test]
fn shapefile_names_in_other_scripts_without_a_cpg() {
    let dir = TempDir::new().unwrap();
    let elevations = |name: &[u8], language: u8, options: &ReadOptions| {
        let path = flat_shapefile(&dir, &dbf(name, b'N', 8, language, &["10", "20.5"], None), 2);
        let map = read_contours(&path, options)?.value;
        Ok::<_, tokosen::Error>(map.contours.iter().map(|c| c.elevation).collect::<Vec<_>>())
    };
    let plain = ReadOptions::default();
    for (name, language) in [
        // Korean, Russian, Chinese in two encodings, Japanese as Unix has it, Polish; 0x57 says nothing, 3 is wrong.
        (&b"\xb5\xee\xb0\xed\xbc\xf6\xc4\xa1"[..], 0x57),
        (b"\xb5\xee\xb0\xed\xbc\xf6\xc4\xa1", 3),
        (b"\xe2\xfb\xf1\xee\xf2\xe0", 0x57),
        (b"\xb8\xdf\xb3\xcc", 0),
        (b"\xb0\xaa\xb5\x7b", 0),
        (b"\xc9\xb8\xb9\xe2", 0),
        (b"wysoko\x9c\xe6", 0),
    ] {
        assert_eq!(elevations(name, language, &plain).unwrap(), [10.0, 20.5], "{name:?} {language}");
    }
    // A name that is not known: the message says what to do, and the name may be given.
    let own = b"\xbb\xea\xb3\xf4\xc0\xcc";
    let error = elevations(own, 0, &plain).unwrap_err().to_string();
    assert!(error.contains("in.cpg") && error.contains("EUC-KR"), "{error}");
    let named = |name: &str| ReadOptions { elevation_field: Some(name.into()), ..ReadOptions::default() };
    assert_eq!(elevations(own, 0, &named("산높이")).unwrap(), [10.0, 20.5]);
    let error = elevations(own, 0, &named("산")).unwrap_err().to_string();
    assert!(error.contains("in.cpg"), "{error}");
    // Where the encoding is known, or does not matter, nothing is said about it.
    let error = elevations(b"H\xf6", 0x03, &plain).unwrap_err().to_string();
    assert!(!error.contains(".cpg"), "{error}");
    let error = elevations(b"NAME", 0, &plain).unwrap_err().to_string();
    assert!(!error.contains(".cpg"), "{error}");
}

#[test]
fn shapefile_numbers_of_every_kind() {
    let dir = tempfile::tempdir().unwrap();
    let read_values = |kind: u8, values: &[&str]| {
        let path = flat_shapefile(&dir, &dbf(b"ELEV", kind, 24, 0, values, None), values.len());
        read(&path).value.contours.iter().map(|c| c.elevation).collect::<Vec<_>>()
    };
    // Through f32 this would be 12.300000190734863.
    assert_eq!(read_values(b'F', &["1.23000000000e+001"]), [12.3]);
    assert_eq!(read_values(b'N', &["12.3", "", "****"]), [12.3]);
    assert_eq!(read_values(b'C', &["12.3"]), [12.3]);
    let path = flat_shapefile(&dir, &dbf(b"ELEV", b'C', 24, 0, &["1", "top"], None), 2);
    let error = read_error(&path);
    assert!(error.contains("feature 1") && error.contains("\"top\""), "{error}");
}

#[test]
fn deleted_records_take_their_shape_with_them() {
    let dir = tempfile::tempdir().unwrap();
    let path = flat_shapefile(&dir, &dbf(b"ELEV", b'N', 8, 0, &["10", "20", "30"], Some(1)), 3);
    let map = read(&path).value;
    let got: Vec<_> = map.contours.iter().map(|c| (c.feature.number(), c.elevation, c.points[0].x)).collect();
    assert_eq!(got, [(0, 10.0, 0.0), (2, 30.0, 2.0)]);
}

#[test]
fn shapefile_companions_may_be_missing_or_wrong() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("out.shp");
    write(&path, &[layer("a", nasty_lines())], Some(&Crs::from_epsg(6677))).unwrap();
    assert_eq!(names_in(&dir), ["out.cpg", "out.dbf", "out.prj", "out.shp", "out.shx"]);
    let mut whole = read(&path).value;

    fs::remove_file(path.with_extension("dbf")).unwrap();
    whole.depressions.clear();
    assert_eq!(read(&path).value, whole, "z has the elevation, and the marks are lost");
    fs::remove_file(path.with_extension("shx")).unwrap();
    assert_eq!(read(&path).value, whole);
    fs::write(path.with_extension("shx"), "garbage").unwrap();
    assert_eq!(read(&path).value, whole);
    fs::write(path.with_extension("prj"), "garbage").unwrap();
    assert_eq!(read(&path).value.crs, Some(Crs { epsg: None, wkt: Some("garbage".into()) }));
    fs::remove_file(path.with_extension("prj")).unwrap();
    assert_eq!(read(&path).value.crs, None);

    let flat = flat_shapefile(&dir, &dbf(b"ELEV", b'N', 8, 0, &["10", "20"], None), 3);
    assert!(read_error(&flat).contains("do not belong together"));
    let flat = flat_shapefile(&dir, &dbf(b"ELEV", b'N', 8, 0, &["10", "20", "30", "40"], None), 3);
    assert!(read_error(&flat).contains("do not belong together"));
    fs::remove_file(flat.with_extension("dbf")).unwrap();
    assert!(read_error(&flat).contains("no z"));
}

#[test]
fn no_cut_or_changed_byte_of_a_shapefile_panics() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("out.shp");
    let mut lines = nasty_lines();
    lines.retain(|line| line.points.len() < 10);
    write(&path, &[layer("a", lines)], Some(&Crs::from_epsg(6677))).unwrap();
    for extension in ["shp", "shx", "dbf", "cpg"] {
        let file = path.with_extension(extension);
        let whole = fs::read(&file).unwrap();
        for end in 0..whole.len() {
            fs::write(&file, &whole[..end]).unwrap();
            let _ = read_contours(&path, &ReadOptions::default());
        }
        for at in 0..whole.len() {
            for byte in [0, 0x20, 0x7f, 0xff] {
                let mut changed = whole.clone();
                changed[at] = byte;
                fs::write(&file, &changed).unwrap();
                let _ = read_contours(&path, &ReadOptions::default());
            }
        }
        fs::write(&file, &whole).unwrap();
    }
    let whole = fs::read(&path).unwrap();
    fs::write(&path, &whole[..whole.len() - 10]).unwrap();
    assert!(read_error(&path).contains("not complete"));
    fs::write(&path, "not a shapefile").unwrap();
    assert!(read_error(&path).contains("not a shapefile"));
}

#[cfg(target_os = "linux")]
#[test]
fn a_full_disk_is_an_error_for_every_file_of_a_format() {
    let dir = tempfile::tempdir().unwrap();
    let shapefile = ["out.shp", "out.shx", "out.dbf", "out.prj", "out.cpg"];
    for name in ["out.geojson", "out.gpkg", "out.fgb", "out.parquet", "out.dxf"].into_iter().chain(shapefile) {
        let extension = Path::new(name).extension().unwrap().to_str().unwrap();
        let main = if FORMATS.contains(&extension) { extension } else { "shp" };
        let path = dir.path().join("out").with_extension(main);
        let staged = StagedOutput::create(&path).unwrap();
        std::os::unix::fs::symlink("/dev/full", staged.sibling(name)).unwrap();
        let error = write_contours(&staged, &[layer("a", nasty_lines())], Some(&Crs::from_epsg(6677))).unwrap_err();
        if main != "gpkg" {
            let cause = std::error::Error::source(&error).unwrap().downcast_ref::<std::io::Error>().unwrap();
            assert_eq!(cause.kind(), std::io::ErrorKind::StorageFull, "{name}");
        }
        assert!(!error.to_string().contains(".tokosen-"), "{error}");
        drop(staged);
        assert!(names_in(&dir).is_empty());
    }
}

#[test]
fn nothing_is_left_when_writing_fails_or_is_given_up() {
    let dir = tempfile::tempdir().unwrap();
    for format in FORMATS {
        let path = dir.path().join("out").with_extension(format);
        fs::write(&path, "old").unwrap();
        let staged = StagedOutput::create(&path).unwrap();
        write_contours(&staged, &[layer("a", nasty_lines())], None).unwrap();
        drop(staged);
        assert_eq!(fs::read_to_string(&path).unwrap(), "old");
    }
    assert_eq!(names_in(&dir), FORMATS.map(|format| format!("out.{format}")));
}
