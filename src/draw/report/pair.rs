//! The report of a comparison of two sides: a table in text, sentences, a page.

use super::page::{ComparisonPage, comparison_page};
use super::table::{Group, decimals_for, groups};
use super::words::{HeightSource, remarks};
use crate::base::error::Result;
use crate::dem::compare::{Comparison, Statistics};
use crate::terrain::{Kind, Pair};

const COLUMNS: [&str; 11] =
    ["cells", "bias", "RMSE", "RMSE-b", "MAE", "median", "NMAD", "LE90", "LE95", "lowest", "highest"];

/// The figures as the lines of a table.
pub fn table(found: &Comparison) -> Vec<String> {
    let decimals = decimals_for(found.overall.rmse);
    let groups = groups(found);
    let label_width = groups.iter().flat_map(|g| &g.rows).map(|r| r.label.chars().count()).max().unwrap_or(0) + 1;
    let rows = groups.iter().flat_map(|g| &g.rows).filter_map(|r| r.statistics);
    let cells: Vec<[String; 11]> = rows.map(|s| row(&s, decimals)).collect();
    let widths: [usize; 11] =
        std::array::from_fn(|i| cells.iter().map(|row| row[i].len()).chain([COLUMNS[i].len()]).max().unwrap_or(0) + 2);
    let padded =
        |row: &[String; 11]| -> String { row.iter().zip(widths).map(|(cell, w)| format!("{cell:>w$}")).collect() };
    let mut out = vec![format!("{:label_width$}{}", "", padded(&COLUMNS.map(String::from)))];
    for (k, Group { title, rows }) in groups.iter().enumerate() {
        // The row of all cells, which comes first, needs no heading.
        if k > 0 {
            out.push((*title).to_string());
        }
        for r in rows {
            let figures =
                r.statistics.map_or_else(|| format!("{:>w$}", "-", w = widths[0]), |s| padded(&row(&s, decimals)));
            let indented = if k > 0 { format!(" {}", r.label) } else { r.label.clone() };
            out.push(format!("{indented:label_width$}{figures}"));
        }
    }
    out
}

fn row(s: &Statistics, decimals: usize) -> [String; 11] {
    let figures =
        [s.bias, s.rmse, s.rmse_debiased, s.mae, s.median, s.nmad, s.le90, s.le95, s.lowest.value, s.highest.value];
    let mut figures = figures.into_iter().map(|v| format!("{:.decimals$}", v + 0.0));
    std::array::from_fn(|i| if i == 0 { s.cells.to_string() } else { figures.next().unwrap_or_default() })
}

/// Sentences about how the sides were brought onto one grid and what the figures mean.
pub fn sentences(pair: &Pair, found: &Comparison) -> Vec<String> {
    pair.notes.iter().cloned().chain(remarks(found, height_sources(pair))).collect()
}

/// A page of HTML with maps, charts and tables.
///
/// # Errors
/// As [`comparison_page`].
pub fn page(pair: &Pair, found: &Comparison) -> Result<String> {
    comparison_page(&ComparisonPage {
        a_name: &pair.a.source.title(),
        b_name: &pair.b.source.title(),
        sources: height_sources(pair),
        notes: &pair.notes,
        a: &*pair.a_heights,
        b: &*pair.b_heights,
        found,
        metres_per_unit: pair.metres_per_unit(),
    })
}

/// What each side's heights come from.
fn height_sources(pair: &Pair) -> [HeightSource; 2] {
    [&pair.a, &pair.b].map(|side| match side.kind {
        Kind::Dem(_) => HeightSource::HeightMap,
        Kind::Surface(_) => HeightSource::Surface,
    })
}
