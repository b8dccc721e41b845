//! Height maps in: the file's name decides the reader, and what all readers check is here.
//!
//! A reader gives heights in metres with north up, whatever the file's way of keeping them. What a file leaves open
//! becomes a finding; what cannot be told becomes an error that says what to do.

use std::path::Path;

use super::{asc, exr, geotiff_read, like, png_read};
use crate::base::Grid;
use crate::base::error::{Error, Finding, FindingKind, Report, Result};
use crate::crs::Crs;
use crate::dem::Dem;
use crate::io::gsi::{self, GsiDem, Product};

/// The extensions [`read_dem`] knows, for messages and help texts.
pub const READABLE_EXTENSIONS: [&str; 5] = ["tif", "tiff", "asc", "exr", "png"];

/// A height map as it was read.
#[derive(Debug, Clone, PartialEq)]
pub struct DemFile {
    /// The heights.
    pub dem: Dem,
    /// The product of 基盤地図情報 that it is, if it is one.
    pub product: Option<Product>,
}

/// Reads a height map: GeoTIFF, ESRI ASCII grid, OpenEXR, 16-bit PNG, an elevation tile of the Geospatial Information
/// Authority of Japan (PNG), or its 基盤地図情報 (.xml, .zip or a folder of them, as one mosaic).
///
/// Heights come out as 32-bit floating point in metres, north up: 64-bit floating point and 32-bit whole numbers are
/// rounded to that, a scale and an offset that the file names are applied, feet become metres. Of several bands the
/// first is taken.
///
/// # Errors
/// An extension that is not in [`READABLE_EXTENSIONS`], a file that cannot be read, is broken or cut off, is a picture,
/// has no place on a map, is rotated, or claims more cells than its size could hold.
pub fn read_dem(path: &Path) -> Result<Report<DemFile>> {
    if gsi::is_source(path) {
        let Report { value: GsiDem { dem, product }, findings } = gsi::read_dem(path)?;
        return Ok(Report { value: DemFile { dem, product: Some(product) }, findings });
    }
    let read = match extension(path).as_str() {
        "tif" | "tiff" => geotiff_read::read,
        "asc" => asc::read,
        "exr" => exr::read,
        "png" => png_read::read,
        _ => return Err(unknown(path)),
    };
    check_file(path)?;
    let Report { value: dem, mut findings } = read(path)?;
    if dem.crs.is_none() {
        let message = "the height map does not name its coordinate reference system";
        findings.push(Finding::general(FindingKind::UnknownCrs, message));
    }
    Ok(Report { value: DemFile { dem, product: None }, findings })
}

/// Reads the standard errors that [`write_with_errors`](super::write_with_errors) put beside the heights; `None` if the file
/// has none, or is of a format that has no room for them.
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

/// The grid of a height map and its coordinate reference system, where it names one.
///
/// A raster that is stored with its south edge first gives the same cells with north up. Of a GeoTIFF only the header is
/// read: any kind of sample and compression will do.
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

fn extension(path: &Path) -> String {
    path.extension().and_then(|e| e.to_str()).unwrap_or_default().to_ascii_lowercase()
}

fn unknown(path: &Path) -> Error {
    let known = READABLE_EXTENSIONS.map(|e| format!(".{e}")).join(", ");
    Error::file(path, format!("is not a height map format that can be read; known are {known}"))
}

/// Refuses what is no file with something in it.
fn check_file(path: &Path) -> Result<()> {
    let meta = std::fs::metadata(path).map_err(|e| Error::io("read", path, e))?;
    if meta.is_dir() {
        return Err(Error::file(path, "is a folder; name a file in it"));
    }
    if meta.is_file() && meta.len() == 0 {
        return Err(Error::file(path, "the file is empty"));
    }
    Ok(())
}

/// Cells that a height map may have; the memory it takes is four bytes each.
const MOST_CELLS: u64 = 4_000_000_000;

/// Cells that a byte of a file can stand for. Rasters whose empty tiles are left out come nearest to it.
const CELLS_A_BYTE: u64 = 16_384;

