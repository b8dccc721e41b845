//! Plane geometry that several steps need: segments and how they meet, trees of boxes, the border of an area.

mod border;
mod common_area;
mod contains_area;
mod east;
mod inside;
mod lines;
mod meet;
mod order;
mod oriented;
mod segment;
mod thin;

#[doc(hidden)]
pub use border::Border;
pub use border::{OnEdge, rings, tolerance, tolerance_of_box, with_corners_at, with_vertices};
pub use common_area::common_area;
pub use contains_area::contains_area;
pub use east::nearest_east;
pub use lines::LineTree;
#[doc(hidden)]
pub use meet::Meeting;
#[doc(hidden)]
pub use meet::meeting;
#[doc(hidden)]
pub use meet::place;
pub use meet::{distance, point_distance};
pub use order::compare_points;
#[doc(hidden)]
pub use oriented::BoxTree;
#[doc(hidden)]
pub use oriented::OrientedBox;
pub use oriented::along_curve;
pub use segment::Bounds;
#[doc(hidden)]
pub use segment::Segment;
pub use thin::thinned;
