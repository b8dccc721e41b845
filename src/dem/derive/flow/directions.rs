//! The neighbour that each cell drains to, by a flood from the outlets.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use glam::DVec2;

use crate::base::Grid;
use crate::base::error::{Error, Result};
use crate::crs::Crs;
use crate::dem::{Dem, GroundScale};

/// The neighbours of a cell as steps of columns and rows, from the east clockwise. Neighbour `k` has the code `1 << k`.
const STEPS: [(isize, isize); 8] = [(1, 0), (1, 1), (0, 1), (-1, 1), (-1, 0), (-1, -1), (0, -1), (1, -1)];

/// The neighbour of an outlet.
const OUTLET: u8 = 8;
/// The neighbour of a cell without data.
const NO_DATA: u8 = 9;
/// The neighbour of a cell that the flood has not reached yet.
const UNREACHED: u8 = 10;

/// The neighbour that each cell of a height map drains to.
#[derive(Debug, Clone, PartialEq)]
pub struct FlowDirections {
    grid: Grid,
    crs: Option<Crs>,
    /// Index of the neighbour in [`STEPS`], or [`OUTLET`] or [`NO_DATA`].
    towards: Vec<u8>,
}

impl FlowDirections {
    /// The grid of the height map.
    pub fn grid(&self) -> &Grid {
        &self.grid
    }

    /// Whether the cell has a height.
    pub fn has_data(&self, cell: usize) -> bool {
        self.towards[cell] != NO_DATA
    }

    /// The cell that this cell drains to. `None` for an outlet, and for a cell without data.
    pub fn downstream(&self, cell: usize) -> Option<usize> {
        let step = STEPS.get(usize::from(self.towards[cell]))?;
        cell.checked_add_signed(step.1 * self.grid.cols as isize + step.0)
    }

    /// The directions as a raster of the usual codes: 1 east, 2 south-east, 4 south, 8 south-west, 16 west, 32 north-west,
    /// 64 north, 128 north-east, 0 an outlet. NaN without data.
    pub fn raster(&self) -> Dem {
        let code = |&towards: &u8| match towards {
            NO_DATA => f32::NAN,
            OUTLET => 0.0,
            k => f32::from(1_u8 << k),
        };
        self.with(self.towards.iter().map(code).collect())
    }

    /// The coordinate reference system of the height map.
    pub(super) fn crs(&self) -> Option<&Crs> {
        self.crs.as_ref()
    }

    /// A raster of other values on the same grid.
    pub(super) fn with(&self, values: Vec<f32>) -> Dem {
        Dem { grid: self.grid, values, crs: self.crs.clone() }
    }
}

