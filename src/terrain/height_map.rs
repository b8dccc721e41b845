//! Height maps of a terrain: [`Terrain::dem`], [`Terrain::errors`], and both at once in [`HeightMap`].

use super::base::BaseJoin;
use super::facade::Terrain;
use super::grid::GridSpec;
use tokosen_core::base::Grid;
use tokosen_core::base::error::{Error, Report, Result};
use tokosen_core::base::progress::Progress;
use tokosen_core::crs::Crs;
use tokosen_core::drain::Pit;
use tokosen_core::raster::{Dem, mask};
use tokosen_core::subdomains::FrameRing;

/// A height map, and what is known about its heights.
#[derive(Debug, Clone)]
pub struct HeightMap {
    /// The heights.
    pub dem: Dem,
    /// The standard errors of the heights, cell by cell, metres. NaN where there is no height, and where the height is
    /// that of the base. `None` if the options did not ask for them.
    pub errors: Option<Vec<f32>>,
    /// How the base fits, if there is one.
    pub base: Option<BaseJoin>,
}

impl Terrain {
    /// The height map at the centres of cells.
    ///
    /// # Errors
    /// As [`Terrain::height_map`].
    pub fn dem(&self, grid: &GridSpec) -> Result<Dem> {
        self.dem_with(grid, &())
    }

    /// [`Terrain::dem`] that shows its progress.
    ///
    /// # Errors
    /// As [`Terrain::height_map`].
    pub fn dem_with(&self, grid: &GridSpec, progress: &dyn Progress) -> Result<Dem> {
        Ok(self.height_map(grid, progress)?.value.dem)
    }

    /// Standard errors of the heights of [`Terrain::dem`], metres, as a raster. `None` if the options did not ask for
    /// them.
    ///
    /// # Errors
    /// As [`Terrain::height_map`].
    pub fn errors(&self, grid: &GridSpec) -> Result<Option<Dem>> {
        if self.surface.errors.is_none() {
            return Ok(None);
        }
        let HeightMap { dem, errors, .. } = self.height_map(grid, &())?.value;
        Ok(errors.map(|values| Dem { values, ..dem }))
    }

    /// The height map at the centres of cells, with standard errors. With a base ([`Input::set_base`]), cells outside
    /// the frame have the height of the base plus a correction: the difference at the border of the surface, carried
    /// outwards, where it fades. Cells inside are the same with and without a base. Cells that are given by their size
    /// cover the frame and the base, or the part of the map that is asked for.
    ///
    /// The findings are about the base. The summary of [`BaseJoin`] tells the differences at the border.
    ///
    /// [`Input::set_base`]: super::Input::set_base
    ///
    /// # Errors
    /// As [`GridSpec::check`]. [`Error::TooManyCells`] for cells that are too small,
    /// [`Error::CellTooLarge`] if no centre of a cell lies on the map. [`Error::NoOverlap`] if cells that
    /// were given all lie outside the frame. [`Error::UnknownCrs`] for cells in degrees over contours of an unknown
    /// system.
    pub fn height_map(&self, grid: &GridSpec, progress: &dyn Progress) -> Result<Report<HeightMap>> {
        let cells = grid.over(&self.reprojection)?;
        let mut dem = cells.heights(&self.surface, self.ground(), progress)?;
        if let (None, Some(area)) = (&self.background, &self.part) {
            mask(&mut dem, area, &|p| cells.on_plane(p));
        }
        if let GridSpec::Cells { file, .. } = grid
            && dem.values.iter().all(|height| height.is_nan())
        {
            return Err(file.as_ref().map_or(Error::NoOverlap, |file| Error::NoOverlap.in_file(file)));
        }
        let mut errors = cells.standard_errors(&self.surface, &dem);
        let Some(background) = &self.background else {
            return Ok(Report { value: HeightMap { dem, errors, base: None }, findings: Vec::new() });
        };
        // The border of the surface counts in the whole window, so the part is cut out afterwards.
        let Report { value, findings } = background.fill(&mut dem, &cells, &self.surface.interval, progress)?;
        if let Some(area) = &background.part {
            mask(&mut dem, area, &|p| cells.on_plane(p));
            let known = errors.iter_mut().flatten().zip(&dem.values);
            known.filter(|(_, height)| height.is_nan()).for_each(|(error, _)| *error = f32::NAN);
        }
        Ok(Report { value: HeightMap { dem, errors, base: Some(value) }, findings })
    }

    /// The pits of a height map that [`Terrain::dem`] gave, with the reasons why they stay.
    ///
    /// # Errors
    /// As [`Terrain::height_map`].
    pub fn pits_of(&self, dem: &Dem, grid: &GridSpec) -> Result<Vec<Pit>> {
        Ok(grid.over(&self.reprojection)?.pits(&self.surface, dem))
    }

    /// The cells that a specification gives over this terrain, and the coordinate reference system that they are in.
    ///
    /// # Errors
    /// As [`Terrain::dem`].
    pub fn cells(&self, grid: &GridSpec) -> Result<(Grid, Option<Crs>)> {
        let cells = grid.over(&self.reprojection)?;
        let crs = cells.crs(self.surface.map.crs.as_ref()).cloned();
        Ok((cells.grid(self.ground())?, crs))
    }

    /// The ground that height maps cover.
    fn ground(&self) -> &FrameRing {
        self.background.as_ref().map_or(&self.surface.frame, |background| &background.ground)
    }
}
