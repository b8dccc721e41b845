//! Rasters: the [`Dem`] of heights on a [`Grid`](crate::base::Grid) of cells, row by row or whole, and the heights of a
//! triangulation at the cells of a grid.

mod blocks;
mod faces;
pub(crate) mod gradient;
mod ground;
mod height_map;
mod in_unit;
mod part;
mod rasterise;
mod rows;
mod shift_grid;

#[doc(hidden)]
pub use blocks::Block;
#[doc(hidden)]
pub use blocks::Blocks;
#[doc(hidden)]
pub use blocks::each_pair;
#[doc(hidden)]
pub use faces::rasterise_faces;
pub(crate) use gradient::gradient_at;
#[doc(hidden)]
pub use ground::other_unit;
pub use ground::{GroundScale, equal_area, in_plane_unit, looks_like_degrees, metres_per_unit};
pub use height_map::Dem;
pub use in_unit::InUnit;
#[doc(hidden)]
pub use part::mask;
pub(crate) use rasterise::{height, heights_at};
pub use rasterise::{locate, rasterise};
#[doc(hidden)]
pub use rows::reserve;
#[doc(hidden)]
pub use rows::uniform;
pub use rows::{RasterRows, WithCrs};
pub use shift_grid::{ShiftGrid, ShiftWay};
