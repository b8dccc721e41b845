//! GeoJSON (RFC 7946, and the older form with a `crs` member).
//!
//! The text is read directly into features, without a tree of values, because contour files are large and consist
//! almost only of numbers. Reading and writing preserve every f64 bit for bit.

mod coordinates;
mod read;
mod write;

pub(super) use read::{parse, read};
pub(super) use write::write;
