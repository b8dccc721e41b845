//! Height maps read from files: what was written comes back, and broken files are errors that name the file.

#![allow(clippy::unwrap_used, reason = "helpers of tests are tests too")]

use std::fs;
use std::path::{Path, PathBuf};

use glam::DVec2;
use tempfile::TempDir;
use tiff::encoder::{Compression, Predictor, TiffEncoder, colortype};
use tiff::tags::Tag;
use tokosen::base::Grid;
use tokosen::base::error::{Error, FindingKind};
use tokosen::crs::Crs;
use tokosen::io::raster::{
    PngEncoding, Quantity, RasterParams, read_dem, read_grid, write_dem, write_raster, write_shade,
};
use tokosen::raster::Dem;

/// Rolling ground with a hole.
fn sample(cols: usize, rows: usize) -> Dem {
    let grid = Grid { corner: DVec2::new(-12_340.5, 56_780.25), cell: DVec2::new(10.0, 12.5), cols, rows };
    let height = |i: usize| 400.0 + 90.0 * ((i % cols) as f32 * 0.37).sin() * ((i / cols) as f32 * 0.21).cos();
    let mut values: Vec<f32> = (0..grid.len()).map(height).collect();
    values[grid.len() / 2] = f32::NAN;
    Dem { grid, values, crs: Some(Crs::from_epsg(6677)) }
}

fn same_bits(a: &[f32], b: &[f32]) -> bool {
    a.len() == b.len() && a.iter().zip(b).all(|(a, b)| a.to_bits() == b.to_bits() || a.is_nan() && b.is_nan())
}

/// A file of every kind that is written and read.
fn files(dir: &Path, dem: &Dem) -> Vec<PathBuf> {
    let paths = ["tif", "asc", "exr", "png"].map(|extension| dir.join("dem").with_extension(extension));
    paths.iter().for_each(|path| write_dem(path, dem).unwrap());
    paths.to_vec()
}

#[test]
fn what_is_written_comes_back() {
    let dir = TempDir::new().unwrap();
    let dem = sample(43, 31);
    for path in files(dir.path(), &dem) {
        let read = read_dem(&path).unwrap();
        assert_eq!(read.findings, [], "{path:?}");
        let back = read.value.dem;
        assert_eq!(back.grid, dem.grid, "{path:?}");
        assert_eq!(back.crs.as_ref().unwrap().epsg, Some(6677), "{path:?}");
        assert_eq!(read_grid(&path).unwrap(), (back.grid, back.crs.clone()), "{path:?}");
        if path.extension().unwrap() == "png" {
            for (a, b) in back.values.iter().zip(&dem.values) {
                assert!((a - b).abs() <= 0.0051 || a.is_nan() && b.is_nan(), "{a} {b}");
            }
        } else {
            assert!(same_bits(&back.values, &dem.values), "{path:?}");
        }
    }
}

#[test]
fn broken_files_are_errors_and_never_panics() {
    let dir = TempDir::new().unwrap();
    let dem = sample(19, 13);
    for path in files(dir.path(), &dem) {
        let whole = fs::read(&path).unwrap();
        for end in (0..whole.len().saturating_sub(12)).step_by(7) {
            fs::write(&path, &whole[..end]).unwrap();
            let error = read_dem(&path).map(|read| read.value.dem.grid);
            let Err(Error::File { path: named, .. }) = error else { panic!("{path:?} cut at {end}: {error:?}") };
            assert_eq!(named, path);
        }
        for at in (0..whole.len()).step_by(3) {
            let mut bytes = whole.clone();
            bytes[at] ^= [0x01, 0x80, 0xff][at / 3 % 3];
            fs::write(&path, &bytes).unwrap();
            let _ = read_dem(&path);
        }
    }
}

#[test]
fn broken_companions_are_errors_and_never_panics() {
    let dir = TempDir::new().unwrap();
    write_dem(&dir.path().join("dem.png"), &sample(19, 13)).unwrap();
    write_dem(&dir.path().join("dem.asc"), &sample(19, 13)).unwrap();
    for name in ["dem.png.aux.xml", "dem.pgw", "dem.prj"] {
        let companion = dir.path().join(name);
        let whole = fs::read(&companion).unwrap();
        for end in (0..whole.len()).step_by(7) {
            let mut bytes = whole.clone();
            bytes[end] ^= 0x1f;
            for content in [&whole[..end], &bytes] {
                fs::write(&companion, content).unwrap();
                let _ = read_dem(&dir.path().join("dem.png"));
                let _ = read_dem(&dir.path().join("dem.asc"));
            }
        }
        fs::write(&companion, whole).unwrap();
    }
}

