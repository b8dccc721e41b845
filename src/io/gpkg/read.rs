//! Reads layers of a GeoPackage into a table.

use std::path::Path;

use rusqlite::types::ValueRef;
use rusqlite::{Connection, OptionalExtension, Row, params_from_iter};

use super::engine::{self, in_words};
use super::index::sound_index;
use super::quoted::quoted;
use super::wkb;
use crate::attributes::{is_depth_name, is_elevation_name, is_open_name, upper_of};
use crate::ordinary::open_to_read;
use crate::table::{Feature, NO_GEOMETRY, Purpose, Request, Table, Value};
use tokosen_core::base::error::{Error, Finding, FindingKind, Result};
use tokosen_core::base::memory;
use tokosen_core::crs::Crs;
use tokosen_core::features::Shapes;

/// Steps of the database engine that reading a file with views may take, besides those for each byte of the file. They take about
/// a second. A view that joins itself can go on for ever.
const FREE_STEPS: u64 = 100_000_000;
/// Further steps for each byte of the file.
const STEPS_PER_BYTE: u64 = 1_000;
/// Steps between two looks at their number.
const LOOK: i32 = 1_000_000;
/// Length of the head of a database, bytes.
const SHORTEST: u64 = 100;
/// A list that grows is copied to one of twice its length.
const GROWTH: f64 = 3.0;
/// Rows between two looks at the memory.
const ROWS: u64 = 1 << 14;

/// A layer with geometry.
struct Layer {
    table: String,
    geometry: String,
    content: LayerGeometry,
    srs_id: i64,
    /// Whether polygons of it may be contours: they have z, or an attribute with a name of elevations.
    may_be_contours: bool,
}

/// The kind of geometry in a layer.
#[derive(Clone, Copy, PartialEq, Eq)]
enum LayerGeometry {
    Lines,
    Points,
    Polygons,
    Other,
}

/// Reads one layer: the named one, otherwise the only layer of lines (of points or polygons if the request asks for
/// those). A single layer of points beside a single layer of lines is read too.
pub(crate) fn read(path: &Path, request: &Request<'_>) -> Result<Table> {
    // SQLite does not report why it cannot open a file; the operating system does.
    open_to_read(path)?;
    let mut db =
        engine::open_to_read(path).map_err(|e| in_words(path, "the file cannot be opened as a GeoPackage", e))?;
    let broken = |e: rusqlite::Error| in_words(path, "the GeoPackage cannot be read", e);
    let has_layers: bool = db
        .query_row("SELECT count(*) FROM sqlite_master WHERE name = 'gpkg_geometry_columns'", [], |row| row.get(0))
        .map_err(|e| in_words(path, "the file is not a GeoPackage, or it is broken; copy or export it again", e))?;
    if !has_layers {
        // The engine takes a file of one byte for a new database.
        if std::fs::metadata(path).is_ok_and(|file| file.len() < SHORTEST) {
            return Err(Error::file(path, "the file is too short for a GeoPackage; copy or export it again"));
        }
        return Err(Error::file(path, "the file is a database, but not a GeoPackage with vector layers"));
    }
    limit_steps(path, &mut db).map_err(broken)?;
    let layers = list_layers(&db, request).map_err(broken)?;
    let mut table = Table::new(request);
    let chosen = choose(path, &layers, request, &mut table)?;
    for (i, layer) in chosen.iter().enumerate() {
        let (crs, problem) = crs_of(&db, layer.srs_id).map_err(broken)?;
        if i > 0 && layer.srs_id != chosen[0].srs_id {
            let message = format!(
                "the layer {:?} left out: its coordinate reference system is not that of the lines",
                layer.table
            );
            table.findings.push(Finding::general(FindingKind::SkippedFeature, message));
            continue;
        }
        (table.crs, table.crs_problem) = (crs, problem);
        read_layer(path, &db, layer, &mut table, request)?;
    }
    Ok(table)
}

fn list_layers(db: &Connection, request: &Request<'_>) -> rusqlite::Result<Vec<Layer>> {
    let mut statement = db.prepare(
        "SELECT table_name, column_name, geometry_type_name, srs_id FROM gpkg_geometry_columns ORDER BY table_name",
    )?;
    let rows = statement.query_map([], |row| {
        let kind: String = row.get(2)?;
        let layer = Layer {
            table: row.get(0)?,
            geometry: row.get(1)?,
            content: LayerGeometry::Other,
            srs_id: row.get(3)?,
            may_be_contours: false,
        };
        Ok((layer, kind))
    })?;
    let mut layers = Vec::new();
    for row in rows {
        let (mut layer, kind) = row?;
        layer.content = match kind.to_ascii_uppercase().as_str() {
            "GEOMETRY" | "GEOMETRYCOLLECTION" => peek(db, &layer)?,
            other => content_of(other),
        };
        if layer.content == LayerGeometry::Polygons && request.purpose == Purpose::Contours {
            layer.may_be_contours = may_be_contours(db, &layer, request)?;
        }
        layers.push(layer);
    }
    Ok(layers)
}

