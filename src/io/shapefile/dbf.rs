//! The attribute table of a shapefile (dBASE III, with the field types that later versions added).
//!
//! The reader is written by hand for three reasons: float fields must not pass through f32; records that are marked as
//! deleted must keep their position beside the shapes; a field of an unknown type must not make the file unreadable.
//! The writer is written by hand because numbers must keep all their digits and the header must not contain today's
//! date.

use std::fs::File;
use std::io::{BufReader, BufWriter, ErrorKind, Read, Write};
use std::path::Path;

use encoding_rs::Encoding;

use super::encoding::{self, Guess};
use crate::layer::{Cell, Column, Kind, Row};
use crate::ordinary::open_to_read;
use crate::table::Value;
use tokosen_core::base::error::{Error, Result};

/// A table that is read record by record.
pub(super) struct Reader {
    source: BufReader<File>,
    encoding: &'static Encoding,
    /// Whether the file names its encoding, or its names show it.
    pub is_sure: bool,
    pub names: Vec<String>,
    fields: Vec<Descriptor>,
    pub record_count: u32,
    record: Vec<u8>,
}

struct Descriptor {
    kind: u8,
    start: usize,
    length: usize,
}

impl Reader {
    /// Reads the header. `label` is the content of the `.cpg` file, and `named` the field that the user named.
    pub fn open(path: &Path, label: Option<&str>, named: Option<&str>) -> Result<Self> {
        let file = open_to_read(path)?;
        let mut source = BufReader::new(file);
        let broken = |e: std::io::Error| Error::file_cause(path, "the attribute table's header is not complete", e);
        let mut head = [0; 32];
        source.read_exact(&mut head).map_err(broken)?;
        let word = |at: usize| usize::from(u16::from_le_bytes([head[at], head[at + 1]]));
        let record_count = u32::from_le_bytes([head[4], head[5], head[6], head[7]]);
        let (header_length, record_length) = (word(8), word(10));

        let descriptors_length = header_length.saturating_sub(32);
        let mut bytes = vec![0; descriptors_length];
        source.read_exact(&mut bytes).map_err(broken)?;
        let mut fields = Vec::new();
        let mut raw_names = Vec::new();
        // The first byte of a record marks deletion.
        let mut start = 1;
        for descriptor in bytes.chunks_exact(32).take_while(|d| d[0] != 0x0d) {
            let name = descriptor[..11].split(|&b| b == 0).next().unwrap_or_default();
            raw_names.push(name.trim_ascii().to_vec());
            let kind = descriptor[11];
            // For long text, the field's decimals are the high byte of its length.
            let high = if kind == b'C' { usize::from(descriptor[17]) << 8 } else { 0 };
            let length = usize::from(descriptor[16]) + high;
            fields.push(Descriptor { kind, start, length });
            start += length;
        }
        if header_length < 33 || record_length < start {
            return Err(Error::file(path, "the attribute table's header contradicts itself; the file is broken"));
        }
        let Guess { encoding, is_sure } = match label.and_then(encoding::of_label) {
            Some(encoding) => Guess { encoding, is_sure: true },
            None => encoding::guessed(&raw_names, named, encoding::of_language_byte(head[29])),
        };
        let names = raw_names.iter().map(|name| encoding.decode_without_bom_handling(name).0.into_owned()).collect();
        Ok(Self { source, encoding, is_sure, names, fields, record_count, record: vec![0; record_length] })
    }

    /// Reads the next record; false if it is marked as deleted.
    pub fn advance(&mut self) -> std::io::Result<bool> {
        self.source.read_exact(&mut self.record)?;
        Ok(self.record[0] != b'*')
    }

    /// The value of a field in the current record.
    pub fn value(&self, field: usize) -> Value {
        let Descriptor { kind, start, length } = self.fields[field];
        let bytes = &self.record[start..start + length];
        match kind {
            b'I' | b'+' => match bytes.try_into() {
                Ok(number) => Value::Number(f64::from(i32::from_le_bytes(number))),
                Err(_) => self.text(bytes),
            },
            b'O' | b'B' if length == 8 => {
                Value::Number(f64::from_le_bytes(bytes.try_into().expect("eight bytes were asked for")))
            }
            b'N' | b'F' => match self.text(bytes) {
                // A number that did not fit into its field is written as asterisks.
                Value::Text(text) if text.bytes().all(|b| b == b'*') => Value::Null,
                Value::Text(text) => text.parse().map_or(Value::Text(text), Value::Number),
                other => other,
            },
            _ => self.text(bytes),
        }
    }

