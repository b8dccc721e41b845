//! Streams on a grid: the cells that they run through come near to their heights (`ways`). The cells of river areas are level
//! across (`area_levels`).

mod area_levels;
mod ways;

pub(crate) use area_levels::AreaLevels;
pub(crate) use ways::Ways;
