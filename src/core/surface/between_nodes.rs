//! The smooth surface between the nodes of its working grid.

use glam::DVec2;

use super::built::Surface;
use super::conditions::levels_of_vertices;
use crate::raster::height;
use crate::spline::{Misses, WorkingGrids};

/// Heights of a smooth surface at any place.
pub(crate) struct BetweenNodes<'a> {
    surface: &'a Surface,
    working: &'a WorkingGrids,
    misses: Misses<'a>,
}

impl<'a> BetweenNodes<'a> {
    pub fn new(surface: &'a Surface, working: &'a WorkingGrids) -> Self {
        let levels = levels_of_vertices(&surface.tin, &surface.map, &surface.wrong_lines);
        let step = working.0.iter().map(|part| part.grid.cell.max_element()).fold(0.0, f64::max);
        Self { surface, working, misses: Misses::new(&surface.tin, &levels, step, |p| working.at(p)) }
    }

    /// The height at a position in triangle `t`, metres, within the band of its sub-domain.
    pub fn at(&self, t: u32, p: DVec2) -> f32 {
        let Surface { tin, regions, .. } = self.surface;
        let Some(region) = regions.region(t) else { return f32::NAN };
        let place = p - tin.origin;
        let smooth = self.working.at(p);
        // Where the frame is narrower than the cells of the working grid, there may be no node near.
        let found = if smooth.is_nan() { height(tin, t, place) as f32 } else { smooth + self.misses.at(t, place) };
        found.clamp(region.band.lo as f32, region.band.hi as f32)
    }
}
