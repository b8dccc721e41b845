//! The strips or tiles of a GeoTIFF, and where they are in the file.

use std::path::Path;

use tiff::decoder::{ChunkType, Limits};
use tiff::tags::Tag;

use super::heights::check_size;
use super::like::{self, Tiff};
use tokosen_core::base::error::{Error, Result};

/// The strips or tiles of the first band.
#[derive(Debug)]
pub(super) struct Chunks {
    /// Width and height of a complete strip or tile, cells.
    pub size: (usize, usize),
    pub are_tiles: bool,
    pub across: usize,
    /// Offset and length in the file. Both are zero for missing ones.
    pub ranges: Vec<(u64, u64)>,
    /// Bytes of a complete strip or tile in memory.
    bytes: u64,
}

impl Chunks {
    pub fn of(path: &Path, tiff: &mut Tiff, samples: usize) -> Result<Self> {
        let wrong = |e| like::wrong(path, "has a broken header", e);
        let grid = tiff.placement.grid;
        let (width, height) = tiff.decoder.chunk_dimensions();
        let (kind_offsets, kind_lengths) = match tiff.decoder.get_chunk_type() {
            ChunkType::Strip => (Tag::StripOffsets, Tag::StripByteCounts),
            ChunkType::Tile => (Tag::TileOffsets, Tag::TileByteCounts),
        };
        // The height of a strip may be the greatest number of its type, which means "all rows".
        let height = match tiff.decoder.get_chunk_type() {
            ChunkType::Strip => u64::from(height).min(grid.rows as u64),
            ChunkType::Tile => height.into(),
        };
        let values = u64::from(width).saturating_mul(height).saturating_mul(samples as u64);
        let bytes = values.saturating_mul(size_of::<f64>() as u64);
        check_size(path, width.into(), height.saturating_mul(samples as u64), tiff.length)?;
        let across = grid.cols.div_ceil(width as usize);
        let count = across * grid.rows.div_ceil(height as usize);
        let offsets = tiff.decoder.find_tag_unsigned_vec::<u64>(kind_offsets).map_err(wrong)?.unwrap_or_default();
        let lengths = tiff.decoder.find_tag_unsigned_vec::<u64>(kind_lengths).map_err(wrong)?.unwrap_or_default();
        let ranges: Vec<(u64, u64)> = offsets.into_iter().zip(lengths).take(count).collect();
        if ranges.len() < count {
            return Err(Error::file(path, "has a broken header: strips or tiles are missing in it"));
        }
        for (index, &(offset, length)) in ranges.iter().enumerate() {
            let end = offset.checked_add(length);
            if end.is_none_or(|end| end > tiff.length) {
                let message = format!(
                    "is cut off: part {} of {count} should end at byte {}, and the file has {}; copy or download it again",
                    index + 1,
                    end.unwrap_or(u64::MAX),
                    tiff.length
                );
                return Err(Error::file(path, message));
            }
        }
        let are_tiles = matches!(tiff.decoder.get_chunk_type(), ChunkType::Tile);
        Ok(Self { size: (width as usize, height as usize), are_tiles, across, ranges, bytes })
    }

    pub fn count(&self) -> u32 {
        // The library has already counted them in 32 bits.
        self.ranges.len() as u32
    }

    /// The decoder's memory limit: one strip or tile.
    pub fn limits(&self, file_length: u64) -> Limits {
        let mut limits = Limits::default();
        let usize_of = |bytes: u64| usize::try_from(bytes).unwrap_or(usize::MAX);
        limits.decoding_buffer_size = limits.decoding_buffer_size.max(usize_of(self.bytes));
        limits.intermediate_buffer_size = limits.intermediate_buffer_size.max(usize_of(file_length));
        limits
    }
}
