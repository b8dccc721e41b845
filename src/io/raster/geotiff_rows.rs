//! The heights of a GeoTIFF, some rows at a time.
//!
//! The strips or tiles that share rows are decoded together. Two such rows of them stay in memory. So each is decoded once where
//! blocks of rows are read one after the other, with the row above and the row below each block.

use std::fmt;
use std::fs::File;
use std::io::BufReader;
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};

use tiff::decoder::{Decoder, DecodingResult};

use super::chunks::Chunks;
use super::heights::{Coding, Heights};
use super::like::{self, Tiff};
use super::placement::Placement;
use super::zstd::{self, Storage};
use tokosen_core::base::Grid;
use tokosen_core::base::error::{Error, Finding, Result};
use tokosen_core::crs::Crs;
use tokosen_core::raster::{RasterRows, reserve};

/// How the values of a band are stored.
#[derive(Debug, Clone, Copy)]
pub(super) struct Stored {
    /// The band, counted from 0.
    pub band: usize,
    /// Values per cell that are interleaved.
    pub samples: usize,
    pub sample_bytes: usize,
    pub coding: Coding,
    pub zstd: Option<Storage>,
}

/// A band of a GeoTIFF.
pub(super) struct GeoTiffRows {
    path: PathBuf,
    placement: Placement,
    pub crs: Option<Crs>,
    /// Bytes of the file.
    pub length: u64,
    chunks: Chunks,
    stored: Stored,
    state: Mutex<State>,
}

/// What reading changes.
struct State {
    decoder: Decoder<BufReader<File>>,
    decoded: DecodingResult,
    /// The rows of strips or tiles that were used last, and their heights. The latest comes first.
    held: [(Option<usize>, Vec<f32>); 2],
    /// The values that are no heights, and which rows of strips or tiles were searched for them.
    odd: Heights,
    is_searched: Vec<bool>,
}

impl GeoTiffRows {
    pub fn new(path: &Path, tiff: Tiff, chunks: Chunks, stored: Stored) -> Self {
        let Tiff { decoder, placement, crs, length, .. } = tiff;
        let state = State {
            decoder: decoder.with_limits(chunks.limits(length)),
            decoded: DecodingResult::U8(Vec::new()),
            held: Default::default(),
            odd: Heights::new(stored.coding),
            is_searched: vec![false; placement.grid.rows.div_ceil(chunks.size.1)],
        };
        Self { path: path.to_owned(), placement, crs, length, chunks, stored, state: Mutex::new(state) }
    }

    /// The rows of the grid that a row of strips or tiles covers.
    fn rows_of(&self, chunk_row: usize) -> Range<usize> {
        let rows = self.placement.grid.rows;
        let start = chunk_row * self.chunks.size.1;
        let end = rows.min(start + self.chunks.size.1);
        if self.placement.south_up { rows - end..rows - start } else { start..end }
    }

    /// The heights of a row of strips or tiles.
    fn heights<'a>(&self, state: &'a mut State, chunk_row: usize) -> Result<&'a [f32]> {
        if state.held[0].0 != Some(chunk_row) {
            state.held.swap(0, 1);
        }
        if state.held[0].0 != Some(chunk_row) {
            let mut heights = std::mem::take(&mut state.held[0]).1;
            let cells = self.rows_of(chunk_row).len() * self.placement.grid.cols;
            reserve(&mut heights, cells).map_err(|error| error.in_file(&self.path))?;
            heights.resize(cells, f32::NAN);
            self.decode(state, chunk_row, &mut heights)?;
            state.held[0] = (Some(chunk_row), heights);
        }
        Ok(&state.held[0].1)
    }

    /// Decodes a row of strips or tiles.
    fn decode(&self, state: &mut State, chunk_row: usize, heights: &mut [f32]) -> Result<()> {
        let Chunks { size, across, are_tiles, ref ranges, .. } = self.chunks;
        let Stored { band, samples, sample_bytes, coding, zstd } = self.stored;
        let (path, cols, count) = (&self.path, self.placement.grid.cols, self.chunks.count());
        let covered = self.rows_of(chunk_row);
        heights.fill(f32::NAN);
        // The decoder aborts if it finds no memory. A whole map may be one strip.
        reserve(&mut Vec::<u8>::new(), size.0 * size.1 * samples * sample_bytes).map_err(|e| e.in_file(path))?;
        let State { decoder, decoded, odd, is_searched, .. } = state;
        let mut again = Heights::new(coding);
        let odd = if std::mem::replace(&mut is_searched[chunk_row], true) { &mut again } else { odd };
        // Tiles at the border are decoded with their padding, in one call of the decompressor. Without the padding there
        // would be one call per row, which the LZW decompressor sometimes answers with an error.
        let stride = size.0 * samples;
        for col in 0..across {
            let index = (chunk_row * across + col) as u32;
            if ranges[index as usize] == (0, 0) {
                continue;
            }
            let message = format!("part {} of {count} cannot be decoded; the file is broken", index + 1);
            // Bands are stored one after the other, or interleaved.
            let (skipped, beside) = if samples == 1 { (band as u32 * count, 0) } else { (0, band.min(samples - 1)) };
            let (width, height) = decoder.chunk_data_dimensions(index);
            let (width, height) = (width as usize, height as usize);
            match zstd {
                // Only this program writes a second band, and never with this compression.
                Some(storage) if skipped == 0 => {
                    // Tiles are stored whole, strips as far as the map reaches.
                    let rows = if are_tiles { size.1 } else { height };
                    let range = ranges[index as usize];
                    *decoded = zstd::unpack(decoder.inner(), range, (size.0, rows), storage)
                        .map_err(|why| Error::file(path, format!("part {} of {count}: {why}", index + 1)))?;
                }
                _ => decoder
                    .read_chunk_to_buffer(decoded, index + skipped, stride * sample_bytes)
                    .map_err(|e| like::wrong(path, &unsupported(&e, message), e))?,
            }
            for line in 0..height {
                let row = self.placement.row(chunk_row * size.1 + line) - covered.start;
                let start = row * cols + col * size.0;
                copy(decoded, line * stride + beside, samples, &mut heights[start..start + width], odd);
            }
        }
        Ok(())
    }
}

