//! Layers of any shape and attribute: every format says the same of them.

#![allow(clippy::unwrap_used, reason = "helpers of tests are tests too")]

use std::fs;
use std::path::Path;

use glam::{DVec2, DVec3};
use rusqlite::Connection;
use shapefile::dbase::FieldValue;
use shapefile::{PolygonRing, Shape as Read};
use tokosen::base::error::Result;
use tokosen::crs::Crs;
use tokosen::io::layer::{Cell, Column, Geometry, Kind, Layer, Row, Shape};
use tokosen::io::{ReadOptions, StagedOutput, contour_files, read_area, write_layers};

const FORMATS: [&str; 3] = ["geojson", "gpkg", "shp"];

const COLUMNS: &[Column] = &[
    Column { name: "class", kind: Kind::Text(16) },
    Column { name: "count", kind: Kind::Int },
    Column { name: "slope_deg", kind: Kind::Real },
    Column { name: "is_flat", kind: Kind::Bool },
];

fn square(x: f64, y: f64, side: f64, reverse: bool) -> Vec<DVec2> {
    let corners = [(0.0, 0.0), (side, 0.0), (side, side), (0.0, side), (0.0, 0.0)];
    let mut ring = corners.map(|(u, v)| DVec2::new(x + u, y + v)).to_vec();
    if reverse {
        ring.reverse();
    }
    ring
}

fn cells() -> Vec<Cell<'static>> {
    vec![Cell::Text("尾根 ridge".into()), Cell::Int(-(1 << 53)), Cell::Real(0.1 + 0.2), Cell::Bool(true)]
}

fn nulls() -> Vec<Cell<'static>> {
    vec![Cell::Null; COLUMNS.len()]
}

/// Two areas apart, the first with two holes; every ring turns another way than its neighbour.
fn area_rings() -> [Vec<Vec<DVec2>>; 2] {
    let (x, y) = (436_265.680_000_000_05, 6_444_375.1 + 0.2);
    let holes = [square(x + 10.0 / 3.0, y + 7.0, 20.1, false), square(x + 50.0, y + 7.0, 20.1, true)];
    let [first, second] = holes;
    [vec![square(x, y, 100.0, true), first, second], vec![square(x + 300.0, y, 50.0 / 7.0, false)]]
}

fn areas() -> Layer<'static> {
    let [a, b] = area_rings();
    let rows = vec![Row { shape: Shape::Area(a), cells: cells() }, Row { shape: Shape::Area(b), cells: nulls() }];
    Layer { name: "landform", geometry: Geometry::Areas, columns: COLUMNS, rows }
}

const VALLEY: [DVec3; 3] =
    [DVec3::new(1.0 / 3.0, 2.0, 30.1 + 0.2), DVec3::new(10.0, 20.0, 20.0 / 3.0), DVec3::new(11.0, 21.0, -4.5)];
const LEVEL: [DVec2; 2] = [DVec2::new(0.0, 1.0), DVec2::new(2.0, 3.0)];

fn lines() -> Layer<'static> {
    let rows = vec![
        Row { shape: Shape::Line(&VALLEY), cells: vec![Cell::Int(7)] },
        Row { shape: Shape::Contour(&LEVEL, 12.5), cells: vec![Cell::Null] },
    ];
    const ORDER: &[Column] = &[Column { name: "order", kind: Kind::Int }];
    Layer { name: "streams", geometry: Geometry::Lines, columns: ORDER, rows }
}

