//! The map of a comparison on paper.

use glam::DVec2;
use image::RgbImage;

use super::maps;
use super::page::ComparisonPage;
use super::survey::survey;
use super::table::{decimals_for, number, thousands};
use crate::coordinates::Notation;
use crate::paper::{DifferenceMap, Fonts, Page, Sheet, difference_sheet};
use tokosen_core::base::Grid;
use tokosen_core::base::error::Result;
use tokosen_core::dem::compare::{Comparison, round_limit};
use tokosen_core::raster::metres_per_unit;

/// The map of the differences A − B over the relief of B, with the scale, the colours and the figures. Without a title of its
/// own, the sheet has one that says what it is.
///
/// # Errors
/// As [`RasterRows::read`](tokosen_core::raster::RasterRows::read).
/// [`Error::Parameter`](tokosen_core::base::error::Error::Parameter) if the map does not fit on the paper, or can have no scale.
pub fn comparison_sheet(shown: &ComparisonPage<'_>, page: &Page, fonts: &Fonts) -> Result<Sheet> {
    let &ComparisonPage { a_name, b_name, a, b, found, .. } = shown;
    let survey = survey(a, b, found)?;
    let grid = b.grid();
    let limit = round_limit(&found.overall);
    let pixels = maps::difference_pixels(&survey.difference, &survey.b, limit, shown.metres_per_unit);
    let Grid { cell, cols, rows, .. } = survey.difference.grid;
    let image = RgbImage::from_raw(cols as u32, rows as u32, pixels).unwrap_or_default();
    let title = page.title.clone().or_else(|| Some("Heights compared: A − B".to_owned()));
    let map = DifferenceMap {
        grid: survey.window.of(&grid),
        metres: metres_per_unit(&grid, b.crs()),
        notation: Notation::of(b.crs()),
        image: (image, cell * DVec2::new(cols as f64, rows as f64)),
        limit,
        unit: found.unit,
        color: &maps::color,
        note: format!("A: {a_name}  ·  B: {b_name}"),
        figures: figures(found),
        places: [found.overall.lowest.place, found.overall.highest.place].to_vec(),
    };
    difference_sheet(map, &Page { title, ..page.clone() }, fonts)
}

fn figures(found: &Comparison) -> Vec<String> {
    let s = &found.overall;
    let height = |value: f64| format!("{} {}", number(value, decimals_for(s.rmse)), found.unit.symbol());
    let [lowest, highest] = [s.lowest.value, s.highest.value].map(|value| number(value, decimals_for(s.rmse)));
    let mut rows = vec![
        format!("RMSE {}", height(s.rmse)),
        format!("bias {}", height(s.bias)),
        format!("90 % within {}", height(s.le90)),
        format!("circles: {lowest} and {highest} {}", found.unit.symbol()),
        // The fonts have no narrow space.
        format!("{} cells", thousands(s.cells).replace('\u{202f}', " ")),
    ];
    rows.extend(found.slope.map(|slope| format!("slope RMSE {}°", number(slope.rmse, 2))));
    rows
}
