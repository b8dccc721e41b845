//! Standard errors of the heights of a surface, cell by cell.

use glam::DVec2;

use super::built::Surface;
use crate::base::parallel;
use crate::raster::Dem;

/// Standard errors of the cells of a height map of the surface, metres. They are NaN where the height map has no data.
/// `None` if no errors were requested when the surface was built.
pub fn standard_errors(surface: &Surface, dem: &Dem) -> Option<Vec<f32>> {
    standard_errors_on(surface, dem, &Some)
}

/// [`standard_errors`] for a height map in other coordinates than the surface. `to_surface` converts a position on the
/// height map to the coordinates of the surface.
pub fn standard_errors_on(
    surface: &Surface,
    dem: &Dem,
    to_surface: &(impl Fn(DVec2) -> Option<DVec2> + Sync),
) -> Option<Vec<f32>> {
    let field = surface.errors.as_ref()?;
    let grid = &dem.grid;
    Some(parallel::values(grid.len(), |i| {
        let place = if dem.values[i].is_nan() { None } else { to_surface(grid.center(i % grid.cols, i / grid.cols)) };
        place.map_or(f32::NAN, |p| field.at(p))
    }))
}
