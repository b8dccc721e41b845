//! Heights on a grid that fall along streams.
//!
//! The cells of a grid lie beside a stream, not on it. Banks are higher than the water, so heights read along a stream
//! would rise and fall with the distance of the stream from the cell centres. Here they are changed until they never
//! rise, by as little as needed. Two readings count: that of the nearest cell, and the bilinear one between four cells.

use std::collections::HashMap;

use super::ways::{Way, Ways, move_to, reading};
use crate::base::{Grid, parallel};

/// Lowering one reading changes its neighbours. After so many rounds, what is left is below what floors allow.
const ROUNDS: usize = 12;
/// Heights are lowered by at most this share of the contour interval below a stream. Beside a contour, a reading has a share
/// of ground that may not move. The other cells, which are lowered instead, have a share in the readings upstream too. Without
/// a limit, these draw each other down to the floor of the band, and with them all of the stream below.
///
/// Tried 0.02 and 0.1. With 0.02, heights rise more downstream, by 0.34 instead of 0.31 m per kilometre on one of seven maps.
/// With 0.1, twice as many places on the streams of Norway lie 60 m or more below the stream.
const DEEPEST: f64 = 0.05;
/// Columns and rows of a block of cells.
const BLOCK: usize = 16;

/// Lowers heights along streams until they never rise downstream, as far as this is `allowed` and not far below the stream
/// ([`DEEPEST`]). Heights that are NaN stay. `interval` is the contour interval.
pub(crate) fn fall_along(
    Ways { grid, of_streams }: &Ways<'_>,
    heights: &mut [f32],
    interval: f64,
    allowed: impl Fn(usize, f32) -> Option<f32>,
) {
    let mut blocks = Blocks::new(grid);
    let blocks_of = parallel::map_each(of_streams, |way| blocks.of_way(way, grid));
    let depth = (DEEPEST * interval) as f32;
    let mut visits: Vec<Visit> = vec![Visit::default(); of_streams.len()];
    for _ in 0..ROUNDS {
        let mut ends: HashMap<[u64; 2], [f32; 2]> = HashMap::new();
        let mut changed = false;
        for ((way, own), visit) in of_streams.iter().zip(&blocks_of).zip(&mut visits) {
            let Some([first, last]) = way.ends else { continue };
            let start = ends.get(&first).copied().unwrap_or([f32::INFINITY; 2]);
            // After the first rounds few heights change. Where none did, the last visit left nothing to do.
            if visit.turn == 0 || visit.start != start || blocks.changed_after(visit.turn, own) {
                let turn = blocks.next_turn();
                let end = fall(way, grid, start, depth, heights, &allowed, &mut |cell| blocks.change(cell));
                changed |= blocks.changed_after(turn, own);
                *visit = Visit { turn, start, end };
            }
            let end = ends.entry(last).or_insert([f32::INFINITY; 2]);
            *end = [end[0].min(visit.end[0]), end[1].min(visit.end[1])];
        }
        if !changed {
            break;
        }
    }
}

/// Lowers heights along one stream. `most` and the result are the highest readings that its start and its end may have.
/// No height is lowered by more than `depth` below the stream. `changed` is told each cell that changes.
fn fall(
    way: &Way,
    grid: &Grid,
    mut most: [f32; 2],
    depth: f32,
    heights: &mut [f32],
    allowed: &impl Fn(usize, f32) -> Option<f32>,
    changed: &mut impl FnMut(usize),
) -> [f32; 2] {
    // The first cell is the last one of the streams that flow into this one.
    let mut below = most[0];
    for sample in &way.samples {
        let floor = sample.height - depth;
        // A cell that the stream comes back to cannot be lower than itself.
        if let Some(n) = sample.new_cell().filter(|&n| !heights[n].is_nan()) {
            if heights[n] > below
                && let Some(lowered) = allowed(n, below.max(floor)).filter(|lowered| *lowered < heights[n])
            {
                heights[n] = lowered;
                changed(n);
            }
            most[0] = most[0].min(heights[n]);
            below = most[0].next_down();
        }
        if let Some(corners) = sample.corners(grid) {
            let wanted = most[1].max(floor);
            if reading(heights, &corners) > wanted && move_to(wanted, heights, &corners, allowed) {
                corners.iter().for_each(|&(n, _)| changed(n));
            }
            most[1] = most[1].min(reading(heights, &corners));
        }
    }
    most
}

/// The last visit to a stream.
#[derive(Debug, Clone, Copy, Default)]
struct Visit {
    /// 0 before the first one.
    turn: u32,
    /// The highest readings that were allowed at the start and at the end.
    start: [f32; 2],
    end: [f32; 2],
}

/// The cells of a grid in blocks. It is known when a height of a block changed last.
struct Blocks {
    /// Columns of the grid and of the blocks.
    cols: [usize; 2],
    changed: Vec<u32>,
    turn: u32,
}

impl Blocks {
    fn new(grid: &Grid) -> Self {
        let [cols, rows] = [grid.cols, grid.rows].map(|n| n.div_ceil(BLOCK));
        Self { cols: [grid.cols, cols], changed: vec![0; cols * rows], turn: 0 }
    }

