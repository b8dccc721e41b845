//! The ways of streams over a grid.

use glam::DVec2;

use crate::base::{Grid, parallel};
use crate::streams::Stream;
use crate::streams::fall::fall;
use crate::streams::line::Ends;

/// Samples per cell along a stream.
const SAMPLES: f64 = 4.0;

/// Streams on a grid. They come in an order in which each one follows those that flow into it.
pub(crate) struct Ways<'a> {
    pub(super) grid: &'a Grid,
    pub(super) of_streams: Vec<Way>,
}

/// A stream on a grid.
pub(super) struct Way {
    /// Where the stream begins and ends; `None` if it has no points. Where streams meet, their ends are equal.
    ends: Option<Ends>,
    /// The cells that the stream runs through, downstream, each once in a row.
    pub cells: Vec<usize>,
    /// The height of the stream in each cell, where it is nearest to the centre, metres.
    heights: Vec<f64>,
}

impl<'a> Ways<'a> {
    /// Finds the cells along streams.
    pub fn new(streams: &[Stream], grid: &'a Grid) -> Self {
        Self { grid, of_streams: parallel::map_each(streams, |stream| Way::new(stream, grid)) }
    }

    /// The cells that streams run through. Some come more than once.
    pub(super) fn cells(&self) -> impl Iterator<Item = usize> {
        self.of_streams.iter().flat_map(|way| &way.cells).copied()
    }

    /// Brings the cells of streams within `tolerance` (metres) of the heights of the streams, and makes them fall along the
    /// streams, by as little as needed. All other cells stay. Cells come as near to that as is `allowed`: for a cell and a
    /// wanted height, the allowed height that is nearest to it, or `None` if the cell stays. Heights that are NaN stay, and so
    /// do those that are further than `most` from that of their stream.
    pub fn follow(
        &self,
        heights: &mut [f32],
        [tolerance, most]: [f64; 2],
        allowed: impl Fn(usize, f32) -> Option<f32>,
    ) {
        let near = |cell: usize, own: f64| match f64::from(heights[cell]) {
            z if (z - own).abs() <= most => z.max(own - tolerance).min(own + tolerance),
            _ => f64::NAN,
        };
        let along = |way: &Way| way.cells.iter().zip(&way.heights).map(|(cell, own)| near(*cell, *own)).collect();
        let mut wanted: Vec<Vec<f64>> = self.of_streams.iter().map(along).collect();
        let stays: Vec<bool> = wanted.iter().flatten().map(|z| z.is_nan()).collect();
        // The heights of streams fall. So no height leaves the tolerance.
        fall(&self.of_streams.iter().map(|way| way.ends).collect::<Vec<_>>(), &mut wanted);
        for ((cell, stays), wanted) in self.cells().zip(stays).zip(wanted.into_iter().flatten()) {
            if !stays && let Some(height) = allowed(cell, wanted as f32) {
                heights[cell] = height;
            }
        }
    }
}

impl Way {
    fn new(stream: &Stream, grid: &Grid) -> Self {
        let mut way = Self { ends: stream.ends(), cells: Vec::new(), heights: Vec::new() };
        let size = DVec2::new(grid.cols as f64, grid.rows as f64);
        let mut nearest = f64::INFINITY;
        let mut visit = |place: DVec2, z: f64| {
            let centre = place.round();
            if centre.cmplt(DVec2::ZERO).any() || centre.cmpge(size).any() {
                return;
            }
            let cell = centre.y as usize * grid.cols + centre.x as usize;
            let distance = place.distance_squared(centre);
            if way.cells.last() != Some(&cell) {
                way.cells.push(cell);
                way.heights.push(z);
                nearest = distance;
            } else if distance < nearest
                && let Some(height) = way.heights.last_mut()
            {
                *height = z;
                nearest = distance;
            }
        };
        let mut points = stream.points.iter().map(|p| grid.place(p.truncate()).extend(p.z));
        let Some(mut a) = points.next() else { return way };
        visit(a.truncate(), a.z);
        for b in points {
            let count = (SAMPLES * a.truncate().distance(b.truncate())).ceil().max(1.0);
            for k in 1..=count as usize {
                let p = a.lerp(b, k as f64 / count);
                visit(p.truncate(), p.z);
            }
            a = b;
        }
        way
    }
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::*;
    use crate::subdomains::Band;

    /// A stream along row 1 of a grid of 12 x 3 cells, from 20 m to 9 m, on uneven ground.
    fn followed(ground: impl Fn(usize) -> f32, allowed: impl Fn(usize, f32) -> Option<f32>) -> Vec<f32> {
        let grid = Grid { corner: DVec2::new(0.0, 3.0), cell: DVec2::ONE, cols: 12, rows: 3 };
        let points: Vec<DVec3> = (0..12).map(|col| grid.center(col, 1).extend(20.0 - col as f64)).collect();
        let streams = [Stream::between(points, Band { lo: 0.0, hi: 200.0 })];
        let mut heights: Vec<f32> = (0..36).map(ground).collect();
        Ways::new(&streams, &grid).follow(&mut heights, [0.5, 45.0], allowed);
        heights
    }

    #[test]
    fn only_cells_of_a_stream_change_and_only_as_far_as_its_height_and_its_fall_want() {
        // A dam, a hollow, and a bump of less than the tolerance.
        let ground = |n: usize| match n {
            15 => 30.0,
            18 => 2.0,
            22 => 11.4,
            n if n / 12 == 1 => 20.0 - (n % 12) as f32,
            _ => 7.0,
        };
        let heights = followed(ground, |_, wanted| Some(wanted));
        for (n, z) in heights.iter().enumerate() {
            let wanted = match n {
                15 => 17.5,
                18 => 13.5,
                22 => 10.2,
                n => ground(n),
            };
            assert!((z - wanted).abs() < 0.31, "cell {n}: {z}");
            assert!(n / 12 == 1 || *z == 7.0, "cell {n}: {z}");
        }
        assert!(heights[12..24].is_sorted_by(|a, b| a >= b), "{heights:?}");
    }

    #[test]
    fn cells_stay_where_they_must_where_there_is_no_ground_and_far_above_the_stream() {
        let ground = |n: usize| match n {
            14 => f32::NAN,
            20 => 90.0,
            _ => 50.0,
        };
        let heights = followed(ground, |n, wanted| (n != 16).then(|| wanted.max(18.0)));
        assert!(heights[14].is_nan() && heights[16] == 50.0 && heights[20] == 90.0);
        assert!(heights[12..24].iter().enumerate().all(|(k, z)| [2, 4, 8].contains(&k) || (18.0..=20.5).contains(z)));
    }
}
