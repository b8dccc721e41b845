//! Converts stored values into heights: possible sizes, scales and nodata values.

use std::path::Path;

use tokosen_core::base::error::{Error, Finding, FindingKind, Result};
use tokosen_core::raster::uniform;

/// The largest number of cells of a height map; each takes four bytes of memory.
const MAX_CELLS: u64 = 4_000_000_000;

/// The largest number of cells per byte of a file. Rasters with missing empty tiles come close to it.
const CELLS_PER_BYTE: u64 = 16_384;

/// Refuses a size that the file cannot hold. A header can state any size, and memory is allocated for it.
pub(super) fn check_size(path: &Path, cols: u64, rows: u64, file_length: u64) -> Result<u64> {
    let cells = cols.checked_mul(rows).filter(|&cells| cells > 0 && cells <= MAX_CELLS);
    let Some(cells) = cells else {
        return Err(Error::file(
            path,
            format!("has {cols} x {rows} cells; a height map has at least one and at most {MAX_CELLS}. Clip it first"),
        ));
    };
    if cells / CELLS_PER_BYTE > file_length {
        return Err(Error::file(
            path,
            format!("claims {cols} x {rows} cells, but is only {file_length} bytes long: the file is broken"),
        ));
    }
    Ok(cells)
}

/// Allocates the heights of a raster, all without data. `file_length` limits the size.
pub(super) fn room(path: &Path, cols: u64, rows: u64, file_length: u64) -> Result<Vec<f32>> {
    let cells = check_size(path, cols, rows, file_length)?;
    let values = usize::try_from(cells).ok().and_then(|count| uniform(count, f32::NAN).ok());
    values.ok_or_else(|| Error::file(path, format!("has {cols} x {rows} cells, for which there is not enough memory")))
}

/// How stored values become heights.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Coding {
    /// The stored value that means no data, if the file names one.
    pub nodata: Option<f64>,
    /// Metres per step.
    pub scale: f64,
    /// Height of the value 0, metres.
    pub offset: f64,
}

/// Nodata values that files often do not declare.
const USUAL_MARKS: [f64; 2] = [-9999.0, -32768.0];

/// Values outside this range, metres, cannot be heights on Earth; they mark cells without data.
const LOWEST: f64 = -20_000.0;
const HIGHEST: f64 = 100_000.0;

/// Converts stored values into heights and counts the values that are not heights.
pub(super) struct Heights {
    coding: Coding,
    /// Cells treated as cells without data, though the file does not say so.
    odd: u64,
    example: f64,
}

impl Heights {
    pub fn new(coding: Coding) -> Self {
        Self { coding, odd: 0, example: 0.0 }
    }

    /// The height of a stored value; NaN means no data.
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

    /// The finding about the undeclared nodata values so far, if there were any.
    pub fn finding(&self) -> Option<Finding> {
        let message = format!(
            "{} cells of the height map hold a value that is not a height, such as {}; they are taken as cells without data",
            self.odd, self.example
        );
        (self.odd > 0).then(|| Finding::general(FindingKind::NoHeight, message))
    }
}
