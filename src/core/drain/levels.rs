//! The levels at which the cells of a grid drain.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use super::flood::{sortable, unsorted, ways_end};
use super::ground::Ground;
use crate::base::parallel;

/// Stands for the catchment of a cell without height. There are fewer cells than that.
const NO_HEIGHT: u32 = u32::MAX;
/// Stands for the catchment of all cells from which water runs off.
const RUNS_OFF: u32 = u32::MAX - 1;

/// The least height, over all ways from each cell to an outlet, of the highest place on the way. NaN without height.
///
/// From each cell, water runs to the lowest neighbour, and at last to an outlet or into a pit. A cell from which it runs
/// off drains at its own height. The others in the catchment of one pit drain at the level at which this pit overflows, or at
/// their own height if they are higher. Pits overflow in the order of their levels, as in a priority-flood (Barnes, Lehman
/// and Mulla 2014, Computers & Geosciences 62), but with one entry for each pair of catchments instead of one for each cell.
fn levels(
    heights: &[f32],
    ground: &Ground<'_>,
    height: impl Fn(usize) -> f32 + Sync,
    is_outlet: impl Fn(usize) -> bool + Sync,
) -> Vec<f32> {
    let next = parallel::values(heights.len(), |cell| {
        if !heights[cell].is_finite() {
            return NO_HEIGHT;
        }
        if is_outlet(cell) {
            return RUNS_OFF;
        }
        let near = ground.around(cell).filter(|&near| heights[near].is_finite());
        let lowest = near.min_by(|&a, &b| height(a).total_cmp(&height(b)));
        lowest.filter(|&lowest| height(lowest) < height(cell)).unwrap_or(cell) as u32
    });
    let catchments = ways_end(next);
    let mut levels =
        parallel::values(heights.len(), |cell| if catchments[cell] == RUNS_OFF { height(cell) } else { f32::NAN });

    let is_dry = |levels: &[f32], cell: usize| catchments[cell] != NO_HEIGHT && levels[cell].is_nan();
    // A way into a dry catchment: the catchment, the level, and the first cell.
    let way_in = |level: f32, to: usize| (catchments[to], sortable(level.max(height(to))), to as u32);
    let mut ways_in = parallel::flat_map(ground.rows, |row| {
        let cells = (row * ground.cols..(row + 1) * ground.cols).filter(|&cell| catchments[cell] == RUNS_OFF);
        let from = |cell: usize| {
            let dry = ground.around(cell).filter(|&near| is_dry(&levels, near));
            dry.map(|near| way_in(levels[cell], near)).collect::<Vec<_>>()
        };
        cells.flat_map(from).collect::<Vec<_>>()
    });
    let mut edge = BinaryHeap::new();
    let mut wet = Vec::new();
    loop {
        ways_in.sort_unstable();
        ways_in.dedup_by_key(|(catchment, ..)| *catchment);
        edge.extend(ways_in.drain(..).map(|(_, level, cell)| Reverse((level, cell as usize))));
        let Some(Reverse((level, first))) = edge.pop() else { break };
        if !is_dry(&levels, first) {
            continue;
        }
        let level = unsorted(level);
        levels[first] = level.max(height(first));
        wet.push(first);
        while let Some(cell) = wet.pop() {
            for near in ground.around(cell) {
                if !is_dry(&levels, near) {
                    continue;
                }
                // Water covers the whole catchment, and runs on into those whose rim is not higher.
                let reached = levels[cell].max(height(near));
                if catchments[near] == catchments[cell] || reached == level {
                    levels[near] = level.max(height(near));
                    wet.push(near);
                } else {
                    ways_in.push(way_in(levels[cell], near));
                }
            }
        }
    }
    levels
}

/// The lowest level at which each cell can drain while no ground goes below its contours: the least height, over all
/// ways out, of the highest floor on the way. NaN without height.
pub(crate) fn drainable(heights: &[f32], ground: &Ground<'_>) -> Vec<f32> {
    let stays = ground.stays;
    let floor = |cell: usize| if stays[cell] { heights[cell] } else { lower(ground.lo[cell], heights[cell]) };
    levels(heights, ground, floor, |cell| stays[cell] || ground.is_outlet(heights, cell))
}

/// The lower one of a limit and a height; the height if there is no limit.
fn lower(limit: f32, height: f32) -> f32 {
    if limit < height { limit } else { height }
}

/// The height to which each cell is flooded when water rises until it runs off. `is_outlet` says where it leaves. NaN
/// without height.
pub(crate) fn flooded(heights: &[f32], ground: &Ground<'_>, is_outlet: impl Fn(usize) -> bool + Sync) -> Vec<f32> {
    levels(heights, ground, |cell| heights[cell], is_outlet)
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    /// The levels by the slow way: each cell asks its neighbours until nothing changes.
    fn slow(heights: &[f32], ground: &Ground<'_>, is_outlet: impl Fn(usize) -> bool) -> Vec<f32> {
        let first = |cell: usize| if is_outlet(cell) { heights[cell] } else { f32::INFINITY };
        let mut levels: Vec<f32> = (0..heights.len()).map(first).collect();
        loop {
            let level = |cell: usize| {
                let near = ground.around(cell).filter(|&near| heights[near].is_finite()).map(|near| levels[near]);
                near.fold(f32::INFINITY, f32::min).max(heights[cell]).min(levels[cell])
            };
            let after: Vec<f32> = (0..heights.len()).map(level).collect();
            if after == levels {
                break;
            }
            levels = after;
        }
        (0..heights.len()).map(|cell| if heights[cell].is_finite() { levels[cell] } else { f32::NAN }).collect()
    }

    proptest! {
        #[test]
        fn levels_are_those_of_the_slow_way(
            (cols, heights) in (1_usize..12).prop_flat_map(|cols| {
                let height = prop_oneof![9 => (0_i8..9).prop_map(f32::from), 1 => Just(f32::NAN)];
                (Just(cols), proptest::collection::vec(height, cols..=cols * 12))
            }),
            outlets in proptest::collection::vec(proptest::bool::weighted(0.04), 144),
        ) {
            let heights = &heights[..heights.len() / cols * cols];
            let ground = Ground { cols, rows: heights.len() / cols, lo: &[], hi: &[], stays: &[] };
            let is_outlet = |cell: usize| heights[cell].is_finite() && (outlets[cell] || ground.is_outlet(heights, cell));
            let found = levels(heights, &ground, |cell| heights[cell], is_outlet);
            let slow = slow(heights, &ground, is_outlet);
            prop_assert!(found.iter().zip(&slow).all(|(a, b)| a.total_cmp(b).is_eq()), "{found:?} instead of {slow:?}");
        }
    }
}
