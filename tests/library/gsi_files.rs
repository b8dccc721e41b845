//! Files of 基盤地図情報: small documents written here in the published layout, and what must not be read as one.

use std::fs;
use std::io::{Cursor, Write};
use std::path::{Path, PathBuf};

use glam::{DVec2, DVec3};
use tokosen::base::error::{FindingKind, Report};
use tokosen::clean::{CleanParams, clean};
use tokosen::contour::ContourMap;
use tokosen::features::Role;
use tokosen::io::gsi::{GsiDem, Product, read_dem};
use tokosen::io::{FileFeatures, ReadOptions, read_area, read_contours, read_features, read_spot_heights};
use zip::ZipWriter;
use zip::write::SimpleFileOptions;

fn dataset(members: &str) -> String {
    format!(
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\r\n\
         <Dataset xmlns:gml=\"http://www.opengis.net/gml/3.2\" xmlns=\"http://fgd.gsi.go.jp/spec/2008/FGD_GMLSchema\" \
         gml:id=\"Dataset1\">\r\n<gml:name>test</gml:name>\r\n{members}\r\n</Dataset>\r\n"
    )
}

/// A height map of one square, with what tests change.
#[derive(Clone, Copy)]
struct Square<'a> {
    code: &'a str,
    kind: &'a str,
    date: &'a str,
    system: &'a str,
    /// South, west, north and east edge as files state them.
    edges: [&'a str; 4],
    high: &'a str,
    tuples: &'a str,
    start: &'a str,
}

/// The square 3624-30-98 of 225 x 150 cells.
const SQUARE: Square<'_> = Square {
    code: "36243098",
    kind: "5mメッシュ（数値地形）",
    date: "2017-02-02",
    system: "fguuid:jgd2011.bl",
    edges: ["24.325", "124.1", "24.333333333", "124.1125"],
    high: "224 149",
    tuples: "地表面,1.50\r\nデータなし,-9999.\r\n内水面,-0.10\r\n",
    start: "224 0",
};

/// The square east of [`SQUARE`].
const EAST: Square<'_> =
    Square { code: "36243099", edges: ["24.325", "124.1125", "24.333333333", "124.125"], ..SQUARE };

impl Square<'_> {
    fn xml(&self) -> String {
        let Self { code, kind, date, system, edges: [south, west, north, east], high, tuples, start } = self;
        dataset(&format!(
            "<DEM gml:id=\"DEM001\"><fid>x</fid><lfSpanFr gml:id=\"a\"><gml:timePosition>{date}</gml:timePosition></lfSpanFr>\
             <type>{kind}</type><mesh>{code}</mesh><coverage gml:id=\"b\"><gml:boundedBy><gml:Envelope srsName=\"{system}\">\
             <gml:lowerCorner>{south} {west}</gml:lowerCorner><gml:upperCorner>{north} {east}</gml:upperCorner>\
             </gml:Envelope></gml:boundedBy><gml:gridDomain><gml:Grid dimension=\"2\" gml:id=\"c\"><gml:limits>\
             <gml:GridEnvelope><gml:low>0 0</gml:low><gml:high>{high}</gml:high></gml:GridEnvelope></gml:limits>\
             <gml:axisLabels>x y</gml:axisLabels></gml:Grid></gml:gridDomain><gml:rangeSet><gml:DataBlock>\
             <gml:rangeParameters><gml:QuantityList uom=\"DEM構成点\"/></gml:rangeParameters>\r\n<gml:tupleList>\r\n{tuples}\
             </gml:tupleList></gml:DataBlock></gml:rangeSet><gml:coverageFunction><gml:GridFunction>\
             <gml:sequenceRule order=\"+x-y\">Linear</gml:sequenceRule><gml:startPoint>{start}</gml:startPoint>\
             </gml:GridFunction></gml:coverageFunction></coverage></DEM>"
        ))
    }
}

fn contour(fid: &str, kind: &str, elevation: &str, positions: &str) -> String {
    format!(
        "<Cntr gml:id=\"{fid}\"><fid>{fid}</fid><lfSpanFr gml:id=\"{fid}-1\"><gml:timePosition>2016-10-01</gml:timePosition>\
         </lfSpanFr><orgGILvl>25000</orgGILvl><vis>非表示</vis><loc><gml:Curve gml:id=\"{fid}-g\" \
         srsName=\"fguuid:jgd2011.bl\"><gml:segments><gml:LineStringSegment><gml:posList>\r\n{positions}</gml:posList>\
         </gml:LineStringSegment></gml:segments></gml:Curve></loc><type>{kind}</type><alti>{elevation}</alti></Cntr>\r\n"
    )
}

