//! GeoTIFF height maps: 32-bit floating point in compressed tiles.
//!
//! Cells without data hold -9999, and the nodata tag names this value. GDAL and QGIS would accept NaN, but older ArcGIS
//! versions and most self-written readers treat NaN as a height. Tiles pass the floating point predictor and are then
//! deflated, which halves the size of smooth terrain. They are compressed in parallel and written in order: the file
//! does not depend on the number of threads.

use std::io::{Seek, Write};
use std::path::Path;

use flate2::Compression;
use flate2::write::ZlibEncoder;
use rayon::prelude::*;
use tiff::TiffError;
use tiff::encoder::{TiffEncoder, TiffKind, TiffKindBig, TiffKindStandard};
use tiff::tags::{CompressionMethod, PhotometricInterpretation, PlanarConfiguration, Predictor, SampleFormat, Tag};

use super::geokeys::GeoKeys;
use super::output::{Filled, create};
use super::quantity::{Quantity, STANDARD_ERROR, Values};
use crate::base::Grid;
use crate::base::error::Result;
use crate::dem::Dem;
use crate::io::maker::PROGRAM;

/// Side of a tile in cells. The format requires a multiple of 16.
const TILE: usize = 256;

/// Tiles that are compressed before they are written. This bounds the memory in addition to the height map.
const BATCH: usize = 64;

/// The offsets of a classic TIFF have 32 bits. A margin is left for tiles that do not compress.
const CLASSIC_LIMIT: u64 = 4_000_000_000;

/// The usual nodata value. If a cell really is that low, NaN is used instead.
const NODATA: f32 = -9999.0;

/// GDAL's own tag: name and unit of the values.
const GDAL_METADATA: Tag = Tag::Unknown(42112);

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

/// Writes `dem` to `path`, with a second band of `errors` if there are any.
pub(super) fn write(path: &Path, dem: &Dem, values: Values, errors: Option<&[f32]>) -> Result<()> {
    let bands = 1 + u64::from(errors.is_some());
    let tiles = bands * dem.grid.cols.div_ceil(TILE) as u64 * dem.grid.rows.div_ceil(TILE) as u64;
    let big = tiles * (TILE * TILE * size_of::<f32>()) as u64 > CLASSIC_LIMIT;
    create(path, |out| {
        let written = if big {
            write_kind::<TiffKindBig>(out, dem, values, errors)
        } else {
            write_kind::<TiffKindStandard>(out, dem, values, errors)
        };
        written.map_err(|error| match error {
            TiffError::IoError(error) => Filled::Io(error),
            other => Filled::Format(other.into()),
        })
    })
}

/// Long because it lists all tags of the file.
fn write_kind<K: TiffKind>(
    out: impl Write + Seek,
    dem: &Dem,
    values: Values,
    errors: Option<&[f32]>,
) -> std::result::Result<(), TiffError> {
    let grid = dem.grid;
    let nodata = if dem.values.contains(&NODATA) { f32::NAN } else { NODATA };
    let mut encoder = TiffEncoder::<_, K>::new_generic(out)?;
    let mut directory = encoder.image_directory()?;

    let across = grid.cols.div_ceil(TILE);
    let a_band = across * grid.rows.div_ceil(TILE);
    let bands: Vec<&[f32]> = std::iter::once(dem.values.as_slice()).chain(errors).collect();
    let count = bands.len() * a_band;
    let (mut offsets, mut lengths) = (Vec::with_capacity(count), Vec::with_capacity(count));
    for first in (0..count).step_by(BATCH) {
        let batch: Vec<std::io::Result<Vec<u8>>> = (first..count.min(first + BATCH))
            .into_par_iter()
            .map(|k| (bands[k / a_band], k % a_band))
            .map(|(band, tile)| compress(&tile_bytes(band, &grid, [tile % across, tile / across], nodata)))
            .collect();
        for tile in batch {
            let tile = tile?;
            offsets.push(K::convert_offset(directory.write_data(tile.as_slice())?)?);
            lengths.push(K::convert_offset(tile.len() as u64)?);
        }
    }

    // The caller has checked that both fit into 31 bits.
    directory.write_tag(Tag::ImageWidth, grid.cols as u32)?;
    directory.write_tag(Tag::ImageLength, grid.rows as u32)?;
    directory.write_tag(Tag::BitsPerSample, vec![32_u16; bands.len()].as_slice())?;
    directory.write_tag(Tag::Compression, CompressionMethod::Deflate)?;
    directory.write_tag(Tag::PhotometricInterpretation, PhotometricInterpretation::BlackIsZero)?;
    directory.write_tag(Tag::SamplesPerPixel, bands.len() as u16)?;
    // The bands are stored one after the other. A reader of heights need not read the errors.
    let planar = if errors.is_some() { PlanarConfiguration::Planar } else { PlanarConfiguration::Chunky };
    directory.write_tag(Tag::PlanarConfiguration, planar)?;
    if errors.is_some() {
        directory.write_tag(Tag::ExtraSamples, 0_u16)?;
    }
    directory.write_tag(Tag::Predictor, Predictor::FloatingPoint)?;
    directory.write_tag(Tag::TileWidth, TILE as u32)?;
    directory.write_tag(Tag::TileLength, TILE as u32)?;
    directory.write_tag(Tag::TileOffsets, K::convert_slice(&offsets))?;
    directory.write_tag(Tag::TileByteCounts, K::convert_slice(&lengths))?;
    directory.write_tag(Tag::SampleFormat, vec![SampleFormat::IEEEFP.to_u16(); bands.len()].as_slice())?;
    directory.write_tag(Tag::Software, PROGRAM)?;
    directory.write_tag(Tag::ModelPixelScaleTag, [grid.cell.x, grid.cell.y, 0.0])?;
    directory.write_tag(Tag::ModelTiepointTag, [0.0, 0.0, 0.0, grid.corner.x, grid.corner.y, 0.0])?;
    directory.write_tag(Tag::GdalNodata, if nodata.is_nan() { "nan" } else { "-9999" })?;
    directory.write_tag(GDAL_METADATA, metadata(values, errors.is_some()).as_str())?;
    if let Some(keys) = dem.crs.as_ref().and_then(GeoKeys::of) {
        directory.write_tag(Tag::GeoKeyDirectoryTag, keys.directory.as_slice())?;
        if !keys.ascii.is_empty() {
            directory.write_tag(Tag::GeoAsciiParamsTag, keys.ascii.as_str())?;
        }
    }
    directory.finish()
}

