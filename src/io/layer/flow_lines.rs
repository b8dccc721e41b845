//! The layer of streams that a height map shows.

use super::features::{Cell, Column, Geometry, Kind, Layer, Row, Shape};
use tokosen_core::dem::derive::FlowLine;

/// The name of the layer.
pub const STREAM_LINES_LAYER: &str = "stream_lines";

const COLUMNS: &[Column] = &[
    Column { name: "line", kind: Kind::Int },
    Column { name: "into", kind: Kind::Int },
    Column { name: "strahler", kind: Kind::Int },
    Column { name: "length_m", kind: Kind::Real },
    Column { name: "fall_m", kind: Kind::Real },
    Column { name: "above_m2", kind: Kind::Real },
];

/// The streams of a height map, as the layer `stream_lines`. They run downstream, with a height at every vertex.
///
/// The attributes are:
/// - `line`: the number of the line, from 1; `into`: that of the line that it runs into
/// - `strahler`: the Strahler order
/// - `length_m` and `fall_m`: its length on the map, and how much lower its end is than its beginning, metres
/// - `above_m2`: the area that drains through it at its end, square metres
pub fn of_flow_lines(lines: &[FlowLine]) -> Layer<'_> {
    let number = |k: usize| Cell::Int(i64::try_from(k).unwrap_or(i64::MAX).saturating_add(1));
    let row = |(k, line): (usize, &'_ FlowLine)| {
        vec![
            number(k),
            line.into.map_or(Cell::Null, number),
            Cell::Int(line.strahler.into()),
            Cell::Real(line.length),
            Cell::Real(line.fall()),
            Cell::Real(line.area),
        ]
    };
    let rows =
        lines.iter().enumerate().map(|(k, line)| Row { shape: Shape::Line(&line.points), cells: row((k, line)) });
    Layer { name: STREAM_LINES_LAYER, geometry: Geometry::Lines, columns: COLUMNS, rows: rows.collect() }
}
