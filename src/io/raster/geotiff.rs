//! GeoTIFF height maps: 32-bit floating point in compressed tiles, plain or as a Cloud Optimized GeoTIFF. Brightness has 8 bits,
//! and 0 where there is no data, as other programs have hillshades.
//!
//! Cells without data hold -9999, and the nodata tag names this value. GDAL and QGIS would accept NaN, but older ArcGIS
//! versions and most self-written readers treat NaN as a height. Tiles pass the floating point predictor and are then
//! deflated, which halves the size of smooth terrain. They are compressed in parallel and written in order: the file
//! does not depend on the number of threads.
//!
//! The directories come first, and the tiles behind them. The directories state the places of the tiles, which are known
//! at the end. Their length is known before: it depends only on the number of tiles.

use std::borrow::Cow;
use std::io::{Seek, SeekFrom, Write};
use std::path::Path;

use flate2::Compression;
use flate2::write::ZlibEncoder;
use rayon::prelude::*;
use tiff::tags::{CompressionMethod, PhotometricInterpretation, PlanarConfiguration, Predictor, SampleFormat, Tag};

use super::directory::{Directory, Field, Kind, beginning};
use super::geokeys::GeoKeys;
use super::output::{Filled, create};
use super::overview::{Image, overviews};
use super::quantity::{Quantity, STANDARD_ERROR, Values};
use super::{TiffLayout, cog};
use crate::maker::PROGRAM;
use tokosen_core::base::Grid;
use tokosen_core::base::error::Result;
use tokosen_core::crs::Crs;
use tokosen_core::raster::{Blocks, Dem, RasterRows};

/// Side of a tile in cells. The format requires a multiple of 16.
const TILE: usize = 256;

/// Tiles that are compressed before they are written. This bounds the memory in addition to the height map.
const BATCH: usize = 32;

/// The offsets of a classic TIFF have 32 bits. A margin is left for tiles that do not compress.
const CLASSIC_LIMIT: u64 = 4_000_000_000;

/// The usual nodata value. If a cell really is that low, NaN is used instead.
const NODATA: f32 = -9999.0;

/// The nodata value of brightness, which is from 1 to 255.
const DARK: f32 = 0.0;

/// GDAL's own tag: name and unit of the values.
const GDAL_METADATA: Tag = Tag::Unknown(42112);

/// The subfile type of an overview.
const IS_OVERVIEW: u32 = 1;

fn metadata(values: Values, with_errors: bool) -> String {
    let of_band = |band: u8, name: &str, role: &str, text: &str| {
        format!("  <Item name=\"{name}\" sample=\"{band}\" role=\"{role}\">{text}</Item>\n")
    };
    let item = |name: &str, role: &str, text: &str| of_band(0, name, role, text);
    let unit = values.unit().map(|(unit, _)| item("UNITTYPE", "unittype", unit)).unwrap_or_default();
    // Readers expect heights in a height map; other values are named.
    let name = match values.quantity {
        Quantity::Height if !with_errors => String::new(),
        other => item("DESCRIPTION", "description", other.name()),
    };
    let errors = if with_errors {
        let unit = values.unit().map(|(unit, _)| of_band(1, "UNITTYPE", "unittype", unit)).unwrap_or_default();
        of_band(1, "DESCRIPTION", "description", STANDARD_ERROR) + &unit
    } else {
        String::new()
    };
    format!("<GDALMetadata>\n{name}{unit}{errors}</GDALMetadata>\n")
}

impl Image<'_> {
    /// The number of tiles in a row of tiles, and of rows of tiles.
    fn tiles(&self) -> [usize; 2] {
        [self.cols, self.rows].map(|cells| cells.div_ceil(TILE))
    }

    /// The number of tiles of all bands.
    fn count(&self) -> usize {
        self.bands.len() * self.tiles().iter().product::<usize>()
    }
}

/// Where the tiles of an image are in the file: offsets and lengths, bytes.
struct Places {
    offsets: Vec<u64>,
    lengths: Vec<u64>,
}

/// A raster, and how it is written.
struct Raster<'a> {
    grid: Grid,
    crs: Option<&'a Crs>,
    values: Values,
    layout: TiffLayout,
    kind: Kind,
    /// The map, and its overviews from the largest to the smallest.
    images: Vec<Image<'a>>,
    nodata: f32,
}

