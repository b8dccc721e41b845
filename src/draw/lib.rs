//! Pictures and reports: the preview of a result and the report of a comparison.

mod coordinates;
pub mod preview;
pub mod report;
mod scale;
