//! Streams that hold the water of a grid.
//!
//! Programs that follow water over a height map take the steepest of the ways from a cell to its eight neighbours (D8;
//! O'Callaghan and Mark 1984, Computer Vision, Graphics and Image Processing 28). Where the ground beside a stream falls to
//! one side, or hardly falls at all, this way leaves the stream, even if heights fall along it. There, the cells of the
//! stream are lowered, until the way along the stream is the steepest one. That mostly takes what the ground falls over
//! the width of a cell. No trench is dug where water stays in the stream anyway.

use foldhash::HashSet;
use glam::DVec2;

use super::ways::{Ways, move_to, reading};
use crate::base::parallel;
use crate::drain::{STEPS, neighbours};

/// Water that stays within a cell of a stream for so many steps is held.
const HELD_STEPS: usize = 10;
/// Lowering one cell changes the ways from its neighbours. After so many rounds, what is left is below what floors allow.
const ROUNDS: usize = 4;
/// Searches for leaks, and how often banks are lowered in between.
const SEARCHES: usize = 2;
const BANK_ROUNDS: usize = 2;

/// Where a cell lies.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Place {
    Away,
    /// A neighbour of a cell of a stream, or in a river area.
    Bank,
    Stream,
    /// In a stream that does not hold its water there.
    Leak,
}

/// Lowers heights along streams until their water stays within a cell of them. Then banks are lowered where they rise
/// between two cells of a stream. No height falls below its `floor`, and none that is below it changes. Heights that are
/// NaN stay. Water in the cells of river areas (`wide`) has not left its stream. `size` is that of a cell on the ground.
pub(crate) fn hold_along(
    ways: &Ways<'_>,
    wide: &HashSet<usize>,
    size: DVec2,
    heights: &mut [f32],
    floor: impl Fn(usize) -> f32,
) {
    let mut held = Held::new(ways, wide, size, heights.len());
    for round in 0..=BANK_ROUNDS {
        for _ in 0..SEARCHES {
            let leaks = held.find_leaks(heights);
            let rounds = (0..ROUNDS).take_while(|_| held.lower_streams(heights, &floor)).count();
            if !leaks && rounds == 0 {
                break;
            }
        }
        if round == BANK_ROUNDS || !held.lower_banks(heights, &floor) {
            break;
        }
    }
}

struct Held<'a> {
    ways: &'a Ways<'a>,
    places: Vec<Place>,
    /// The distance of each neighbour, in the order of [`STEPS`].
    distances: [f32; 8],
}

impl<'a> Held<'a> {
    fn new(ways: &'a Ways<'a>, wide: &HashSet<usize>, size: DVec2, cells: usize) -> Self {
        let mut places = vec![Place::Away; cells];
        wide.iter().for_each(|&cell| places[cell] = Place::Bank);
        for cell in ways.cells() {
            for (_, bank) in neighbours(cell, ways.grid.cols, ways.grid.rows).flatten() {
                places[bank] = places[bank].max(Place::Bank);
            }
            places[cell] = Place::Stream;
        }
        let distances = STEPS.map(|(x, y)| (size * DVec2::new(x as f64, y as f64)).length() as f32);
        Self { ways, places, distances }
    }

    /// The neighbours of a cell, with their distances.
    fn around(&self, cell: usize) -> impl Iterator<Item = (usize, f32)> {
        neighbours(cell, self.ways.grid.cols, self.ways.grid.rows).flatten().map(|(step, n)| (n, self.distances[step]))
    }

    /// Where water runs to from a cell, if a neighbour is lower.
    fn downstream(&self, heights: &[f32], cell: usize) -> Option<usize> {
        let fall = |(n, distance): (usize, f32)| ((heights[cell] - heights[n]) / distance, n);
        let falls = self.around(cell).map(fall).filter(|(fall, _)| *fall > 0.0);
        falls.reduce(|a, b| if b.0 > a.0 { b } else { a }).map(|(_, n)| n)
    }

