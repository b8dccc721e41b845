//! Surfaces, sub-domains and height maps with lines on them, as pictures and on paper.

use std::borrow::Cow;

use geo::{BoundingRect, MultiPolygon};
use glam::{DVec2, DVec3};
use image::RgbImage;

use crate::paper::{Fonts, Page, Sheet, Shown, sheet};
use crate::preview::{Patches, Preview, Subject, map_grid, render};
use tokosen_core::base::error::Result;
use tokosen_core::base::{Grid, Units};
use tokosen_core::contour::{Contour, ContourLine, ContourMap, Interval, Source, clip};
use tokosen_core::crs::{Crs, Reprojection};
use tokosen_core::dem::compare::heights_between;
use tokosen_core::raster::{Dem, mask, rasterise};
use tokosen_core::skeleton::SkeletonLine;
use tokosen_core::subdivision::Subdivision;
use tokosen_core::surface::{Surface, heights};

/// How many levels of the input lie between index contours in a picture.
const INDEX_EVERY: i64 = 5;

/// What a picture shows: ground, and lines on it.
pub struct Scene<'a> {
    /// Lower left and upper right corner.
    extent: (DVec2, DVec2),
    heights: Box<dyn Fn(&Grid) -> Dem + 'a>,
    crs: Option<Crs>,
    frame: Vec<[DVec2; 2]>,
    contours: Cow<'a, [ContourLine]>,
    skeleton_lines: Cow<'a, [SkeletonLine]>,
    patches: Option<&'a Patches>,
    levels: Vec<f64>,
    subject: Subject,
    reprojection: Option<&'a Reprojection>,
    units: Units,
    part: Option<&'a MultiPolygon<f64>>,
}

impl<'a> Scene<'a> {
    /// A surface with contours on it. The margin has the coordinates of the input if these are degrees, otherwise those of the
    /// plane. Heights are in these units.
    pub fn of_surface(
        surface: &'a Surface,
        contours: &'a [ContourLine],
        reprojection: &'a Reprojection,
        units: Units,
    ) -> Self {
        Self {
            extent: surface.frame.extent(),
            heights: Box::new(|grid| heights(surface, grid, &())),
            crs: surface.map.crs.clone(),
            frame: surface.frame.edges().collect(),
            contours: Cow::Borrowed(contours),
            skeleton_lines: Cow::Borrowed(&surface.skeleton_lines),
            patches: None,
            levels: Vec::new(),
            subject: Subject::Ground,
            reprojection: Some(reprojection),
            units,
            part: None,
        }
    }

    /// A triangulated map with its contours, lines, and areas in colour.
    pub fn of_subdivision(
        subdivision: &'a Subdivision,
        skeleton_lines: &'a [SkeletonLine],
        patches: Option<&'a Patches>,
        reprojection: &'a Reprojection,
        units: Units,
    ) -> Self {
        let contours = subdivision.map.contours.iter().map(|c| contour_line(c, &subdivision.interval)).collect();
        let crs = subdivision.map.crs.clone();
        let own = crs.clone();
        Self {
            extent: subdivision.frame.extent(),
            heights: Box::new(move |grid| rasterise(&subdivision.tin, grid, own.clone(), &())),
            crs,
            frame: subdivision.frame.edges().collect(),
            contours: Cow::Owned(contours),
            skeleton_lines: Cow::Borrowed(skeleton_lines),
            patches,
            levels: Vec::new(),
            subject: Subject::BreakLines,
            reprojection: Some(reprojection),
            units,
            part: None,
        }
    }

    /// A height map with contours on it.
    pub fn of_height_map(dem: &'a Dem, contours: &'a [ContourLine], units: Units) -> Self {
        let Grid { corner, cell, cols, rows } = dem.grid;
        let size = cell * DVec2::new(cols as f64, rows as f64);
        let heights = |grid: &Grid| {
            let values = heights_between(dem, grid, &Some);
            Dem { grid: *grid, values, crs: dem.crs.clone() }
        };
        Self {
            extent: (DVec2::new(corner.x, corner.y - size.y), DVec2::new(corner.x + size.x, corner.y)),
            heights: Box::new(heights),
            crs: dem.crs.clone(),
            frame: Vec::new(),
            contours: Cow::Borrowed(contours),
            skeleton_lines: Cow::Borrowed(&[]),
            patches: None,
            levels: Vec::new(),
            subject: Subject::Ground,
            reprojection: None,
            units,
            part: None,
        }
    }

