//! What a map gives beside its contours.

use glam::DVec2;

use crate::break_lines::BreakLine;
use crate::drain::Sink;
use crate::features::Features;
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

impl Given {
    /// Features on the plane of the map, the level of the sea, and the levels of coasts. The lines of coasts are contours,
    /// and excluded parts are cut out of the map, before a surface is made.
    pub fn new(features: Features, sea: Option<f64>, coast: Vec<f64>) -> Self {
        let Features { cliffs, lakes, streams, river_areas, break_lines, sinks, coast: _, excluded: _ } = features;
        Self {
            water: Water { lakes, sea, coast },
            streams: Streams { lines: streams, areas: river_areas },
            cliffs: cliffs.into_iter().map(|cliff| cliff.points).collect(),
            break_lines,
            sinks,
        }
    }
}
