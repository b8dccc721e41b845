//! River areas on a grid: their cells are level across.

use foldhash::{HashMap, HashSet};
use rstar::primitives::GeomWithData;
use rstar::{PointDistance, RTree};

use super::ways::Ways;
use crate::base::{Grid, parallel};
use crate::drain::neighbours;
use crate::streams::Stream;

/// A smaller share of a squared distance is a rounding error.
const ROUNDING: f64 = 1e-9;

/// The centre of a cell and the number of the cell.
type Centre = GeomWithData<[f64; 2], usize>;

/// Which cells of river areas have the height of which cells of streams: each one that of the nearest cell in its area that
/// a stream runs through. Where a side stream enters the water of a river, it has the height of the river.
pub(crate) struct AreaLevels {
    /// Cells, each with its nearest stream cell. Where several are as near, there is a pair for each, one after the other.
    pairs: Vec<(usize, usize)>,
}

impl AreaLevels {
    /// `areas` are the cells of each area. Those without ground, where `heights` are NaN, have no part in it.
    pub(crate) fn new(areas: &[Vec<usize>], streams: &[Stream], ways: &Ways<'_>, heights: &[f32]) -> Self {
        if areas.is_empty() {
            return Self { pairs: Vec::new() };
        }
        let grid = ways.grid;
        let in_streams: HashSet<usize> = ways.cells().collect();
        let entering = entering(areas, streams, ways);
        let pairs = parallel::map_each(areas, |area| {
            let area = area.iter().copied().filter(|n| !heights[*n].is_nan());
            let (middle, beside): (Vec<usize>, Vec<usize>) =
                area.partition(|n| in_streams.contains(n) && !entering.contains(n));
            nearest(&middle, &beside, grid)
        });
        Self { pairs: pairs.concat() }
    }

    /// Makes the areas level across, as far as this is `allowed`.
    pub(crate) fn level(&self, heights: &mut [f32], allowed: impl Fn(usize, f32) -> Option<f32>) {
        for pairs in self.pairs.chunk_by(|a, b| a.0 == b.0) {
            let cell = pairs[0].0;
            // Of two that are as near, the upstream one counts. The other one would draw water out of the stream.
            let level = pairs.iter().map(|&(_, nearest)| heights[nearest]).reduce(f32::max);
            if let Some(level) = level.and_then(|level| allowed(cell, level)) {
                heights[cell] = level;
            }
        }
    }
}

/// The pairs of [`AreaLevels`] in one area.
fn nearest(middle: &[usize], beside: &[usize], grid: &Grid) -> Vec<(usize, usize)> {
    let middle = index(middle.iter().copied(), grid);
    let nearest = |&cell: &usize| {
        let at = centre(cell, grid);
        let distance = middle.nearest_neighbor(&at).map_or(f64::NAN, |nearest| nearest.distance_2(&at));
        let as_near = middle.locate_within_distance(at, distance * (1.0 + ROUNDING));
        as_near.map(|near| (cell, near.data)).collect::<Vec<_>>()
    };
    beside.iter().flat_map(nearest).collect()
}

/// The cells of side streams that are in the water of their river or near it: nearer to a cell of the river than twice the
/// way from there to its bank. So no water of the river is nearer to the rest of the side stream.
fn entering(areas: &[Vec<usize>], streams: &[Stream], ways: &Ways<'_>) -> HashSet<usize> {
    let grid = ways.grid;
    let wet: HashSet<usize> = areas.iter().flatten().copied().collect();
    let beside = wet.iter().flat_map(|&n| neighbours(n, grid.cols, grid.rows).flatten());
    let banks: HashSet<usize> = beside.map(|(_, n)| n).filter(|n| !wet.contains(n)).collect();
    let banks = index(banks.into_iter(), grid);
    let in_water = |stream: usize| ways.of_streams[stream].cells.iter().copied().filter(|n| wet.contains(n));
    let of_side_stream = |(side, rivers): (usize, Vec<usize>)| {
        let mut entering = Vec::new();
        let side = index(in_water(side), grid);
        if side.size() == 0 {
            return entering;
        }
        let of_rivers: HashSet<usize> = rivers.iter().flat_map(|river| in_water(*river)).collect();
        for &river in &of_rivers {
            let at = centre(river, grid);
            let to_bank = banks.nearest_neighbor(&at).map_or(0.0, |bank| bank.distance_2(&at).sqrt());
            let near = side.locate_within_distance(at, (2.0 * to_bank).powi(2));
            entering.extend(near.map(|cell| cell.data).filter(|n| !of_rivers.contains(n)));
        }
        entering
    };
    side_streams(streams).into_iter().flat_map(of_side_stream).collect()
}

/// The streams that end in a river, each with the pieces of this river above and below. Where streams meet, the river is the
/// one of the highest order; of these, the one whose water comes the longest way.
fn side_streams(streams: &[Stream]) -> Vec<(usize, Vec<usize>)> {
    let mut below: HashMap<[u64; 2], usize> = HashMap::default();
    let mut above: HashMap<[u64; 2], (u32, f64, usize)> = HashMap::default();
    for (k, stream) in streams.iter().enumerate() {
        let Some([first, last]) = stream.ends() else { continue };
        below.insert(first, k);
        let way = stream.length() + above.get(&first).map_or(0.0, |river| river.1);
        let river = above.entry(last).or_insert((stream.order, way, k));
        if (stream.order, way) > (river.0, river.1) {
            *river = (stream.order, way, k);
        }
    }
    let of_stream = |(k, stream): (usize, &Stream)| {
        let [_, end] = stream.ends()?;
        let river = above.get(&end)?.2;
        (river != k).then(|| (k, std::iter::once(river).chain(below.get(&end).copied()).collect()))
    };
    streams.iter().enumerate().filter_map(of_stream).collect()
}

