//! Whether anything can be derived from a height map.

use crate::base::error::{Error, Result};
use crate::dem::{Dem, looks_like_degrees};

/// Refuses a height map of which slopes say nothing.
///
/// # Errors
/// [`Error::Data`] if it has no height, or if its coordinates look like degrees and it names no coordinate reference system.
pub fn check(dem: &Dem) -> Result<()> {
    if looks_like_degrees(&dem.grid, dem.crs.as_ref()) {
        let message = "the coordinates look like degrees, but the height map names no system; name it first, for example \
                       with 'gdal_translate -a_srs EPSG:6668'";
        return Err(Error::Data(message.into()));
    }
    if dem.values.iter().all(|height| height.is_nan()) {
        return Err(Error::Data("has no cell with a height".into()));
    }
    Ok(())
}
