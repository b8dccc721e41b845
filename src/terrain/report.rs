//! The report of a comparison of two sides: sentences and a page.

use super::compare::{Kind, Pair};
use tokosen_core::base::error::Result;
use tokosen_core::dem::compare::Comparison;
use tokosen_core::raster::InUnit;
use tokosen_draw::report::{ComparisonPage, HeightSource, comparison_page, remarks};

/// Sentences about how the sides were brought onto one grid and what the figures mean.
pub fn sentences(pair: &Pair, found: &Comparison) -> Vec<String> {
    pair.notes.iter().cloned().chain(remarks(found, height_sources(pair))).collect()
}

/// A page of HTML with maps, charts and tables.
///
/// # Errors
/// As [`comparison_page`].
pub fn page(pair: &Pair, found: &Comparison) -> Result<String> {
    let [a, b] = [&pair.a_heights, &pair.b_heights].map(|heights| InUnit::of(heights, found.unit));
    comparison_page(&ComparisonPage {
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
