//! Where water flows over a height map: the direction of each cell, how many cells drain through it, and catchments.

mod accumulation;
mod catchments;
mod directions;
#[cfg(test)]
mod tests;

pub use accumulation::flow_accumulation;
pub use catchments::{CatchmentPart, Catchments, catchment_parts, catchments};
pub use directions::{FlowDirections, flow_directions};