/// The kind of TIFF that has room for images.
fn kind(images: &[Image<'_>]) -> Kind {
    let tiles: usize = images.iter().map(Image::count).sum();
    let is_large = (tiles * TILE * TILE * size_of::<f32>()) as u64 > CLASSIC_LIMIT;
    if is_large { Kind::Big } else { Kind::Classic }
}

/// Writes values row by row to `path`, as one band of a plain GeoTIFF.
pub(super) fn write_rows(path: &Path, rows: &dyn RasterRows, crs: Option<&Crs>, values: Values) -> Result<()> {
    let marks: &[f32] = if values.quantity == Quantity::Shade { &[DARK] } else { &[NODATA, f32::NAN] };
    for &nodata in marks {
        let mut is_whole = false;
        create(path, |out| {
            is_whole = Raster::of_rows(rows.grid(), crs, values, nodata).write_rows(rows, out)?;
            Ok(())
        })?;
        if is_whole {
            break;
        }
    }
    Ok(())
}

/// Writes `dem` to `path`, with a second band of `errors` if there are any.
pub(super) fn write(path: &Path, dem: &Dem, values: Values, layout: TiffLayout, errors: Option<&[f32]>) -> Result<()> {
    let raster = Raster::of(dem, values, layout, errors);
    create(path, |out| Ok(raster.write(out)?))
}

impl<'a> Raster<'a> {
    fn of(dem: &'a Dem, values: Values, layout: TiffLayout, errors: Option<&'a [f32]>) -> Self {
        let bands = std::iter::once(dem.values.as_slice()).chain(errors).map(Cow::Borrowed).collect();
        let mut images = vec![Image { bands, cols: dem.grid.cols, rows: dem.grid.rows }];
        if layout == TiffLayout::CloudOptimized {
            images.extend(overviews(&images[0], TILE, values.quantity));
        }
        let is_taken = images.iter().flat_map(|image| &image.bands).any(|band| band.contains(&NODATA));
        let nodata = match values.quantity {
            Quantity::Shade => DARK,
            _ if is_taken => f32::NAN,
            _ => NODATA,
        };
        Self { grid: dem.grid, crs: dem.crs.as_ref(), values, layout, kind: kind(&images), images, nodata }
    }

    /// A raster whose values are read row by row.
    fn of_rows(grid: Grid, crs: Option<&'a Crs>, values: Values, nodata: f32) -> Self {
        let images = vec![Image { bands: vec![Cow::Borrowed(&[])], cols: grid.cols, rows: grid.rows }];
        Self { grid, crs, values, layout: TiffLayout::Plain, kind: kind(&images), images, nodata }
    }

    /// How values are stored.
    fn stored(&self) -> Stored {
        if self.values.quantity == Quantity::Shade { Stored::Byte } else { Stored::Float { nodata: self.nodata } }
    }

    /// Writes the tiles from the first rows to the last, and the directory. It stops and returns false if a value is that for no
    /// data.
    fn write_rows(&self, rows: &dyn RasterRows, out: &mut (impl Write + Seek)) -> std::result::Result<bool, Filled> {
        let image = &self.images[0];
        let [across, _] = image.tiles();
        let mut places = Places { offsets: Vec::new(), lengths: Vec::new() };
        let room = self.beginning(&[Places { offsets: vec![0; image.count()], lengths: vec![0; image.count()] }]).len();
        let mut at = out.seek(SeekFrom::Start(room as u64))?;
        let mut blocks = Blocks::of_length(rows, TILE * (BATCH / across).max(1));
        while let Some(block) = blocks.next_block().map_err(Filled::Values)? {
            let values = block.heights();
            if self.stored() != Stored::Byte && values.contains(&self.nodata) {
                return Ok(false);
            }
            let part = Part { values, cols: image.cols, rows: block.rows.len() };
            let count = across * block.rows.len().div_ceil(TILE);
            let tiles: Vec<std::io::Result<Vec<u8>>> = (0..count)
                .into_par_iter()
                .map(|tile| compress(&tile_bytes(&part, (tile % across * TILE, tile / across * TILE), self.stored())))
                .collect();
            for bytes in tiles {
                let bytes = bytes?;
                places.offsets.push(at);
                places.lengths.push(bytes.len() as u64);
                out.write_all(&bytes)?;
                at += bytes.len() as u64;
            }
        }
        out.seek(SeekFrom::Start(0))?;
        out.write_all(&self.beginning(&[places]))?;
        Ok(true)
    }

    /// Writes the directories from the map to the smallest overview, and the tiles the other way round. So the beginning
    /// of the file holds the directories and the small overviews.
    fn write(&self, out: &mut (impl Write + Seek)) -> std::io::Result<()> {
        let unknown = |image: &Image<'_>| Places { offsets: vec![0; image.count()], lengths: vec![0; image.count()] };
        let mut places: Vec<Places> = self.images.iter().map(unknown).collect();
        let room = self.beginning(&places).len() as u64;
        let mut at = out.seek(SeekFrom::Start(room))?;
        for (image, places) in self.images.iter().zip(&mut places).rev() {
            for first in (0..image.count()).step_by(BATCH) {
                let batch: Vec<std::io::Result<Vec<u8>>> = (first..image.count().min(first + BATCH))
                    .into_par_iter()
                    .map(|tile| compress(&image_tile(image, tile, self.stored())))
                    .collect();
                for (tile, bytes) in (first..).zip(batch) {
                    let bytes = bytes?;
                    let [before, after] = match self.layout {
                        TiffLayout::Plain => Default::default(),
                        TiffLayout::CloudOptimized => cog::around(&bytes),
                    };
                    places.offsets[tile] = at + before.len() as u64;
                    places.lengths[tile] = bytes.len() as u64;
                    for part in [before, bytes, after] {
                        out.write_all(&part)?;
                        at += part.len() as u64;
                    }
                }
            }
        }
        out.seek(SeekFrom::Start(0))?;
        out.write_all(&self.beginning(&places))
    }

    /// The bytes before the tiles.
    fn beginning(&self, places: &[Places]) -> Vec<u8> {
        let directories: Vec<Directory> = (0..places.len()).map(|k| self.directory(k, &places[k])).collect();
        let after_header = match self.layout {
            TiffLayout::Plain => String::new(),
            TiffLayout::CloudOptimized => cog::structure(),
        };
        beginning(self.kind, after_header.as_bytes(), &directories)
    }

    /// The directory of an image. Long because it lists all tags of the file.
    fn directory(&self, k: usize, places: &Places) -> Directory {
        let image = &self.images[k];
        let bands = image.bands.len();
        let short = |value: u16| Field::Shorts(vec![value]);
        // The caller has checked that columns and rows fit into 31 bits.
        let long = |value: usize| Field::Longs(vec![value as u32]);
        // The bands are stored one after the other. A reader of heights need not read the errors.
        let planar = if bands > 1 { PlanarConfiguration::Planar } else { PlanarConfiguration::Chunky };
        let nodata = if self.nodata.is_nan() { "nan".to_owned() } else { self.nodata.to_string() };
        let (bits, format, predictor) = match self.stored() {
            Stored::Byte => (8, SampleFormat::Uint, Predictor::Horizontal),
            Stored::Float { .. } => (32, SampleFormat::IEEEFP, Predictor::FloatingPoint),
        };
        let mut tags: Directory = vec![
            (Tag::ImageWidth, long(image.cols)),
            (Tag::ImageLength, long(image.rows)),
            (Tag::BitsPerSample, Field::Shorts(vec![bits; bands])),
            (Tag::Compression, short(CompressionMethod::Deflate.to_u16())),
            (Tag::PhotometricInterpretation, short(PhotometricInterpretation::BlackIsZero.to_u16())),
            (Tag::SamplesPerPixel, short(bands as u16)),
            (Tag::PlanarConfiguration, short(planar.to_u16())),
            (Tag::Predictor, short(predictor.to_u16())),
            (Tag::TileWidth, long(TILE)),
            (Tag::TileLength, long(TILE)),
            (Tag::TileOffsets, Field::Offsets(places.offsets.clone())),
            (Tag::TileByteCounts, Field::Offsets(places.lengths.clone())),
            (Tag::SampleFormat, Field::Shorts(vec![format.to_u16(); bands])),
            (Tag::GdalNodata, Field::Ascii(nodata)),
        ];
        if bands > 1 {
            tags.push((Tag::ExtraSamples, short(0)));
        }
        if k > 0 {
            tags.push((Tag::NewSubfileType, Field::Longs(vec![IS_OVERVIEW])));
            return tags;
        }
        let grid = self.grid;
        tags.extend([
            (Tag::Software, Field::Ascii(PROGRAM.into())),
            (Tag::ModelPixelScaleTag, Field::Doubles(vec![grid.cell.x, grid.cell.y, 0.0])),
            (Tag::ModelTiepointTag, Field::Doubles(vec![0.0, 0.0, 0.0, grid.corner.x, grid.corner.y, 0.0])),
            (GDAL_METADATA, Field::Ascii(metadata(self.values, bands > 1))),
        ]);
        if let Some(keys) = self.crs.and_then(GeoKeys::of) {
            tags.push((Tag::GeoKeyDirectoryTag, Field::Shorts(keys.directory)));
            if !keys.ascii.is_empty() {
                tags.push((Tag::GeoAsciiParamsTag, Field::Ascii(keys.ascii)));
            }
        }
        tags
    }
}

fn compress(bytes: &[u8]) -> std::io::Result<Vec<u8>> {
    let mut encoder = ZlibEncoder::new(Vec::with_capacity(bytes.len() / 2), Compression::new(3));
    encoder.write_all(bytes)?;
    encoder.finish()
}

/// How a value is stored.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Stored {
    /// 8 bits: brightness, rounded.
    Byte,
    /// 32 bits.
    Float { nodata: f32 },
}

