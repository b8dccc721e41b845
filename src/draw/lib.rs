//! Pictures, charts and reports: the preview of a result, maps on paper, profiles and curves, and the report of a comparison.

pub mod chart;
mod coordinates;
pub mod paper;
pub mod preview;
pub mod report;
mod scale;
mod scene;

pub use scene::Scene;
