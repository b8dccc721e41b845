//! Features as a result: an Arrow table, which numpy and GeoArrow read without a copy.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use arrow_array::cast::AsArray;
use arrow_array::types::{Float64Type, Int64Type};
use arrow_array::{
    Array, ArrayRef, BooleanArray, FixedSizeListArray, Float64Array, Int64Array, ListArray, RecordBatch, StringArray,
    StructArray,
};
use arrow_buffer::{NullBuffer, OffsetBuffer};
use arrow_schema::{DataType, Field, Schema};
use geoarrow_schema::{CoordType, Dimension, LineStringType, Metadata, PointType, PolygonType};
use glam::{DVec2, DVec3};
use numpy::PyArray1;
use pyo3::IntoPyObjectExt;
use pyo3::exceptions::PyKeyError;
use pyo3::prelude::*;
use pyo3::types::PyCapsule;
use pyo3_arrow::buffer::PyArrowBuffer;
use pyo3_arrow::ffi::{ArrayIterator, to_stream_pycapsule};
use tokosen::base::ElevationUnit;
use tokosen::contour::{ContourLayer, ContourLine, Source};
use tokosen::crs::{Crs, FromWorking};
use tokosen::io::layer::{self, Cell, Column, Geometry, Kind, Outer, Row, Shape};
use tokosen::io::tiles::TileFormat;
use tokosen::io::{StagedOutput, check_paths, with_layers_back, write_layers};

use crate::error::Warned;
use crate::tiles::{Shown, Tiling, contour_tiles};
use crate::work::work;

/// The name of the column of geometries.
const GEOMETRY: &str = "geometry";

/// A layer of features: geometries with attributes.
#[pyclass(frozen, module = "tokosen._tokosen")]
pub struct Layer {
    pub(crate) name: String,
    pub(crate) geometry: Geometry,
    pub(crate) columns: &'static [Column],
    /// The geometries, then the attributes.
    pub(crate) batch: RecordBatch,
    pub(crate) crs: Option<Crs>,
    /// What map tiles show of them, if they are contours.
    pub(crate) shown: Option<Shown>,
}

/// The coordinate reference system as other programs read it: its code if that is known, else its text.
pub fn crs_text(crs: &Crs) -> Option<String> {
    crs.epsg.map(|code| format!("EPSG:{code}")).or_else(|| crs.wkt().map(str::to_owned))
}

impl Layer {
    /// Layers in the coordinates and the unit of heights that `back` converts to.
    pub fn all(layers: &[layer::Layer<'_>], back: &FromWorking) -> tokosen::Result<Vec<Self>> {
        with_layers_back(layers, back, |layers| layers.iter().map(|layer| Self::new(layer, back.crs())).collect())
    }

    /// A layer whose coordinates are in the system `crs`.
    pub fn new(layer: &layer::Layer<'_>, crs: Option<&Crs>) -> tokosen::Result<Self> {
        let named = crs.and_then(crs_text).map(geoarrow_schema::Crs::from_unknown_crs_type).unwrap_or_default();
        let (field, geometries) = geometries(layer, Arc::new(Metadata::new(named, None)))?;
        let mut fields = vec![field];
        let mut arrays = vec![geometries];
        for (k, column) in layer.columns.iter().enumerate() {
            let cells = layer.rows.iter().map(|row| row.cells.get(k).unwrap_or(&Cell::Null));
            let array = attribute(column.kind, cells);
            fields.push(Field::new(column.name, array.data_type().clone(), true));
            arrays.push(array);
        }
        let batch = RecordBatch::try_new(Arc::new(Schema::new(fields)), arrays);
        let batch = batch.map_err(|e| tokosen::Error::Data(format!("the table of {}: {e}", layer.name)))?;
        let (name, crs) = (layer.name.to_owned(), crs.cloned());
        Ok(Self { name, geometry: layer.geometry, columns: layer.columns, batch, crs, shown: None })
    }

    /// The coordinates of all vertices: x, y of points and areas, x, y, z of lines.
    pub(crate) fn vertices(&self) -> &Float64Array {
        let column = self.batch.column(0);
        let vertices = match self.geometry {
            Geometry::Points => column.as_fixed_size_list(),
            Geometry::Lines => column.as_list::<i32>().values().as_fixed_size_list(),
            Geometry::Areas => column.as_list::<i32>().values().as_list::<i32>().values().as_fixed_size_list(),
        };
        vertices.values().as_primitive::<Float64Type>()
    }

    /// The lists of lines, or of rings and of polygons.
    pub(crate) fn offset_lists(&self) -> Vec<&ListArray> {
        let column = self.batch.column(0);
        match self.geometry {
            Geometry::Points => Vec::new(),
            Geometry::Lines => vec![column.as_list::<i32>()],
            Geometry::Areas => {
                let polygons = column.as_list::<i32>();
                vec![polygons.values().as_list::<i32>(), polygons]
            }
        }
    }

    /// The name of the type of geometries.
    pub(crate) fn geometry_name(&self) -> &'static str {
        match self.geometry {
            Geometry::Points => "Point",
            Geometry::Lines => "LineString",
            Geometry::Areas => "Polygon",
        }
    }

