//! Heights of a surface on any grid.

use glam::DVec2;

use super::along_streams::{Centres, flow_along};
use super::between_nodes::BetweenNodes;
use super::built::Surface;
use super::conditions::on_contours;
use super::places::triangle_at;
use crate::base::progress::Progress;
use crate::base::{Grid, parallel};
use crate::raster::{Dem, height, locate, rasterise};
use crate::tin::NONE;

/// Rows per task: enough to be worth a task.
const BAND_ROWS: usize = 16;

/// Heights of the surface at the cell centres of `grid`, metres; NaN outside the frame.
///
/// On the smooth surface, a centre at a node of the working grid has the node's height. Other centres are interpolated
/// by cubic convolution. What that misses at the contours around is added, and the height is kept in the band of its
/// sub-domain. A centre at a vertex of a contour has the level of the contour. Other surfaces are triangles (see
/// [`rasterise`]).
pub fn heights(surface: &Surface, grid: &Grid, progress: &dyn Progress) -> Dem {
    let Some(working) = &surface.working else {
        return rasterise(&surface.tin, grid, surface.map.crs.clone(), progress);
    };
    if let Some(mut values) = working.on_nodes(grid) {
        flow_along(surface, grid, &mut values, Centres::OnNodes);
        return Dem { grid: *grid, values, crs: surface.map.crs.clone() };
    }
    let triangles = locate(&surface.tin, grid, progress);
    let between = BetweenNodes::new(surface, working);
    let mut values = parallel::values(triangles.len(), |i| match triangles[i] {
        NONE => f32::NAN,
        t => between.at(t, grid.center(i % grid.cols, i / grid.cols)),
    });
    for (cell, level) in on_contours(&surface.map, grid) {
        if triangles[cell] != NONE
            && let Some(region) = surface.regions.region(triangles[cell])
        {
            values[cell] = level.clamp(region.band.lo, region.band.hi) as f32;
        }
    }
    flow_along(surface, grid, &mut values, Centres::BetweenNodes(&triangles));
    Dem { grid: *grid, values, crs: surface.map.crs.clone() }
}

/// Heights of the surface at the cell centres of a grid in other coordinates, metres, row by row from the north-west;
/// NaN outside the frame.
///
/// `to_surface` converts a position on the grid to the coordinates of the surface, if it can. The surface is evaluated
/// at each centre. No raster is resampled.
pub fn heights_on(
    surface: &Surface,
    grid: &Grid,
    to_surface: &(impl Fn(DVec2) -> Option<DVec2> + Sync),
    progress: &dyn Progress,
) -> Vec<f32> {
    let tin = &surface.tin;
    let mut values = vec![f32::NAN; grid.len()];
    if values.is_empty() || tin.is_empty() {
        return values;
    }
    let between = surface.working.as_ref().map(|working| BetweenNodes::new(surface, working));
    let height_in = |t: u32, p: DVec2| match &between {
        Some(between) => between.at(t, p),
        None => height(tin, t, p - tin.origin) as f32,
    };
    progress.start("evaluating the surface", grid.rows as u64);
    parallel::chunks(&mut values, grid.cols * BAND_ROWS, |band, cells| {
        // The search for the triangle of a centre starts at the triangle of the centre before. At the start of a row,
        // it starts at that of the row before.
        let mut start_of_row = 0;
        for (k, row) in cells.chunks_mut(grid.cols).enumerate() {
            let mut near = start_of_row;
            for (col, value) in row.iter_mut().enumerate() {
                let Some(p) = to_surface(grid.center(col, band * BAND_ROWS + k)) else { continue };
                let found = triangle_at(surface, &mut near, p);
                if col == 0 {
                    start_of_row = near;
                }
                if let Some(t) = found {
                    *value = height_in(t, p);
                }
            }
        }
        progress.advance((cells.len() / grid.cols) as u64);
    });
    progress.finish();
    values
}