/// Writes a GeoTIFF of one kind of sample.
macro_rules! tiff {
    ($path:expr, $kind:ty, $compression:expr, $predictor:expr, $values:expr, $nodata:expr) => {{
        let file = fs::File::create($path).unwrap();
        let encoder = TiffEncoder::new(file).unwrap().with_compression($compression).with_predictor($predictor);
        let mut encoder = encoder;
        let mut image = encoder.new_image::<$kind>(5, 4).unwrap();
        image.rows_per_strip(3).unwrap();
        let tags = image.encoder();
        tags.write_tag(Tag::ModelPixelScaleTag, &[2.0_f64, 2.0, 0.0][..]).unwrap();
        tags.write_tag(Tag::ModelTiepointTag, &[0.0_f64, 0.0, 0.0, 100.0, 50.0, 0.0][..]).unwrap();
        if let Some(nodata) = $nodata {
            tags.write_tag(Tag::GdalNodata, nodata).unwrap();
        }
        image.write_data(&$values).unwrap();
    }};
}

#[test]
fn all_kinds_of_numbers() {
    let dir = TempDir::new().unwrap();
    let path = &dir.path().join("a.tif");
    let deflate = Compression::Deflate(Default::default());
    let expected: Vec<f32> = (0..20).map(|i| if i == 7 { f32::NAN } else { 10.0 + i as f32 }).collect();
    let check = |what: &str| {
        let read = read_dem(path).unwrap();
        assert!(same_bits(&read.value.dem.values, &expected), "{what}: {:?}", read.value.dem.values);
        let grid = Grid { corner: DVec2::new(100.0, 50.0), cell: DVec2::splat(2.0), cols: 5, rows: 4 };
        assert_eq!(read.value.dem.grid, grid);
        let kinds: Vec<FindingKind> = read.findings.iter().map(|f| f.kind).collect();
        assert_eq!(kinds, [FindingKind::UnknownCrs]);
    };
    let values = |mark: f64| (0..20).map(move |i| if i == 7 { mark } else { f64::from(10 + i) });
    for predictor in [Predictor::None, Predictor::Horizontal] {
        for compression in [Compression::Uncompressed, Compression::Lzw, deflate, Compression::Packbits] {
            let low: Vec<i16> = values(-9999.0).map(|v| v as i16).collect();
            tiff!(path, colortype::GrayI16, compression, predictor, low, Some("-9999"));
            check("i16");
            let high: Vec<u16> = values(65535.0).map(|v| v as u16).collect();
            tiff!(path, colortype::Gray16, compression, predictor, high, Some("65535"));
            check("u16");
            let long: Vec<i32> = values(f64::from(i32::MIN)).map(|v| v as i32).collect();
            tiff!(path, colortype::GrayI32, compression, predictor, long, Some("-2147483648"));
            check("i32");
        }
    }
    for compression in [Compression::Uncompressed, Compression::Lzw, deflate] {
        let single: Vec<f32> = values(f64::from(f32::MIN)).map(|v| v as f32).collect();
        tiff!(path, colortype::Gray32Float, compression, Predictor::None, single, Some("-3.4028234663852886e+38"));
        check("f32");
        let double: Vec<f64> = values(1e-300).collect();
        tiff!(path, colortype::Gray64Float, compression, Predictor::None, double, Some("1e-300"));
        check("f64");
    }
}

/// Writes a GeoTIFF of 2 x 1 cells of 40 and 100, with these keys and this metadata of GDAL.
fn tiff_with(path: &Path, keys: &[[u16; 4]], metadata: &str) {
    let mut encoder = TiffEncoder::new(fs::File::create(path).unwrap()).unwrap();
    let mut image = encoder.new_image::<colortype::GrayI16>(2, 1).unwrap();
    let tags = image.encoder();
    tags.write_tag(Tag::ModelPixelScaleTag, &[2.0_f64, 2.0, 0.0][..]).unwrap();
    tags.write_tag(Tag::ModelTiepointTag, &[0.0_f64, 0.0, 0.0, 100.0, 50.0, 0.0][..]).unwrap();
    let directory: Vec<u16> =
        [1, 1, 0, keys.len() as u16].into_iter().chain(keys.as_flattened().iter().copied()).collect();
    tags.write_tag(Tag::GeoKeyDirectoryTag, &directory[..]).unwrap();
    if !metadata.is_empty() {
        tags.write_tag(Tag::Unknown(42112), metadata).unwrap();
    }
    image.write_data(&[40, 100]).unwrap();
}

