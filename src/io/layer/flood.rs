//! The layer of ground under water.

use super::features::{Cell, Column, Geometry, Kind, Layer, Row, Shape};
use tokosen_core::dem::derive::FloodPart;

/// The name of the layer.
pub const FLOOD_LAYER: &str = "flood";

const COLUMNS: &[Column] = &[
    Column { name: "area_m2", kind: Kind::Real },
    Column { name: "volume_m3", kind: Kind::Real },
    Column { name: "depth_max", kind: Kind::Real },
    Column { name: "depth_from", kind: Kind::Real },
    Column { name: "depth_to", kind: Kind::Real },
];

/// The outlines of a flood, as the layer `flood`, each with its area, the volume of its water, its largest depth, and the depths
/// that it lies between, in metres.
pub fn of_flood(parts: &[FloodPart]) -> Layer<'_> {
    let rows = parts.iter().map(|part| Row {
        shape: Shape::Area(part.rings.clone()),
        cells: vec![
            Cell::Real(part.area),
            Cell::Real(part.volume),
            Cell::Real(part.deepest),
            Cell::Real(part.from),
            part.to.map_or(Cell::Null, Cell::Real),
        ],
    });
    Layer { name: FLOOD_LAYER, geometry: Geometry::Areas, columns: COLUMNS, rows: rows.collect() }
}
