//! What may happen to pits, and the places where water may stay.

use geo::{BoundingRect, MultiPolygon};
use glam::DVec2;

use crate::base::FeatureId;

/// Which pits get a way out.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default, serde::Serialize, serde::Deserialize)]
pub enum Drain {
    /// None: the surface keeps every pit between contours.
    None,
    /// Those that no contour speaks for: a way out is cut as far as the contours leave one.
    #[default]
    Safe,
    /// All but those in sinks and in water. Ground inside depression contours is cut or filled too.
    All,
}

/// A place where water may stay.
#[derive(Debug, Clone, PartialEq)]
pub struct Sink {
    /// The place.
    pub shape: SinkShape,
    /// The feature that it came from, for messages.
    pub feature: FeatureId,
}

impl Sink {
    /// Its position in messages.
    pub(crate) fn place(&self) -> Option<DVec2> {
        match &self.shape {
            SinkShape::Point(p) => Some(*p),
            SinkShape::Area(area) => area.bounding_rect().map(|rect| DVec2::new(rect.center().x, rect.center().y)),
        }
    }
}

/// The shape of a sink, map units.
#[derive(Debug, Clone, PartialEq)]
pub enum SinkShape {
    /// The pit that holds this point.
    Point(DVec2),
    /// Everything inside.
    Area(MultiPolygon<f64>),
}
