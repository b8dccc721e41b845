//! A line of the output: a contour with what a map needs to know about it.

use glam::DVec2;

/// The expected error of a line.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LineError {
    /// Root mean square of the standard errors of the heights along the line, metres.
    pub vertical: f64,
    /// The same for its position: height error over slope, at most the distance to the contours around, map units.
    pub horizontal: f64,
    /// Whether the contours hardly determine the height along most of the line: on a top, in a pit, on a wide flat, or
    /// between the last contour and the frame.
    pub inferred: bool,
}

/// Where an output line comes from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Source {
    /// A contour of the input, its vertices unchanged.
    Input,
    /// A line traced on the surface.
    Interpolated,
    /// A line traced on a height map.
    HeightMap,
}

/// The kind of a contour on a map.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum ContourKind {
    /// Every fifth contour, drawn bold.
    Index,
    /// The other contours of the interval.
    Intermediate,
    /// A contour at half of the interval.
    Supplementary,
    /// A contour at a quarter of the interval.
    SupplementaryQuarter,
}

impl ContourKind {
    /// Its name in files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Index => "index",
            Self::Intermediate => "intermediate",
            Self::Supplementary => "supplementary",
            Self::SupplementaryQuarter => "supplementary_quarter",
        }
    }

    /// Whether it is drawn only where the ground needs it.
    pub fn is_supplementary(self) -> bool {
        matches!(self, Self::Supplementary | Self::SupplementaryQuarter)
    }
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
    /// Input, interpolated, or of a height map.
    pub source: Source,
    /// Whether it is an index contour, drawn bold on a map.
    pub index: bool,
    /// Its kind on a map; `None` if it was not asked for.
    pub kind: Option<ContourKind>,
    /// Whether it closes around lower ground.
    pub depression: bool,
    /// The expected error; `None` if it was not asked for. An input line has no error.
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
    /// Number of artefact rings left out: new rings too small for the contours to determine.
    pub artefact_rings: usize,
    /// Number of dead ends left out: new lines that ran into a closed contour of their own level. Contours are missing
    /// around such a contour: the ground outside it is higher on one part and lower on another.
    pub dead_ends: usize,
}
