//! A picture of the result: the shaded surface with its contours, ridge and canyon lines, and a legend.
//!
//! [`map_grid`] gives the cells to rasterise the surface on: one cell per pixel. [`render`] draws the map.
//! [`render_model`] draws a mesh in space.
//!
//! From bottom to top: the tint by elevation, shaded by soft light from the north-west; areas by class, if asked for;
//! the interpolated contours, thin; the input's contours, bold; canyon and ridge lines. Cells without data stay white.
//! Where contours would lie closer than a few pixels, only some levels are drawn, and the legend says which.

mod canvas;
mod color;
mod kinds;
mod legend;
mod lines;
mod oblique;
mod patches;
mod render;
mod scale;
mod scene;
mod sheet;
mod text;
mod view;
mod zbuffer;

pub use kinds::{landform_patches, triangle_patches};
pub use oblique::{Model, render_model};
pub use patches::{Patch, PatchClass, Patches};
pub use render::render;
pub use scene::{height_map_picture, picture, subdivision_picture};
pub use sheet::{MAX_SIDE, map_grid};
pub use view::Preview;
