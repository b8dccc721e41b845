//! Reads PNG height maps: 16-bit grey with a scale, and elevation tiles in colour.
//!
//! Grey: height = offset + scale * value. Scale and offset come from the file's own text chunks, otherwise from the
//! `.png.aux.xml` beside it. A grey picture without either is refused, because its values could mean anything. The
//! placement is in the same files or in the world file. Colour: see the module on elevation tiles. Their encoding is in the
//! same files. A picture that does not state it is read as a tile of GSI, with a note, because these tiles do not. Terrarium and Mapbox are
//! never assumed. The placement of tiles is in the path or in the world file.

use std::io::BufReader;
use std::path::Path;

use png::{BitDepth, ColorType, Decoder, DecodingError, Info, Limits, Transformations};

use super::elevation_tile::{self, ColourCode};
use super::exr;
use super::height_unit::height_unit;
use super::heights::{Coding, Heights, check_size};
use super::pam;
use super::placement::{self, Placement};
use super::sidecar::{self, Aux};
use crate::ordinary::open_to_read;
use tokosen_core::base::error::{Error, Finding, FindingKind, Report, Result};
use tokosen_core::crs::Crs;
use tokosen_core::raster::Dem;

/// The coordinate reference system of elevation tiles.
const WEB_MERCATOR: u32 = 3857;

/// Memory limit of the PNG library in addition to the rows of the picture, bytes.
const SIDE_MEMORY: usize = 64 << 20;

/// The largest ratio of decompressed to deflated bytes, rounded up.
const MAX_DEFLATE_RATIO: u64 = 1100;

/// The range of heights on Earth, metres. Colours outside it belong to an ordinary picture.
const EARTH: std::ops::RangeInclusive<f64> = -12_000.0..=9_500.0;

pub(super) fn read(path: &Path) -> Result<Report<Dem>> {
    let wrong = |error: DecodingError| match error {
        DecodingError::IoError(e) if e.raw_os_error().is_some() => Error::io("read", path, e),
        other => Error::file_cause(path, "is not a PNG file that can be read, or it is cut off", other),
    };
    let file = open_to_read(path)?;
    let length = file.metadata().map_err(|e| Error::io("read", path, e))?.len();
    let mut decoder = Decoder::new_with_limits(BufReader::new(file), Limits { bytes: SIDE_MEMORY });
    decoder.set_transformations(Transformations::EXPAND);
    let (width, height) = decoder.read_header_info().map_err(wrong)?.size();
    check_size(path, width.into(), height.into(), length)?;
    decoder.set_limits(Limits { bytes: SIDE_MEMORY.saturating_add(width as usize * 16) });
    let mut reader = decoder.read_info().map_err(wrong)?;
    let bytes = reader.output_buffer_size().filter(|&bytes| bytes as u64 / MAX_DEFLATE_RATIO <= length);
    let Some(bytes) = bytes else {
        let message = format!("claims {width} x {height} cells, but is only {length} bytes long: the file is broken");
        return Err(Error::file(path, message));
    };
    let mut pixels = vec![0; bytes];
    let frame = reader.next_frame(&mut pixels).map_err(wrong)?;
    // Text chunks may follow the picture.
    reader.finish().map_err(wrong)?;
    if matches!(reader.info().bit_depth, BitDepth::One | BitDepth::Two | BitDepth::Four) {
        return Err(Error::file(path, "has values of less than 8 bits, which are no heights"));
    }
    let own = text_chunks(reader.info());
    let beside = sidecar::read_aux_xml(path)?;
    let channels = frame.color_type.samples();
    match frame.color_type {
        ColorType::Grayscale | ColorType::GrayscaleAlpha => {
            let deep = frame.bit_depth == BitDepth::Sixteen;
            grey(path, (width, height), own, beside, &Pixels { bytes: &pixels, channels, deep })
        }
        ColorType::Rgb | ColorType::Rgba if frame.bit_depth == BitDepth::Eight => {
            colour(path, (width, height), own, beside, &Pixels { bytes: &pixels, channels, deep: false })
        }
        _ => Err(Error::file(path, "is a picture in colour and not a height map")),
    }
}

/// The decoded picture.
struct Pixels<'a> {
    bytes: &'a [u8],
    /// Samples per pixel. If the number is even, the last sample is opacity.
    channels: usize,
    /// Whether samples have two bytes.
    deep: bool,
}

impl Pixels<'_> {
    /// The samples of every pixel that is not transparent.
    fn iter(&self) -> impl Iterator<Item = Option<[u16; 3]>> {
        let width = if self.deep { 2 } else { 1 };
        self.bytes.chunks_exact(self.channels * width).map(move |pixel| {
            let sample = |k: usize| match pixel.get(k * width..(k + 1) * width) {
                Some(&[high, low]) => u16::from_be_bytes([high, low]),
                Some(&[byte]) => byte.into(),
                _ => 0,
            };
            let is_clear = self.channels.is_multiple_of(2) && sample(self.channels - 1) == 0;
            (!is_clear).then(|| [0, 1, 2].map(sample))
        })
    }
}