    /// The lines as contours, whose heights are in this unit here.
    fn contours(&self, unit: ElevationUnit) -> Option<ContourLayer> {
        let column = |name: &str| Some(self.batch.column(1 + self.columns.iter().position(|c| c.name == name)?));
        let (elevations, index) = (column("elev")?.as_primitive::<Float64Type>(), column("is_index")?.as_boolean());
        let (numbers, lines) = (self.vertices().values(), *self.offset_lists().first()?);
        let line = |(k, w): (usize, &[i32])| ContourLine {
            elevation: unit.metres(elevations.value(k)),
            points: numbers[3 * w[0] as usize..3 * w[1] as usize].chunks_exact(3).map(DVec2::from_slice).collect(),
            source: Source::Interpolated,
            index: index.value(k),
            kind: None,
            depression: false,
            expected: None,
        };
        let lines = lines.offsets().windows(2).enumerate().map(line).collect();
        Some(ContourLayer { name: self.name.clone(), lines, ..ContourLayer::default() })
    }

    /// The features in the form that is written.
    fn with_rows<T>(&self, take: impl FnOnce(&layer::Layer<'_>) -> T) -> T {
        let numbers = self.vertices().values();
        let column = self.batch.column(0);
        let flat = |range: std::ops::Range<usize>| -> Vec<DVec2> {
            numbers[2 * range.start..2 * range.end].chunks_exact(2).map(DVec2::from_slice).collect()
        };
        let lines: Vec<Vec<DVec3>> = match self.geometry {
            Geometry::Lines => {
                let line =
                    |w: &[i32]| numbers[3 * w[0] as usize..3 * w[1] as usize].chunks_exact(3).map(DVec3::from_slice);
                column.as_list::<i32>().offsets().windows(2).map(|w| line(w).collect()).collect()
            }
            Geometry::Points | Geometry::Areas => Vec::new(),
        };
        // A line at one height is a contour: some formats write its height once.
        let is_level = |line: &[DVec3]| line.iter().all(|p| p.z.to_bits() == line[0].z.to_bits());
        let levels: Vec<Option<Vec<DVec2>>> =
            lines.iter().map(|line| is_level(line).then(|| line.iter().map(|p| p.truncate()).collect())).collect();
        let shape = |k: usize| match self.geometry {
            Geometry::Points => Shape::Point(column.is_valid(k).then(|| flat(k..k + 1)[0])),
            Geometry::Lines => match &levels[k] {
                Some(points) if self.name.starts_with("contours") => Shape::Contour(points, lines[k][0].z),
                _ => Shape::Line(&lines[k]),
            },
            Geometry::Areas => {
                let polygons = column.as_list::<i32>();
                let rings = polygons.values().as_list::<i32>().offsets();
                let [from, to] = [k, k + 1].map(|k| polygons.offsets()[k] as usize);
                Shape::Area((from..to).map(|r| flat(rings[r] as usize..rings[r + 1] as usize)).collect())
            }
        };
        let cell = |k: usize, c: usize, kind: Kind| -> Cell<'_> {
            let array = self.batch.column(c + 1);
            if array.is_null(k) {
                return Cell::Null;
            }
            match kind {
                Kind::Real | Kind::Height | Kind::HeightError => {
                    Cell::Real(array.as_primitive::<Float64Type>().value(k))
                }
                Kind::Int => Cell::Int(array.as_primitive::<Int64Type>().value(k)),
                Kind::Text(_) | Kind::LongText => Cell::Text(array.as_string::<i32>().value(k).into()),
                Kind::Bool => Cell::Bool(array.as_boolean().value(k)),
            }
        };
        let cells = |k: usize| self.columns.iter().enumerate().map(|(c, column)| cell(k, c, column.kind)).collect();
        let rows = (0..self.batch.num_rows()).map(|k| Row { shape: shape(k), cells: cells(k) }).collect();
        take(&layer::Layer { name: &self.name, geometry: self.geometry, columns: self.columns, rows })
    }
}

