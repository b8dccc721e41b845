//! The layer of catchments.

use super::features::{Cell, Column, Geometry, Kind, Layer, Row, Shape};
use tokosen_core::dem::derive::{CatchmentPart, Outlet};

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

const OF_OUTLETS: &[Column] = &[
    Column { name: "catchment", kind: Kind::Int },
    Column { name: "area_m2", kind: Kind::Real },
    Column { name: "above_m2", kind: Kind::Real },
    Column { name: "outlet_x", kind: Kind::Real },
    Column { name: "outlet_y", kind: Kind::Real },
    Column { name: "moved_m", kind: Kind::Real },
];

/// The outlines of catchments above outlets.
///
/// The attributes are those of [`of_catchments`] and:
/// - `above_m2`: the area of all ground above the outlet, with the catchments of outlets further up
/// - `moved_m`: how far the outlet was moved to its stream
pub fn of_outlets<'a>(parts: &'a [CatchmentPart], outlets: &[Outlet]) -> Layer<'a> {
    let row = |part: &'a CatchmentPart| {
        let outlet = outlets.get((part.catchment as usize).wrapping_sub(1));
        let of = |value: fn(&Outlet) -> f64| outlet.map_or(Cell::Null, |outlet| Cell::Real(value(outlet)));
        Row {
            shape: Shape::Area(part.rings.clone()),
            cells: vec![
                Cell::Int(part.catchment.into()),
                Cell::Real(part.area),
                of(|outlet| outlet.area),
                Cell::Real(part.outlet.x),
                Cell::Real(part.outlet.y),
                of(|outlet| outlet.moved),
            ],
        }
    };
    let rows = parts.iter().map(row).collect();
    Layer { name: CATCHMENTS_LAYER, geometry: Geometry::Areas, columns: OF_OUTLETS, rows }
}
