//! The base of all other modules: errors and findings, progress, the [`Grid`] of a raster, units of elevations, and
//! small data structures.

#[doc(hidden)]
pub mod bits;
#[doc(hidden)]
pub mod decimal;
pub mod error;
mod feature;
mod grid;
mod key;
mod known_line;
#[doc(hidden)]
pub mod memory;
#[doc(hidden)]
pub mod parallel;
pub mod progress;
#[doc(hidden)]
pub mod rows;
#[doc(hidden)]
pub mod union_find;
mod unit;
mod words;

pub use feature::FeatureId;
pub use grid::Grid;
pub(crate) use key::Key;
pub(crate) use known_line::{KnownLine, Sure};
pub use unit::ElevationUnit;
pub use words::Units;
