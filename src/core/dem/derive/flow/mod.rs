//! Where water flows over a height map: the direction of each cell, how much ground drains through it, catchments, streams as
//! lines, and floods.

mod accumulation;
mod catchments;
mod directions;
mod edge;
mod flood;
mod outlets;
mod stream_lines;
#[cfg(test)]
mod tests;

pub use accumulation::{Accumulated, flow_accumulation};
pub use catchments::{CatchmentPart, Catchments, catchment_parts, catchments};
pub use directions::{FlowDirections, flow_directions};
pub use flood::{Flood, FloodFrom, FloodPart, StreamFlood, check_depths, flood_along_streams, flood_to_level};
pub use outlets::{Outlet, catchments_above, cells_at_edge, snapped_outlet};
pub use stream_lines::{FlowLine, flow_lines};
