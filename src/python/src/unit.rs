//! Units of heights by the names that Python uses.

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
