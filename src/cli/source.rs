//! Vector files on the command line, with a layer if one is named: `all.gpkg|layername=Lakes`.

use std::ffi::OsString;

use clap::builder::{OsStringValueParser, TypedValueParser};
use tokosen::io::VectorSource;

/// The parser of an argument that names a vector file.
pub fn source() -> impl TypedValueParser<Value = VectorSource> {
    OsStringValueParser::new().try_map(|text: OsString| match text.to_str() {
        Some("") => Err("it must be the name of a file".to_owned()),
        Some(text) => VectorSource::from_text(text),
        None => Ok(text.into()),
    })
}
