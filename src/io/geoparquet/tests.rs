//! Files of other programs, made with the crate: geometries by their type, columns of every kind, and what cannot be read.

use std::fs::File;
use std::path::Path;
use std::sync::Arc;

use parquet::basic::{LogicalType, Repetition, Type as Physical};
use parquet::data_type::{
    BoolType, ByteArray, ByteArrayType, DataType, DoubleType, FixedLenByteArray, FixedLenByteArrayType, FloatType,
    Int32Type, Int64Type,
};
use parquet::file::metadata::KeyValue;
use parquet::file::properties::WriterProperties;
use parquet::file::writer::SerializedFileWriter;
use parquet::schema::types::Type;

use crate::{ReadOptions, read_contours};
use tokosen_core::base::error::Result;
use tokosen_core::contour::ContourMap;

/// A column of a file: its name, its types, and how its values are written.
type Column = (&'static str, Physical, Option<LogicalType>, Values);

enum Values {
    Bytes(Vec<Option<Vec<u8>>>),
    Doubles(Vec<f64>),
    Floats(Vec<f32>),
    Ints(Vec<i32>),
    Longs(Vec<i64>),
    Bools(Vec<bool>),
    Halves(Vec<[u8; 2]>),
}

/// Writes a file with the columns and this metadata.
fn write(path: &Path, columns: Vec<Column>, metadata: &[(&str, &str)]) {
    let fields = columns.iter().map(|(name, physical, logical, values)| {
        let repetition = match values {
            Values::Bytes(_) => Repetition::OPTIONAL,
            _ => Repetition::REQUIRED,
        };
        let (scale, precision) = match logical {
            Some(LogicalType::Decimal(decimal)) => (decimal.scale, decimal.precision),
            _ => (-1, -1),
        };
        let length = if *physical == Physical::FIXED_LEN_BYTE_ARRAY { 2 } else { -1 };
        let leaf = Type::primitive_type_builder(name, *physical).with_repetition(repetition).with_length(length);
        Arc::new(leaf.with_scale(scale).with_precision(precision).with_logical_type(logical.clone()).build().unwrap())
    });
    let schema = Type::group_type_builder("schema").with_fields(fields.collect()).build().unwrap();
    let entries = metadata.iter().map(|(key, value)| KeyValue::new((*key).to_owned(), (*value).to_owned()));
    let properties = WriterProperties::builder().set_key_value_metadata(Some(entries.collect())).build();
    let file = File::create(path).unwrap();
    let mut writer = SerializedFileWriter::new(file, Arc::new(schema), Arc::new(properties)).unwrap();
    let mut group = writer.next_row_group().unwrap();
    fn put<D: DataType>(
        group: &mut parquet::file::writer::SerializedRowGroupWriter<'_, File>,
        values: &[D::T],
        levels: Option<&[i16]>,
    ) {
        let mut column = group.next_column().unwrap().unwrap();
        column.typed::<D>().write_batch(values, levels, None).unwrap();
        column.close().unwrap();
    }
    for (.., values) in columns {
        match values {
            Values::Bytes(values) => {
                let levels: Vec<i16> = values.iter().map(|value| i16::from(value.is_some())).collect();
                let values: Vec<ByteArray> = values.into_iter().flatten().map(ByteArray::from).collect();
                put::<ByteArrayType>(&mut group, &values, Some(&levels));
            }
            Values::Doubles(values) => put::<DoubleType>(&mut group, &values, None),
            Values::Floats(values) => put::<FloatType>(&mut group, &values, None),
            Values::Ints(values) => put::<Int32Type>(&mut group, &values, None),
            Values::Longs(values) => put::<Int64Type>(&mut group, &values, None),
            Values::Bools(values) => put::<BoolType>(&mut group, &values, None),
            Values::Halves(values) => {
                let values: Vec<FixedLenByteArray> =
                    values.into_iter().map(|bytes| ByteArray::from(bytes.to_vec()).into()).collect();
                put::<FixedLenByteArrayType>(&mut group, &values, None);
            }
        }
    }
    group.close().unwrap();
    writer.close().unwrap();
}

/// Two lines as WKB, and a row without geometry between them.
fn lines(logical: Option<LogicalType>) -> Column {
    let line = |x: f64| {
        let mut wkb = vec![1];
        wkb.extend([2_u32, 2].map(u32::to_le_bytes).as_flattened());
        wkb.extend([x, 0.1 + 0.2, x + 1.0, 5.0].map(f64::to_le_bytes).as_flattened());
        Some(wkb)
    };
    ("shape", Physical::BYTE_ARRAY, logical, Values::Bytes(vec![line(1.0), None, line(3.0)]))
}

fn read(path: &Path, field: &str) -> Result<ContourMap> {
    let options = ReadOptions { elevation_field: Some(field.to_owned()), ..ReadOptions::default() };
    Ok(read_contours(path, &options)?.value)
}

const GEO: &str =
    r#"{"version":"1.0.0","primary_column":"shape","columns":{"shape":{"encoding":"WKB","geometry_types":[]"#;

#[test]
fn columns_of_every_kind_are_elevations() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("a.parquet");
    let text = |text: &str| Some(text.as_bytes().to_vec());
    let decimal = |precision| Some(LogicalType::decimal(1, precision));
    let columns = vec![
        ("double", Physical::DOUBLE, None, Values::Doubles(vec![12.5, 0.0, 13.5])),
        ("float", Physical::FLOAT, None, Values::Floats(vec![12.5, 0.0, 13.5])),
        (
            "half",
            Physical::FIXED_LEN_BYTE_ARRAY,
            Some(LogicalType::Float16),
            Values::Halves(vec![[0x40, 0x4a], [0, 0], [0xc0, 0x4a]]),
        ),
        ("int", Physical::INT32, decimal(9), Values::Ints(vec![125, 0, 135])),
        ("long", Physical::INT64, decimal(18), Values::Longs(vec![125, 0, 135])),
        ("bytes", Physical::BYTE_ARRAY, decimal(9), Values::Bytes(vec![Some(vec![125]), None, Some(vec![0, 135])])),
        (
            "text",
            Physical::BYTE_ARRAY,
            Some(LogicalType::String),
            Values::Bytes(vec![text("12.5"), None, text("13.5")]),
        ),
        ("yes", Physical::BOOLEAN, None, Values::Bools(vec![true, false, true])),
        ("day", Physical::INT32, Some(LogicalType::Date), Values::Ints(vec![i32::MAX; 3])),
        ("blob", Physical::BYTE_ARRAY, None, Values::Bytes(vec![Some(vec![0xff]), None, None])),
        lines(None),
    ];
    write(
        &path,
        columns,
        &[("geo", &format!("{GEO},\"crs\":{{\"id\":{{\"authority\":\"EPSG\",\"code\":6677}}}}}}}}}}"))],
    );
    for field in ["double", "float", "half", "int", "long", "bytes", "text"] {
        let map = read(&path, field).unwrap();
        assert_eq!(map.contours.iter().map(|line| line.elevation).collect::<Vec<_>>(), [12.5, 13.5], "{field}");
        assert_eq!(map.contours[0].points[0].y.to_bits(), (0.1_f64 + 0.2).to_bits());
        assert_eq!(map.crs.and_then(|crs| crs.epsg), Some(6677));
    }
    assert_eq!(read(&path, "yes").unwrap().contours[0].elevation, 1.0);
    for field in ["day", "blob"] {
        assert!(read(&path, field).unwrap_err().to_string().contains("not a number"), "{field}");
    }
}

