//! Side inputs that lie elsewhere than the contours: streams, lakes, spot heights in another system.

use geo::{CoordsIter, MultiPolygon, Polygon};
use glam::DVec2;

use super::input::Input;
use tokosen_core::base::error::{Finding, FindingKind};
use tokosen_core::contour::ContourMap;
use tokosen_core::drain::SinkShape;

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
    /// Reports the side inputs of which nothing lies near the contours.
    pub(super) fn report_sides_elsewhere(&mut self) {
        let sides = [
            ("streams", Extent::of(self.features.streams.iter().flat_map(|line| line.points.iter().copied()))),
            ("river areas", Extent::of(self.features.river_areas.iter().flat_map(|area| corners(&area.polygon)))),
            ("lakes", Extent::of(self.features.lakes.iter().flat_map(|lake| corners(&lake.polygon)))),
            ("break lines", Extent::of(self.features.break_lines.iter().flat_map(|line| line.points.iter().copied()))),
            ("cliffs", Extent::of(self.features.cliffs.iter().flat_map(|line| line.points.iter().copied()))),
            ("sinks", Extent::of(self.features.sinks.iter().flat_map(|sink| places(&sink.shape)))),
        ];
        let found = sides.into_iter().filter_map(|(what, side)| elsewhere(&self.map, what, side?));
        let found: Vec<Finding> = found.collect();
        self.findings.extend(found);
    }

    /// Reports spot heights of which none lies near the contours.
    pub(super) fn report_spots_elsewhere(&mut self, places: impl Iterator<Item = DVec2>) {
        let found = Extent::of(places).and_then(|side| elsewhere(&self.map, "spot heights", side));
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
    let message =
        format!("all {what} lie {:.3} km away from the contours, so they have no effect: {why}", distance / 1e3);
    Some(Finding::at(kind, side.lo, message))
}

fn corners(polygon: &Polygon<f64>) -> impl Iterator<Item = DVec2> {
    polygon.exterior_coords_iter().map(|c| DVec2::new(c.x, c.y))
}

fn places(shape: &SinkShape) -> Vec<DVec2> {
    let of_area = |area: &MultiPolygon<f64>| area.iter().flat_map(corners).collect();
    match shape {
        SinkShape::Point(p) => vec![*p],
        SinkShape::Area(area) => of_area(area),
    }
}
