//! Reads GeoTIFF height maps: strips and tiles, every number type, with deflate, LZW, PackBits, Zstandard or no
//! compression.
//!
//! The file is decoded strip by strip or tile by tile into the height map. Therefore no second copy of it is held.
//! Strips and tiles that are missing in the file (GDAL calls such files sparse) are cells without data.

use std::path::Path;

use tiff::ColorType;
use tiff::decoder::{ChunkType, DecodingResult, Limits};
use tiff::tags::Tag;

use super::height_unit::height_unit;
use super::heights::{Coding, Heights, check_size, room};
use super::like::{self, Tiff};
use super::quantity::STANDARD_ERROR;
use super::sidecar::{Aux, elements};
use super::zstd::{self, Storage, ZSTD};
use crate::base::error::{Error, Finding, FindingKind, Report, Result};
use crate::dem::Dem;

/// GDAL's own tag: scale, offset and unit of the values.
const GDAL_METADATA: Tag = Tag::Unknown(42112);

/// The photometric interpretation in which 0 is white.
const WHITE_IS_ZERO: u16 = 0;

/// The bit of the subfile type that marks a mask.
const IS_MASK: u32 = 4;

/// The largest number of overviews and masks that are checked.
const MAX_SUBFILES: usize = 64;

pub(super) fn read(path: &Path) -> Result<Report<Dem>> {
    read_band(path, 0)
}

/// Reads the second band if it holds the standard errors of the first.
pub(super) fn read_errors(path: &Path) -> Result<Option<Dem>> {
    let mut tiff = like::open(path)?;
    if !second_is_error(path, &mut tiff)? {
        return Ok(None);
    }
    Ok(Some(read_band(path, 1)?.value))
}

/// Reads one of the bands, counted from 0.
fn read_band(path: &Path, band: usize) -> Result<Report<Dem>> {
    let mut tiff = like::open(path)?;
    let mut findings = Vec::new();
    let (samples, sample_bytes) = samples(path, &mut tiff, &mut findings)?;
    let coding = coding(path, &mut tiff, &mut findings)?;
    let chunks = Chunks::of(path, &mut tiff, samples)?;
    let zstd = zstd_storage(path, &mut tiff, samples, sample_bytes)?;

    let grid = tiff.placement.grid;
    let mut values = room(path, grid.cols as u64, grid.rows as u64, tiff.length)?;
    let mut heights = Heights::new(coding);
    let limits = chunks.limits(tiff.length);
    let Tiff { decoder, placement, crs, crs_problem, .. } = tiff;
    let mut decoder = decoder.with_limits(limits);
    // Tiles at the border are decoded with their padding, in one call of the decompressor. Without the padding there
    // would be one call per row, which the LZW decompressor sometimes answers with an error.
    let stride = chunks.size.0 * samples;
    let mut decoded = DecodingResult::U8(Vec::new());
    for index in 0..chunks.count() {
        if chunks.ranges[index as usize] == (0, 0) {
            continue;
        }
        let message = format!("part {} of {} cannot be decoded; the file is broken", index + 1, chunks.count());
        // Bands are stored one after the other, or interleaved.
        let (skipped, beside) =
            if samples == 1 { (band as u32 * chunks.count(), 0) } else { (0, band.min(samples - 1)) };
        let (width, height) = decoder.chunk_data_dimensions(index);
        let (width, height) = (width as usize, height as usize);
        match zstd {
            // Only this program writes a second band, and never with this compression.
            Some(storage) if skipped == 0 => {
                // Tiles are stored whole, strips as far as the map reaches.
                let rows = if chunks.are_tiles { chunks.size.1 } else { height };
                let range = chunks.ranges[index as usize];
                decoded = zstd::unpack(decoder.inner(), range, (chunks.size.0, rows), storage)
                    .map_err(|why| Error::file(path, format!("part {} of {}: {why}", index + 1, chunks.count())))?;
            }
            _ => decoder
                .read_chunk_to_buffer(&mut decoded, index + skipped, stride * sample_bytes)
                .map_err(|e| like::wrong(path, &unsupported(&e, message), e))?,
        }
        let (left, top) = chunks.origin(index);
        for line in 0..height {
            let row = placement.row(top + line) * grid.cols + left;
            let out = &mut values[row..row + width];
            copy(&decoded, line * stride + beside, samples, out, &mut heights);
        }
    }
    findings.extend(heights.findings());
    if let Some(why) = crs_problem.filter(|_| crs.is_none()) {
        findings.push(Finding::general(FindingKind::UnknownCrs, format!("the GeoTIFF keys of the height map {why}")));
    }
    refuse_mask(path, &mut decoder)?;
    Ok(Report { value: Dem { grid, values, crs }, findings })
}

