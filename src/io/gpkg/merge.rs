//! Adds layers to a GeoPackage that exists.
//!
//! New layers are first written into a GeoPackage of their own, like every output. When the run is done, they are moved
//! into the target in one transaction: either all of them are in it afterwards, or it is as before. Other layers are not
//! touched, and the engine's locks hold for programs that have the file open.

use std::path::Path;
use std::time::Duration;

use rusqlite::{Connection, OpenFlags, OptionalExtension, Params, params};

use super::quoted::quoted;
use super::write::{EXTENSIONS_TABLE, OWN_SRS_ID, SrsRow};
use crate::base::error::{Error, Result};
use crate::io::maker::MADE_BY;

/// How long to wait for another program that writes to the file.
const PATIENCE: Duration = Duration::from_secs(10);

/// Tables with a row per layer or per column of it, all by `table_name`. Some of them need not be there. Styles are kept:
/// they hold for the new layer of that name too.
const REGISTERS: &[&str] =
    &["gpkg_data_columns", "gpkg_extensions", "gpkg_ogr_contents", "gpkg_geometry_columns", "gpkg_contents"];

/// Whether there is a file that layers are added to. An empty file is none.
pub(in crate::io) fn is_there(path: &Path) -> bool {
    path.metadata().is_ok_and(|meta| meta.len() > 0) && open(path).is_ok_and(|db| is_geopackage(&db).unwrap_or(false))
}

/// Checks that layers of these names may be written to a file.
///
/// # Errors
/// [`Error::LayerExists`] if the file has a layer of that name that this program did not make, and `overwrite` is not
/// set, or if the file is an input. [`Error::Exists`] if it is no GeoPackage and `overwrite` is not set. [`Error::File`]
/// if it has a table of that name that is no layer, or cannot be read.
pub(in crate::io) fn check_layers(path: &Path, layers: &[&str], overwrite: bool, is_input: bool) -> Result<()> {
    if !path.metadata().is_ok_and(|meta| meta.is_file() && meta.len() > 0) {
        return Ok(());
    }
    let failed = |e| Error::file_cause(path, "the GeoPackage cannot be read", e);
    let db = open(path).map_err(failed)?;
    if !is_geopackage(&db).unwrap_or(false) {
        return if overwrite { Ok(()) } else { Err(Error::Exists { path: path.to_owned() }) };
    }
    for &layer in layers {
        match existing(&db, layer).map_err(failed)? {
            Existing::No => {}
            Existing::Own if !is_input => {}
            Existing::Foreign if overwrite && !is_input => {}
            Existing::Own | Existing::Foreign => {
                return Err(Error::LayerExists { path: path.to_owned(), layer: layer.to_owned(), is_input });
            }
            Existing::NoLayer => {
                let message = format!("has a table {layer:?} that is no layer; choose another file");
                return Err(Error::file(path, message));
            }
        }
    }
    Ok(())
}

/// What a file has under a layer's name.
enum Existing {
    No,
    /// A layer that this program made.
    Own,
    /// A layer of another program.
    Foreign,
    /// A table or view that is not registered as a layer.
    NoLayer,
}

fn existing(db: &Connection, layer: &str) -> rusqlite::Result<Existing> {
    let description: Option<Option<String>> = db
        .query_row("SELECT description FROM gpkg_contents WHERE lower(table_name) = lower(?1)", [layer], |row| {
            row.get(0)
        })
        .optional()?;
    if let Some(description) = description {
        return Ok(if description.as_deref() == Some(MADE_BY) { Existing::Own } else { Existing::Foreign });
    }
    let others = "SELECT count(*) FROM sqlite_master WHERE lower(name) IN (lower(?1), lower(?2))";
    let count: i64 = db.query_row(others, [layer, &index_of(layer)], |row| row.get(0))?;
    Ok(if count > 0 { Existing::NoLayer } else { Existing::No })
}

/// The name of a layer's spatial index.
fn index_of(layer: &str) -> String {
    format!("rtree_{layer}_geom")
}

