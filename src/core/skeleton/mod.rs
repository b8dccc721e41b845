//! Ridge and canyon lines from the triangulation (paper, section 4).
//!
//! [`skeleton`] drops the small branches ([`eliminate`]), places points on the axis of the rest and joins them from
//! contour to contour ([`axis`]). Then it gives them heights ([`axis_heights`]), makes the heights fall along the lines
//! ([`flow`](fn@flow)), and traces the lines ([`skeleton_lines`]).

mod attach;
mod axis;
mod axis_builder;
mod border_levels;
mod branches;
mod build;
mod caps;
mod cone;
mod edges;
mod eliminate;
mod flow;
mod glimpse;
mod heights;
mod joins;
mod line;
mod lines;
mod pieces;
mod sight;

pub use axis::axis;
pub(crate) use axis::narrow;
pub(crate) use build::skeleton_with;
pub use build::{Skeleton, skeleton};
pub use caps::Cap;
pub use edges::{JunctionEdge, junction_edges};
pub use eliminate::{Elimination, eliminate, is_chord};
pub use flow::{Flow, flow};
pub(crate) use heights::Heights;
pub use heights::axis_heights;
pub use line::{LineEnd, SkeletonKind, SkeletonLine};
pub use lines::skeleton_lines;
pub use pieces::{Axis, AxisPoint, End};