    fn of(&self, cell: usize) -> usize {
        let [of_grid, of_blocks] = self.cols;
        cell / of_grid / BLOCK * of_blocks + cell % of_grid / BLOCK
    }

    /// The blocks whose cells count along a stream.
    fn of_way(&self, way: &Way, grid: &Grid) -> Vec<usize> {
        let mut blocks: Vec<usize> = Vec::new();
        for block in way.samples.iter().flat_map(|sample| sample.cells(grid)).map(|n| self.of(n)) {
            if blocks.last() != Some(&block) {
                blocks.push(block);
            }
        }
        blocks.sort_unstable();
        blocks.dedup();
        blocks
    }

    /// Begins a turn. What changes from now on changes after it.
    fn next_turn(&mut self) -> u32 {
        self.turn += 1;
        self.turn
    }

    fn change(&mut self, cell: usize) {
        let block = self.of(cell);
        self.changed[block] = self.turn + 1;
    }

    fn changed_after(&self, turn: u32, blocks: &[usize]) -> bool {
        blocks.iter().any(|&block| self.changed[block] > turn)
    }
}

#[cfg(test)]
mod tests {
    use glam::{DVec2, DVec3};
    use proptest::prelude::*;

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
        fall_along(&ways, &mut heights, 100.0, nodes);
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
        fall_along(&ways, &mut heights, 100.0, cells);
        assert!(east(&heights).iter().all(|z| *z >= 100.0));
    }

    #[test]
    fn ground_beyond_a_contour_does_not_draw_a_stream_down() {
        // A level stream beside a contour of 100 m, at the edge of much lower ground that may not be raised.
        let grid = Grid::on_multiples(DVec2::ZERO, DVec2::new(40.0, 4.0), 1.0);
        let at = |k: usize| DVec3::new(1.0 + 0.5 * k as f64, 2.05 + 0.4 * (k as f64 / 6.0).sin(), 110.0);
        let streams = [Stream::between((0..76).map(at).collect(), Band { lo: 100.0, hi: 120.0 })];
        let mut heights: Vec<f32> = (0..160).map(|n| if n / 40 < 2 { 112.0 } else { 80.0 }).collect();
        let allowed = |n: usize, wanted: f32| (n / 40 < 2).then(|| wanted.clamp(100.0, 120.0));
        fall_along(&Ways::new(&streams, &grid), &mut heights, 20.0, allowed);
        let (upper, lower) = heights.split_at(80);
        assert!(upper.iter().all(|z| *z >= 109.0) && lower.iter().all(|z| *z == 80.0), "{heights:?}");
        assert!(upper.iter().any(|z| *z < 112.0));
    }

    #[test]
    fn streams_that_fall_already_stay_as_they_are_where_they_meet() {
        let grid = Grid::on_multiples(DVec2::ZERO, DVec2::splat(9.0), 1.0);
        let line = |places: [(f64, f64); 2]| {
            Stream::between(places.map(|(x, y)| DVec3::new(x, y, 0.0)).to_vec(), Band { lo: 0.0, hi: 100.0 })
        };
        let streams = [[(0.5, 8.5), (4.5, 4.5)], [(8.5, 8.5), (4.5, 4.5)], [(4.5, 4.5), (4.5, 0.5)]].map(line);
        let before: Vec<f32> = (0..81).map(|n| 50.0 - (n / 9) as f32).collect();
        let mut heights = before.clone();
        fall_along(&Ways::new(&streams, &grid), &mut heights, 100.0, |_, wanted| Some(wanted));
        assert_eq!(heights, before);
    }

    proptest! {
        #[test]
        fn streams_without_changes_need_no_visit(
            turns in proptest::collection::vec(proptest::collection::vec((0.0..40.0_f64, 0.0..40.0_f64), 2..5), 1..8),
            ground in proptest::collection::vec(0.0..9.0_f32, 1600),
        ) {
            let grid = Grid::on_multiples(DVec2::ZERO, DVec2::splat(40.0), 1.0);
            let band = Band { lo: 0.0, hi: 9.0 };
            // Each stream ends where the next one begins.
            let mut mouth = DVec3::ZERO;
            let streams: Vec<Stream> = turns
                .iter()
                .map(|turns| {
                    let points = turns.iter().map(|&(x, y)| DVec3::new(x, y, 0.0));
                    let points: Vec<DVec3> = std::iter::once(mouth).chain(points).collect();
                    mouth = points[points.len() - 1];
                    Stream::between(points, band)
                })
                .collect();
            let ways = Ways::new(&streams, &grid);
            let allowed = |n: usize, wanted: f32| (!n.is_multiple_of(7)).then(|| wanted.max(ground[n] - 3.0));
            let mut heights = ground.clone();
            fall_along(&ways, &mut heights, 9.0, allowed);
            let mut all = ground.clone();
            for _ in 0..ROUNDS {
                let mut most = [f32::INFINITY; 2];
                for way in &ways.of_streams {
                    most = super::fall(way, &grid, most, 0.45, &mut all, &allowed, &mut |_| ());
                }
            }
            prop_assert_eq!(heights, all);
        }
    }
}
