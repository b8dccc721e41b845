//! Pictures, charts and pages: the preview of a result, profiles and curves, the report of a comparison, and the page for map
//! tiles.

pub mod chart;
mod coordinates;
pub mod preview;
pub mod report;
mod scale;
pub mod viewer;