fn spot(fid: &str, kind: &str, elevation: &str, position: &str) -> String {
    format!(
        "<ElevPt gml:id=\"{fid}\"><fid>{fid}</fid><pos><gml:Point gml:id=\"{fid}-g\" srsName=\"fguuid:jgd2011.bl\">\
         <gml:pos>{position}</gml:pos></gml:Point></pos><type>{kind}</type><alti>{elevation}</alti></ElevPt>\r\n"
    )
}

/// A ring of water that is given by one or more lines.
fn ring(lines: &[&str]) -> String {
    let lines: String = lines
        .iter()
        .map(|line| {
            format!(
                "<gml:curveMember><gml:Curve gml:id=\"r\"><gml:segments><gml:LineStringSegment><gml:posList>{line}\
                 </gml:posList></gml:LineStringSegment></gml:segments></gml:Curve></gml:curveMember>"
            )
        })
        .collect();
    format!("<gml:Ring>{lines}</gml:Ring>")
}

fn water(kind: &str, exterior: &str, interior: Option<&str>) -> String {
    let interior = interior.map_or(String::new(), |ring| format!("<gml:interior>{ring}</gml:interior>"));
    format!(
        "<WA gml:id=\"w\"><fid>w</fid><area><gml:Surface gml:id=\"s\" srsName=\"fguuid:jgd2011.bl\"><gml:patches>\
         <gml:PolygonPatch><gml:exterior>{exterior}</gml:exterior>{interior}</gml:PolygonPatch></gml:patches></gml:Surface>\
         </area><type>{kind}</type></WA>\r\n"
    )
}

fn shore(kind: &str, positions: &str) -> String {
    format!(
        "<WL gml:id=\"l\"><fid>l</fid><loc><gml:Curve gml:id=\"g\" srsName=\"fguuid:jgd2011.bl\"><gml:segments>\
         <gml:LineStringSegment><gml:posList>{positions}</gml:posList></gml:LineStringSegment></gml:segments></gml:Curve>\
         </loc><type>{kind}</type></WL>\r\n"
    )
}

fn zipped(files: &[(&str, &[u8])]) -> Vec<u8> {
    let mut archive = ZipWriter::new(Cursor::new(Vec::new()));
    for (name, bytes) in files {
        archive.start_file(*name, SimpleFileOptions::default()).expect("a new file in the archive");
        archive.write_all(bytes).expect("memory");
    }
    archive.finish().expect("memory").into_inner()
}

/// A folder that tests write files to.
struct Folder(tempfile::TempDir);

impl Folder {
    fn new() -> Self {
        Self(tempfile::tempdir().expect("a folder for temporary files"))
    }

    fn path(&self) -> &Path {
        self.0.path()
    }

    fn write(&self, name: &str, bytes: impl AsRef<[u8]>) -> PathBuf {
        let path = self.path().join(name);
        fs::create_dir_all(path.parent().expect("a file in the folder")).expect("a folder that can be written");
        fs::write(&path, bytes).expect("a folder that can be written");
        path
    }
}

fn contours(path: &Path) -> Report<ContourMap> {
    read_contours(path, &ReadOptions::default()).expect("contours")
}

fn kinds<T>(report: &Report<T>) -> Vec<FindingKind> {
    report.findings.iter().map(|finding| finding.kind).collect()
}

/// The cells with a height, by column and row.
fn cells(path: &Path) -> Vec<(usize, usize, f32)> {
    let dem = read_dem(path).expect("a height map").value.dem;
    let cells = dem.values.iter().enumerate().filter(|(_, height)| !height.is_nan());
    cells.map(|(i, &height)| (i % dem.grid.cols, i / dem.grid.cols, height)).collect()
}

#[test]
fn a_height_map_begins_at_its_start_point_and_may_end_early() {
    let folder = Folder::new();
    let path = folder.write("FG-GML-3624-30-98-DEM5B-20170202.xml", format!("\u{feff}{}", SQUARE.xml()));
    let report = read_dem(&path).unwrap();
    assert_eq!(report.findings, []);
    let dem = &report.value.dem;
    assert_eq!((report.value.product, report.value.product.sigma()), (Product::Dem5B, 0.7));
    assert_eq!((dem.grid.cols, dem.grid.rows), (225, 150));
    assert_eq!(dem.grid.corner, DVec2::new(124.1, 24.0 + 20.0 / 60.0));
    assert_eq!(dem.grid.cell, DVec2::splat(1.0 / 18_000.0));
    assert_eq!(dem.crs.as_ref().and_then(|crs| crs.epsg), Some(6668));
    assert_eq!(cells(&path), [(224, 0, 1.5), (1, 1, -0.1)]);
}

