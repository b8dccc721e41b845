//! Reads a GeoParquet into a table.

use std::fs::File;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;

use parquet::basic::Compression;
use parquet::column::reader::ColumnReader;
use parquet::errors::ParquetError;
use parquet::file::metadata::{ColumnChunkMetaData, RowGroupMetaData};
use parquet::file::reader::{FileReader, SerializedFileReader};
use parquet::file::statistics::Statistics;

use super::about::{Geometries, geometries};
use super::column;
use crate::gpkg::wkb;
use crate::maker::PROGRAM;
use crate::ordinary::open_to_read;
use crate::table::{Feature, NO_GEOMETRY, Request, Table};
use tokosen_core::base::error::{Error, Result};
use tokosen_core::base::memory;

/// Memory that a group of rows takes while it is read, for each byte of its values.
const GROWTH: f64 = 3.0;

/// Reads a file. Features are numbered from 0 in the order of the file, as geopandas and GDAL show them.
///
/// At some damaged files the crate panics, for example where a dictionary is missing. That is an error like any other.
pub(crate) fn read(path: &Path, request: &Request<'_>) -> Result<Table> {
    let read = catch_unwind(AssertUnwindSafe(|| read_groups(path, request)));
    read.unwrap_or_else(|_| Err(Error::file(path, "the file is broken; copy or export it again")))
}

fn read_groups(path: &Path, request: &Request<'_>) -> Result<Table> {
    let broken = |e: ParquetError| {
        Error::file_cause(path, "the file is no Parquet, or it is broken; copy or export it again", e)
    };
    let reader = SerializedFileReader::new(open_to_read(path)?).map_err(broken)?;
    let file = reader.metadata().file_metadata();
    let about = geometries(file).map_err(|what| Error::file(path, what))?;
    let mut table = Table::new(request);
    let columns = file.schema_descr().columns();
    // Attributes are columns that are neither parts of others nor lists.
    let attributes: Vec<(usize, usize)> = (0..columns.len())
        .filter(|&k| k != about.leaf && columns[k].path().parts().len() == 1 && columns[k].max_rep_level() == 0)
        .map(|k| (k, table.field(columns[k].name())))
        .collect();
    let mut number: u64 = 0;
    for group in 0..reader.num_row_groups() {
        let rows = reader.metadata().row_group(group);
        let is_negative = |column: &ColumnChunkMetaData| {
            let places = [Some(column.data_page_offset()), column.dictionary_page_offset()];
            column.compressed_size() < 0 || places.into_iter().flatten().any(|place| place < 0)
        };
        if rows.columns().iter().any(is_negative) {
            return Err(Error::file(path, "the places of its columns are broken; copy or export the file again"));
        }
        if request.within.is_some_and(|within| sides(rows, &about).is_some_and(|sides| !within.meets(sides))) {
            number = number.saturating_add(u64::try_from(rows.num_rows()).unwrap_or_default());
            continue;
        }
        let read = read_group(path, (&reader, group), &about, &attributes, &mut table, number, request.memory)?;
        number = number.saturating_add(read);
    }
    (table.crs, table.crs_problem) = (about.crs, about.crs_problem);
    Ok(table)
}

/// The box of all geometries of a group of rows, if the file has it: by the columns of boxes, or by the type of the geometries.
fn sides(rows: &RowGroupMetaData, about: &Geometries) -> Option<[f64; 4]> {
    let range = |k: usize| match rows.column(k).statistics()? {
        Statistics::Double(found) => Some([*found.min_opt()?, *found.max_opt()?]),
        Statistics::Float(found) => Some([*found.min_opt()?, *found.max_opt()?].map(f64::from)),
        _ => None,
    };
    match about.boxes {
        Some([x0, y0, x1, y1]) => Some([range(x0)?[0], range(y0)?[0], range(x1)?[1], range(y1)?[1]]),
        None => {
            let found = rows.column(about.leaf).geo_statistics()?.bounding_box()?;
            // A box across the meridian of 180 degrees begins in the east.
            let sides = [found.get_xmin(), found.get_ymin(), found.get_xmax(), found.get_ymax()];
            (sides[0] <= sides[2]).then_some(sides)
        }
    }
}

/// Reads the features of a group of rows, the first of which has this number. Gives their number.
fn read_group(
    path: &Path,
    (reader, group): (&SerializedFileReader<File>, usize),
    about: &Geometries,
    attributes: &[(usize, usize)],
    table: &mut Table,
    first: u64,
    memory: Option<u64>,
) -> Result<u64> {
    let broken = |e: ParquetError| {
        Error::file_cause(path, format!("the rows from {first} on are broken; copy or export the file again"), e)
    };
    let wrong = |what: String| Error::file(path, what);
    let rows = reader.get_row_group(group).map_err(broken)?;
    let count =
        usize::try_from(rows.metadata().num_rows()).map_err(|_| wrong("a group has less than no rows".into()))?;
    let bytes = rows.metadata().column(about.leaf).uncompressed_size().max(0) as f64;
    memory::check(
        GROWTH * bytes,
        memory,
        format!("{}: reading its rows", path.display()),
        "choose a part of it, or close other programs",
    )?;
    let columns = reader.metadata().file_metadata().schema_descr().columns();
    let column = |k: usize| -> Result<ColumnReader> { rows.get_column_reader(k).map_err(broken) };
    let compression = rows.metadata().column(about.leaf).compression();
    if matches!(compression, Compression::BROTLI(_) | Compression::LZ4 | Compression::LZ4_RAW | Compression::LZO) {
        let what =
            format!("its columns are compressed with {compression}, which is not read; write it with ZSTD or SNAPPY");
        return Err(wrong(what));
    }
    let shapes = column::bytes(column(about.leaf)?, &columns[about.leaf], count).map_err(broken)?;
    let mut features: Vec<Feature> =
        (0..shapes.len() as u64).map(|k| Feature { number: first.saturating_add(k), ..Feature::default() }).collect();
    for &(k, field) in attributes {
        if !table.wants(field) {
            continue;
        }
        let values = column::values(column(k)?, &columns[k], count).map_err(broken)?;
        if values.len() != features.len() {
            return Err(wrong(format!(
                "the column {:?} does not have one value for each row; the file is broken",
                columns[k].name()
            )));
        }
        for (feature, value) in features.iter_mut().zip(values) {
            table.note(&mut feature.values, field, value);
        }
    }
    for (mut feature, shape) in features.into_iter().zip(shapes) {
        match shape {
            Some(shape) => wkb::read(shape.data(), &mut feature, table)
                .map_err(|what| wrong(format!("feature {}: {what}; the file is broken", feature.number)))?,
            None => table.leave_out(NO_GEOMETRY),
        }
        table.push(feature);
    }
    Ok(count as u64)
}

/// Whether a file states that this program made it.
pub(crate) fn is_own(file: File) -> bool {
    let reader = SerializedFileReader::new(file);
    reader.is_ok_and(|reader| {
        reader.metadata().file_metadata().created_by().is_some_and(|made| made.split(' ').next() == Some(PROGRAM))
    })
}
