//! Values of a raster, some rows at a time. So a raster may be larger than the memory.

use std::borrow::Cow;
use std::fmt::Debug;
use std::sync::Arc;

use super::height_map::Dem;
use crate::base::Grid;
use crate::base::error::{Error, Finding, Result};
use crate::crs::Crs;

/// A raster whose rows are read or computed on demand: a [`Dem`], a file, or what follows from one. Values are heights in metres
/// where nothing else is said.
///
/// Reading row after row is fast. A file may have to decode many rows for one.
pub trait RasterRows: Debug + Send + Sync {
    /// The grid of cells.
    fn grid(&self) -> Grid;

    /// The coordinate reference system, if known.
    fn crs(&self) -> Option<&Crs>;

    /// Reads whole rows from the row `first` on: as many as `heights` has room for. Heights are in metres; NaN where there is no
    /// data.
    ///
    /// # Errors
    /// If the file cannot be read or is broken.
    fn read(&self, first: usize, heights: &mut [f32]) -> Result<()>;

    /// Findings about the heights of all rows that were read so far.
    fn findings(&self) -> Vec<Finding> {
        Vec::new()
    }

    /// All heights.
    ///
    /// # Errors
    /// As [`RasterRows::read`]. If there is not enough memory.
    fn whole(&self) -> Result<Cow<'_, Dem>> {
        let grid = self.grid();
        let mut values = uniform(grid.len(), f32::NAN)?;
        self.read(0, &mut values)?;
        Ok(Cow::Owned(Dem { grid, values, crs: self.crs().cloned() }))
    }
}

/// A vector of one value for each of `cells` cells.
///
/// # Errors
/// As [`reserve`].
pub fn uniform<T: Clone>(cells: usize, value: T) -> Result<Vec<T>> {
    let mut values = Vec::new();
    reserve(&mut values, cells)?;
    values.resize(cells, value);
    Ok(values)
}

/// Makes room for the values of `cells` cells in all.
///
/// # Errors
/// [`Error::Data`] if there is not enough memory.
pub fn reserve<T>(values: &mut Vec<T>, cells: usize) -> Result<()> {
    values.try_reserve_exact(cells.saturating_sub(values.len())).map_err(|_| {
        Error::Data(format!(
            "there is not enough memory for {cells} cells; cut the raster first, for example with gdalwarp"
        ))
    })
}

impl RasterRows for Dem {
    fn grid(&self) -> Grid {
        self.grid
    }

    fn crs(&self) -> Option<&Crs> {
        self.crs.as_ref()
    }

    fn read(&self, first: usize, heights: &mut [f32]) -> Result<()> {
        let start = first * self.grid.cols;
        let Some(values) = self.values.get(start..start + heights.len()) else {
            let Grid { cols, rows, .. } = self.grid;
            let message = format!("a height map of {cols} x {rows} cells cannot have {} values", self.values.len());
            return Err(Error::Parameter(message));
        };
        heights.copy_from_slice(values);
        Ok(())
    }

    fn whole(&self) -> Result<Cow<'_, Dem>> {
        Ok(Cow::Borrowed(self))
    }
}

/// A raster in another coordinate reference system than it states.
#[derive(Debug)]
pub struct WithCrs {
    /// The raster.
    pub rows: Arc<dyn RasterRows>,
    /// The system.
    pub crs: Option<Crs>,
}

impl RasterRows for WithCrs {
    fn grid(&self) -> Grid {
        self.rows.grid()
    }

    fn crs(&self) -> Option<&Crs> {
        self.crs.as_ref()
    }

    fn read(&self, first: usize, heights: &mut [f32]) -> Result<()> {
        self.rows.read(first, heights)
    }

    fn findings(&self) -> Vec<Finding> {
        self.rows.findings()
    }
}
