//! Lakes and the sea: ground that is level, whatever the contours around it say.
//!
//! The contours come first. They stay as they are, and a lake never changes what they tell of the ground around it: its
//! height has to lie between theirs, it is cut back from those that cross it, and where its shore is one of them it
//! shares every vertex with that contour.

mod bodies;
mod cut;
mod height;
mod net;
mod nodes;
mod settle;
mod shores;

pub(crate) use bodies::{WaterBodies, lake_finding};
pub(crate) use settle::{leave_out_vanished, settle};
pub(crate) use shores::Shores;

use crate::base::error::{Error, Finding, FindingKind, Result};
use crate::contour::{ContourMap, Lake, distinct_levels};

/// Ground that is level.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Water {
    /// Lakes; where they overlap, the first one counts.
    pub lakes: Vec<Lake>,
    /// The level of the coast, metres: ground that reaches only down to contours of this level is the sea.
    pub sea: Option<f64>,
}

/// A level of the sea and a contour that differ by no more are the same, metres.
const SAME_LEVEL: f64 = 1e-6;
/// How many levels a message lists.
const LISTED: usize = 5;

/// The level of the sea as the contours have it.
///
/// # Errors
/// When there is no contour of that level.
pub(crate) fn sea_level(water: &Water, map: &ContourMap, findings: &mut Vec<Finding>) -> Result<Option<f64>> {
    let Some(sea) = water.sea else { return Ok(None) };
    let mut levels = distinct_levels(&map.contours);
    levels.sort_by(|a, b| (a - sea).abs().total_cmp(&(b - sea).abs()));
    let Some(level) = levels.first().copied().filter(|l| (l - sea).abs() <= SAME_LEVEL) else {
        let near: Vec<String> = levels.iter().take(LISTED).map(f64::to_string).collect();
        return Err(Error::Parameter(format!(
            "there is no contour at the level of the sea, {sea}: the coast is known from contours of that level; the \
             levels nearest to it are {}",
            near.join(", ")
        )));
    };
    if let Some(below) = map.contours.iter().find(|c| c.elevation < level) {
        let message = format!(
            "contour {} lies below the sea ({level}): ground between the coast and such contours is left as they say",
            below.elevation
        );
        let finding = Finding::new(FindingKind::BelowSea, below.points.first().copied(), message);
        findings.push(finding.about(below.feature, below.elevation));
    }
    Ok(Some(level))
}