/// How the values are stored, if they are compressed with Zstandard.
fn zstd_storage(path: &Path, tiff: &mut Tiff, samples: usize, bytes: usize) -> Result<Option<Storage>> {
    let wrong = |e| like::wrong(path, "has a broken header", e);
    if tiff.decoder.find_tag_unsigned::<u16>(Tag::Compression).map_err(wrong)? != Some(ZSTD) {
        return Ok(None);
    }
    let predictor = tiff.decoder.find_tag_unsigned::<u16>(Tag::Predictor).map_err(wrong)?.unwrap_or(1);
    let format = tiff.decoder.find_tag_unsigned_vec::<u16>(Tag::SampleFormat).map_err(wrong)?.unwrap_or_default();
    let format = format.first().copied().unwrap_or(1);
    Ok(Some(Storage { bytes, format, predictor, order: tiff.decoder.byte_order(), samples }))
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

/// How many values per cell are interleaved, and how many bytes each has. Pictures are refused.
fn samples(path: &Path, tiff: &mut Tiff, findings: &mut Vec<Finding>) -> Result<(usize, usize)> {
    let picture = || Error::file(path, "is a picture in colour and not a height map");
    let color = tiff.decoder.colortype().map_err(|_| picture())?;
    let white_is_zero = tiff.decoder.find_tag_unsigned::<u16>(Tag::PhotometricInterpretation);
    if matches!(white_is_zero, Ok(Some(WHITE_IS_ZERO))) {
        return Err(Error::file(path, "has 0 as white, as scanned pages have; it is not a height map"));
    }
    let bands = match color {
        ColorType::Gray(_) => 1,
        ColorType::Multiband { num_samples, .. } => usize::from(num_samples),
        _ => return Err(picture()),
    };
    let bits = color.bit_depth();
    if ![8, 16, 32, 64].contains(&bits) {
        return Err(Error::file(
            path,
            format!("has values of {bits} bits, which are not read; heights have 8, 16, 32 or 64"),
        ));
    }
    if bands > 1 && !(bands == 2 && second_is_error(path, tiff)?) {
        let message = format!("the raster has {bands} bands; the first one is taken for the heights");
        findings.push(Finding::general(FindingKind::OtherBands, message));
    }
    let planar = tiff.decoder.find_tag_unsigned::<u16>(Tag::PlanarConfiguration);
    Ok((if matches!(planar, Ok(Some(2))) { 1 } else { bands }, usize::from(bits / 8)))
}

/// Whether the second band is described as the standard errors of the first.
fn second_is_error(path: &Path, tiff: &mut Tiff) -> Result<bool> {
    let Some(text) = text_tag(path, tiff, GDAL_METADATA)? else { return Ok(false) };
    let items = elements(&text).unwrap_or_default();
    let says_so = |role: Option<&str>, sample: Option<&str>, text: &str| {
        role == Some("description") && sample == Some("1") && text == STANDARD_ERROR
    };
    Ok(items.iter().any(|item| says_so(item.attribute("role"), item.attribute("sample"), item.text.trim())))
}

/// How stored values become heights: by the file's own tags, otherwise by the `.aux.xml` beside it.
fn coding(path: &Path, tiff: &mut Tiff, findings: &mut Vec<Finding>) -> Result<Coding> {
    let wrong = |e| like::wrong(path, "has a broken header", e);
    let mut own = Aux::default();
    if let Some(text) = text_tag(path, tiff, Tag::GdalNodata)? {
        let text = text.trim_matches(['\0', ' ']);
        own.nodata = Some(
            text.parse()
                .map_err(|_| Error::file(path, format!("has the nodata value {text:?}, which is not a number")))?,
        );
    }
    if let Some(text) = text_tag(path, tiff, GDAL_METADATA)? {
        for item in elements(&text).unwrap_or_default() {
            let of_band = item.attribute("sample").is_none_or(|sample| sample == "0");
            let number = || item.text.trim().parse().ok();
            match item.attribute("role") {
                Some("scale") if of_band => own.scale = number(),
                Some("offset") if of_band => own.offset = number(),
                Some("unittype") if of_band => own.unit = Some(item.text.trim().to_owned()),
                _ => {}
            }
        }
    }
    let system = [&tiff.crs, &tiff.aux.crs].into_iter().flatten().find(|crs| crs.height_unit().is_some());
    let names = [own.unit.as_deref(), tiff.aux.unit.as_deref(), tiff.keys.vertical_unit()];
    let unit = height_unit(names, system.or(tiff.crs.as_ref()));
    findings.extend(unit.finding);
    let metres = unit.metres;
    let bits = tiff.decoder.find_tag_unsigned_vec::<u16>(Tag::BitsPerSample).map_err(wrong)?.unwrap_or_default();
    let format = tiff.decoder.find_tag_unsigned_vec::<u16>(Tag::SampleFormat).map_err(wrong)?.unwrap_or_default();
    let is_f32 = bits.first() == Some(&32) && format.first() == Some(&3);
    Ok(Coding {
        // The nodata tag is a decimal number. Stored values are the nearest number of their own type.
        nodata: own.nodata.or(tiff.aux.nodata).map(|mark| if is_f32 { f64::from(mark as f32) } else { mark }),
        scale: own.scale.or(tiff.aux.scale).unwrap_or(1.0) * metres,
        offset: own.offset.or(tiff.aux.offset).unwrap_or(0.0) * metres,
    })
}

/// The text of a tag. An unreadable text is an error, because it may change the meaning of the heights.
fn text_tag(path: &Path, tiff: &mut Tiff, tag: Tag) -> Result<Option<String>> {
    let value = tiff.decoder.find_tag(tag);
    let text = value.and_then(|value| value.map(|value| value.into_string()).transpose());
    text.map_err(|e| like::wrong(path, "has a broken header", e))
}

/// The strips or tiles of the first band.
struct Chunks {
    /// Width and height of a complete strip or tile, cells.
    size: (usize, usize),
    are_tiles: bool,
    across: usize,
    /// Offset and length in the file. Both are zero for missing ones.
    ranges: Vec<(u64, u64)>,
    /// Bytes of a complete strip or tile in memory.
    bytes: u64,
}

impl Chunks {
    fn of(path: &Path, tiff: &mut Tiff, samples: usize) -> Result<Self> {
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

    fn count(&self) -> u32 {
        // The library has already counted them in 32 bits.
        self.ranges.len() as u32
    }

    /// Column and stored row of the first cell.
    fn origin(&self, index: u32) -> (usize, usize) {
        let index = index as usize;
        (index % self.across * self.size.0, index / self.across * self.size.1)
    }

    /// The decoder's memory limit: one strip or tile.
    fn limits(&self, file_length: u64) -> Limits {
        let mut limits = Limits::default();
        let usize_of = |bytes: u64| usize::try_from(bytes).unwrap_or(usize::MAX);
        limits.decoding_buffer_size = limits.decoding_buffer_size.max(usize_of(self.bytes));
        limits.intermediate_buffer_size = limits.intermediate_buffer_size.max(usize_of(file_length));
        limits
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

/// A mask marks cells without data. Without it, their values would be treated as heights.
fn refuse_mask<R: std::io::Read + std::io::Seek>(path: &Path, decoder: &mut tiff::decoder::Decoder<R>) -> Result<()> {
    for _ in 0..MAX_SUBFILES {
        // Overviews that cannot be read do not matter for the height map.
        if !decoder.more_images() || decoder.next_image().is_err() {
            break;
        }
        let kind = decoder.find_tag_unsigned::<u32>(Tag::NewSubfileType);
        if matches!(kind, Ok(Some(kind)) if kind & IS_MASK != 0) {
            return Err(Error::file(
                path,
                "marks its cells without data by a mask, which is not read; rewrite it with a nodata value, for example \
                 with 'gdalwarp -dstnodata -9999 in.tif out.tif'",
            ));
        }
    }
    Ok(())
}