fn open(path: &Path) -> rusqlite::Result<Connection> {
    let flags = OpenFlags::SQLITE_OPEN_READ_ONLY | OpenFlags::SQLITE_OPEN_NO_MUTEX;
    let db = Connection::open_with_flags(path, flags)?;
    db.busy_timeout(PATIENCE)?;
    Ok(db)
}

fn is_geopackage(db: &Connection) -> rusqlite::Result<bool> {
    let tables = "SELECT count(*) FROM sqlite_master WHERE name IN ('gpkg_contents', 'gpkg_spatial_ref_sys')";
    db.query_row(tables, [], |row| row.get::<_, i64>(0)).map(|count| count == 2)
}

/// The id under which a file has, or can have, a coordinate reference system.
pub(in crate::io) fn srs_id_in(path: &Path, row: &SrsRow) -> Result<i32> {
    let find = || -> rusqlite::Result<i32> {
        let db = open(path)?;
        let known = match &row.code {
            Some(code) => db.query_row(
                "SELECT srs_id FROM gpkg_spatial_ref_sys
                 WHERE upper(organization) = 'EPSG' AND organization_coordsys_id = ?1 ORDER BY srs_id LIMIT 1",
                [code],
                |row| row.get(0),
            ),
            None => db.query_row(
                "SELECT srs_id FROM gpkg_spatial_ref_sys WHERE definition = ?1 ORDER BY srs_id LIMIT 1",
                [&row.definition],
                |row| row.get(0),
            ),
        };
        if let Some(id) = known.optional()? {
            return Ok(id);
        }
        let is_free = |id: i32| {
            let count = "SELECT count(*) FROM gpkg_spatial_ref_sys WHERE srs_id = ?1";
            db.query_row(count, [id], |row| row.get::<_, i64>(0)).map(|count| count == 0)
        };
        if let Some(code) = row.code.filter(|code| *code < OWN_SRS_ID)
            && is_free(code)?
        {
            return Ok(code);
        }
        let last = "SELECT max(srs_id) FROM gpkg_spatial_ref_sys WHERE srs_id >= ?1";
        let last: Option<i32> = db.query_row(last, [OWN_SRS_ID], |row| row.get(0))?;
        Ok(last.map_or(OWN_SRS_ID, |last| last.saturating_add(1)))
    };
    find().map_err(|e| Error::file_cause(path, "the GeoPackage cannot be read", e))
}

/// Moves the layers of the GeoPackage `added` into `target`. Layers of the same name are replaced.
pub(in crate::io) fn merge(added: &Path, target: &Path) -> Result<()> {
    run(added, target).map_err(|e| {
        let message =
            "the layers cannot be added to the GeoPackage, which is as before; is it open in another program?";
        Error::file_cause(target, message, e)
    })
}

fn run(added: &Path, target: &Path) -> rusqlite::Result<()> {
    let flags = OpenFlags::SQLITE_OPEN_READ_WRITE | OpenFlags::SQLITE_OPEN_NO_MUTEX;
    let mut db = Connection::open_with_flags(target, flags)?;
    db.busy_timeout(PATIENCE)?;
    // The rows of a layer are in several tables. They are removed and added together.
    db.execute_batch("PRAGMA foreign_keys = OFF")?;
    db.execute("ATTACH DATABASE ?1 AS added", [added.to_string_lossy()])?;
    let transaction = db.transaction_with_behavior(rusqlite::TransactionBehavior::Immediate)?;
    transaction.execute_batch(EXTENSIONS_TABLE)?;
    add_systems(&transaction)?;
    for layer in &texts(&transaction, "SELECT table_name FROM added.gpkg_contents ORDER BY rowid", [])? {
        remove(&transaction, layer)?;
        add(&transaction, layer)?;
    }
    transaction.commit()?;
    db.execute_batch("DETACH DATABASE added")?;
    db.close().map_err(|(_, e)| e)
}

