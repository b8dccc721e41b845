//! Standard errors of a surface's heights, cell by cell.

use glam::DVec2;
use rayon::prelude::*;

use super::built::Surface;
use crate::dem::Dem;

/// Standard errors of the cells of a height map of the surface, metres: no data where it has none. `None` if none were
/// asked for when the surface was built.
pub fn standard_errors(surface: &Surface, dem: &Dem) -> Option<Vec<f32>> {
    standard_errors_on(surface, dem, &Some)
}

/// [`standard_errors`] for a height map in other coordinates than the surface: `to_surface` gives the place on the surface
/// of a place in those.
pub fn standard_errors_on(
    surface: &Surface,
    dem: &Dem,
    to_surface: &(impl Fn(DVec2) -> Option<DVec2> + Sync),
) -> Option<Vec<f32>> {
    let field = surface.errors.as_ref()?;
    let grid = &dem.grid;
    let error = |(i, height): (usize, &f32)| {
        let place = if height.is_nan() { None } else { to_surface(grid.center(i % grid.cols, i / grid.cols)) };
        place.map_or(f32::NAN, |p| field.at(p))
    };
    Some(dem.values.par_iter().enumerate().map(error).collect())
}
