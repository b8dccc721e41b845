//! Writes a layer as GeoParquet 1.1.

use std::fs::File;
use std::path::Path;
use std::sync::Arc;

use parquet::basic::{Compression, LogicalType, Repetition, Type as Physical, ZstdLevel};
use parquet::data_type::{BoolType, ByteArray, ByteArrayType, DataType, DoubleType, Int64Type};
use parquet::errors::{ParquetError, Result as Written};
use parquet::file::metadata::KeyValue;
use parquet::file::properties::{EnabledStatistics, WriterProperties};
use parquet::file::writer::{SerializedFileWriter, SerializedRowGroupWriter};
use parquet::schema::types::{ColumnPath, Type};
use serde_json::json;

use super::about::{KEY, WKT_KEY};
use super::hilbert;
use crate::gpkg::wkb;
use crate::layer::{Bounds, Cell, Geometry, Kind, Layer, NO_BOUNDS, Row, Shape, joined};
use crate::maker::PROGRAM;
use tokosen_core::base::error::{Error, Result};
use tokosen_core::crs::Crs;

const GEOMETRY: &str = "geometry";
const BOX: &str = "bbox";
/// The sides of a box, in their order.
const SIDES: [&str; 4] = ["xmin", "ymin", "xmax", "ymax"];
/// Most rows and vertices of a group. A reader loads a group as a whole; each has statistics of its boxes.
const MOST_ROWS: usize = 10_000;
const MOST_VERTICES: usize = 1_000_000;
/// A level beyond which files get hardly smaller, but take longer.
const ZSTD: i32 = 6;

/// Writes one file. Missing attribute values are null. The system is written as PROJJSON.
pub(crate) fn write(path: &Path, layer: &Layer<'_>, crs: Option<&Crs>) -> Result<()> {
    // The text of a system without a code, which is not read from PROJJSON.
    let wkt = crs.filter(|crs| crs.epsg.is_none()).and_then(Crs::wkt);
    let crs = match crs.map(|crs| (crs, crs.projjson())) {
        None => serde_json::Value::Null,
        Some((_, Some(text))) => text,
        Some((crs, None)) => {
            let name = crs.name().unwrap_or_else(|| "without a name".into());
            let message = format!(
                "a GeoParquet cannot name the coordinate reference system {name}; write a GeoPackage (.gpkg), or convert it with \
                 --to-crs"
            );
            return Err(Error::file(path, message));
        }
    };
    let file = File::create(path).map_err(|e| Error::io("write", path, e))?;
    write_rows(file, layer, crs, wkt).map_err(|e| failed(path, e))
}

/// The error of the operating system, if it is one.
fn failed(path: &Path, error: ParquetError) -> Error {
    match error {
        ParquetError::External(cause) => match cause.downcast::<std::io::Error>() {
            Ok(cause) => Error::io("write", path, *cause),
            Err(cause) => Error::file_cause(path, "the GeoParquet cannot be written", ParquetError::External(cause)),
        },
        other => Error::file_cause(path, "the GeoParquet cannot be written; is the disk full?", other),
    }
}

fn write_rows(file: File, layer: &Layer<'_>, crs: serde_json::Value, wkt: Option<&str>) -> Written<()> {
    let bounds: Vec<Bounds> = layer.rows.iter().map(|row| row.shape.bounds()).collect();
    let all = bounds.iter().copied().fold(NO_BOUNDS, joined);
    let order = along_curve(&bounds, all);
    let mut about = vec![KeyValue::new(KEY.to_owned(), about(layer, all, crs).to_string())];
    about.extend(wkt.map(|text| KeyValue::new(WKT_KEY.to_owned(), text.to_owned())));
    let geometry = ColumnPath::new(vec![GEOMETRY.to_owned()]);
    let mut properties = WriterProperties::builder()
        .set_created_by(format!("{PROGRAM} {}", env!("CARGO_PKG_VERSION")))
        .set_compression(Compression::ZSTD(ZstdLevel::try_new(ZSTD)?))
        .set_statistics_enabled(EnabledStatistics::Chunk)
        .set_column_statistics_enabled(geometry.clone(), EnabledStatistics::None)
        .set_column_dictionary_enabled(geometry, false)
        .set_key_value_metadata(Some(about));
    for side in SIDES {
        let path = ColumnPath::new(vec![BOX.to_owned(), side.to_owned()]);
        properties = properties.set_column_dictionary_enabled(path, false);
    }
    let mut writer = SerializedFileWriter::new(file, Arc::new(schema(layer)?), Arc::new(properties.build()))?;
    let mut rest: &[usize] = &order;
    while !rest.is_empty() {
        let mut vertices = 0;
        let fits = rest.iter().take(MOST_ROWS).take_while(|&&row| {
            vertices += layer.rows[row].shape.vertex_count();
            vertices <= MOST_VERTICES
        });
        // A line may be longer than a group.
        let (group, others) = rest.split_at(fits.count().max(1));
        let mut out = writer.next_row_group()?;
        write_group(&mut out, layer, group, &bounds)?;
        out.close()?;
        rest = others;
    }
    writer.close()?.file_metadata();
    Ok(())
}

