//! What is derived from a height map, as an object of Python.

use pyo3::prelude::*;

use crate::layer::Layer;
use crate::raster::Raster;

/// What is derived from a height map.
#[derive(IntoPyObject)]
pub enum Derived {
    Raster(Raster),
    Layer(Layer),
}
