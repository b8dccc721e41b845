//! The layer of contours.

use super::features::{Cell, Column, Geometry, Kind, Layer, Row, Shape, rounded_error};
use tokosen_core::contour::{ContourLayer, Source};

/// What every layer has.
const COLUMNS: &[Column] = ALL.split_at(5).0;

/// The same columns, with the expected errors of each line.
const WITH_ERRORS: &[Column] = ALL.split_at(8).0;

/// With the kind of each line too.
const ALL: &[Column] = &[
    Column { name: "elev", kind: Kind::Height },
    Column { name: "source", kind: Kind::Text(12) },
    Column { name: "is_index", kind: Kind::Bool },
    Column { name: "depression", kind: Kind::Bool },
    Column { name: "closed", kind: Kind::Bool },
    Column { name: "err_v", kind: Kind::HeightError },
    Column { name: "err_h", kind: Kind::Real },
    Column { name: "inferred", kind: Kind::Bool },
    KIND,
];

/// With the kind of each line, without errors.
const WITH_KIND: &[Column] = &[ALL[0], ALL[1], ALL[2], ALL[3], ALL[4], KIND];

const KIND: Column = Column { name: "kind", kind: Kind::Text(24) };

/// The features of a layer of contours; see [`write_contours`](crate::write_contours) for their attributes.
pub fn of_contours(layer: &ContourLayer) -> Layer<'_> {
    let with_errors = layer.lines.iter().any(|line| line.expected.is_some());
    let with_kind = layer.lines.iter().any(|line| line.kind.is_some());
    let mut rows = Vec::with_capacity(layer.lines.len());
    for line in &layer.lines {
        let source = match line.source {
            Source::Input => "input",
            Source::Interpolated => "interpolated",
            Source::HeightMap => "height_map",
        };
        let mut cells = vec![
            Cell::Real(line.elevation),
            Cell::Text(source.into()),
            Cell::Bool(line.index),
            Cell::Bool(line.depression),
            Cell::Bool(line.is_closed()),
        ];
        if with_errors {
            let rounded = |error: f64| Cell::Real(rounded_error(error));
            cells.extend(match line.expected {
                Some(expected) => {
                    [rounded(expected.vertical), rounded(expected.horizontal), Cell::Bool(expected.inferred)]
                }
                None => [Cell::Null, Cell::Null, Cell::Null],
            });
        }
        if with_kind {
            cells.push(line.kind.map_or(Cell::Null, |kind| Cell::Text(kind.name().into())));
        }
        rows.push(Row { shape: Shape::Contour(&line.points, line.elevation), cells });
    }
    let columns = match (with_errors, with_kind) {
        (true, true) => ALL,
        (true, false) => WITH_ERRORS,
        (false, true) => WITH_KIND,
        (false, false) => COLUMNS,
    };
    Layer { name: &layer.name, geometry: Geometry::Lines, columns, rows }
}
