//! The surface over a map: a triangulation with heights everywhere inside the frame.
//!
//! * [`SurfaceKind::Linear`] is the constrained Delaunay triangulation of the contours. It has flat triangles on
//!   ridges, in valleys and on tops.
//! * [`SurfaceKind::Skeleton`] is the surface of the paper: ridge and canyon lines go into the triangulation. A
//!   triangle with three corners on one level is left only where the ground is level.
//! * [`SurfaceKind::Spline`] is smooth: a minimum-curvature surface on a working grid ([`spline`](crate::spline)).

mod along_streams;
mod between_nodes;
mod build;
mod built;
mod coarse;
mod conditions;
mod drained;
mod errors;
mod given;
mod given_lines;
mod groups;
mod height_map;
mod known_lines;
mod lakeside;
mod nodes;
mod params;
mod parted;
mod places;
mod sample;
mod skeleton_lines;
mod smooth;
mod smooth_height;
mod trial_builder;
mod triangulated;
mod water_cells;
mod whole;
mod whole_map;

pub use along_streams::largest_stream_change;
pub use build::build;
pub use built::Surface;
#[doc(hidden)]
pub use drained::pits_of;
pub use drained::working_pits;
pub use errors::{standard_errors, standard_errors_on};
pub use given::Given;
#[doc(hidden)]
pub use given_lines::settle_lines;
#[doc(hidden)]
pub use height_map::height_map;
pub use params::{SurfaceKind, SurfaceParams, Triangles, Uncertainty};
#[doc(hidden)]
pub use places::InOther;
pub use sample::{heights, heights_on};
pub use water_cells::water_cells;
pub use whole::Whole;
pub use whole_map::whole_map;
