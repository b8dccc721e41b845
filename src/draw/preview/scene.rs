//! Pictures of a surface or of sub-domains with lines on them.

use glam::DVec2;
use image::RgbImage;

use super::patches::Patches;
use super::render::render;
use super::sheet::map_grid;
use super::view::{Preview, Subject};
use tokosen_core::base::error::Result;
use tokosen_core::base::{Grid, Units};
use tokosen_core::contour::{Contour, ContourLine, Interval, Source};
use tokosen_core::crs::Reprojection;
use tokosen_core::dem::compare::heights_between;
use tokosen_core::raster::{Dem, rasterise};
use tokosen_core::skeleton::BreakLine;
use tokosen_core::subdivision::Subdivision;
use tokosen_core::subdomains::FrameRing;
use tokosen_core::surface::{Surface, heights};

/// How many levels of the input lie between index contours in a picture.
const INDEX_EVERY: i64 = 5;

/// Draws a surface with contours on it. The margin has the coordinates of the input if these are degrees, otherwise
/// those of the plane. Heights are in these units.
///
/// # Errors
/// As [`map_grid`] and [`render`].
pub fn picture(
    surface: &Surface,
    contours: &[ContourLine],
    reprojection: &Reprojection,
    units: Units,
) -> Result<RgbImage> {
    let (frame, break_lines, subject) = (&surface.frame, surface.break_lines.as_slice(), Subject::Ground);
    let scene = Scene { frame, contours, break_lines, patches: None, subject, reprojection, units };
    scene.draw(|grid| heights(surface, grid, &()))
}

/// Draws a triangulated map with its contours, lines, and areas in colour.
///
/// # Errors
/// As [`map_grid`] and [`render`].
pub fn subdivision_picture(
    subdivision: &Subdivision,
    break_lines: &[BreakLine],
    patches: Option<&Patches>,
    reprojection: &Reprojection,
    units: Units,
) -> Result<RgbImage> {
    let contours: Vec<ContourLine> =
        subdivision.map.contours.iter().map(|c| contour_line(c, &subdivision.interval)).collect();
    let (frame, subject) = (&subdivision.frame, Subject::BreakLines);
    let scene = Scene { frame, contours: &contours, break_lines, patches, subject, reprojection, units };
    scene.draw(|grid| rasterise(&subdivision.tin, grid, subdivision.map.crs.clone(), &()))
}

/// Draws a height map with contours on it.
///
/// # Errors
/// As [`map_grid`] and [`render`].
pub fn height_map_picture(dem: &Dem, contours: &[ContourLine], units: Units) -> Result<RgbImage> {
    let Grid { corner, cell, cols, rows } = dem.grid;
    let size = cell * DVec2::new(cols as f64, rows as f64);
    let grid = map_grid(DVec2::new(corner.x, corner.y - size.y), DVec2::new(corner.x + size.x, corner.y))?;
    let values = heights_between(dem, &grid, &Some);
    let dem = Dem { grid, values, crs: dem.crs.clone() };
    render(&Preview { units, ..Preview::new(&dem, contours) })
}

/// What a picture shows.
struct Scene<'a> {
    frame: &'a FrameRing,
    contours: &'a [ContourLine],
    break_lines: &'a [BreakLine],
    patches: Option<&'a Patches>,
    subject: Subject,
    reprojection: &'a Reprojection,
    units: Units,
}

impl Scene<'_> {
    /// Draws it over anything that has heights on a grid.
    fn draw(&self, heights: impl FnOnce(&Grid) -> Dem) -> Result<RgbImage> {
        let (lo, hi) = self.frame.extent();
        let dem = heights(&map_grid(lo, hi)?);
        let Self { contours, break_lines, patches, subject, reprojection, units, .. } = *self;
        let frame: Vec<_> = self.frame.edges().collect();
        render(&Preview {
            break_lines,
            frame: &frame,
            patches,
            subject,
            reprojection: Some(reprojection),
            units,
            ..Preview::new(&dem, contours)
        })
    }
}

/// A contour of the input as a line of the output.
fn contour_line(contour: &Contour, interval: &Interval) -> ContourLine {
    ContourLine {
        elevation: contour.elevation,
        points: contour.points.clone(),
        source: Source::Input,
        index: interval.index_of(contour.elevation) % INDEX_EVERY == 0,
        depression: false,
        expected: None,
    }
}
