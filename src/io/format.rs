//! The vector formats and their file extensions: those that are read and written, and those that are only read.

use std::path::Path;

use tokosen_core::base::error::{Error, Result};

/// A vector format.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum VectorFormat {
    /// `.geojson`, `.json`
    GeoJson,
    /// `.gpkg`
    GeoPackage,
    /// `.fgb`
    FlatGeobuf,
    /// `.parquet`
    GeoParquet,
    /// `.dxf`
    Dxf,
    /// `.shp` with its companions
    Shapefile,
    /// `.kml`, and `.kmz` with one in it
    Kml,
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
            "parquet" | "geoparquet" => Ok(Self::GeoParquet),
            "dxf" => Ok(Self::Dxf),
            "shp" => Ok(Self::Shapefile),
            "kml" | "kmz" => Ok(Self::Kml),
            _ => Err(Error::file(
                path,
                "the file's extension does not name a vector format that is written; known are .geojson and .json (GeoJSON), \
                 .gpkg (GeoPackage), .fgb (FlatGeobuf), .parquet (GeoParquet), .dxf (DXF), .shp (shapefile), .kml and .kmz (KML)",
            )),
        }
    }
}

/// A format that is read.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum InputFormat {
    /// A format that is written too.
    Written(VectorFormat),
    /// GeoJSON text sequence, or a text per line: `.geojsonl`, `.geojsons`, `.ndjson`.
    GeoJsonSequence,
    /// `.gml`
    Gml,
    /// LandXML `.xml`. Other documents are 基盤地図情報
    LandXml,
    /// `.csv`, `.tsv` with geometries as well-known text
    Text,
    /// `.zip` with a shapefile in it, also called `.shp.zip`
    ZippedShapefile,
}

impl InputFormat {
    /// The format of a file, by its extension. A `.zip` is not looked into.
    ///
    /// # Errors
    /// The extension is not known. The message lists the known ones, and says how other formats are converted.
    pub fn from_path(path: &Path) -> Result<Self> {
        if let Ok(format) = VectorFormat::from_path(path) {
            return Ok(Self::Written(format));
        }
        let extension = path.extension().and_then(|e| e.to_str()).unwrap_or_default().to_ascii_lowercase();
        match extension.as_str() {
            "geojsonl" | "geojsons" | "geojsonseq" | "ndjson" => Ok(Self::GeoJsonSequence),
            "gml" => Ok(Self::Gml),
            "xml" => Ok(Self::LandXml),
            "csv" | "tsv" => Ok(Self::Text),
            "zip" => Ok(Self::ZippedShapefile),
            _ if has_layer_of_another_program(path) => Err(Error::file(
                path,
                "a layer of a file is named with |layername=, as in 'all.gpkg|layername=contours'",
            )),
            _ => Err(Error::file(
                path,
                "the file's extension does not name a vector format that is read; known are .geojson and .json (GeoJSON), \
                 .gpkg (GeoPackage), .fgb (FlatGeobuf), .parquet (GeoParquet), .dxf (DXF), .shp (shapefile; also in a .zip), .geojsonl and .geojsons \
                 (GeoJSON text sequence), .kml and .kmz (KML), .gml (GML), .xml (LandXML), .csv and .tsv (well-known text); \
                 folders, .zip and other .xml are read as 基盤地図情報. Convert other formats with 'ogr2ogr out.gpkg FILE'",
            )),
        }
    }
}

/// Whether a path is that of a file with a layer behind it, as some programs write it: `all.gpkg:contours`.
fn has_layer_of_another_program(path: &Path) -> bool {
    let parts = path.to_str().and_then(|text| text.rsplit_once([':', ',', ';', '#', '@']));
    parts.is_some_and(|(file, _)| VectorFormat::from_path(Path::new(file)).is_ok())
}
