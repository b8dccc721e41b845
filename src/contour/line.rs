//! A line of the output: a contour with what a map needs to know about it.

use glam::DVec2;

/// How far a line is expected to be off.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LineError {
    /// Root mean square of the standard error of the heights along it, metres.
    pub vertical: f64,
    /// The same of its place: height error over slope, no more than the distance from the contours around, map units.
    pub horizontal: f64,
    /// Whether most of it lies where the contours hardly tell the height: on a top, in a pit, on a wide flat, or along
    /// the frame beyond the last contour.
    pub inferred: bool,
}

/// Where an output line comes from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Source {
    /// A contour of the input, its vertices unchanged.
    Input,
    /// A line traced on the surface.
    Interpolated,
}

/// A contour line of the output.
///
/// Higher ground lies on the right of the line's direction. A closed line repeats its first point at the end.
#[derive(Debug, Clone, PartialEq)]
pub struct ContourLine {
    /// Elevation of every vertex, exactly the level.
    pub elevation: f64,
    /// The vertices in order, map units.
    pub points: Vec<DVec2>,
    /// Input or interpolated.
    pub source: Source,
    /// Whether it is an index contour, drawn bold on a map.
    pub index: bool,
    /// Whether it closes around lower ground.
    pub depression: bool,
    /// How far the line is expected to be off; `None` if that was not asked for. An input line is off by nothing.
    pub expected: Option<LineError>,
}

impl ContourLine {
    /// Whether the line ends where it starts, around an area.
    pub fn is_closed(&self) -> bool {
        self.points.len() >= 4 && self.points.first() == self.points.last()
    }
}

/// Lines of one target interval, as one layer of the output.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct ContourLayer {
    /// Name of the layer, such as `contours_2m`.
    pub name: String,
    /// The lines, by elevation and then in a fixed order.
    pub lines: Vec<ContourLine>,
    /// New rings that were left out because they are smaller than what the contours can tell.
    pub artefact_rings: usize,
    /// New lines that were left out because they ran into a closed contour of their own level: contours are missing around
    /// it, so that the ground outside it is higher on one part and lower on another.
    pub dead_ends: usize,
}
