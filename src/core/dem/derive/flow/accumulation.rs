//! How many cells drain through each cell.

use super::directions::FlowDirections;
use crate::raster::Dem;

/// In place of the number of neighbours: the cell is done.
const COUNTED: u8 = u8::MAX;

/// The flow accumulation: the number of cells that drain through each cell, including itself, as in GRASS and SAGA. (In
/// ArcGIS it is one less.) NaN without data. A `f32` holds counts up to 2²⁴ exactly, and larger ones with an error of at most
/// one part in 2²⁴.
///
/// The time is in proportion to the number of cells.
pub fn flow_accumulation(directions: &FlowDirections) -> Dem {
    let cells = directions.grid().len();
    // The neighbours of a cell that drain to it and are not counted yet.
    let mut waiting = vec![0_u8; cells];
    (0..cells).filter_map(|cell| directions.downstream(cell)).for_each(|down| waiting[down] += 1);
    let mut counts: Vec<u32> = (0..cells).map(|cell| u32::from(directions.has_data(cell))).collect();
    for source in 0..cells {
        // From a source downstream, as far as all of the flow has come in.
        let mut next = (waiting[source] == 0).then_some(source);
        while let Some(cell) = next {
            waiting[cell] = COUNTED;
            next = directions.downstream(cell).filter(|&down| {
                counts[down] += counts[cell];
                waiting[down] -= 1;
                waiting[down] == 0
            });
        }
    }
    directions.with(counts.into_iter().map(|count| if count == 0 { f32::NAN } else { count as f32 }).collect())
}
