//! The figures of a comparison as a table in text.

use super::table::{Group, decimals_for, groups};
use tokosen_core::dem::compare::{Comparison, Statistics};

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