#[test]
fn heights_in_feet_become_metres_where_the_header_says_feet() {
    let dir = TempDir::new().unwrap();
    let path = &dir.path().join("a.tif");
    // EPSG:26912 is in metres, EPSG:2222 in feet.
    let (metric, feet) = ([3072, 0, 1, 26912], [3072, 0, 1, 2222]);
    let unit = |name: &str| {
        format!("<GDALMetadata><Item name=\"UNITTYPE\" sample=\"0\" role=\"unittype\">{name}</Item></GDALMetadata>")
    };
    let [m, ft, us] = [1.0, 0.3048, 1200.0 / 3937.0];
    for (keys, metadata, metres, kind) in [
        (vec![metric], String::new(), m, None),
        (vec![metric], unit("m"), m, None),
        (vec![metric], unit("ft"), ft, Some(FindingKind::HeightUnit)),
        (vec![metric], unit("US survey foot"), us, Some(FindingKind::HeightUnit)),
        (vec![metric, [4099, 0, 1, 9002]], String::new(), ft, Some(FindingKind::HeightUnit)),
        (vec![metric, [4099, 0, 1, 9003]], String::new(), us, Some(FindingKind::HeightUnit)),
        (vec![metric, [4096, 0, 1, 6360]], String::new(), us, Some(FindingKind::HeightUnit)),
        (vec![feet, [4099, 0, 1, 9001]], String::new(), m, None),
        (vec![feet], String::new(), m, Some(FindingKind::UnitDoubt)),
        (vec![feet], unit("metre"), m, None),
    ] {
        tiff_with(path, &keys, &metadata);
        let read = read_dem(path).unwrap();
        let expected = [40.0, 100.0].map(|height: f64| (height * metres) as f32);
        assert_eq!(read.value.dem.values, expected, "{keys:?} {metadata}");
        assert_eq!(read.findings.iter().map(|f| f.kind).next(), kind, "{keys:?} {metadata}");
    }
    // A vertical part of the system, in a file beside it.
    tiff_with(path, &[[1024, 0, 1, 32767]], "");
    fs::write(dir.path().join("a.prj"), Crs::from_epsg(8700).wkt.unwrap()).unwrap();
    let read = read_dem(path).unwrap();
    assert_eq!(read.value.dem.values, [12.192, 30.48]);
    assert_eq!(read.value.dem.crs.and_then(|crs| crs.epsg), Some(2222));
}

#[test]
fn marks_that_are_not_named_are_found_and_told() {
    let dir = TempDir::new().unwrap();
    let path = &dir.path().join("a.tif");
    let mut values = vec![5_i16; 20];
    (values[0], values[1]) = (-32768, -9999);
    let none: Option<&str> = None;
    tiff!(path, colortype::GrayI16, Compression::Uncompressed, Predictor::None, values, none);
    let read = read_dem(path).unwrap();
    assert!(read.value.dem.values[0].is_nan() && read.value.dem.values[1].is_nan());
    assert!(read.findings.iter().any(|f| f.kind == FindingKind::NoHeight && f.message.starts_with("2 cells")));
}

#[test]
fn rasters_that_claim_more_than_they_hold_are_refused_at_once() {
    let dir = TempDir::new().unwrap();
    let header = "ncols 60000\nnrows 60000\nxllcorner 0\nyllcorner 0\ncellsize 1\n1 2 3\n";
    let path = dir.path().join("a.asc");
    fs::write(&path, header).unwrap();
    assert!(read_dem(&path).unwrap_err().to_string().contains("is cut off"));
    let path = dir.path().join("a.tif");
    let none: Option<&str> = None;
    tiff!(&path, colortype::Gray16, Compression::Uncompressed, Predictor::None, [5_u16; 20], none);
    let mut bytes = fs::read(&path).unwrap();
    // Width and height are the entries of the tags 256 and 257, four bytes each.
    for tag in [256_u16, 257] {
        let [a, b] = tag.to_le_bytes();
        let at = (8..bytes.len() - 12).find(|&at| bytes[at..at + 4] == [a, b, 4, 0]).unwrap();
        bytes[at + 8..at + 12].copy_from_slice(&60_000_u32.to_le_bytes());
    }
    fs::write(&path, &bytes).unwrap();
    assert!(matches!(read_dem(&path), Err(Error::File { .. })));
}

