//! A 3-D model: triangles as numpy arrays.

use std::path::PathBuf;

use numpy::{PyArray1, PyArray2, PyArrayMethods};
use pyo3::prelude::*;
use tokosen::io::mesh::{MESH_EXTENSIONS, SURFACE_EXTENSIONS, write_mesh};
use tokosen::io::{StagedOutput, check_paths};
use tokosen::mesh::Mesh;

use crate::error::{exception, parameter};

/// Triangles in space.
#[pyclass(frozen, module = "tokosen._tokosen")]
pub struct Model(pub Mesh);

#[pymethods]
impl Model {
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
