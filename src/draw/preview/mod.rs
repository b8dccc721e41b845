//! A picture of the result: the shaded surface with its contours, ridge and canyon lines, and a legend.
//!
//! [`map_grid`] gives the cells to rasterise the surface on: one cell per pixel. [`render`] draws the map.
//! [`render_model`] draws a mesh in space.
//!
//! From bottom to top: the tint by elevation, shaded by soft light from the north-west; areas by class, if asked for;
//! the interpolated contours, thin and orange; the input's contours, brown, and index contours bolder; canyon and ridge
//! lines; the elevations of index contours. Cells without data stay white. Around the map are coordinates.
//!
//! Where contours would lie closer than a few pixels, only some levels are drawn. Ridge and canyon lines that would hide
//! the ground are left out. The legend says what is drawn.

pub(crate) mod canvas;
pub(crate) mod color;
mod density;
mod kinds;
mod labels;
pub(crate) mod legend;
mod lines;
mod margin;
mod oblique;
pub(crate) mod patches;
pub(crate) mod plan;
pub(crate) mod render;
mod sheet;
pub(crate) mod skeleton_lines;
pub(crate) mod stroke;
pub(crate) mod text;
mod view;
mod zbuffer;

pub use kinds::{landform_patches, triangle_patches};
pub use oblique::{Model, render_model};
pub use patches::{Patch, PatchClass, Patches};
pub use render::render;
pub use sheet::{MAX_SIDE, map_grid};
pub use view::{Preview, Subject};
