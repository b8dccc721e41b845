//! Products of a height map: slope, aspect, hillshade, places that are steep and high enough to slide, and the flow of water.

mod check;
mod flow;
mod note;
mod outline;
mod rows;
mod slope;
mod steep;

pub use check::check;
pub use flow::{
    CatchmentPart, Catchments, FlowDirections, catchment_parts, catchments, flow_accumulation, flow_directions,
};
pub use note::{HeightsFrom, steep_note};
pub use rows::{Derivative, Derived};
pub use slope::{aspect, shade, slope};
pub use steep::{SteepArea, SteepParams, Steeps, steep};
