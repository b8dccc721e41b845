//! The lakes as they are added one after the other, with an index of the boxes around them.

use geo::{BoundingRect, MultiPolygon};
use rstar::primitives::{GeomWithData, Rectangle};
use rstar::{AABB, RTree};

use super::bodies::{WaterBody, first_vertex, rounded};
use super::cut::{cut_from_water, joined};
use crate::base::error::{Finding, FindingKind};
use crate::geometry::tolerance;

/// How far boolean operations move vertices at most, as a share of the size of a lake; more than they do.
const MOVED: f64 = 1e-7;

/// The box around a lake, with the lake's place in the list.
type Placed = GeomWithData<Rectangle<[f64; 2]>, usize>;

/// Lakes of which no two meet.
#[derive(Default)]
pub(super) struct Gathered {
    /// In the order in which they were added; none where a lake was joined with a later one.
    bodies: Vec<Option<WaterBody>>,
    boxes: RTree<Placed>,
}

impl Gathered {
    /// Adds a lake to those before it. It is joined with water of the same height, and cut back from water of another
    /// height.
    pub fn add(&mut self, mut body: WaterBody, distance: f64, findings: &mut Vec<Finding>) {
        for k in self.near(&body.area) {
            let Some(other) = self.bodies[k].as_ref().filter(|other| other.height != body.height) else { continue };
            if let Some(rest) = cut_from_water(&body.area, &other.area, distance) {
                findings.push(cut_from(&body, other));
                body.area = rest;
            }
        }
        while let Some((k, both)) = self.same_water(&body) {
            body = WaterBody { area: both, ..self.take(k).unwrap_or(body) };
        }
        if let Some(around) = around(&body.area) {
            self.boxes.insert(GeomWithData::new(around, self.bodies.len()));
        }
        self.bodies.push(Some(body));
    }

    /// The first lake of the same height that a lake meets, and the union of the two.
    fn same_water(&self, body: &WaterBody) -> Option<(usize, MultiPolygon<f64>)> {
        self.near(&body.area).into_iter().find_map(|k| {
            let other = self.bodies[k].as_ref().filter(|other| other.height == body.height)?;
            Some((k, joined(&other.area, &body.area)?))
        })
    }

    /// Places of the lakes whose boxes meet that of an area, ascending.
    fn near(&self, area: &MultiPolygon<f64>) -> Vec<usize> {
        let Some(around) = around(area) else { return Vec::new() };
        let envelope = AABB::from_corners(around.lower(), around.upper());
        let mut found: Vec<usize> =
            self.boxes.locate_in_envelope_intersecting(&envelope).map(|placed| placed.data).collect();
        found.sort_unstable();
        found
    }

    fn take(&mut self, k: usize) -> Option<WaterBody> {
        let body = self.bodies[k].take()?;
        if let Some(around) = around(&body.area) {
            self.boxes.remove(&GeomWithData::new(around, k));
        }
        Some(body)
    }

    /// The lakes of which something is left, in the order in which they were added.
    pub fn into_bodies(self) -> Vec<WaterBody> {
        self.bodies.into_iter().flatten().filter(|body| !body.area.0.is_empty()).collect()
    }
}

/// The box around an area, grown by its tolerance and by what boolean operations move.
fn around(area: &MultiPolygon<f64>) -> Option<Rectangle<[f64; 2]>> {
    let bounds = area.bounding_rect()?;
    let margin = tolerance(area) + MOVED * bounds.width().hypot(bounds.height());
    let ([x0, y0], [x1, y1]) = ([bounds.min().x, bounds.min().y], [bounds.max().x, bounds.max().y]);
    Some(Rectangle::from_corners([x0 - margin, y0 - margin], [x1 + margin, y1 + margin]))
}

/// The finding that a lake is cut back from water of another height.
fn cut_from(body: &WaterBody, other: &WaterBody) -> Finding {
    let message = format!(
        "the lake of feature {} meets that of feature {}, which has another height ({} m and {} m); it is cut back",
        body.feature,
        other.feature,
        rounded(body.height),
        rounded(other.height)
    );
    let finding = Finding::at(FindingKind::LakeCutBack, first_vertex(&body.area), message);
    finding.about(body.feature, body.height).about(other.feature, other.height)
}

#[cfg(test)]
mod tests {
    use geo::{Area, polygon};

    use super::*;

    fn square(x: f64, y: f64, height: f64) -> WaterBody {
        let area = polygon![(x: x, y: y), (x: x + 1.0, y: y), (x: x + 1.0, y: y + 1.0), (x: x, y: y + 1.0)].into();
        WaterBody { area, height, feature: 0.into(), shores: Vec::new(), used: true }
    }

    #[test]
    fn a_lake_is_compared_with_those_beside_it_only() {
        let mut lakes = Gathered::default();
        for k in 0..400 {
            let lake = square(f64::from(k % 20) * 2.0, f64::from(k / 20) * 2.0, f64::from(k));
            assert!(lakes.near(&lake.area).is_empty());
            lakes.add(lake, 0.1, &mut Vec::new());
        }
        assert_eq!(lakes.near(&square(2.5, 4.5, 0.0).area), [41]);
        assert_eq!(lakes.into_bodies().len(), 400);
    }

    #[test]
    fn lakes_that_meet_are_joined_or_cut_back() {
        let mut findings = Vec::new();
        let mut lakes = Gathered::default();
        for lake in [square(0.0, 0.0, 5.0), square(4.0, 0.0, 6.0), square(1.5, 0.0, 5.0), square(0.75, 0.0, 5.0)] {
            lakes.add(lake, 0.25, &mut findings);
        }
        assert!(findings.is_empty());
        lakes.add(square(2.25, 0.0, 7.0), 0.25, &mut findings);
        assert_eq!(findings.len(), 1);
        let areas: Vec<f64> = lakes.into_bodies().iter().map(|lake| lake.area.unsigned_area()).collect();
        assert_eq!(areas.len(), 3);
        assert!(areas.iter().zip([1.0, 2.5, 0.5]).all(|(area, expected)| (area - expected).abs() < 1e-6), "{areas:?}");
    }
}
