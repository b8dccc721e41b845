//! The attributes of a feature: column numbers, each followed by a value whose length depends on the column's type.

use ::flatgeobuf::{Column, ColumnType};

use crate::table::{Feature, Table, Value};

/// The columns of a file or feature: each column's type and its index in the table's fields.
pub(super) type Columns = Vec<(ColumnType, usize)>;

/// Records the columns as fields of the table.
pub(super) fn columns<'a>(columns: impl Iterator<Item = Column<'a>>, table: &mut Table) -> Columns {
    columns.map(|column| (column.type_(), table.field(column.name()))).collect()
}

/// Reads the values of a feature, or returns what is wrong with them.
pub(super) fn read(bytes: &[u8], columns: &Columns, feature: &mut Feature, table: &mut Table) -> Result<(), String> {
    let mut rest = Rest(bytes);
    // Some writers add a byte after a last column of binary content.
    while rest.0.len() > 1 {
        let column = usize::from(u16::from_le_bytes(rest.take()?));
        let &(kind, field) = columns.get(column).ok_or_else(|| format!("there is no column {column}"))?;
        let value = match kind {
            ColumnType::Byte => Value::Number(i8::from_le_bytes(rest.take()?).into()),
            ColumnType::UByte => Value::Number(u8::from_le_bytes(rest.take()?).into()),
            ColumnType::Bool => Value::Number(if rest.take()? == [0] { 0.0 } else { 1.0 }),
            ColumnType::Short => Value::Number(i16::from_le_bytes(rest.take()?).into()),
            ColumnType::UShort => Value::Number(u16::from_le_bytes(rest.take()?).into()),
            ColumnType::Int => Value::Number(i32::from_le_bytes(rest.take()?).into()),
            ColumnType::UInt => Value::Number(u32::from_le_bytes(rest.take()?).into()),
            ColumnType::Long => Value::Number(i64::from_le_bytes(rest.take()?) as f64),
            ColumnType::ULong => Value::Number(u64::from_le_bytes(rest.take()?) as f64),
            // The shortest decimal number that the single-precision number stands for: 12.3, not 12.300000190734863.
            ColumnType::Float => Value::Number(shortest(f32::from_le_bytes(rest.take()?))),
            ColumnType::Double => Value::Number(f64::from_le_bytes(rest.take()?)),
            ColumnType::String | ColumnType::Json | ColumnType::DateTime => {
                let text = rest.text()?;
                if !table.wants(field) {
                    continue;
                }
                Value::Text(String::from_utf8_lossy(text).into_owned())
            }
            ColumnType::Binary => {
                rest.text()?;
                Value::Text("binary".to_owned())
            }
            other => {
                return Err(format!("the column {:?} is of an unknown type {}", table.fields[field].name, other.0));
            }
        };
        if table.wants(field) {
            table.note(&mut feature.values, field, value);
        }
    }
    Ok(())
}

fn shortest(number: f32) -> f64 {
    number.to_string().parse().unwrap_or(f64::from(number))
}

/// The bytes that are not read yet.
struct Rest<'a>(&'a [u8]);

const CUT: &str = "an attribute reaches beyond the feature";

impl<'a> Rest<'a> {
    fn take<const N: usize>(&mut self) -> Result<[u8; N], String> {
        let (taken, rest) = self.0.split_first_chunk().ok_or(CUT)?;
        self.0 = rest;
        Ok(*taken)
    }

    fn text(&mut self) -> Result<&'a [u8], String> {
        let length = u32::from_le_bytes(self.take()?) as usize;
        let (text, rest) = self.0.split_at_checked(length).ok_or(CUT)?;
        self.0 = rest;
        Ok(text)
    }
}
