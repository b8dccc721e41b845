//! Contours for a map of some scale: supplementary contours where the ground is flat.
//!
//! 1. [`Kinds::mark`]: each line gets its kind by its level.
//! 2. [`keep_supplementary`]: supplementary contours stay where the ground between the others needs them. `nearest` measures how
//!    far apart these are, `tops` finds rings that show a top or a hollow, `pieces` chooses the pieces of a line.

mod for_map;
mod ground;
mod kinds;
mod nearest;
mod pieces;
mod supplementary;
mod tops;

pub use for_map::{MapCount, MapParams, for_map};
pub use ground::Ground;
pub use kinds::Kinds;
pub use supplementary::{OfInput, SupplementaryCount, keep_supplementary};
