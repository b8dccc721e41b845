//! Hollows beside streams.
//!
//! Between contours and far from them, the surface may lie lower beside a stream than the stream itself. Water would leave
//! the stream, and come back where the stream is lowest. Such a hollow is filled up to the stream. Lowering the stream to
//! its bottom instead would lower all of the stream below.
//!
//! Measured on all of Norway, contours every 200 m, cells of 200 m: water stays within a cell of 95.5 instead of 94.7 % of
//! the stream cells, heights rise 0.53 instead of 0.56 m per kilometre of stream, and there are 34,823 pits instead of
//! 40,305. On five maps with true ground, the RMSE near streams changes by less than 0.1 %.

use foldhash::HashSet;

use super::ways::Ways;
use crate::base::{Grid, parallel};
use crate::drain::{Flood, neighbours, sortable};

/// Largest number of cells of a hollow. It limits time.
const LARGEST: usize = 20_000;
/// The same for hollows behind raised banks. They are small.
const LARGEST_NEW: usize = 200;

/// Fills the hollows whose rim is lowest where a stream runs through it, as far as this is `allowed`. Hollows with
/// a cell that `stays` are left. Heights that are NaN stay.
pub(crate) fn fill_hollows(
    ways: &Ways<'_>,
    heights: &mut [f32],
    stays: impl Fn(usize) -> bool,
    allowed: impl Fn(usize, f32) -> Option<f32>,
) {
    let grid = ways.grid;
    let in_streams: HashSet<usize> = ways.cells().collect();
    let rows: Vec<usize> = (0..grid.rows).collect();
    let before: &[f32] = heights;
    let found = parallel::flat_map_each(&rows, |row| {
        let cells = row * grid.cols..(row + 1) * grid.cols;
        let bottoms = cells.filter(|&cell| is_bottom(cell, grid, before) && !in_streams.contains(&cell));
        bottoms.filter_map(|bottom| Hollow::beside_stream(bottom, &in_streams, grid, before)).collect::<Vec<_>>()
    });
    for Hollow { cells, level } in found {
        if cells.iter().any(|&cell| stays(cell)) {
            continue;
        }
        for cell in cells {
            if let Some(filled) = allowed(cell, level).filter(|filled| *filled > heights[cell]) {
                heights[cell] = filled;
            }
        }
    }
}

/// Fills the hollows that are new since heights were raised from `before`, until water runs off. A hollow of which a cell
/// would rise above its `ceiling` is left.
pub(super) fn fill_new_hollows(ways: &Ways<'_>, before: &[f32], heights: &mut [f32], ceiling: impl Fn(usize) -> f32) {
    let grid = ways.grid;
    let in_streams: HashSet<usize> = ways.cells().collect();
    let around = |cell: usize| neighbours(cell, grid.cols, grid.rows).flatten().map(|(_, near)| near).chain([cell]);
    let raised = (0..heights.len()).filter(|&cell| heights[cell] > before[cell]);
    let mut near_raised: Vec<usize> = raised.flat_map(around).filter(|cell| !in_streams.contains(cell)).collect();
    near_raised.sort_unstable();
    near_raised.dedup();
    for bottom in near_raised {
        if !is_bottom(bottom, grid, heights) || is_bottom(bottom, grid, before) {
            continue;
        }
        let Some(Hollow { cells, level }) = Hollow::anywhere(bottom, &in_streams, grid, heights) else { continue };
        if cells.iter().all(|&cell| level <= ceiling(cell)) {
            cells.into_iter().for_each(|cell| heights[cell] = level);
        }
    }
}

/// Whether all neighbours are higher. No water stays on the border of the grid and beside cells without height.
fn is_bottom(cell: usize, grid: &Grid, heights: &[f32]) -> bool {
    neighbours(cell, grid.cols, grid.rows).all(|near| near.is_some_and(|(_, near)| is_lower(cell, near, heights)))
}