#[pymethods]
impl Layer {
    #[getter]
    fn name(&self) -> &str {
        &self.name
    }

    #[getter]
    fn geometry_type(&self) -> &'static str {
        self.geometry_name()
    }

    #[getter]
    fn crs(&self) -> Option<String> {
        self.crs.as_ref().and_then(crs_text)
    }

    #[getter]
    fn columns(&self) -> Vec<&'static str> {
        self.columns.iter().map(|column| column.name).collect()
    }

    fn __len__(&self) -> usize {
        self.batch.num_rows()
    }

    /// The bytes of all coordinates, without a copy.
    fn coords(&self) -> PyArrowBuffer {
        PyArrowBuffer::new(self.vertices().values().inner().clone())
    }

    /// The bytes of the offsets, without a copy: none for points, of lines, of rings and of polygons.
    fn offsets(&self) -> Vec<PyArrowBuffer> {
        let of = |list: &ListArray| PyArrowBuffer::new(list.offsets().inner().inner().clone());
        self.offset_lists().into_iter().map(of).collect()
    }

    /// An attribute: an array of numbers or of yes and no, or a list of texts. Where whole numbers are missing, they become
    /// floating point with NaN.
    fn column<'py>(&self, py: Python<'py>, name: &str) -> PyResult<Bound<'py, PyAny>> {
        let index = self.columns.iter().position(|column| column.name == name);
        let index = index.ok_or_else(|| PyKeyError::new_err(name.to_owned()))?;
        let array = self.batch.column(index + 1);
        match self.columns[index].kind {
            Kind::Real | Kind::Height | Kind::HeightError => {
                let numbers = array.as_primitive::<Float64Type>().iter().map(|number| number.unwrap_or(f64::NAN));
                Ok(PyArray1::from_iter(py, numbers).into_any())
            }
            Kind::Int if array.null_count() > 0 => {
                let number = |number: Option<i64>| number.map_or(f64::NAN, |number| number as f64);
                let numbers = array.as_primitive::<Int64Type>().iter().map(number);
                Ok(PyArray1::from_iter(py, numbers).into_any())
            }
            Kind::Bool if array.null_count() > 0 => {
                array.as_boolean().iter().collect::<Vec<Option<bool>>>().into_bound_py_any(py)
            }
            Kind::Int => {
                let numbers = array.as_primitive::<Int64Type>().iter().map(Option::unwrap_or_default);
                Ok(PyArray1::from_iter(py, numbers).into_any())
            }
            Kind::Bool => {
                let flags = array.as_boolean().iter().map(Option::unwrap_or_default);
                Ok(PyArray1::from_iter(py, flags).into_any())
            }
            Kind::Text(_) | Kind::LongText => {
                array.as_string::<i32>().iter().collect::<Vec<Option<&str>>>().into_bound_py_any(py)
            }
        }
    }

    #[pyo3(signature = (requested_schema = None))]
    fn __arrow_c_stream__<'py>(
        &self,
        py: Python<'py>,
        requested_schema: Option<Bound<'py, PyCapsule>>,
    ) -> PyResult<Bound<'py, PyCapsule>> {
        let rows = StructArray::from(self.batch.clone());
        let metadata = self.batch.schema_ref().metadata().clone();
        let field = Field::new("", DataType::Struct(rows.fields().clone()), false).with_metadata(metadata);
        let reader = ArrayIterator::new(vec![Ok(Arc::new(rows) as ArrayRef)], Arc::new(field));
        Ok(to_stream_pycapsule(py, Box::new(reader), requested_schema)?)
    }

    /// Writes the layer; contours also as map tiles. Gives what to warn of.
    fn write(&self, py: Python<'_>, path: PathBuf, tiling: Tiling) -> PyResult<Vec<Warned>> {
        work(py, None, |progress| {
            if TileFormat::of(&path).is_none() {
                tiling.check_no_tiles(&path)?;
                return write(&[self], &path, tiling.overwrite).map(|()| Vec::new());
            }
            let what = || tokosen::Error::Parameter(format!("{}: contours alone are map tiles", path.display()));
            let (shown, layer) =
                self.shown.and_then(|shown| Some((shown, self.contours(shown.unit)?))).ok_or_else(what)?;
            let warned = contour_tiles(&layer, self.crs.as_ref(), shown, &path, &tiling, progress)?;
            Ok(warned.into_iter().collect())
        })
    }
}