/// Whether polygons may be contours, or areas between contours: they have z, or an attribute with such a name.
fn may_be_contours(db: &Connection, layer: &Layer, request: &Request<'_>) -> rusqlite::Result<bool> {
    let sql = "SELECT z FROM gpkg_geometry_columns WHERE table_name = ?1";
    let z = db.query_row(sql, [&layer.table], |row| row.get::<_, i64>(0));
    let columns: Vec<String> = columns_of(db, layer)?.0.iter().map(|name| name.trim().to_lowercase()).collect();
    let is_named = |name: &str| request.elevation_field.is_some_and(|named| named.to_lowercase() == name);
    let is_band = |name: &str| upper_of(name).any(|upper| columns.contains(&upper));
    Ok(z.is_ok_and(|z| z != 0)
        || columns.iter().any(|name| {
            is_named(name) || is_elevation_name(name) || is_open_name(name) || is_depth_name(name) || is_band(name)
        }))
}

fn content_of(kind: &str) -> LayerGeometry {
    match kind.to_ascii_uppercase().as_str() {
        "LINESTRING" | "MULTILINESTRING" | "CURVE" | "MULTICURVE" => LayerGeometry::Lines,
        "POINT" | "MULTIPOINT" => LayerGeometry::Points,
        "POLYGON" | "MULTIPOLYGON" | "SURFACE" | "CURVEPOLYGON" | "MULTISURFACE" => LayerGeometry::Polygons,
        _ => LayerGeometry::Other,
    }
}

/// A layer may declare "any geometry". Then its first geometry decides.
fn peek(db: &Connection, layer: &Layer) -> rusqlite::Result<LayerGeometry> {
    let (table, geometry) = (quoted(&layer.table), quoted(&layer.geometry));
    let sql = format!("SELECT {geometry} FROM {table} WHERE {geometry} IS NOT NULL LIMIT 1");
    let blob: Option<Vec<u8>> = db.query_row(&sql, [], |row| row.get(0)).optional().unwrap_or(None);
    let kind = blob.and_then(|blob| wkb::without_header(&blob).ok().flatten().and_then(|wkb| wkb::type_name(wkb).ok()));
    Ok(match kind {
        // A collection most likely holds contours.
        Some("GeometryCollection") => LayerGeometry::Lines,
        Some(kind) => content_of(kind),
        None => LayerGeometry::Other,
    })
}

fn choose<'a>(path: &Path, layers: &'a [Layer], request: &Request<'_>, table: &mut Table) -> Result<Vec<&'a Layer>> {
    let names =
        |layers: &[&Layer]| layers.iter().map(|layer| format!("{:?}", layer.table)).collect::<Vec<_>>().join(", ");
    let all: Vec<&Layer> = layers.iter().collect();
    if all.is_empty() {
        return Err(Error::file(path, "the GeoPackage has no vector layer"));
    }
    if let Some(wanted) = request.layer {
        let exact = all.iter().find(|layer| layer.table == wanted);
        let found = exact.or_else(|| all.iter().find(|layer| layer.table.to_lowercase() == wanted.to_lowercase()));
        return match found {
            Some(layer) => Ok(vec![layer]),
            None => Err(Error::file(path, format!("there is no layer {wanted:?}; its layers are {}", names(&all)))),
        };
    }
    let of = |content: LayerGeometry| all.iter().copied().filter(|layer| layer.content == content).collect::<Vec<_>>();
    let (lines, points, polygons) = (of(LayerGeometry::Lines), of(LayerGeometry::Points), of(LayerGeometry::Polygons));
    let contours: Vec<_> = polygons.iter().filter(|layer| layer.may_be_contours).copied().collect();
    let outlines: Vec<_> = lines.iter().chain(&polygons).copied().collect();
    let either: Vec<_> = points.iter().chain(&polygons).copied().collect();
    let (wanted, what) = match request.purpose {
        // Contours may be stored as polygons.
        Purpose::Contours if lines.is_empty() && !contours.is_empty() => (&contours, "polygons"),
        Purpose::Contours => (&lines, "lines"),
        Purpose::Spots | Purpose::Places => (&points, "points"),
        Purpose::Area => (&polygons, "polygons"),
        Purpose::Features(role) => {
            let layers = match role.shapes() {
                Shapes::LinesElsePolygons if lines.is_empty() => &polygons,
                Shapes::Lines | Shapes::LinesElsePolygons => &lines,
                Shapes::Polygons => &polygons,
                Shapes::LinesOrPolygons => &outlines,
                Shapes::PointsOrPolygons => &either,
            };
            (layers, role.shapes().words())
        }
    };
    match wanted.as_slice() {
        [] => Err(Error::file(path, format!("there is no layer of {what}; its layers are {}", names(&all)))),
        [one] => {
            let mut chosen = vec![*one];
            if request.purpose == Purpose::Contours {
                match points.as_slice() {
                    [] => {}
                    [spots] => chosen.push(spots),
                    many => {
                        let message = format!("several layers of points, none was read: {}", names(many));
                        table.findings.push(Finding::general(FindingKind::SkippedFeature, message));
                    }
                }
            }
            Ok(chosen)
        }
        many => {
            let layers = many.iter().map(|layer| layer.table.clone()).collect();
            Err(Error::LayerAmbiguous { what, layers }.in_file(path))
        }
    }
}

