//! Height maps: the [`Dem`] of heights on a [`Grid`](crate::base::Grid) of cells. [`contour`] draws its contours,
//! [`derive`](mod@derive) slopes, [`compare`] compares two of them, [`join`] fills one from another.

mod blocks;
pub mod compare;
pub mod contour;
pub mod derive;
mod gradient;
mod ground;
mod height_map;
pub mod join;
mod part;
mod rasterise;
mod rows;
pub mod shade;
pub mod smooth;

pub(crate) use blocks::{Block, Blocks, each_pair};
pub(crate) use ground::other_unit;
pub use ground::{GroundScale, in_plane_unit, looks_like_degrees, metres_per_unit};
pub use height_map::Dem;
pub(crate) use part::mask;
pub(crate) use rasterise::{height, heights_at};
pub use rasterise::{locate, rasterise};
#[cfg(feature = "io")]
pub(crate) use rows::reserve;
pub(crate) use rows::uniform;
pub use rows::{RasterRows, WithCrs};
