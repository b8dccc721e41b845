//! The smooth surface along streams: streams get its heights and fall, pits are breached, and nodes beside streams get their
//! heights.
//!
//! Between contours that are near, a stream gets the mean of the surface and of the curve from crossing to crossing with which
//! it was drawn into the surface. On seven maps, the errors of the surface on streams are 10 to 21 % smaller than those of the
//! curves, because the surface knows the ground beside the stream. But beyond the last contour, it carries slopes on.

use super::pits::Limits;
use super::working_grid::WorkingGrid;
use crate::streams::{Stream, Ways, fall_along, follow, raise_to};

/// Cuts undo falls along streams, and falls make pits. So both are repeated.
const ROUNDS: usize = 2;
/// Depth of the ways out of pits that raised streams have closed, as a share of the contour interval. A stream may be far
/// above ground that sags. A deeper cut beside it would be a trench down to that ground.
const DEEPEST: f64 = 0.125;

/// Breaches pits, gives streams the heights of the surface where no contour or water gives them, and makes the surface fall
/// along them. `breach` cuts ways out of pits within limits.
pub(super) fn settle(
    streams: &mut [Stream],
    working: &mut WorkingGrid,
    [lo, hi]: [&[f32]; 2],
    interval: f64,
    breach: impl Fn(&mut [f32], &Limits<'_>),
) {
    follow(streams, |p| f64::from(working.at(p.truncate())));
    let WorkingGrid { grid, heights } = working;
    // Between neighbouring contours no cut needs to be deeper.
    breach(heights, &Limits { lo, depth: interval as f32 });
    if streams.is_empty() {
        return;
    }
    // A node beyond a contour from the stream stays. Heights between nodes follow it up to two nodes away, so moving it
    // would falsify the ground there.
    let allowed = |n: usize, wanted: f32| (lo[n] < wanted && wanted < hi[n]).then_some(wanted);
    let before = heights.clone();
    raise_to(streams, grid, heights, allowed);
    let raised: Vec<usize> = (0..heights.len()).filter(|&n| heights[n] > before[n]).collect();
    let ways = Ways::new(streams, grid);
    fall_along(&ways, heights, interval, allowed);
    for _ in 0..ROUNDS {
        // Ground that was raised to a stream is no dam. A way through it would lower all of the stream below.
        let mut floor = lo.to_vec();
        raised.iter().for_each(|&n| floor[n] = floor[n].max(heights[n]));
        breach(heights, &Limits { lo: &floor, depth: (DEEPEST * interval) as f32 });
        fall_along(&ways, heights, interval, allowed);
    }
}

#[cfg(test)]
mod tests {
    use glam::{DVec2, DVec3};

    use super::super::lattice::Lattice;
    use super::super::pits;
    use super::*;
    use crate::base::{Grid, Sure};
    use crate::subdomains::Band;

    #[test]
    fn a_stream_above_sagging_ground_gets_no_trench_beside_it_and_other_dams_are_cut() {
        let (cols, rows) = (40, 15);
        let grid = Grid { corner: DVec2::new(0.0, rows as f64), cell: DVec2::ONE, cols, rows };
        let (valley, stream_row) = (3, 10);
        // Two valleys in level ground fall to the east. In one there is a dam, in the other a stream far above the floor.
        let dam = valley * cols + 15;
        let ground = |n: usize| match (n / cols, n % cols) {
            _ if n == dam => 250.0,
            (row, col) if row == valley || row == stream_row => 180.0 - 0.5 * col as f32,
            _ => 350.0,
        };
        let before: Vec<f32> = (0..grid.len()).map(ground).collect();
        let points: Vec<DVec3> =
            [(10, 396.0), (20, 392.0), (36, 162.0)].map(|(col, z)| grid.center(col, stream_row).extend(z)).to_vec();
        let [lo, hi] = [0.0, 400.0].map(|bound| vec![bound; grid.len()]);
        // Exact heights stay. Those between contours come half-way to the ground.
        for (sure, least) in [(Sure::Exact, 390.0), (Sure::Between, 280.0)] {
            let stream = Stream::between(points.clone(), Band { lo: 0.0, hi: 400.0 });
            let mut streams = [Stream { sure: vec![sure; points.len()], ..stream }];
            let mut working = WorkingGrid { grid, heights: before.clone() };
            settle(&mut streams, &mut working, [&lo, &hi], 200.0, |heights, limits| {
                pits::breach(heights, &Lattice::of_grid(&grid), limits, |_| false);
            });
            let heights = &working.heights;
            assert!(heights[dam] < 180.0 && heights[stream_row * cols + 12] > least, "{sure:?}");
            for n in (0..grid.len()).filter(|n| before[*n] == 350.0) {
                assert!(heights[n] > 350.0 - 25.0, "{sure:?}: node {} in row {}: {}", n % cols, n / cols, heights[n]);
            }
        }
    }

    #[test]
    fn ground_that_was_raised_to_a_stream_is_not_cut_again() {
        let (cols, rows) = (40, 9);
        let grid = Grid { corner: DVec2::new(0.0, rows as f64), cell: DVec2::ONE, cols, rows };
        let row = 4;
        // A valley that falls to the east. A stream begins in it, 15 to 20 m above the ground. Behind it is a pit.
        let ground = |n: usize| if n / cols == row { 180.0 - 0.5 * (n % cols) as f32 } else { 350.0 };
        let points: Vec<DVec3> =
            [(10, 191.0), (30, 189.0), (36, 162.0)].map(|(c, z)| grid.center(c, row).extend(z)).to_vec();
        let stream = Stream::between(points, Band { lo: 0.0, hi: 400.0 });
        let mut streams = [Stream { sure: vec![Sure::Exact; 3], ..stream }];
        let mut working = WorkingGrid { grid, heights: (0..grid.len()).map(ground).collect() };
        let [lo, hi] = [0.0, 400.0].map(|bound| vec![bound; grid.len()]);
        settle(&mut streams, &mut working, [&lo, &hi], 200.0, |heights, limits| {
            pits::breach(heights, &Lattice::of_grid(&grid), limits, |_| false);
        });
        let in_valley = &working.heights[row * cols..][..cols];
        assert!(in_valley[12..29].iter().all(|z| *z > 188.0), "{in_valley:?}");
    }
}