/// Writes layers to one file, or to a file each where the format holds one layer.
pub fn write(layers: &[&Layer], path: &Path, overwrite: bool) -> tokosen::Result<()> {
    let names: Vec<&str> = layers.iter().map(|layer| layer.name.as_str()).collect();
    let files = tokosen::io::contour_files(path, &names)?;
    let planned = |path| tokosen::io::PlannedOutput { path, layers: &names };
    check_paths(&[], &files.iter().map(|path| planned(path.as_path())).collect::<Vec<_>>(), overwrite)?;
    let staged = StagedOutput::create(path)?;
    for layer in layers {
        layer.with_rows(|rows| write_layers(&staged, std::slice::from_ref(rows), layer.crs.as_ref()))?;
    }
    staged.commit()?;
    Ok(())
}

/// Offsets as Arrow has them.
fn offsets(lengths: impl Iterator<Item = usize>) -> tokosen::Result<OffsetBuffer<i32>> {
    let mut all = vec![0_i32];
    let mut sum = 0_usize;
    for length in lengths {
        sum += length;
        let too_many = |_| tokosen::Error::Data(format!("{sum} vertices are too many for one Arrow table"));
        all.push(i32::try_from(sum).map_err(too_many)?);
    }
    Ok(OffsetBuffer::new(all.into()))
}

