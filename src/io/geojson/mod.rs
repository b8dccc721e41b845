//! GeoJSON (RFC 7946, and the older form with a `crs` member), and sequences of it (RFC 8142).
//!
//! The text is read directly into features, without a tree of values, because contour files are large and consist
//! almost only of numbers. Reading and writing preserve every f64 bit for bit.

mod coordinates;
mod read;
mod sequence;
mod write;

pub(super) use read::{parse, read};
pub(super) use sequence::read_sequence;
pub(super) use write::write;
