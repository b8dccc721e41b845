//! A part of a map: results end at its border, and the contours around it still count.
//!
//! The surface is built over a window around the part. The window is so wide that contours beyond it hardly change the
//! surface in the part. What depends on the whole map is taken from the whole map ([`Whole`](tokosen_core::surface::Whole)).
//! Lines outside of the window are left out once the lines are clean, so a part of a large map takes little time.

use std::collections::HashSet;

use geo::{Area, BoundingRect, Coord, MultiPolygon, Rect};
use glam::DVec2;

use tokosen_core::base::error::{Error, Finding, Result};
use tokosen_core::contour::{Contour, ContourMap};
use tokosen_core::geometry::Border;
use tokosen_core::geometry::{common_area, contains_area};
use tokosen_core::subdomains::{Frame, frame_ring};

/// Width of the window beyond the part, as a multiple of the mean spacing of the contours in it.
pub(crate) const SPACINGS: f64 = 20.0;
/// Its least width beyond the part, as a share of the part's longer side.
pub(crate) const SHARE: f64 = 0.1;
/// Levels that a window has, if the map has them: fewer do not show the interval.
pub(crate) const LEVELS: usize = 4;
/// Growth of a window that is too small.
pub(crate) const GROWTH: f64 = 1.6;

/// A part of a map, on the working plane.
#[derive(Debug, Clone)]
pub(super) struct Part {
    /// The part.
    area: MultiPolygon<f64>,
    /// The window around it.
    window: Rect<f64>,
    /// The convex hull of the whole map, and the box around it.
    hull: MultiPolygon<f64>,
    boxed: MultiPolygon<f64>,
}

/// An upright box as an area: least x, least y, greatest x, greatest y.
///
/// # Errors
/// [`Error::Parameter`] if the box has no width or no height.
pub(super) fn box_area([west, south, east, north]: [f64; 4]) -> Result<MultiPolygon<f64>> {
    if !(west < east && south < north && [west, south, east, north].iter().all(|v| v.is_finite())) {
        let message = "the extent has no width or no height; it is least x, least y, greatest x, greatest y";
        return Err(Error::Parameter(message.into()));
    }
    Ok(Rect::new(Coord { x: west, y: south }, Coord { x: east, y: north }).to_polygon().into())
}

/// The boxes around a part and around the map.
///
/// # Errors
/// [`Error::PartOutside`] if the part lies outside of the map.
fn on_map(area: &MultiPolygon<f64>, boxed: &MultiPolygon<f64>) -> Result<[Rect<f64>; 2]> {
    let (Some(inner), Some(whole)) = (area.bounding_rect(), boxed.bounding_rect()) else {
        return Err(Error::NoContours { in_polygon: false });
    };
    let meet = inner.min().x < whole.max().x
        && inner.max().x > whole.min().x
        && inner.min().y < whole.max().y
        && inner.max().y > whole.min().y;
    if meet { Ok([inner, whole]) } else { Err(outside(&inner, &whole)) }
}

/// Checks that a part lies on a map.
///
/// # Errors
/// [`Error::PartOutside`] if it lies outside of it.
pub(super) fn check_on_map(area: &MultiPolygon<f64>, map: &ContourMap) -> Result<()> {
    on_map(area, &frame_ring(map, &Frame::Box).area).map(|_| ())
}

impl Part {
    /// The part of a clean map.
    ///
    /// # Errors
    /// [`Error::PartOutside`] if it lies outside of the map.
    pub(super) fn new(area: MultiPolygon<f64>, map: &ContourMap) -> Result<Self> {
        let [hull, boxed] = [Frame::Hull, Frame::Box].map(|frame| frame_ring(map, &frame).area);
        let [inner, whole] = on_map(&area, &boxed)?;
        Ok(Self { window: window(map, &inner, &whole), area, hull, boxed })
    }

    /// A part whose window was chosen before. `ground` is the area inside the frame of the whole map.
    #[cfg(feature = "io")]
    pub(super) fn with_window(area: MultiPolygon<f64>, window: Rect<f64>, ground: MultiPolygon<f64>) -> Self {
        Self { area, window, hull: ground.clone(), boxed: ground }
    }

    /// Leaves out what does not meet the window.
    pub(super) fn cut(&self, map: &mut ContourMap) {
        map.contours.retain(|line| meets(line, &self.window));
        map.spots.retain(|spot| holds(&self.window, spot.truncate()));
        map.soft_spots.retain(|spot| holds(&self.window, spot.place.truncate()));
    }

    /// The part that is asked for, also where there is no ground.
    pub(super) fn area(&self) -> &MultiPolygon<f64> {
        &self.area
    }

