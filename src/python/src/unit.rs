//! Words and numbers that several arguments of Python take, such as units of heights.

use pyo3::prelude::*;
use tokosen::base::ElevationUnit;

use crate::error::parameter;

/// The units and their names.
const UNITS: [(&str, ElevationUnit); 3] =
    [("m", ElevationUnit::Metre), ("ft", ElevationUnit::Foot), ("us-ft", ElevationUnit::UsSurveyFoot)];

/// A unit of heights by its name.
pub fn unit(py: Python<'_>, name: &str) -> PyResult<ElevationUnit> {
    let found = UNITS.iter().find(|(known, _)| *known == name).map(|(_, unit)| *unit);
    found.ok_or_else(|| parameter(py, format!("the unit is {name:?}; it must be \"m\", \"ft\" or \"us-ft\"")))
}

/// The name of a unit.
pub fn unit_name(unit: ElevationUnit) -> &'static str {
    UNITS.iter().find(|(_, known)| *known == unit).map_or("m", |(name, _)| name)
}

/// The exception for a word that is none of those known.
pub fn one_of(py: Python<'_>, name: &str, given: &str, known: &str) -> PyErr {
    parameter(py, format!("{name} is {given:?}; it must be {known}"))
}

/// The pixels of a terrain tile's side, if there are as many.
pub fn tile_side(py: Python<'_>, side: usize) -> PyResult<usize> {
    match side {
        256 | 512 => Ok(side),
        other => Err(parameter(py, format!("tile_size is {other}; it must be 256 or 512"))),
    }
}
