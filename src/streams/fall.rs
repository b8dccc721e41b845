//! Heights on a grid that fall along streams.
//!
//! The cells of a grid lie beside a stream, not on it. Banks are higher than the water, so heights read along a stream
//! would rise and fall with the distance of the stream from the cell centres. Here they are changed until they never
//! rise, by as little as needed. Two readings count: that of the nearest cell, and the bilinear one between four cells.
//!
//! The caller tells which heights are `allowed`: for a cell and a wanted height, the allowed height that is nearest to it,
//! or `None` if the cell stays.

use std::collections::HashMap;

use glam::{DVec2, DVec3};

use super::line::Stream;
use crate::base::Grid;
use crate::base::bits::bits;

/// Readings per cell along a stream.
const READINGS: f64 = 4.0;
/// A grid knows the place of a stream to half a cell.
const PLACE: f64 = 0.5;
/// Lowering one reading changes its neighbours. After so many rounds, what is left is below what floors allow.
const ROUNDS: usize = 12;

/// Raises heights along streams to those of the streams, as far as this is `allowed`.
pub(crate) fn raise_to(
    streams: &[Stream],
    grid: &Grid,
    heights: &mut [f32],
    allowed: impl Fn(usize, f32) -> Option<f32>,
) {
    streams.iter().for_each(|stream| raise_along(stream, grid, heights, &allowed));
}

/// Lowers heights along streams until they never rise downstream, as far as this is `allowed`. Heights that are NaN stay.
/// `streams` come in an order in which each one follows those that flow into it.
pub(crate) fn fall_along(
    streams: &[Stream],
    grid: &Grid,
    heights: &mut [f32],
    allowed: impl Fn(usize, f32) -> Option<f32>,
) {
    for _ in 0..ROUNDS {
        let mut ends: HashMap<[u64; 2], [f32; 2]> = HashMap::new();
        let mut changed = false;
        for stream in streams {
            let (Some(first), Some(last)) = (stream.points.first(), stream.points.last()) else { continue };
            let mut most = ends.get(&bits(first.truncate())).copied().unwrap_or([f32::INFINITY; 2]);
            let mut before = usize::MAX;
            for_each_reading(stream, grid, |place, _| {
                let n = nearest(grid, place);
                if let Some(n) = n.filter(|&n| n != before && !heights[n].is_nan()) {
                    before = n;
                    let below = if most[0] == f32::INFINITY { most[0] } else { most[0].next_down() };
                    if heights[n] > below
                        && let Some(lowered) = allowed(n, below).filter(|lowered| *lowered < heights[n])
                    {
                        heights[n] = lowered;
                        changed = true;
                    }
                    most[0] = most[0].min(heights[n]);
                }
                if let Some(corners) = corners(grid, place) {
                    if reading(heights, &corners) > most[1] {
                        changed |= move_to(most[1], heights, &corners, &allowed);
                    }
                    most[1] = most[1].min(reading(heights, &corners));
                }
            });
            let end = ends.entry(bits(last.truncate())).or_insert([f32::INFINITY; 2]);
            *end = [end[0].min(most[0]), end[1].min(most[1])];
        }
        if !changed {
            break;
        }
    }
}

/// Raises what is lower than a stream: the cells that it runs through, where it is nearest to their centre, and the readings
/// between cells. They are raised to the height that the stream has [`PLACE`] cells further downstream. On steep ground
/// its height at the very place would be too much.
fn raise_along(stream: &Stream, grid: &Grid, heights: &mut [f32], allowed: &impl Fn(usize, f32) -> Option<f32>) {
    let mut readings: Vec<(DVec2, f32)> = Vec::new();
    for_each_reading(stream, grid, |place, z| readings.push((place, z)));
    let mut walked = 0.0;
    let mut at = vec![0.0; readings.len()];
    for k in 1..readings.len() {
        walked += readings[k - 1].0.distance(readings[k].0);
        at[k] = walked;
    }
    let raise = |heights: &mut [f32], n: usize, z: f32| {
        if heights[n] < z {
            heights[n] = allowed(n, z).map_or(heights[n], |raised| raised.max(heights[n]));
        }
    };
    // The cell that the stream runs through, with its distance from the centre and the height for it.
    let mut through: Option<(usize, f64, f32)> = None;
    let mut ahead = 0;
    for (&(place, _), s) in readings.iter().zip(&at) {
        while ahead + 1 < readings.len() && at[ahead] < s + PLACE {
            ahead += 1;
        }
        let z = readings[ahead].1;
        let distance = place.distance_squared(place.round());
        match (nearest(grid, place), &mut through) {
            (Some(n), Some((cell, least, height))) if *cell == n => {
                if distance < *least {
                    (*least, *height) = (distance, z);
                }
            }
            (n, through) => {
                if let Some((cell, _, height)) = std::mem::replace(through, n.map(|n| (n, distance, z))) {
                    raise(heights, cell, height);
                }
            }
        }
        if let Some(corners) = corners(grid, place).filter(|corners| reading(heights, corners) < z) {
            move_to(z, heights, &corners, allowed);
        }
    }
    if let Some((cell, _, height)) = through {
        raise(heights, cell, height);
    }
}

/// The bilinear reading between four cells.
pub(super) fn reading(heights: &[f32], corners: &[(usize, f32); 4]) -> f32 {
    corners.iter().map(|&(n, share)| share * heights[n]).sum()
}

