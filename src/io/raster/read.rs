//! Reads height maps. The file's extension decides the reader, and the path is checked here.
//!
//! A reader gives heights in metres with north up, however the file stores them. Missing information becomes a finding
//! if a default exists. Otherwise it is an error that says what to do.

use std::path::Path;
use std::sync::Arc;

use super::geotiff_read::Opened;
use super::{asc, exr, geotiff_read, like, png_read, xyz_read};
use crate::crs_finding::crs_finding;
use crate::gsi::{self, GsiDem, Product};
use crate::landxml::read_surface;
use crate::ordinary::open_to_read;
use tokosen_core::base::error::{Error, Finding, FindingKind, Report, Result};
use tokosen_core::base::{ElevationUnit, Grid};
use tokosen_core::crs::{Crs, HeightSystem};
use tokosen_core::raster::{Dem, RasterRows};

/// The extensions that [`read_dem`] accepts, for messages and help texts.
pub const READABLE_EXTENSIONS: [&str; 6] = ["tif", "tiff", "asc", "exr", "png", "xyz"];

/// A height map as it was read.
#[derive(Debug, Clone, PartialEq)]
pub struct DemFile {
    /// The heights.
    pub dem: Dem,
    /// The product of 基盤地図情報, if the file is one.
    pub product: Option<Product>,
    /// The height system, if the file names one.
    pub height_system: Option<HeightSystem>,
}

/// Reads a height map as 32-bit floating point, metres, north up.
///
/// The formats are GeoTIFF, ESRI ASCII grid, OpenEXR, XYZ, 16-bit PNG and elevation tile (PNG) of the Geospatial
/// Information Authority of Japan. Its 基盤地図情報 is read too: `.xml`, `.zip` or a folder of them, as one mosaic. Of a LandXML
/// surface, the triangles are read; a triangle of median size gets about four cells.
///
/// 64-bit floating point and 32-bit whole numbers are rounded to 32-bit floating point. Scale and offset of the file
/// are applied. Feet become metres, if the band states its unit (unit type, GeoTIFF key) or the vertical part of the
/// coordinate reference system does. If there are several bands, the first one is used.
///
/// # Errors
/// One of these is the case:
/// - The extension is not in [`READABLE_EXTENSIONS`].
/// - The file cannot be read, is broken or cut off.
/// - It is a picture, has no georeferencing or is rotated.
/// - It states more cells than its size can hold.
pub fn read_dem(path: &Path) -> Result<Report<DemFile>> {
    if gsi::is_source(path) {
        let Report { value: GsiDem { dem, product, height_system }, findings } = gsi::read_dem(path)?;
        return Ok(Report { value: DemFile { dem, product: Some(product), height_system }, findings });
    }
    let read = match extension(path).as_str() {
        "xml" => read_surface,
        "tif" | "tiff" => geotiff_read::read,
        "asc" => asc::read,
        "exr" => exr::read,
        "png" => png_read::read,
        "xyz" => xyz_read::read,
        _ => return Err(unknown(path)),
    };
    check_file(path)?;
    let Report { value: mut dem, mut findings } = read(path)?;
    let height_system = dem.crs.as_ref().and_then(Crs::height_system);
    // Heights are metres now.
    dem.crs = dem.crs.map(|crs| crs.with_heights_in(ElevationUnit::Metre));
    name_missing_crs(dem.crs.as_ref(), &mut findings);
    Ok(Report { value: DemFile { dem, product: None, height_system }, findings })
}

/// A height map whose rows are read on demand.
#[derive(Debug)]
pub struct DemRows {
    /// The heights.
    pub heights: Arc<dyn RasterRows>,
    /// The product of 基盤地図情報, if the file is one.
    pub product: Option<Product>,
    /// The height system, if the file names one.
    pub height_system: Option<HeightSystem>,
}

/// Opens a height map, of which the heights are as [`read_dem`] gives them. The rows of a GeoTIFF are read on demand. Files in
/// other formats are read whole.
///
/// # Errors
/// As [`read_dem`]. A broken part of a GeoTIFF is an error only when its rows are read.
pub fn open_dem(path: &Path) -> Result<Report<DemRows>> {
    if !matches!(extension(path).as_str(), "tif" | "tiff") || gsi::is_source(path) {
        let Report { value: DemFile { dem, product, height_system }, findings } = read_dem(path)?;
        return Ok(Report { value: DemRows { heights: Arc::new(dem), product, height_system }, findings });
    }
    check_file(path)?;
    let Opened { mut rows, mut findings, crs_problem } = geotiff_read::open(path, 0)?;
    let height_system = rows.crs.as_ref().and_then(Crs::height_system);
    rows.crs = rows.crs.map(|crs| crs.with_heights_in(ElevationUnit::Metre));
    findings.extend(crs_problem);
    name_missing_crs(rows.crs.as_ref(), &mut findings);
    Ok(Report { value: DemRows { heights: Arc::new(rows), product: None, height_system }, findings })
}

/// Adds the finding that there is no coordinate reference system. A reader that found a description of one, but could not use
/// it, has said so.
fn name_missing_crs(crs: Option<&Crs>, findings: &mut Vec<Finding>) {
    if findings.iter().all(|finding| finding.kind != FindingKind::UnknownCrs) {
        let missing = || "the height map does not name its coordinate reference system".to_owned();
        findings.extend(crs_finding(crs, missing));
    }
}

/// Reads the standard errors that [`write_with_errors`](super::write_with_errors) stores beside the heights. `None` if
/// the file has none, or if its format cannot hold them.
///
/// # Errors
/// As [`read_dem`].
pub fn read_standard_errors(path: &Path) -> Result<Option<Dem>> {
    match extension(path).as_str() {
        "tif" | "tiff" => geotiff_read::read_errors(path),
        "exr" => exr::read_errors(path),
        _ => Ok(None),
    }
}

/// The grid of a height map, and its coordinate reference system if the file names one.
///
/// A raster that is stored with its south edge first gives the same cells with north up. Of a GeoTIFF only the header
/// is read; any sample type and compression is accepted.
///
/// # Errors
/// As [`read_dem`].
pub fn read_grid(path: &Path) -> Result<(Grid, Option<Crs>)> {
    match extension(path).as_str() {
        "tif" | "tiff" => like::read_grid(path),
        "asc" => {
            check_file(path)?;
            asc::read_grid(path)
        }
        _ => {
            let dem = read_dem(path)?.value.dem;
            Ok((dem.grid, dem.crs))
        }
    }
}

pub(super) fn extension(path: &Path) -> String {
    path.extension().and_then(|e| e.to_str()).unwrap_or_default().to_ascii_lowercase()
}

fn unknown(path: &Path) -> Error {
    if extension(path) == "zip" {
        return Error::file(path, "the archive holds a shapefile and no height map");
    }
    let known = READABLE_EXTENSIONS.map(|e| format!(".{e}")).join(", ");
    let message = format!(
        "is not a height map format that can be read; known are {known}. Convert other formats with 'gdal_translate FILE out.tif'"
    );
    Error::file(path, message)
}

/// Refuses a folder, an empty file, and what is no ordinary file.
fn check_file(path: &Path) -> Result<()> {
    let meta = open_to_read(path)?.metadata().map_err(|e| Error::io("read", path, e))?;
    if meta.len() == 0 {
        return Err(Error::empty(path));
    }
    Ok(())
}
