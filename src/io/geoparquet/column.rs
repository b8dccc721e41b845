//! The values of a column in a group of rows.

use parquet::basic::{ConvertedType, LogicalType};
use parquet::column::reader::{ColumnReader, ColumnReaderImpl};
use parquet::data_type::{ByteArray, DataType};
use parquet::errors::Result;
use parquet::schema::types::ColumnDescriptor;

use crate::table::Value;

/// What stands for times and bytes, which are never elevations.
const TIME: &str = "a time";
const BINARY: &str = "binary";

/// The bytes of each row; none where there is no value.
pub(super) fn bytes(reader: ColumnReader, about: &ColumnDescriptor, rows: usize) -> Result<Vec<Option<ByteArray>>> {
    match reader {
        ColumnReader::ByteArrayColumnReader(reader) => all(reader, about, rows, |bytes| bytes),
        _ => Ok(Vec::new()),
    }
}

/// The value of each row, as attributes have it.
pub(super) fn values(reader: ColumnReader, about: &ColumnDescriptor, rows: usize) -> Result<Vec<Value>> {
    let scale = 10_f64.powi(about.type_scale().clamp(-300, 300));
    let kind = about.converted_type();
    let is_unsigned = matches!(
        kind,
        ConvertedType::UINT_8 | ConvertedType::UINT_16 | ConvertedType::UINT_32 | ConvertedType::UINT_64
    );
    let is_decimal =
        kind == ConvertedType::DECIMAL || matches!(about.logical_type_ref(), Some(LogicalType::Decimal(_)));
    let is_time = matches!(
        kind,
        ConvertedType::DATE
            | ConvertedType::TIME_MILLIS
            | ConvertedType::TIME_MICROS
            | ConvertedType::TIMESTAMP_MILLIS
            | ConvertedType::TIMESTAMP_MICROS
    ) || matches!(
        about.logical_type_ref(),
        Some(LogicalType::Date | LogicalType::Time(_) | LogicalType::Timestamp(_))
    );
    let is_text = matches!(kind, ConvertedType::UTF8 | ConvertedType::ENUM | ConvertedType::JSON)
        || matches!(about.logical_type_ref(), Some(LogicalType::String | LogicalType::Enum | LogicalType::Json));
    let is_half = matches!(about.logical_type_ref(), Some(LogicalType::Float16));
    let text = |text: &str| Value::Text(text.to_owned());
    let whole = |signed: f64, unsigned: f64| match (is_time, is_decimal) {
        (true, _) => text(TIME),
        (_, true) => Value::Number(signed / scale),
        _ => Value::Number(if is_unsigned { unsigned } else { signed }),
    };
    let of_bytes = |bytes: &[u8]| match bytes {
        bytes if is_text => Value::Text(String::from_utf8_lossy(bytes).into_owned()),
        bytes if is_decimal => Value::Number(big_endian(bytes) / scale),
        [low, high] if is_half => Value::Number(half::f16::from_le_bytes([*low, *high]).to_f64()),
        _ => text(BINARY),
    };
    let some = match reader {
        ColumnReader::BoolColumnReader(r) => all(r, about, rows, |yes| Value::Number(f64::from(u8::from(yes))))?,
        ColumnReader::Int32ColumnReader(r) => {
            all(r, about, rows, |n| whole(f64::from(n), f64::from(n.cast_unsigned())))?
        }
        ColumnReader::Int64ColumnReader(r) => all(r, about, rows, |n| whole(n as f64, n.cast_unsigned() as f64))?,
        ColumnReader::Int96ColumnReader(r) => all(r, about, rows, |_| text(TIME))?,
        // The shortest decimal number that the single-precision number stands for: 12.3, not 12.300000190734863.
        ColumnReader::FloatColumnReader(r) => {
            all(r, about, rows, |n| Value::Number(n.to_string().parse().unwrap_or(f64::from(n))))?
        }
        ColumnReader::DoubleColumnReader(r) => all(r, about, rows, Value::Number)?,
        ColumnReader::ByteArrayColumnReader(r) => all(r, about, rows, |bytes| of_bytes(bytes.data()))?,
        ColumnReader::FixedLenByteArrayColumnReader(r) => all(r, about, rows, |bytes| of_bytes(bytes.data()))?,
    };
    Ok(some.into_iter().map(|value| value.unwrap_or(Value::Null)).collect())
}

/// All values, each as `convert` gives it; none where there is none.
fn all<D: DataType, T>(
    mut reader: ColumnReaderImpl<D>,
    about: &ColumnDescriptor,
    rows: usize,
    convert: impl Fn(D::T) -> T,
) -> Result<Vec<Option<T>>> {
    let most = about.max_def_level();
    let (mut given, mut levels) = (Vec::new(), Vec::new());
    while reader.read_records(rows, (most > 0).then_some(&mut levels), None, &mut given)?.0 > 0 {}
    let mut given = given.into_iter().map(convert);
    if most == 0 {
        return Ok(given.map(Some).collect());
    }
    Ok(levels.into_iter().map(|level| if level == most { given.next() } else { None }).collect())
}

/// A number of any length, as decimals have it.
fn big_endian(bytes: &[u8]) -> f64 {
    let start = match bytes.first() {
        Some(first) if first & 0x80 != 0 => -1.0,
        _ => 0.0,
    };
    bytes.iter().fold(start, |number, byte| number * 256.0 + f64::from(*byte))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn decimals_have_a_sign() {
        assert_eq!(big_endian(&[0x01, 0x00]), 256.0);
        assert_eq!(big_endian(&[0xff, 0xfe]), -2.0);
        assert_eq!(big_endian(&[0xff; 16]), -1.0);
        assert_eq!(big_endian(&[]), 0.0);
    }
}
