//! A segment that is left out, and why.

use glam::DVec2;

use super::canonical::compare_points;
use crate::contour::Contour;
use crate::error::{Finding, FindingKind};

/// A segment without direction, with its elevation: equal bits, equal segment.
pub(super) type SegmentKey = (u64, [u64; 2], [u64; 2]);

/// The key of a segment.
pub(super) fn key(elevation: f64, a: DVec2, b: DVec2) -> SegmentKey {
    let bits = |p: DVec2| [p.x.to_bits(), p.y.to_bits()];
    let (a, b) = (bits(a), bits(b));
    (elevation.to_bits(), a.min(b), a.max(b))
}

/// Why a segment is left out.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Why {
    /// The line runs to the segment's second point and straight back.
    Spike,
    /// The whole line runs there and back; it stays once.
    Doubled,
    /// It meets the line of this elevation and feature, at this place.
    Meets { elevation: f64, feature: u64, place: DVec2 },
}

/// A segment that is left out.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Removed {
    pub(super) elevation: f64,
    pub(super) feature: u64,
    pub(super) ends: [DVec2; 2],
    pub(super) why: Why,
}

impl Removed {
    /// A segment to `tip` that runs back again.
    pub(super) fn spike(line: &Contour, root: DVec2, tip: DVec2) -> Self {
        Self { elevation: line.elevation, feature: line.feature, ends: [root, tip], why: Why::Spike }
    }

    pub(super) fn key(&self) -> SegmentKey {
        key(self.elevation, self.ends[0], self.ends[1])
    }

    /// A fixed order for spikes, whose lines come in the input's order.
    pub(super) fn compare(&self, other: &Self) -> std::cmp::Ordering {
        (self.elevation.total_cmp(&other.elevation))
            .then_with(|| compare_points(&self.ends[0], &other.ends[0]))
            .then_with(|| compare_points(&self.ends[1], &other.ends[1]))
            .then(self.feature.cmp(&other.feature))
    }

    /// The finding that tells of it.
    pub(super) fn finding(&self) -> Finding {
        let (elevation, feature) = (self.elevation, self.feature);
        match self.why {
            Why::Spike => Finding::at(
                FindingKind::SelfCross,
                self.ends[1],
                format!(
                    "the contour {elevation} m (feature {feature}) runs to a point and straight back; the spike was left out"
                ),
            ),
            Why::Doubled => Finding::at(
                FindingKind::SelfCross,
                self.ends[1],
                format!("the contour {elevation} m (feature {feature}) runs there and straight back; it was kept once"),
            ),
            Why::Meets { elevation: other, feature: by, place } => {
                let (kind, verb) = if other == elevation {
                    (
                        FindingKind::SelfCross,
                        if by == feature { "crosses or overlaps itself" } else { "crosses or overlaps" },
                    )
                } else {
                    (FindingKind::LevelsCross, "crosses or touches")
                };
                let whom = if verb.ends_with("itself") {
                    String::new()
                } else {
                    format!(" the contour {other} m (feature {by})")
                };
                Finding::at(
                    kind,
                    place,
                    format!(
                        "the contour {elevation} m (feature {feature}) {verb}{whom}; one segment of it was left out"
                    ),
                )
            }
        }
    }
}
