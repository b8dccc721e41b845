//! The page of a comparison.

use glam::DVec2;
use maud::{DOCTYPE, Markup, PreEscaped, html};

use super::charts;
use super::maps;
use super::profile::{self, Profile};
use super::survey::{Survey, survey};
use super::table::{Row, decimals_for, groups, number, thousands};
use super::view::{View, Width};
use super::words::{HeightSource, remarks};
use tokosen_core::base::error::Result;
use tokosen_core::dem::compare::{Comparison, round_limit};
use tokosen_core::raster::RasterRows;

const STYLE: &str = include_str!("style.css");

/// What the page shows.
#[derive(Debug, Clone, Copy)]
pub struct ComparisonPage<'a> {
    /// What A is, such as a file's name.
    pub a_name: &'a str,
    /// What B is.
    pub b_name: &'a str,
    /// What the heights of A and of B come from.
    pub sources: [HeightSource; 2],
    /// Notes in sentences, such as how both were brought onto one grid.
    pub notes: &'a [String],
    /// Heights of A.
    pub a: &'a dyn RasterRows,
    /// Heights of B at the same cells.
    pub b: &'a dyn RasterRows,
    /// The figures. The heights are in their unit.
    pub found: &'a Comparison,
    /// Metres per map unit in x and y, or other units of the figures, as for these.
    pub metres_per_unit: DVec2,
}

/// The map of the differences A − B over the relief of B, as PNG in a data URI.
///
/// # Errors
/// If the picture cannot be made. As [`RasterRows::read`].
pub fn difference_map(
    a: &dyn RasterRows,
    b: &dyn RasterRows,
    found: &Comparison,
    metres_per_unit: DVec2,
) -> Result<String> {
    picture(&survey(a, b, found)?, found, metres_per_unit)
}

fn picture(survey: &Survey, found: &Comparison, metres_per_unit: DVec2) -> Result<String> {
    maps::differences(&survey.difference, &survey.b, round_limit(&found.overall), metres_per_unit)
}

/// The page as HTML: one file that needs no other file.
///
/// Long because the template of the page is one piece.
///
/// # Errors
/// If a chart or a picture cannot be made. As [`RasterRows::read`].
pub fn comparison_page(page: &ComparisonPage<'_>) -> Result<String> {
    let &ComparisonPage { a_name, b_name, sources, notes, a, b, found, metres_per_unit } = page;
    let profile = profile::profile(found, a, b, metres_per_unit)?;
    let survey = survey(a, b, found)?;
    let limit = round_limit(&found.overall);
    let map = picture(&survey, found, metres_per_unit)?;
    let shown = survey.window.of(&b.grid());
    let [view, half] = [Width::Page, Width::Half].map(|width| View::new(&shown, b, metres_per_unit, width));
    let levels = match (&found.a.levels, &found.b.levels) {
        (None, None) => None,
        (a, b) => Some(charts::levels(a.as_ref(), b.as_ref(), found.unit)?),
    };
    let chart = |svg: String, caption: Markup| {
        html! { figure { (PreEscaped(svg)) figcaption { (caption) } } }
    };
    let letters = html! { span.a { "A" } " and " span.b { "B" } };
    let markup = html! {
        (DOCTYPE)
        html lang="en" {
            head {
                meta charset="utf-8";
                meta name="generator" content="tokosen";
                meta name="viewport" content="width=device-width, initial-scale=1";
                title { (a_name) " against " (b_name) }
                style { (PreEscaped(STYLE)) }
            }
            body {
                h1 { "Heights compared: " span.a { "A" } " − " span.b { "B" } }
                dl.sides {
                    dt.a { "A" } dd { (a_name) }
                    dt.b { "B" } dd { (b_name) }
                }
                (key_figures(found))
                ul {
                    @for note in notes.iter().cloned().chain(remarks(found, sources)) { li { (note) } }
                }
                h2 { "Where they differ" }
                figure {
                    (view.picture(&map, difference_marks(&view, found, &profile)))
                    div.bar style=(format!("background: linear-gradient(to right, {})", gradient())) {}
                    div.bar-labels {
                        @for share in [-1.0, -0.5, 0.0, 0.5, 1.0] {
                            span { (number(share * limit, decimals_for(limit))) @if share == 1.0 { " " (found.unit.symbol()) } }
                        }
                    }
                    figcaption {
                        "A − B over the relief of B: blue where A is lower, red where it is higher; grey: no data. "
                        "Circles: the extreme differences. Line: the profile below."
                        @if shown.len() < b.grid().len() { " The pictures end where there is nothing to compare." }
                    }
                }
                h2 { "Both side by side" }
                div.pair {
                    figure { (half.picture(&maps::shaded(&survey.a, metres_per_unit)?, html! {})) figcaption { "Hillshade of " span.a { "A" } } }
                    figure { (half.picture(&maps::shaded(&survey.b, metres_per_unit)?, html! {})) figcaption { "Hillshade of " span.b { "B" } } }
                }
                h2 { "Charts" }
                div.pair {
                    (chart(charts::difference_histogram(&survey.bars, found)?, html! { "How often which difference occurs; red line: the bias." }))
                    (chart(charts::scatter(&survey.pairs, found.unit)?, html! { "A against B, cell by cell; red line: equal heights." }))
                    (chart(charts::profile(&profile, found.unit)?, html! { "Heights of " (letters) " along the line in the map, through the largest difference." }))
                    @if let Some(svg) = levels {
                        (chart(svg, html! { "Heights of " (letters) " above the contour level below; grey line: ground without terraces." }))
                    }
                }
                h2 { "Figures" }
                (tables(found))
                h2 { "What they mean" }
                (meanings())
            }
        }
    };
    Ok(markup.into_string())
}

