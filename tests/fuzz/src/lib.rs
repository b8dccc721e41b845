//! What the fuzz targets share. The tests of the library call the same with the seeds.

// Of what the tests share, the guarantees ask for this alone; the rest wants crates that are not needed here.
#[path = "../../common/crossings.rs"]
mod common;
#[path = "../../guarantees/mod.rs"]
mod guarantees;
pub mod pipeline;
pub mod readers;

pub use readers::{heights, vectors};
