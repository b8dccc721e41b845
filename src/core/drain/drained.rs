//! Height maps without pits: ways out are cut along the lowest ground, and what cannot be cut is filled.

use super::flood::{Flood, sortable};
use super::ground::{Ground, ponds};
use super::levels::drainable;

/// Largest number of cells of a way out that is cut. It limits time. A pit that needs more is filled.
const LONGEST: usize = 20_000;

/// Whether heights may leave the bands of their sub-domains.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Bands {
    /// No. Some pits then stay.
    Kept,
    /// Where nothing else drains a pit.
    Left,
}

/// Drains all pits of a height map, except where water may stay.
///
/// 1. From each pit, the way out is cut that a flood from the outlets takes to it (Lindsay 2016, Hydrol. Process. 30). The
///    flood comes over the lowest floors of bands, and among those over the lowest ground. So each cut stays above the
///    floors if there is such a way. No cut is deeper than `depth`.
/// 2. A pit without such a way lies in a hollow of the contours. Its ground is raised to the lowest level at which it
///    drains, or, if bands may be left and that changes less, the way out is cut through the contours.
/// 3. What is left is filled to its rim (priority-flood: Barnes, Lehman and Mulla 2014). It is then level.
///
/// The time is in proportion to n log n for n cells, besides the length of the cuts.
pub(crate) fn drain(heights: &mut [f32], ground: &Ground<'_>, depth: f32, bands: Bands) {
    let levels = drainable(heights, ground);
    let costs = match bands {
        Bands::Kept => Vec::new(),
        Bands::Left => costs_of_filling(heights, &levels, ground),
    };
    cut(heights, ground, &levels, &costs, depth);
    let levels = if bands == Bands::Left { drainable(heights, ground) } else { levels };
    if raise(heights, ground, &levels, bands) {
        cut(heights, ground, &levels, &[], depth);
    }
    fill(heights, ground, bands);
}

/// For each cell below the level at which it can drain: how much ground it takes to raise the hollow around it, as a sum
/// of heights. 0 elsewhere; empty if there is no such cell.
fn costs_of_filling(heights: &[f32], levels: &[f32], ground: &Ground<'_>) -> Vec<f32> {
    let hollows = ponds(heights, levels, ground);
    if hollows.is_empty() {
        return Vec::new();
    }
    let mut costs = vec![0.0; heights.len()];
    for hollow in hollows {
        let cost =
            hollow.cells.iter().map(|&cell| f64::from(hollow.level - heights[cell as usize])).sum::<f64>() as f32;
        hollow.cells.iter().for_each(|&cell| costs[cell as usize] = cost);
    }
    costs
}

/// In place of the cell before: the flood began here.
const START: u32 = u32::MAX;
/// In place of the cell before: the flood was not here.
const UNREACHED: u32 = u32::MAX - 1;

/// Cuts ways out of pits. `levels` are the lowest ones at which cells can drain. Below them, a way is cut only if it takes
/// less than `costs`.
fn cut(heights: &mut [f32], ground: &Ground<'_>, levels: &[f32], costs: &[f32], depth: f32) {
    let mut before = vec![UNREACHED; heights.len()];
    let mut flood = Flood::new();
    let key = |cell: usize, height: f32, rim: f32| {
        let rim = height.max(rim);
        ([sortable(levels[cell]), sortable(rim), sortable(height)], rim)
    };
    let starts: Vec<usize> = (0..heights.len())
        .filter(|&cell| heights[cell].is_finite() && (ground.stays[cell] || ground.is_outlet(heights, cell)))
        .collect();
    // The highest ground on the way of the flood.
    let mut rims = vec![f32::NAN; heights.len()];
    for cell in starts {
        before[cell] = START;
        let (key, rim) = key(cell, heights[cell], f32::NEG_INFINITY);
        rims[cell] = rim;
        flood.push(cell, key);
    }
    while let Some((cell, _)) = flood.pop() {
        if before[cell] != START && is_pit(heights, ground, cell) {
            let limit = costs.get(cell).copied().unwrap_or(0.0);
            cut_from(heights, ground, &before, cell, &Limit { level: levels[cell], depth, cost: limit });
        }
        for near in ground.around(cell) {
            if heights[near].is_finite() && before[near] == UNREACHED {
                before[near] = cell as u32;
                let (key, rim) = key(near, heights[near], rims[cell]);
                rims[near] = rim;
                flood.push(near, key);
            }
        }
    }
}

