//! The GeoPackage that layers are added to, before anything is written: what it has under their names, and under which id
//! it has their coordinate reference system.

use std::path::Path;

use rusqlite::{Connection, OptionalExtension};

use super::engine::{in_words, is_about_access, open_to_read};
use crate::maker::MADE_BY;
use tokosen_core::base::error::{Error, Result};
use tokosen_core::crs::Crs;

/// The message if a file cannot be read for another reason than a lock.
const UNREADABLE: &str = "the GeoPackage cannot be read";

/// The smallest id for systems without an EPSG code. Ids of EPSG systems are their codes, which are smaller.
pub(super) const OWN_SRS_ID: i32 = 100_000;

/// Written as the time of the last change.
pub(super) const LAST_CHANGE: &str = "1970-01-01T00:00:00.000Z";

/// A coordinate reference system as a GeoPackage stores it.
pub(crate) struct SrsRow {
    pub(super) name: String,
    /// The EPSG code.
    pub(super) code: Option<i32>,
    pub(super) definition: String,
}

impl SrsRow {
    pub(super) fn new(crs: &Crs) -> Self {
        Self {
            name: crs.name().unwrap_or_else(|| "unnamed".to_owned()),
            code: crs.epsg.and_then(|code| i32::try_from(code).ok()),
            definition: crs.wkt1().or(crs.wkt()).unwrap_or("undefined").to_owned(),
        }
    }
}

/// Whether there is a file that layers are added to. An empty file is none.
///
/// # Errors
/// It is not known: another program holds the file, or the file cannot be opened.
pub(crate) fn is_there(path: &Path) -> Result<bool> {
    if !path.metadata().is_ok_and(|meta| meta.is_file() && meta.len() > 0) {
        return Ok(false);
    }
    open_to_read(path).and_then(|db| is_geopackage(&db)).map_err(|e| in_words(path, UNREADABLE, e))
}

/// Checks that layers of these names may be written to a file.
///
/// # Errors
/// [`Error::LayerExists`] if the file has a layer of that name that this program did not make, and `overwrite` is not
/// set, or if the file is an input. [`Error::Exists`] if it is no GeoPackage and `overwrite` is not set. [`Error::File`]
/// if it has a table of that name that is no layer, cannot be read, or is locked by another program.
pub(crate) fn check_layers(path: &Path, layers: &[&str], overwrite: bool, is_input: bool) -> Result<()> {
    if !path.metadata().is_ok_and(|meta| meta.is_file() && meta.len() > 0) {
        return Ok(());
    }
    let failed = |e| in_words(path, UNREADABLE, e);
    let db = open_to_read(path).map_err(failed)?;
    if !is_geopackage(&db).map_err(failed)? {
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
pub(super) fn index_of(layer: &str) -> String {
    format!("rtree_{layer}_geom")
}

/// Whether the file is a GeoPackage. A file that is broken, or no database, is none.
fn is_geopackage(db: &Connection) -> rusqlite::Result<bool> {
    let tables = "SELECT count(*) FROM sqlite_master WHERE name IN ('gpkg_contents', 'gpkg_spatial_ref_sys')";
    match db.query_row(tables, [], |row| row.get::<_, i64>(0)) {
        Ok(count) => Ok(count == 2),
        Err(e) if is_about_access(&e) => Err(e),
        Err(_) => Ok(false),
    }
}

/// The id under which a file has, or can have, a coordinate reference system.
pub(crate) fn srs_id_in(path: &Path, row: &SrsRow) -> Result<i32> {
    let find = || -> rusqlite::Result<i32> {
        let db = open_to_read(path)?;
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
    find().map_err(|e| in_words(path, UNREADABLE, e))
}