fn compress(bytes: &[u8]) -> std::io::Result<Vec<u8>> {
    let mut encoder = ZlibEncoder::new(Vec::with_capacity(bytes.len() / 2), Compression::default());
    encoder.write_all(bytes)?;
    encoder.finish()
}

/// The bytes of one tile after the predictor. Outside the map the last column and row are repeated.
fn tile_bytes(values: &[f32], grid: &Grid, [tile_col, tile_row]: [usize; 2], nodata: f32) -> Vec<u8> {
    let (cols, rows) = (grid.cols, grid.rows);
    let mut bytes = vec![0; TILE * TILE * size_of::<f32>()];
    for (row, line) in bytes.chunks_exact_mut(TILE * size_of::<f32>()).enumerate() {
        let start = (tile_row * TILE + row).min(rows - 1) * cols;
        let left = tile_col * TILE;
        for col in 0..TILE {
            let height = values[start + (left + col).min(cols - 1)];
            let stored = if height.is_nan() { nodata } else { height };
            for (plane, byte) in stored.to_be_bytes().into_iter().enumerate() {
                line[plane * TILE + col] = byte;
            }
        }
        // The predictor stores the difference to the previous byte, over all four byte planes of the line.
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
    use crate::crs::Crs;

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
            write(&path, &dem, Quantity::Height.into(), None).unwrap();
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
    fn a_height_that_equals_the_mark_is_not_lost() {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("dem.tif");
        let mut dem = sample(20, 20);
        dem.values[0] = -9999.0;
        write(&path, &dem, Quantity::Height.into(), None).unwrap();
        let (values, nodata) = read(&path);
        assert_eq!(values[0], -9999.0);
        assert!(values[21].is_nan());
        assert_eq!(nodata, "nan");
    }

    #[test]
    fn a_system_without_a_code_comes_back_as_text() {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("dem.tif");
        let mut dem = sample(4, 4);
        let wkt = "PROJCS[\"own\",GEOGCS[\"g\",DATUM[\"d\",SPHEROID[\"s\",6378137,298.25]]],UNIT[\"metre\",1]]";
        dem.crs = Some(Crs { epsg: None, wkt: Some(wkt.into()) });
        write(&path, &dem, Quantity::Height.into(), None).unwrap();
        assert_eq!(read_grid(&path).unwrap().1, dem.crs);
        dem.crs = None;
        write(&path, &dem, Quantity::Height.into(), None).unwrap();
        assert_eq!(read_grid(&path).unwrap().1, None);
    }

    #[test]
    fn the_large_kind_reads_back_too() {
        let dem = sample(300, 20);
        let mut file = std::io::Cursor::new(Vec::new());
        write_kind::<TiffKindBig>(&mut file, &dem, Quantity::Height.into(), None).unwrap();
        assert_eq!(file.get_ref()[2], 43);
        file.set_position(0);
        let DecodingResult::F32(values) = Decoder::new(file).unwrap().read_image().unwrap() else { panic!("not f32") };
        assert_eq!(values[299], dem.values[299]);
    }
}
