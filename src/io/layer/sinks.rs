//! The layer of pits that are left.

use super::features::{Cell, Column, Geometry, Kind, Layer, Row, Shape};
use tokosen_core::drain::Pit;

const COLUMNS: &[Column] = &[
    Column { name: "depth", kind: Kind::Real },
    Column { name: "area", kind: Kind::Real },
    Column { name: "reason", kind: Kind::Text(24) },
    Column { name: "bottom_z", kind: Kind::Height },
    Column { name: "spill_z", kind: Kind::Height },
];

/// Pits that are left, as the layer `sinks`: a point at the deepest place of each.
///
/// The attributes are:
/// - `depth`: from the bottom to the rim, metres; `area`: that of the water that would stay, square metres
/// - `reason`: why it stays, as [`Reason::name`](tokosen_core::drain::Reason::name)
/// - `bottom_z` and `spill_z`: heights of the bottom and of the rim
pub fn pit_points(pits: &[Pit]) -> Layer<'static> {
    let rows = pits.iter().map(|pit| Row {
        shape: Shape::Point(Some(pit.place)),
        cells: vec![
            Cell::Real(pit.spill - pit.bottom),
            Cell::Real(pit.area),
            Cell::Text(pit.reason.name().into()),
            Cell::Real(pit.bottom),
            Cell::Real(pit.spill),
        ],
    });
    Layer { name: "sinks", geometry: Geometry::Points, columns: COLUMNS, rows: rows.collect() }
}
