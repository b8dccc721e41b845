//! Products of a height map: slope, aspect, hillshade, and places that are steep and high enough to slide.

mod check;
mod note;
mod outline;
mod slope;
mod steep;

pub use check::check;
pub use note::{HeightsFrom, steep_note};
pub use slope::{aspect, shade, slope};
pub use steep::{SteepArea, SteepParams, Steeps, steep};
