//! Units of heights by the names that Python uses.

use pyo3::prelude::*;
use tokosen::base::ElevationUnit;

use crate::error::parameter;

/// A unit of heights by its name.
pub fn unit(py: Python<'_>, name: &str) -> PyResult<ElevationUnit> {
    match name {
        "m" => Ok(ElevationUnit::Metre),
        "ft" => Ok(ElevationUnit::Foot),
        "us-ft" => Ok(ElevationUnit::UsSurveyFoot),
        other => Err(parameter(py, format!("the unit is {other:?}; it must be \"m\", \"ft\" or \"us-ft\""))),
    }
}