/// Whether a cell is lower than another one. Of level ground, the first cell counts as the lowest, so that each hollow has one
/// bottom.
fn is_lower(cell: usize, other: usize, heights: &[f32]) -> bool {
    heights[cell] < heights[other] || heights[cell] == heights[other] && cell < other
}

/// Ground that water fills before it runs off.
struct Hollow {
    /// Its cells below the level.
    cells: Vec<usize>,
    /// Height of the water, metres.
    level: f32,
}

impl Hollow {
    /// The hollow with a lowest cell, if water runs off from it into a stream, and over no higher place.
    fn beside_stream(bottom: usize, in_streams: &HashSet<usize>, grid: &Grid, heights: &[f32]) -> Option<Self> {
        let is_out = |cell, _| is_lower(cell, bottom, heights);
        let runoff = Runoff::from(bottom, in_streams, (grid, heights), LARGEST, is_out)?;
        (runoff.is_in_stream && runoff.height >= runoff.rim).then(|| runoff.fills_to(runoff.height, heights))
    }

    /// The hollow with a lowest cell, from which water runs off to lower ground or into a stream.
    fn anywhere(bottom: usize, in_streams: &HashSet<usize>, grid: &Grid, heights: &[f32]) -> Option<Self> {
        let is_out = |cell: usize, rim| heights[cell] < rim;
        let runoff = Runoff::from(bottom, in_streams, (grid, heights), LARGEST_NEW, is_out)?;
        Some(runoff.fills_to(runoff.rim.max(runoff.height), heights))
    }
}

/// Where water that rises in a hollow runs off.
struct Runoff {
    /// The cells that it has reached before.
    cells: Vec<usize>,
    /// The highest of these cells.
    rim: f32,
    /// The height where it runs off.
    height: f32,
    is_in_stream: bool,
}

impl Runoff {
    /// Water rises from a lowest cell until it reaches a stream, or ground that `is_out`, from the cell and the highest cell
    /// before it. `None` if it reaches the border of the grid or a cell without height, or after `largest` cells.
    fn from(
        bottom: usize,
        in_streams: &HashSet<usize>,
        (grid, heights): (&Grid, &[f32]),
        largest: usize,
        is_out: impl Fn(usize, f32) -> bool,
    ) -> Option<Self> {
        // Of places as high, water reaches the stream first. Banks are often as high as it, and between two cells of a
        // stream that meet at a corner, water would run across it.
        let key = |cell: usize| (sortable(heights[cell]), !in_streams.contains(&cell));
        let mut rim = heights[bottom];
        let mut seen: HashSet<usize> = std::iter::once(bottom).collect();
        let mut flood = Flood::new();
        flood.push(bottom, key(bottom));
        let mut cells = Vec::new();
        while let Some((cell, (_, is_land))) = flood.pop() {
            let height = heights[cell];
            if !is_land || is_out(cell, rim) {
                return Some(Self { cells, rim, height, is_in_stream: !is_land });
            }
            if cells.len() == largest {
                return None;
            }
            rim = rim.max(height);
            cells.push(cell);
            for near in neighbours(cell, grid.cols, grid.rows) {
                let (_, near) = near.filter(|(_, near)| heights[*near].is_finite())?;
                if seen.insert(near) {
                    flood.push(near, key(near));
                }
            }
        }
        None
    }

    /// The hollow that is full at a level.
    fn fills_to(&self, level: f32, heights: &[f32]) -> Hollow {
        Hollow { cells: self.cells.iter().copied().filter(|&cell| heights[cell] < level).collect(), level }
    }
}

#[cfg(test)]
mod tests {
    use glam::DVec2;

    use super::*;
    use crate::streams::Stream;
    use crate::subdomains::Band;

    const COLS: usize = 9;