fn write(path: &Path, layers: &[Layer<'_>]) -> Result<()> {
    let staged = StagedOutput::create(path)?;
    let names: Vec<&str> = layers.iter().map(|layer| layer.name).collect();
    assert_eq!(write_layers(&staged, layers, Some(&Crs::from_epsg(25832)))?, contour_files(path, &names)?);
    staged.commit()?;
    Ok(())
}

/// Positive for rings that turn left.
fn turn(ring: &[[f64; 2]]) -> f64 {
    ring.windows(2)
        .map(|w| (w[0][0] - ring[0][0]) * (w[1][1] - ring[0][1]) - (w[1][0] - ring[0][0]) * (w[0][1] - ring[0][1]))
        .sum()
}

fn json(path: &Path) -> serde_json::Value {
    serde_json::from_slice(&fs::read(path).unwrap()).unwrap()
}

#[test]
fn areas_come_back_bit_for_bit_with_their_holes() {
    for format in FORMATS {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("out").with_extension(format);
        write(&path, &[areas()]).unwrap();
        let (read, crs) = read_area(&path, &ReadOptions::default()).unwrap();
        assert_eq!(crs.and_then(|crs| crs.epsg), Some(25832));
        assert_eq!(read.0.len(), 2, "{format}");
        for (polygon, expected) in read.iter().zip(area_rings()) {
            let rings = std::iter::once(polygon.exterior()).chain(polygon.interiors());
            for (i, (ring, expected)) in rings.zip(&expected).enumerate() {
                let points: Vec<[f64; 2]> = ring.coords().map(|c| [c.x, c.y]).collect();
                let mut wanted: Vec<[f64; 2]> = expected.iter().map(|p| p.to_array()).collect();
                let turns_left = (format != "shp") == (i == 0);
                if (turn(&wanted) > 0.0) != turns_left {
                    wanted.reverse();
                }
                assert_eq!(points, wanted, "{format}");
                assert_eq!(turn(&points) > 0.0, turns_left, "{format}");
            }
            assert_eq!(polygon.interiors().len() + 1, expected.len(), "{format}");
        }
    }
}

#[test]
fn attributes_and_missing_ones_are_the_same_everywhere() {
    let dir = tempfile::tempdir().unwrap();
    let path = |extension: &str| dir.path().join("out").with_extension(extension);
    FORMATS.iter().for_each(|format| write(&path(format), &[areas()]).unwrap());

    let properties = |i: usize| json(&path("geojson"))["features"][i]["properties"].clone();
    let expected = serde_json::json!(
        {"class": "尾根 ridge", "count": -9_007_199_254_740_992_i64, "slope_deg": 0.1 + 0.2, "is_flat": true});
    assert_eq!(properties(0), expected);
    let nulls = serde_json::json!({"class": null, "count": null, "slope_deg": null, "is_flat": null});
    assert_eq!(properties(1), nulls);

    let db = Connection::open(path("gpkg")).unwrap();
    let row: (String, i64, f64, bool) = db
        .query_row("SELECT class, \"count\", slope_deg, is_flat FROM landform WHERE fid = 1", [], |row| {
            Ok((row.get(0)?, row.get(1)?, row.get(2)?, row.get(3)?))
        })
        .unwrap();
    assert_eq!(row, ("尾根 ridge".to_owned(), -(1 << 53), 0.1 + 0.2, true));
    let query = "SELECT COUNT(*) FROM landform WHERE class IS NULL AND \"count\" IS NULL AND slope_deg IS NULL
                 AND is_flat IS NULL";
    assert_eq!(db.query_row(query, [], |row| row.get::<_, i64>(0)).unwrap(), 1);

    let bytes = fs::read(path("dbf")).unwrap();
    let (header, width) = (32 * 5 + 1, 1 + 16 + 18 + 24 + 1);
    assert_eq!(bytes.len(), header + 2 * width + 1);
    let record = |i: usize| std::str::from_utf8(&bytes[header + i * width..][..width]).unwrap();
    assert_eq!(record(0), " 尾根 ridge     -9007199254740992     0.300000000000000041");
    assert_eq!(record(1).trim(), "");
    let mut reader = shapefile::Reader::from_path(path("shp")).unwrap();
    let (_, second) = reader.iter_shapes_and_records().nth(1).unwrap().unwrap();
    assert_eq!(second.get("count"), Some(&FieldValue::Numeric(None)));
}

#[test]
fn every_vertex_of_a_line_keeps_its_height() {
    let dir = tempfile::tempdir().unwrap();
    let path = |extension: &str| dir.path().join("out").with_extension(extension);
    FORMATS.iter().for_each(|format| write(&path(format), &[lines()]).unwrap());
    let expected = [VALLEY.map(|p| p.to_array()).to_vec(), LEVEL.map(|p| [p.x, p.y, 12.5]).to_vec()];

    for (i, line) in expected.iter().enumerate() {
        let geometry = &json(&path("geojson"))["features"][i]["geometry"];
        assert_eq!(*geometry, serde_json::json!({"type": "LineString", "coordinates": line}));

        let db = Connection::open(path("gpkg")).unwrap();
        let blob: Vec<u8> =
            db.query_row("SELECT geom FROM streams WHERE fid = ?1", [i as i64 + 1], |row| row.get(0)).unwrap();
        let numbers = blob[49..].chunks_exact(8).map(|b| f64::from_le_bytes(b.try_into().unwrap()));
        assert!(numbers.eq(line.iter().flatten().copied()));
    }
    for (shape, expected) in shapefile::read_shapes(path("shp")).unwrap().into_iter().zip(&expected) {
        let Read::PolylineZ(line) = shape else { panic!("{shape}") };
        assert!(line.parts()[0].iter().map(|p| [p.x, p.y, p.z]).eq(expected.iter().copied()));
    }
}

#[test]
fn a_shapefile_holds_all_rings_of_an_area_in_one_record() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("out.shp");
    write(&path, &[areas()]).unwrap();
    let shapes = shapefile::read_shapes(&path).unwrap();
    let inner = |shape: &Read| match shape {
        Read::Polygon(polygon) => polygon.rings().iter().map(|r| matches!(r, PolygonRing::Inner(_))).collect(),
        other => panic!("{other}"),
    };
    assert_eq!(shapes.iter().map(inner).collect::<Vec<Vec<bool>>>(), [vec![false, true, true], vec![false]]);
}

