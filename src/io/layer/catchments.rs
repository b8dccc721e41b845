//! The layer of catchments.

use super::features::{Cell, Column, Geometry, Kind, Layer, Row, Shape};
use tokosen_core::dem::derive::CatchmentPart;

/// The name of the layer.
pub const CATCHMENTS_LAYER: &str = "catchments";

const COLUMNS: &[Column] = &[
    Column { name: "catchment", kind: Kind::Int },
    Column { name: "area_m2", kind: Kind::Real },
    Column { name: "outlet_x", kind: Kind::Real },
    Column { name: "outlet_y", kind: Kind::Real },
];

/// The outlines of catchments.
pub fn of_catchments(parts: &[CatchmentPart]) -> Layer<'_> {
    let rows = parts.iter().map(|part| Row {
        shape: Shape::Area(part.rings.clone()),
        cells: vec![
            Cell::Int(part.catchment.into()),
            Cell::Real(part.area),
            Cell::Real(part.outlet.x),
            Cell::Real(part.outlet.y),
        ],
    });
    Layer { name: CATCHMENTS_LAYER, geometry: Geometry::Areas, columns: COLUMNS, rows: rows.collect() }
}
