//! What a picture shows.

use super::patches::Patches;
use crate::contour::ContourLine;
use crate::dem::Dem;
use crate::skeleton::BreakLine;

/// What to draw.
#[derive(Debug, Clone, Copy)]
pub struct Preview<'a> {
    /// The surface, rasterised on the cells that [`map_grid`](super::map_grid) gives. A cell is a pixel.
    pub dem: &'a Dem,
    /// The contours, in the map units of the surface.
    pub contours: &'a [ContourLine],
    /// Ridge and canyon lines.
    pub break_lines: &'a [BreakLine],
    /// Areas by class, below the lines. The legend then names the classes in the place of the elevations.
    pub patches: Option<&'a Patches>,
    /// A title above the map.
    pub title: Option<&'a str>,
}
