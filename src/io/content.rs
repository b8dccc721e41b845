//! Decides whether a file is a height map or contours, for commands that take both.

use std::path::Path;

use super::format::InputFormat;
use super::gsi;
use super::landxml::is_landxml_surface;
use super::raster::READABLE_EXTENSIONS;
use tokosen_core::base::error::{Error, Result};

/// What a path contains.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Content {
    /// A height map, see [`read_dem`](super::raster::read_dem).
    HeightMap,
    /// Contour lines, see [`read_contours`](super::read_contours).
    Contours,
}

/// Decides between a height map and contours. The extension decides; for documents, archives and folders of 基盤地図情報 the
/// content decides, and for LandXML. If both are present, the answer is contours.
///
/// # Errors
/// The extension is not known, or an archive or folder cannot be read.
pub fn content(path: &Path) -> Result<Content> {
    let extension = path.extension().and_then(|e| e.to_str()).unwrap_or_default().to_ascii_lowercase();
    if gsi::is_source(path) {
        return Ok(if gsi::is_height_map(path)? { Content::HeightMap } else { Content::Contours });
    }
    if is_landxml_surface(path)? {
        return Ok(Content::HeightMap);
    }
    if READABLE_EXTENSIONS.contains(&extension.as_str()) {
        return Ok(Content::HeightMap);
    }
    InputFormat::from_path(path).map(|_| Content::Contours).map_err(|_| {
        let heights = READABLE_EXTENSIONS.map(|e| format!(".{e}")).join(", ");
        let message = format!(
            "is neither a height map ({heights}) nor contour lines (.gpkg, .geojson, .json, .shp, .fgb, .parquet, .dxf, .geojsonl, .kml, \
             .kmz, .gml, .csv, a zipped .shp), nor a .xml, .zip or folder of 基盤地図情報. Convert other formats with \
             'gdal_translate FILE out.tif' or 'ogr2ogr out.gpkg FILE'"
        );
        Error::file(path, message)
    })
}
