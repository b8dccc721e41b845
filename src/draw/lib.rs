//! Pictures, charts and pages: the preview of a result, maps on paper, profiles and curves, the report of a comparison, and the
//! pages for map tiles and for a terrain in 3-D.

pub mod chart;
mod coordinates;
mod page;
pub mod paper;
pub mod preview;
pub mod report;
mod scale;
mod scene;
pub mod terrain_page;
pub mod viewer;

pub use scene::Scene;
