//! Writes a layer as GeoJSON, feature by feature.

use std::fs::File;
use std::io::{BufWriter, Write};
use std::path::Path;

use glam::DVec2;

use crate::layer::{Cell, Layer, Outer, Shape};
use crate::maker::MADE_BY;
use tokosen_core::base::error::{Error, Result};
use tokosen_core::crs::Crs;

/// Writes one file.
///
/// The system is named in the `crs` member of the older GeoJSON version, which GIS programs read. For WGS 84 the
/// standard requires no such member, so it is omitted. An unknown system is written as `null`; otherwise readers would
/// take the coordinates for degrees.
pub(crate) fn write(path: &Path, layer: &Layer<'_>, crs: Option<&Crs>) -> Result<()> {
    let run = || -> std::io::Result<()> {
        let mut out = BufWriter::with_capacity(1 << 16, File::create(path)?);
        out.write_all(b"{\"type\":\"FeatureCollection\",\"name\":")?;
        serde_json::to_writer(&mut out, layer.name)?;
        write!(out, ",\"description\":\"{MADE_BY}\"")?;
        if let Some(member) = crs_member(crs) {
            write!(out, ",\"crs\":{member}")?;
        }
        out.write_all(b",\"features\":[")?;
        for (i, row) in layer.rows.iter().enumerate() {
            out.write_all(if i == 0 { b"\n{\"type\":\"Feature\"" } else { b",\n{\"type\":\"Feature\"" })?;
            for (j, (column, cell)) in layer.columns.iter().zip(&row.cells).enumerate() {
                out.write_all(if j == 0 { b",\"properties\":{\"" } else { b",\"" })?;
                out.write_all(column.name.as_bytes())?;
                out.write_all(b"\":")?;
                match cell {
                    Cell::Real(number) => serde_json::to_writer(&mut out, number)?,
                    Cell::Int(number) => serde_json::to_writer(&mut out, number)?,
                    Cell::Text(text) => serde_json::to_writer(&mut out, text)?,
                    Cell::Bool(yes) => serde_json::to_writer(&mut out, yes)?,
                    Cell::Null => out.write_all(b"null")?,
                }
            }
            // The member is required, even if it is empty.
            out.write_all(if layer.columns.is_empty() { b",\"properties\":{}" } else { b"}" })?;
            write_shape(&mut out, &row.shape)?;
            out.write_all(b"}")?;
        }
        out.write_all(b"\n]}\n")?;
        out.flush()
    };
    run().map_err(|e| Error::io("write", path, e))
}

fn write_shape(out: &mut impl Write, shape: &Shape<'_>) -> std::io::Result<()> {
    if let Shape::Point(point) = shape {
        let Some(point) = point else { return out.write_all(b",\"geometry\":null") };
        out.write_all(b",\"geometry\":{\"type\":\"Point\",\"coordinates\":")?;
        write_position(out, 0, *point)?;
        return out.write_all(b"]}");
    }
    if let Shape::Area(_) = shape {
        out.write_all(b",\"geometry\":{\"type\":\"Polygon\",\"coordinates\":[")?;
        for (i, ring) in shape.rings(Outer::Counterclockwise).enumerate() {
            out.write_all(if i == 0 { b"[" } else { b",[" })?;
            for (j, point) in ring.enumerate() {
                write_position(out, j, point)?;
                out.write_all(b"]")?;
            }
            out.write_all(b"]")?;
        }
        return out.write_all(b"]}");
    }
    out.write_all(b",\"geometry\":{\"type\":\"LineString\",\"coordinates\":[")?;
    // Most lines are level, and their height may have many digits. It is formatted only once.
    let (mut height, mut digits) = (None, Vec::new());
    for (j, point) in shape.vertices().enumerate() {
        write_position(out, j, point.truncate())?;
        if height != Some(point.z.to_bits()) {
            height = Some(point.z.to_bits());
            digits = serde_json::to_vec(&point.z)?;
        }
        out.write_all(b",")?;
        out.write_all(&digits)?;
        out.write_all(b"]")?;
    }
    out.write_all(b"]}")
}

/// Writes the position with the index `place` of a list, with its separator.
fn write_position(out: &mut impl Write, place: usize, point: DVec2) -> std::io::Result<()> {
    out.write_all(if place == 0 { b"[" } else { b",[" })?;
    serde_json::to_writer(&mut *out, &point.x)?;
    out.write_all(b",")?;
    Ok(serde_json::to_writer(out, &point.y)?)
}

/// The value of the `crs` member. `None` if the member is omitted.
fn crs_member(crs: Option<&Crs>) -> Option<serde_json::Value> {
    let name = match (crs.and_then(|crs| crs.epsg), crs.and_then(Crs::wkt)) {
        (Some(4326), _) => return None,
        (Some(code), _) => format!("urn:ogc:def:crs:EPSG::{code}"),
        // A system without a code can only be named by its well-known text, which GDAL reads too.
        (None, Some(wkt)) => wkt.to_owned(),
        (None, None) => return Some(serde_json::Value::Null),
    };
    Some(serde_json::json!({ "type": "name", "properties": { "name": name } }))
}