/// Moves the corners on the other side of `wanted` towards it, as far as this is `allowed`, until the reading between them
/// is there. Whether one was changed.
pub(super) fn move_to(
    wanted: f32,
    heights: &mut [f32],
    corners: &[(usize, f32); 4],
    allowed: &impl Fn(usize, f32) -> Option<f32>,
) -> bool {
    let misses = wanted - reading(heights, corners);
    // How far a corner may move; of the sign of `misses`.
    let room = |n: usize, heights: &[f32]| {
        let by = allowed(n, wanted).map_or(0.0, |to| to - heights[n]);
        if by * misses > 0.0 { by } else { 0.0 }
    };
    let all: f32 = corners.iter().map(|&(n, share)| share * room(n, heights)).sum();
    if all == 0.0 || !all.is_finite() || !misses.is_finite() {
        return false;
    }
    let part = (misses / all).min(1.0);
    let mut changed = false;
    for &(n, share) in corners {
        let moved = heights[n] + part * room(n, heights);
        if share > 0.0 && moved != heights[n] {
            heights[n] = moved;
            changed = true;
        }
    }
    changed
}

/// Calls `read` with places along a stream, from its first vertex to its last, as columns and rows with fractions, and
/// with the heights of the stream there.
pub(super) fn for_each_reading(stream: &Stream, grid: &Grid, mut read: impl FnMut(DVec2, f32)) {
    let mut points = stream.points.iter().map(|p| grid.place(p.truncate()).extend(p.z));
    let Some(mut a) = points.next() else { return };
    let mut read_at = |p: DVec3| read(p.truncate(), p.z as f32);
    read_at(a);
    for b in points {
        let count = (READINGS * a.truncate().distance(b.truncate())).ceil().max(1.0);
        (1..=count as usize).for_each(|k| read_at(a.lerp(b, k as f64 / count)));
        a = b;
    }
}

/// The cells that a stream runs through, downstream, each once in a row.
pub(super) fn cells_along(stream: &Stream, grid: &Grid) -> Vec<usize> {
    let mut cells = Vec::new();
    for_each_reading(stream, grid, |place, _| cells.extend(nearest(grid, place)));
    cells.dedup();
    cells
}

fn nearest(grid: &Grid, place: DVec2) -> Option<usize> {
    let whole = place.round();
    let is_on = whole.cmpge(DVec2::ZERO).all() && whole.x < grid.cols as f64 && whole.y < grid.rows as f64;
    is_on.then(|| whole.y as usize * grid.cols + whole.x as usize)
}

/// The four cells around a place, with their shares of the bilinear reading.
pub(super) fn corners(grid: &Grid, place: DVec2) -> Option<[(usize, f32); 4]> {
    let first = place.floor();
    let is_on = first.cmpge(DVec2::ZERO).all() && first.x + 1.0 < grid.cols as f64 && first.y + 1.0 < grid.rows as f64;
    is_on.then(|| {
        let n = first.y as usize * grid.cols + first.x as usize;
        let (u, v) = ((place.x - first.x) as f32, (place.y - first.y) as f32);
        let below = n + grid.cols;
        [(n, (1.0 - u) * (1.0 - v)), (n + 1, u * (1.0 - v)), (below, (1.0 - u) * v), (below + 1, u * v)]
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::subdomains::Band;

    #[test]
    fn a_stream_between_cells_moves_only_those_that_may_move() {
        // Two columns of cells, and a stream about midway between them, from north to south. It falls from 99 m to 90 m.
        let grid = Grid::on_multiples(DVec2::ZERO, DVec2::new(2.0, 10.0), 1.0);
        let at = |k: usize| DVec3::new(0.98, 9.5 - k as f64, 99.0 - k as f64);
        let stream = Stream::between((0..10).map(at).collect(), Band { lo: 0.0, hi: 100.0 });
        // The eastern column lies beyond a contour of 100 m.
        let before: Vec<f32> = (0..20).map(|n| if n % 2 == 0 { 30.0 + 3.0 * (n % 7) as f32 } else { 140.0 }).collect();
        let nodes = |n: usize, wanted: f32| {
            let [lo, hi] = if n.is_multiple_of(2) { [0.0, 100.0] } else { [100.0, 200.0] };
            (lo < wanted && wanted < hi).then_some(wanted)
        };
        let mut heights = before.clone();
        raise_to(std::slice::from_ref(&stream), &grid, &mut heights, nodes);
        fall_along(std::slice::from_ref(&stream), &grid, &mut heights, nodes);
        let east = |heights: &[f32]| heights.iter().skip(1).step_by(2).copied().collect::<Vec<f32>>();
        assert_eq!(east(&heights), east(&before));
        let readings = |heights: &[f32]| {
            let mut found = Vec::new();
            for_each_reading(&stream, &grid, |place, _| {
                found.extend(corners(&grid, place).map(|corners| reading(heights, &corners)));
            });
            found
        };
        let rise = |heights: &[f32]| readings(heights).windows(2).map(|w| w[1] - w[0]).fold(0.0, f32::max);
        assert!(rise(&before) > 0.5 && rise(&heights) < 1e-4, "{} {}", rise(&before), rise(&heights));
        // Cells of a height map move as far as their bands allow.
        let cells = |n: usize, wanted: f32| Some(wanted.max(if n.is_multiple_of(2) { 0.0 } else { 100.0 }));
        fall_along(std::slice::from_ref(&stream), &grid, &mut heights, cells);
        assert!(east(&heights).iter().all(|z| *z >= 100.0));
    }
}
