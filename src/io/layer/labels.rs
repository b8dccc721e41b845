//! The layer of labels on contours.

use std::borrow::Cow;

use glam::DVec2;

use super::features::{Cell, Column, Geometry, Kind, Layer, Row, Shape};
use tokosen_core::crs::FromWorking;
use tokosen_core::slice::Label;

/// The name of the layer. With several layers of contours, each has its own: `labels_5m`.
pub const LABELS_LAYER: &str = "labels";

const COLUMNS: &[Column] = &[
    Column { name: "text", kind: Kind::Text(24) },
    Column { name: "elev", kind: Kind::Height },
    Column { name: "angle", kind: Kind::Real },
    Column { name: "height", kind: Kind::Real },
];

/// The name of the layer of labels beside a layer of contours; `alone` if there is no other.
pub fn labels_layer(contours: &str, alone: bool) -> String {
    match contours.strip_prefix("contours_").filter(|_| !alone) {
        Some(interval) => format!("{LABELS_LAYER}_{interval}"),
        None => LABELS_LAYER.to_owned(),
    }
}

/// Labels as points in the middle of their text, with the attributes
///
/// * `text`: the elevation as it is written, in the unit of the output, or the depth if the output has depths,
/// * `elev`: the elevation,
/// * `angle`: the direction of the text in the output's coordinates, degrees counter-clockwise from the x axis,
/// * `height`: the height of the text, units of the output's coordinates.
///
/// `back` is the conversion with which the layer is written.
pub fn of_labels<'a>(name: &'a str, labels: &'a [Label], back: &FromWorking) -> Layer<'a> {
    let rows = labels.iter().map(|label| {
        let (angle, scale) = direction(label, back);
        Row {
            shape: Shape::Point(Some(label.position)),
            cells: vec![
                Cell::Text(text(label, back)),
                Cell::Real(label.elevation),
                Cell::Real(angle),
                Cell::Real(label.size.y * scale),
            ],
        }
    });
    Layer { name, geometry: Geometry::Points, columns: COLUMNS, rows: rows.collect() }
}

/// The text: of a depth, without the sign of a height below 0.
fn text<'a>(label: &'a Label, back: &FromWorking) -> Cow<'a, str> {
    let height = label.text.as_str();
    match (back.has_depths(), height.strip_prefix('-')) {
        (false, _) => height.into(),
        (true, Some(depth)) => depth.into(),
        (true, None) if label.elevation > 0.0 => format!("-{height}").into(),
        (true, None) => height.into(),
    }
}

/// The angle of a text in the output's coordinates, and units of these per unit of the plane along it.
fn direction(label: &Label, back: &FromWorking) -> (f64, f64) {
    let half = DVec2::from_angle(label.angle.to_radians()) * label.size.x / 2.0;
    let ends = [label.position - half, label.position + half].map(|p| back.place(p));
    match ends {
        [Some(a), Some(b)] if a != b => {
            let angle = (b - a).to_angle().to_degrees();
            // The text stays upright where the axes of the output are turned.
            let upright = if angle > 90.0 {
                angle - 180.0
            } else if angle <= -90.0 {
                angle + 180.0
            } else {
                angle
            };
            (upright, a.distance(b) / label.size.x)
        }
        _ => (label.angle, 1.0),
    }
}
