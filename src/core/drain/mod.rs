//! Pits: which get a way out, how height maps are drained, and which pits are left.
//!
//! Water stays in pits that the ground does not have: between contours every gully is dammed. [`Drain`] says what happens
//! to them; a [`Sink`] is a place where water may stay.

mod drained;
mod flood;
mod ground;
mod left;
mod levels;
mod params;
mod sink_cells;
#[cfg(test)]
mod tests;

pub(crate) use drained::{Bands, drain};
pub(crate) use flood::{Flood, STEPS, neighbours, sortable, unsorted, ways_end};
pub(crate) use ground::{Ground, ponds};
pub(crate) use left::{CellPit, Kinds, cell_pits};
pub use left::{Pit, Reason};
pub(crate) use levels::drainable;
pub use params::{Drain, Sink, SinkShape};
pub(crate) use sink_cells::{Found, Placed, cells_in, mark_sinks};
