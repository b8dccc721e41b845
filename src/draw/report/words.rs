//! What the figures of a comparison mean, in sentences.

use super::table::{decimals_for, number};
use tokosen_core::base::{ElevationUnit, Units};
use tokosen_core::dem::compare::{Comparison, HeightFigures, Precision};

/// What heights come from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum HeightSource {
    /// A height map of unknown origin.
    HeightMap,
    /// The surface of contours.
    Surface,
}

/// Sentences about a comparison in addition to its tables, in a fixed order. `sources` are those of A and of B.
pub fn remarks(found: &Comparison, sources: [HeightSource; 2]) -> Vec<String> {
    let mut out = Vec::new();
    let overall = &found.overall;
    let decimals = decimals_for(overall.rmse);
    let unit = found.unit.symbol();
    let height = |value: f64| format!("{} {unit}", number(value, decimals));
    out.push(format!(
        "Lowest difference {} at {}, highest {} at {}.",
        height(overall.lowest.value),
        place(overall.lowest.place),
        height(overall.highest.value),
        place(overall.highest.place)
    ));
    if let Some(slope) = &found.slope {
        out.push(format!(
            "Slopes differ by {}° (RMSE); on average A is {}° {} than B.",
            number(slope.rmse, 2),
            number(slope.bias.abs(), 2),
            if slope.bias < 0.0 { "gentler" } else { "steeper" }
        ));
    }
    if let Some(s) = &found.significance {
        let left = if s.rmse_beyond > 0.0 {
            format!("an RMSE of {} is left beyond that accuracy", height(s.rmse_beyond))
        } else {
            "the RMSE is no more than that accuracy accounts for".into()
        };
        out.push(format!(
            "{} % of the cells differ by more than {} {unit}, 1.96 times the stated accuracy of {} {unit} (5 % would by chance \
             alone); {left}.",
            number(100.0 * s.share, 1),
            number(s.limit, 2),
            number(s.sigma, 2)
        ));
    }
    if let Some(bands) = &found.bands {
        let furthest = bands.furthest.map_or(String::new(), |f| {
            format!(
                ", on average by {}, at most by {} at {}",
                height(bands.mean_excess),
                height(f.value),
                place(f.place)
            )
        });
        out.push(format!(
            "{} % of the cells of the height map are not between the contours that lie around them{furthest}.",
            number(100.0 * bands.share, 2)
        ));
    }
    for (name, side, source) in [("A", &found.a, sources[0]), ("B", &found.b, sources[1])] {
        out.extend(terraces(name, side, source, found.unit));
        // The heights of a surface are computed, so their rounding means nothing.
        if source == HeightSource::HeightMap {
            out.extend(precision(name, side));
        }
    }
    out
}

fn precision(name: &str, side: &HeightFigures) -> Option<String> {
    let unit = match side.precision? {
        Precision::WholeMetres => "whole metres",
        Precision::Tenths => "tenths of a metre",
    };
    Some(format!("All heights of {name} are {unit}: no difference below that means anything."))
}

fn terraces(name: &str, side: &HeightFigures, source: HeightSource, unit: ElevationUnit) -> Option<String> {
    let levels = side.levels.as_ref().filter(|levels| levels.terraced == Some(true))?;
    let interval = Units::all(unit).height(levels.interval);
    let meaning = match source {
        HeightSource::HeightMap => {
            format!("It looks like a height map that was made from contours {interval} apart")
        }
        HeightSource::Surface => "They come from flat triangles between vertices of one contour".into(),
    };
    Some(format!(
        "{name} has terraces: {} % of its heights are within 5 % of the interval of {interval} from one of its levels, where {} % \
         would be expected, most clearly at {} of {} levels. {meaning}.",
        number(100.0 * levels.near, 1),
        number(100.0 * levels.expected, 1),
        levels.terraced_levels,
        levels.levels
    ))
}

/// A place in map units; degrees need more decimals than metres.
pub(super) fn place(p: glam::DVec2) -> String {
    let decimals = if p.x.abs() <= 180.0 && p.y.abs() <= 90.0 { 6 } else { 1 };
    format!("{} {}", number(p.x, decimals), number(p.y, decimals))
}
