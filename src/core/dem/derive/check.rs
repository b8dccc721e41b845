//! Whether anything can be derived from a height map.

use crate::base::error::{Error, Result};
use crate::raster::{Blocks, RasterRows, looks_like_degrees};

/// Refuses a height map of which slopes say nothing.
///
/// # Errors
/// [`Error::Data`] if it has no height, or if its coordinates look like degrees and it names no coordinate reference system.
/// As [`RasterRows::read`].
pub fn check(heights: &dyn RasterRows) -> Result<()> {
    if looks_like_degrees(&heights.grid(), heights.crs()) {
        let message = "the coordinates look like degrees, but the height map names no system; name it first, for example \
                       with 'gdal_translate -a_srs EPSG:6668'";
        return Err(Error::Data(message.into()));
    }
    let mut blocks = Blocks::of(heights);
    while let Some(block) = blocks.next()? {
        if block.heights().iter().any(|height| !height.is_nan()) {
            return Ok(());
        }
    }
    Err(Error::Data("has no cell with a height".into()))
}
