//! A GeoTIFF's header: the placement of its cells and its coordinate reference system.
//!
//! The placement is computed as GDAL does it, and both agree to the last bit. If the file has no placement, a world
//! file beside it gives one. If it has no coordinate reference system, an `.aux.xml` or `.prj` gives it.

use std::fs::File;
use std::io::{BufReader, Read, Seek};
use std::path::Path;

use glam::DVec2;
use tiff::TiffError;
use tiff::decoder::Decoder;
use tiff::decoder::ifd::Value;
use tiff::tags::Tag;

use super::geokeys::GeoKeys;
use super::placement::{self, Placement};
use super::sidecar::{self, Aux};
use crate::ordinary::open_to_read;
use tokosen_core::base::Grid;
use tokosen_core::base::error::{Error, Result};
use tokosen_core::crs::Crs;

/// An open TIFF and what its header says.
pub(super) struct Tiff {
    pub decoder: Decoder<BufReader<File>>,
    pub placement: Placement,
    pub crs: Option<Crs>,
    /// Why the keys that describe a system do not give one, if there are such keys.
    pub crs_problem: Option<String>,
    pub keys: GeoKeys,
    /// The content of the `.aux.xml` beside it.
    pub aux: Aux,
    /// Bytes of the file.
    pub length: u64,
}

/// The grid of a GeoTIFF, and its coordinate reference system if it gives an EPSG code or well-known text.
pub(super) fn read_grid(path: &Path) -> Result<(Grid, Option<Crs>)> {
    let tiff = open(path)?;
    Ok((tiff.placement.grid, tiff.crs))
}

/// An error of the TIFF library about `path`: either the operating system's error, or `message`.
pub(super) fn wrong(path: &Path, message: &str, error: TiffError) -> Error {
    match error {
        // Errors of decompression have the same type, but no error number of the system.
        TiffError::IoError(e) if e.raw_os_error().is_some() => Error::io("read", path, e),
        other => Error::file_cause(path, message, other),
    }
}

/// Opens a GeoTIFF and reads its header.
///
/// # Errors
/// The file cannot be read, is not a TIFF, has no georeferencing, or is rotated, sheared or mirrored.
pub(super) fn open(path: &Path) -> Result<Tiff> {
    let file = open_to_read(path)?;
    let length = file.metadata().map_err(|e| Error::io("read", path, e))?.len();
    let wrong = |error| wrong(path, "is not a TIFF file that can be read", error);
    let mut decoder = Decoder::new(BufReader::with_capacity(1 << 16, file)).map_err(wrong)?;
    let (cols, rows) = decoder.dimensions().map_err(wrong)?;
    let size = (cols as usize, rows as usize);
    let header = Header {
        size,
        scale: doubles(&mut decoder, Tag::ModelPixelScaleTag).map_err(wrong)?,
        tiepoint: doubles(&mut decoder, Tag::ModelTiepointTag).map_err(wrong)?,
        matrix: doubles(&mut decoder, Tag::ModelTransformationTag).map_err(wrong)?,
    };
    let keys = GeoKeys {
        directory: decoder.find_tag_unsigned_vec(Tag::GeoKeyDirectoryTag).map_err(wrong)?.unwrap_or_default(),
        ascii: match decoder.find_tag(Tag::GeoAsciiParamsTag) {
            Ok(Some(Value::Ascii(text))) => text,
            // Text that is not ASCII gives no system; the placement is valid without it.
            _ => String::new(),
        },
        doubles: doubles(&mut decoder, Tag::GeoDoubleParamsTag).map_err(wrong)?,
    };
    let aux = sidecar::read_aux_xml(path)?.unwrap_or_default();
    let placement = if header.is_empty() {
        match aux.transform {
            Some(numbers) => {
                Some(placement::by_transform(numbers, size).map_err(|message| Error::file(path, message))?)
            }
            None => sidecar::read_world(path, &["tfw", "tifw", "tiffw", "wld"], size)?,
        }
    } else {
        None
    };
    let placement = match placement {
        Some(placement) => placement,
        None => header.placement(keys.pixel_is_point()).map_err(|message| Error::file(path, message))?,
    };
    // A text beside the file names a system better than the parameters of a projection do.
    let (described, crs_problem) = match keys.described() {
        Some(Ok(crs)) => (Some(crs), None),
        Some(Err(why)) => (None, Some(why)),
        None => (None, None),
    };
    let crs = match keys.crs().or_else(|| aux.crs.clone()).or(described) {
        Some(crs) => Some(crs),
        None => sidecar::read_prj(path)?,
    };
    Ok(Tiff { decoder, placement, crs, crs_problem, keys, aux, length })
}