/// Refuses a size that the file cannot hold: a header can claim any, and memory is taken for it.
pub(super) fn check_size(path: &Path, cols: u64, rows: u64, file_length: u64) -> Result<u64> {
    let cells = cols.checked_mul(rows).filter(|&cells| cells > 0 && cells <= MOST_CELLS);
    let Some(cells) = cells else {
        return Err(Error::file(
            path,
            format!("has {cols} x {rows} cells; a height map has one at least and {MOST_CELLS} at most. Cut it first"),
        ));
    };
    if cells / CELLS_A_BYTE > file_length {
        return Err(Error::file(
            path,
            format!("claims {cols} x {rows} cells, but is only {file_length} bytes long: the file is broken"),
        ));
    }
    Ok(cells)
}

/// Room for the heights of a raster of which so many bytes are there, all without data.
pub(super) fn room(path: &Path, cols: u64, rows: u64, file_length: u64) -> Result<Vec<f32>> {
    let cells = check_size(path, cols, rows, file_length)?;
    let mut values = Vec::new();
    match usize::try_from(cells) {
        Ok(count) if values.try_reserve_exact(count).is_ok() => {
            values.resize(count, f32::NAN);
            Ok(values)
        }
        _ => Err(Error::file(path, format!("has {cols} x {rows} cells, for which there is not enough memory"))),
    }
}

/// How stored values become heights.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Coding {
    /// The stored value of cells without data, if the file names one.
    pub nodata: Option<f64>,
    /// Metres a step.
    pub scale: f64,
    /// Height of the value 0, metres.
    pub offset: f64,
}

/// Marks of cells without data that files leave unnamed.
const USUAL_MARKS: [f64; 2] = [-9999.0, -32768.0];

/// Heights below or above, metres, are marks of some kind: no point of the Earth comes near.
const LOWEST: f64 = -20_000.0;
const HIGHEST: f64 = 100_000.0;

/// Turns stored values into heights and counts what is none.
pub(super) struct Heights {
    coding: Coding,
    /// Cells that were taken as cells without data, though the file does not say so.
    odd: u64,
    example: f64,
}

impl Heights {
    pub fn new(coding: Coding) -> Self {
        Self { coding, odd: 0, example: 0.0 }
    }

    /// The height of a stored value; NaN is no data.
    pub fn height(&mut self, stored: f64) -> f32 {
        let Coding { nodata, scale, offset } = self.coding;
        if stored.is_nan() || nodata == Some(stored) {
            return f32::NAN;
        }
        let height = stored * scale + offset;
        if !(LOWEST..=HIGHEST).contains(&height) || nodata.is_none() && USUAL_MARKS.contains(&stored) {
            (self.odd, self.example) = (self.odd + 1, stored);
            return f32::NAN;
        }
        height as f32
    }

    /// What was noticed.
    pub fn findings(self) -> Option<Finding> {
        let message = format!(
            "{} cells of the height map hold a value that is no height, such as {}; they are taken as cells without data",
            self.odd, self.example
        );
        (self.odd > 0).then(|| Finding::general(FindingKind::NoHeight, message))
    }
}

/// Metres in a unit of height by its name, and whether the name is known.
pub(super) fn metres_in(unit: &str) -> Option<f64> {
    match unit.trim().to_ascii_lowercase().as_str() {
        "" | "m" | "metre" | "meter" | "metres" | "meters" => Some(1.0),
        "ft" | "foot" | "feet" | "foot (international)" | "international foot" => Some(0.3048),
        "us-ft" | "ftus" | "us survey foot" | "foot_us" | "us survey feet" | "foot us" => Some(1200.0 / 3937.0),
        "dm" | "decimetre" | "decimeter" => Some(0.1),
        "cm" | "centimetre" | "centimeter" => Some(0.01),
        "mm" | "millimetre" | "millimeter" => Some(0.001),
        "km" | "kilometre" | "kilometer" => Some(1000.0),
        _ => None,
    }
}

/// The finding that heights were not in metres, or that their unit is unknown.
pub(super) fn unit_finding(unit: &str) -> Option<Finding> {
    let message = match metres_in(unit) {
        Some(1.0) => return None,
        Some(_) => format!("the heights are in {unit} and were turned into metres"),
        None => format!("the heights are in {unit:?}, which is not known; they are taken as metres"),
    };
    Some(Finding::general(FindingKind::HeightUnit, message))
}
