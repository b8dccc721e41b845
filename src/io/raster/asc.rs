//! ESRI ASCII grids (`.asc`): a header of words and numbers, then the heights as text, row by row from the north.
//!
//! The coordinate reference system is in the `.prj` beside the file, a unit of heights other than the metre in
//! `.asc.aux.xml`, as GDAL reads it. Cells need not be square: then `dx` and `dy`
//! replace `cellsize`, as in GDAL.

use std::fs::File;
use std::io::{BufRead, BufReader, Write};
use std::path::Path;

use glam::DVec2;

use super::height_unit::height_unit;
use super::heights::{Coding, Heights, room};
use super::output::{create, write_text};
use super::pam::{self, Band};
use super::placement;
use super::quantity::Values;
use super::sidecar;
use crate::ordinary::open_to_read;
use crate::text;
use tokosen_core::base::Grid;
use tokosen_core::base::error::{Error, Report, Result};
use tokosen_core::crs::Crs;
use tokosen_core::raster::Dem;

/// The longest word that is accepted. Doubles written out in full have about 330 digits.
const MAX_WORD_LENGTH: usize = 512;

/// The nodata value of files that do not name theirs.
const USUAL_NODATA: f64 = -9999.0;

pub(super) fn read(path: &Path) -> Result<Report<Dem>> {
    let (header, mut words) = open(path)?;
    let grid = header.grid(path)?;
    let crs = sidecar::read_prj(path)?;
    let aux = sidecar::read_aux_xml(path)?.unwrap_or_default();
    let unit = height_unit([aux.unit.as_deref()], crs.as_ref());
    let mut values = room(path, grid.cols as u64, grid.rows as u64, words.length)?;
    let mut heights = Heights::new(Coding { nodata: Some(header.nodata), scale: unit.metres, offset: 0.0 });
    let place = |index: usize| format!("row {}, column {}", index / grid.cols + 1, index % grid.cols + 1);
    for (index, value) in values.iter_mut().enumerate() {
        let Some(word) = words.next(path)? else {
            let message = format!("is cut off: it ends before the height of {}", place(index));
            return Err(Error::file(path, message));
        };
        let Some(number) = parse(word) else {
            let word = String::from_utf8_lossy(word).into_owned();
            return Err(Error::file(path, format!("{word:?} at {} is not a number", place(index))));
        };
        *value = heights.height(number);
    }
    if words.next(path)?.is_some() {
        let message = format!("holds more heights than its {} rows of {} have cells", grid.rows, grid.cols);
        return Err(Error::file(path, message));
    }
    let findings = unit.finding.into_iter().chain(heights.finding()).collect();
    Ok(Report { value: Dem { grid, values, crs }, findings })
}

/// Reads only the grid, from the header.
pub(super) fn read_grid(path: &Path) -> Result<(Grid, Option<Crs>)> {
    Ok((open(path)?.0.grid(path)?, sidecar::read_prj(path)?))
}

/// A number as 64-bit floating point. A height with the digits of a 32-bit number gives exactly that number when it is
/// rounded back.
fn parse(word: &[u8]) -> Option<f64> {
    std::str::from_utf8(word).ok()?.parse().ok()
}

/// The words of a text, one at a time.
struct Words {
    input: BufReader<File>,
    /// Bytes of the file.
    length: u64,
    word: Vec<u8>,
    /// Whether the next call returns the same word again.
    again: bool,
    /// Bytes that were read.
    offset: u64,
}

