//! The beds of streams: on a grid, the cells of a stream lie lower than the ground beside them.
//!
//! Contours show valleys, not beds. On four maps, the true ground in the cells of streams was 0.7 to 4.6 % of the contour
//! interval lower than a surface that only falls along them. Also, water leaves a stream on level ground less easily if it
//! has a bed. Where the ground falls to the stream from both sides, the valley is deep enough.

use foldhash::HashMap;

use super::ways::Ways;
use crate::drain::neighbours;

/// Lowers the cells that streams run through, as far as this is `allowed`, until they lie `depth` below the mean of their
/// neighbours beside streams. A cell without such neighbours stays. So do heights that are NaN. No cell is lowered below one
/// further downstream.
pub(crate) fn lower_beds(
    ways: &Ways<'_>,
    heights: &mut [f32],
    depth: f32,
    allowed: impl Fn(usize, f32) -> Option<f32>,
) {
    let grid = ways.grid;
    // The height of each cell with its bed.
    let in_streams = ways.cells().filter(|cell| !heights[*cell].is_nan());
    let mut beds: HashMap<usize, f32> = in_streams.map(|cell| (cell, heights[cell])).collect();
    let bed = |cell: usize| {
        let banks = neighbours(cell, grid.cols, grid.rows).flatten().map(|(_, n)| n);
        let banks = banks.filter(|n| !beds.contains_key(n) && !heights[*n].is_nan()).map(|n| heights[n]);
        let (sum, count) = banks.fold((0.0, 0.0), |(sum, count), z| (sum + z, count + 1.0));
        let wanted = if count > 0.0 { sum / count - depth } else { heights[cell] };
        wanted.max(heights[cell] - depth).min(heights[cell])
    };
    let found: Vec<(usize, f32)> = beds.keys().map(|&cell| (cell, bed(cell))).collect();
    beds.extend(found);
    // The greatest height downstream of each confluence.
    let mut downstream: HashMap<[u64; 2], f32> = HashMap::default();
    for way in ways.of_streams.iter().rev() {
        let Some([first, last]) = way.ends else { continue };
        let mut highest = downstream.get(&last).copied().unwrap_or(f32::NEG_INFINITY);
        for &cell in way.cells.iter().rev() {
            let Some(bed) = beds.get(&cell) else { continue };
            if let Some(lowered) = allowed(cell, bed.max(highest)).filter(|lowered| *lowered < heights[cell]) {
                heights[cell] = lowered;
            }
            highest = highest.max(heights[cell]);
        }
        let start = downstream.entry(first).or_insert(f32::NEG_INFINITY);
        *start = start.max(highest);
    }
}

#[cfg(test)]
mod tests {
    use glam::{DVec2, DVec3};

    use super::*;
    use crate::base::Grid;
    use crate::streams::Stream;
    use crate::subdomains::Band;

    #[test]
    fn a_stream_gets_a_bed_but_none_below_a_cell_further_downstream() {
        let grid = Grid { corner: DVec2::new(0.0, 3.0), cell: DVec2::ONE, cols: 12, rows: 3 };
        let along_row = |row: usize, from: usize, to: usize| {
            let points = [from, to].map(|col| grid.center(col, row).extend(0.0));
            Stream::between(points.to_vec(), Band { lo: 0.0, hi: 200.0 })
        };
        let stream = |from: usize, to: usize| along_row(1, from, to);
        // Level ground that falls by steps of 10 m at the columns 4 and 8; the cell in column 6 has to stay.
        let before: Vec<f32> = (0..36).map(|n| 100.0 - 10.0 * ((n % 12) / 4) as f32).collect();
        let row = |k: usize, heights: &[f32]| heights[12 * k..12 * (k + 1)].to_vec();
        let lowered = |streams: &[Stream], before: &[f32], allowed: &dyn Fn(usize, f32) -> Option<f32>| {
            let mut heights = before.to_vec();
            lower_beds(&Ways::new(streams, &grid), &mut heights, 1.0, allowed);
            assert_eq!([row(0, &heights), row(2, &heights)], [row(0, before), row(2, before)]);
            row(1, &heights)
        };
        let allowed = |n: usize, wanted: f32| (n != 12 + 6).then(|| wanted.max(79.5));
        let beds = lowered(&[stream(0, 5), stream(5, 11)], &before, &allowed);
        // Above a step, the banks of a cell are lower in the mean. Below it, they are higher.
        assert_eq!(beds, [99.0, 99.0, 99.0, 99.0, 90.0, 90.0, 90.0, 89.0, 80.0, 79.5, 79.5, 79.5]);
        // Two streams in the same cells have one bed.
        let beds = lowered(&[stream(0, 11), stream(2, 11)], &before, &|_, wanted| Some(wanted));
        assert_eq!(beds[9..], [79.0; 3]);
        // In a valley that is half as deep as a bed, the other half is missing. A deeper one stays.
        for (valley, missing) in [(0.5, 0.5), (1.5, 0.0)] {
            let mut ground = vec![50.0; 36];
            ground[12..24].fill(50.0 - valley);
            let beds = lowered(&[stream(0, 11)], &ground, &|_, wanted| Some(wanted));
            assert_eq!(beds, [50.0 - valley - missing; 12]);
        }
        // Where streams are everywhere, no cell shows the ground beside them.
        let mut ground = before.clone();
        let rows = [0, 1, 2].map(|row| along_row(row, 0, 11));
        lower_beds(&Ways::new(&rows, &grid), &mut ground, 1.0, |_, wanted| Some(wanted));
        assert_eq!(ground, before);
        let outside = Stream { points: vec![DVec3::splat(-9.0), DVec3::splat(-5.0)], ..stream(0, 5) };
        lowered(&[outside], &before, &|_, wanted| Some(wanted));
    }
}
