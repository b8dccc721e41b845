//! The axis as data: its points and the pieces between them.

use glam::DVec2;

/// A point of the axis. Most lie midway between two vertices on one level.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AxisPoint {
    /// Position relative to the triangulation's origin.
    pub position: DVec2,
    /// The level of those vertices; none for a point anywhere in its sub-domain.
    pub level: Option<f64>,
    /// A triangle that the point lies in or on.
    pub triangle: u32,
    /// The sub-domain.
    pub region: u32,
}

/// The end of a piece of a line.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum End {
    /// To an axis point.
    Axis(u32),
    /// To a vertex of the triangulation: the tip of a contour's bend, or a vertex of the next contour.
    Vertex(u32),
}

/// Axis points and the pieces of line between them.
#[derive(Debug, Clone, Default)]
pub struct Axis {
    /// The points. Those in dropped branches are here too: they carry heights, but no lines.
    pub points: Vec<AxisPoint>,
    /// Pieces of ridge and canyon lines. The first end is an axis point.
    pub pieces: Vec<[End; 2]>,
}
