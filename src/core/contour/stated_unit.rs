//! Units of elevations that a file states beside them.

use crate::base::ElevationUnit;

/// What a file states about the unit of its elevations, in an attribute beside them or in their text.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct StatedUnit {
    /// The statement, as a sentence without its full stop: `the field "contourunits" states feet`.
    pub says: String,
    /// The unit that the elevations are in. Where units differ from line to line, the reader turned them into metres.
    pub unit: ElevationUnit,
}
