//! Heights on a grid that fall along streams.
//!
//! The cells of a grid lie beside a stream, not on it. Banks are higher than the water, so heights read along a stream
//! would rise and fall with the distance of the stream from the cell centres. Here they are changed until they never
//! rise, by as little as needed. Two readings count: that of the nearest cell, and the bilinear one between four cells.

use std::collections::HashMap;

use super::ways::{Ways, move_to, reading};

/// Lowering one reading changes its neighbours. After so many rounds, what is left is below what floors allow.
const ROUNDS: usize = 12;

/// Lowers heights along streams until they never rise downstream, as far as this is `allowed`. Heights that are NaN stay.
pub(crate) fn fall_along(
    Ways { grid, of_streams }: &Ways<'_>,
    heights: &mut [f32],
    allowed: impl Fn(usize, f32) -> Option<f32>,
) {
    for _ in 0..ROUNDS {
        let mut ends: HashMap<[u64; 2], [f32; 2]> = HashMap::new();
        let mut changed = false;
        for way in of_streams {
            let Some([first, last]) = way.ends else { continue };
            let mut most = ends.get(&first).copied().unwrap_or([f32::INFINITY; 2]);
            let mut before = usize::MAX;
            for sample in &way.samples {
                if let Some(n) = sample.nearest().filter(|&n| n != before && !heights[n].is_nan()) {
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
                if let Some(corners) = sample.corners(grid) {
                    if reading(heights, &corners) > most[1] {
                        changed |= move_to(most[1], heights, &corners, &allowed);
                    }
                    most[1] = most[1].min(reading(heights, &corners));
                }
            }
            let end = ends.entry(last).or_insert([f32::INFINITY; 2]);
            *end = [end[0].min(most[0]), end[1].min(most[1])];
        }
        if !changed {
            break;
        }
    }
}

#[cfg(test)]
mod tests {
    use glam::{DVec2, DVec3};

    use super::super::raise_to;
    use super::*;
    use crate::base::Grid;
    use crate::streams::Stream;
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
        let streams = [stream];
        let ways = Ways::new(&streams, &grid);
        raise_to(&streams, &grid, &mut heights, nodes);
        fall_along(&ways, &mut heights, nodes);
        let east = |heights: &[f32]| heights.iter().skip(1).step_by(2).copied().collect::<Vec<f32>>();
        assert_eq!(east(&heights), east(&before));
        let readings = |heights: &[f32]| {
            let corners = ways.of_streams[0].samples.iter().filter_map(|sample| sample.corners(&grid));
            corners.map(|corners| reading(heights, &corners)).collect::<Vec<_>>()
        };
        let rise = |heights: &[f32]| readings(heights).windows(2).map(|w| w[1] - w[0]).fold(0.0, f32::max);
        assert!(rise(&before) > 0.5 && rise(&heights) < 1e-4, "{} {}", rise(&before), rise(&heights));
        // Cells of a height map move as far as their bands allow.
        let cells = |n: usize, wanted: f32| Some(wanted.max(if n.is_multiple_of(2) { 0.0 } else { 100.0 }));
        fall_along(&ways, &mut heights, cells);
        assert!(east(&heights).iter().all(|z| *z >= 100.0));
    }
}
