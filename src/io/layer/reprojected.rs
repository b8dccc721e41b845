//! Layers in the coordinates and the unit of heights of the output, if these differ from those inside.

use glam::{DVec2, DVec3};

use super::depths::{depth, with_depths};
use super::features::{Cell, Column, Kind, Layer, Row, Shape, rounded_error};
use tokosen_core::base::error::{Error, Result};
use tokosen_core::base::parallel;
use tokosen_core::crs::FromWorking;

/// A shape that owns its vertices.
enum ReprojectedShape {
    Point(Option<DVec2>),
    Contour(Vec<DVec2>, f64),
    Line(Vec<DVec3>),
    Area(Vec<Vec<DVec2>>),
}

/// The reprojected shapes of layers.
pub(crate) struct ReprojectedShapes {
    shapes: Vec<Vec<ReprojectedShape>>,
    back: FromWorking,
}

impl ReprojectedShapes {
    /// Reprojects all shapes of the layers. Vertices of the input get their input coordinates.
    ///
    /// # Errors
    /// A vertex has no coordinates in the output's system.
    pub fn new(layers: &[Layer<'_>], back: &FromWorking) -> Result<Self> {
        let layer = |layer: &Layer<'_>| -> Result<Vec<ReprojectedShape>> {
            let place = |p: DVec2| {
                let missing = || {
                    let name = back.crs().and_then(|crs| crs.name()).unwrap_or_default();
                    Error::Data(format!("layer {:?}: {:.3} {:.3} has no place in {name}", layer.name, p.x, p.y))
                };
                back.place(p).ok_or_else(missing)
            };
            let flat = |points: &[DVec2]| points.iter().map(|p| place(*p)).collect::<Result<Vec<DVec2>>>();
            let shape = |row: &Row<'_>| {
                Ok(match &row.shape {
                    // A finding stays valid without its place, so a point may lose its coordinates.
                    Shape::Point(point) => ReprojectedShape::Point(point.and_then(|p| back.place(p))),
                    Shape::Contour(points, z) => ReprojectedShape::Contour(flat(points)?, back.height(*z)),
                    Shape::Line(points) => {
                        let place = |p: &DVec3| Ok(place(p.truncate())?.extend(back.height(p.z)));
                        ReprojectedShape::Line(points.iter().map(place).collect::<Result<_>>()?)
                    }
                    Shape::Area(rings) => {
                        ReprojectedShape::Area(rings.iter().map(|ring| flat(ring)).collect::<Result<_>>()?)
                    }
                })
            };
            parallel::map_each(&layer.rows, shape).into_iter().collect()
        };
        Ok(Self { shapes: layers.iter().map(layer).collect::<Result<_>>()?, back: back.clone() })
    }

    /// The layers with the reprojected shapes instead of their own, and with the heights of attributes in the unit of
    /// the output. Attributes of depths are added if the output has them.
    pub fn layers<'a>(&'a mut self, layers: &'a [Layer<'a>]) -> Vec<Layer<'a>> {
        let back = &self.back;
        let row = |(columns, depths): (&[Column], &[usize]),
                   (row, reprojected): (&'a Row<'a>, &'a mut ReprojectedShape)| {
            let shape = match reprojected {
                ReprojectedShape::Point(point) => Shape::Point(*point),
                ReprojectedShape::Contour(points, z) => Shape::Contour(points, *z),
                ReprojectedShape::Line(points) => Shape::Line(points),
                ReprojectedShape::Area(rings) => Shape::Area(std::mem::take(rings)),
            };
            // A cell without a column is refused when the layer is checked.
            let kind = |k: usize| columns.get(k).map(|column| column.kind);
            let mut cells: Vec<Cell<'a>> =
                row.cells.iter().enumerate().map(|(k, cell)| in_unit(cell, kind(k), back)).collect();
            cells.extend(depths.iter().map(|&k| depth(cells.get(k).unwrap_or(&Cell::Null))).collect::<Vec<_>>());
            Row { shape, cells }
        };
        let layer = |(layer, reprojected): (&'a Layer<'a>, &'a mut Vec<ReprojectedShape>)| {
            let own = layer.columns;
            let (columns, depths) = if back.has_depths() { with_depths(own) } else { (own, Vec::new()) };
            let rows = layer.rows.iter().zip(reprojected).map(|pair| row((own, &depths), pair)).collect();
            Layer { name: layer.name, geometry: layer.geometry, columns, rows }
        };
        layers.iter().zip(&mut self.shapes).map(layer).collect()
    }
}

/// A cell with its height, if it holds one, in the unit of the output.
fn in_unit<'a>(cell: &Cell<'a>, kind: Option<Kind>, back: &FromWorking) -> Cell<'a> {
    let unit = back.unit();
    match (cell, kind) {
        (Cell::Real(height), Some(Kind::Height)) => Cell::Real(back.height(*height)),
        (Cell::Real(error), Some(Kind::HeightError)) if unit.is_foot() => Cell::Real(rounded_error(unit.about(*error))),
        _ => cell.clone(),
    }
}
