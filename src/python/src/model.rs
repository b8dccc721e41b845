//! A 3-D model: triangles as numpy arrays.

use std::path::PathBuf;

use glam::{DVec3, Vec3};
use numpy::{PyArray1, PyArray2, PyArrayMethods};
use pyo3::prelude::*;
use tokosen::crs::LengthUnit;
use tokosen::io::mesh::{MESH_EXTENSIONS, SURFACE_EXTENSIONS, write_mesh};
use tokosen::io::{StagedOutput, check_paths};
use tokosen::mesh::Mesh;

use crate::error::{exception, parameter};
use crate::layer::crs_text;

/// Triangles in space.
#[pyclass(frozen, module = "tokosen._tokosen")]
pub struct Model(pub Mesh);

/// What a model consists of: origin, vertices, normals, triangles, break lines, height of the bottom, CRS, name and size of the
/// unit.
type State<'py> = (
    [f64; 3],
    Bound<'py, PyArray2<f64>>,
    Bound<'py, PyArray2<f32>>,
    Bound<'py, PyArray2<u32>>,
    Vec<Vec<[f64; 3]>>,
    Option<f64>,
    Option<String>,
    Option<(String, f64)>,
);

#[pymethods]
impl Model {
    /// A model from what [`Model::state`] gave.
    #[staticmethod]
    fn restore(py: Python<'_>, state: State<'_>) -> PyResult<Self> {
        let (origin, vertices, normals, triangles, break_lines, base, crs, unit) = state;
        let crs = crate::source::crs(py, crs.as_deref())?;
        let unit = unit.map(|(name, metres)| LengthUnit { name, metres });
        let mesh = Mesh {
            origin: origin.into(),
            vertices: rows(&vertices)?.into_iter().map(DVec3::from).collect(),
            normals: rows(&normals)?.into_iter().map(Vec3::from).collect(),
            triangles: rows(&triangles)?,
            break_lines: break_lines.into_iter().map(|line| line.into_iter().map(DVec3::from).collect()).collect(),
            base,
            crs,
            unit,
        };
        let count = mesh.vertices.len();
        match mesh.triangles.iter().flatten().all(|corner| (*corner as usize) < count) && mesh.normals.len() == count {
            true => Ok(Self(mesh)),
            false => Err(parameter(py, "the parts of the model do not fit each other")),
        }
    }

    /// What the model consists of, for pickle.
    fn state<'py>(&self, py: Python<'py>) -> PyResult<State<'py>> {
        let Mesh { origin, vertices, normals, break_lines, base, crs, unit, .. } = &self.0;
        Ok((
            origin.to_array(),
            PyArray1::from_iter(py, vertices.iter().flat_map(|v| v.to_array())).reshape([vertices.len(), 3])?,
            PyArray1::from_iter(py, normals.iter().flat_map(|v| v.to_array())).reshape([normals.len(), 3])?,
            self.triangles(py)?,
            break_lines.iter().map(|line| line.iter().map(|p| p.to_array()).collect()).collect(),
            *base,
            crs.as_ref().and_then(crs_text),
            unit.as_ref().map(|unit| (unit.name.clone(), unit.metres)),
        ))
    }

    /// The vertices (n, 3): x, y and height, map coordinates. A new array.
    fn vertices<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let flat = self.0.vertices.iter().flat_map(|v| (*v + self.0.origin).to_array()).collect();
        PyArray1::from_vec(py, flat).reshape([self.0.vertices.len(), 3])
    }

    /// The triangles (n, 3): indices of vertices. A new array.
    fn triangles<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<u32>>> {
        PyArray1::from_vec(py, self.0.triangles.as_flattened().to_vec()).reshape([self.0.triangles.len(), 3])
    }

    #[getter]
    fn is_solid(&self) -> bool {
        self.0.base.is_some()
    }

    fn write(&self, py: Python<'_>, path: PathBuf, overwrite: bool) -> PyResult<()> {
        let extension = path.extension().and_then(|e| e.to_str()).unwrap_or_default().to_ascii_lowercase();
        let known = [MESH_EXTENSIONS.as_slice(), &SURFACE_EXTENSIONS].concat();
        if !known.contains(&extension.as_str()) {
            let known = known.iter().map(|e| format!(".{e}")).collect::<Vec<_>>().join(", ");
            return Err(parameter(py, format!("{}: models are written as {known}", path.display())));
        }
        let write = || {
            check_paths(&[], &[path.as_path().into()], overwrite)?;
            let staged = StagedOutput::create(&path)?;
            write_mesh(&staged.path(), &self.0).map_err(|error| staged.with_final_name(error))?;
            staged.commit().map(drop)
        };
        py.detach(write).map_err(|error| exception(py, &error))
    }
}

/// The rows of an array (n, 3).
fn rows<T: numpy::Element + Copy>(array: &Bound<'_, PyArray2<T>>) -> PyResult<Vec<[T; 3]>> {
    let array = array.try_readonly()?;
    let values: Vec<T> = array.as_array().iter().copied().collect();
    Ok(values.as_chunks::<3>().0.to_vec())
}
