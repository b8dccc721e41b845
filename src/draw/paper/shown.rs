//! What a sheet shows.

use glam::DVec2;

use crate::preview::Preview;
use tokosen_core::base::Grid;
use tokosen_core::raster::Dem;

/// What a sheet shows: a picture, and the heights in cells of any size.
pub(crate) struct Shown<'a> {
    /// Lower left and upper right corner.
    pub extent: (DVec2, DVec2),
    pub heights: &'a dyn Fn(&Grid) -> Dem,
    /// The lines and units; of its heights, only their coordinate reference system counts.
    pub preview: Preview<'a>,
}
