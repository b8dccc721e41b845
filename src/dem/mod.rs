//! Height maps: the [`Dem`] of heights on a [`Grid`](crate::base::Grid) of cells.

pub mod compare;
pub mod derive;
mod ground;
mod height_map;
mod rasterise;
pub mod shade;

pub use ground::{GroundScale, looks_like_degrees};
pub use height_map::Dem;
pub(crate) use rasterise::{height, heights_at};
pub use rasterise::{locate, rasterise};
