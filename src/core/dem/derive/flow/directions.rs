//! The neighbour that each cell drains to, by a flood from the outlets.

use glam::DVec2;

use super::edge::falls_outwards;
use crate::base::error::{Error, Result};
use crate::base::{self, Grid};
use crate::crs::Crs;
use crate::drain::{Flood, STEPS, neighbours, sortable, unsorted};
use crate::raster::{Dem, GroundScale};

/// Bytes of memory per cell: its direction, a mark, the flood's edge, and what is computed from the directions.
const BYTES_PER_CELL: f64 = 18.0;
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
    /// Index `k` of the neighbour in [`STEPS`], with the code `1 << k`; or [`OUTLET`] or [`NO_DATA`].
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
/// Water can leave at the border of the height map and beside cells without data. From there a flood rises over the map
/// (priority-flood: Barnes, Lehman and Mulla 2014, Computers & Geosciences 62). It takes the cell with the lowest flooded
/// height next, and in a pit the lowest ground first, as in GRASS (Metz, Mitasova and Harmon 2011). A cell drains along the
/// steepest descent (O'Callaghan and Mark 1984) to a neighbour that the flood took before it. Without a lower one, it
/// drains to the neighbour from which the flood reached it. So pits drain along their lowest ground to the lowest point
/// of their rim, and no height is changed. Level ground drains to the neighbour from which the way over level ground is shortest,
/// of those that the flood took before. `scale` gives the distances, as cells
/// need not be square.
///
/// A cell where water can leave is an outlet if its ground falls outwards, by the plane through the cells around it, or if no
/// neighbour is lower. Otherwise it drains as any other.
///
/// The time is in proportion to n log n for n cells. The memory is six bytes per cell, and sixteen per cell of the
/// flood's edge. `memory` is what the directions, and the accumulation or the catchments that are computed from them, may take,
/// bytes; no limit if `None`.
///
/// # Errors
/// [`Error::Parameter`] if the values do not fit the grid, or if there are more cells than 32 bits count.
/// [`Error::OutOfMemory`] if they need more memory than they may take.
pub fn flow_directions(dem: &Dem, scale: &GroundScale, memory: Option<u64>) -> Result<FlowDirections> {
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
    let (what, remedy) =
        (format!("the flow of water over {} cells", cols * rows), "clip the height map, or make its cells larger");
    base::memory::check(BYTES_PER_CELL * dem.values.len() as f64, memory, what, remedy)?;
    let has_data = |cell: usize| dem.values[cell].is_finite();
    let neighbours = |cell: usize| neighbours(cell, cols, rows);
    let is_outlet = |cell: usize| neighbours(cell).flatten().filter(|(_, near)| has_data(*near)).count() < STEPS.len();

    let mut towards: Vec<u8> = dem.values.iter().map(|h| if h.is_finite() { UNREACHED } else { NO_DATA }).collect();
    let mut is_taken = vec![false; dem.values.len()];
    // The length of the way over level ground, to where it falls or water leaves.
    let mut level_way = vec![0.0f32; dem.values.len()];
    // The flooded height and the height of the ground as one key.
    let key = |height: f32, level: f32| u64::from(sortable(height.max(level))) << 32 | u64::from(sortable(height));
    let mut flood = Flood::new();
    for cell in (0..dem.values.len()).filter(|&cell| has_data(cell) && is_outlet(cell)) {
        towards[cell] = OUTLET;
        flood.push(cell, key(dem.values[cell], f32::NEG_INFINITY));
    }
    while let Some((cell, flooded)) = flood.pop() {
        let level = unsorted((flooded >> 32) as u32);
        is_taken[cell] = true;
        let height = dem.values[cell];
        let DVec2 { x, y } = size * scale.row(cell / cols);
        let leaves = towards[cell] == OUTLET && falls_outwards(dem, cell, DVec2 { x, y });
        // To the neighbours on a column, diagonally, and on a row.
        let distances = [y, x.hypot(y), x];
        let mut steepest = 0.0;
        let (flooded_from, mut is_level, mut nearest) = (towards[cell], false, (f32::INFINITY, towards[cell]));
        for (k, near) in neighbours(cell).flatten() {
            if towards[near] == UNREACHED {
                towards[near] = ((k + 4) % 8) as u8;
                flood.push(near, key(dem.values[near], level));
            } else if is_taken[near] && !leaves {
                let (col, row) = STEPS[k];
                let distance = if row == 0 { distances[2] } else { distances[col.unsigned_abs()] };
                let descent = (f64::from(height) - f64::from(dem.values[near])) / distance;
                if descent > steepest {
                    (steepest, towards[cell]) = (descent, k as u8);
                }
                if descent == 0.0 {
                    is_level |= k == usize::from(flooded_from);
                    let way = level_way[near] + distance as f32;
                    nearest = if way < nearest.0 { (way, k as u8) } else { nearest };
                }
            }
        }
        // A pit that is not level drains along the flood.
        if is_level && steepest == 0.0 {
            (level_way[cell], towards[cell]) = nearest;
        }
    }
    Ok(FlowDirections { grid: dem.grid, crs: dem.crs.clone(), towards })
}