#[test]
fn ascii_grids_of_all_sorts() {
    let dir = TempDir::new().unwrap();
    let path = dir.path().join("a.asc");
    let text = "NCOLS 3\r\nNROWS 2\r\nXLLCENTER 10.5\r\nYLLCENTER 20.5\r\nCELLSIZE 1\r\nNODATA_VALUE -1e3\r\n\
                1 2.5 -1000\r\n  4e0\t5 6\r\n\x1a";
    fs::write(&path, text).unwrap();
    let dem = read_dem(&path).unwrap().value.dem;
    assert_eq!(dem.grid, Grid { corner: DVec2::new(10.0, 22.0), cell: DVec2::ONE, cols: 3, rows: 2 });
    assert!(same_bits(&dem.values, &[1.0, 2.5, f32::NAN, 4.0, 5.0, 6.0]));
    for (broken, words) in [
        (text.replace("2.5", "2,5"), "row 1, column 2 is not a number"),
        (text.replace("NCOLS 3", "NCOLS 3.5"), "ncols is 3.5"),
        (text.replace("NCOLS 3", "NCOLS 2"), "more heights"),
        (text.replace("NROWS 2", "NROWS 3"), "ends before the height of row 3, column 1"),
        (text.replace("CELLSIZE 1", "CELLSIZE 0"), "not a valid grid"),
        (text.replace("CELLSIZE 1", "CELLSIZE -1"), "not a valid grid"),
        (text.replace("CELLSIZE", "SIZE"), "\"size\" is not a header word"),
        (text.replace("YLLCENTER 20.5", ""), "no yllcorner"),
        ("<html>no grid here</html>".into(), "is not an ESRI ASCII grid"),
        ("x".repeat(5000), "is not an ESRI ASCII grid"),
    ] {
        fs::write(&path, broken).unwrap();
        let error = read_dem(&path).unwrap_err().to_string();
        assert!(error.contains(words), "{error}");
    }
}

#[test]
fn elevation_tiles_lie_where_their_path_says() {
    let dir = TempDir::new().unwrap();
    let folder = dir.path().join("14/14549");
    fs::create_dir_all(&folder).unwrap();
    let path = folder.join("6452.png");
    let mut picture = vec![0_u8; 256 * 256 * 3];
    // 377 600 steps of a centimetre, minus one step, and no data.
    picture[..9].copy_from_slice(&[5, 195, 0, 255, 255, 255, 128, 0, 0]);
    let write = |path: &Path, picture: &[u8]| {
        let mut encoder = png::Encoder::new(fs::File::create(path).unwrap(), 256, 256);
        encoder.set_color(png::ColorType::Rgb);
        encoder.write_header().unwrap().write_image_data(picture).unwrap();
    };
    write(&path, &picture);
    let dem = read_dem(&path).unwrap().value.dem;
    assert_eq!(dem.values[..2], [3776.0, -0.01]);
    assert!(dem.values[2].is_nan());
    assert_eq!(dem.crs.unwrap().epsg, Some(3857));
    // The tile's west and north edges, from the tile's numbers by the rule of the tile scheme.
    let half = 20_037_508.342_789_244;
    let (west, north) = (14549.0 / 16384.0 * 2.0 * half - half, half - 6452.0 / 16384.0 * 2.0 * half);
    assert!((dem.grid.corner - DVec2::new(west, north)).length() < 1e-6);
    assert!((dem.grid.cell.x - 2.0 * half / 16384.0 / 256.0).abs() < 1e-9);

    let lost = dir.path().join("tile.png");
    write(&lost, &picture);
    assert!(read_dem(&lost).unwrap_err().to_string().contains("zoom/column/row.png"));
    fs::write(dir.path().join("tile.pgw"), "2\n0\n0\n-2\n101\n99\n").unwrap();
    assert_eq!(read_dem(&lost).unwrap().value.dem.grid.corner, DVec2::new(100.0, 100.0));
    picture[300] = 99;
    write(&path, &picture);
    assert!(read_dem(&path).unwrap_err().to_string().contains("picture in colour"));
}