#[test]
fn systems_are_those_that_the_file_names() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("a.parquet");
    let code = |logical: Option<LogicalType>, metadata: &[(&str, &str)]| {
        let elevations = ("elev", Physical::DOUBLE, None, Values::Doubles(vec![1.0, 2.0, 3.0]));
        write(&path, vec![elevations, lines(logical)], metadata);
        read(&path, "elev").unwrap().crs.and_then(|crs| crs.epsg)
    };
    let geometry = |crs: Option<&str>| Some(LogicalType::geometry(crs.map(str::to_owned)));
    let utm = r#"{"type":"ProjectedCRS","id":{"authority":"EPSG","code":32616}}"#;
    assert_eq!(
        code(None, &[("geo", &format!("{GEO}}}}}}}"))]),
        Some(4326),
        "longitudes and latitudes without an entry"
    );
    assert_eq!(code(None, &[("geo", &format!("{GEO},\"crs\":null}}}}}}"))]), None);
    assert_eq!(code(None, &[("geo", &format!("{GEO},\"crs\":{{\"name\":\"mine\"}}}}}}}}"))]), None);
    assert_eq!(code(geometry(None), &[]), Some(4326));
    assert_eq!(code(geometry(Some("srid:6677")), &[]), Some(6677));
    assert_eq!(code(geometry(Some("OGC:CRS84")), &[]), Some(4326));
    assert_eq!(code(geometry(Some("projjson:mine")), &[("mine", utm)]), Some(32616));
    assert_eq!(code(geometry(Some(utm)), &[]), Some(32616));
    assert_eq!(code(geometry(Some("srid:0")), &[]), None);
}

#[test]
fn what_cannot_be_read_is_said() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("a.parquet");
    for (metadata, expected) in [
        (None, "no column has geometries"),
        (Some("{}"), "names no column"),
        (Some("{"), "is not valid"),
        (Some(r#"{"primary_column":"shape","columns":{"shape":{"encoding":"linestring"}}}"#), "\"linestring\""),
        (Some(r#"{"primary_column":"shape","columns":{}}"#), "does not describe"),
        (Some(r#"{"primary_column":"x","columns":{"x":{"encoding":"WKB"}}}"#), "no column \"x\""),
    ] {
        write(&path, vec![lines(None)], &metadata.map(|text| ("geo", text)).into_iter().collect::<Vec<_>>());
        let error = read(&path, "elev").unwrap_err().to_string();
        assert!(error.contains(expected) && error.contains("a.parquet"), "{error}");
    }
    std::fs::write(&path, "PAR1 and no more").unwrap();
    assert!(read(&path, "elev").unwrap_err().to_string().contains("no Parquet"));
}

#[test]
fn no_changed_byte_panics() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("a.parquet");
    let elevations = ("elev", Physical::DOUBLE, None, Values::Doubles(vec![1.0, 1.0, 3.0]));
    write(&path, vec![elevations, lines(Some(LogicalType::geometry(None)))], &[]);
    let whole = std::fs::read(&path).unwrap();
    let mut refused = 0;
    for at in 0..whole.len() {
        for byte in [0, 1, 0x7f, 0x80, 0xff, whole[at] ^ 1, whole[at] ^ 8] {
            let mut changed = whole.clone();
            changed[at] = byte;
            std::fs::write(&path, &changed).unwrap();
            refused += usize::from(read(&path, "elev").is_err());
        }
    }
    assert!(refused > whole.len(), "{refused} of {}", 7 * whole.len());
}
