//! What a map gives beside its contours.

use glam::DVec2;

use crate::break_lines::BreakLine;
use crate::drain::Sink;
use crate::streams::Streams;
use crate::subdivision::Water;

/// What a map gives beside its contours, for [`build`](super::build).
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Given {
    /// Lakes and the sea.
    pub water: Water,
    /// Rivers and streams. Not for [`SurfaceKind::Linear`](super::SurfaceKind::Linear).
    pub streams: Streams,
    /// Cliffs, map coordinates. Only for [`SurfaceKind::Spline`](super::SurfaceKind::Spline).
    pub cliffs: Vec<Vec<DVec2>>,
    /// Break lines. Not for [`SurfaceKind::Linear`](super::SurfaceKind::Linear).
    pub break_lines: Vec<BreakLine>,
    /// Where water may stay. Only for [`SurfaceKind::Spline`](super::SurfaceKind::Spline).
    pub sinks: Vec<Sink>,
}
