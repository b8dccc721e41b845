//! Arrow tables as features: geometries of any GeoArrow type or WKB, and the columns that may hold elevations.

use arrow_array::cast::AsArray;
use arrow_array::types::{
    Decimal128Type, Float32Type, Float64Type, Int8Type, Int16Type, Int32Type, Int64Type, UInt8Type, UInt16Type,
    UInt32Type, UInt64Type,
};
use arrow_array::{Array, ArrowPrimitiveType, RecordBatch};
use arrow_schema::{DataType, Field, Schema};
use geoarrow_array::array::from_arrow_array;
use geoarrow_array::{GeoArrowArrayAccessor, downcast_geoarrow_array};
use geoarrow_schema::GeoArrowType;
use tokosen::crs::Crs;
use tokosen::io::{Attribute, MemoryLayer};
use wkb::writer::{WriteOptions, write_geometry};

/// The features of a table.
///
/// # Errors
/// A sentence if there is no column with geometries or several, or a geometry cannot be read.
pub fn features(batches: &[RecordBatch], schema: &Schema) -> Result<MemoryLayer, String> {
    let fields = schema.fields();
    let geometry = geometry_column(schema)?;
    let field = &fields[geometry];
    let mut features = MemoryLayer { crs: crs_of(field), offsets: vec![0], ..MemoryLayer::default() };
    for batch in batches {
        let column = from_arrow_array(batch.column(geometry), field).map_err(|e| e.to_string())?;
        let column = column.as_ref();
        downcast_geoarrow_array!(column, add, &mut features)?;
    }
    for (k, field) in fields.iter().enumerate().filter(|(k, _)| *k != geometry) {
        features.attributes.extend(attribute(batches, k, field).map(|values| (field.name().clone(), values)));
    }
    Ok(features)
}

/// The index of the column that holds geometries.
fn geometry_column(schema: &Schema) -> Result<usize, String> {
    let is_extension = |field: &Field| field.extension_type_name().is_some_and(|name| name.starts_with("geoarrow."));
    let columns: Vec<usize> = (0..schema.fields().len()).filter(|k| is_extension(schema.field(*k))).collect();
    match columns.as_slice() {
        [one] => Ok(*one),
        [] => {
            let names: Vec<&str> = schema.fields().iter().map(|field| field.name().as_str()).collect();
            Err(format!(
                "no column of the Arrow table has geometries of GeoArrow; its columns are {}",
                names.join(", ")
            ))
        }
        many => {
            let names: Vec<&str> = many.iter().map(|k| schema.field(*k).name().as_str()).collect();
            Err(format!("several columns of the Arrow table have geometries: {}; keep one", names.join(", ")))
        }
    }
}

/// Adds the geometries of a column as WKB.
fn add<'a>(column: &'a impl GeoArrowArrayAccessor<'a>, features: &mut MemoryLayer) -> Result<(), String> {
    let options = WriteOptions::default();
    for geometry in column.iter() {
        if let Some(geometry) = geometry {
            let geometry = geometry.map_err(|e| e.to_string())?;
            write_geometry(&mut features.wkb, &geometry, &options).map_err(|e| e.to_string())?;
        }
        features.offsets.push(features.wkb.len());
    }
    Ok(())
}

/// The coordinate reference system that a column of geometries names.
fn crs_of(field: &Field) -> Option<Crs> {
    let found = GeoArrowType::from_arrow_field(field).ok()?;
    match found.metadata().crs().crs_value()? {
        serde_json::Value::String(text) => Crs::from_text(text).ok(),
        // PROJJSON names its code.
        value => {
            let id = &value["id"];
            let code = id["code"].as_u64().filter(|_| id["authority"].as_str() == Some("EPSG"))?;
            Crs::from_text(&format!("EPSG:{code}")).ok()
        }
    }
}

/// The values of a column, if they are numbers or texts.
fn attribute(batches: &[RecordBatch], column: usize, field: &Field) -> Option<Attribute> {
    let columns = batches.iter().map(|batch| batch.column(column).as_ref());
    match field.data_type() {
        DataType::Utf8 => Some(Attribute::Texts(
            columns.flat_map(|c| c.as_string::<i32>().iter().map(|text| text.map(str::to_owned))).collect(),
        )),
        DataType::LargeUtf8 => Some(Attribute::Texts(
            columns.flat_map(|c| c.as_string::<i64>().iter().map(|text| text.map(str::to_owned))).collect(),
        )),
        DataType::Utf8View => Some(Attribute::Texts(
            columns.flat_map(|c| c.as_string_view().iter().map(|text| text.map(str::to_owned))).collect(),
        )),
        DataType::Decimal128(_, scale) => {
            let factor = 10_f64.powi(i32::from(*scale));
            let number = |value: Option<i128>| value.map_or(f64::NAN, |value| value as f64 / factor);
            Some(Attribute::Numbers(
                columns.flat_map(|c| c.as_primitive::<Decimal128Type>().iter().map(number)).collect(),
            ))
        }
        kind => numbers(columns, kind).map(Attribute::Numbers),
    }
}

/// The values of a column of numbers.
fn numbers<'a>(columns: impl Iterator<Item = &'a dyn Array>, kind: &DataType) -> Option<Vec<f64>> {
    fn all<'a, T: ArrowPrimitiveType>(
        columns: impl Iterator<Item = &'a dyn Array>,
        number: impl Fn(T::Native) -> f64,
    ) -> Vec<f64> {
        columns
            .flat_map(|c| c.as_primitive::<T>().iter().map(|v| v.map_or(f64::NAN, &number)).collect::<Vec<_>>())
            .collect()
    }
    Some(match kind {
        DataType::Float64 => all::<Float64Type>(columns, |v| v),
        DataType::Float32 => all::<Float32Type>(columns, f64::from),
        DataType::Int8 => all::<Int8Type>(columns, f64::from),
        DataType::Int16 => all::<Int16Type>(columns, f64::from),
        DataType::Int32 => all::<Int32Type>(columns, f64::from),
        DataType::Int64 => all::<Int64Type>(columns, |v| v as f64),
        DataType::UInt8 => all::<UInt8Type>(columns, f64::from),
        DataType::UInt16 => all::<UInt16Type>(columns, f64::from),
        DataType::UInt32 => all::<UInt32Type>(columns, f64::from),
        DataType::UInt64 => all::<UInt64Type>(columns, |v| v as f64),
        _ => return None,
    })
}
