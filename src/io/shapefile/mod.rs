//! Shapefile (Esri technical description, 1998): geometry in `.shp`, its index in `.shx`, attributes in `.dbf`, the
//! coordinate reference system in `.prj`, the encoding of text in `.cpg`.

mod dbf;
pub(super) mod encoding;
mod polygon;
mod read;
mod write;

pub(super) use polygon::grouped;
pub(super) use read::read;
pub(super) use write::write;

use std::path::{Path, PathBuf};

/// The companion of a `.shp` with this extension, as it is spelled on the disk: in lower case, in capitals, or as it
/// would be written new.
fn companion(shp: &Path, extension: &str) -> PathBuf {
    let lower = shp.with_extension(extension);
    let upper = shp.with_extension(extension.to_ascii_uppercase());
    if !lower.exists() && upper.exists() { upper } else { lower }
}
