//! FlatGeobuf: one layer a file, with a spatial index.
//!
//! The tables of the format and the writing are the `flatgeobuf` crate's. The walk through a file is not, because the
//! crate's reader trusts the lengths that a file states: it asks for as much memory as a damaged length says, panics where
//! an attribute reaches beyond its bytes, and takes the end of a cut file for the end of its features. Here every length is
//! held against what is left of the file, and the crate's verifier looks at each table before it is read.

mod geometry;
mod properties;
mod read;
mod write;

pub(super) use read::read;
pub(super) use write::write;
