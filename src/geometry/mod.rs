//! Plane geometry that several steps need: segments and how they meet, trees of boxes, the border of an area.

mod border;
mod common_area;
mod inside;
mod meet;
mod order;
mod oriented;
mod segment;
mod thin;

pub(crate) use border::{Border, OnEdge, rings, tolerance, tolerance_of_box, with_corners_at, with_vertices};
pub(crate) use common_area::common_area;
pub(crate) use meet::{Meeting, distance, meeting, place, point_distance};
pub(crate) use order::compare_points;
pub(crate) use oriented::{BoxTree, OrientedBox};
pub(crate) use segment::{Bounds, Segment};
pub(crate) use thin::thinned;
