//! The layer of streams as they are used.

use super::features::{Cell, Column, Geometry, Kind, Layer, Row, Shape};
use tokosen_core::streams::Stream;

const COLUMNS: &[Column] = &[
    Column { name: "feature", kind: Kind::Text(24) },
    Column { name: "strahler", kind: Kind::Int },
    Column { name: "length", kind: Kind::Real },
    Column { name: "upper_z", kind: Kind::Height },
    Column { name: "lower_z", kind: Kind::Height },
    Column { name: "shift", kind: Kind::Real },
    Column { name: "turned", kind: Kind::Bool },
];

/// The pieces of streams that the surface uses, as the layer `streams`. They run downstream, with a height at every
/// vertex.
///
/// The attributes are:
/// - `feature`: the number of the feature in the file of streams
/// - `strahler`: the Strahler order
/// - `length`; `upper_z` and `lower_z`: heights of the ends
/// - `shift`: the largest distance by which it was moved
/// - `turned`: whether it was drawn upstream
pub fn stream_lines(streams: &[Stream]) -> Layer<'_> {
    let rows = streams.iter().map(|stream| {
        let height = |at: Option<&glam::DVec3>| at.map_or(Cell::Null, |p| Cell::Real(p.z));
        let cells = vec![
            Cell::Text(stream.feature.to_string().into()),
            Cell::Int(stream.order.into()),
            Cell::Real(stream.length()),
            height(stream.points.first()),
            height(stream.points.last()),
            Cell::Real(stream.shift),
            Cell::Bool(stream.turned),
        ];
        Row { shape: Shape::Line(&stream.points), cells }
    });
    Layer { name: "streams", geometry: Geometry::Lines, columns: COLUMNS, rows: rows.collect() }
}
