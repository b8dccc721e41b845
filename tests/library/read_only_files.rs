//! Formats that are read and not written: sequences of GeoJSON, tables of well-known text, zipped shapefiles; GeoTIFFs with
//! keys of other programs.

#![allow(clippy::unwrap_used, reason = "helpers of tests are tests too")]

use std::fs;
use std::io::Write;
use std::path::{Path, PathBuf};

use glam::{DVec2, DVec3};
use tempfile::TempDir;
use tiff::encoder::{TiffEncoder, colortype};
use tiff::tags::Tag;
use tokosen::base::error::{Error, FindingKind};
use tokosen::crs::{Crs, Transform};
use tokosen::features::Role;
use tokosen::io::raster::{read_dem, read_grid, write_dem};
use tokosen::io::{
    Content, ReadOptions, VectorSource, content, read_area, read_contours, read_features, read_spot_heights,
};

fn put(dir: &TempDir, name: &str, content: impl AsRef<[u8]>) -> PathBuf {
    let path = dir.path().join(name);
    fs::write(&path, content).unwrap();
    path
}

/// Elevation and first vertex of each contour, and the code of the system.
fn contours(path: &Path) -> (Vec<(f64, [f64; 2])>, Option<u32>) {
    let map = read_contours(path, &ReadOptions::default()).unwrap().value;
    let lines = map.contours.iter().map(|c| (c.elevation, c.points[0].to_array())).collect();
    (lines, map.crs.and_then(|crs| crs.epsg))
}

fn error(path: &Path) -> String {
    read_contours(path, &ReadOptions::default()).map(|r| r.value.contours.len()).unwrap_err().to_string()
}

/// A zip archive of these files.
fn archive(dir: &TempDir, name: &str, files: &[(&str, Vec<u8>)]) -> PathBuf {
    let path = dir.path().join(name);
    let mut out = zip::ZipWriter::new(fs::File::create(&path).unwrap());
    for (name, bytes) in files {
        out.start_file(*name, zip::write::SimpleFileOptions::default()).unwrap();
        out.write_all(bytes).unwrap();
    }
    out.finish().unwrap();
    path
}

/// The parts of a shapefile of two lines, under this name in an archive.
fn shapefile_parts(dir: &TempDir, name: &str, field: &[u8]) -> Vec<(String, Vec<u8>)> {
    let path = dir.path().join("made.shp");
    let mut writer = shapefile::ShapeWriter::from_path(&path).unwrap();
    for y in [0.0, 1.0] {
        let ends = vec![shapefile::Point::new(5.0, y), shapefile::Point::new(6.0, y)];
        writer.write_shape(&shapefile::Polyline::with_parts(vec![ends])).unwrap();
    }
    drop(writer);
    let mut dbf = vec![3, 100, 1, 1, 2, 0, 0, 0, 65, 0, 9, 0];
    dbf.resize(32, 0);
    let mut descriptor = [0; 32];
    descriptor[..field.len()].copy_from_slice(field);
    (descriptor[11], descriptor[16]) = (b'N', 8);
    dbf.extend(descriptor);
    dbf.extend(b"\r       10       20\x1a");
    let prj = Crs::from_epsg(25832).wkt.unwrap().into_bytes();
    let part = |extension: &str, bytes: Vec<u8>| (format!("{name}.{extension}"), bytes);
    let read = |extension: &str| fs::read(path.with_extension(extension)).unwrap();
    vec![part("shp", read("shp")), part("shx", read("shx")), part("dbf", dbf), part("prj", prj)]
}

fn zipped(dir: &TempDir, name: &str, parts: &[(String, Vec<u8>)]) -> PathBuf {
    let files: Vec<(&str, Vec<u8>)> = parts.iter().map(|(name, bytes)| (name.as_str(), bytes.clone())).collect();
    archive(dir, name, &files)
}