fn doubles<R: Read + Seek>(decoder: &mut Decoder<R>, tag: Tag) -> std::result::Result<Vec<f64>, TiffError> {
    decoder.find_tag(tag)?.map_or_else(|| Ok(Vec::new()), Value::into_f64_vec)
}

/// The tags that place a raster, unchanged from the file.
struct Header {
    /// Columns and rows.
    size: (usize, usize),
    scale: Vec<f64>,
    tiepoint: Vec<f64>,
    matrix: Vec<f64>,
}

impl Header {
    /// Whether the file has no georeferencing.
    fn is_empty(&self) -> bool {
        self.scale.is_empty() && self.tiepoint.is_empty() && self.matrix.is_empty()
    }

    fn placement(&self, pixel_is_point: bool) -> std::result::Result<Placement, String> {
        // The affine transform: origin, and the step per column and per row.
        let (mut origin, across, down) = if let [sx, sy, ..] = self.scale[..]
            && sx != 0.0
            && sy != 0.0
        {
            let [col, row, _, x, y, _, ref more @ ..] = self.tiepoint[..] else {
                return Err("has a cell size but no tie point; it is not georeferenced".into());
            };
            // Some programs repeat the tie point for the other corners, which adds nothing.
            let _ = more;
            if sy < 0.0 {
                return Err("has a negative cell height, which programs understand in different ways; \
                            rewrite it with north up, for example with gdalwarp"
                    .into());
            }
            (DVec2::new(x - col * sx, y + row * sy), DVec2::new(sx, 0.0), DVec2::new(0.0, -sy))
        } else if let [a, b, _, x, d, e, _, y, ..] = self.matrix[..] {
            (DVec2::new(x, y), DVec2::new(a, d), DVec2::new(b, e))
        } else if self.tiepoint.len() > 6 {
            return Err("is placed by ground control points; warp it to a grid first, for example with gdalwarp".into());
        } else {
            return Err("has no georeferencing (no cell size and tie point, no transformation, no world file), \
                        so its cells have no place on a map"
                .into());
        };
        if pixel_is_point {
            origin -= 0.5 * (across + down);
        }
        placement::north_up(origin, across, down, self.size)
    }
}

#[cfg(test)]
mod tests {
    use std::io::Cursor;

    use tiff::encoder::{TiffEncoder, colortype};

    use super::*;

    /// Writes a picture of 4 x 3 cells with the given tags.
    fn file(tags: &[(Tag, &[f64])], keys: &[u16]) -> tempfile::NamedTempFile {
        let mut bytes = Cursor::new(Vec::new());
        let mut encoder = TiffEncoder::new(&mut bytes).unwrap();
        let mut picture = encoder.new_image::<colortype::Gray8>(4, 3).unwrap();
        for (tag, values) in tags {
            picture.encoder().write_tag(*tag, *values).unwrap();
        }
        if !keys.is_empty() {
            picture.encoder().write_tag(Tag::GeoKeyDirectoryTag, keys).unwrap();
        }
        picture.write_data(&[0; 12]).unwrap();
        let file = tempfile::Builder::new().suffix(".tif").tempfile().unwrap();
        std::fs::write(file.path(), bytes.into_inner()).unwrap();
        file
    }

    const SCALE: (Tag, &[f64]) = (Tag::ModelPixelScaleTag, &[10.0, 20.0, 0.0]);
    const POINT: [u16; 8] = [1, 1, 0, 1, 1025, 0, 1, 2];

    fn grid(tags: &[(Tag, &[f64])], keys: &[u16]) -> Result<(Grid, Option<Crs>)> {
        read_grid(file(tags, keys).path())
    }

