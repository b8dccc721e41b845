//! Signs of the unit of elevations that are not certain.

use crate::base::ElevationUnit;

/// What a file lets suppose about the unit of its elevations, without stating it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct UnitHint {
    /// The sign, as a sentence without its full stop: `the field "elev_ft" seems to hold feet`.
    pub says: String,
    /// Whether it is a sign of feet, of either kind. Otherwise of metres.
    pub is_feet: bool,
}

impl UnitHint {
    /// Whether a unit is not the supposed one.
    pub fn contradicts(&self, unit: ElevationUnit) -> bool {
        self.is_feet != unit.is_foot()
    }
}
