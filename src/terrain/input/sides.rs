//! Side inputs that lie elsewhere than the contours: streams, lakes, spot heights in another system.

use glam::DVec2;

use super::Input;
use tokosen_core::base::error::{Finding, FindingKind};
use tokosen_core::contour::ContourMap;

/// A side input is far away if it is further from the contours than this many diagonals of the box around them.
const FAR: f64 = 1.0;

/// An upright box.
#[derive(Clone, Copy)]
struct Extent {
    lo: DVec2,
    hi: DVec2,
}

impl Extent {
    /// The box around places; `None` without any.
    fn of(places: impl Iterator<Item = DVec2>) -> Option<Self> {
        let around = |found: Option<Self>, p: DVec2| {
            Some(found.map_or(Self { lo: p, hi: p }, |e| Self { lo: e.lo.min(p), hi: e.hi.max(p) }))
        };
        places.filter(|p| p.is_finite()).fold(None, around)
    }

    fn fits_degrees(&self) -> bool {
        self.lo.abs().max(self.hi.abs()).cmple(DVec2::new(180.0, 90.0)).all()
    }

    fn distance(&self, other: &Self) -> f64 {
        (other.lo - self.hi).max(self.lo - other.hi).max(DVec2::ZERO).length()
    }
}

impl Input {
    /// Reports features or spot heights, at these places, if none of them lies near the contours.
    pub(super) fn report_elsewhere(&mut self, what: &str, places: impl Iterator<Item = DVec2>) {
        let found = Extent::of(places).and_then(|side| elsewhere(&self.map, what, side));
        self.findings.extend(found);
    }
}

/// The finding that a side input lies elsewhere than the contours.
fn elsewhere(map: &ContourMap, what: &str, side: Extent) -> Option<Finding> {
    let contours = Extent::of(map.contours.iter().flat_map(|line| line.points.iter().copied()))?;
    let distance = contours.distance(&side);
    if distance <= FAR * contours.lo.distance(contours.hi) {
        return None;
    }
    let (kind, why) = match side.fits_degrees() && !contours.fits_degrees() {
        true => (FindingKind::LooksLikeDegrees, "their coordinates look like degrees; name their system"),
        false => (FindingKind::FarAway, "they are in another system or zone, or of another map"),
    };
    let message = format!("all {what} lie {:.3} km away from the contours: {why}", distance / 1e3);
    Some(Finding::at(kind, side.lo, message))
}
