//! Reads GeoTIFF height maps: strips and tiles, every number type, with deflate, LZW, PackBits, Zstandard or no
//! compression.
//!
//! The file is decoded strip by strip or tile by tile into the height map. Therefore no second copy of it is held.
//! Strips and tiles that are missing in the file (GDAL calls such files sparse) are cells without data.

use std::path::Path;

use tiff::ColorType;
use tiff::tags::Tag;

use super::chunks::Chunks;
use super::geotiff_rows::{GeoTiffRows, Stored};
use super::height_unit::height_unit;
use super::heights::{Coding, check_size, room};
use super::like::{self, Tiff};
use super::quantity::STANDARD_ERROR;
use super::sidecar::{Aux, elements};
use super::zstd::{Storage, ZSTD};
use tokosen_core::base::error::{Error, Finding, FindingKind, Report, Result};
use tokosen_core::raster::{Dem, RasterRows};

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
    let Opened { rows, mut findings, crs_problem } = open(path, band)?;
    let grid = rows.grid();
    let mut values = room(path, grid.cols as u64, grid.rows as u64, rows.length)?;
    rows.read(0, &mut values)?;
    findings.extend(rows.findings());
    findings.extend(crs_problem);
    Ok(Report { value: Dem { grid, values, crs: rows.crs().cloned() }, findings })
}

/// A GeoTIFF whose heights were not read yet, and what its header gives reason to say.
pub(super) struct Opened {
    pub rows: GeoTiffRows,
    pub findings: Vec<Finding>,
    /// The finding about a coordinate reference system that cannot be used.
    pub crs_problem: Option<Finding>,
}

/// Opens one of the bands, counted from 0.
pub(super) fn open(path: &Path, band: usize) -> Result<Opened> {
    let mut tiff = like::open(path)?;
    let mut findings = Vec::new();
    let (samples, sample_bytes) = samples(path, &mut tiff, &mut findings)?;
    let coding = coding(path, &mut tiff, &mut findings)?;
    let chunks = Chunks::of(path, &mut tiff, samples)?;
    let zstd = zstd_storage(path, &mut tiff, samples, sample_bytes)?;
    let grid = tiff.placement.grid;
    check_size(path, grid.cols as u64, grid.rows as u64, tiff.length)?;
    let crs_problem = tiff
        .crs_problem
        .take()
        .filter(|_| tiff.crs.is_none())
        .map(|why| Finding::general(FindingKind::UnknownCrs, format!("the GeoTIFF keys of the height map {why}")));
    refuse_mask(path)?;
    let rows = GeoTiffRows::new(path, tiff, chunks, Stored { band, samples, sample_bytes, coding, zstd });
    Ok(Opened { rows, findings, crs_problem })
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

/// The items of GDAL's own tag that say something about the whole file: name and text.
pub(super) fn metadata(path: &Path) -> Result<Vec<(String, String)>> {
    let text = text_tag(path, &mut like::open(path)?, GDAL_METADATA)?.unwrap_or_default();
    let items = elements(&text).unwrap_or_default().into_iter().filter(|item| item.attribute("sample").is_none());
    Ok(items.filter_map(|item| Some((item.attribute("name")?.to_owned(), item.text.trim().to_owned()))).collect())
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

/// A mask marks cells without data. Without it, their values would be treated as heights.
fn refuse_mask(path: &Path) -> Result<()> {
    // Going to the next image changes the decoder. So it is not that of the heights.
    let mut decoder = like::open(path)?.decoder;
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
