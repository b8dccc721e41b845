//! What a file is for a verb that takes both height maps and contours.

use std::path::Path;

use super::format::VectorFormat;
use super::gsi;
use super::raster::READABLE_EXTENSIONS;
use crate::base::error::{Error, Result};

/// What can be read from a path.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Content {
    /// A height map, see [`read_dem`](super::raster::read_dem).
    HeightMap,
    /// Contour lines, see [`read_contours`](super::read_contours).
    Contours,
}

/// Tells height maps from contours: by the extension, and for documents, archives and folders of 基盤地図情報 by what is in
/// them. Where both are there, contours count.
///
/// # Errors
/// If the extension is none of the known ones, or if an archive or folder cannot be looked into.
pub fn content(path: &Path) -> Result<Content> {
    let extension = path.extension().and_then(|e| e.to_str()).unwrap_or_default().to_ascii_lowercase();
    if gsi::is_source(path) {
        return Ok(if gsi::is_height_map(path)? { Content::HeightMap } else { Content::Contours });
    }
    if READABLE_EXTENSIONS.contains(&extension.as_str()) {
        return Ok(Content::HeightMap);
    }
    VectorFormat::from_path(path).map(|_| Content::Contours).map_err(|_| {
        let heights = READABLE_EXTENSIONS.map(|e| format!(".{e}")).join(", ");
        let message = format!(
            "is neither a height map ({heights}) nor contour lines (.gpkg, .geojson, .json, .shp, .fgb, .dxf), nor a .xml, .zip or \
             folder of 基盤地図情報"
        );
        Error::file(path, message)
    })
}
