//! GeoJSON (RFC 7946, and the older form with a `crs` member).
//!
//! The text is read straight into features, without a tree of values in between, because contour files are large and
//! nearly all numbers. Numbers are read and written so that every f64 comes back bit for bit.

mod coordinates;
mod read;
mod write;

pub(super) use read::read;
pub(super) use write::write;
