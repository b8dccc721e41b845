//! Ridge and canyon lines from the triangulation (paper, section 4).
//!
//! [`skeleton`] drops the small branches ([`eliminate`]), puts points on the axis of what remains ([`axis`]), gives them
//! heights ([`axis_heights`]) and joins them to lines ([`break_lines`]).

mod axis;
mod caps;
mod eliminate;
mod heights;
mod lines;

pub use axis::{Axis, AxisPoint, End, axis};
pub use caps::Cap;
pub use eliminate::{Elimination, eliminate};
pub use heights::axis_heights;
pub use lines::break_lines;

use glam::DVec3;

use crate::tin::{Regions, Tin, triangle_kinds};

/// Which way the ground falls from a break line.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum BreakKind {
    /// Ground falls to both sides.
    Ridge,
    /// Ground rises to both sides.
    Canyon,
}

/// A ridge or canyon line with its heights.
#[derive(Debug, Clone, PartialEq)]
pub struct BreakLine {
    /// Ridge or canyon.
    pub kind: BreakKind,
    /// Vertices (x, y in map units, height in metres).
    pub points: Vec<DVec3>,
}

/// The axis of a map's spurs, gullies and tops, with heights and as lines.
#[derive(Debug, Clone)]
pub struct Skeleton {
    /// Axis points and the pieces between them.
    pub axis: Axis,
    /// Height of each axis point.
    pub heights: Vec<f64>,
    /// Ridge and canyon lines.
    pub lines: Vec<BreakLine>,
}

/// Finds ridge and canyon lines. `resolution` is the paper's w: more of it, fewer lines.
pub fn skeleton(tin: &Tin, regions: &Regions, resolution: f64) -> Skeleton {
    let kinds = triangle_kinds(tin);
    let elimination = eliminate(tin, &kinds, regions, resolution);
    let axis = axis(tin, &kinds, regions, &elimination);
    let heights = axis_heights(tin, regions, &axis.points);
    let lines = break_lines(tin, &axis, &heights);
    Skeleton { axis, heights, lines }
}