/// Rows of a band.
struct Part<'a> {
    values: &'a [f32],
    cols: usize,
    rows: usize,
}

/// The bytes of one of the tiles of an image.
fn image_tile(image: &Image<'_>, tile: usize, stored: Stored) -> Vec<u8> {
    let [across, down] = image.tiles();
    let part = Part { values: &image.bands[tile / (across * down)], cols: image.cols, rows: image.rows };
    let tile = tile % (across * down);
    tile_bytes(&part, (tile % across * TILE, tile / across * TILE), stored)
}

/// A brightness as a byte. NaN becomes the mark of no data.
fn byte(brightness: f32) -> u8 {
    if brightness.is_nan() { DARK as u8 } else { brightness.round().clamp(1.0, 255.0) as u8 }
}

/// The bytes of one tile after the predictor. Outside the map the last column and row are repeated.
fn tile_bytes(part: &Part<'_>, (left, top): (usize, usize), stored: Stored) -> Vec<u8> {
    let &Part { values, cols, rows } = part;
    let width = match stored {
        Stored::Byte => 1,
        Stored::Float { .. } => size_of::<f32>(),
    };
    let mut bytes = vec![0; TILE * TILE * width];
    for (row, line) in bytes.chunks_exact_mut(TILE * width).enumerate() {
        let start = (top + row).min(rows - 1) * cols;
        let value = |col: usize| values[start + (left + col).min(cols - 1)];
        match stored {
            Stored::Byte => (0..TILE).for_each(|col| line[col] = byte(value(col))),
            Stored::Float { nodata } => {
                for col in 0..TILE {
                    let value = value(col);
                    let value = if value.is_nan() { nodata } else { value };
                    for (plane, byte) in value.to_be_bytes().into_iter().enumerate() {
                        line[plane * TILE + col] = byte;
                    }
                }
            }
        }
        // The predictor stores the difference to the previous byte, with floating point over all four byte planes of the line.
        for at in (1..line.len()).rev() {
            line[at] = line[at].wrapping_sub(line[at - 1]);
        }
    }
    bytes
}

