//! Heights in another unit than metres, for figures that people read.

use std::sync::Arc;

use super::rows::RasterRows;
use crate::base::error::{Finding, Result};
use crate::base::{ElevationUnit, Grid};
use crate::crs::Crs;

/// The heights of `rows`, which are in metres, in `unit`.
#[derive(Debug)]
pub struct InUnit {
    /// The heights in metres.
    pub rows: Arc<dyn RasterRows>,
    /// The unit.
    pub unit: ElevationUnit,
}

impl InUnit {
    /// The heights in a unit; those in metres stay as they are.
    pub fn of(rows: &Arc<dyn RasterRows>, unit: ElevationUnit) -> Arc<dyn RasterRows> {
        let rows = Arc::clone(rows);
        if unit.is_foot() { Arc::new(Self { rows, unit }) } else { rows }
    }
}

impl RasterRows for InUnit {
    fn grid(&self) -> Grid {
        self.rows.grid()
    }

    fn crs(&self) -> Option<&Crs> {
        self.rows.crs()
    }

    fn read(&self, first: usize, heights: &mut [f32]) -> Result<()> {
        self.rows.read(first, heights)?;
        heights.iter_mut().for_each(|height| *height = self.unit.about(f64::from(*height)) as f32);
        Ok(())
    }

    fn findings(&self) -> Vec<Finding> {
        self.rows.findings()
    }
}
