//! Streams on a grid: the cells along them get heights with which water stays in them. In this order:
//!
//! 1. Heights below a stream are raised to it (`raise`), and hollows beside it are filled (`hollows`).
//! 2. The cells of a stream get a shallow bed (`bed`), and heights fall along it (`fall`).
//! 3. The cells of river areas are level across (`area_levels`).
//! 4. Cells hold water that flows from one to the next (`hold`).
//!
//! Functions that change heights are told which ones are `allowed`: for a cell and a wanted height, the allowed height that
//! is nearest to it, or `None` if the cell stays.

mod area_levels;
mod bed;
mod fall;
mod hold;
mod hollows;
mod raise;
mod ways;

pub(crate) use area_levels::AreaLevels;
pub(crate) use bed::lower_beds;
pub(crate) use fall::fall_along;
pub(crate) use hold::hold_along;
pub(crate) use hollows::fill_hollows;
pub(crate) use raise::raise_to;
pub(crate) use ways::Ways;
