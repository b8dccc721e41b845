//! A map on paper, as PDF or SVG: the shaded relief with lines, text and frame as vectors, at a scale.
//!
//! 1. [`Page`] says on which [`Paper`], at which scale, and under which title. It places the map on the paper.
//! 2. The map is drawn as shapes in millimetres, a [`Sheet`]. The relief is a picture; all else are lines, areas and texts.
//! 3. [`Sheet::pdf`] and [`Sheet::svg`] write the shapes. [`Fonts`] are embedded.

mod compress;
mod differences;
mod embed;
mod fonts;
mod legend;
mod lines;
mod map;
mod page;
mod pdf;
mod shapes;
mod shown;
mod svg;

pub(crate) use differences::{DifferenceMap, difference_sheet};
pub use fonts::Fonts;
pub(crate) use map::sheet;
pub use page::{Page, Paper};
pub use shapes::Sheet;
pub(crate) use shown::Shown;
