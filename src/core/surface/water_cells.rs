//! Cells that lie in lakes or in the sea.

use super::built::Surface;
use crate::base::{Grid, parallel};
use crate::raster::locate;
use crate::tin::NONE;

/// Whether each cell's centre lies in a lake or in the sea. `None` if the map has neither.
pub fn water_cells(surface: &Surface, grid: &Grid) -> Option<Vec<bool>> {
    surface.regions.regions.iter().any(|region| region.water.is_some()).then(|| {
        let triangles = locate(&surface.tin, grid, &());
        let is_water = |t: u32| surface.regions.region(t).is_some_and(|region| region.water.is_some());
        parallel::values(triangles.len(), |k| triangles[k] != NONE && is_water(triangles[k]))
    })
}
