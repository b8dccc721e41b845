//! The rows of the tables: all cells, classes, check points.

use tokosen_core::dem::compare::{Class, Comparison, Statistics};

/// Rows under one heading.
#[derive(Debug, Clone, PartialEq)]
pub struct Group {
    /// The heading.
    pub title: &'static str,
    /// The rows.
    pub rows: Vec<Row>,
}

/// Figures of a group of cells.
#[derive(Debug, Clone, PartialEq)]
pub struct Row {
    /// The name of the group.
    pub label: String,
    /// The figures; none if there were no such cells.
    pub statistics: Option<Statistics>,
}

/// All figures of a comparison, by group; groups without rows are left out.
pub fn groups(found: &Comparison) -> Vec<Group> {
    let all = vec![Row { label: "all cells".into(), statistics: Some(found.overall) }];
    let points = [("A at check points", &found.a), ("B at check points", &found.b)]
        .into_iter()
        .filter_map(|(label, side)| Some(Row { label: label.into(), statistics: Some(side.points?) }))
        .collect();
    let unit = format!(" {}", found.unit.symbol());
    let groups = [
        Group { title: "A − B", rows: all },
        Group { title: "by slope of B", rows: classes(&found.by_slope, "°") },
        Group { title: "by elevation of B", rows: classes(&found.by_elevation, &unit) },
        Group { title: "by distance to the nearest contour", rows: classes(&found.by_distance, &unit) },
        Group { title: "against check points", rows: points },
    ];
    groups.into_iter().filter(|group| !group.rows.is_empty()).collect()
}

fn classes(classes: &[Class], unit: &str) -> Vec<Row> {
    let row = |class: &Class| {
        let from = plain(class.from);
        let label = match class.to {
            Some(to) => format!("{from} to {}{unit}", plain(to)),
            None => format!("{from}{unit} and more"),
        };
        Row { label, statistics: class.statistics }
    };
    classes.iter().map(row).collect()
}

/// A bound without the rounding errors of a multiplication.
fn plain(bound: f64) -> String {
    let rounded = (bound * 1e6).round() / 1e6;
    format!("{}", if rounded == 0.0 { 0.0 } else { rounded })
}

/// Decimals that show three digits of a figure of this size, at most four.
pub fn decimals_for(figure: f64) -> usize {
    if figure > 0.0 && figure.is_finite() { (2.0 - figure.log10().floor()).clamp(0.0, 4.0) as usize } else { 2 }
}

/// A whole number with a space between thousands.
pub(super) fn thousands(count: usize) -> String {
    let digits = count.to_string();
    let mut out = String::new();
    for (i, digit) in digits.chars().enumerate() {
        if i > 0 && (digits.len() - i).is_multiple_of(3) {
            out.push('\u{202f}');
        }
        out.push(digit);
    }
    out
}

/// A number with a true minus sign.
pub(super) fn number(value: f64, decimals: usize) -> String {
    let text = format!("{value:.decimals$}");
    let is_zero = text.chars().all(|c| matches!(c, '-' | '0' | '.'));
    match text.strip_prefix('-') {
        Some(size) if is_zero => size.to_owned(),
        Some(size) => format!("−{size}"),
        None => text,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_set_for_reading() {
        assert_eq!((thousands(7), thousands(1234567)), ("7".into(), "1\u{202f}234\u{202f}567".into()));
        assert_eq!((number(-0.0004, 2), number(-1.5, 1), number(2.0, 0)), ("0.00".into(), "−1.5".into(), "2".into()));
        assert_eq!([123.0, 12.0, 1.2, 0.03, 0.0, f64::NAN].map(decimals_for), [0, 1, 2, 4, 2, 2]);
        assert_eq!((plain(0.30000000000000004), plain(-0.0), plain(250.0)), ("0.3".into(), "0".into(), "250".into()));
    }
}
