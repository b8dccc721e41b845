//! FlatGeobuf: one layer per file, with a spatial index.
//!
//! The `flatgeobuf` crate provides the tables of the format and the writer. Its reader is not used, because it trusts
//! the lengths in a file. It allocates as much memory as a damaged length states. It panics if an attribute extends
//! beyond its bytes. It takes the end of a truncated file for the end of the features. Here every length is compared
//! with the rest of the file, and the crate's verifier checks each table before it is read.

mod geometry;
mod properties;
mod read;
mod write;

pub(super) use read::read;
pub(super) use write::write;
