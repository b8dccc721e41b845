//! What a picture shows.

use geo::MultiPolygon;
use glam::DVec2;

use super::patches::Patches;
use tokosen_core::base::Units;
use tokosen_core::contour::ContourLine;
use tokosen_core::crs::Reprojection;
use tokosen_core::raster::Dem;
use tokosen_core::skeleton::SkeletonLine;

/// What to draw.
#[derive(Debug, Clone, Copy)]
pub struct Preview<'a> {
    /// The surface, rasterised on the cells that [`map_grid`](super::map_grid) gives. A cell is a pixel.
    pub dem: &'a Dem,
    /// The contours, in the map units of the surface.
    pub contours: &'a [ContourLine],
    /// Ridge and canyon lines.
    pub skeleton_lines: &'a [SkeletonLine],
    /// The edges of the map's frame. Ridge and canyon lines are not drawn along them.
    pub frame: &'a [[DVec2; 2]],
    /// Areas by class, below the lines. The legend then names the classes in the place of the elevations.
    pub patches: Option<&'a Patches>,
    /// Levels, metres, ascending. The ground between two of them has one colour. Without levels, the tint is smooth.
    pub levels: &'a [f64],
    /// What the picture is about.
    pub subject: Subject,
    /// The conversion to the coordinates of the input. If these are degrees, the margin has degrees.
    pub reprojection: Option<&'a Reprojection>,
    /// The units of the heights and of the scale bar. A plane whose unit is not known has a bar in map units.
    pub units: Units,
    /// A title above the map.
    pub title: Option<&'a str>,
    /// The border of the part of the map that the picture is about.
    pub outline: Option<&'a MultiPolygon<f64>>,
}

impl<'a> Preview<'a> {
    /// A surface with contours, and nothing else.
    pub fn new(dem: &'a Dem, contours: &'a [ContourLine]) -> Self {
        Self {
            dem,
            contours,
            skeleton_lines: &[],
            frame: &[],
            patches: None,
            levels: &[],
            subject: Subject::Ground,
            reprojection: None,
            units: Units::METRES,
            title: None,
            outline: None,
        }
    }
}

/// What a picture is about.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Subject {
    /// The ground and its contours. Ridge and canyon lines are left out where they would hide it.
    #[default]
    Ground,
    /// Ridge and canyon lines.
    BreakLines,
}
