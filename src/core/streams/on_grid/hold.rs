//! Streams that hold the water of a grid.
//!
//! Programs that follow water over a height map take the steepest of the ways from a cell to its eight neighbours (D8;
//! O'Callaghan and Mark 1984, Computer Vision, Graphics and Image Processing 28). Where the ground beside a stream falls to
//! one side, or hardly falls at all, this way leaves the stream, even if heights fall along it. There, the banks are raised
//! until the way along the stream is the steepest one. Where they may not rise as far as that, the cells of the stream are
//! lowered. Both mostly take what the ground falls over the width of a cell. Nothing is changed where water stays in the
//! stream anyway.
//!
//! Banks come first because they concern one place. A stream that is lowered at one place is as low from there on.
//! Measured on all of Norway, contours every 200 m, cells of 200 m, against lowering alone: the height map is 10 m or more
//! below a stream at 7.7 instead of 14.5 % of the places on streams, and heights rise 0.47 instead of 0.53 m per kilometre. On
//! seven maps with true ground, water stays in 0.1 % fewer to 0.4 % more of the stream cells. The RMSE near streams changes by
//! 0.2 % at most.

use foldhash::HashSet;
use glam::DVec2;

use super::hollows::fill_new_hollows;
use super::ways::{Ways, move_to, reading};
use crate::base::parallel;
use crate::drain::{STEPS, neighbours};

/// Water that stays within a cell of a stream for so many steps is held.
const HELD_STEPS: usize = 10;
/// Lowering one cell changes the ways from its neighbours. After so many rounds, what is left is below what floors allow.
const ROUNDS: usize = 4;
/// Searches for leaks where banks are raised: water held at one place may leave at the next one.
const RAISES: usize = 2;
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