#[test]
fn layers_of_one_geopackage_may_differ_and_be_empty() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("out.gpkg");
    let empty = Layer { name: "nothing", rows: Vec::new(), ..areas() };
    write(&path, &[areas(), lines(), empty.clone()]).unwrap();
    let db = Connection::open(&path).unwrap();
    let mut query = db.prepare("SELECT table_name, geometry_type_name, z FROM gpkg_geometry_columns").unwrap();
    let rows = query.query_map([], |row| Ok((row.get(0)?, row.get(1)?, row.get(2)?))).unwrap();
    let rows: Vec<(String, String, i64)> = rows.map(|row| row.unwrap()).collect();
    let expected = [("landform", "POLYGON", 0), ("streams", "LINESTRING", 1), ("nothing", "POLYGON", 0)];
    assert_eq!(rows, expected.map(|(name, kind, z)| (name.to_owned(), kind.to_owned(), z)));
    let boxes: i64 = db.query_row("SELECT COUNT(*) FROM rtree_landform_geom", [], |row| row.get(0)).unwrap();
    assert_eq!(boxes, 2);

    let path = dir.path().join("out.shp");
    write(&path, &[empty]).unwrap();
    assert_eq!(fs::read(&path).unwrap()[32], 5);
}

#[test]
fn what_a_format_cannot_say_is_refused_by_all() {
    let area = |rings| Row { shape: Shape::Area(rings), cells: nulls() };
    let with = |i: usize, cell| {
        let mut row = area(vec![square(0.0, 0.0, 1.0, false)]);
        row.cells[i] = cell;
        row
    };
    let mut open = square(0.0, 0.0, 1.0, false);
    open.pop();
    open.push(DVec2::new(0.0, 0.5));
    let rows = [
        (area(vec![]), "without a ring"),
        (area(vec![open]), "not closed"),
        (area(vec![vec![DVec2::ZERO; 3]]), "fewer than four"),
        (area(vec![vec![DVec2::NAN; 4]]), "not finite"),
        (Row { shape: Shape::Line(&VALLEY), cells: nulls() }, "another type"),
        (Row { cells: vec![], ..area(vec![square(0.0, 0.0, 1.0, false)]) }, "one value per attribute"),
        (with(0, Cell::Text("seventeen letters".into())), "class is longer"),
        (with(0, Cell::Int(1)), "another kind"),
        (with(1, Cell::Int(i64::MIN)), "count is too large"),
        (with(2, Cell::Real(f64::NAN)), "slope_deg is not finite"),
    ];
    let dir = tempfile::tempdir().unwrap();
    for format in FORMATS {
        let path = dir.path().join("out").with_extension(format);
        for (row, words) in rows.clone() {
            let error = write(&path, &[Layer { rows: vec![row], ..areas() }]).unwrap_err().to_string();
            assert!(error.contains(words) && error.contains("landform"), "{error}");
        }
        for columns in [
            &[Column { name: "eleven_long", kind: Kind::Int }][..],
            &[Column { name: "", kind: Kind::Int }],
            &[Column { name: "fid", kind: Kind::Int }],
            &[Column { name: "a", kind: Kind::Int }, Column { name: "A", kind: Kind::Int }],
        ] {
            let columns: &'static [Column] = columns.to_vec().leak();
            assert!(write(&path, &[Layer { columns, rows: vec![], ..areas() }]).is_err());
        }
    }
    assert_eq!(fs::read_dir(dir.path()).unwrap().count(), 0);
}
