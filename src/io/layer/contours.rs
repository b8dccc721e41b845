//! The layer of contours.

use super::{Cell, Column, Geometry, Kind, Layer, Row, Shape};
use crate::contour::{ContourLayer, Source};

const COLUMNS: &[Column] = &[
    Column { name: "elev", kind: Kind::Real },
    Column { name: "source", kind: Kind::Text(12) },
    Column { name: "is_index", kind: Kind::Bool },
    Column { name: "depression", kind: Kind::Bool },
    Column { name: "closed", kind: Kind::Bool },
];

/// The features of a layer of contours; see [`write_contours`](crate::io::write_contours) for their attributes.
pub fn of_contours(layer: &ContourLayer) -> Layer<'_> {
    let mut rows = Vec::with_capacity(layer.lines.len());
    for line in &layer.lines {
        let source = match line.source {
            Source::Input => "input",
            Source::Interpolated => "interpolated",
        };
        let cells = vec![
            Cell::Real(line.elevation),
            Cell::Text(source.into()),
            Cell::Bool(line.index),
            Cell::Bool(line.depression),
            Cell::Bool(line.is_closed()),
        ];
        rows.push(Row { shape: Shape::Contour(&line.points, line.elevation), cells });
    }
    Layer { name: &layer.name, geometry: Geometry::Lines, columns: COLUMNS, rows }
}
