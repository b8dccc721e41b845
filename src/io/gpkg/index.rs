//! The spatial index of a layer: it shows which features may meet a box, without reading the others.

use rusqlite::{Connection, params_from_iter};

use super::quoted::quoted;

/// The index of a layer whose rows have the key `key`, if it can be trusted: it is sound, and each feature with a geometry has an
/// entry. A program that does not know the index may have added features. Its boxes are believed, as other programs do. Both looks
/// take a fraction of the time for the features themselves.
pub(super) fn sound_index(db: &Connection, layer: &str, geometry: &str, key: &str) -> Option<String> {
    let name = format!("rtree_{layer}_{geometry}");
    let (table, geometry, index) = (quoted(layer), quoted(geometry), quoted(&name));
    let entries = quoted(&format!("{name}_rowid"));
    let sound = format!("SELECT rtreecheck(?1) = 'ok' AND EXISTS (SELECT minx, maxx, miny, maxy FROM {index})");
    let lost = format!("{geometry} IS NOT NULL AND {key} NOT IN (SELECT rowid FROM {entries})");
    let complete = format!("SELECT NOT EXISTS (SELECT 1 FROM {table} WHERE {lost})");
    let holds = |sql: &str, given: &[&str]| {
        db.query_row(sql, params_from_iter(given), |row| row.get::<_, bool>(0)).unwrap_or(false)
    };
    (holds(&sound, &[&name]) && holds(&complete, &[])).then_some(index)
}