#[test]
fn colours_come_back_within_half_a_step() {
    let dir = TempDir::new().unwrap();
    let path = dir.path().join("tile.png");
    for (png, step, beyond) in [
        (PngEncoding::Gsi, 0.01, 90_000.0),
        (PngEncoding::Terrarium, 1.0 / 256.0, 32_768.0),
        (PngEncoding::Mapbox, 0.1, -10_000.5),
    ] {
        let params = RasterParams { png, ..RasterParams::default() };
        for holes in [true, false] {
            let mut dem = sample(43, 31);
            (dem.values[1], dem.values[2]) = (-431.25, 8848.86);
            if !holes {
                dem.values.iter_mut().for_each(|height| *height = if height.is_nan() { 5.0 } else { *height });
            }
            write_raster(&path, &dem, &params).unwrap();
            let is_transparent = image::open(&path).unwrap().color().has_alpha();
            assert_eq!(is_transparent, holes && png != PngEncoding::Gsi, "{png:?}");
            let aux = dir.path().join("tile.png.aux.xml");
            // The file's own text is enough, and so is the file beside it. World file and `.aux.xml` give the place.
            for way in ["both", "text", "aux"] {
                match way {
                    "text" => fs::remove_file(&aux).unwrap(),
                    "aux" => {
                        write_raster(&path, &dem, &params).unwrap();
                        image::open(&path).unwrap().save(&path).unwrap();
                    }
                    _ => {}
                }
                let report = read_dem(&path).unwrap();
                assert_eq!(report.findings, [], "{png:?} {way}");
                let back = report.value.dem;
                assert_eq!((back.grid, back.crs.unwrap().epsg), (dem.grid, Some(6677)));
                for (a, b) in back.values.iter().zip(&dem.values) {
                    let off = (f64::from(*a) - f64::from(*b)).abs();
                    assert!(off <= step * 0.5 + 6e-4 || a.is_nan() && b.is_nan(), "{png:?} {way}: {a} {b}");
                }
            }
        }
        // The world file gives a place, but nothing says what the colours mean.
        fs::remove_file(dir.path().join("tile.png.aux.xml")).unwrap();
        match (png, read_dem(&path)) {
            (PngEncoding::Terrarium, read) => {
                let text = read.unwrap_err().to_string();
                assert!(text.contains("ElevationEncoding terrarium or mapbox"), "{text}");
            }
            (_, read) => {
                let kinds: Vec<FindingKind> = read.unwrap().findings.iter().map(|finding| finding.kind).collect();
                assert!(kinds.contains(&FindingKind::ColourEncoding), "read as a tile of GSI: {kinds:?}");
            }
        }
        let mut dem = sample(43, 31);
        let slope = RasterParams { quantity: Quantity::Slope, ..params };
        assert!(matches!(write_raster(&path, &dem, &slope), Err(Error::Parameter(_))));
        dem.values[5] = beyond;
        let text = write_raster(&path, &dem, &params).unwrap_err().to_string();
        assert!(text.contains("is beyond those of the encoding") && text.contains(&beyond.to_string()), "{text}");
    }
}

#[test]
fn an_unknown_encoding_of_heights_is_refused() {
    let dir = TempDir::new().unwrap();
    let path = dir.path().join("tile.png");
    let params = RasterParams { png: PngEncoding::Mapbox, ..RasterParams::default() };
    write_raster(&path, &sample(9, 7), &params).unwrap();
    image::open(&path).unwrap().save(&path).unwrap();
    let aux = dir.path().join("tile.png.aux.xml");
    let text = fs::read_to_string(&aux).unwrap();
    assert!(text.contains("<MDI key=\"ElevationEncoding\">mapbox</MDI>"), "{text}");
    fs::write(&aux, text.replace("mapbox", "other")).unwrap();
    assert!(read_dem(&path).unwrap_err().to_string().contains("the encoding \"other\", which is not known"));
}

#[test]
fn a_hillshade_is_grey_with_a_place() {
    let dir = TempDir::new().unwrap();
    let path = dir.path().join("shade.png");
    let dem = sample(9, 7);
    write_shade(&path, &dem).unwrap();
    let shade = image::open(&path).unwrap().to_luma8();
    assert_eq!((shade.width(), shade.height(), shade.as_raw()[31], shade.as_raw()[0]), (9, 7, 0, 255));
    assert!(dir.path().join("shade.pgw").exists() && dir.path().join("shade.png.aux.xml").exists());
    assert!(read_dem(&path).unwrap_err().to_string().contains("how its values become heights"));
}

#[test]
fn what_is_no_height_map_is_refused() {
    let dir = TempDir::new().unwrap();
    for name in ["a.geojson", "b", "c.doc"] {
        let path = dir.path().join(name);
        fs::write(&path, "{}").unwrap();
        assert!(read_dem(&path).unwrap_err().to_string().contains("not a height map format"));
    }
    let path = dir.path().join("grey.png");
    let mut encoder = png::Encoder::new(fs::File::create(&path).unwrap(), 2, 1);
    encoder.set_color(png::ColorType::Grayscale);
    encoder.write_header().unwrap().write_image_data(&[1, 2]).unwrap();
    assert!(read_dem(&path).unwrap_err().to_string().contains("how its values become heights"));
    assert!(matches!(read_dem(&dir.path().join("missing.tif")), Err(Error::Io { action: "read", .. })));
    assert!(read_dem(dir.path()).is_err());
}
