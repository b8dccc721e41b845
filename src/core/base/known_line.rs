//! Lines on the ground with heights.

use glam::{DVec2, DVec3};

/// How sure a height on a line is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Sure {
    /// Nothing near gives it: the smooth surface knows better.
    Guessed,
    /// From the contours that the line crosses near by.
    Between,
    /// From a survey of the line.
    Surveyed,
    /// A contour or water has this height.
    Exact,
}

/// A line on the ground with heights, such as a stream or a break line.
#[derive(Debug, Clone, Copy)]
pub(crate) struct KnownLine<'a> {
    /// Vertices (x, y in map units, height in metres).
    pub points: &'a [DVec3],
    /// Whether it is a stream. The banks of river areas are none.
    pub is_stream: bool,
    /// How sure the height of each vertex is.
    pub sure: &'a [Sure],
}

impl<'a> KnownLine<'a> {
    /// The vertices with how sure they are.
    pub fn vertices(self) -> impl Iterator<Item = (DVec3, Sure)> + 'a {
        self.points.iter().copied().zip(self.sure.iter().copied())
    }

    /// The course on the map.
    pub fn course(self) -> Vec<DVec2> {
        self.points.iter().map(|p| p.truncate()).collect()
    }
}
