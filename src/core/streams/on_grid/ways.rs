//! The ways of streams over a grid, and heights read along them.

use foldhash::HashSet;
use glam::{DVec2, DVec3};

use crate::base::{Grid, parallel};
use crate::streams::Stream;

/// Samples per cell along a stream.
const SAMPLES: f64 = 4.0;
/// Stands for no cell. No grid has so many.
const NO_CELL: u32 = u32::MAX;

/// Streams on a grid. They come in an order in which each one follows those that flow into it.
pub(crate) struct Ways<'a> {
    pub(super) grid: &'a Grid,
    pub(super) of_streams: Vec<Way>,
}

/// A stream on a grid.
pub(super) struct Way {
    /// Where the stream begins and ends; `None` if it has no points. Where streams meet, their ends are equal.
    pub ends: Option<[[u64; 2]; 2]>,
    /// The cells that the stream runs through, downstream, each once in a row.
    pub cells: Vec<usize>,
    /// Places along it, from its first vertex to its last.
    pub samples: Vec<Sample>,
}

impl<'a> Ways<'a> {
    /// Finds the cells along streams.
    pub fn new(streams: &[Stream], grid: &'a Grid) -> Self {
        let way = |stream: &Stream| {
            let mut samples = Vec::new();
            let mut seen = HashSet::default();
            for_each_place(stream, grid, |place, z| {
                let sample = Sample::new(grid, place, z);
                let is_first = seen.insert(sample.nearest);
                samples.push(Sample { is_first, ..sample });
            });
            let mut cells: Vec<usize> = samples.iter().filter_map(Sample::nearest).collect();
            cells.dedup();
            Way { ends: stream.ends(), cells, samples }
        };
        Self { grid, of_streams: parallel::map_each(streams, way) }
    }

    /// The cells that streams run through. Some come more than once.
    pub(super) fn cells(&self) -> impl Iterator<Item = usize> {
        self.of_streams.iter().flat_map(|way| &way.cells).copied()
    }
}

/// Calls `visit` with places along a stream, from its first vertex to its last, as columns and rows with fractions, and
/// with the heights of the stream there.
pub(super) fn for_each_place(stream: &Stream, grid: &Grid, mut visit: impl FnMut(DVec2, f32)) {
    let mut points = stream.points.iter().map(|p| grid.place(p.truncate()).extend(p.z));
    let Some(mut a) = points.next() else { return };
    let mut visit = |p: DVec3| visit(p.truncate(), p.z as f32);
    visit(a);
    for b in points {
        let count = (SAMPLES * a.truncate().distance(b.truncate())).ceil().max(1.0);
        (1..=count as usize).for_each(|k| visit(a.lerp(b, k as f64 / count)));
        a = b;
    }
}

/// A place where heights are read.
pub(super) struct Sample {
    /// The nearest cell.
    nearest: u32,
    /// Whether it is the nearest cell for the first time along the stream.
    is_first: bool,
    /// The north-western one of the four cells around.
    first: u32,
    /// The shares of the eastern and of the southern ones in the bilinear reading.
    shares: [f32; 2],
    /// The height of the stream there.
    pub height: f32,
}

impl Sample {
    /// A place at a column and a row with fractions, where a stream has a height.
    pub fn new(grid: &Grid, place: DVec2, height: f32) -> Self {
        let cell = |at: DVec2, least_beyond: f64| {
            let end = DVec2::new(grid.cols as f64, grid.rows as f64) - least_beyond;
            let is_on = at.cmpge(DVec2::ZERO).all() && at.cmplt(end).all();
            if is_on { (at.y as usize * grid.cols + at.x as usize) as u32 } else { NO_CELL }
        };
        let first = place.floor();
        let shares = [place.x - first.x, place.y - first.y].map(|share| share as f32);
        Self { nearest: cell(place.round(), 0.0), is_first: true, first: cell(first, 1.0), shares, height }
    }

    /// The nearest cell, if it is on the grid.
    pub fn nearest(&self) -> Option<usize> {
        (self.nearest != NO_CELL).then_some(self.nearest as usize)
    }

    /// The nearest cell, if the stream comes to it for the first time.
    pub fn new_cell(&self) -> Option<usize> {
        self.nearest().filter(|_| self.is_first)
    }

    /// The four cells around, with their shares of the bilinear reading, if all are on the grid.
    pub fn corners(&self, grid: &Grid) -> Option<[(usize, f32); 4]> {
        if self.first == NO_CELL {
            return None;
        }
        let (n, [u, v]) = (self.first as usize, self.shares);
        let below = n + grid.cols;
        Some([(n, (1.0 - u) * (1.0 - v)), (n + 1, u * (1.0 - v)), (below, (1.0 - u) * v), (below + 1, u * v)])
    }

    /// The cells that count in a reading. Some come twice.
    pub fn cells(&self, grid: &Grid) -> impl Iterator<Item = usize> + use<> {
        let corners = self.corners(grid).into_iter().flatten().filter(|(_, share)| *share > 0.0);
        corners.map(|(n, _)| n).chain(self.nearest())
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
