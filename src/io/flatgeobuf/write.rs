//! Writes a layer as FlatGeobuf.

use std::fs::File;
use std::io::{BufWriter, Write};
use std::path::Path;

use ::flatgeobuf::geozero::error::Result as Written;
use ::flatgeobuf::geozero::{ColumnValue, FeatureProcessor, GeomProcessor, PropertyProcessor};
use ::flatgeobuf::{ColumnType, FgbCrs, FgbWriter, FgbWriterOptions, GeometryType};

use crate::layer::{Cell, Geometry, Kind, Layer, Outer, Row, Shape};
use crate::maker::MADE_BY;
use tokosen_core::base::error::{Error, Result};
use tokosen_core::crs::Crs;

/// The largest number of vertices per feature: a feature's table ends at 2 GB, and a vertex takes 24 bytes.
const MAX_VERTICES: usize = 80_000_000;

/// Writes one file: the header, the spatial index, then the features in the order of the index.
///
/// Missing attribute values are omitted. The system is written as EPSG code and WKT if they are known.
pub(crate) fn write(path: &Path, layer: &Layer<'_>, crs: Option<&Crs>) -> Result<()> {
    if layer.rows.iter().any(|row| row.shape.vertex_count() > MAX_VERTICES) {
        let message = "a feature does not fit into a FlatGeobuf; write a GeoPackage (.gpkg) instead";
        return Err(Error::file(path, message));
    }
    let failed = |e| match e {
        ::flatgeobuf::Error::IO(e) => Error::io("write", path, e),
        other => Error::file_cause(path, "the FlatGeobuf cannot be written", other),
    };
    let name = crs.and_then(Crs::name);
    let code = crs.and_then(|crs| crs.epsg).and_then(|code| i32::try_from(code).ok());
    let options = FgbWriterOptions {
        // An index without entries is not valid.
        write_index: !layer.rows.is_empty(),
        detect_type: false,
        promote_to_multi: false,
        has_z: layer.geometry == Geometry::Lines,
        crs: FgbCrs {
            org: code.map(|_| "EPSG"),
            code: code.unwrap_or_default(),
            name: name.as_deref(),
            wkt: crs.and_then(|crs| crs.wkt1().or(crs.wkt())),
            ..FgbCrs::default()
        },
        description: Some(MADE_BY),
        ..FgbWriterOptions::default()
    };
    let kind = match layer.geometry {
        // Layers of points are refused before this function.
        Geometry::Lines | Geometry::Points => GeometryType::LineString,
        Geometry::Areas => GeometryType::Polygon,
    };
    let mut writer = FgbWriter::create_with_options(layer.name, kind, options).map_err(failed)?;
    for column in layer.columns {
        let (kind, width) = match column.kind {
            Kind::Real | Kind::Height | Kind::HeightError => (ColumnType::Double, None),
            Kind::Int => (ColumnType::Long, None),
            Kind::Text(most) => (ColumnType::String, Some(i32::from(most))),
            Kind::LongText => (ColumnType::String, None),
            Kind::Bool => (ColumnType::Bool, None),
        };
        writer.add_column(column.name, kind, |_, args| args.width = width.unwrap_or(args.width));
    }
    for row in &layer.rows {
        add_row(&mut writer, layer, row)
            .map_err(|e| Error::file_cause(path, "the FlatGeobuf cannot be written; is the disk full?", e))?;
    }
    let mut out = BufWriter::with_capacity(1 << 16, File::create(path).map_err(|e| Error::io("write", path, e))?);
    writer.write(&mut out).map_err(failed)?;
    out.flush().map_err(|e| Error::io("write", path, e))
}

fn add_row(writer: &mut FgbWriter<'_>, layer: &Layer<'_>, row: &Row<'_>) -> Written<()> {
    if let Shape::Area(rings) = &row.shape {
        writer.polygon_begin(true, rings.len(), 0)?;
        for (i, ring) in row.shape.rings(Outer::Counterclockwise).enumerate() {
            writer.linestring_begin(false, ring.len(), i)?;
            for (j, p) in ring.enumerate() {
                writer.xy(p.x, p.y, j)?;
            }
            writer.linestring_end(false, i)?;
        }
        writer.polygon_end(true, 0)?;
    } else {
        writer.linestring_begin(true, row.shape.vertex_count(), 0)?;
        for (i, p) in row.shape.vertices().enumerate() {
            writer.coordinate(p.x, p.y, Some(p.z), None, None, None, i)?;
        }
        writer.linestring_end(true, 0)?;
    }
    for (i, (column, cell)) in layer.columns.iter().zip(&row.cells).enumerate() {
        let value = match cell {
            Cell::Real(number) => ColumnValue::Double(*number),
            Cell::Int(number) => ColumnValue::Long(*number),
            Cell::Text(text) => ColumnValue::String(text),
            Cell::Bool(yes) => ColumnValue::Bool(*yes),
            Cell::Null => continue,
        };
        writer.property(i, column.name, &value)?;
    }
    writer.feature_end(0)
}
