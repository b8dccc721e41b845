//! Writes layers into a new GeoPackage. [`merge`](super::merge) adds them to one that exists.
//!
//! The same layers give the same bytes. The format requires the time of the last change; a fixed date is written.

use std::path::Path;

use rusqlite::{Connection, params, params_from_iter};

use super::quoted::quoted;
use super::styles;
use super::target::{LAST_CHANGE, OWN_SRS_ID, SrsRow, srs_id_in};
use super::wkb;
use crate::layer::{Cell, Geometry, Kind, Layer, NO_BOUNDS, joined};
use crate::maker::MADE_BY;
use tokosen_core::base::error::{Error, Result};
use tokosen_core::crs::Crs;

/// "GPKG" in ASCII.
const APPLICATION_ID: i32 = 0x4750_4B47;
/// Version 1.3.0 of the format.
const USER_VERSION: i32 = 10300;
/// The id of WGS 84, which every file has.
const WGS84_SRS_ID: i32 = 4326;
/// The id that the format reserves for plane coordinates of an unknown system.
const UNKNOWN_SRS_ID: i32 = -1;

const TABLES: &str = "
CREATE TABLE gpkg_spatial_ref_sys (
  srs_name TEXT NOT NULL,
  srs_id INTEGER NOT NULL PRIMARY KEY,
  organization TEXT NOT NULL,
  organization_coordsys_id INTEGER NOT NULL,
  definition TEXT NOT NULL,
  description TEXT
);
CREATE TABLE gpkg_contents (
  table_name TEXT NOT NULL PRIMARY KEY,
  data_type TEXT NOT NULL,
  identifier TEXT UNIQUE,
  description TEXT DEFAULT '',
  last_change DATETIME NOT NULL DEFAULT (strftime('%Y-%m-%dT%H:%M:%fZ','now')),
  min_x DOUBLE, min_y DOUBLE, max_x DOUBLE, max_y DOUBLE,
  srs_id INTEGER,
  CONSTRAINT fk_gc_r_srs_id FOREIGN KEY (srs_id) REFERENCES gpkg_spatial_ref_sys(srs_id)
);
CREATE TABLE gpkg_geometry_columns (
  table_name TEXT NOT NULL,
  column_name TEXT NOT NULL,
  geometry_type_name TEXT NOT NULL,
  srs_id INTEGER NOT NULL,
  z TINYINT NOT NULL,
  m TINYINT NOT NULL,
  CONSTRAINT pk_geom_cols PRIMARY KEY (table_name, column_name),
  CONSTRAINT uk_gc_table_name UNIQUE (table_name),
  CONSTRAINT fk_gc_tn FOREIGN KEY (table_name) REFERENCES gpkg_contents(table_name),
  CONSTRAINT fk_gc_srs FOREIGN KEY (srs_id) REFERENCES gpkg_spatial_ref_sys (srs_id)
);
INSERT INTO gpkg_spatial_ref_sys VALUES
  ('Undefined cartesian SRS', -1, 'NONE', -1, 'undefined', 'undefined cartesian coordinate reference system'),
  ('Undefined geographic SRS', 0, 'NONE', 0, 'undefined', 'undefined geographic coordinate reference system');
";

/// The table of the extensions that layers use. A GeoPackage of another program may lack it.
pub(super) const EXTENSIONS_TABLE: &str = "
CREATE TABLE IF NOT EXISTS gpkg_extensions (
  table_name TEXT,
  column_name TEXT,
  extension_name TEXT NOT NULL,
  definition TEXT NOT NULL,
  scope TEXT NOT NULL,
  CONSTRAINT ge_tce UNIQUE (table_name, column_name, extension_name)
);
";