    /// Marks the cells from which water leaves the streams. Whether there are new ones.
    fn find_leaks(&mut self, heights: &[f32]) -> bool {
        let leaks = |&cell: &usize| {
            let mut way = std::iter::successors(Some(cell), |&at| self.downstream(heights, at)).take(HELD_STEPS + 1);
            self.places[cell] != Place::Leak && way.any(|at| self.places[at] == Place::Away)
        };
        let leaking = parallel::flat_map_each(&self.ways.of_streams, |way| {
            way.cells.iter().copied().filter(leaks).collect::<Vec<_>>()
        });
        leaking.iter().for_each(|&cell| self.places[cell] = Place::Leak);
        !leaking.is_empty()
    }

    /// Lowers the cells of streams until heights fall along them, below leaks as steeply as to any bank. Whether one was
    /// changed.
    fn lower_streams(&self, heights: &mut [f32], floor: impl Fn(usize) -> f32) -> bool {
        let mut changed = false;
        for pair in self.ways.of_streams.iter().flat_map(|way| way.cells.windows(2)) {
            let (from, to) = (pair[0], pair[1]);
            let Some((_, length)) = self.around(from).find(|(n, _)| *n == to) else { continue };
            let mut steepest = 0.0f32;
            if self.places[from] == Place::Leak {
                let banks = self.around(from).filter(|(n, _)| self.places[*n] < Place::Stream);
                steepest = banks.map(|(n, distance)| (heights[from] - heights[n]) / distance).fold(0.0, f32::max);
            }
            let lowest = floor(to);
            let [holds, falls] = [heights[from] - steepest * length, heights[from]].map(f32::next_down);
            // A cut that is not deep enough for the water to stay is only a trench.
            let most = if lowest <= holds { holds } else { falls };
            if heights[to] > most {
                let lowered = most.max(lowest).min(heights[to]);
                changed |= lowered < heights[to];
                heights[to] = lowered;
            }
        }
        changed
    }

    /// Lowers banks between which heights rise along streams. Whether one was changed.
    fn lower_banks(&self, heights: &mut [f32], floor: impl Fn(usize) -> f32) -> bool {
        // Cells of streams stay.
        let allowed = |n: usize, wanted: f32| (self.places[n] < Place::Stream).then(|| wanted.max(floor(n)));
        let mut changed = false;
        for way in &self.ways.of_streams {
            let mut most = f32::INFINITY;
            for corners in way.samples.iter().filter_map(|sample| sample.corners(self.ways.grid)) {
                if reading(heights, &corners) > most {
                    changed |= move_to(most, heights, &corners, &allowed);
                }
                most = most.min(reading(heights, &corners));
            }
        }
        changed
    }
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::*;
    use crate::base::Grid;
    use crate::streams::Stream;
    use crate::subdomains::Band;

    /// Heights along a level stream of 20 cells that may be lowered to `floor`, beside ground that is 40 m lower.
    fn held(floor: f32) -> Vec<f32> {
        let grid = Grid::on_multiples(DVec2::ZERO, DVec2::new(20.0, 5.0), 1.0);
        let at = |k: usize| DVec3::new(0.5 + k as f64, 2.5, 100.0);
        let streams = [Stream::between((0..20).map(at).collect(), Band { lo: 0.0, hi: 200.0 })];
        let mut heights: Vec<f32> = [110.0, 105.0, 100.0, 60.0, 50.0].into_iter().flat_map(|z| [z; 20]).collect();
        hold_along(&Ways::new(&streams, &grid), &HashSet::default(), DVec2::ONE, &mut heights, |_| floor);
        heights[40..60].to_vec()
    }

    #[test]
    fn a_stream_is_not_lowered_where_that_does_not_hold_its_water() {
        assert!(held(90.0).iter().all(|z| *z > 99.9), "{:?}", held(90.0));
        assert!(held(0.0)[19] < 61.0, "{:?}", held(0.0));
    }
}
