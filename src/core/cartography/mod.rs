//! Contours for a map of some scale: fewer where they would run together, more where the ground is flat.
//!
//! [`for_map()`] does all of it; it has the steps. `rules` has the table of rules by scale, `kinds` the kinds of contours by
//! their levels. `generalise` and `steep` leave out. `tint` has the colours of heights. [`keep_supplementary`] chooses
//! supplementary contours: `nearest` measures how far apart the contours beside them are, `tops` finds rings that show a top or a
//! hollow, `pieces` chooses the pieces of a line.

mod for_map;
mod generalise;
mod ground;
mod kinds;
mod nearest;
mod pieces;
mod request;
mod rules;
mod steep;
mod supplementary;
mod tint;
mod tops;

#[cfg(test)]
mod tests;

pub use for_map::{MapCount, MapParams, Steep, for_map};
pub use ground::{Ground, mean_slope, slope_between};
pub use kinds::Kinds;
pub use request::{MapPlan, MapRequest};
pub use rules::{APART, CLOSEST, INTERVALS, LABEL, MapScale, SIMPLIFIED, SMALLEST_RING};
pub use supplementary::{OfInput, SupplementaryCount, keep_supplementary};
pub use tint::TINT;