impl RasterRows for GeoTiffRows {
    fn grid(&self) -> Grid {
        self.placement.grid
    }

    fn crs(&self) -> Option<&Crs> {
        self.crs.as_ref()
    }

    fn read(&self, first: usize, heights: &mut [f32]) -> Result<()> {
        let cols = self.placement.grid.cols;
        let mut state = self.state.lock().unwrap_or_else(PoisonError::into_inner);
        let state = &mut *state;
        let (mut row, mut left) = (first, heights);
        while !left.is_empty() {
            let chunk_row = self.placement.row(row) / self.chunks.size.1;
            let covered = self.rows_of(chunk_row);
            let count = (covered.end - row).min(left.len() / cols);
            let (out, rest) = left.split_at_mut(count * cols);
            let start = (row - covered.start) * cols;
            out.copy_from_slice(&self.heights(state, chunk_row)?[start..start + out.len()]);
            (row, left) = (row + count, rest);
        }
        Ok(())
    }

    fn findings(&self) -> Vec<Finding> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner).odd.finding().into_iter().collect()
    }
}

impl fmt::Debug for GeoTiffRows {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("GeoTiffRows")
            .field("path", &self.path)
            .field("grid", &self.placement.grid)
            .finish_non_exhaustive()
    }
}

/// A clearer message for an unknown compression.
fn unsupported(error: &tiff::TiffError, message: String) -> String {
    match error {
        tiff::TiffError::UnsupportedError(_) => {
            "holds its values in a way that cannot be read (LERC or JPEG, for instance); rewrite it, for example \
             with 'gdal_translate -co COMPRESS=DEFLATE in.tif out.tif'"
                .into()
        }
        _ => message,
    }
}

/// Copies one line of a band.
fn copy(decoded: &DecodingResult, start: usize, samples: usize, out: &mut [f32], heights: &mut Heights) {
    fn each<T: Copy>(
        from: &[T],
        (start, samples): (usize, usize),
        out: &mut [f32],
        heights: &mut Heights,
        number: impl Fn(T) -> f64,
    ) {
        let line = from.get(start..).unwrap_or_default().iter().step_by(samples);
        for (out, &value) in out.iter_mut().zip(line) {
            *out = heights.height(number(value));
        }
    }
    let at = (start, samples);
    match decoded {
        DecodingResult::U8(from) => each(from, at, out, heights, f64::from),
        DecodingResult::U16(from) => each(from, at, out, heights, f64::from),
        DecodingResult::U32(from) => each(from, at, out, heights, f64::from),
        DecodingResult::U64(from) => each(from, at, out, heights, |v| v as f64),
        DecodingResult::I8(from) => each(from, at, out, heights, f64::from),
        DecodingResult::I16(from) => each(from, at, out, heights, f64::from),
        DecodingResult::I32(from) => each(from, at, out, heights, f64::from),
        DecodingResult::I64(from) => each(from, at, out, heights, |v| v as f64),
        DecodingResult::F16(from) => each(from, at, out, heights, |v| v.to_f64()),
        DecodingResult::F32(from) => each(from, at, out, heights, f64::from),
        DecodingResult::F64(from) => each(from, at, out, heights, |v| v),
    }
}
