//! The layers of a repaired map: its contours and its spot heights.

use std::path::Path;

use super::features::{Cell, Column, Geometry, Kind, Layer, Row, Shape};
use crate::format::VectorFormat;
use tokosen_core::contour::ContourMap;

/// The names of the layers: contours and spot heights.
pub const REPAIRED_LAYERS: [&str; 2] = ["contours", "spot_heights"];

const LINE_COLUMNS: &[Column] = &[
    Column { name: "elev", kind: Kind::Height },
    Column { name: "feature", kind: Kind::Int },
    Column { name: "depression", kind: Kind::Bool },
];

const SPOT_COLUMNS: &[Column] = &[Column { name: "elev", kind: Kind::Height }];

/// The contours of a map.
///
/// The attributes are `elev`, `feature` (the feature's number in its file; the smallest one of a joined line) and
/// `depression` (the mark in the input, if there is one).
pub fn of_map(map: &ContourMap) -> Layer<'_> {
    let rows = map.contours.iter().map(|line| Row {
        shape: Shape::Contour(&line.points, line.elevation),
        cells: vec![
            Cell::Real(line.elevation),
            i64::try_from(line.feature.number()).map_or(Cell::Null, Cell::Int),
            map.depressions.get(&line.feature).map_or(Cell::Null, |&mark| Cell::Bool(mark)),
        ],
    });
    Layer { name: REPAIRED_LAYERS[0], geometry: Geometry::Lines, columns: LINE_COLUMNS, rows: rows.collect() }
}

/// The spot heights of a map, as points with the attribute `elev`.
pub fn of_spots(map: &ContourMap) -> Layer<'_> {
    let rows = map
        .spots
        .iter()
        .map(|spot| Row { shape: Shape::Point(Some(spot.truncate())), cells: vec![Cell::Real(spot.z)] });
    Layer { name: REPAIRED_LAYERS[1], geometry: Geometry::Points, columns: SPOT_COLUMNS, rows: rows.collect() }
}

/// The layers of a repaired map for a file: its contours and, where the format holds points beside lines, its spot heights.
pub fn of_repaired<'a>(map: &'a ContourMap, path: &Path) -> Vec<Layer<'a>> {
    let mut layers = vec![of_map(map)];
    if !map.spots.is_empty() && holds_spots(path) {
        layers.push(of_spots(map));
    }
    layers
}

/// Whether a file of that name holds points beside lines: only a GeoPackage does.
pub fn holds_spots(path: &Path) -> bool {
    matches!(VectorFormat::from_path(path), Ok(VectorFormat::GeoPackage))
}
