//! Pieces of lines that are left out, and why.

use glam::DVec2;

use crate::base::FeatureId;
use crate::base::bits::bits;
use crate::base::error::{Finding, FindingKind};
use crate::contour::Contour;
use crate::geometry::compare_points;

/// A segment without direction, with its elevation. Equal segments have equal keys.
pub(super) type SegmentKey = (u64, [u64; 2], [u64; 2]);

/// The key of a segment.
pub(super) fn key(elevation: f64, a: DVec2, b: DVec2) -> SegmentKey {
    let (a, b) = (bits(a), bits(b));
    (elevation.to_bits(), a.min(b), a.max(b))
}

/// Why a piece is left out.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Why {
    /// The line runs to the piece's first point and straight back.
    Spike,
    /// The whole line runs there and straight back. One of the two runs stays.
    Doubled,
    /// The line goes on over itself at an end. The other run stays.
    Overrun,
    /// The ends of the line overlap. It is closed at its first vertex, which lies on the piece.
    Overlap,
    /// It meets another segment. The findings about the place report it.
    Meets,
    /// Its inner vertices are stray vertices, and a straight piece replaces it. The findings about the place report it.
    Strays,
}

/// A piece of a line that is left out.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Removed {
    pub(super) elevation: f64,
    pub(super) feature: FeatureId,
    /// Its points: of a spike from the tip to the root.
    pub(super) way: Vec<DVec2>,
    pub(super) why: Why,
}

impl Removed {
    /// A piece of a line.
    pub(super) fn new(line: &Contour, way: Vec<DVec2>, why: Why) -> Self {
        Self { elevation: line.elevation, feature: line.feature, way, why }
    }

    /// The keys of its segments.
    pub(super) fn keys(&self) -> impl Iterator<Item = SegmentKey> {
        self.way.windows(2).map(|w| key(self.elevation, w[0], w[1]))
    }

    /// A fixed order for spikes, whose lines come in the input's order.
    pub(super) fn compare(&self, other: &Self) -> std::cmp::Ordering {
        let ways = || self.way.iter().rev().zip(other.way.iter().rev());
        (self.elevation.total_cmp(&other.elevation))
            .then_with(|| {
                ways()
                    .map(|(p, q)| compare_points(p, q))
                    .find(|o| o.is_ne())
                    .unwrap_or(self.way.len().cmp(&other.way.len()))
            })
            .then(self.feature.cmp(&other.feature))
    }

    /// The finding about it, unless other findings report it.
    pub(super) fn finding(&self) -> Option<Finding> {
        let (elevation, feature) = (self.elevation, self.feature);
        let length: f64 = self.way.windows(2).map(|w| w[0].distance(w[1])).sum();
        let message = match self.why {
            Why::Meets | Why::Strays => return None,
            Why::Overrun => format!(
                "the contour {elevation} m (feature {feature}) goes on over itself at an end, for {length:.3} map units; only \
                 one of the two runs was kept"
            ),
            Why::Overlap => format!(
                "the two ends of the contour {elevation} m (feature {feature}) overlap by {:.3} map units; the ring was closed",
                self.way.windows(2).next_back().map_or(0.0, |w| w[0].distance(w[1]))
            ),
            Why::Spike => format!(
                "the contour {elevation} m (feature {feature}) runs to a point and straight back; the spike, {length:.3} map \
                 units long, was left out"
            ),
            Why::Doubled => format!(
                "the contour {elevation} m (feature {feature}) runs there and straight back over {length:.3} map units; only \
                 one of the two runs was kept"
            ),
        };
        let kind = match self.why {
            Why::Overrun | Why::Overlap => FindingKind::OverlappingLines,
            _ => FindingKind::Spike,
        };
        let tip = self.way.first().copied();
        Some(Finding::new(kind, tip, message).about(feature, elevation))
    }
}
