//! The difference of two height maps on one grid.

use crate::base::Grid;
use crate::base::error::Result;
use crate::crs::Crs;
use crate::raster::{Dem, RasterRows, uniform};

/// The difference A − B of two height maps on one grid. NaN where one of them has no height.
///
/// # Errors
/// As [`RasterRows::read`]. If there is not enough memory.
pub fn difference(a: &dyn RasterRows, b: &dyn RasterRows) -> Result<Dem> {
    Ok(Difference { a, b }.whole()?.into_owned())
}

/// The difference A − B of two height maps on one grid, computed when its rows are read.
#[derive(Debug, Clone, Copy)]
pub struct Difference<'a> {
    /// The heights from which those of B are subtracted.
    pub a: &'a dyn RasterRows,
    /// The heights that are subtracted.
    pub b: &'a dyn RasterRows,
}

impl RasterRows for Difference<'_> {
    fn grid(&self) -> Grid {
        self.b.grid()
    }

    fn crs(&self) -> Option<&Crs> {
        self.b.crs()
    }

    fn read(&self, first: usize, values: &mut [f32]) -> Result<()> {
        let mut heights = uniform(values.len(), f32::NAN)?;
        let (of_a, of_b) = rayon::join(|| self.a.read(first, values), || self.b.read(first, &mut heights));
        of_a.and(of_b)?;
        values.iter_mut().zip(heights).for_each(|(a, b)| *a = subtract(*a, b));
        Ok(())
    }
}

/// The difference of two heights. NaN if one of them is no number.
pub fn subtract(a: f32, b: f32) -> f32 {
    if a.is_finite() && b.is_finite() { (f64::from(a) - f64::from(b)) as f32 } else { f32::NAN }
}
