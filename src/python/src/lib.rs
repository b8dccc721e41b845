//! The extension module of the Python package `tokosen`.
//!
//! It converts between Python's data and those of the library, and calls the library's facade. The package's Python files
//! (`../tokosen`) have the public names, their documentation, and everything that needs other Python packages.
//!
//! | file | holds |
//! |---|---|
//! | `source.rs`, `arrow_input.rs` | what is read: files, features and arrays in memory |
//! | `options.rs`, `unit.rs` | the keyword arguments |
//! | `input.rs` | the input of a terrain, from sources and options |
//! | `terrain.rs`, `verbs.rs`, `flow.rs`, `comparison.rs` | the work |
//! | `layer.rs`, `raster.rs`, `model.rs`, `derived.rs` | results |
//! | `layer_state.rs` | layers for pickle |
//! | `tiles.rs` | map tiles |
//! | `work.rs`, `error.rs` | threads, progress, Ctrl-C; exceptions |

mod arrow_input;
mod comparison;
mod derived;
mod error;
mod flow;
mod input;
mod layer;
mod layer_state;
mod model;
mod options;
mod raster;
mod source;
mod terrain;
mod tiles;
mod unit;
mod verbs;
mod work;

use std::ffi::OsString;

use pyo3::prelude::*;

/// Runs the program `tokosen` with these arguments, the first of which is its name. Returns its exit status; where the program
/// ends early, as for `--help`, the process ends.
#[pyfunction]
fn program(py: Python<'_>, arguments: Vec<OsString>) -> u8 {
    py.detach(|| tokosen::cli::main(arguments))
}

/// What the package's Python files call.
#[pymodule]
fn _tokosen(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add("__version__", env!("CARGO_PKG_VERSION"))?;
    module.add_class::<source::Source>()?;
    module.add_class::<layer::Layer>()?;
    module.add_function(wrap_pyfunction!(layer_state::layer_state, module)?)?;
    module.add_function(wrap_pyfunction!(layer_state::restored_layer, module)?)?;
    module.add_class::<raster::Raster>()?;
    module.add_class::<model::Model>()?;
    module.add_class::<terrain::Terrain>()?;
    module.add_class::<comparison::Comparison>()?;
    module.add_function(wrap_pyfunction!(program, module)?)?;
    module.add_function(wrap_pyfunction!(verbs::check, module)?)?;
    module.add_function(wrap_pyfunction!(verbs::regions, module)?)?;
    module.add_function(wrap_pyfunction!(verbs::skeleton, module)?)?;
    module.add_function(wrap_pyfunction!(verbs::contour, module)?)?;
    module.add_function(wrap_pyfunction!(verbs::bands, module)?)?;
    module.add_function(wrap_pyfunction!(verbs::derive, module)?)?;
    module.add_function(wrap_pyfunction!(comparison::compare, module)?)?;
    module.add_function(wrap_pyfunction!(tiles::viewer, module)?)?;
    Ok(())
}
