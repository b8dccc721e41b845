//! What makes a GeoTIFF a Cloud Optimized GeoTIFF, besides tiles, overviews and directories at its beginning.
//!
//! GDAL reads a statement about the structure behind the header of the file, and bytes around each tile. With them it
//! gets a tile with one request, without the tables of places. See "Header ghost area" in GDAL's page of its COG driver.

/// The statement about the structure. `NO` means that no other program has changed the file; GDAL overwrites it, for
/// which the space behind it is left.
const STRUCTURE: &str = "LAYOUT=IFDS_BEFORE_DATA\nBLOCK_ORDER=ROW_MAJOR\nBLOCK_LEADER=SIZE_AS_UINT4\n\
                         BLOCK_TRAILER=LAST_4_BYTES_REPEATED\nKNOWN_INCOMPATIBLE_EDITION=NO\n ";

/// The text behind the header of the file.
pub(super) fn structure() -> String {
    format!("GDAL_STRUCTURAL_METADATA_SIZE={:06} bytes\n{STRUCTURE}", STRUCTURE.len())
}

/// The bytes before and behind a tile: its length, and its last four bytes again.
pub(super) fn around(tile: &[u8]) -> [Vec<u8>; 2] {
    let last = &tile[tile.len().saturating_sub(4)..];
    [(tile.len() as u32).to_le_bytes().to_vec(), last.to_vec()]
}

#[cfg(test)]
mod tests {
    use std::fs::File;
    use std::io::BufReader;
    use std::path::Path;

    use tiff::decoder::{Decoder, DecodingResult};
    use tiff::tags::Tag;

    use super::super::tests::sample;
    use super::super::{
        Quantity, RasterParams, TiffLayout, read_dem, read_standard_errors, write_raster, write_with_errors,
    };
    use super::*;

    const PARAMS: RasterParams = RasterParams {
        quantity: Quantity::Height,
        png: super::super::PngEncoding::Gray16,
        tiff: TiffLayout::CloudOptimized,
        unit: tokosen_core::base::ElevationUnit::Metre,
    };

    struct Read {
        size: (u32, u32),
        /// The places of the tiles in the file.
        offsets: Vec<u64>,
        /// Their bytes.
        lengths: Vec<u64>,
        values: Vec<f32>,
    }

    /// The images of a file.
    fn images(path: &Path) -> Vec<Read> {
        let mut decoder = Decoder::new(BufReader::new(File::open(path).unwrap())).unwrap();
        let mut found = Vec::new();
        loop {
            let [offsets, lengths] =
                [Tag::TileOffsets, Tag::TileByteCounts].map(|tag| decoder.get_tag_u64_vec(tag).unwrap());
            let DecodingResult::F32(values) = decoder.read_image().unwrap() else { panic!("not f32") };
            found.push(Read { size: decoder.dimensions().unwrap(), offsets, lengths, values });
            if !decoder.more_images() {
                return found;
            }
            decoder.next_image().unwrap();
            let kind = decoder.find_tag_unsigned::<u32>(Tag::NewSubfileType).unwrap();
            assert_eq!(kind, Some(1), "a reduced image");
        }
    }

    #[test]
    fn the_statement_has_the_length_that_it_states_and_its_place() {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("dem.tif");
        write_raster(&path, &sample(700, 300), &PARAMS).unwrap();
        let bytes = std::fs::read(&path).unwrap();
        let text = structure();
        let (first, rest) = text.split_once('\n').unwrap();
        assert_eq!(first, format!("GDAL_STRUCTURAL_METADATA_SIZE={:06} bytes", rest.len()));
        assert_eq!(&bytes[8..8 + text.len()], text.as_bytes());
        // The first directory begins on a whole word.
        let first = u32::from_le_bytes([bytes[4], bytes[5], bytes[6], bytes[7]]) as usize;
        assert_eq!(first, (8 + text.len()).next_multiple_of(4));
    }

    #[test]
    fn directories_come_first_then_the_smallest_overview_and_the_map_last() {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("dem.tif");
        let dem = sample(1100, 700);
        write_raster(&path, &dem, &PARAMS).unwrap();
        let bytes = std::fs::read(&path).unwrap();
        let images = images(&path);
        let sizes: Vec<_> = images.iter().map(|image| image.size).collect();
        assert_eq!(sizes, [(1100, 700), (550, 350), (275, 175), (138, 88)]);
        let mut end = None;
        for image in images.iter().rev() {
            for (&offset, &length) in image.offsets.iter().zip(&image.lengths) {
                // The length is before each tile, and its last four bytes are behind it again. Nothing is between tiles.
                let (start, length) = (offset as usize, length as usize);
                assert!(end.is_none_or(|end| end == start - 4));
                assert_eq!(bytes[start - 4..start], (length as u32).to_le_bytes());
                assert_eq!(bytes[start + length - 4..start + length], bytes[start + length..start + length + 4]);
                end = Some(start + length + 4);
            }
        }
        assert_eq!(end, Some(bytes.len()));
        // Values of the first overview: the mean of those that are not the mark.
        for (i, value) in images[1].values.iter().enumerate() {
            let (col, row) = (i % 550 * 2, i / 550 * 2);
            let below = [(0, 0), (1, 0), (0, 1), (1, 1)].map(|(x, y)| dem.values[(row + y) * 1100 + col + x]);
            let known: Vec<f64> = below.into_iter().filter(|v| !v.is_nan()).map(f64::from).collect();
            assert_eq!(*value, (known.iter().sum::<f64>() / known.len() as f64) as f32);
        }
    }

    #[test]
    fn heights_and_errors_come_back_bit_for_bit() {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("dem.tif");
        let bits = |values: &[f32]| values.iter().map(|v| v.to_bits()).collect::<Vec<u32>>();
        for (cols, rows) in [(3, 2), (256, 256), (257, 900)] {
            let dem = sample(cols, rows);
            let errors: Vec<f32> = dem.values.iter().map(|v| v * 1e-3).collect();
            for layout in [TiffLayout::Plain, TiffLayout::CloudOptimized] {
                let params = RasterParams { tiff: layout, ..PARAMS };
                write_with_errors(&path, &dem, &errors, &params).unwrap();
                let read = read_dem(&path).unwrap().value.dem;
                assert_eq!((read.grid, read.crs.and_then(|crs| crs.epsg)), (dem.grid, Some(6690)));
                assert!(bits(&read.values) == bits(&dem.values), "{layout:?} {cols} x {rows}");
                let read = read_standard_errors(&path).unwrap().unwrap();
                assert!(bits(&read.values) == bits(&errors), "{layout:?} {cols} x {rows}");
            }
        }
    }

    #[test]
    fn the_bytes_do_not_depend_on_the_number_of_threads() {
        let dir = tempfile::tempdir().unwrap();
        let dem = sample(900, 1300);
        let bytes = [1, 4].map(|threads| {
            let path = dir.path().join(format!("{threads}.tif"));
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| write_raster(&path, &dem, &PARAMS)).unwrap();
            std::fs::read(path).unwrap()
        });
        assert!(bytes[0] == bytes[1]);
    }
}
