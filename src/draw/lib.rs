//! Pictures, charts and reports: the preview of a result, profiles and curves, and the report of a comparison.

pub mod chart;
mod coordinates;
pub mod preview;
pub mod report;
mod scale;