/// A column of geometries, with its field.
fn geometries(layer: &layer::Layer<'_>, metadata: Arc<Metadata>) -> tokosen::Result<(Field, ArrayRef)> {
    let child = |kind: &DataType| match kind {
        DataType::List(field) | DataType::FixedSizeList(field, _) => Arc::clone(field),
        _ => unreachable!("geometries of GeoArrow are lists of lists"),
    };
    let coordinates = |kind: &DataType, width: i32, numbers: Vec<f64>, nulls: Option<NullBuffer>| {
        FixedSizeListArray::new(child(kind), width, Arc::new(Float64Array::from(numbers)), nulls)
    };
    match layer.geometry {
        Geometry::Points => {
            let kind = PointType::new(Dimension::XY, metadata).with_coord_type(CoordType::Interleaved);
            let place = |row: &Row<'_>| if let Shape::Point(place) = row.shape { place } else { None };
            let nulls = NullBuffer::from_iter(layer.rows.iter().map(|row| place(row).is_some()));
            let numbers = layer.rows.iter().flat_map(|row| place(row).unwrap_or(DVec2::NAN).to_array()).collect();
            let points = coordinates(&kind.data_type(), 2, numbers, Some(nulls));
            Ok((kind.to_field(GEOMETRY, true), Arc::new(points)))
        }
        Geometry::Lines => {
            let kind = LineStringType::new(Dimension::XYZ, metadata).with_coord_type(CoordType::Interleaved);
            let lengths = layer.rows.iter().map(|row| match &row.shape {
                Shape::Contour(points, _) => points.len(),
                Shape::Line(points) => points.len(),
                Shape::Point(_) | Shape::Area(_) => 0,
            });
            let offsets = offsets(lengths)?;
            let mut numbers = Vec::with_capacity(3 * offsets.last().map_or(0, |last| *last as usize));
            for row in &layer.rows {
                match &row.shape {
                    Shape::Contour(points, z) => points.iter().for_each(|p| numbers.extend([p.x, p.y, *z])),
                    Shape::Line(points) => points.iter().for_each(|p| numbers.extend(p.to_array())),
                    Shape::Point(_) | Shape::Area(_) => {}
                }
            }
            let vertices = child(&kind.data_type());
            let coordinates = coordinates(vertices.data_type(), 3, numbers, None);
            let lines = ListArray::new(vertices, offsets, Arc::new(coordinates), None);
            Ok((kind.to_field(GEOMETRY, true), Arc::new(lines)))
        }
        Geometry::Areas => {
            let kind = PolygonType::new(Dimension::XY, metadata).with_coord_type(CoordType::Interleaved);
            let rings: Vec<Vec<Vec<DVec2>>> = (layer.rows.iter())
                .map(|row| row.shape.rings(Outer::Counterclockwise).map(Iterator::collect).collect())
                .collect();
            let of_polygons = offsets(rings.iter().map(Vec::len))?;
            let of_rings = offsets(rings.iter().flatten().map(Vec::len))?;
            let numbers = rings.iter().flatten().flatten().flat_map(|p| p.to_array()).collect();
            let ring = child(&kind.data_type());
            let vertices = child(ring.data_type());
            let coordinates = coordinates(vertices.data_type(), 2, numbers, None);
            let lists = ListArray::new(vertices, of_rings, Arc::new(coordinates), None);
            let polygons = ListArray::new(ring, of_polygons, Arc::new(lists), None);
            Ok((kind.to_field(GEOMETRY, true), Arc::new(polygons)))
        }
    }
}

/// A column of attributes.
fn attribute<'a>(kind: Kind, cells: impl Iterator<Item = &'a Cell<'a>>) -> ArrayRef {
    match kind {
        Kind::Real | Kind::Height | Kind::HeightError => {
            Arc::new(Float64Array::from_iter(cells.map(|cell| match cell {
                Cell::Real(number) => Some(*number),
                _ => None,
            })))
        }
        Kind::Int => Arc::new(Int64Array::from_iter(cells.map(|cell| match cell {
            Cell::Int(number) => Some(*number),
            _ => None,
        }))),
        Kind::Bool => Arc::new(BooleanArray::from_iter(cells.map(|cell| match cell {
            Cell::Bool(flag) => Some(*flag),
            _ => None,
        }))),
        Kind::Text(_) | Kind::LongText => Arc::new(StringArray::from_iter(cells.map(|cell| match cell {
            Cell::Text(text) => Some(text.as_ref()),
            _ => None,
        }))),
    }
}