#[cfg(test)]
mod tests {
    use std::fs::File;
    use std::io::BufReader;

    use tiff::decoder::{Decoder, DecodingResult};

    use super::super::read_grid;
    use super::super::tests::sample;
    use super::*;
    use tokosen_core::crs::Crs;

    fn read(path: &Path) -> (Vec<f32>, String) {
        let mut decoder = Decoder::new(BufReader::new(File::open(path).unwrap())).unwrap();
        let nodata = decoder.get_tag_ascii_string(Tag::GdalNodata).unwrap();
        let DecodingResult::F32(values) = decoder.read_image().unwrap() else { panic!("not 32-bit floating point") };
        (values, nodata)
    }

    #[test]
    fn heights_come_back_bit_for_bit() {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("dem.tif");
        for (cols, rows) in [(3, 2), (256, 256), (257, 255), (300, 700)] {
            let dem = sample(cols, rows);
            write(&path, &dem, Quantity::Height.into(), TiffLayout::Plain, None).unwrap();
            let (values, nodata) = read(&path);
            assert_eq!(nodata, "-9999");
            assert_eq!(values.len(), cols * rows);
            for (stored, height) in values.iter().zip(&dem.values) {
                let expected = if height.is_nan() { -9999.0 } else { *height };
                assert_eq!(stored.to_bits(), f32::to_bits(expected));
            }
            let (grid, crs) = read_grid(&path).unwrap();
            assert_eq!(grid, dem.grid);
            assert_eq!(crs.unwrap().epsg, Some(6690));
        }
    }

