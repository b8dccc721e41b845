//! The layer of areas between levels.

use super::features::{Cell, Column, Geometry, Kind, Layer, Row, Shape};
use tokosen_core::bands::BandArea;

const COLUMNS: &[Column] = &[
    Column { name: "elev_from", kind: Kind::Height },
    Column { name: "elev_to", kind: Kind::Height },
    Column { name: "elev_mid", kind: Kind::Height },
    Column { name: "kind", kind: Kind::Text(12) },
    Column { name: "area_m2", kind: Kind::Real },
    Column { name: "share", kind: Kind::Real },
];

/// The name of the layer of bands between the lines of a layer of contours: `bands_2m` for `contours_2m`.
pub fn bands_layer(contours: &str) -> String {
    contours.replacen("contours", "bands", 1)
}

/// The areas, each with the levels below, above and half-way between, what covers it, its area in square metres and its share.
pub fn of_bands<'a>(name: &'a str, areas: &[BandArea]) -> Layer<'a> {
    let height = |height: Option<f64>| height.map_or(Cell::Null, Cell::Real);
    let rows = areas.iter().map(|area| Row {
        shape: Shape::Area(area.rings.clone()),
        cells: vec![
            height(area.from),
            height(area.to),
            height(area.middle()),
            Cell::Text(area.kind.name().into()),
            Cell::Real(area.area),
            Cell::Real(area.share),
        ],
    });
    Layer { name, geometry: Geometry::Areas, columns: COLUMNS, rows: rows.collect() }
}
