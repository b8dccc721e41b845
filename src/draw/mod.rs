//! Pictures and reports: the preview of a result and the report of a comparison.

pub mod preview;
pub mod report;