#[test]
fn the_three_systems_and_their_mixture() {
    let folder = Folder::new();
    for (system, code) in [("fguuid:jgd2000.bl", 4612), ("fguuid:jgd2011.bl", 6668), ("fguuid:jgd2024.bl", 6668)] {
        let path = folder.write("FG-GML-3624-30-98-DEM5B.xml", Square { system, ..SQUARE }.xml());
        assert_eq!(read_dem(&path).unwrap().value.dem.crs.and_then(|crs| crs.epsg), Some(code));
    }
    folder.write("FG-GML-3624-30-99-DEM5B.xml", Square { system: "fguuid:jgd2000.bl", ..EAST }.xml());
    let report = read_dem(folder.path()).unwrap();
    assert_eq!(report.value.dem.crs.as_ref().and_then(|crs| crs.epsg), Some(6668));
    assert_eq!(kinds(&report), [FindingKind::MixedHeights, FindingKind::MixedCrs]);
}

#[test]
fn a_list_may_be_in_a_legacy_encoding_and_have_comments() {
    let folder = Folder::new();
    let tuples = "地表面,1\n<!-- x -->内水面,2<![CDATA[\nその他,3]]>\n";
    let text = Square { tuples, start: "0 149", ..SQUARE }.xml().replace("UTF-8", "Shift_JIS");
    let path = folder.write("a.xml", encoding_rs::SHIFT_JIS.encode(&text).0);
    assert_eq!(cells(&path), [(0, 149, 1.0), (1, 149, 2.0), (2, 149, 3.0)]);
    let none = folder.write("none.xml", Square { tuples: "", ..SQUARE }.xml());
    assert_eq!(cells(&none), []);
}

#[test]
fn squares_of_a_folder_an_archive_and_archives_in_it_are_one_map() {
    let expected = [(224, 0, 1.5), (449, 0, 1.5), (1, 1, -0.1), (226, 1, -0.1)];
    let names = ["FG-GML-3624-30-98-DEM5B-20170202.xml", "FG-GML-3624-30-99-DEM5B-20170202.xml"];
    let texts = [SQUARE.xml(), EAST.xml()];
    let files: Vec<(&str, &[u8])> = names.into_iter().zip(texts.iter().map(|text| text.as_bytes())).collect();

    let folder = Folder::new();
    folder.write(names[0], &texts[0]);
    folder.write(&format!("more/{}", names[1]), &texts[1]);
    folder.write("readme.txt", "no map");
    folder.write("FG-GML-362430-BldA-20170202-0001.xml", "not looked at");
    assert_eq!(cells(folder.path()), expected);

    let flat = folder.write("flat.zip", zipped(&files));
    assert_eq!(cells(&flat), expected);
    let inner: Vec<Vec<u8>> = files.iter().map(|file| zipped(&[*file])).collect();
    let nested =
        zipped(&[("FG-GML-3624-30-DEM5B.zip", &inner[0][..]), ("b/FG-GML-3624-30-DEM5B_2.zip", &inner[1][..])]);
    assert_eq!(cells(&folder.write("PackDLMap.zip", &nested)), expected);
    let renamed = folder.write("renamed.zip", zipped(&[("a.xml", files[0].1), ("b.xml", files[1].1)]));
    assert_eq!(cells(&renamed), expected);

    let grid = read_dem(&flat).unwrap().value.dem.grid;
    assert_eq!((grid.cols, grid.rows, grid.corner.x), (450, 150, 124.1));
}

#[test]
fn of_two_editions_the_newer_one_lies_on_top() {
    let folder = Folder::new();
    let newer = Square { date: "2021-01-01", tuples: "地表面,7.5\n", start: "224 0", ..SQUARE };
    folder.write("FG-GML-3624-30-98-DEM5B-a.xml", newer.xml());
    folder.write("FG-GML-3624-30-98-DEM5B-b.xml", SQUARE.xml());
    let report = read_dem(folder.path()).unwrap();
    assert_eq!(kinds(&report), [FindingKind::RepeatedMesh]);
    assert!(report.findings[0].message.contains("36243098"));
    assert_eq!(cells(folder.path()), [(224, 0, 7.5), (1, 1, -0.1)]);
}

