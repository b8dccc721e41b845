//! Streams as the input gives them, and as they are used.

use std::ops::Range;

use geo::Polygon;
use glam::{DVec2, DVec3};

use crate::base::bits::bits;
use crate::base::{FeatureId, KnownLine, Sure};
use crate::subdomains::Band;

/// Where a line begins and ends.
pub(super) type Ends = [[u64; 2]; 2];

/// A stream as a map draws it.
#[derive(Debug, Clone, PartialEq)]
pub struct StreamLine {
    /// Its course, map units, in any direction.
    pub points: Vec<DVec2>,
    /// The feature that it came from, for messages.
    pub feature: FeatureId,
}

/// A river as wide as a map shows it.
#[derive(Debug, Clone, PartialEq)]
pub struct RiverArea {
    /// Its outline, map units; holes are islands.
    pub polygon: Polygon<f64>,
    /// The feature that it came from, for messages.
    pub feature: FeatureId,
}

/// The streams of a map.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Streams {
    /// The lines.
    pub lines: Vec<StreamLine>,
    /// River areas. They are level across and fall along, as the streams through them.
    pub areas: Vec<RiverArea>,
}

/// A piece of a stream as the surface uses it, from one confluence or end to the next.
#[derive(Debug, Clone, PartialEq)]
pub struct Stream {
    /// Vertices (x, y in map units, height in metres), downstream. Heights never rise.
    pub points: Vec<DVec3>,
    /// How sure the height of each vertex is.
    pub(crate) sure: Vec<Sure>,
    /// The band of the sub-domain around each vertex.
    pub(crate) bands: Vec<Band>,
    /// The feature that it came from.
    pub feature: FeatureId,
    /// Strahler order: 1 at a source; where two of one order meet, the next one.
    pub order: u32,
    /// The largest distance by which it was moved, map units.
    pub shift: f64,
    /// Whether it was drawn upstream.
    pub turned: bool,
}

impl Stream {
    /// A piece of the stream with these points, to be written.
    pub fn piece(&self, points: Vec<DVec3>) -> Self {
        Self { points, sure: Vec::new(), bands: Vec::new(), ..*self }
    }

    /// The stream between some of its vertices; `None` for fewer than two.
    pub(super) fn part(&self, vertices: Range<usize>) -> Option<Self> {
        let points = self.points[vertices.clone()].to_vec();
        let (sure, bands) = (self.sure[vertices.clone()].to_vec(), self.bands[vertices].to_vec());
        (points.len() > 1).then(|| Self { sure, bands, ..self.piece(points) })
    }

    /// The height at a vertex: that of a contour or of water if it lies there, otherwise that of a surface, in the band.
    pub(super) fn height_on(&self, vertex: usize, surface: impl Fn(DVec2) -> f64) -> f64 {
        let p = self.points[vertex];
        let height = if self.sure[vertex] == Sure::Exact { f64::NAN } else { surface(p.truncate()) };
        if height.is_nan() { p.z } else { self.bands[vertex].strictly_inside(height) }
    }

    /// The largest difference between the stream and what a surface gives for its vertices ([`Stream::height_on`]), metres.
    pub(crate) fn change_from(&self, surface: impl Fn(DVec2) -> f64) -> f64 {
        let change = |k: usize| (self.points[k].z - self.height_on(k, &surface)).abs();
        (0..self.points.len()).map(change).fold(0.0, f64::max)
    }

    /// Where it begins and ends; `None` without points. Where streams meet, their ends are equal.
    pub(super) fn ends(&self) -> Option<Ends> {
        let ends = self.points.first().zip(self.points.last());
        ends.map(|(first, last)| [first, last].map(|p| bits(p.truncate())))
    }

    /// Its course with heights.
    pub(crate) fn known(&self) -> KnownLine<'_> {
        KnownLine { points: &self.points, is_stream: true, sure: &self.sure }
    }

    /// Length on the map, map units.
    pub fn length(&self) -> f64 {
        self.points.windows(2).map(|w| w[0].truncate().distance(w[1].truncate())).sum()
    }

    /// A stream between contours, for tests.
    #[cfg(test)]
    pub(crate) fn between(points: Vec<DVec3>, band: Band) -> Self {
        Self {
            sure: vec![Sure::Between; points.len()],
            bands: vec![band; points.len()],
            points,
            feature: 0.into(),
            order: 1,
            shift: 0.0,
            turned: false,
        }
    }
}