/// Writes all layers into one new file. If they are to be added to the file `target`, the system has the same id as there.
pub(crate) fn write(path: &Path, layers: &[Layer<'_>], crs: Option<&Crs>, target: Option<&Path>) -> Result<()> {
    let system = crs.map(SrsRow::new);
    let srs_id = match (&system, target) {
        (None, _) => UNKNOWN_SRS_ID,
        (Some(system), Some(target)) => srs_id_in(target, system)?,
        (Some(system), None) => system.code.unwrap_or(OWN_SRS_ID),
    };
    fill(path, layers, system.as_ref(), srs_id).map_err(|e| match e {
        rusqlite::Error::SqliteFailure(failure, _) if failure.code == rusqlite::ErrorCode::DiskFull => {
            Error::io("write", path, std::io::Error::from(std::io::ErrorKind::StorageFull))
        }
        other => Error::file_cause(path, "the GeoPackage cannot be written", other),
    })
}

fn fill(path: &Path, layers: &[Layer<'_>], system: Option<&SrsRow>, srs_id: i32) -> rusqlite::Result<()> {
    let mut db = Connection::open(path)?;
    // An unfinished file is discarded, and a finished one is flushed before it gets its name. The database engine
    // therefore needs no journal and need not wait for the disk.
    db.execute_batch("PRAGMA journal_mode = OFF; PRAGMA synchronous = OFF; PRAGMA encoding = 'UTF-8';")?;
    db.pragma_update(None, "application_id", APPLICATION_ID)?;
    db.pragma_update(None, "user_version", USER_VERSION)?;
    let transaction = db.transaction()?;
    transaction.execute_batch(TABLES)?;
    transaction.execute_batch(EXTENSIONS_TABLE)?;
    add_system(&transaction, WGS84_SRS_ID, &SrsRow::new(&Crs::wgs84()))?;
    if let Some(system) = system.filter(|_| srs_id != WGS84_SRS_ID) {
        add_system(&transaction, srs_id, system)?;
    }
    for layer in layers {
        add_layer(&transaction, layer, srs_id)?;
    }
    styles::add(&transaction, layers)?;
    transaction.commit()?;
    db.close().map_err(|(_, e)| e)
}

fn add_system(db: &Connection, id: i32, system: &SrsRow) -> rusqlite::Result<()> {
    let organization = if system.code.is_some() { "EPSG" } else { "NONE" };
    db.execute(
        "INSERT INTO gpkg_spatial_ref_sys VALUES (?1, ?2, ?3, ?4, ?5, NULL)",
        params![system.name, id, organization, system.code.unwrap_or(id), system.definition],
    )?;
    Ok(())
}

/// Adds a layer with its entries in the GeoPackage tables.
///
/// Long because it lists the SQL of all tables that know of a layer.
fn add_layer(db: &Connection, layer: &Layer<'_>, srs_id: i32) -> rusqlite::Result<()> {
    let table = quoted(layer.name);
    let index = quoted(&format!("rtree_{}_geom", layer.name));
    let (geometry, has_z) = match layer.geometry {
        Geometry::Points => ("POINT", 0),
        Geometry::Lines => ("LINESTRING", 1),
        Geometry::Areas => ("POLYGON", 0),
    };
    let columns: String = layer
        .columns
        .iter()
        .map(|column| match column.kind {
            Kind::Real | Kind::Height | Kind::HeightError => format!(", {} DOUBLE", quoted(column.name)),
            Kind::Int => format!(", {} INTEGER", quoted(column.name)),
            Kind::Text(_) | Kind::LongText => format!(", {} TEXT", quoted(column.name)),
            Kind::Bool => format!(", {} BOOLEAN", quoted(column.name)),
        })
        .collect();
    db.execute_batch(&format!(
        "CREATE TABLE {table} (fid INTEGER PRIMARY KEY AUTOINCREMENT NOT NULL, geom {geometry}{columns});
         CREATE VIRTUAL TABLE {index} USING rtree(id, minx, maxx, miny, maxy);"
    ))?;
    db.execute(
        "INSERT INTO gpkg_contents (table_name, data_type, identifier, description, last_change, srs_id)
         VALUES (?1, 'features', ?1, ?2, ?3, ?4)",
        params![layer.name, MADE_BY, LAST_CHANGE, srs_id],
    )?;
    db.execute(
        "INSERT INTO gpkg_geometry_columns VALUES (?1, 'geom', ?2, ?3, ?4, 0)",
        params![layer.name, geometry, srs_id, has_z],
    )?;
    db.execute(
        "INSERT INTO gpkg_extensions VALUES (?1, 'geom', 'gpkg_rtree_index',
         'http://www.geopackage.org/spec130/#extension_rtree', 'write-only')",
        params![layer.name],
    )?;

    let slots = ", ?".repeat(layer.columns.len());
    let mut add_feature = db.prepare(&format!("INSERT INTO {table} VALUES (?, ?{slots})"))?;
    let mut add_bounds = db.prepare(&format!("INSERT INTO {index} VALUES (?1, ?2, ?3, ?4, ?5)"))?;
    let mut blob = Vec::new();
    let mut extent = NO_BOUNDS;
    for (fid, row) in (1_i64..).zip(&layer.rows) {
        let bounds = row.shape.bounds();
        extent = joined(extent, bounds);
        let is_somewhere = row.shape.vertex_count() > 0;
        wkb::put(&mut blob, &row.shape, srs_id, bounds);
        let cells = row.cells.iter().map(|cell| match cell {
            Cell::Real(number) => SqlCell::Real(*number),
            Cell::Int(number) => SqlCell::Integer(*number),
            Cell::Text(text) => SqlCell::Text(text),
            Cell::Bool(yes) => SqlCell::Integer(i64::from(*yes)),
            Cell::Null => SqlCell::Null,
        });
        let geometry = if is_somewhere { SqlCell::Blob(&blob) } else { SqlCell::Null };
        let cells = [SqlCell::Integer(fid), geometry].into_iter().chain(cells);
        add_feature.execute(params_from_iter(cells))?;
        if !is_somewhere {
            continue;
        }
        let [min_x, max_x, min_y, max_y] = bounds;
        add_bounds.execute(params![fid, min_x, max_x, min_y, max_y])?;
    }
    let [min_x, max_x, min_y, max_y] = extent;
    if min_x <= max_x {
        db.execute(
            "UPDATE gpkg_contents SET min_x = ?2, min_y = ?3, max_x = ?4, max_y = ?5 WHERE table_name = ?1",
            params![layer.name, min_x, min_y, max_x, max_y],
        )?;
    }
    db.execute_batch(&index_triggers(layer.name))
}

/// A value to be written to the database.
enum SqlCell<'a> {
    Integer(i64),
    Real(f64),
    Text(&'a str),
    Blob(&'a [u8]),
    Null,
}

impl rusqlite::ToSql for SqlCell<'_> {
    fn to_sql(&self) -> rusqlite::Result<rusqlite::types::ToSqlOutput<'_>> {
        use rusqlite::types::{ToSqlOutput, ValueRef};
        Ok(ToSqlOutput::Borrowed(match *self {
            Self::Integer(number) => ValueRef::Integer(number),
            Self::Real(number) => ValueRef::Real(number),
            Self::Text(text) => ValueRef::Text(text.as_bytes()),
            Self::Blob(bytes) => ValueRef::Blob(bytes),
            Self::Null => ValueRef::Null,
        }))
    }
}