    /// The same with one colour for the ground between each two of these levels, metres, ascending.
    pub fn in_bands(self, levels: Vec<f64>) -> Self {
        Self { levels, ..self }
    }

    /// The same of a part of the ground alone, with its border. Contours of a surface and of a height map must end there.
    pub fn within(self, part: Option<&'a MultiPolygon<f64>>) -> Self {
        let Some((area, rect)) = part.and_then(|part| Some((part, part.bounding_rect()?))) else { return self };
        let (lo, hi) = self.extent;
        let [least, greatest] = [rect.min(), rect.max()].map(|c| DVec2::new(c.x, c.y));
        let extent = (lo.max(least), hi.min(greatest));
        // A part beside the map has nothing to show.
        let extent = if extent.0.cmplt(extent.1).all() { extent } else { self.extent };
        let flat = |points: &[DVec3]| points.iter().map(|p| p.truncate()).collect();
        let pieces = pieces(self.skeleton_lines.iter().map(|line| flat(&line.points)), area);
        let skeleton_lines = pieces
            .into_iter()
            .map(|(k, points)| {
                // Heights of break lines are not drawn.
                SkeletonLine { points: points.into_iter().map(|p| p.extend(0.0)).collect(), ..self.skeleton_lines[k] }
            })
            .collect();
        let contours = match self.contours {
            Cow::Borrowed(contours) => Cow::Borrowed(contours),
            Cow::Owned(contours) => {
                let pieces = self::pieces(contours.iter().map(|line| line.points.clone()), area);
                let piece = |(k, points): (usize, Vec<DVec2>)| ContourLine { points, ..contours[k] };
                Cow::Owned(pieces.into_iter().map(piece).collect())
            }
        };
        Self { extent, part, contours, skeleton_lines: Cow::Owned(skeleton_lines), ..self }
    }

    /// The heights in cells, as far as they are shown.
    fn shown(&self, grid: &Grid) -> Dem {
        let mut dem = (self.heights)(grid);
        if let Some(part) = self.part {
            mask(&mut dem, part, &Some);
        }
        dem
    }

    fn preview<'b>(&'b self, dem: &'b Dem) -> Preview<'b> {
        Preview {
            skeleton_lines: &self.skeleton_lines,
            frame: &self.frame,
            patches: self.patches,
            levels: &self.levels,
            subject: self.subject,
            reprojection: self.reprojection,
            units: self.units,
            outline: self.part,
            ..Preview::new(dem, &self.contours)
        }
    }

    /// The picture.
    ///
    /// # Errors
    /// As [`map_grid`] and [`render`](fn@render).
    pub fn image(&self) -> Result<RgbImage> {
        let (lo, hi) = self.extent;
        render(&self.preview(&self.shown(&map_grid(lo, hi)?)))
    }

    /// The map on paper.
    ///
    /// # Errors
    /// [`Error::Parameter`](tokosen_core::base::error::Error::Parameter) if it does not fit on the paper, or can have no scale. As [`map_grid`].
    pub fn sheet(&self, page: &Page, fonts: &Fonts) -> Result<Sheet> {
        let (lo, hi) = self.extent;
        map_grid(lo, hi)?;
        // Of these heights, the system alone counts.
        let cell = Grid { corner: DVec2::new(lo.x, hi.y), cell: hi - lo, cols: 1, rows: 1 };
        let dem = Dem { grid: cell, values: vec![f32::NAN], crs: self.crs.clone() };
        let heights = |grid: &Grid| self.shown(grid);
        sheet(&Shown { extent: self.extent, heights: &heights, preview: self.preview(&dem) }, page, fonts)
    }
}

/// The pieces of lines inside an area, each with the number of its line.
fn pieces(lines: impl Iterator<Item = Vec<DVec2>>, area: &MultiPolygon<f64>) -> Vec<(usize, Vec<DVec2>)> {
    let line = |(k, points): (u64, Vec<DVec2>)| Contour { elevation: 0.0, points, feature: k.into() };
    let map = ContourMap { contours: (0..).zip(lines).map(line).collect(), ..ContourMap::default() };
    clip(map, area).map.contours.into_iter().map(|piece| (piece.feature.number() as usize, piece.points)).collect()
}

/// A contour of the input as a line of the output.
fn contour_line(contour: &Contour, interval: &Interval) -> ContourLine {
    ContourLine {
        elevation: contour.elevation,
        points: contour.points.clone(),
        source: Source::Input,
        index: interval.index_of(contour.elevation) % INDEX_EVERY == 0,
        kind: None,
        depression: false,
        expected: None,
    }
}