/// Adds the coordinate reference systems that the target has not.
fn add_systems(db: &Connection) -> rusqlite::Result<()> {
    let mut missing = db.prepare(
        "SELECT srs_name, srs_id, organization, organization_coordsys_id, definition FROM added.gpkg_spatial_ref_sys
         WHERE srs_id NOT IN (SELECT srs_id FROM main.gpkg_spatial_ref_sys)",
    )?;
    // A column of a later version of the format, which may not be empty.
    let second = "SELECT count(*) FROM pragma_table_info('gpkg_spatial_ref_sys') WHERE name = 'definition_12_063'";
    let has_second: bool = db.query_row(second, [], |row| row.get(0))?;
    let (column, value) = if has_second { (", definition_12_063", ", 'undefined'") } else { ("", "") };
    let sql = format!(
        "INSERT INTO main.gpkg_spatial_ref_sys
         (srs_name, srs_id, organization, organization_coordsys_id, definition{column}) VALUES (?1, ?2, ?3, ?4, ?5{value})"
    );
    let mut rows = missing.query([])?;
    while let Some(row) = rows.next()? {
        let text = |k| row.get::<_, String>(k);
        let number = |k| row.get::<_, i64>(k);
        db.execute(&sql, params![text(0)?, number(1)?, text(2)?, number(3)?, text(4)?])?;
    }
    Ok(())
}

/// Removes a layer, if there is one of that name in any letter case.
fn remove(db: &Connection, layer: &str) -> rusqlite::Result<()> {
    let name = "SELECT table_name FROM main.gpkg_contents WHERE lower(table_name) = lower(?1)";
    let Some(layer): Option<String> = db.query_row(name, [layer], |row| row.get(0)).optional()? else { return Ok(()) };
    let columns = "SELECT column_name FROM main.gpkg_geometry_columns WHERE table_name = ?1";
    for column in texts(db, columns, [&layer])? {
        let index = quoted(&format!("rtree_{layer}_{column}"));
        db.execute_batch(&format!("DROP TABLE IF EXISTS main.{index}"))?;
    }
    let kind = "SELECT type FROM main.sqlite_master WHERE name = ?1 AND type IN ('table', 'view')";
    let kind: Option<String> = db.query_row(kind, [&layer], |row| row.get(0)).optional()?;
    if let Some(kind) = kind {
        db.execute_batch(&format!("DROP {kind} main.{}", quoted(&layer)))?;
    }
    for register in REGISTERS {
        let exists = "SELECT count(*) FROM main.sqlite_master WHERE name = ?1";
        if db.query_row(exists, [register], |row| row.get::<_, i64>(0))? > 0 {
            db.execute(&format!("DELETE FROM main.{register} WHERE table_name = ?1"), [&layer])?;
        }
    }
    Ok(())
}

/// Copies a layer of `added`: table, spatial index, rows of the registers, and last the triggers.
fn add(db: &Connection, layer: &str) -> rusqlite::Result<()> {
    let (table, index) = (quoted(layer), quoted(&index_of(layer)));
    for name in [layer, &index_of(layer)] {
        let sql = "SELECT sql FROM added.sqlite_master WHERE type = 'table' AND name = ?1";
        db.execute_batch(&db.query_row(sql, [name], |row| row.get::<_, String>(0))?)?;
    }
    db.execute_batch(&format!(
        "INSERT INTO main.{table} SELECT * FROM added.{table};
         INSERT INTO main.{index} SELECT id, minx, maxx, miny, maxy FROM added.{index};"
    ))?;
    for (register, columns) in [
        (
            "gpkg_contents",
            "table_name, data_type, identifier, description, last_change, min_x, min_y, max_x, max_y, srs_id",
        ),
        ("gpkg_geometry_columns", "table_name, column_name, geometry_type_name, srs_id, z, m"),
        ("gpkg_extensions", "table_name, column_name, extension_name, definition, scope"),
    ] {
        let copy = format!(
            "INSERT INTO main.{register} ({columns}) SELECT {columns} FROM added.{register} WHERE table_name = ?1"
        );
        db.execute(&copy, [layer])?;
    }
    let triggers = "SELECT sql FROM added.sqlite_master WHERE type = 'trigger' AND tbl_name = ?1 ORDER BY rowid";
    texts(db, triggers, [layer])?.iter().try_for_each(|sql| db.execute_batch(sql))
}

/// The first column of a query's rows.
fn texts(db: &Connection, sql: &str, parameters: impl Params) -> rusqlite::Result<Vec<String>> {
    db.prepare(sql)?.query_map(parameters, |row| row.get(0))?.collect()
}