#[test]
fn sequences_of_geojson() {
    let dir = TempDir::new().unwrap();
    let feature = |x: u32| {
        format!(
            "{{\"type\":\"Feature\",\"properties\":{{\"elev\":{x}}},\"geometry\":{{\"type\":\"LineString\",\"coordinates\":[[{x},1],[2,3]]}}}}"
        )
    };
    let expected = (vec![(10.0, [10.0, 1.0]), (20.0, [20.0, 1.0])], Some(4326));
    let (a, b) = (feature(10), feature(20));
    let spread = b.replace(",", ",\n");
    for (name, text) in [
        ("a.geojsonl", format!("{a}\n{b}\n")),
        ("a.ndjson", format!("\u{feff}{a}\r\n\r\n{b}")),
        ("a.geojsons", format!("\u{1e}{a}\n\u{1e}{spread}\n")),
        ("b.geojsons", format!("\u{1e}{a}\u{1e}{b}")),
        ("c.geojsonl", format!("{a}{b}")),
    ] {
        assert_eq!(contours(&put(&dir, name, text)), expected, "{name}");
    }
    let points = put(&dir, "p.geojsonl", "{\"type\":\"Point\",\"coordinates\":[1,2,3]}\n");
    assert_eq!(read_spot_heights(&points, &ReadOptions::default()).unwrap().value.points, [DVec3::new(1.0, 2.0, 3.0)]);
    for (text, words) in [
        (format!("{a}\n{{\"type\":"), "the text 1 of the sequence: the file ends in the middle"),
        (format!("{a}\nx"), "the text 1 of the sequence: the text is not JSON"),
        ("{\"type\":\"FeatureCollection\",\"features\":[]}".into(), "a sequence holds features or geometries"),
        ("[".repeat(100_000), "ends in the middle"),
        ("{\"geometry\":".repeat(100_000) + &"}".repeat(100_000), "is not JSON"),
        ("\u{1e}\n\u{1e}".into(), "empty"),
    ] {
        let told = error(&put(&dir, "wrong.geojsonl", text));
        assert!(told.contains(words), "{words}: {told}");
    }
}

#[test]
fn tables_of_well_known_text() {
    let dir = TempDir::new().unwrap();
    let expected = vec![(10.0, [1.0, 2.0]), (20.0, [5.0, 6.0])];
    let lines = "WKT,ELEV\n\"LINESTRING (1 2,3 4)\",10\n\"MULTILINESTRING ((5 6,7 8))\",20\n";
    assert_eq!(contours(&put(&dir, "a.csv", lines)), (expected.clone(), None));
    let tabs = "id\tgeom\theight\n1\tSRID=25832;LINESTRING (1 2,3 4)\t10\n2\tSRID=25832;LINESTRING (5 6,7 8)\t20\n";
    assert_eq!(contours(&put(&dir, "a.tsv", tabs)), (expected.clone(), Some(25832)));
    let z = "the_geom;name\nLINESTRING Z (1 2 10,3 4 10);a\nLINESTRING Z (5 6 20,7 8 20);b\n";
    assert_eq!(contours(&put(&dir, "b.csv", z)), (expected, None));
    let korean = encoding_rs::EUC_KR.encode("WKT,등고수치\n\"LINESTRING (1 2,3 4)\",10\n").0.into_owned();
    assert_eq!(contours(&put(&dir, "c.csv", korean)).0, [(10.0, [1.0, 2.0])]);
    let mixed = "wkt,z\nPOINT (1 2),5\n\"POLYGON ((0 0,9 0,9 9,0 0))\",7\n\"LINESTRING (1 2,3 4)\",8\n";
    let path = put(&dir, "d.csv", mixed);
    assert_eq!(read_spot_heights(&path, &ReadOptions::default()).unwrap().value.points, [DVec3::new(1.0, 2.0, 5.0)]);
    assert_eq!(read_area(&path, &ReadOptions::default()).unwrap().0.0.len(), 1);
    let found = read_features(Role::Streams, &path, &ReadOptions::default()).unwrap().value.features;
    assert_eq!((found.streams.len(), found.river_areas.len()), (1, 1));
    for (text, words) in [
        ("WKT,elev\n\"LINESTRING (1 2,3\",10\n", "line 2: the geometry"),
        ("WKT,elev\nhill,10\n", "line 2: the geometry"),
        (
            "WKT,elev\n\"SRID=1;LINESTRING (1 2,3 4)\",1\n\"SRID=2;LINESTRING (1 2,3 4)\",1\n",
            "several coordinate reference systems",
        ),
        ("x,y,z\n1,2,3\n", "there is no line in it (found: 1 points)"),
        ("a,b\n1,2\n", "or WKT for geometries"),
    ] {
        let told = error(&put(&dir, "wrong.csv", text));
        assert!(told.contains(words), "{words}: {told}");
    }
}