/// Finds the neighbour among eight that each cell drains to (D8), so that every cell drains to an outlet.
///
/// Outlets are at the border of the height map and beside cells without data. From there a flood rises over the map
/// (priority-flood: Barnes, Lehman and Mulla 2014, Computers & Geosciences 62). It takes the cell with the lowest flooded
/// height next, and in a pit the lowest ground first, as in GRASS (Metz, Mitasova and Harmon 2011). A cell drains along the
/// steepest descent (O'Callaghan and Mark 1984) to a neighbour that the flood took before it. Without a lower one, it
/// drains to the neighbour from which the flood reached it. So pits drain along their lowest ground to the lowest point
/// of their rim, level ground drains the shortest way, and no height is changed. `scale` gives the distances, as cells
/// need not be square.
///
/// The time is in proportion to n log n for n cells. The memory is two bytes per cell, and sixteen per cell of the
/// flood's edge.
///
/// # Errors
/// [`Error::Parameter`] if the values do not fit the grid, or if there are more cells than 32 bits count.
pub fn flow_directions(dem: &Dem, scale: &GroundScale) -> Result<FlowDirections> {
    let Grid { cols, rows, cell: size, .. } = dem.grid;
    if cols.checked_mul(rows) != Some(dem.values.len()) {
        let count = dem.values.len();
        return Err(Error::Parameter(format!("a height map of {cols} x {rows} cells cannot have {count} values")));
    }
    if u32::try_from(dem.values.len()).is_err() {
        return Err(Error::Parameter(format!(
            "a height map of {cols} x {rows} cells is too large for flow directions"
        )));
    }
    let has_data = |cell: usize| dem.values[cell].is_finite();
    let neighbours = |cell: usize| neighbours(cell, cols, rows);
    let is_outlet = |cell: usize| neighbours(cell).flatten().filter(|(_, near)| has_data(*near)).count() < STEPS.len();

    let mut towards: Vec<u8> = dem.values.iter().map(|h| if h.is_finite() { UNREACHED } else { NO_DATA }).collect();
    let mut is_taken = vec![false; dem.values.len()];
    let mut flood = Flood::default();
    for cell in (0..dem.values.len()).filter(|&cell| has_data(cell) && is_outlet(cell)) {
        towards[cell] = OUTLET;
        flood.push(cell, dem.values[cell], f32::NEG_INFINITY);
    }
    while let Some((cell, level)) = flood.pop() {
        is_taken[cell] = true;
        let height = dem.values[cell];
        let DVec2 { x, y } = size * scale.row(cell / cols);
        // To the neighbours on a column, diagonally, and on a row.
        let distances = [y, x.hypot(y), x];
        let mut steepest = 0.0;
        for (k, near) in neighbours(cell).flatten() {
            if towards[near] == UNREACHED {
                towards[near] = ((k + 4) % 8) as u8;
                flood.push(near, dem.values[near], level);
            } else if is_taken[near] {
                let (col, row) = STEPS[k];
                let distance = if row == 0 { distances[2] } else { distances[col.unsigned_abs()] };
                let descent = (f64::from(height) - f64::from(dem.values[near])) / distance;
                if descent > steepest {
                    (steepest, towards[cell]) = (descent, k as u8);
                }
            }
        }
    }
    Ok(FlowDirections { grid: dem.grid, crs: dem.crs.clone(), towards })
}

/// The neighbours of a cell with their index in [`STEPS`]; `None` beyond the border.
fn neighbours(cell: usize, cols: usize, rows: usize) -> impl Iterator<Item = Option<(usize, usize)>> {
    let (col, row) = (cell % cols, cell / cols);
    STEPS.iter().enumerate().map(move |(k, step)| {
        let col = col.checked_add_signed(step.0).filter(|col| *col < cols)?;
        let row = row.checked_add_signed(step.1).filter(|row| *row < rows)?;
        Some((k, row * cols + col))
    })
}

/// The cells at the flood's edge, the next one first.
#[derive(Default)]
struct Flood {
    /// Flooded height and height of the ground as one sortable number, then the cell's turn, then the cell. Cells of one
    /// height are taken in turn, so that level ground is flooded evenly from its edge.
    edge: BinaryHeap<Reverse<(u64, u32, u32)>>,
    turn: u32,
}

impl Flood {
    /// Adds a cell that the flood reaches from a neighbour, which was flooded to `level`.
    fn push(&mut self, cell: usize, height: f32, level: f32) {
        let key = u64::from(sortable(height.max(level))) << 32 | u64::from(sortable(height));
        // There are no more cells than 32 bits count, and each is added once.
        self.edge.push(Reverse((key, self.turn, cell as u32)));
        self.turn += 1;
    }

    /// The next cell, and the height to which it is flooded.
    fn pop(&mut self) -> Option<(usize, f32)> {
        let Reverse((key, _, cell)) = self.edge.pop()?;
        Some((cell as usize, unsorted((key >> 32) as u32)))
    }
}

/// A number with the order of a height. Both zeros have the same.
fn sortable(height: f32) -> u32 {
    let bits = (height + 0.0).to_bits();
    if bits >> 31 == 0 { bits | 1 << 31 } else { !bits }
}

/// The height of a sortable number.
fn unsorted(number: u32) -> f32 {
    f32::from_bits(if number >> 31 == 1 { number & !(1 << 31) } else { !number })
}
