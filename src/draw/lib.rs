//! Pictures, charts and pages: the preview of a result, maps on paper, profiles and curves, the report of a comparison, and the
//! page for map tiles.

pub mod chart;
mod coordinates;
pub mod paper;
pub mod preview;
pub mod report;
mod scale;
mod scene;
pub mod viewer;

pub use scene::Scene;