    /// A stream down column 4, from 50 to 42 m. The ground rises from it by 1 m per column; `hollow` changes it.
    fn filled(hollow: impl Fn(usize, usize) -> Option<f32>, stays: impl Fn(usize) -> bool) -> (Vec<f32>, Vec<f32>) {
        let grid = Grid { corner: DVec2::new(0.0, 9.0), cell: DVec2::ONE, cols: COLS, rows: 9 };
        let points = [0, 8].map(|row| grid.center(4, row).extend(0.0));
        let streams = [Stream::between(points.to_vec(), Band { lo: 0.0, hi: 200.0 })];
        let ground = |n: usize| {
            let (row, col) = (n / COLS, n % COLS);
            hollow(row, col).unwrap_or(50.0 - row as f32 + col.abs_diff(4) as f32)
        };
        let before: Vec<f32> = (0..grid.len()).map(ground).collect();
        let mut heights = before.clone();
        fill_hollows(&Ways::new(&streams, &grid), &mut heights, stays, |_, wanted| Some(wanted));
        (before, heights)
    }

    #[test]
    fn a_hollow_beside_a_stream_is_filled_to_the_lowest_place_of_the_stream_at_it() {
        let hollow = |row: usize, col: usize| ((3..=5).contains(&row) && (5..=6).contains(&col)).then_some(30.0);
        let (before, heights) = filled(hollow, |_| false);
        for (n, height) in heights.iter().enumerate() {
            // The stream leaves the hollow in row 6, from a neighbour of the hollow's last cell.
            let wanted = if before[n] == 30.0 { 44.0 } else { before[n] };
            assert_eq!(*height, wanted, "cell {n}");
        }
        let (before, heights) = filled(hollow, |n| n == 4 * COLS + 6);
        assert_eq!(before, heights, "where water may stay, nothing is filled");
    }

    #[test]
    fn hollows_that_run_off_elsewhere_stay() {
        // On a slope above the stream: water runs off over the slope.
        let (before, heights) = filled(|row, col| (row == 4 && col == 7).then_some(40.0), |_| false);
        assert_eq!(before, heights);
        // Beside the stream, but at the border there is lower ground.
        let to_border = |row: usize, col: usize| match (row, col) {
            (4, 5..=7) => Some(30.0),
            (4, 8) => Some(33.0),
            _ => None,
        };
        let (before, heights) = filled(to_border, |_| false);
        assert_eq!(before, heights);
        // The same beside cells without height.
        let (before, heights) =
            filled(|row, col| (row == 4 && col > 4).then_some(if col == 7 { f32::NAN } else { 30.0 }), |_| false);
        assert!(before.iter().zip(&heights).all(|(a, b)| a.to_bits() == b.to_bits()));
    }

    #[test]
    fn no_water_runs_across_a_stream_between_banks_as_high_as_it() {
        // The stream runs from corner to corner. The ground falls away on its other side.
        let grid = Grid { corner: DVec2::new(0.0, 9.0), cell: DVec2::ONE, cols: COLS, rows: 9 };
        let streams =
            [Stream::between([0, 8].map(|k| grid.center(k, k).extend(0.0)).to_vec(), Band { lo: 0.0, hi: 99.0 })];
        let ground = |n: usize| match (n / COLS, n % COLS) {
            (row, col) if row.abs_diff(col) <= 1 => 50.0,
            (3..=4, 6) => 30.0,
            (row, col) if row < col => 60.0,
            (row, col) => 50.0 - (row - col) as f32,
        };
        let before: Vec<f32> = (0..grid.len()).map(ground).collect();
        let mut heights = before.clone();
        fill_hollows(&Ways::new(&streams, &grid), &mut heights, |_| false, |_, wanted| Some(wanted));
        let filled = (0..grid.len()).filter(|n| heights[*n] != before[*n]);
        assert_eq!(filled.collect::<Vec<_>>(), [3 * COLS + 6, 4 * COLS + 6]);
        assert_eq!(heights[3 * COLS + 6], 50.0);
    }
}