fn key_figures(found: &Comparison) -> Markup {
    let s = &found.overall;
    let unit = found.unit.symbol();
    let height = |v: f64| format!("{} {unit}", number(v, decimals_for(s.rmse)));
    let mut figures =
        vec![(height(s.rmse), "RMSE"), (height(s.bias), "bias"), (height(s.mae), "MAE"), (height(s.le90), "LE90")];
    figures.extend(found.slope.map(|slope| (format!("{}°", number(slope.rmse, 2)), "slope RMSE")));
    figures.push((thousands(s.cells), "cells compared"));
    html! {
        div.figures {
            @for (value, name) in figures { div { b { (value) } span { (name) } } }
        }
    }
}

const COLUMNS: [&str; 11] =
    ["cells", "bias", "RMSE", "de-biased", "MAE", "median", "NMAD", "LE90", "LE95", "lowest", "highest"];

fn tables(found: &Comparison) -> Markup {
    let decimals = decimals_for(found.overall.rmse);
    let row = |row: &Row| {
        html! {
            tr {
                th scope="row" { (row.label) }
                @if let Some(s) = &row.statistics {
                    td { (thousands(s.cells)) }
                    @for v in [s.bias, s.rmse, s.rmse_debiased, s.mae, s.median, s.nmad, s.le90, s.le95, s.lowest.value, s.highest.value] {
                        td { (number(v, decimals)) }
                    }
                } @else {
                    td.none colspan=(COLUMNS.len()) { "no cells" }
                }
            }
        }
    };
    html! {
        div.scroll {
            table {
                thead { tr { th { (found.unit.name()) } @for column in COLUMNS { th scope="col" { (column) } } } }
                tbody {
                    @for (k, group) in groups(found).into_iter().enumerate() {
                        @if k > 0 { tr.group { th colspan=(COLUMNS.len() + 1) { (group.title) } } }
                        @for r in &group.rows { (row(r)) }
                    }
                }
            }
        }
    }
}

fn meanings() -> Markup {
    html! {
        p.note {
            "Differences d are A − B, so that they are above 0 where A is higher. Bias: mean of d. RMSE: root of the mean of d²; "
            "de-biased: the same about the bias. MAE: mean of |d|. NMAD: 1.4826 times the median of |d − median|, which "
            "a few gross errors do not change. LE90, LE95: 90 % and 95 % of the cells have a smaller |d|. Slopes are Horn's, "
            "from eight neighbours; the slope RMSE counts cells that have all of them in both. Classes include their lower "
            "bound."
        }
    }
}

fn difference_marks(view: &View, found: &Comparison, profile: &Profile) -> Markup {
    let [from, to] = profile.ends.map(|p| view.at(p));
    let spots = [found.overall.lowest.place, found.overall.highest.place].map(|p| view.at(p));
    html! {
        line x1=(from.x) y1=(from.y) x2=(to.x) y2=(to.y) stroke="#111" stroke-width="2.5" {}
        @for p in spots {
            circle cx=(p.x) cy=(p.y) r="11" fill="none" stroke="#111" stroke-width="2.5" {}
        }
    }
}

/// The colours of the scale for a style sheet.
fn gradient() -> String {
    let colors = (-6..=6).map(|k| {
        let [r, g, b] = maps::color(f64::from(k) / 6.0);
        format!("rgb({r},{g},{b})")
    });
    colors.collect::<Vec<_>>().join(", ")
}
