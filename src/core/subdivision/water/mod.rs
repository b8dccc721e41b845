//! Lakes and the sea: level ground that the contours do not show.
//!
//! The contours have priority. They stay as they are, and a lake never changes the bands of the ground around it. The
//! height of a lake has to lie between the contours around it. A lake is cut back from contours that cross it. Where
//! its shore is a contour, it shares every vertex with that contour.

mod bodies;
mod cut;
mod dry;
mod gathered;
mod height;
mod net;
mod nodes;
mod settle;

pub(crate) use bodies::{WaterBodies, crossing_finding, lake_finding};
pub(crate) use dry::DrySubdivision;
pub(crate) use settle::{leave_out_vanished, settle};

use crate::base::error::{Error, Finding, FindingKind, Result};
use crate::contour::{ContourMap, Lake, distinct_levels};

/// Level ground of a map.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Water {
    /// Lakes; where they overlap, the first one counts.
    pub lakes: Vec<Lake>,
    /// The level of the coast, metres. Ground whose only contours are of this level, with the ground below them, is the
    /// sea.
    pub sea: Option<f64>,
    /// Levels of coasts, metres: exactly those of their contours. The sea beside them is level, wherever the contours show
    /// that the other side is land.
    pub coast: Vec<f64>,
}

/// The sea level and a contour that differ by no more are the same, metres.
pub const SAME_LEVEL: f64 = 1e-6;
/// How many levels a message lists.
const LISTED: usize = 5;

/// The sea level, exactly as the contours have it.
///
/// # Errors
/// When there is no contour of that level.
pub(crate) fn sea_level(water: &Water, map: &ContourMap, findings: &mut Vec<Finding>) -> Result<Option<f64>> {
    let Some(sea) = water.sea else { return Ok(None) };
    let mut levels = distinct_levels(&map.contours);
    levels.sort_by(|a, b| (a - sea).abs().total_cmp(&(b - sea).abs()));
    let Some(level) = levels.first().copied().filter(|l| (l - sea).abs() <= SAME_LEVEL) else {
        let near: Vec<String> = levels.iter().take(LISTED).map(|level| format!("{level} m")).collect();
        return Err(Error::Parameter(format!(
            "no contour has the level of the sea, {sea} m, and only contours of that level show the coast; the nearest \
             levels are {}",
            near.join(", ")
        )));
    };
    if let Some(below) = map.contours.iter().find(|c| c.elevation < level) {
        let message = format!(
            "contour {} m lies below the sea ({level} m): the ground between the coast and such contours does not \
             become sea",
            below.elevation
        );
        let finding = Finding::new(FindingKind::BelowSea, below.points.first().copied(), message);
        findings.push(finding.about(below.feature, below.elevation));
    }
    Ok(Some(level))
}
