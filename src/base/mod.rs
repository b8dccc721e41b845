//! The base of all other modules: errors and findings, progress, the [`Grid`] of a raster, units of elevations, and
//! small data structures.

pub(crate) mod bits;
pub(crate) mod decimal;
pub mod error;
mod feature;
mod grid;
mod key;
mod known_line;
pub(crate) mod memory;
pub(crate) mod parallel;
pub mod progress;
pub(crate) mod rows;
pub(crate) mod union_find;
mod unit;

pub use feature::FeatureId;
pub use grid::Grid;
pub(crate) use key::Key;
pub(crate) use known_line::{KnownLine, Sure};
pub use unit::ElevationUnit;