/// Raises banks, then lowers streams, until water stays within a cell of the streams. Then banks are lowered where they rise
/// between two cells of a stream. No height falls below its `floor` or rises above its `ceiling`, and none that is beyond
/// them changes. Hollows that raised banks make are filled. Heights that are NaN stay. Water in the cells of river areas
/// (`wide`) has not left its stream. `size` is that of a cell on the ground.
pub(crate) fn hold_along(
    ways: &Ways<'_>,
    wide: &HashSet<usize>,
    size: DVec2,
    heights: &mut [f32],
    floor: impl Fn(usize) -> f32,
    ceiling: impl Fn(usize) -> f32,
) {
    let mut held = Held::new(ways, wide, size, heights.len());
    for _ in 0..RAISES {
        let before = heights.to_vec();
        let raised = held.find_leaks(heights) && held.raise_banks(heights, &ceiling);
        held.forget_leaks();
        if !raised {
            break;
        }
        fill_new_hollows(ways, &before, heights, &ceiling);
    }
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
        let leaking = parallel::flat_map_each(&self.ways.of_streams, |way| self.new_leaks(&way.cells, heights));
        leaking.iter().for_each(|&cell| self.places[cell] = Place::Leak);
        !leaking.is_empty()
    }

    /// The cells of a stream from which water leaves the streams and that are not marked.
    fn new_leaks(&self, cells: &[usize], heights: &[f32]) -> Vec<usize> {
        let mut leaks = Vec::new();
        // The cell further downstream that was looked at last, if its water stays. Water that runs there stays too.
        let mut holds = None;
        for &cell in cells.iter().rev().filter(|&&cell| self.places[cell] != Place::Leak) {
            let next = self.downstream(heights, cell);
            let stays = next.is_none() || next == holds || {
                let mut way = std::iter::successors(next, |&at| self.downstream(heights, at)).take(HELD_STEPS);
                way.all(|at| self.places[at] != Place::Away)
            };
            holds = stays.then_some(cell);
            if !stays {
                leaks.push(cell);
            }
        }
        leaks
    }

    /// Takes the marks of leaks away.
    fn forget_leaks(&mut self) {
        self.ways.cells().for_each(|cell| self.places[cell] = Place::Stream);
    }

    /// Raises banks at leaks until the way along the stream is steeper than that to them. Banks that may not rise as far as
    /// that stay. Whether one was changed.
    fn raise_banks(&self, heights: &mut [f32], ceiling: impl Fn(usize) -> f32) -> bool {
        let mut changed = false;
        for pair in self.ways.of_streams.iter().flat_map(|way| way.cells.windows(2)) {
            let (from, to) = (pair[0], pair[1]);
            if self.places[from] != Place::Leak {
                continue;
            }
            let Some((_, length)) = self.around(from).find(|(n, _)| *n == to) else { continue };
            // 0 also where the stream leaves the ground: its water runs off there, not along the border.
            let fall = ((heights[from] - heights[to]) / length).max(0.0);
            for (bank, distance) in self.around(from).filter(|(n, _)| self.places[*n] < Place::Stream) {
                let holds = (heights[from] - fall * distance).next_up();
                if heights[bank] < holds && holds <= ceiling(bank) {
                    heights[bank] = holds;
                    changed = true;
                }
            }
        }
        changed
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
            let [holds, falls] = [heights[from] - steepest * length, heights[from]].map(f32::next_down);
            if heights[to] <= holds {
                continue;
            }
            let lowest = floor(to);
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

    /// A level stream of 20 cells along row 2. From north to south, the rows of the ground have these heights.
    fn held_between(rows: [f32; 5], floor: f32, ceiling: f32) -> Vec<f32> {
        let grid = Grid::on_multiples(DVec2::ZERO, DVec2::new(20.0, 5.0), 1.0);
        let at = |k: usize| DVec3::new(0.5 + k as f64, 2.5, rows[2].into());
        let streams = [Stream::between((0..20).map(at).collect(), Band { lo: 0.0, hi: 200.0 })];
        let mut heights: Vec<f32> = rows.into_iter().flat_map(|z| [z; 20]).collect();
        let ways = Ways::new(&streams, &grid);
        hold_along(&ways, &HashSet::default(), DVec2::ONE, &mut heights, |_| floor, |_| ceiling);
        heights
    }

    /// Heights along a level stream of 20 cells that may be lowered to `floor`, beside ground that is 40 m lower.
    fn held(floor: f32) -> Vec<f32> {
        held_between([110.0, 105.0, 100.0, 60.0, 50.0], floor, f32::NEG_INFINITY)[40..60].to_vec()
    }

    #[test]
    fn leaks_are_where_water_comes_away_from_the_streams() {
        let grid = Grid::on_multiples(DVec2::ZERO, DVec2::new(40.0, 15.0), 1.0);
        // Two streams that meet: along row 7, and from the north into its middle.
        let line = |places: [(f64, f64); 2]| {
            let points = places.map(|(x, y)| DVec3::new(x, y, 0.0)).to_vec();
            Stream::between(points, Band { lo: 0.0, hi: 200.0 })
        };
        let streams = [[(12.5, 14.5), (19.5, 7.5)], [(0.5, 7.5), (39.5, 7.5)]].map(line);
        let ways = Ways::new(&streams, &grid);
        let (mut leaking, mut holding) = (0, 0);
        for trial in 1..=100 {
            // A valley along row 7 that falls to the east, with more and more rough ground.
            let ground: Vec<f32> = (0..600)
                .map(|n| {
                    let rough = (f64::from(n * trial) * 0.618_034).fract() * 0.1 * f64::from(trial);
                    (0.5 * f64::from(n / 40 - 7).abs() - 0.2 * f64::from(n % 40) + rough) as f32
                })
                .collect();
            let mut held = Held::new(&ways, &HashSet::default(), DVec2::ONE, 600);
            for search in 0..2 {
                // Marked leaks are not told again.
                for way in &ways.of_streams {
                    let comes_away = |&&cell: &&usize| {
                        let way = std::iter::successors(Some(cell), |&at| held.downstream(&ground, at));
                        way.take(HELD_STEPS + 1).any(|at| held.places[at] == Place::Away)
                    };
                    let expected: Vec<usize> = way.cells.iter().filter(comes_away).copied().collect();
                    let mut found = held.new_leaks(&way.cells, &ground);
                    found.reverse();
                    assert_eq!(found, if search == 0 { expected } else { Vec::new() }, "trial {trial}");
                    leaking += found.len();
                    holding += way.cells.len() - found.len();
                }
                assert_eq!(held.find_leaks(&ground), held.places.contains(&Place::Leak) && search == 0);
            }
        }
        assert!(leaking > 300 && holding > 300, "{leaking} {holding}");
    }

    #[test]
    fn a_stream_is_not_lowered_where_that_does_not_hold_its_water() {
        assert!(held(90.0).iter().all(|z| *z > 99.9), "{:?}", held(90.0));
        assert!(held(0.0)[19] < 61.0, "{:?}", held(0.0));
    }

    #[test]
    fn a_bank_is_raised_rather_than_that_a_stream_is_lowered() {
        let rows = [110.0, 105.0, 100.0, 90.0, 80.0];
        let heights = held_between(rows, 0.0, 101.0);
        // The stream falls by the least step from cell to cell.
        assert!(heights[40..60].iter().all(|z| *z > 99.9), "{:?}", &heights[40..60]);
        assert!(heights[60..79].iter().all(|z| *z > 99.9 && *z < 100.1), "{:?}", &heights[60..80]);
        assert!(heights[80..].iter().all(|z| *z == 80.0), "ground beside the bank stays");
        // Where a bank may not rise as far as that, it stays, and the stream is lowered.
        let heights = held_between(rows, 0.0, 99.0);
        assert!(heights[60..80].iter().all(|z| *z == 90.0), "{:?}", &heights[60..80]);
        assert!(heights[59] < 91.0, "{:?}", &heights[40..60]);
    }

    #[test]
    fn no_water_stays_behind_a_raised_bank() {
        let grid = Grid::on_multiples(DVec2::ZERO, DVec2::new(20.0, 7.0), 1.0);
        let at = |k: usize| DVec3::new(0.5 + k as f64, 3.5, 100.0 - 0.1 * k as f64);
        let streams = [Stream::between((0..20).map(at).collect(), Band { lo: 0.0, hi: 200.0 })];
        // South of the stream, in row 4, a gully runs along it and turns away. A hollow drains into the gully.
        let height = |row: usize, k: usize| match (row, k) {
            (0..=2, _) => 103.0,
            (3, k) => 100.0 - 0.1 * k as f32,
            (4, 3..=12) => 98.0 - 0.3 * k as f32,
            (5, 8) => 97.0,
            (5, 13) => 93.0,
            (6, 13) => 90.0,
            _ => 101.0 + row as f32,
        };
        let before: Vec<f32> = (0..7).flat_map(|row| (0..20).map(move |k| height(row, k))).collect();
        let mut heights = before.clone();
        let ways = Ways::new(&streams, &grid);
        hold_along(&ways, &HashSet::default(), DVec2::ONE, &mut heights, |_| 0.0, |_| 150.0);
        assert!(heights[80..99].iter().zip(&before[80..99]).any(|(z, before)| z > before), "banks were raised");
        assert!(heights[5 * 20 + 8] > 97.0, "the hollow is filled");
        let inside = (1..6).flat_map(|row| (1..19).map(move |k| 20 * row + k));
        let is_pit = |&n: &usize| neighbours(n, 20, 7).flatten().all(|(_, near)| heights[near] > heights[n]);
        assert_eq!(inside.filter(is_pit).collect::<Vec<_>>(), [0usize; 0]);
    }
}