    fn text(&self, bytes: &[u8]) -> Value {
        let bytes = bytes.split(|&b| b == 0).next().unwrap_or_default().trim_ascii();
        if bytes.is_empty() {
            return Value::Null;
        }
        Value::Text(self.encoding.decode_without_bom_handling(bytes).0.into_owned())
    }
}

/// Width and decimals of a number field, as GIS programs write them.
const NUMBER_WIDTH: u8 = 24;
const NUMBER_DECIMALS: u8 = 15;
/// The largest width that programs still read as a whole number; wider fields are read as decimal numbers.
const INT_WIDTH: u8 = 18;

/// The largest length of a text field, bytes.
const MAX_TEXT_LENGTH: u8 = 254;

/// Width of a column, bytes per record.
fn width(column: &Column) -> u8 {
    match column.kind {
        Kind::Real | Kind::Height | Kind::HeightError => NUMBER_WIDTH,
        Kind::Int => INT_WIDTH,
        Kind::Text(width) => width,
        Kind::LongText => MAX_TEXT_LENGTH,
        Kind::Bool => 1,
    }
}

fn header_length(columns: &[Column]) -> usize {
    32 * (columns.len() + 1) + 1
}

fn record_length(columns: &[Column]) -> usize {
    1 + columns.iter().map(|column| usize::from(width(column))).sum::<usize>()
}

/// Length of a table with this many rows, bytes.
pub(super) fn length(columns: &[Column], row_count: usize) -> u64 {
    header_length(columns) as u64 + record_length(columns) as u64 * row_count as u64 + 1
}

/// Writes the attributes of all rows.
pub(super) fn write(path: &Path, columns: &[Column], rows: &[Row<'_>]) -> std::io::Result<()> {
    let too_long = |_| std::io::Error::from(ErrorKind::FileTooLarge);
    let mut out = BufWriter::new(File::create(path)?);

    // dBASE version 3 without memo. A fixed date replaces today's, because the same lines must give the same bytes.
    out.write_all(&[3, 70, 1, 1])?;
    out.write_all(&u32::try_from(rows.len()).map_err(too_long)?.to_le_bytes())?;
    out.write_all(&u16::try_from(header_length(columns)).map_err(too_long)?.to_le_bytes())?;
    out.write_all(&u16::try_from(record_length(columns)).map_err(too_long)?.to_le_bytes())?;
    out.write_all(&[0; 20])?;
    for column in columns {
        let mut descriptor = [0; 32];
        descriptor[..column.name.len()].copy_from_slice(column.name.as_bytes());
        (descriptor[11], descriptor[17]) = match column.kind {
            Kind::Real | Kind::Height | Kind::HeightError => (b'N', NUMBER_DECIMALS),
            Kind::Text(_) | Kind::LongText => (b'C', 0),
            // Yes and no are written as a digit, because many programs show a logical field as the letters T and F.
            Kind::Int | Kind::Bool => (b'N', 0),
        };
        descriptor[16] = width(column);
        out.write_all(&descriptor)?;
    }
    out.write_all(b"\r")?;
    for row in rows {
        out.write_all(b" ")?;
        for (column, cell) in columns.iter().zip(&row.cells) {
            let width = usize::from(width(column));
            match cell {
                Cell::Real(number) => write!(out, "{:>width$}", number_text(*number))?,
                Cell::Int(number) => write!(out, "{number:>width$}")?,
                // The field's width counts bytes, but formatting counts characters.
                Cell::Text(text) => write!(out, "{text}{:1$}", "", width.saturating_sub(text.len()))?,
                Cell::Bool(yes) => write!(out, "{:>width$}", u8::from(*yes))?,
                Cell::Null => write!(out, "{:width$}", "")?,
            }
        }
    }
    out.write_all(&[0x1a])?;
    out.flush()
}

/// The shortest text that fits and gives the same number back.
fn number_text(number: f64) -> String {
    let plain = number.to_string();
    if plain.len() <= usize::from(NUMBER_WIDTH) { plain } else { format!("{number:e}") }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_keep_their_digits_and_fit() {
        for number in
            [0.0, -0.0, 0.1 + 0.2, 1e7 + 1e-9, -8848.86, f64::MAX, f64::MIN, 5e-324, -2.225_073_858_507_201e-308]
        {
            let text = number_text(number);
            assert!(text.len() <= usize::from(NUMBER_WIDTH), "{text}");
            assert_eq!(text.parse::<f64>().unwrap().to_bits(), number.to_bits());
        }
    }
}
