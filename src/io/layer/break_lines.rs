//! The layer of given break lines as they are used.

use super::features::{Cell, Column, Geometry, Kind, Layer, Row, Shape};
use tokosen_core::break_lines::{Bend, FittedBreakLine};

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
pub fn break_lines(break_lines: &[FittedBreakLine]) -> Layer<'_> {
    let rows = break_lines.iter().map(|line| {
        let kind = match line.bend {
            Bend::Either => "edge",
            Bend::Ridge => "ridge",
            Bend::Valley => "valley",
        };
        let cells = vec![
            Cell::Text(line.feature.to_string().into()),
            Cell::Text(kind.into()),
            Cell::Real(line.length()),
            Cell::Real(line.surveyed_share()),
        ];
        Row { shape: Shape::Line(&line.points), cells }
    });
    Layer { name: "breaklines", geometry: Geometry::Lines, columns: COLUMNS, rows: rows.collect() }
}
