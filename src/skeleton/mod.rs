//! Ridge and canyon lines from the triangulation (paper, section 4).
//!
//! [`skeleton`] drops the small branches ([`eliminate`]), puts points on the axis of what remains and joins them from
//! contour to contour ([`axis`]), gives them heights ([`axis_heights`]) that fall steadily ([`flow`](fn@flow)), and traces
//! the lines ([`break_lines`]).

mod attach;
mod axis;
mod caps;
mod edges;
mod eliminate;
mod flow;
mod heights;
mod joins;
mod lines;
mod sight;

pub(crate) use axis::narrow;
pub use axis::{Axis, AxisPoint, End, axis};
pub use caps::Cap;
pub use edges::{JunctionEdge, junction_edges};
pub use eliminate::{Elimination, eliminate, is_chord};
pub use flow::{Flow, flow};
pub use heights::axis_heights;
pub use lines::break_lines;

use glam::DVec3;

use crate::subdomains::Regions;
use crate::tin::{Tin, TriangleKind, triangle_kinds};
use crate::tuning::SkeletonTuning;

/// Which way the ground falls from a break line.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum BreakKind {
    /// Ground falls to both sides.
    Ridge,
    /// Ground rises to both sides.
    Canyon,
}

/// What lies at the end of a ridge or canyon line.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum LineEnd {
    /// A vertex of a contour: the tip of a bend, or the next contour. A line of the neighbouring sub-domain may go on there.
    Contour,
    /// Another line of the sub-domain, which runs through there.
    Junction,
    /// The highest point of a ridge.
    Peak,
    /// The lowest point of a canyon without a way out.
    Bottom,
    /// The lowest point of a ridge between two ways up, the highest of a canyon between two ways down.
    Saddle,
    /// The frame, or the opening between the ends of two contours.
    Frame,
    /// A spot height.
    Spot,
}

impl LineEnd {
    /// The word for it in files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Contour => "contour",
            Self::Junction => "junction",
            Self::Peak => "peak",
            Self::Bottom => "bottom",
            Self::Saddle => "saddle",
            Self::Frame => "frame",
            Self::Spot => "spot",
        }
    }
}

/// A ridge or canyon line with its heights, which fall from the first point to the last.
#[derive(Debug, Clone, PartialEq)]
pub struct BreakLine {
    /// Ridge or canyon.
    pub kind: BreakKind,
    /// Vertices (x, y in map units, height in metres), downhill.
    pub points: Vec<DVec3>,
    /// The sub-domain that the line runs in.
    pub region: u32,
    /// What lies at the first point and at the last.
    pub ends: [LineEnd; 2],
    /// Number of the network: lines that share end points, directly or through others, have the same.
    pub network: u32,
}

impl BreakLine {
    /// Length on the map, map units.
    pub fn length(&self) -> f64 {
        self.points.windows(2).map(|w| w[0].truncate().distance(w[1].truncate())).sum()
    }
}

/// The axis of a map's spurs, gullies and tops, with heights and as lines.
#[derive(Debug, Clone)]
pub struct Skeleton {
    /// Axis points and the pieces between them.
    pub axis: Axis,
    /// Heights of the axis points, and which way the pieces fall.
    pub flow: Flow,
    /// Ridge and canyon lines.
    pub lines: Vec<BreakLine>,
    /// Kind of each triangle.
    pub kinds: Vec<TriangleKind>,
    /// Junctions that were turned into sleeves, and the branches that this dropped.
    pub elimination: Elimination,
}

/// Finds ridge and canyon lines. `resolution` is the paper's w: more of it, fewer lines.
pub fn skeleton(tin: &Tin, regions: &Regions, resolution: f64, tuning: &SkeletonTuning) -> Skeleton {
    let kinds = triangle_kinds(tin);
    let elimination = eliminate(tin, &kinds, regions, resolution);
    let axis = axis(tin, &kinds, regions, &elimination, tuning.join_reach);
    let heights = axis_heights(tin, regions, &axis.points, tuning.top_reach);
    let flow = flow(tin, regions, &axis, heights, tuning);
    let lines = break_lines(tin, regions, &axis, &flow);
    Skeleton { axis, flow, lines, kinds, elimination }
}