/// The coordinate reference system of an id, or the reason why there is none.
fn crs_of(db: &Connection, srs_id: i64) -> rusqlite::Result<(Option<Crs>, Option<String>)> {
    if srs_id == 0 || srs_id == -1 {
        return Ok((None, Some("the layer says that its coordinate reference system is not defined".to_owned())));
    }
    // The second version of the well-known text has its own column, which only some files have.
    let read = |row: &Row<'_>| {
        let text = |name: &str| row.get::<_, Option<String>>(name).ok().flatten();
        let organization = text("organization").unwrap_or_default();
        let code = row.get::<_, i64>("organization_coordsys_id").ok().and_then(|code| u32::try_from(code).ok());
        let defined = |text: &String| !text.trim().is_empty() && !text.trim().eq_ignore_ascii_case("undefined");
        let wkt = text("definition").filter(defined).or_else(|| text("definition_12_063").filter(defined));
        Ok((organization, code, wkt))
    };
    let found = db.query_row("SELECT * FROM gpkg_spatial_ref_sys WHERE srs_id = ?1", [srs_id], read).optional()?;
    Ok(match found {
        Some((organization, Some(code), wkt)) if organization.eq_ignore_ascii_case("EPSG") && code > 0 => {
            let wkt = wkt.or_else(|| Crs::from_epsg(code).wkt);
            (Some(Crs { epsg: Some(code), wkt }), None)
        }
        Some((_, _, Some(wkt))) => (Some(Crs::from_wkt(&wkt)), None),
        _ => {
            (None, Some(format!("the coordinate reference system {srs_id} of the layer is not described in the file")))
        }
    })
}

/// Stops the engine when reading takes more steps than the layers of this file can need. Only views need many.
fn limit_steps(path: &Path, db: &mut Connection) -> rusqlite::Result<()> {
    let views = "SELECT count(*) FROM sqlite_master WHERE type = 'view'";
    if db.query_row(views, [], |row| row.get::<_, i64>(0))? == 0 {
        return Ok(());
    }
    let bytes = path.metadata().map_or(0, |meta| meta.len());
    let mut left = FREE_STEPS.saturating_add(STEPS_PER_BYTE.saturating_mul(bytes)) / LOOK as u64;
    db.progress_handler(
        LOOK,
        Some(move || {
            left = left.saturating_sub(1);
            left == 0
        }),
    )
}

