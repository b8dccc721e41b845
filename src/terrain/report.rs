//! The report of a comparison of two sides: sentences and a page.

use super::compare::{Kind, Pair, Side};
use tokosen_core::base::Units;
use tokosen_core::base::error::Result;
use tokosen_core::crs::HeightSystem;
use tokosen_core::dem::compare::{Comparison, Trend};
use tokosen_core::raster::InUnit;
use tokosen_draw::paper::{Fonts, Page, Sheet};
use tokosen_draw::report::{ComparisonPage, HeightSource, comparison_page, comparison_sheet, remarks};

/// Of fewer cells than this, a plane through their differences says nothing about height systems.
const FEWEST_CELLS: usize = 10;

/// Sentences about how the sides were brought onto one grid and what the figures mean.
pub fn sentences(pair: &Pair, found: &Comparison) -> Vec<String> {
    let trend = found.trend.as_ref().filter(|_| found.overall.cells >= FEWEST_CELLS);
    let trend = trend.map(|trend| about_trend(pair, found, trend));
    pair.notes.iter().cloned().chain(remarks(found, height_sources(pair))).chain(trend).collect()
}

/// That the differences look like those of two height systems, and which ones these may be.
fn about_trend(pair: &Pair, found: &Comparison, trend: &Trend) -> String {
    let named = |side: &Side| side.height_system.as_ref().map_or("not named", |system| system.name.as_str()).to_owned();
    let systems: Vec<&HeightSystem> = [&pair.a, &pair.b].into_iter().filter_map(|s| s.height_system.as_ref()).collect();
    let known = match systems[..] {
        [a, b] => a.difference(b).map(|usual| format!("; {} ({})", usual.text, usual.source)),
        _ => None,
    };
    // Usual differences are in metres.
    let known = Units::all(found.unit).message(&known.unwrap_or_default());
    let [low, high] = [trend.lowest, trend.highest].map(|height| format!("{:.2}", found.unit.about(height)));
    let plane = match low == high {
        true => format!("A difference of {low} {} everywhere", found.unit.symbol()),
        false => format!("A plane from {low} to {high} {}", found.unit.symbol()),
    };
    format!(
        "{plane} explains {:.0} % of the squared differences. The bias may come from different height \
         systems (A: {}, B: {}) and not from errors of the heights: look up the systems of both{known}.",
        100.0 * trend.explained,
        named(&pair.a),
        named(&pair.b)
    )
}

/// A page of HTML with maps, charts and tables.
///
/// # Errors
/// As [`comparison_page`].
pub fn page(pair: &Pair, found: &Comparison) -> Result<String> {
    shown(pair, found, comparison_page)
}

/// The map of the differences on paper, with the figures and the names of the files.
///
/// # Errors
/// As [`comparison_sheet`].
pub fn difference_map(pair: &Pair, found: &Comparison, page: &Page, fonts: &Fonts) -> Result<Sheet> {
    let [a_name, b_name] = [&pair.a, &pair.b].map(|side| {
        let file = &side.source.file;
        file.file_name().unwrap_or(file.as_os_str()).to_string_lossy()
    });
    shown(pair, found, |shown| {
        comparison_sheet(&ComparisonPage { a_name: &a_name, b_name: &b_name, ..*shown }, page, fonts)
    })
}

/// What a page or a sheet shows, in the unit of the figures.
fn shown<T>(pair: &Pair, found: &Comparison, draw: impl FnOnce(&ComparisonPage<'_>) -> Result<T>) -> Result<T> {
    let [a, b] = [&pair.a_heights, &pair.b_heights].map(|heights| InUnit::of(heights, found.unit));
    draw(&ComparisonPage {
        a_name: &pair.a.source.title(),
        b_name: &pair.b.source.title(),
        sources: height_sources(pair),
        notes: &pair.notes,
        a: &*a,
        b: &*b,
        found,
        metres_per_unit: pair.metres_per_unit() * found.unit.about(1.0),
    })
}

/// What each side's heights come from.
fn height_sources(pair: &Pair) -> [HeightSource; 2] {
    [&pair.a, &pair.b].map(|side| match side.kind {
        Kind::Dem(_) => HeightSource::HeightMap,
        Kind::Surface(_) => HeightSource::Surface,
    })
}