fn index(cells: impl Iterator<Item = usize>, grid: &Grid) -> RTree<Centre> {
    RTree::bulk_load(cells.map(|n| Centre::new(centre(n, grid), n)).collect())
}

fn centre(cell: usize, grid: &Grid) -> [f64; 2] {
    grid.center(cell % grid.cols, cell / grid.cols).to_array()
}

#[cfg(test)]
mod tests {
    use glam::DVec2;

    use super::*;
    use crate::subdomains::Band;

    #[test]
    fn a_river_area_gets_the_heights_of_the_stream_cells_in_it() {
        let grid = Grid { corner: DVec2::new(0.0, 4.0), cell: DVec2::ONE, cols: 8, rows: 4 };
        let points = [0, 3].map(|row| grid.center(2, row).extend(0.0));
        let streams = [Stream::between(points.to_vec(), Band { lo: 0.0, hi: 200.0 })];
        // The banks of the stream are uneven. A contour holds one cell, one has no ground, and no stream runs through the
        // area in the last two columns.
        let (held, outside_ground) = (8 + 1, 16 + 3);
        let ground = |n: usize| match (n / 8, n % 8) {
            (2, 3) => f32::NAN,
            (row, 2) => 90.0 - 3.0 * row as f32,
            (row, col) => 80.0 + (3 * row + 7 * col) as f32,
        };
        let before: Vec<f32> = (0..grid.len()).map(ground).collect();
        let area = |cols: [usize; 2]| (0..grid.len()).filter(|n| (cols[0]..=cols[1]).contains(&(n % 8))).collect();
        let mut heights = before.clone();
        let allowed = |cell: usize, wanted: f32| (cell != held).then_some(wanted.min(88.5));
        AreaLevels::new(&[area([1, 4]), area([6, 7])], &streams, &Ways::new(&streams, &grid), &before)
            .level(&mut heights, allowed);
        for (n, height) in heights.into_iter().enumerate() {
            let is_level = (1..=4).contains(&(n % 8)) && n % 8 != 2 && n != held;
            match n {
                _ if n == outside_ground => assert!(height.is_nan()),
                _ if is_level => assert_eq!(height, before[n / 8 * 8 + 2].min(88.5), "cell {n}"),
                _ => assert_eq!(height, before[n], "cell {n}"),
            }
        }
    }

    #[test]
    fn beside_a_bend_the_water_has_the_height_upstream() {
        let grid = Grid { corner: DVec2::new(0.0, 0.3), cell: DVec2::splat(0.1), cols: 3, rows: 3 };
        let points = [0, 1, 2].map(|k| grid.center(k, k).extend(0.0));
        let streams = [Stream::between(points.to_vec(), Band { lo: 0.0, hi: 200.0 })];
        let mut heights = vec![0.0; 9];
        (heights[0], heights[4], heights[8]) = (30.0, 20.0, 10.0);
        let area: Vec<usize> = (0..9).collect();
        AreaLevels::new(&[area], &streams, &Ways::new(&streams, &grid), &heights)
            .level(&mut heights, |_, wanted| Some(wanted));
        assert_eq!(heights, [30.0, 30.0, 20.0, 30.0, 20.0, 20.0, 20.0, 20.0, 10.0]);
    }

    #[test]
    fn a_side_stream_has_the_height_of_the_river_from_its_bank_on() {
        // A river of order 2 falls eastwards in row 9, its water is in rows 7 to 11. A side stream comes down column 10, and
        // the water goes up this valley to row 0.
        let grid = Grid { corner: DVec2::new(0.0, 14.0), cell: DVec2::ONE, cols: 20, rows: 14 };
        let line = |from: [usize; 2], to: [usize; 2], order| {
            let points = [from, to].map(|[col, row]| grid.center(col, row).extend(0.0));
            Stream { order, ..Stream::between(points.to_vec(), Band { lo: 0.0, hi: 200.0 }) }
        };
        let streams = [line([10, 0], [10, 9], 1), line([0, 9], [10, 9], 2), line([10, 9], [19, 9], 2)];
        let is_wet = |col: usize, row: usize| (7..=11).contains(&row) || row < 7 && (8..=12).contains(&col);
        let area: Vec<usize> = (0..grid.len()).filter(|n| is_wet(n % 20, n / 20)).collect();
        let ground = |n: usize| match (n % 20, n / 20) {
            (col, 9) => 50.0 - col as f32,
            (10, row) if row < 9 => 60.0 - row as f32,
            _ => 100.0,
        };
        let mut heights: Vec<f32> = (0..grid.len()).map(ground).collect();
        AreaLevels::new(&[area], &streams, &Ways::new(&streams, &grid), &heights)
            .level(&mut heights, |_, wanted| Some(wanted));
        let row = |row: usize| heights[20 * row + 8..20 * row + 13].to_vec();
        assert_eq!([row(0), row(1)], [vec![60.0; 5], vec![59.0; 5]], "the side valley is level across");
        for beside in [7, 8, 10, 11] {
            assert_eq!(row(beside), [42.0, 41.0, 40.0, 39.0, 38.0], "the river is level across in row {beside}");
        }
        assert_eq!(heights[20 * 12 + 10], 100.0, "the ground stays");
    }
}
