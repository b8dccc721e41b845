//! GeoParquet: one layer per file, in groups of rows.
//!
//! Written is version 1.1: geometries as WKB, the box of each in a column of its own, rows along a Hilbert curve, so that a reader
//! who wants a part finds it in few groups. Read are all versions with WKB, and geometries by the type that Parquet itself has.
//!
//! The crate `parquet` reads and writes columns, without Arrow. Its reader of rows is not used, because it panics at types that it
//! does not know and at times without a date.

mod about;
mod column;
mod hilbert;
mod read;
mod write;

pub(super) use read::{is_own, read};
pub(super) use write::write;

#[cfg(test)]
mod tests;
