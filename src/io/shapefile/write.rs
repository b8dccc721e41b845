//! Writes a layer as a shapefile.
//!
//! Shapes are written here, not through the `shapefile` crate. The crate adds a measure to every vertex of a
//! three-dimensional line. That makes files a third larger, and GIS programs then show meaningless measures.

use std::fs::File;
use std::io::{BufWriter, Write};
use std::path::Path;

use super::dbf;
use crate::layer::{Bounds, Geometry, Layer, NO_BOUNDS, Outer, Row, Shape, joined};
use tokosen_core::base::error::{Error, Result};
use tokosen_core::crs::Crs;

/// Shape type of areas without z.
const POLYGON: i32 = 5;
/// Shape type of lines with z.
const POLYLINE_Z: i32 = 13;
const HEADER_LENGTH: u64 = 100;
/// Bytes per record in addition to its parts, vertices and heights: header, type, bounds and counts.
const RECORD_OVERHEAD: u64 = 8 + 4 + 32 + 8;
/// Readers keep offsets in 32-bit integers, so files may not reach 2 GB.
const LENGTH_LIMIT: u64 = i32::MAX as u64;

/// Writes `.shp`, `.shx`, `.dbf`, `.cpg`, and `.prj` if the system is known.
///
/// Measures of vertices are optional in the format and are not written.
pub(crate) fn write(path: &Path, layer: &Layer<'_>, crs: Option<&Crs>) -> Result<()> {
    let length = HEADER_LENGTH + layer.rows.iter().map(record_length).sum::<u64>();
    if length.max(dbf::length(layer.columns, layer.rows.len())) > LENGTH_LIMIT {
        return Err(Error::file(
            path,
            "the layer does not fit into a shapefile, whose parts end at 2 GB; write a GeoPackage (.gpkg) instead",
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
    let count = row.shape.vertex_count() as u64;
    match &row.shape {
        Shape::Contour(..) | Shape::Line(_) | Shape::Point(_) => RECORD_OVERHEAD + 4 + 16 + 24 * count,
        Shape::Area(rings) => RECORD_OVERHEAD + 4 * rings.len() as u64 + 16 * count,
    }
}

fn write_shapes(path: &Path, layer: &Layer<'_>, length: u64) -> std::io::Result<()> {
    let mut shp = BufWriter::with_capacity(1 << 16, File::create(path)?);
    let mut shx = BufWriter::new(File::create(path.with_extension("shx"))?);
    let kind = match layer.geometry {
        // Layers of points are refused before this function.
        Geometry::Lines | Geometry::Points => POLYLINE_Z,
        Geometry::Areas => POLYGON,
    };
    let (mut bounds, mut heights) = (NO_BOUNDS, NO_HEIGHTS);
    for row in &layer.rows {
        bounds = joined(bounds, row.shape.bounds());
        let row = self::heights(&row.shape);
        heights = [heights[0].min(row[0]), heights[1].max(row[1])];
    }
    if layer.rows.is_empty() {
        (bounds, heights) = ([0.0; 4], [0.0; 2]);
    }
    let header = |length| header(length, kind, bounds, heights);
    shp.write_all(&header(length))?;
    shx.write_all(&header(HEADER_LENGTH + 8 * layer.rows.len() as u64))?;
    let mut offset = HEADER_LENGTH;
    for (number, row) in (1_i32..).zip(&layer.rows) {
        let length = record_length(row);
        // The format counts lengths and offsets in words of two bytes. A record's length does not include its header.
        let content = words(length - 8);
        shx.write_all(&words(offset).to_be_bytes())?;
        shx.write_all(&content.to_be_bytes())?;
        offset += length;

        shp.write_all(&number.to_be_bytes())?;
        shp.write_all(&content.to_be_bytes())?;
        write_record(&mut shp, &row.shape, kind)?;
    }
    shp.flush()?;
    shx.flush()
}

/// Writes a record without its header. Its counts fit, because its length was checked against the limit.
fn write_record(shp: &mut impl Write, shape: &Shape<'_>, kind: i32) -> std::io::Result<()> {
    shp.write_all(&kind.to_le_bytes())?;
    write_numbers(shp, in_order(shape.bounds()))?;
    let count = shape.vertex_count() as i32;
    if let Shape::Area(rings) = shape {
        let starts = rings.iter().scan(0, |start, ring| Some(std::mem::replace(start, *start + ring.len() as i32)));
        for number in [rings.len() as i32, count].into_iter().chain(starts) {
            shp.write_all(&number.to_le_bytes())?;
        }
        return shape.rings(Outer::Clockwise).flatten().try_for_each(|p| write_numbers(shp, p.to_array()));
    }
    for number in [1, count, 0] {
        shp.write_all(&number.to_le_bytes())?;
    }
    shape.vertices().try_for_each(|p| write_numbers(shp, p.truncate().to_array()))?;
    write_numbers(shp, heights(shape))?;
    shape.vertices().try_for_each(|p| write_numbers(shp, [p.z]))
}

fn write_numbers<const N: usize>(out: &mut impl Write, numbers: [f64; N]) -> std::io::Result<()> {
    numbers.iter().try_for_each(|number| out.write_all(&number.to_le_bytes()))
}

fn words(bytes: u64) -> i32 {
    i32::try_from(bytes / 2).expect("the length was checked against the limit")
}

fn header(length: u64, kind: i32, bounds: Bounds, heights: [f64; 2]) -> Vec<u8> {
    let mut bytes = Vec::with_capacity(HEADER_LENGTH as usize);
    bytes.extend(9994_i32.to_be_bytes());
    bytes.extend([0; 20]);
    bytes.extend(words(length).to_be_bytes());
    bytes.extend(1000_i32.to_le_bytes());
    bytes.extend(kind.to_le_bytes());
    // The range of measures comes last; there are no measures.
    for number in in_order(bounds).into_iter().chain(heights).chain([0.0; 2]) {
        bytes.extend(number.to_le_bytes());
    }
    bytes
}

/// Bounds in the format's order: least x and y, greatest x and y.
fn in_order([min_x, max_x, min_y, max_y]: Bounds) -> [f64; 4] {
    [min_x, min_y, max_x, max_y]
}

/// The height range of a layer without vertices.
const NO_HEIGHTS: [f64; 2] = [f64::INFINITY, f64::NEG_INFINITY];

/// Least and greatest height.
fn heights(shape: &Shape<'_>) -> [f64; 2] {
    shape.vertices().fold(NO_HEIGHTS, |range, p| [range[0].min(p.z), range[1].max(p.z)])
}