/// Whether no neighbour is lower.
fn is_pit(heights: &[f32], ground: &Ground<'_>, cell: usize) -> bool {
    ground.around(cell).all(|near| heights[near] >= heights[cell])
}

/// What a way out may take.
struct Limit {
    /// The lowest level at which the pit can drain above the floors of bands.
    level: f32,
    depth: f32,
    /// The largest sum of cuts below the floors of bands.
    cost: f32,
}

/// Lowers the way by which the flood came to a pit, until it reaches ground that is not above the pit.
fn cut_from(heights: &mut [f32], ground: &Ground<'_>, before: &[u32], pit: usize, limit: &Limit) {
    let bottom = heights[pit];
    let is_above_floors = limit.level <= bottom;
    let (mut way, mut end, mut cost) = (Vec::new(), bottom, 0.0);
    let mut at = before[pit];
    while at != START {
        let cell = at as usize;
        let height = heights[cell];
        if height <= bottom {
            end = height;
            break;
        }
        cost += height - bottom;
        way.push(cell);
        let is_too_much = height - bottom >= limit.depth || (!is_above_floors && cost > limit.cost);
        if ground.stays[cell] || is_too_much || way.len() > LONGEST {
            return;
        }
        at = before[cell];
    }
    // From the end upwards, so that a floor on the way holds the ground above it.
    let (steps, mut least) = (way.len() as f32 + 1.0, f32::NEG_INFINITY);
    for (k, &cell) in way.iter().enumerate().rev() {
        let fall = bottom + (end - bottom) * ((k + 1) as f32 / steps);
        let floor = if is_above_floors { ground.lo[cell] } else { f32::NEG_INFINITY };
        least = fall.max(floor).max(least).min(bottom);
        heights[cell] = least;
    }
}

/// Raises ground to the lowest level at which it can drain. Returns whether there was such ground.
fn raise(heights: &mut [f32], ground: &Ground<'_>, levels: &[f32], bands: Bands) -> bool {
    let mut is_raised = false;
    for (cell, height) in heights.iter_mut().enumerate() {
        let level = match bands {
            Bands::Kept => levels[cell].min(ground.hi[cell]),
            Bands::Left => levels[cell],
        };
        if level > *height && !ground.stays[cell] {
            *height = level;
            is_raised = true;
        }
    }
    is_raised
}

/// Fills what has no way out to its rim.
fn fill(heights: &mut [f32], ground: &Ground<'_>, bands: Bands) {
    let mut is_reached = vec![false; heights.len()];
    let mut flood = Flood::new();
    let starts: Vec<usize> = (0..heights.len())
        .filter(|&cell| heights[cell].is_finite() && (ground.stays[cell] || ground.is_outlet(heights, cell)))
        .collect();
    // The height to which a cell is flooded is its own, except where the band does not let it rise as far.
    let mut levels = vec![f32::NAN; heights.len()];
    for cell in starts {
        is_reached[cell] = true;
        levels[cell] = heights[cell];
        flood.push(cell, sortable(heights[cell]));
    }
    while let Some((cell, _)) = flood.pop() {
        let level = levels[cell];
        for near in ground.around(cell) {
            let height = heights[near];
            if !height.is_finite() || is_reached[near] {
                continue;
            }
            is_reached[near] = true;
            if height < level {
                heights[near] = match bands {
                    Bands::Kept => level.min(ground.hi[near]).max(height),
                    Bands::Left => level,
                };
            }
            levels[near] = heights[near].max(level);
            flood.push(near, sortable(levels[near]));
        }
    }
}
