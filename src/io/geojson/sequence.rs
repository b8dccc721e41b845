//! Reads sequences of GeoJSON texts: one feature or geometry a line (`.geojsonl`), or after a record separator each
//! (`.geojsons`, RFC 8142).

use std::path::Path;

use serde::de::{DeserializeSeed, IgnoredAny};

use super::read::{ObjectSeed, add_feature, is_feature, set_crs, wrong};
use crate::table::{Request, Table};
use crate::text;
use tokosen_core::base::error::{Error, Result};

/// The byte before each text of a sequence.
const RECORD_SEPARATOR: u8 = 0x1e;

/// Reads a sequence. Its texts are numbered from 0.
pub(crate) fn read_sequence(path: &Path, request: &Request<'_>) -> Result<Table> {
    let bytes = text::read(path, request.memory, |_| None)?;
    let bytes = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(&bytes);
    let mut table = Table::new(request);
    let (mut number, mut crs) = (0, None);
    for record in bytes.split(|&byte| byte == RECORD_SEPARATOR) {
        let mut rest = record.trim_ascii();
        while !rest.is_empty() {
            // A text ends where its object does; the next may follow on the same line.
            let mut texts = serde_json::Deserializer::from_slice(rest).into_iter::<IgnoredAny>();
            let at = |error: Error| {
                let Error::File { path, message, source } = error else { return error };
                Error::File { path, message: format!("the text {number} of the sequence: {message}"), source }
            };
            match texts.next() {
                Some(Ok(_)) => {}
                Some(Err(error)) => return Err(at(wrong(path, error))),
                None => break,
            }
            let end = texts.byte_offset();
            let mut json = serde_json::Deserializer::from_slice(&rest[..end]);
            let root = ObjectSeed { table: &mut table, is_root: true };
            let mut root = root.deserialize(&mut json).map_err(|e| at(wrong(path, e)))?;
            match root.kind.as_deref() {
                Some(kind) if is_feature(kind) => {}
                other => {
                    let shown = other.unwrap_or("without a type");
                    let message = format!("the object is {shown:?}; a sequence holds features or geometries");
                    return Err(at(Error::file(path, message)));
                }
            }
            crs = crs.or(root.crs.take());
            add_feature(root, number, &mut table);
            number += 1;
            rest = rest[end..].trim_ascii_start();
        }
    }
    if number == 0 {
        return Err(Error::empty(path));
    }
    set_crs(crs, &mut table);
    Ok(table)
}
