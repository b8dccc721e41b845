//! Writes a layer as a shapefile.
//!
//! Shapes are written here and not through the `shapefile` crate, because it adds a measure to every vertex of a
//! three-dimensional line: a third more bytes, and GIS programs then offer measures that mean nothing.

use std::fs::File;
use std::io::{BufWriter, Write};
use std::path::Path;

use super::dbf;
use crate::crs::Crs;
use crate::error::{Error, Result};
use crate::io::layer::{Layer, Row};

/// Shape type of lines with z.
const POLYLINE_Z: i32 = 13;
const HEADER_LENGTH: u64 = 100;
/// Bytes of a record beside its vertices: its header, type, bounds, counts, the start of its part, and the range of z.
const RECORD_OVERHEAD: u64 = 8 + 4 + 32 + 8 + 4 + 16;
/// Readers keep offsets in 32-bit integers, so files may not reach 2 GB.
const LENGTH_LIMIT: u64 = i32::MAX as u64;

/// Writes `.shp`, `.shx`, `.dbf`, `.cpg`, and `.prj` if the system is known.
///
/// Measures of vertices are optional in the format and left out.
pub(in crate::io) fn write(path: &Path, layer: &Layer<'_>, crs: Option<&Crs>) -> Result<()> {
    let length = HEADER_LENGTH + layer.rows.iter().map(record_length).sum::<u64>();
    // A record of the attribute table is shorter than the shape it belongs to, so the shapes reach the limit first.
    if length > LENGTH_LIMIT {
        return Err(Error::file(
            path,
            "the lines do not fit into a shapefile, which ends at 2 GB; write a GeoPackage (.gpkg) instead",
        ));
    }
    write_shapes(path, layer, length).map_err(|e| Error::io("write", path, e))?;
    let attributes = path.with_extension("dbf");
    dbf::write(&attributes, layer.columns, &layer.rows).map_err(|e| Error::io("write", &attributes, e))?;
    let mut texts = vec![("cpg", "UTF-8")];
    texts.extend(crs.and_then(|crs| crs.wkt1().or(crs.wkt())).map(|wkt| ("prj", wkt)));
    for (extension, text) in texts {
        let path = path.with_extension(extension);
        std::fs::write(&path, text).map_err(|e| Error::io("write", &path, e))?;
    }
    Ok(())
}

fn record_length(row: &Row<'_>) -> u64 {
    RECORD_OVERHEAD + 24 * row.points.len() as u64
}

fn write_shapes(path: &Path, layer: &Layer<'_>, length: u64) -> std::io::Result<()> {
    let mut shp = BufWriter::with_capacity(1 << 16, File::create(path)?);
    let mut shx = BufWriter::new(File::create(path.with_extension("shx"))?);
    let mut bounds = Bounds::EMPTY;
    let mut heights = [f64::INFINITY, f64::NEG_INFINITY];
    for row in &layer.rows {
        bounds = bounds.joined(Bounds::of(row));
        heights = [heights[0].min(row.z), heights[1].max(row.z)];
    }
    if layer.rows.is_empty() {
        (bounds, heights) = (Bounds([0.0; 4]), [0.0; 2]);
    }
    shp.write_all(&header(length, bounds, heights))?;
    shx.write_all(&header(HEADER_LENGTH + 8 * layer.rows.len() as u64, bounds, heights))?;
    let mut offset = HEADER_LENGTH;
    for (number, row) in (1_i32..).zip(&layer.rows) {
        let length = record_length(row);
        // Lengths and offsets are counted in words of two bytes, and the header of a record is not part of its length.
        let content = words(length - 8);
        shx.write_all(&words(offset).to_be_bytes())?;
        shx.write_all(&content.to_be_bytes())?;
        offset += length;

        shp.write_all(&number.to_be_bytes())?;
        shp.write_all(&content.to_be_bytes())?;
        shp.write_all(&POLYLINE_Z.to_le_bytes())?;
        for bound in Bounds::of(row).0 {
            shp.write_all(&bound.to_le_bytes())?;
        }
        for count in [1, row.points.len() as i32, 0] {
            shp.write_all(&count.to_le_bytes())?;
        }
        for point in row.points {
            shp.write_all(&point.x.to_le_bytes())?;
            shp.write_all(&point.y.to_le_bytes())?;
        }
        for _ in 0..row.points.len() + 2 {
            shp.write_all(&row.z.to_le_bytes())?;
        }
    }
    shp.flush()?;
    shx.flush()
}

fn words(bytes: u64) -> i32 {
    i32::try_from(bytes / 2).expect("the length was checked against the limit")
}

fn header(length: u64, bounds: Bounds, heights: [f64; 2]) -> Vec<u8> {
    let mut bytes = Vec::with_capacity(HEADER_LENGTH as usize);
    bytes.extend(9994_i32.to_be_bytes());
    bytes.extend([0; 20]);
    bytes.extend(words(length).to_be_bytes());
    bytes.extend(1000_i32.to_le_bytes());
    bytes.extend(POLYLINE_Z.to_le_bytes());
    // The range of measures comes last: there are none.
    for number in bounds.0.into_iter().chain(heights).chain([0.0; 2]) {
        bytes.extend(number.to_le_bytes());
    }
    bytes
}

/// Least x and y, greatest x and y.
#[derive(Clone, Copy)]
struct Bounds([f64; 4]);

impl Bounds {
    const EMPTY: Self = Self([f64::INFINITY, f64::INFINITY, f64::NEG_INFINITY, f64::NEG_INFINITY]);

    fn of(row: &Row<'_>) -> Self {
        row.points.iter().fold(Self::EMPTY, |bounds, p| bounds.joined(Self([p.x, p.y, p.x, p.y])))
    }

    fn joined(self, other: Self) -> Self {
        let (Self(a), Self(b)) = (self, other);
        Self([a[0].min(b[0]), a[1].min(b[1]), a[2].max(b[2]), a[3].max(b[3])])
    }
}
