//! Layers for pickle: what they consist of, and layers made of that again.

use arrow_array::cast::AsArray;
use arrow_array::types::{Float64Type, Int64Type};
use glam::{DVec2, DVec3};
use numpy::{PyArray1, PyArrayMethods};
use pyo3::prelude::*;
use tokosen::contour::Interval;
use tokosen::io::layer::{self, Cell, Column, Geometry, Kind, Row, Shape};

use crate::error::{exception, parameter};
use crate::layer::{Layer, crs_text};
use crate::tiles::Shown;
use crate::unit::{unit as unit_of, unit_name};

/// The values of a column; none where they are missing.
#[derive(FromPyObject, IntoPyObject)]
pub enum Values {
    Flags(Vec<Option<bool>>),
    Ints(Vec<Option<i64>>),
    Reals(Vec<Option<f64>>),
    Texts(Vec<Option<String>>),
}

/// What map tiles show: step and base of the interval, every so many levels an index contour, the unit.
type ShownState = (Option<(f64, f64)>, u32, String);

/// A layer in parts: name, type of geometry, CRS; names, kinds and values of the columns; coordinates; offsets; what map tiles show.
type State<'py> = (
    (String, String, Option<String>),
    Vec<(String, String, Values)>,
    Bound<'py, PyArray1<f64>>,
    Vec<Bound<'py, PyArray1<i32>>>,
    Option<ShownState>,
);

fn name_of(kind: Kind) -> String {
    match kind {
        Kind::Real => "real".into(),
        Kind::Height => "height".into(),
        Kind::HeightError => "height error".into(),
        Kind::Int => "int".into(),
        Kind::Text(most) => format!("text {most}"),
        Kind::LongText => "long text".into(),
        Kind::Bool => "bool".into(),
    }
}

fn kind_of(name: &str) -> Option<Kind> {
    Some(match name {
        "real" => Kind::Real,
        "height" => Kind::Height,
        "height error" => Kind::HeightError,
        "int" => Kind::Int,
        "long text" => Kind::LongText,
        "bool" => Kind::Bool,
        text => Kind::Text(text.strip_prefix("text ")?.parse().ok()?),
    })
}

/// What a layer consists of, for pickle.
#[pyfunction]
pub fn layer_state<'py>(py: Python<'py>, layer: &Layer) -> State<'py> {
    let values = |k: usize, kind: Kind| {
        let array = layer.batch.column(k + 1);
        match kind {
            Kind::Real | Kind::Height | Kind::HeightError => {
                Values::Reals(array.as_primitive::<Float64Type>().iter().collect())
            }
            Kind::Int => Values::Ints(array.as_primitive::<Int64Type>().iter().collect()),
            Kind::Bool => Values::Flags(array.as_boolean().iter().collect()),
            Kind::Text(_) | Kind::LongText => {
                Values::Texts(array.as_string::<i32>().iter().map(|text| text.map(str::to_owned)).collect())
            }
        }
    };
    let column = |(k, column): (usize, &Column)| (column.name.to_owned(), name_of(column.kind), values(k, column.kind));
    let crs = layer.crs.as_ref().and_then(crs_text);
    let head = (layer.name.clone(), layer.geometry_name().to_owned(), crs);
    let coords = PyArray1::from_slice(py, layer.vertices().values());
    let offsets = layer.offset_lists().into_iter().map(|list| PyArray1::from_slice(py, list.offsets())).collect();
    let shown = layer.shown.map(|Shown { interval, index, unit }| {
        (interval.map(|interval| (interval.step, interval.base)), index, unit_name(unit).to_owned())
    });
    (head, layer.columns.iter().enumerate().map(column).collect(), coords, offsets, shown)
}