    #[test]
    fn any_tie_point_gives_the_corner() {
        let expected = Grid { corner: DVec2::new(1000.0, 500.0), cell: DVec2::new(10.0, 20.0), cols: 4, rows: 3 };
        for tie in [[0.0, 0.0, 0.0, 1000.0, 500.0, 0.0], [2.0, 3.0, 0.0, 1020.0, 440.0, 0.0]] {
            assert_eq!(grid(&[SCALE, (Tag::ModelTiepointTag, &tie)], &[]).unwrap(), (expected, None));
        }
        let matrix = [10., 0., 0., 1000., 0., -20., 0., 500., 0., 0., 0., 0., 0., 0., 0., 1.];
        assert_eq!(grid(&[(Tag::ModelTransformationTag, &matrix)], &[]).unwrap().0, expected);
    }

    #[test]
    fn points_lie_half_a_cell_inside() {
        let tie = [0.0, 0.0, 0.0, 1000.0, 500.0, 0.0];
        let (grid, _) = grid(&[SCALE, (Tag::ModelTiepointTag, &tie)], &POINT).unwrap();
        assert_eq!(grid.corner, DVec2::new(995.0, 510.0));
    }

    #[test]
    fn south_up_gives_the_same_cells_with_north_up() {
        let matrix = [10., 0., 0., 1000., 0., 20., 0., 440., 0., 0., 0., 0., 0., 0., 0., 1.];
        let corner = |keys| grid(&[(Tag::ModelTransformationTag, &matrix)], keys).unwrap().0.corner;
        assert_eq!(corner(&[]), DVec2::new(1000.0, 500.0));
        // The centre of the south-west cell lies at 1000, 440.
        assert_eq!(corner(&POINT), DVec2::new(995.0, 490.0));
    }

    #[test]
    fn what_is_no_north_up_grid_is_refused_with_the_reason() {
        let tie: (Tag, &[f64]) = (Tag::ModelTiepointTag, &[0.0, 0.0, 0.0, 1000.0, 500.0, 0.0]);
        let many: (Tag, &[f64]) = (Tag::ModelTiepointTag, &[0.0; 24]);
        const ROTATED: [f64; 16] = [10., 1., 0., 0., 1., -10., 0., 0., 0., 0., 0., 0., 0., 0., 0., 1.];
        const MIRRORED: [f64; 16] = [-10., 0., 0., 0., 0., -10., 0., 0., 0., 0., 0., 0., 0., 0., 0., 1.];
        let matrix = |m: &'static [f64]| vec![(Tag::ModelTransformationTag, m)];
        type Tags<'a> = Vec<(Tag, &'a [f64])>;
        let cases: [(Tags<'_>, &str); 8] = [
            (vec![], "no georeferencing"),
            (vec![tie], "no georeferencing"),
            (vec![SCALE], "no tie point"),
            (vec![many], "control points"),
            (matrix(&ROTATED), "rotated"),
            (matrix(&MIRRORED), "east to west"),
            (vec![(Tag::ModelPixelScaleTag, &[10.0, -10.0, 0.0]), tie], "negative cell height"),
            (vec![(Tag::ModelPixelScaleTag, &[10.0, f64::NAN, 0.0]), tie], "not a valid grid"),
        ];
        for (tags, reason) in cases {
            let error = grid(&tags, &[]).unwrap_err().to_string();
            assert!(error.contains(reason), "{error}");
        }
    }

    #[test]
    fn what_is_no_tiff_is_refused() {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("notes.tif");
        assert!(matches!(read_grid(&path), Err(Error::Io { action: "read", .. })));
        assert!(read_grid(dir.path()).is_err());
        let whole = std::fs::read(file(&[SCALE], &[]).path()).unwrap();
        for content in [&b""[..], b"II", b"not a raster at all", b"II*\0\x08\0\0\0", &whole[..whole.len() / 2]] {
            std::fs::write(&path, content).unwrap();
            let error = read_grid(&path).unwrap_err();
            assert!(matches!(error, Error::File { .. }), "{error:?}");
            assert!(error.to_string().contains("not a TIFF"), "{error}");
        }
    }
}