#[test]
fn zipped_shapefiles() {
    let dir = TempDir::new().unwrap();
    let parts = shapefile_parts(&dir, "maps/contours", b"ELEV");
    let expected = (vec![(10.0, [5.0, 0.0]), (20.0, [5.0, 1.0])], Some(25832));
    for name in ["a.zip", "a.shp.zip", "A.ZIP"] {
        let path = zipped(&dir, name, &parts);
        assert_eq!(content(&path).unwrap(), Content::Contours);
        assert_eq!(contours(&path), expected, "{name}");
        let told = read_dem(&path).map(|read| read.findings).unwrap_err().to_string();
        assert!(told.contains("holds a shapefile and no height map"), "{told}");
    }
    // Copies that a Mac adds, and metadata, are no second shapefile.
    let more =
        [&parts[..], &[("__MACOSX/maps/._contours.shp".into(), vec![0]), ("maps/contours.shp.xml".into(), vec![b'<'])]]
            .concat();
    assert_eq!(contours(&zipped(&dir, "mac.zip", &more)), expected);
    // Of several, one is chosen by its name.
    let both = [&parts[..], &shapefile_parts(&dir, "roads", b"ELEV")].concat();
    let path = zipped(&dir, "both.zip", &both);
    let told = read_contours(&path, &ReadOptions::default()).map(|_| ()).unwrap_err();
    assert!(matches!(told.root(), Error::LayerAmbiguous { layers, .. } if layers == &["contours", "roads"]), "{told}");
    let named = |layer: &str| ReadOptions { layer: Some(layer.into()), ..ReadOptions::default() };
    assert_eq!(read_contours(&path, &named("roads")).unwrap().value.contours.len(), 2);
    let told = read_contours(&path, &named("rivers")).map(|_| ()).unwrap_err().to_string();
    assert!(told.contains("\"rivers\"") && told.contains("\"roads\""), "{told}");
    // Messages name the file in the archive.
    let own = shapefile_parts(&dir, "own", b"\xbb\xea\xb3\xf4\xc0\xcc");
    let told = error(&zipped(&dir, "own.zip", &own));
    assert!(told.contains("own.cpg") && !told.contains("in.cpg"), "{told}");
    let mut cut = parts.clone();
    let half = cut[0].1.len() / 2;
    cut[0].1.truncate(half);
    let told = error(&zipped(&dir, "cut.zip", &cut));
    assert!(told.contains("cut.zip!maps/contours.shp"), "{told}");
    // What is no shapefile is still an archive of 基盤地図情報.
    let told = error(&archive(&dir, "other.zip", &[("a.gpkg", vec![0; 9])]));
    assert!(told.contains("the archive holds a .gpkg file"), "{told}");
    let folder = TempDir::new().unwrap();
    zipped(&folder, "sheet.zip", &parts);
    let sheets = VectorSource::from(folder.path()).expand().unwrap();
    assert_eq!(sheets, [VectorSource::from(folder.path().join("sheet.zip"))]);
}