impl Words {
    fn next(&mut self, path: &Path) -> Result<Option<&[u8]>> {
        if std::mem::take(&mut self.again) {
            return Ok(Some(&self.word));
        }
        self.word.clear();
        loop {
            let buffer = match self.input.fill_buf() {
                Ok(buffer) => buffer,
                Err(e) if e.kind() == std::io::ErrorKind::Interrupted => continue,
                Err(e) => return Err(Error::io("read", path, e)),
            };
            if buffer.is_empty() {
                return Ok((!self.word.is_empty()).then_some(&self.word));
            }
            // Spaces and control characters separate words; the end-of-file mark of old systems is one of them.
            let skipped = if self.word.is_empty() { buffer.iter().take_while(|&&b| b <= b' ').count() } else { 0 };
            text::without_zeros(path, &buffer[..skipped], self.offset)?;
            let rest = &buffer[skipped..];
            let length = rest.iter().position(|&b| b <= b' ').unwrap_or(rest.len());
            self.word.extend_from_slice(&rest[..length.min(MAX_WORD_LENGTH + 1)]);
            let is_whole = length < rest.len();
            self.offset += (skipped + length) as u64;
            self.input.consume(skipped + length);
            if self.word.len() > MAX_WORD_LENGTH {
                return Err(Error::file(path, "is not an ESRI ASCII grid, which holds words and numbers"));
            }
            if is_whole && !self.word.is_empty() {
                return Ok(Some(&self.word));
            }
        }
    }
}

/// The header, with its values as they are in the file.
struct Header {
    cols: u64,
    rows: u64,
    /// West and south: the number, and whether it belongs to a cell's centre instead of its corner.
    west: (f64, bool),
    south: (f64, bool),
    cell: DVec2,
    nodata: f64,
}

fn open(path: &Path) -> Result<(Header, Words)> {
    let file = open_to_read(path)?;
    let length = file.metadata().map_err(|e| Error::io("read", path, e))?.len();
    let mut words =
        Words { input: BufReader::with_capacity(1 << 18, file), length, word: Vec::new(), again: false, offset: 0 };
    let (mut cols, mut rows, mut west, mut south, mut dx, mut dy) = (None, None, None, None, None, None);
    let mut nodata = USUAL_NODATA;
    loop {
        let Some(word) = words.next(path)? else {
            return Err(Error::file(path, "is cut off in its header"));
        };
        let word = word.strip_prefix(b"\xef\xbb\xbf").unwrap_or(word);
        if parse(word).is_some() {
            words.again = true;
            break;
        }
        let key = String::from_utf8_lossy(word).to_ascii_lowercase();
        let number = words.next(path)?.and_then(parse);
        let Some(number) = number else {
            let key: String = key.chars().take(24).collect();
            let message = format!("is not an ESRI ASCII grid: no number follows {key:?} in its header");
            return Err(Error::file(path, message));
        };
        match key.as_str() {
            "ncols" => cols = Some(number),
            "nrows" => rows = Some(number),
            "xllcorner" => west = Some((number, false)),
            "xllcenter" => west = Some((number, true)),
            "yllcorner" => south = Some((number, false)),
            "yllcenter" => south = Some((number, true)),
            "cellsize" => (dx, dy) = (Some(number), Some(number)),
            "dx" => dx = Some(number),
            "dy" => dy = Some(number),
            "nodata_value" | "nodata" => nodata = number,
            _ => {
                let key: String = key.chars().take(24).collect();
                return Err(Error::file(path, format!("{key:?} is not a header word of an ESRI ASCII grid")));
            }
        }
    }
    let missing = |name: &str| Error::file(path, format!("is not an ESRI ASCII grid: its header has no {name}"));
    let whole = |number: f64, name: &str| {
        let is_count = number >= 1.0 && number <= f64::from(u32::MAX) && number.fract() == 0.0;
        let message = || Error::file(path, format!("{name} is {number} in its header, which is not a number of cells"));
        if is_count { Ok(number as u64) } else { Err(message()) }
    };
    let header = Header {
        cols: whole(cols.ok_or_else(|| missing("ncols"))?, "ncols")?,
        rows: whole(rows.ok_or_else(|| missing("nrows"))?, "nrows")?,
        west: west.ok_or_else(|| missing("xllcorner"))?,
        south: south.ok_or_else(|| missing("yllcorner"))?,
        cell: DVec2::new(dx.ok_or_else(|| missing("cellsize"))?, dy.ok_or_else(|| missing("cellsize"))?),
        nodata,
    };
    header.check_length(path, length)?;
    Ok((header, words))
}