    #[test]
    fn rows_make_the_same_file_as_the_whole() {
        let dir = tempfile::tempdir().unwrap();
        let [whole, rows] = ["whole.tif", "rows.tif"].map(|name| dir.path().join(name));
        for (cols, count) in [(3, 2), (256, 256), (257, 255), (300, 700), (20, 20_000)] {
            let mut dem = sample(cols, count);
            for lowest in [0.0, -9999.0] {
                dem.values[cols * count - 1] = lowest;
                write(&whole, &dem, Quantity::Height.into(), TiffLayout::Plain, None).unwrap();
                write_rows(&rows, &dem, dem.crs.as_ref(), Quantity::Height.into()).unwrap();
                assert!(std::fs::read(&whole).unwrap() == std::fs::read(&rows).unwrap(), "{cols} x {count}");
            }
        }
    }

    #[test]
    fn a_height_that_equals_the_mark_is_not_lost() {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("dem.tif");
        let mut dem = sample(20, 20);
        dem.values[0] = -9999.0;
        write(&path, &dem, Quantity::Height.into(), TiffLayout::Plain, None).unwrap();
        let (values, nodata) = read(&path);
        assert_eq!(values[0], -9999.0);
        assert!(values[21].is_nan());
        assert_eq!(nodata, "nan");
    }

    #[test]
    fn brightness_has_8_bits_and_0_where_there_is_no_data() {
        let dir = tempfile::tempdir().unwrap();
        let [whole, rows, cog] = ["whole.tif", "rows.tif", "cog.tif"].map(|name| dir.path().join(name));
        let mut dem = sample(300, 520);
        dem.values.iter_mut().enumerate().for_each(|(k, value)| *value = 1.0 + (k % 2541) as f32 / 10.0);
        (dem.values[7], dem.values[8]) = (f32::NAN, 254.7);
        write(&whole, &dem, Quantity::Shade.into(), TiffLayout::Plain, None).unwrap();
        write(&cog, &dem, Quantity::Shade.into(), TiffLayout::CloudOptimized, None).unwrap();
        write_rows(&rows, &dem, dem.crs.as_ref(), Quantity::Shade.into()).unwrap();
        assert!(std::fs::read(&whole).unwrap() == std::fs::read(&rows).unwrap());
        for path in [&whole, &cog] {
            let mut decoder = Decoder::new(BufReader::new(File::open(path).unwrap())).unwrap();
            assert_eq!(decoder.get_tag_ascii_string(Tag::GdalNodata).unwrap(), "0");
            let DecodingResult::U8(values) = decoder.read_image().unwrap() else { panic!("not 8 bits") };
            assert_eq!(values[7..9], [0, 255]);
            let far = |(&stored, value): (&u8, &f32)| (f32::from(stored) - value).abs() > 0.5;
            assert!(!values.iter().zip(&dem.values).any(far));
        }
    }

    #[test]
    fn a_system_without_a_code_comes_back_as_text() {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("dem.tif");
        let mut dem = sample(4, 4);
        let wkt = "PROJCS[\"own\",GEOGCS[\"g\",DATUM[\"d\",SPHEROID[\"s\",6378137,298.25]]],UNIT[\"metre\",1]]";
        dem.crs = Some(Crs { epsg: None, wkt: Some(wkt.into()) });
        write(&path, &dem, Quantity::Height.into(), TiffLayout::Plain, None).unwrap();
        assert_eq!(read_grid(&path).unwrap().1, dem.crs);
        dem.crs = None;
        write(&path, &dem, Quantity::Height.into(), TiffLayout::Plain, None).unwrap();
        assert_eq!(read_grid(&path).unwrap().1, None);
    }

    #[test]
    fn the_large_kind_reads_back_too() {
        let dem = sample(300, 520);
        for layout in [TiffLayout::Plain, TiffLayout::CloudOptimized] {
            let raster = Raster { kind: Kind::Big, ..Raster::of(&dem, Quantity::Height.into(), layout, None) };
            let mut file = std::io::Cursor::new(Vec::new());
            raster.write(&mut file).unwrap();
            assert_eq!(file.get_ref()[2], 43);
            file.set_position(0);
            let mut decoder = Decoder::new(file).unwrap();
            let DecodingResult::F32(values) = decoder.read_image().unwrap() else { panic!("not f32") };
            assert_eq!(values[299], dem.values[299]);
        }
    }
}
