//! The vector formats and their file extensions.

use std::path::Path;

use crate::base::error::{Error, Result};

/// A vector format.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum VectorFormat {
    /// `.geojson`, `.json`
    GeoJson,
    /// `.gpkg`
    GeoPackage,
    /// `.fgb`
    FlatGeobuf,
    /// `.dxf`
    Dxf,
    /// `.shp` with its companions
    Shapefile,
}

impl VectorFormat {
    /// The format of a file, by its extension.
    ///
    /// # Errors
    /// The extension is not known. The message lists the known ones.
    pub fn from_path(path: &Path) -> Result<Self> {
        let extension = path.extension().and_then(|e| e.to_str()).unwrap_or_default().to_ascii_lowercase();
        match extension.as_str() {
            "geojson" | "json" => Ok(Self::GeoJson),
            "gpkg" => Ok(Self::GeoPackage),
            "fgb" => Ok(Self::FlatGeobuf),
            "dxf" => Ok(Self::Dxf),
            "shp" => Ok(Self::Shapefile),
            _ => Err(Error::file(
                path,
                "the file's extension does not name a vector format; known are .geojson and .json (GeoJSON), \
                 .gpkg (GeoPackage), .fgb (FlatGeobuf), .dxf (DXF) and .shp (shapefile); folders, .zip and .xml are read as 基盤地図情報",
            )),
        }
    }
}
