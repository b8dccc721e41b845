//! Contour lines as data: [`Contour`], [`ContourMap`], their levels.

mod cliff;
mod clip;
mod clip_lines;
mod coast;
mod cut_out;
mod excluded;
mod interval_search;
mod lake;
mod levels;
mod line;
mod map;
mod outlying;
mod reproject;
mod same_levels;
mod source_raster;
mod spots;
mod stated_unit;
mod target;
mod unit_hint;

pub use crate::base::ElevationUnit;
pub use cliff::CliffLine;
pub use clip::{Clipped, clip, noded};
#[doc(hidden)]
pub use clip_lines::clip_lines;
pub use coast::CoastLine;
pub use cut_out::{CutOut, cut_out};
pub use excluded::Excluded;
pub use interval_search::find_interval;
pub use lake::Lake;
pub use levels::{Interval, distinct_levels};
pub use line::{ContourKind, ContourLayer, ContourLine, LineError, Source};
pub use map::{Contour, ContourMap};
pub(crate) use outlying::{outlying_vertices, without_outlying};
pub use reproject::reproject;
pub use same_levels::unite_levels;
pub use source_raster::{SourceRaster, source_raster};
pub use spots::{SoftSpot, SpotHeights};
pub use stated_unit::StatedUnit;
pub use target::Target;
pub use unit_hint::UnitHint;