#[test]
fn what_was_unpacked_beside_its_archive_is_read_once() {
    let folder = Folder::new();
    let name = "FG-GML-543745-Cntr-20160401-0001.xml";
    let text = dataset(&contour("K1", "一般等高線", "120", "36.35 137.65 36.36 137.65"));
    folder.write("FG-GML-543745-Cntr-20160401.zip", zipped(&[(name, text.as_bytes())]));
    folder.write(name, &text);
    let report = contours(folder.path());
    assert_eq!((report.value.contours.len(), kinds(&report)), (1, vec![FindingKind::RepeatedFile]));
    assert!(report.findings[0].message.contains(".zip!FG-GML"), "{:?}", report.findings);

    let name = "FG-GML-3624-30-98-DEM5B-20170202.xml";
    folder.write("FG-GML-3624-30-98-DEM5B.zip", zipped(&[(name, SQUARE.xml().as_bytes())]));
    folder.write(&format!("unpacked/{name}"), SQUARE.xml());
    assert_eq!(kinds(&read_dem(folder.path()).unwrap()), [FindingKind::RepeatedFile]);
}

#[test]
fn all_products_are_told_by_their_name_type_and_cells() {
    let second = ["36.333333333", "137.625", "36.416666667", "137.75"];
    let ten = Square { code: "543745", edges: second, high: "1124 749", start: "743 639", ..SQUARE };
    let one = Square { kind: "1mメッシュ（標高）", high: "1124 749", start: "1124 0", ..SQUARE };
    let five = Square { kind: "5mメッシュ（標高）", ..SQUARE };
    let folder = Folder::new();
    for (name, square, product, cell, first) in [
        ("DEM1A", one, Product::Dem1A, 90_000.0, (1124, 0, 1.5)),
        ("DEM5A", five, Product::Dem5A, 18_000.0, (224, 0, 1.5)),
        ("DEM5B", SQUARE, Product::Dem5B, 18_000.0, (224, 0, 1.5)),
        ("DEM5C", SQUARE, Product::Dem5C, 18_000.0, (224, 0, 1.5)),
        ("dem10a", Square { kind: "10mメッシュ（火山標高）", ..ten }, Product::Dem10A, 9000.0, (743, 639, 1.5)),
        ("dem10b", Square { kind: "10mメッシュ（標高）", ..ten }, Product::Dem10B, 9000.0, (743, 639, 1.5)),
    ] {
        let path = folder.write(&format!("FG-GML-{}-{name}-20161001.xml", square.code), square.xml());
        let GsiDem { dem, product: found, .. } = read_dem(&path).unwrap().value;
        assert_eq!((found, dem.grid.cell), (product, DVec2::splat(1.0 / cell)), "{name}");
        assert_eq!(cells(&path)[0], first, "{name}");
    }
}

#[test]
fn damage_of_any_kind_is_an_error_or_another_map() {
    let folder = Folder::new();
    let lines = contour("K1", "凹地等高線", "100", "36.35 137.70 36.36 137.70 36.36 137.71 36.35 137.70");
    let texts = [SQUARE.xml(), dataset(&format!("{lines}{}", spot("P1", "その他", "1", "36.35 137.70")))];
    let archive =
        zipped(&[("FG-GML-3624-30-98-DEM5B.xml", texts[0].as_bytes()), ("FG-GML-1-Cntr.xml", texts[1].as_bytes())]);
    let mut random = 1_u64;
    let mut next = |below: usize| {
        random = random.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (random >> 33) as usize % below
    };
    let mut read = 0;
    for round in 0..900 {
        let (name, good) =
            [("a.xml", texts[0].as_bytes()), ("a.xml", texts[1].as_bytes()), ("a.zip", &archive)][round % 3];
        let mut bytes = good.to_vec();
        for _ in 0..=next(3) {
            let at = next(bytes.len());
            match next(4) {
                0 => bytes[at] = b"<>/ ,.-9\"\0&"[next(11)],
                1 => drop(bytes.remove(at)),
                2 => bytes[at] ^= 1 << next(8),
                _ => bytes.extend_from_within(at..(at + 40).min(bytes.len())),
            }
        }
        let path = folder.write(name, bytes);
        read +=
            usize::from(read_dem(&path).is_ok()) + usize::from(read_contours(&path, &ReadOptions::default()).is_ok());
    }
    assert!(read > 50, "{read}: the damage is so great that it tells nothing");
}

