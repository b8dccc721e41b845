//! A map of differences of heights on paper, with its figures.

use glam::DVec2;
use image::RgbImage;

use super::fonts::Fonts;
use super::legend::{around, columns, ramp, scale_block};
use super::map::{TICK_PIXEL, frame};
use super::page::{Page, Placed};
use super::shapes::{Look, Shape, Sheet};
use crate::coordinates::{Notation, ticks};
use crate::preview::color::{INK, Rgb};
use tokosen_core::base::error::Result;
use tokosen_core::base::{ElevationUnit, Grid};

/// Radius of the circles around places, and width of their lines, millimetres.
const CIRCLE: [f64; 2] = [2.5, 0.35];
/// Corners of a circle.
const CORNERS: usize = 48;

/// What the sheet shows.
pub(crate) struct DifferenceMap<'a> {
    /// The cells of the map.
    pub grid: Grid,
    /// Metres in a map unit along x and y, if they are known.
    pub metres: Option<DVec2>,
    /// How coordinates are written.
    pub notation: Notation,
    /// The map as a picture, and the size of what it covers in map units, from the upper left corner of the map.
    pub image: (RgbImage, DVec2),
    /// The difference, above and below 0, where the colours end.
    pub limit: f64,
    /// The unit of the differences.
    pub unit: ElevationUnit,
    /// The colours of differences, from −1 to 1 as shares of the limit.
    pub color: &'a dyn Fn(f64) -> Rgb,
    /// What was compared, above the map.
    pub note: String,
    /// Figures, below the map.
    pub figures: Vec<String>,
    /// Places with a circle.
    pub places: Vec<DVec2>,
}

/// Draws the sheet.
///
/// # Errors
/// As [`Page::place`].
pub(crate) fn difference_sheet(map: DifferenceMap<'_>, page: &Page, fonts: &Fonts) -> Result<Sheet> {
    // Degrees are longer along y than along x, so the map is laid out in metres.
    let metres = map.metres.unwrap_or(DVec2::ONE);
    let size = map.grid.cell * DVec2::new(map.grid.cols as f64, map.grid.rows as f64) * metres;
    let placed = page.place(size, map.metres.map(|_| 1.0))?;
    let Placed { paper, frame: [from, to], unit, scale } = placed;
    let on_plane = |millimetres: DVec2| map.grid.corner + DVec2::new(millimetres.x, -millimetres.y) * unit / metres;
    let ticks = ticks((to - from) / TICK_PIXEL, map.notation, |p| Some(on_plane(p * TICK_PIXEL)));
    let circle = |place: &DVec2| {
        let middle = from + (*place - map.grid.corner) * DVec2::new(1.0, -1.0) * metres / unit;
        let at = |k: usize| middle + CIRCLE[0] * DVec2::from_angle(k as f64 * std::f64::consts::TAU / CORNERS as f64);
        (0..=CORNERS).map(at).collect()
    };
    let circles = map.places.iter().map(circle).collect();
    let look = Look { color: INK, width: CIRCLE[1], dashes: None };
    let mut blocks = vec![scale_block(&placed, map.unit, fonts)];
    let color = |share: f64| (map.color)(2.0 * share - 1.0);
    blocks.push(ramp(&format!("Difference A − B, {}", map.unit.symbol()), [-map.limit, map.limit], color));
    blocks.extend(columns(&map.figures, fonts));
    let mut outside = frame(&placed, &ticks, fonts);
    outside.extend(around(page, &placed, &map.note, blocks, fonts));
    let (image, covered) = map.image;
    let picture = Shape::Picture { from, to: from + covered * metres / unit, image };
    let shapes = vec![picture, Shape::Lines { lines: circles, look }];
    Ok(Sheet { size: paper, frame: [from, to], map: shapes, around: outside, title: page.title.clone(), scale })
}
