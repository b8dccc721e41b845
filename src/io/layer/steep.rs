//! The layer of steep places.

use super::features::{Cell, Column, Geometry, Kind, Layer, Row, Shape};
use tokosen_core::dem::derive::Steeps;

/// Longest note, bytes: the limit of a shapefile's attribute table.
const NOTE_LENGTH: u8 = 254;

/// The name of the layer.
pub const STEEP_LAYER: &str = "steep";

const COLUMNS: &[Column] = &[
    Column { name: "area_id", kind: Kind::Int },
    Column { name: "area_m2", kind: Kind::Real },
    Column { name: "height_m", kind: Kind::Real },
    Column { name: "slope_mean", kind: Kind::Real },
    Column { name: "slope_max", kind: Kind::Real },
    Column { name: "note", kind: Kind::Text(NOTE_LENGTH) },
];

/// The steep areas, each with a note for the user of at most 254 bytes.
pub fn steep_areas<'a>(steeps: &'a Steeps, note: &'a str) -> Layer<'a> {
    let rows = steeps.parts.iter().map(|part| Row {
        shape: Shape::Area(part.rings.clone()),
        cells: vec![
            Cell::Int(part.area_id.into()),
            Cell::Real(part.area),
            Cell::Real(part.height),
            Cell::Real(part.slope_mean),
            Cell::Real(part.slope_max),
            Cell::Text(note.into()),
        ],
    });
    Layer { name: STEEP_LAYER, geometry: Geometry::Areas, columns: COLUMNS, rows: rows.collect() }
}