/// The rows in the order of the middles of their boxes along a Hilbert curve; equal ones in their own order.
fn along_curve(bounds: &[Bounds], [min_x, max_x, min_y, max_y]: Bounds) -> Vec<usize> {
    let size = (max_x - min_x).max(max_y - min_y);
    let cell = |middle: f64, least: f64| {
        let share = (middle - least) / size;
        // Points without a place come first.
        if share.is_finite() { (share * 65535.0) as u32 } else { 0 }
    };
    let mut order: Vec<(u32, usize)> = bounds
        .iter()
        .map(|[x0, x1, y0, y1]| hilbert::number(cell(x0.midpoint(*x1), min_x), cell(y0.midpoint(*y1), min_y)))
        .zip(0..)
        .collect();
    order.sort_unstable();
    order.into_iter().map(|(_, row)| row).collect()
}

/// The metadata of GeoParquet.
fn about(layer: &Layer<'_>, [min_x, max_x, min_y, max_y]: Bounds, crs: serde_json::Value) -> serde_json::Value {
    let kind = match layer.geometry {
        Geometry::Points => "Point",
        Geometry::Lines => "LineString Z",
        Geometry::Areas => "Polygon",
    };
    let covering: serde_json::Map<_, _> = SIDES.iter().map(|side| ((*side).to_owned(), json!([BOX, side]))).collect();
    let mut column = json!({
        "encoding": "WKB",
        "geometry_types": [kind],
        "crs": crs,
        "covering": { BOX: covering },
    });
    if layer.geometry == Geometry::Areas {
        column["orientation"] = "counterclockwise".into();
    }
    if min_x <= max_x {
        column[BOX] = json!([min_x, min_y, max_x, max_y]);
    }
    json!({ "version": "1.1.0", "primary_column": GEOMETRY, "columns": { GEOMETRY: column } })
}

fn schema(layer: &Layer<'_>) -> Written<Type> {
    let leaf = |name: &str, physical, logical| -> Written<Arc<Type>> {
        let leaf = Type::primitive_type_builder(name, physical).with_repetition(Repetition::OPTIONAL);
        Ok(Arc::new(leaf.with_logical_type(logical).build()?))
    };
    let mut fields = Vec::new();
    for column in layer.columns {
        let (physical, logical) = match column.kind {
            Kind::Real | Kind::Height | Kind::HeightError => (Physical::DOUBLE, None),
            Kind::Int => (Physical::INT64, None),
            Kind::Text(_) | Kind::LongText => (Physical::BYTE_ARRAY, Some(LogicalType::String)),
            Kind::Bool => (Physical::BOOLEAN, None),
        };
        fields.push(leaf(column.name, physical, logical)?);
    }
    fields.push(leaf(GEOMETRY, Physical::BYTE_ARRAY, None)?);
    let sides: Written<Vec<Arc<Type>>> = SIDES
        .iter()
        .map(|side| {
            let side = Type::primitive_type_builder(side, Physical::DOUBLE).with_repetition(Repetition::REQUIRED);
            Ok(Arc::new(side.build()?))
        })
        .collect();
    let sides = Type::group_type_builder(BOX).with_repetition(Repetition::OPTIONAL).with_fields(sides?);
    fields.push(Arc::new(sides.build()?));
    Type::group_type_builder("schema").with_fields(fields).build()
}

/// Writes rows, column by column.
fn write_group<W: std::io::Write + Send>(
    out: &mut SerializedRowGroupWriter<'_, W>,
    layer: &Layer<'_>,
    rows: &[usize],
    bounds: &[Bounds],
) -> Written<()> {
    let cells = |k: usize| rows.iter().map(move |&row| &layer.rows[row].cells[k]);
    for (k, column) in layer.columns.iter().enumerate() {
        match column.kind {
            Kind::Real | Kind::Height | Kind::HeightError => put::<DoubleType, _>(
                out,
                cells(k).map(|cell| match cell {
                    Cell::Real(number) => Some(*number),
                    _ => None,
                }),
            )?,
            Kind::Int => put::<Int64Type, _>(
                out,
                cells(k).map(|cell| match cell {
                    Cell::Int(number) => Some(*number),
                    _ => None,
                }),
            )?,
            Kind::Text(_) | Kind::LongText => put::<ByteArrayType, _>(
                out,
                cells(k).map(|cell| match cell {
                    Cell::Text(text) => Some(ByteArray::from(text.as_bytes().to_vec())),
                    _ => None,
                }),
            )?,
            Kind::Bool => put::<BoolType, _>(
                out,
                cells(k).map(|cell| match cell {
                    Cell::Bool(yes) => Some(*yes),
                    _ => None,
                }),
            )?,
        }
    }
    let has_place = |row: &Row<'_>| row.shape != Shape::Point(None);
    put::<ByteArrayType, _>(
        out,
        rows.iter().map(|&row| &layer.rows[row]).map(|row| {
            has_place(row).then(|| {
                let mut blob = Vec::new();
                wkb::put_plain(&mut blob, &row.shape);
                ByteArray::from(blob)
            })
        }),
    )?;
    // Bounds are least and greatest x, then y.
    for side in [0, 2, 1, 3] {
        put::<DoubleType, _>(out, rows.iter().map(|&row| has_place(&layer.rows[row]).then(|| bounds[row][side])))?;
    }
    Ok(())
}

/// Writes the next column.
fn put<D: DataType, W: std::io::Write + Send>(
    out: &mut SerializedRowGroupWriter<'_, W>,
    values: impl Iterator<Item = Option<D::T>>,
) -> Written<()> {
    let (mut levels, mut some) = (Vec::new(), Vec::new());
    for value in values {
        levels.push(i16::from(value.is_some()));
        some.extend(value);
    }
    let Some(mut column) = out.next_column()? else { return Ok(()) };
    column.typed::<D>().write_batch(&some, Some(&levels), None)?;
    column.close()
}