impl Header {
    /// Refuses a file that is too short for its cells: a height takes at least a digit and a space.
    fn check_length(&self, path: &Path, length: u64) -> Result<()> {
        let (cols, rows) = (self.cols, self.rows);
        if cols.saturating_mul(rows) <= length / 2 + 1 {
            return Ok(());
        }
        let message = format!(
            "is cut off: {cols} x {rows} heights do not fit into its {length} bytes; copy or download it again"
        );
        Err(Error::file(path, message))
    }

    fn grid(&self, path: &Path) -> Result<Grid> {
        let (cell, rows) = (self.cell, self.rows as f64);
        if cell.is_nan() || cell.min_element() <= 0.0 {
            return Err(Error::file(path, format!("has cells of {} x {}, which is not a valid grid", cell.x, cell.y)));
        }
        let half = |(number, is_center): (f64, bool), cell: f64| if is_center { number - cell / 2.0 } else { number };
        let origin = DVec2::new(half(self.west, cell.x), half(self.south, cell.y) + rows * cell.y);
        let size = (self.cols as usize, self.rows as usize);
        placement::north_up(origin, DVec2::new(cell.x, 0.0), DVec2::new(0.0, -cell.y), size)
            .map(|placed| placed.grid)
            .map_err(|message| Error::file(path, message))
    }
}

/// Writes `dem` to `path`, and `.prj` beside it if the coordinate reference system is known. Feet are stated in
/// `.asc.aux.xml`.
pub(super) fn write(path: &Path, dem: &Dem, values: Values) -> Result<()> {
    let Grid { corner, cell, cols, rows } = dem.grid;
    let nodata = free_mark(&dem.values);
    create(path, |out| {
        writeln!(out, "ncols {cols}\nnrows {rows}")?;
        writeln!(out, "xllcorner {}\nyllcorner {}", corner.x, corner.y - rows as f64 * cell.y)?;
        if cell.x == cell.y {
            writeln!(out, "cellsize {}", cell.x)?;
        } else {
            writeln!(out, "dx {}\ndy {}", cell.x, cell.y)?;
        }
        writeln!(out, "NODATA_value {nodata}")?;
        for row in dem.values.chunks_exact(cols) {
            for (col, height) in row.iter().enumerate() {
                let space = if col == 0 { "" } else { " " };
                // The shortest digits that give the same 32-bit height again. They keep their decimal point; without it
                // readers would treat the whole map as integers.
                if height.is_finite() { write!(out, "{space}{height:?}")? } else { write!(out, "{space}{nodata}")? }
            }
            out.write_all(b"\n")?;
        }
        Ok(())
    })?;
    if values.factor().is_some() {
        let band = Band { name: values.name(), unit: values.unit(), offset: 0.0, scale: 1.0, nodata: None };
        pam::write_aux_xml(path, dem, &[band])?;
    }
    match dem.crs.as_ref().and_then(|crs| crs.wkt1().or(crs.wkt())) {
        Some(wkt) => write_text(&path.with_extension("prj"), wkt),
        None => Ok(()),
    }
}

/// A nodata value that is not a height of the map: -9999, or a number with more nines.
fn free_mark(values: &[f32]) -> i64 {
    let mut marks = (4..8).map(|digits| 1 - 10_i64.pow(digits));
    let is_free = |mark: &i64| !values.contains(&(*mark as f32));
    marks.find(is_free).unwrap_or(-99_999_999)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn zero_bytes_are_no_space_between_words() {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("a.asc");
        let start = "ncols 2\nnrows 1\nxllcorner 0\nyllcorner 0\ncellsize 1\n1 ";
        for (text, at) in [("\0\0\0".to_owned(), 1), (format!("{start}\0 2\n"), start.len() + 1)] {
            std::fs::write(&path, text).unwrap();
            let said = read(&path).unwrap_err().to_string();
            assert!(said.contains(&format!("its byte {at} is zero")), "{said}");
        }
        std::fs::write(&path, format!("{start}2\n")).unwrap();
        assert_eq!(read(&path).unwrap().value.values, [1.0, 2.0]);
    }
}
