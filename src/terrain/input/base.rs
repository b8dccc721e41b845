//! The height map that gives the heights outside the frame.

use std::path::Path;

use super::Input;
use crate::terrain::base::Base;
use tokosen_core::base::error::Result;
use tokosen_core::raster::Dem;

impl Input {
    /// Takes a height map that gives the heights outside the frame. Height maps of the terrain then cover both:
    /// see [`Terrain::height_map`](crate::Terrain::height_map). It is in the contours' coordinate reference system if it
    /// names none. `file` is its name in messages. A base that was set before is replaced.
    ///
    /// # Errors
    /// [`Error::File`](crate::Error::File) if it seems to be in degrees and neither it nor the contours name a system in degrees.
    /// As [`Reprojection::bring`](tokosen_core::crs::Reprojection::bring) if its system cannot be converted to the working one.
    pub fn set_base(&mut self, dem: Dem, file: &Path) -> Result<()> {
        self.base = Some(Base::new(dem, file, &self.reprojection)?);
        Ok(())
    }
}
