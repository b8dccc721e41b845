//! Adds layers to a GeoPackage that exists.
//!
//! New layers are first written into a GeoPackage of their own, like every output. When the run is done, they are moved
//! into the target in one transaction: either all of them are in it afterwards, or it is as before. Other layers are not
//! touched, and the engine's locks hold for programs that have the file open.

use std::path::Path;

use rusqlite::{Connection, OptionalExtension, Params, params};

use super::engine::{in_words, open_to_write};
use super::quoted::quoted;
use super::styles;
use super::target::index_of;
use super::write::EXTENSIONS_TABLE;
use tokosen_core::base::error::{Error, Result};

/// Tables with a row per layer or per column of it, all by `table_name`. Some of them need not be there. Styles are kept:
/// they hold for the new layer of that name too.
const REGISTERS: &[&str] =
    &["gpkg_data_columns", "gpkg_extensions", "gpkg_ogr_contents", "gpkg_geometry_columns", "gpkg_contents"];

/// Moves the layers of the GeoPackage `added` into `target`. Layers of the same name are replaced.
pub(crate) fn merge(added: &Path, target: &Path) -> Result<()> {
    let is_added = run(added, target).map_err(|e| {
        let message =
            "the layers cannot be added to the GeoPackage, which is as before; is it open in another program?";
        in_words(target, message, e)
    })?;
    if is_added {
        return Ok(());
    }
    let message = "another program has meanwhile added another coordinate reference system under the same number, so the \
                   layers are not added; run the command again";
    Err(Error::file(target, message))
}

/// Whether the layers are added. They are not if the target has meanwhile got another coordinate reference system under the
/// id of theirs.
fn run(added: &Path, target: &Path) -> rusqlite::Result<bool> {
    let mut db = open_to_write(target)?;
    // The rows of a layer are in several tables. They are removed and added together.
    db.execute_batch("PRAGMA foreign_keys = OFF")?;
    db.execute("ATTACH DATABASE ?1 AS added", [added.to_string_lossy()])?;
    let transaction = db.transaction_with_behavior(rusqlite::TransactionBehavior::Immediate)?;
    if has_other_systems(&transaction)? {
        return Ok(false);
    }
    transaction.execute_batch(EXTENSIONS_TABLE)?;
    add_systems(&transaction)?;
    for layer in &texts(&transaction, "SELECT table_name FROM added.gpkg_contents ORDER BY rowid", [])? {
        remove(&transaction, layer)?;
        add(&transaction, layer)?;
        styles::copy(&transaction, layer)?;
    }
    transaction.commit()?;
    db.execute_batch("DETACH DATABASE added")?;
    db.close().map(|()| true).map_err(|(_, e)| e)
}

/// Whether the target has another system under the id of one that the added layers use. The id was chosen when the layers
/// were written; since then, another run may have chosen it too.
fn has_other_systems(db: &Connection) -> rusqlite::Result<bool> {
    let others =
        "SELECT count(*) FROM added.gpkg_spatial_ref_sys AS a JOIN main.gpkg_spatial_ref_sys AS b USING (srs_id)
         WHERE srs_id > 0 AND srs_id IN (SELECT srs_id FROM added.gpkg_contents)
         AND CASE upper(a.organization) WHEN 'EPSG'
             THEN upper(b.organization) <> 'EPSG' OR a.organization_coordsys_id <> b.organization_coordsys_id
             ELSE a.definition <> b.definition END";
    db.query_row(others, [], |row| row.get::<_, i64>(0)).map(|count| count > 0)
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
