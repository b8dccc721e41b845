//! How much ground drains through each cell.

use super::directions::FlowDirections;
use crate::raster::{Dem, GroundScale};

/// In place of the number of neighbours: the cell is done.
const COUNTED: u8 = u8::MAX;

/// What a flow accumulation adds up.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Accumulated<'a> {
    /// Each cell counts one.
    Cells,
    /// Each cell counts its area on the map, square metres, by the scale of its row.
    SquareMetres(&'a GroundScale),
}

/// The flow accumulation: the cells that drain through each cell, including itself, as in GRASS and SAGA. (In ArcGIS it is
/// one less.) Either their number or their area. NaN without data. A `f32` holds counts up to 2²⁴ exactly, and larger ones
/// and areas with an error of at most one part in 2²⁴.
///
/// The time is in proportion to the number of cells. The memory is nine bytes per cell besides the directions; thirteen for
/// areas if the scale differs from row to row.
pub fn flow_accumulation(directions: &FlowDirections, accumulated: Accumulated<'_>) -> Dem {
    let grid = *directions.grid();
    let has_data = |cell: usize| directions.has_data(cell);
    let value = |sum: f64| if sum == 0.0 { f32::NAN } else { sum as f32 };
    let counts = || sums(directions, |cell| u32::from(has_data(cell)), |a, b| a + b);
    let values = match accumulated {
        Accumulated::Cells => counts().into_iter().map(|count| value(count.into())).collect(),
        Accumulated::SquareMetres(GroundScale::Uniform(scale)) => {
            let cell = (grid.cell * *scale).element_product();
            counts().into_iter().map(|count| value(f64::from(count) * cell)).collect()
        }
        Accumulated::SquareMetres(scale) => {
            let areas: Vec<f64> = (0..grid.rows).map(|row| (grid.cell * scale.row(row)).element_product()).collect();
            let area = |cell: usize| if has_data(cell) { areas[cell / grid.cols] } else { 0.0 };
            sums(directions, area, |a, b| a + b).into_iter().map(value).collect()
        }
    };
    directions.with(values)
}

/// For each cell, the sum of what it and all cells above it count.
fn sums<T: Copy>(directions: &FlowDirections, of: impl Fn(usize) -> T, add: impl Fn(T, T) -> T) -> Vec<T> {
    let cells = directions.grid().len();
    // The neighbours of a cell that drain to it and are not counted yet.
    let mut waiting = vec![0_u8; cells];
    (0..cells).filter_map(|cell| directions.downstream(cell)).for_each(|down| waiting[down] += 1);
    let mut sums: Vec<T> = (0..cells).map(of).collect();
    for source in 0..cells {
        // From a source downstream, as far as all of the flow has come in.
        let mut next = (waiting[source] == 0).then_some(source);
        while let Some(cell) = next {
            waiting[cell] = COUNTED;
            next = directions.downstream(cell).filter(|&down| {
                sums[down] = add(sums[down], sums[cell]);
                waiting[down] -= 1;
                waiting[down] == 0
            });
        }
    }
    sums
}