#[test]
fn an_archive_that_unpacks_to_far_more_than_its_size_is_refused() {
    let dir = TempDir::new().unwrap();
    // 300 MB of zeros make about 300 kB.
    let path = archive(&dir, "bomb.zip", &[("a.shp", vec![0; 300 << 20])]);
    let told = error(&path);
    assert!(told.contains("bomb.zip!a.shp") && told.contains("read to its end"), "{told}");
}

/// A GeoTIFF of 2 x 1 cells with these keys; those of a key of more than a short go to `doubles` and `ascii`.
fn tiff_with(path: &Path, keys: &[[u16; 4]], doubles: &[f64], ascii: &str) {
    let mut encoder = TiffEncoder::new(fs::File::create(path).unwrap()).unwrap();
    let mut image = encoder.new_image::<colortype::Gray32Float>(2, 1).unwrap();
    let tags = image.encoder();
    tags.write_tag(Tag::ModelPixelScaleTag, &[2.0_f64, 2.0, 0.0][..]).unwrap();
    tags.write_tag(Tag::ModelTiepointTag, &[0.0_f64, 0.0, 0.0, 649_328.0, 665_262.0, 0.0][..]).unwrap();
    let directory: Vec<u16> =
        [1, 1, 0, keys.len() as u16].into_iter().chain(keys.as_flattened().iter().copied()).collect();
    tags.write_tag(Tag::GeoKeyDirectoryTag, &directory[..]).unwrap();
    tags.write_tag(Tag::GeoDoubleParamsTag, doubles).unwrap();
    tags.write_tag(Tag::GeoAsciiParamsTag, ascii).unwrap();
    image.write_data(&[40.0, 100.0]).unwrap();
}

#[test]
fn a_system_described_by_geokeys_is_read_and_kept() {
    let dir = TempDir::new().unwrap();
    let path = dir.path().join("a.tif");
    // Belgian Lambert 2008 without its code, as GDAL writes it.
    let double = |key: u16, at: u16| [key, 34736, 1, at];
    let ellipsoid = [[2048, 0, 1, 32767], [2050, 0, 1, 32767], [2054, 0, 1, 9102], [2056, 0, 1, 7019]];
    let plane = [[3072, 0, 1, 32767], [3074, 0, 1, 32767], [3075, 0, 1, 8], [3076, 0, 1, 9001]];
    let parameters =
        [double(3078, 2), double(3079, 3), double(3084, 1), double(3085, 0), double(3086, 4), double(3087, 5)];
    let lambert =
        [&[[1024, 0, 1, 1], [1025, 0, 1, 1], [1026, 34737, 8, 0]], &ellipsoid[..], &plane, &parameters].concat();
    let doubles = [50.797815, 4.35921583333333, 49.8333333333333, 51.1666666666667, 649_328.0, 665_262.0];
    tiff_with(&path, &lambert, &doubles, "unknown|");
    let read = read_dem(&path).unwrap();
    assert_eq!(read.findings, []);
    let dem = read.value.dem;
    let crs = dem.crs.clone().unwrap();
    let belgian = Transform::between(&crs, &Crs::from_epsg(3812)).unwrap();
    let place = DVec2::new(700_000.0, 600_000.0);
    assert!(belgian.forward(place).unwrap().distance(place) < 1e-3);
    assert_eq!(read_grid(&path).unwrap().1, Some(crs.clone()));
    // The output keeps the system.
    write_dem(&path, &dem).unwrap();
    assert_eq!(read_dem(&path).unwrap().value.dem.crs, Some(crs));
    // What the keys do not describe completely is told.
    let short: Vec<[u16; 4]> = lambert.iter().copied().filter(|key| key[0] != 3079).collect();
    tiff_with(&path, &short, &doubles, "unknown|");
    let read = read_dem(&path).unwrap();
    assert_eq!(read.findings.iter().map(|f| f.kind).collect::<Vec<_>>(), [FindingKind::UnknownCrs]);
    assert!(read.findings[0].message.contains("standard_parallel_2"), "{}", read.findings[0].message);
}
