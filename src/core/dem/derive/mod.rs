//! Products of a height map: slope, aspect, hillshade, places that are steep and high enough to slide, the flow of water, and
//! floods.

mod check;
mod flow;
mod note;
mod outline;
mod rows;
mod slope;
mod steep;

pub use check::check;
pub use flow::{
    Accumulated, CatchmentPart, Catchments, Flood, FloodFrom, FloodPart, FlowDirections, FlowLine, Outlet, StreamFlood,
    catchment_parts, catchments, catchments_above, cells_at_edge, check_depths, flood_along_streams, flood_to_level,
    flow_accumulation, flow_directions, flow_lines, snapped_outlet,
};
pub use note::{HeightsFrom, steep_note};
pub use outline::square_outlines;
pub use rows::{Derivative, Derived};
pub use slope::{aspect, shade, slope};
pub use steep::{SteepArea, SteepParams, Steeps, steep};
