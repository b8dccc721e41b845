//! A height map: heights on a grid of cells.

use crate::base::Grid;
use crate::crs::Crs;

/// Heights at the cell centres of a [`Grid`].
#[derive(Debug, Clone, PartialEq)]
pub struct Dem {
    /// The grid of cells.
    pub grid: Grid,
    /// Heights in metres, row by row from the north-west; NaN where there is no data.
    pub values: Vec<f32>,
    /// The coordinate reference system, if known.
    pub crs: Option<Crs>,
}