#[test]
fn height_maps_that_contradict_themselves_are_errors_with_their_document() {
    let whole = "地表面,1.00\n".repeat(225 * 150);
    let over = format!("{whole}地表面,1.00\n");
    let cases: [(Square<'_>, &str); 14] = [
        (Square { code: "3624309", ..SQUARE }, "mesh code \"3624309\""),
        (Square { code: "99999999", ..SQUARE }, "mesh code \"99999999\""),
        (Square { code: "36243097", ..SQUARE }, "corner \"24.325 124.1\""),
        (Square { high: "224 150", ..SQUARE }, "225 x 151 cells"),
        (Square { high: "99999999 99999999", ..SQUARE }, "not a cell"),
        (Square { high: "224", ..SQUARE }, "not a cell"),
        (Square { tuples: &over, start: "0 0", ..SQUARE }, "more cells than the grid, which has 33750"),
        (
            Square { tuples: &whole, start: "1 0", ..SQUARE },
            "33750 cells; from its start point \"1 0\" on the grid has 33749",
        ),
        (Square { start: "225 0", ..SQUARE }, "start point \"225 0\""),
        (Square { start: "0 -1", ..SQUARE }, "start point \"0 -1\""),
        (Square { start: "", ..SQUARE }, "start point"),
        (Square { tuples: "地表面,1\n地表面,x\n", ..SQUARE }, "line 2 of the tuple list is \"地表面,x\""),
        (Square { tuples: "地表面,1\n<b/>", ..SQUARE }, "element among the cells"),
        (Square { system: "fguuid:tokyo.bl", ..SQUARE }, "\"fguuid:tokyo.bl\" is not known"),
    ];
    let folder = Folder::new();
    for (square, word) in cases {
        let name = "FG-GML-3624-30-98-DEM5B.xml";
        let path = folder.write("a.zip", zipped(&[(name, square.xml().as_bytes())]));
        let error = read_dem(&path).unwrap_err().to_string();
        assert!(error.contains(&format!("a.zip!{name}: ")) && error.contains(word), "{word}: {error}");
    }
    let order = SQUARE.xml().replace("+x-y", "+x+y");
    assert!(read_dem(&folder.write("a.xml", order)).unwrap_err().to_string().contains("\"+x+y\""));
    let text = SQUARE.xml();
    for end in (10..text.len() - 10).step_by(37).filter(|&end| text.is_char_boundary(end)) {
        let error = read_dem(&folder.write("short.xml", &text[..end])).unwrap_err().to_string();
        assert!(error.contains("short.xml: "), "{error}");
    }
}

#[test]
fn products_do_not_mix_and_far_squares_do_not_fill_the_memory() {
    let folder = Folder::new();
    folder.write("FG-GML-3624-30-98-DEM5B.xml", SQUARE.xml());
    folder.write("FG-GML-3624-30-99-DEM5A.xml", EAST.xml());
    let error = read_dem(folder.path()).unwrap_err().to_string();
    assert!(error.contains("DEM5B.xml is DEM5B") && error.contains("DEM5A.xml is DEM5A"), "{error}");

    let folder = Folder::new();
    folder.write("FG-GML-3624-30-98-DEM5B.xml", SQUARE.xml());
    let far = Square { code: "64444408", edges: ["43.0", "144.6", "43.008333333", "144.6125"], ..SQUARE };
    folder.write("FG-GML-6444-44-08-DEM5B.xml", far.xml());
    let error = read_dem(folder.path()).unwrap_err().to_string();
    assert!(error.contains("box around all its squares"), "{error}");
}

#[test]
fn what_is_no_such_file_is_told() {
    let folder = Folder::new();
    let empty = Folder::new();
    let text = SQUARE.xml();
    let archive = zipped(&[("FG-GML-3624-30-98-DEM5B.xml", text.as_bytes())]);
    let foreign = zipped(&[("map.shp", b"x"), ("map.dbf", b"x")]);
    let lines = zipped(&[("FG-GML-362430-Cntr-1.xml", dataset("").as_bytes())]);
    let mut damaged = archive.clone();
    let middle = damaged.len() / 2;
    damaged[middle] ^= 0x55;
    let cases: [(PathBuf, &str); 9] = [
        (empty.path().to_owned(), "no file FG-GML-….xml"),
        (folder.write("cut.zip", &archive[..archive.len() / 2]), "not complete"),
        (folder.write("empty.zip", ""), "not complete"),
        (folder.write("damaged.zip", &damaged), "damaged.zip"),
        (folder.write("lines.zip", &lines), "found: 1 Cntr"),
        (folder.write("empty.xml", ""), "empty"),
        (folder.write("page.xml", "<html><body/></html>"), "root element is \"html\""),
        (folder.write("zip.xml", "PK<\u{3}\u{4}\u{14}>x</\u{3}>"), "is not an XML document"),
        (folder.path().join("missing.xml"), "cannot read"),
    ];
    for (path, word) in &cases {
        let error = read_dem(path).unwrap_err().to_string();
        assert!(error.contains(word), "{}: {error}", path.display());
        if *word != "found: 1 Cntr" {
            let error = read_contours(path, &ReadOptions::default()).unwrap_err().to_string();
            assert!(error.contains(word), "{}: {error}", path.display());
        }
    }
    // A zipped shapefile is read as one.
    let shape = folder.write("shape.zip", &foreign);
    let error = read_dem(&shape).unwrap_err().to_string();
    assert!(error.contains("holds a .shp file"), "{error}");
    let error = read_contours(&shape, &ReadOptions::default()).unwrap_err().to_string();
    assert!(error.contains("shape.zip!map.shp"), "{error}");
    let dem = folder.write("dem.zip", &archive);
    let error = read_contours(&dem, &ReadOptions::default()).unwrap_err().to_string();
    assert!(error.contains("no contour (Cntr)") && error.contains("1 DEM5B"), "{error}");
    let error = read_area(&dem, &ReadOptions::default()).unwrap_err().to_string();
    assert!(error.contains("no frame"), "{error}");
    let layer = ReadOptions { layer: Some("dem".to_owned()), ..ReadOptions::default() };
    assert!(read_contours(&dem, &layer).unwrap_err().to_string().contains("no layers"));
}

#[test]
fn an_archive_that_unpacks_to_far_more_than_it_is_worth_is_refused() {
    let folder = Folder::new();
    let mut archive = ZipWriter::new(Cursor::new(Vec::new()));
    for part in 0..2 {
        archive.start_file(format!("FG-GML-362430-Cntr-{part}.xml"), SimpleFileOptions::default()).unwrap();
        archive.write_all(b"<Dataset>").unwrap();
        for _ in 0..90 {
            archive.write_all(&vec![b' '; 1 << 20]).unwrap();
        }
        archive.write_all(b"</Dataset>").unwrap();
    }
    let path = folder.write("bomb.zip", archive.finish().unwrap().into_inner());
    let error = read_contours(&path, &ReadOptions::default()).unwrap_err();
    let cause = std::error::Error::source(&error).unwrap().to_string();
    assert!(cause.contains("more than is allowed"), "{error}: {cause}");
}

#[test]
fn contours_and_spot_heights_come_with_east_first() {
    let folder = Folder::new();
    let cntr = dataset(&format!(
        "{}{}{}",
        contour("K1", "一般等高線", "120", "36.350000000 137.650000000\r\n36.351000000 137.652000000\r\n"),
        contour("K2", "凹地等高線", "110.5", "36.35 137.70 36.36 137.70 36.36 137.71 36.35 137.70"),
        contour("K3", "その他", "", "36.35 137.72 36.36 137.72"),
    ));
    let elev = dataset(&format!(
        "{}{}",
        spot("P1", "標高点（測点）", "131.2", "36.355 137.655"),
        spot("P2", "等高線構成点", "120", "36.350000000 137.650000000"),
    ));
    folder.write("FG-GML-543745-Cntr-20160401-0001.xml", &cntr);
    folder.write("FG-GML-543745-ElevPt-20160401-0001.xml", &elev);
    folder.write("FG-GML-543745-RdEdg-20160401-0001.xml", "not looked at");
    let report = contours(folder.path());
    let map = &report.value;
    assert_eq!(map.crs.as_ref().and_then(|crs| crs.epsg), Some(6668));
    assert_eq!(map.contours.len(), 2);
    assert_eq!((map.contours[0].elevation, map.contours[1].elevation), (120.0, 110.5));
    assert_eq!(map.contours[0].points, [DVec2::new(137.65, 36.35), DVec2::new(137.652, 36.351)]);
    assert!(map.contours[1].is_closed());
    assert_eq!(map.depressions, [(1.into(), true)].into());
    assert_eq!(map.spots, [DVec3::new(137.655, 36.355, 131.2), DVec3::new(137.65, 36.35, 120.0)]);
    assert_eq!(kinds(&report), [FindingKind::MissingElevation]);
    assert!(report.findings[0].message.contains("line 2"), "{:?}", report.findings);

    let spots = read_spot_heights(folder.path(), &ReadOptions::default()).unwrap().value;
    assert_eq!(spots.points, map.spots);
    let named = ReadOptions { elevation_field: Some("orgGILvl".to_owned()), ..ReadOptions::default() };
    assert_eq!(read_contours(folder.path(), &named).unwrap().value.contours[0].elevation, 25_000.0);
    let both = format!("{}{}", cntr.split_once("</Dataset>").unwrap().0, elev.split_once("</gml:name>").unwrap().1);
    let one = folder.write("all.xml", both);
    assert_eq!(contours(&one).value, *map);
}

#[test]
fn the_segments_of_a_line_are_one_line() {
    let folder = Folder::new();
    let second = "</gml:posList></gml:LineStringSegment><gml:LineStringSegment><gml:posList>36.2 137.1 36.3 137.1";
    let text = dataset(&contour("K1", "一般等高線", "100", &format!("36.1 137.0 36.2 137.1{second}")));
    let map = contours(&folder.write("a.xml", text)).value;
    assert_eq!(map.contours[0].points.len(), 3);
}

#[test]
fn lines_cut_at_the_edge_of_a_square_are_joined() {
    let folder = Folder::new();
    // A ring over the common edge of 5437-45 and 5437-46 at 137.75 degrees, in two halves.
    let west = "36.360000000 137.750000000\n36.360000000 137.748\n36.362000000 137.748\n36.362000000 137.750000000\n";
    // The last decimal of one end is rounded the other way.
    let east = "36.362000000 137.750000000\n36.362000000 137.752\n36.360000000 137.752\n36.360000001 137.750000000\n";
    folder.write("FG-GML-543745-Cntr-1.xml", dataset(&contour("W", "一般等高線", "100", west)));
    let other = zipped(&[("FG-GML-543746-Cntr-1.xml", dataset(&contour("E", "一般等高線", "100", east)).as_bytes())]);
    folder.write("FG-GML-543746-Cntr.zip", other);
    let map = contours(folder.path()).value;
    assert_eq!(map.contours.len(), 2);
    let joined = clean(map, &CleanParams { snap: 2e-9, ..CleanParams::default() }).unwrap().value;
    assert_eq!(joined.contours.len(), 1);
    assert!(joined.contours[0].is_closed());
}

#[test]
fn a_legacy_encoding_is_read_as_declared() {
    let folder = Folder::new();
    let text = dataset(&contour("K1", "凹地等高線", "100", "36.35 137.70 36.36 137.70 36.36 137.71 36.35 137.70"));
    let text = text.replace("UTF-8", "Shift_JIS");
    let map = contours(&folder.write("a.xml", encoding_rs::SHIFT_JIS.encode(&text).0)).value;
    assert_eq!(map.depressions, [(0.into(), true)].into());
}

#[test]
fn broken_features_are_errors_with_their_document_and_identifier() {
    let good = "36.35 137.70 36.36 137.70";
    let cases = [
        (contour("K7", "一般等高線", "abc", good), "Cntr K7: its elevation (alti) is \"abc\""),
        (contour("K7", "一般等高線", "NaN", good), "Cntr K7: its elevation (alti) is \"NaN\""),
        (contour("K7", "一般等高線", "1", "36.35 137.70 36.36"), "Cntr K7: its positions have an odd number"),
        (contour("K7", "一般等高線", "1", "36.35 x"), "Cntr K7: its positions hold \"x\""),
        (
            contour("K7", "一般等高線", "1", "137.70 36.35 137.70 36.36"),
            "Cntr K7: its position 137.7 36.35 is not a latitude",
        ),
        (contour("K7", "", "1", good).replace("jgd2011", "jgd3000"), "\"fguuid:jgd3000.bl\" is not known"),
        (contour("K7", "", "1", good).replace("<gml:posList>", "<gml:posList srsDimension=\"3\">"), "3 numbers"),
        (contour("K7", "一般等高線", "1", good).replace("</Cntr>", ""), "broken"),
    ];
    let folder = Folder::new();
    for (text, word) in cases {
        let path = folder.write("c.zip", zipped(&[("FG-GML-543745-Cntr-1.xml", dataset(&text).as_bytes())]));
        let error = read_contours(&path, &ReadOptions::default()).unwrap_err().to_string();
        assert!(error.contains("c.zip!FG-GML-543745-Cntr-1.xml: ") && error.contains(word), "{word}: {error}");
    }
    let empty = dataset(&contour("K7", "一般等高線", "1", ""));
    assert!(read_contours(&folder.write("e.xml", empty), &ReadOptions::default()).is_err());
    let text = dataset(&contour("K1", "一般等高線", "100", good));
    for end in (10..text.len() - 10).step_by(31).filter(|&end| text.is_char_boundary(end)) {
        let path = folder.write("short.xml", &text[..end]);
        assert!(read_contours(&path, &ReadOptions::default()).is_err());
    }
}

#[test]
fn water_areas_are_lakes_and_their_pieces_are_united() {
    let folder = Folder::new();
    // A lake over the edge of two squares with an island in the western half, a river, a piece of the sea.
    let west = ring(&["36.36 137.75 36.36 137.74 36.37 137.74", "36.37 137.74 36.37 137.75 36.36 137.75"]);
    let island = ring(&["36.364 137.744 36.364 137.746 36.366 137.746 36.364 137.744"]);
    let east = ring(&["36.36 137.75 36.37 137.75 36.37 137.76 36.36 137.76 36.36 137.75"]);
    let apart = ring(&["36.38 137.75 36.39 137.75 36.39 137.76 36.38 137.75"]);
    let first = [
        water("湖池", &west, Some(&island)),
        water("河川", &apart, None),
        shore("水涯線（湖池）", "36.3 137.7 36.4 137.7 36.4 137.8 36.3 137.7"),
    ];
    folder.write("FG-GML-543745-WA-1.xml", dataset(&first.concat()));
    folder.write("FG-GML-543746-WA-1.xml", dataset(&[water("湖池", &east, None), water("海", &apart, None)].concat()));
    folder.write("FG-GML-543746-WL-1.xml", dataset(&shore("水涯線（河川）", "36.3 137.7 36.4 137.7")));
    let report = read_features(Role::Water, folder.path(), &ReadOptions::default()).unwrap();
    let FileFeatures { features, crs, .. } = &report.value;
    let lakes = &features.lakes;
    assert_eq!(crs.as_ref().and_then(|crs| crs.epsg), Some(6668));
    assert_eq!(lakes.len(), 2, "{lakes:?}");
    assert_eq!((lakes[0].height, lakes[0].polygon.interiors().len()), (None, 1));
    let area = geo::Area::unsigned_area(&lakes[0].polygon);
    assert!((area - (0.01 * 0.02 - 0.002 * 0.002 / 2.0)).abs() < 1e-9, "{area}");
    assert_eq!(lakes[1].height, Some(0.0));
    assert_eq!(kinds(&report), [FindingKind::SkippedFeature; 3]);
    let told: Vec<&str> = report.findings.iter().map(|finding| &finding.message[..1]).collect();
    assert_eq!(told, ["1", "1", "1"]);
}

#[test]
fn closed_shores_are_lakes_where_there_are_no_water_areas() {
    let folder = Folder::new();
    let text = dataset(
        &[
            shore("水涯線（湖池）", "36.36 137.74 36.36 137.76 36.38 137.76 36.38 137.74 36.36 137.74"),
            shore("水涯線（湖池）", "36.365 137.745 36.365 137.75 36.37 137.75 36.365 137.745"),
            shore("水涯線（湖池）", "36.3 137.7 36.4 137.7"),
            shore("水涯線（河川）", "36.1 137.1 36.1 137.2 36.2 137.2 36.1 137.1"),
        ]
        .concat(),
    );
    let path = folder.write("FG-GML-543745-WL-1.xml", text);
    let report = read_features(Role::Water, &path, &ReadOptions::default()).unwrap();
    let lakes = &report.value.features.lakes;
    assert_eq!((lakes.len(), lakes[0].polygon.interiors().len(), lakes[0].height), (1, 1, None));
    assert_eq!(kinds(&report), [FindingKind::SkippedFeature]);
    assert!(report.findings[0].message.starts_with("2 water edges"), "{:?}", report.findings);
}
