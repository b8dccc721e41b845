//! What is read: files, or features and arrays in memory.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use glam::DVec3;
use numpy::{PyArrayDyn, PyReadonlyArray1, PyReadonlyArray2, PyUntypedArrayMethods};
use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyList};
use pyo3_arrow::PyTable;
use tokosen::crs::Crs;
use tokosen::io::{Attribute, InMemory, MemoryLayer, VectorSource};

use crate::arrow_input;
use crate::error::{exception, parameter};

/// A source of lines, points or polygons.
#[pyclass(frozen, module = "tokosen._tokosen")]
pub struct Source(Given);

/// What a source is made of.
#[derive(Clone)]
pub enum Given {
    /// A file, or features in memory.
    Vector(VectorSource),
    /// Contours as ragged arrays.
    Lines(Arc<Lines>),
    /// Points with heights.
    Points(Arc<[DVec3]>, Option<Crs>),
}

/// Contours as ragged arrays.
pub struct Lines {
    pub coords: Vec<[f64; 2]>,
    pub offsets: Vec<usize>,
    pub elevations: Vec<f64>,
    pub crs: Option<Crs>,
}

impl Source {
    /// What it is made of.
    pub fn given(&self) -> &Given {
        &self.0
    }

    /// The source as a vector file or features. `what` names the argument.
    pub fn vector(&self, py: Python<'_>, what: &str) -> PyResult<VectorSource> {
        match &self.0 {
            Given::Vector(source) => Ok(source.clone()),
            Given::Lines(_) | Given::Points(..) => {
                Err(parameter(py, format!("{what} cannot be given as arrays; take a file or a GeoDataFrame")))
            }
        }
    }

    /// The path, if it is a file.
    pub fn path(&self) -> Option<&Path> {
        match &self.0 {
            Given::Vector(source) if source.features.is_none() => Some(&source.path),
            _ => None,
        }
    }
}

/// A coordinate reference system as text.
pub fn crs(py: Python<'_>, text: Option<&str>) -> PyResult<Option<Crs>> {
    let read = text.map(Crs::from_text).transpose();
    read.map_err(|why| parameter(py, format!("the coordinate reference system {:?}: {why}", text.unwrap_or_default())))
}

#[pymethods]
impl Source {
    /// A file; a layer may follow its name, as in QGIS.
    #[staticmethod]
    fn file(py: Python<'_>, path: PathBuf) -> PyResult<Self> {
        let source = match path.to_str() {
            Some(text) => VectorSource::from_text(text).map_err(|why| parameter(py, why))?,
            None => VectorSource::from(path),
        };
        Ok(Self(Given::Vector(source)))
    }

    /// The text of a GeoJSON file.
    #[staticmethod]
    fn geojson(name: &str, text: &Bound<'_, PyBytes>) -> Self {
        let features = InMemory::geojson(text.as_bytes().to_vec());
        Self(Given::Vector(VectorSource::in_memory(name, features)))
    }

    /// Features: a geometry each as WKB or None, and attributes: arrays of numbers, or lists of texts and None.
    #[staticmethod]
    #[pyo3(signature = (name, wkb, attributes, crs))]
    fn features(
        py: Python<'_>,
        name: &str,
        wkb: &Bound<'_, PyList>,
        attributes: Vec<(String, Values<'_>)>,
        crs: Option<&str>,
    ) -> PyResult<Self> {
        let mut features = MemoryLayer { crs: self::crs(py, crs)?, offsets: vec![0], ..MemoryLayer::default() };
        for geometry in wkb {
            if !geometry.is_none() {
                features.wkb.extend_from_slice(geometry.cast::<PyBytes>()?.as_bytes());
            }
            features.offsets.push(features.wkb.len());
        }
        for (attribute, values) in attributes {
            features.attributes.push((attribute, values.attribute()?));
        }
        Ok(Self(Given::Vector(VectorSource::in_memory(name, features.into()))))
    }

    /// An Arrow table whose geometries are GeoArrow or WKB.
    #[staticmethod]
    #[pyo3(signature = (name, table, crs))]
    fn arrow(py: Python<'_>, name: &str, table: PyTable, crs: Option<&str>) -> PyResult<Self> {
        let (batches, schema) = table.into_inner();
        let features =
            arrow_input::features(&batches, &schema).map_err(|why| parameter(py, format!("{name}: {why}")))?;
        let named = self::crs(py, crs)?;
        let features = MemoryLayer { crs: named.or(features.crs), ..features };
        Ok(Self(Given::Vector(VectorSource::in_memory(name, features.into()))))
    }

    /// Contours as ragged arrays: coordinates (n, 2), offsets (lines + 1), elevations (lines).
    #[staticmethod]
    #[pyo3(signature = (coords, offsets, elevations, crs))]
    fn lines(
        py: Python<'_>,
        coords: PyReadonlyArray2<'_, f64>,
        offsets: PyReadonlyArray1<'_, i64>,
        elevations: PyReadonlyArray1<'_, f64>,
        crs: Option<&str>,
    ) -> PyResult<Self> {
        if coords.shape()[1] != 2 {
            let [rows, columns] = [coords.shape()[0], coords.shape()[1]];
            return Err(parameter(
                py,
                format!("the coordinates have the shape ({rows}, {columns}); it must be (n, 2)"),
            ));
        }
        let offset = |k: &i64| usize::try_from(*k).map_err(|_| parameter(py, format!("the offset {k} is below 0")));
        let lines = Lines {
            coords: coords.as_array().rows().into_iter().map(|row| [row[0], row[1]]).collect(),
            offsets: offsets.as_array().iter().map(offset).collect::<PyResult<_>>()?,
            elevations: elevations.as_array().iter().copied().collect(),
            crs: self::crs(py, crs)?,
        };
        Ok(Self(Given::Lines(Arc::new(lines))))
    }

    /// Points with heights: (n, 3).
    #[staticmethod]
    #[pyo3(signature = (points, crs))]
    fn points(py: Python<'_>, points: PyReadonlyArray2<'_, f64>, crs: Option<&str>) -> PyResult<Self> {
        if points.shape()[1] != 3 {
            let [rows, columns] = [points.shape()[0], points.shape()[1]];
            return Err(parameter(py, format!("the points have the shape ({rows}, {columns}); it must be (n, 3)")));
        }
        let points = points.as_array().rows().into_iter().map(|row| DVec3::new(row[0], row[1], row[2])).collect();
        Ok(Self(Given::Points(points, self::crs(py, crs)?)))
    }
}

/// The values of an attribute.
#[derive(FromPyObject)]
enum Values<'py> {
    Numbers(Bound<'py, PyArrayDyn<f64>>),
    Texts(Vec<Option<String>>),
}

impl Values<'_> {
    fn attribute(self) -> PyResult<Attribute> {
        Ok(match self {
            Self::Numbers(array) => {
                let array: PyReadonlyArray1<'_, f64> = array.extract().map_err(|_| {
                    PyTypeError::new_err("the values of an attribute must be an array of one dimension")
                })?;
                Attribute::Numbers(array.as_array().iter().copied().collect())
            }
            Self::Texts(values) => Attribute::Texts(values),
        })
    }
}

/// The sources of contours: several files are one map.
pub fn sources(py: Python<'_>, given: &[PyRef<'_, Source>]) -> PyResult<Vec<VectorSource>> {
    let mut all = Vec::new();
    for source in given {
        let expanded = source.vector(py, "several maps of contours")?.expand();
        all.extend(expanded.map_err(|error| exception(py, &error))?);
    }
    Ok(all)
}
