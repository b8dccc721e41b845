//! The steps of [tokosen](https://docs.rs/tokosen), from contour lines in memory to surfaces and their products. They know no
//! files.
//!
//! The crate `tokosen` calls them in the right order and has the documentation of the whole. Use that one. Items here may
//! change in any version.

pub mod arrays;
pub mod bands;
pub mod base;
pub mod break_lines;
pub mod cartography;
pub mod check;
pub mod clean;
pub mod contour;
pub mod crs;
pub mod dem;
pub mod drain;
#[cfg(test)]
#[path = "../../tests/common/draws.rs"]
mod draws;
pub mod features;
#[doc(hidden)]
pub mod geometry;
pub mod layers;
pub mod mesh;
pub mod plates;
pub mod raster;
pub mod resample;
pub mod skeleton;
pub mod slice;
pub mod spline;
pub mod streams;
pub mod subdivision;
pub mod subdomains;
pub mod surface;
pub mod tiles;
pub mod tin;
pub mod tuning;
pub mod validate;

pub use base::error::{Error, Result};
