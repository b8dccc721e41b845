//! The coordinate reference system that travels from the input to every output.

/// A coordinate reference system, by its EPSG code, its WKT, or both.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Crs {
    /// EPSG code, if known.
    pub epsg: Option<u32>,
    /// Well-known text (OGC WKT 1 or what the input had), if known.
    pub wkt: Option<String>,
}