/// The content of the file's text chunks.
fn text_chunks(info: &Info<'_>) -> Aux {
    let mut aux = Aux::default();
    let plain = info.uncompressed_latin1_text.iter().map(|chunk| (chunk.keyword.as_str(), chunk.text.as_str()));
    for (key, text) in plain {
        let number = || text.trim().parse().ok();
        match key {
            "Scale" => aux.scale = number(),
            "Offset" => aux.offset = number(),
            "NoData" => aux.nodata = number(),
            pam::ENCODING => aux.encoding = Some(text.trim().to_owned()),
            "Unit" => aux.unit = Some(text.trim().to_owned()),
            "GeoTransform" => aux.transform = sidecar::six_numbers(text),
            "EPSG" if aux.crs.is_none() => aux.crs = text.trim().parse().ok().map(Crs::from_epsg),
            _ => {}
        }
    }
    let wkt = info.utf8_text.iter().find(|chunk| chunk.keyword == "WKT").and_then(|chunk| chunk.get_text().ok());
    if let Some(wkt) = wkt {
        aux.crs = Some(Crs::from_wkt(&wkt));
    }
    aux
}

/// The placement by transform or world file.
fn placed(path: &Path, (width, height): (u32, u32), own: &Aux, beside: &Aux) -> Result<Option<Placement>> {
    let size = (width as usize, height as usize);
    match own.transform.or(beside.transform) {
        Some(numbers) => placement::by_transform(numbers, size).map(Some).map_err(|message| Error::file(path, message)),
        None => sidecar::read_world(path, &["pgw", "pngw", "wld"], size),
    }
}

fn system(path: &Path, own: Option<Crs>, beside: Option<Crs>) -> Result<Option<Crs>> {
    match own.or(beside) {
        Some(crs) => Ok(Some(crs)),
        None => sidecar::read_prj(path),
    }
}

fn grey(path: &Path, size: (u32, u32), own: Aux, beside: Option<Aux>, pixels: &Pixels<'_>) -> Result<Report<Dem>> {
    let has_coding = |aux: &Aux| aux.scale.is_some() || aux.offset.is_some() || aux.unit.is_some();
    if own.scale.is_none() && !beside.as_ref().is_some_and(has_coding) {
        let message = "is a grey picture that does not say how its values become heights; write an .aux.xml with Scale \
                       and Offset beside it, for example with 'gdal_translate -a_scale 0.1 -a_offset 0'";
        return Err(Error::file(path, message));
    }
    let beside = beside.unwrap_or_default();
    let Some(placement) = placed(path, size, &own, &beside)? else {
        return Err(Error::file(path, "has no georeferencing; put a world file (.pgw) beside it"));
    };
    let crs = system(path, own.crs, beside.crs)?;
    let unit = height_unit([own.unit.as_deref(), beside.unit.as_deref()], crs.as_ref());
    let metres = unit.metres;
    // Scale, offset and nodata value must come from the same file.
    let (scale, offset, nodata) = match own.scale {
        Some(scale) => (scale, own.offset, own.nodata),
        None => (beside.scale.unwrap_or(1.0), beside.offset, beside.nodata),
    };
    let mut heights = Heights::new(Coding { nodata, scale: scale * metres, offset: offset.unwrap_or(0.0) * metres });
    let values =
        pixels.iter().map(|pixel| pixel.map_or(f32::NAN, |[value, ..]| heights.height(value.into()))).collect();
    let mut findings: Vec<_> = unit.finding.into_iter().collect();
    findings.extend(heights.finding());
    let dem = turned(placement, values, crs);
    Ok(Report { value: dem, findings })
}

fn colour(path: &Path, size: (u32, u32), own: Aux, beside: Option<Aux>, pixels: &Pixels<'_>) -> Result<Report<Dem>> {
    let beside = beside.unwrap_or_default();
    let stated = own.encoding.as_ref().or(beside.encoding.as_ref());
    let code = match stated {
        Some(name) => ColourCode::named(name)
            .ok_or_else(|| Error::file(path, format!("holds heights in the encoding {name:?}, which is not known")))?,
        None => ColourCode::Gsi,
    };
    let mut strange = false;
    let height = |pixel: Option<[u16; 3]>| {
        let height = pixel.and_then(|rgb| code.height(rgb.map(|sample| sample as u8)));
        strange |= height.is_some_and(|height| !EARTH.contains(&height));
        height.map_or(f32::NAN, |height| height as f32)
    };
    let values: Vec<f32> = pixels.iter().map(height).collect();
    if strange && stated.is_none() {
        let message = "is a picture in colour: taken as an elevation tile of GSI it has heights that are not on Earth. If it \
                       is a tile of another kind, it must say so: ElevationEncoding terrarium or mapbox, in a text of the \
                       PNG or in the metadata of the .aux.xml beside it";
        return Err(Error::file(path, message));
    }
    let note = || {
        let text =
            "the file does not state how its colours become heights; they are taken as those of elevation tiles of GSI";
        Finding::general(FindingKind::ColourEncoding, text)
    };
    let findings = stated.is_none().then(note).into_iter().collect();
    let (placement, crs) = match placed(path, size, &own, &beside)? {
        Some(placement) => (placement, system(path, own.crs, beside.crs)?),
        None => {
            let placement = elevation_tile::placement(&std::path::absolute(path).unwrap_or(path.to_owned()), size);
            let Some(placement) = placement else {
                let message = "is in colour. If it is an elevation tile, its placement must be known: keep the path \
                               zoom/column/row.png of the tile, or put a world file (.pgw) beside it";
                return Err(Error::file(path, message));
            };
            (placement, Some(Crs::from_epsg(WEB_MERCATOR)))
        }
    };
    Ok(Report { value: turned(placement, values, crs), findings })
}

fn turned(placement: Placement, mut values: Vec<f32>, crs: Option<Crs>) -> Dem {
    if placement.south_up {
        exr::flip(&mut values, placement.grid.cols);
    }
    Dem { grid: placement.grid, values, crs }
}