/// The triggers that update the spatial index after later edits (annex F.3 of the format's specification). They call
/// functions that only editing programs provide. Therefore they are created after the features are added.
fn index_triggers(layer: &str) -> String {
    let table = quoted(layer);
    let index = quoted(&format!("rtree_{layer}_geom"));
    let name = |suffix: &str| quoted(&format!("rtree_{layer}_geom_{suffix}"));
    let put = format!(
        "INSERT OR REPLACE INTO {index} VALUES
         (NEW.fid, ST_MinX(NEW.geom), ST_MaxX(NEW.geom), ST_MinY(NEW.geom), ST_MaxY(NEW.geom));"
    );
    let is_there = "(NEW.geom NOTNULL AND NOT ST_IsEmpty(NEW.geom))";
    let is_gone = "(NEW.geom ISNULL OR ST_IsEmpty(NEW.geom))";
    let cases = [
        ("insert", "INSERT", is_there.to_owned(), put.clone()),
        ("update1", "UPDATE OF geom", format!("OLD.fid = NEW.fid AND {is_there}"), put.clone()),
        (
            "update2",
            "UPDATE OF geom",
            format!("OLD.fid = NEW.fid AND {is_gone}"),
            format!("DELETE FROM {index} WHERE id = OLD.fid;"),
        ),
        (
            "update3",
            "UPDATE",
            format!("OLD.fid != NEW.fid AND {is_there}"),
            format!("DELETE FROM {index} WHERE id = OLD.fid; {put}"),
        ),
        (
            "update4",
            "UPDATE",
            format!("OLD.fid != NEW.fid AND {is_gone}"),
            format!("DELETE FROM {index} WHERE id IN (OLD.fid, NEW.fid);"),
        ),
        ("delete", "DELETE", "OLD.geom NOT NULL".to_owned(), format!("DELETE FROM {index} WHERE id = OLD.fid;")),
    ];
    cases
        .iter()
        .map(|(suffix, event, when, action)| {
            format!("CREATE TRIGGER {} AFTER {event} ON {table} WHEN {when} BEGIN {action} END;\n", name(suffix))
        })
        .collect()
}