/// A layer from what [`layer_state`] gave.
#[pyfunction]
pub fn restored_layer(py: Python<'_>, state: State<'_>) -> PyResult<Layer> {
    let (head, given, coords, offsets, shown) = state;
    let ((name, geometry, crs), broken) = (head, || parameter(py, "the parts of the layer do not fit each other"));
    let geometry = match geometry.as_str() {
        "Point" => Geometry::Points,
        "LineString" => Geometry::Lines,
        "Polygon" => Geometry::Areas,
        _ => return Err(broken()),
    };
    let kinds: Option<Vec<(&str, Kind)>> =
        given.iter().map(|(name, kind, _)| Some((name.as_str(), kind_of(kind)?))).collect();
    let columns = layer::columns(&kinds.ok_or_else(broken)?);
    let numbers = coords.try_readonly()?;
    let numbers = numbers.as_slice().map_err(|_| broken())?;
    let lists: Vec<Vec<usize>> = offsets
        .iter()
        .map(|list| Ok(list.try_readonly()?.as_array().iter().map(|at| *at as usize).collect()))
        .collect::<PyResult<_>>()?;
    let flat: Vec<DVec2> = numbers.as_chunks::<2>().0.iter().map(|p| DVec2::from(*p)).collect();
    let solid: Vec<DVec3> = numbers.as_chunks::<3>().0.iter().map(|p| DVec3::from(*p)).collect();
    let shapes: Option<Vec<Shape<'_>>> = match (geometry, lists.as_slice()) {
        (Geometry::Points, []) => Some(flat.iter().map(|p| Shape::Point(Some(*p).filter(|p| p.is_finite()))).collect()),
        (Geometry::Lines, [lines]) => lines.windows(2).map(|w| Some(Shape::Line(solid.get(w[0]..w[1])?))).collect(),
        (Geometry::Areas, [rings, areas]) => {
            let ring = |w: &[usize]| Some(flat.get(w[0]..w[1])?.to_vec());
            let area =
                |w: &[usize]| rings.get(w[0]..=w[1])?.windows(2).map(ring).collect::<Option<Vec<_>>>().map(Shape::Area);
            areas.windows(2).map(area).collect()
        }
        _ => None,
    };
    let shapes = shapes.ok_or_else(broken)?;
    let cell = |values: &Values, k: usize| -> Option<Cell<'static>> {
        Some(match values {
            Values::Reals(all) => all.get(k)?.map_or(Cell::Null, Cell::Real),
            Values::Ints(all) => all.get(k)?.map_or(Cell::Null, Cell::Int),
            Values::Flags(all) => all.get(k)?.map_or(Cell::Null, Cell::Bool),
            Values::Texts(all) => all.get(k)?.clone().map_or(Cell::Null, |text| Cell::Text(text.into())),
        })
    };
    // Python has no whole numbers apart from others where all values are missing.
    let fitted = |cell: Cell<'static>, kind: Kind| match (cell, kind) {
        (Cell::Int(number), Kind::Real | Kind::Height | Kind::HeightError) => Cell::Real(number as f64),
        (cell, _) => cell,
    };
    let rows: Option<Vec<Row<'_>>> = shapes
        .into_iter()
        .enumerate()
        .map(|(k, shape)| {
            let cells =
                given.iter().zip(columns).map(|((_, _, values), column)| Some(fitted(cell(values, k)?, column.kind)));
            Some(Row { shape, cells: cells.collect::<Option<_>>()? })
        })
        .collect();
    let rows = rows.ok_or_else(broken)?;
    let crs = crate::source::crs(py, crs.as_deref())?;
    let layer = layer::Layer { name: &name, geometry, columns, rows };
    let made = Layer::new(&layer, crs.as_ref()).map_err(|error| exception(py, &error))?;
    let shown = shown.map(|(interval, index, unit)| -> PyResult<Shown> {
        let interval = interval.map(|(step, base)| Interval { step, base, rounding: 0.0 });
        Ok(Shown { interval, index, unit: unit_of(py, &unit)? })
    });
    Ok(Layer { shown: shown.transpose()?, ..made })
}
