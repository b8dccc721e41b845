//! The pits that a height map has, and why they stay.

use glam::DVec2;

use super::ground::{Ground, Pond, ponds};
use super::levels::{drainable, flooded};

/// Why a pit stays.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Reason {
    /// A given sink lies in it.
    Given,
    /// Its deepest place is a lake or the sea.
    Water,
    /// It lies inside depression contours: all contours around it are higher.
    Depression,
    /// The contours leave no way out: each way is higher than the bottom of the pit.
    Band,
    /// A way out would need a cut deeper than the contour interval, or none was looked for.
    Uncut,
}

impl Reason {
    /// The reason in words, for files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Given => "given",
            Self::Water => "water",
            Self::Depression => "depression contour",
            Self::Band => "band",
            Self::Uncut => "uncut",
        }
    }
}

/// A pit that a height map has.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pit {
    /// The deepest place, map units.
    pub place: DVec2,
    /// Its height, metres.
    pub bottom: f64,
    /// The height of the rim, above which water runs off, metres.
    pub spill: f64,
    /// Area under water that reaches the rim, square metres.
    pub area: f64,
    /// Why it stays.
    pub reason: Reason,
}

/// A part of a height map where water stays until it reaches the level of the rim.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct CellPit {
    /// The deepest cell.
    pub cell: usize,
    /// Its height, metres.
    pub bottom: f32,
    /// The height of the rim, metres.
    pub spill: f32,
    /// Number of cells below the rim.
    pub cells: usize,
    pub reason: Reason,
}

/// What the cells are, besides the limits of their heights.
pub(crate) struct Kinds<'a> {
    /// Whether a cell lies in a given sink.
    pub given: &'a [bool],
    /// Whether a cell lies inside depression contours.
    pub hollow: &'a dyn Fn(usize) -> bool,
}

/// The pits of a height map, in the order of their first cells: first those that hold sinks and water, then the others. A
/// pit beside a given sink counts for itself if water stays there before it reaches the sink.
pub(crate) fn cell_pits(heights: &[f32], ground: &Ground<'_>, kinds: &Kinds<'_>) -> Vec<CellPit> {
    let runs_off = |cell: usize| ground.is_outlet(heights, cell);
    let holds = |pond: &Pond| pond.cells.iter().any(|&cell| ground.stays[cell as usize]);
    let mut found = Vec::new();
    let with_sinks = ponds(heights, &flooded(heights, ground, runs_off), ground);
    for pond in with_sinks.iter().filter(|pond| holds(pond)) {
        let is_given = pond.cells.iter().any(|&cell| kinds.given[cell as usize]);
        found.push(pit(heights, pond, if is_given { Reason::Given } else { Reason::Water }));
    }
    let others = ponds(heights, &flooded(heights, ground, |cell| ground.stays[cell] || runs_off(cell)), ground);
    if others.is_empty() {
        return found;
    }
    let drainable = drainable(heights, ground);
    for pond in &others {
        let bottom = pond.bottom(heights);
        let reason = if (kinds.hollow)(bottom) {
            Reason::Depression
        } else if drainable[bottom] > heights[bottom] {
            Reason::Band
        } else {
            Reason::Uncut
        };
        found.push(pit(heights, pond, reason));
    }
    found
}

fn pit(heights: &[f32], pond: &Pond, reason: Reason) -> CellPit {
    let cell = pond.bottom(heights);
    CellPit { cell, bottom: heights[cell], spill: pond.level, cells: pond.cells.len(), reason }
}
