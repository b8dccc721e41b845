//! The parts that all raster writers share: checks, creation of files, placement.

use std::fs::File;
use std::io::{BufWriter, Write};
use std::path::{Path, PathBuf};

use tokosen_core::base::Grid;
use tokosen_core::base::error::{Cause, Error, Result};
use tokosen_core::raster::Dem;

/// Refuses a height map that no format can hold.
pub(super) fn check(path: &Path, dem: &Dem) -> Result<()> {
    let Grid { cols, rows, .. } = dem.grid;
    if cols.checked_mul(rows) != Some(dem.values.len()) || dem.values.is_empty() {
        return Err(Error::Parameter(format!(
            "{}: a height map of {cols} x {rows} cells cannot have {} values",
            path.display(),
            dem.values.len()
        )));
    }
    check_grid(path, &dem.grid)
}

/// Refuses cells that no format can hold.
pub(super) fn check_grid(path: &Path, &Grid { corner, cell, cols, rows }: &Grid) -> Result<()> {
    if !(corner.is_finite() && cell.is_finite() && cell.min_element() > 0.0) {
        return Err(Error::Parameter(format!(
            "{}: cells of {} x {} at {}, {} are not a valid grid",
            path.display(),
            cell.x,
            cell.y,
            corner.x,
            corner.y
        )));
    }
    // The binary formats count columns and rows in 32 bits. The limit of EXR is a quarter of that range.
    if cols.max(rows) > i32::MAX as usize / 2 {
        return Err(Error::file(path, format!("{cols} x {rows} cells are more than the format can count")));
    }
    Ok(())
}

/// Creates `path`, lets `fill` write to it through a buffer, and flushes the buffer.
///
/// `fill` returns the operating system's errors as [`Filled::Io`]: then the message can name a full disk.
pub(super) fn create(
    path: &Path,
    fill: impl FnOnce(&mut BufWriter<File>) -> std::result::Result<(), Filled>,
) -> Result<()> {
    let file = File::create(path).map_err(|e| Error::io("create", path, e))?;
    let mut out = BufWriter::with_capacity(1 << 20, file);
    let filled = fill(&mut out).and_then(|()| out.flush().map_err(Filled::Io));
    filled.map_err(|error| match error {
        Filled::Io(source) => Error::io("write", path, source),
        Filled::Format(cause) => Error::file_cause(path, "cannot be written", cause),
        Filled::Values(error) => error,
    })
}

/// Why a file could not be filled.
pub(super) enum Filled {
    /// The operating system reported an error.
    Io(std::io::Error),
    /// The format's library reported an error.
    Format(Cause),
    /// The values could not be read.
    Values(Error),
}

impl From<std::io::Error> for Filled {
    fn from(error: std::io::Error) -> Self {
        Self::Io(error)
    }
}

/// The affine placement in GDAL's order: x of the corner, cell width, 0, y of the corner, 0, minus the cell height.
pub(super) fn geo_transform(grid: &Grid) -> [f64; 6] {
    [grid.corner.x, grid.cell.x, 0.0, grid.corner.y, 0.0, -grid.cell.y]
}

/// `path` with `suffix` appended to its whole name, as in `dem.png` + `.aux.xml`.
pub(super) fn beside(path: &Path, suffix: &str) -> PathBuf {
    let mut name = path.as_os_str().to_owned();
    name.push(suffix);
    name.into()
}

/// Writes a small text file.
pub(super) fn write_text(path: &Path, text: &str) -> Result<()> {
    create(path, |out| Ok(out.write_all(text.as_bytes())?))
}