    /// The frame of the surface: what lies inside the window.
    pub(super) fn frame(&self, wanted: Frame) -> Frame {
        let whole = match &wanted {
            Frame::Auto | Frame::Hull => &self.hull,
            Frame::Box => &self.boxed,
            Frame::Polygon(area) | Frame::PolygonInHull(area) | Frame::Outline(area) | Frame::Convex(area) => area,
        };
        let is_in_window = |around: Rect<f64>| corners(&around).into_iter().all(|corner| holds(&self.window, corner));
        if whole.bounding_rect().is_none_or(is_in_window) {
            return wanted;
        }
        let common = common_area(whole, &self.window.to_polygon().into());
        match wanted {
            Frame::Auto | Frame::Hull | Frame::Box | Frame::Convex(_) => Frame::Convex(common),
            Frame::Polygon(_) => Frame::Polygon(common),
            Frame::PolygonInHull(_) | Frame::Outline(_) => Frame::PolygonInHull(common),
        }
    }

    /// The part of the ground that is asked for; `ground` is all that there is.
    ///
    /// # Errors
    /// [`Error::PartOutside`] if there is no ground in the part.
    pub(super) fn of(&self, ground: &MultiPolygon<f64>) -> Result<MultiPolygon<f64>> {
        // An intersection moves vertices by a rounding error; then a grid could get a further column.
        if contains_area(ground, &self.area) {
            return Ok(self.area.clone());
        }
        let common = common_area(ground, &self.area);
        match (common.unsigned_area() > 0.0, self.area.bounding_rect(), self.boxed.bounding_rect()) {
            (false, Some(part), Some(map)) => Err(outside(&part, &map)),
            _ => Ok(common),
        }
    }
}

/// Leaves out the findings whose place is outside of an area, and returns their number.
pub(super) fn drop_outside(findings: &mut Vec<Finding>, area: &MultiPolygon<f64>) -> usize {
    let border = Border::new(area);
    let before = findings.len();
    findings.retain(|finding| finding.place.is_none_or(|p| border.contains(p) || border.edge_at(p).is_some()));
    before - findings.len()
}

/// A box around the part, so wide that it holds enough contours around it.
fn window(map: &ContourMap, part: &Rect<f64>, whole: &Rect<f64>) -> Rect<f64> {
    let mut reach = SHARE * part.width().max(part.height());
    loop {
        let window = Rect::new(
            Coord { x: part.min().x - reach, y: part.min().y - reach },
            Coord { x: part.max().x + reach, y: part.max().y + reach },
        );
        if corners(whole).into_iter().all(|corner| holds(&window, corner)) {
            return window;
        }
        let kept: Vec<&Contour> = map.contours.iter().filter(|line| meets(line, &window)).collect();
        let length: f64 = kept.iter().flat_map(|line| line.points.windows(2)).map(|w| within(w, &window)).sum();
        let spacing = window.width() * window.height() / length;
        let is_around = kept
            .iter()
            .flat_map(|line| &line.points)
            .fold(None, |around: Option<(DVec2, DVec2)>, &p| {
                Some(around.map_or((p, p), |(lo, hi)| (lo.min(p), hi.max(p))))
            })
            .is_some_and(|(lo, hi)| {
                lo.x <= part.min().x.max(whole.min().x)
                    && lo.y <= part.min().y.max(whole.min().y)
                    && hi.x >= part.max().x.min(whole.max().x)
                    && hi.y >= part.max().y.min(whole.max().y)
            });
        let levels: HashSet<u64> = kept.iter().map(|line| line.elevation.to_bits()).collect();
        if is_around && reach >= SPACINGS * spacing && levels.len() >= LEVELS {
            return window;
        }
        reach *= GROWTH;
    }
}

/// Length of a segment, if its middle is in a box.
fn within(ends: &[DVec2], window: &Rect<f64>) -> f64 {
    if holds(window, ends[0].midpoint(ends[1])) { ends[0].distance(ends[1]) } else { 0.0 }
}

fn holds(window: &Rect<f64>, p: DVec2) -> bool {
    (window.min().x..=window.max().x).contains(&p.x) && (window.min().y..=window.max().y).contains(&p.y)
}

/// Whether the box around a segment of a line meets a box.
fn meets(line: &Contour, window: &Rect<f64>) -> bool {
    let [lo, hi] = [window.min(), window.max()].map(|c| DVec2::new(c.x, c.y));
    line.points.windows(2).any(|w| w[0].max(w[1]).cmpge(lo).all() && w[0].min(w[1]).cmple(hi).all())
}

fn outside(part: &Rect<f64>, map: &Rect<f64>) -> Error {
    Error::PartOutside { part: corners(part), map: corners(map), of: "the contours" }
}

fn corners(around: &Rect<f64>) -> [DVec2; 2] {
    [around.min(), around.max()].map(|c| DVec2::new(c.x, c.y))
}
