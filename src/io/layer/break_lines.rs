//! The layer of given break lines as they are used.

use super::features::{Cell, Column, Geometry, Kind, Layer, Row, Shape};
use tokosen_core::creases::{Bend, Crease};

const COLUMNS: &[Column] = &[
    Column { name: "feature", kind: Kind::Text(24) },
    Column { name: "kind", kind: Kind::Text(8) },
    Column { name: "length", kind: Kind::Real },
    Column { name: "surveyed", kind: Kind::Real },
];

/// The pieces of break lines that the surface uses, as the layer `breaklines`, with a height at every vertex.
///
/// The attributes are:
/// - `feature`: the number of the feature in the file of break lines
/// - `kind`: `ridge`, `valley` or `edge`
/// - `length`
/// - `surveyed`: the share of the vertices whose height the line gives; contours, streams and the surface give the others
pub fn break_lines(creases: &[Crease]) -> Layer<'_> {
    let rows = creases.iter().map(|crease| {
        let kind = match crease.bend {
            Bend::Either => "edge",
            Bend::Ridge => "ridge",
            Bend::Valley => "valley",
        };
        let cells = vec![
            Cell::Text(crease.feature.to_string().into()),
            Cell::Text(kind.into()),
            Cell::Real(crease.length()),
            Cell::Real(crease.surveyed_share()),
        ];
        Row { shape: Shape::Line(&crease.points), cells }
    });
    Layer { name: "breaklines", geometry: Geometry::Lines, columns: COLUMNS, rows: rows.collect() }
}