/// Reads a layer. If there is a box that features must meet, the index chooses those that may; otherwise all are read. Either
/// way they come in the order of their keys.
fn read_layer(path: &Path, db: &Connection, layer: &Layer, table: &mut Table, request: &Request<'_>) -> Result<()> {
    let broken = |e| unread(path, layer, e);
    let (columns, key) = columns_of(db, layer).map_err(broken)?;
    let name = quoted(&layer.table);
    let index = request.within.and_then(|within| {
        let key = quoted(&columns[key?]);
        let index = sound_index(db, &layer.table, &layer.geometry, &key)?;
        Some((within, key, index))
    });
    let (sql, sides) = match index {
        Some((within, key, index)) => {
            let meeting = "maxx >= ?1 AND maxy >= ?2 AND minx <= ?3 AND miny <= ?4";
            let chosen = format!("SELECT id FROM {index} WHERE {meeting}");
            (format!("SELECT * FROM {name} WHERE {key} IN ({chosen}) ORDER BY {key}"), within.sides().to_vec())
        }
        None => (format!("SELECT * FROM {name}"), Vec::new()),
    };
    let mut statement = db.prepare(&sql).map_err(broken)?;
    if statement.column_count() != columns.len() {
        return Err(Error::file(path, format!("the columns of the layer {:?} cannot be distinguished", layer.table)));
    }
    let is = |name: &str, other: &str| name.eq_ignore_ascii_case(other);
    let geometry = columns.iter().position(|name| is(name, &layer.geometry)).ok_or_else(|| {
        Error::file(path, format!("the layer {:?} lacks its geometry column {:?}", layer.table, layer.geometry))
    })?;
    let fields: Vec<Option<usize>> = columns
        .iter()
        .enumerate()
        .map(|(i, name)| (i != geometry && Some(i) != key).then(|| table.field(name)))
        .collect();

    let mut rows = statement.query(params_from_iter(sides)).map_err(broken)?;
    let (mut count, mut taken) = (0, 0);
    while let Some(row) = rows.next().map_err(broken)? {
        let id = key.and_then(|key| row.get_ref(key).ok()?.as_i64().ok()).and_then(|id| u64::try_from(id).ok());
        let mut feature = Feature { number: id.unwrap_or(count), ..Feature::default() };
        count += 1;
        for (i, field) in fields.iter().enumerate() {
            let Some(field) = field.filter(|&field| table.wants(field)) else { continue };
            table.note(&mut feature.values, field, value_of(row.get_ref(i).map_err(broken)?));
        }
        let blob = match row.get_ref(geometry).map_err(broken)? {
            ValueRef::Blob(blob) => Some(blob),
            ValueRef::Null => None,
            _ => return Err(wrong(path, layer, feature.number, "its geometry is not binary")),
        };
        let at_fault = |what: String| wrong(path, layer, feature.number, &what);
        match blob.map_or(Ok(None), wkb::without_header).map_err(at_fault)? {
            Some(bytes) => {
                let number = feature.number;
                wkb::read(bytes, &mut feature, table).map_err(|what| wrong(path, layer, number, &what))?;
            }
            None => table.leave_out(NO_GEOMETRY),
        }
        taken += feature.bytes();
        if count % ROWS == 0 {
            let what = format!("the layer {:?} as far as row {count}", layer.table);
            memory::check(GROWTH * taken as f64, request.memory, what, "choose a part of it, or close other programs")?;
        }
        table.push(feature);
    }
    Ok(())
}

/// Why a layer cannot be read.
fn unread(path: &Path, layer: &Layer, cause: rusqlite::Error) -> Error {
    if cause.sqlite_error_code() == Some(rusqlite::ErrorCode::OperationInterrupted) {
        let message = format!("the layer {:?} is a view that does not come to an end; save it as a table", layer.table);
        return Error::file(path, message);
    }
    in_words(path, &format!("the layer {:?} cannot be read; the file may be broken", layer.table), cause)
}

/// The value of a cell.
fn value_of(cell: ValueRef<'_>) -> Value {
    match cell {
        ValueRef::Null => Value::Null,
        ValueRef::Integer(number) => Value::Number(number as f64),
        ValueRef::Real(number) => Value::Number(number),
        ValueRef::Text(text) => Value::Text(String::from_utf8_lossy(text).into_owned()),
        ValueRef::Blob(_) => Value::Text("binary".to_owned()),
    }
}

/// The names of a layer's columns, in the order of `SELECT *`, and the index of the primary key.
///
/// The names come from a query, not from the statement: the statement's own names must be UTF-8, and those of a broken
/// file may not be.
fn columns_of(db: &Connection, layer: &Layer) -> rusqlite::Result<(Vec<String>, Option<usize>)> {
    let mut statement = db.prepare("SELECT name, pk FROM pragma_table_xinfo(?1) WHERE hidden <> 1 ORDER BY cid")?;
    let mut rows = statement.query([&layer.table])?;
    let (mut names, mut key) = (Vec::new(), None);
    while let Some(row) = rows.next()? {
        if row.get::<_, i64>(1)? == 1 {
            key = Some(names.len());
        }
        names.push(match row.get_ref(0)? {
            ValueRef::Text(text) => String::from_utf8_lossy(text).into_owned(),
            _ => String::new(),
        });
    }
    Ok((names, key))
}

fn wrong(path: &Path, layer: &Layer, feature: u64, what: &str) -> Error {
    Error::file(path, format!("layer {:?}, feature {feature}: {what}", layer.table))
}
