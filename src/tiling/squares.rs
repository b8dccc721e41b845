//! The map in coarse squares: how many vertices there are, how long the lines are, which levels they have. From this follow the
//! windows of the tiles, and their size in memory.

use std::collections::HashSet;

use glam::DVec2;
use tokosen_core::contour::ContourMap;

use crate::terrain::part::{GROWTH, LEVELS, SHARE, SPACINGS};

/// Squares along the longer side of the map.
const ALONG: f64 = 1024.0;

/// Sums over coarse squares of a map.
pub struct Squares {
    lo: DVec2,
    hi: DVec2,
    side: f64,
    cols: usize,
    rows: usize,
    /// Sums over all squares to the south-west, with a row and a column of zeros first.
    vertices: Vec<f64>,
    lengths: Vec<f64>,
    /// Some levels in each square, as bits.
    levels: Vec<[u64; LEVELS]>,
}

/// No level.
const NONE: u64 = u64::MAX;

impl Squares {
    /// The squares over the box around the contours of a map.
    pub fn new(map: &ContourMap) -> Self {
        let (lo, hi) = map.places().fold((DVec2::INFINITY, DVec2::NEG_INFINITY), |(lo, hi), p| (lo.min(p), hi.max(p)));
        let size = (hi - lo).max(DVec2::splat(f64::MIN_POSITIVE));
        let side = size.max_element() / ALONG;
        let [cols, rows] = (size / side).to_array().map(|n| n.floor() as usize + 1);
        let (mut vertices, mut lengths) = (vec![0.0; cols * rows], vec![0.0; cols * rows]);
        let mut levels = vec![[NONE; LEVELS]; cols * rows];
        let at = |p: DVec2| {
            let [col, row] = ((p - lo) / side).to_array().map(|n| n as usize);
            row.min(rows - 1) * cols + col.min(cols - 1)
        };
        for line in &map.contours {
            let level = line.elevation.to_bits();
            for &p in &line.points {
                let square = at(p);
                vertices[square] += 1.0;
                if let Some(free) = levels[square].iter_mut().find(|l| **l == level || **l == NONE) {
                    *free = level;
                }
            }
            line.points.windows(2).for_each(|ends| lengths[at(ends[0].midpoint(ends[1]))] += ends[0].distance(ends[1]));
        }
        let [vertices, lengths] = [vertices, lengths].map(|values| summed(&values, cols, rows));
        Self { lo, hi, side, cols, rows, vertices, lengths, levels }
    }

    /// The squares that meet a box: first and last column and row, as a range.
    fn range(&self, lo: DVec2, hi: DVec2) -> [usize; 4] {
        let limit = |v: f64, most: usize| v.clamp(0.0, most as f64) as usize;
        let (first, end) = (((lo - self.lo) / self.side).floor(), ((hi - self.lo) / self.side).floor() + 1.0);
        [limit(first.x, self.cols), limit(first.y, self.rows), limit(end.x, self.cols), limit(end.y, self.rows)]
    }

    fn sum(&self, sums: &[f64], [west, south, east, north]: [usize; 4]) -> f64 {
        let at = |col: usize, row: usize| sums[row * (self.cols + 1) + col];
        at(east, north) - at(west, north) - at(east, south) + at(west, south)
    }

    /// About how many vertices lie in a box.
    pub fn vertices(&self, lo: DVec2, hi: DVec2) -> f64 {
        self.sum(&self.vertices, self.range(lo, hi))
    }

    /// About how long the lines in a box are.
    pub fn length(&self, lo: DVec2, hi: DVec2) -> f64 {
        self.sum(&self.lengths, self.range(lo, hi))
    }

    /// The window around a tile, by the rule for parts of a map: wide against the spacing of the contours, with contours all
    /// around and several levels.
    pub fn window(&self, lo: DVec2, hi: DVec2) -> [DVec2; 2] {
        let mut reach = SHARE * (hi - lo).max_element();
        loop {
            let (from, to) = (lo - reach, hi + reach);
            let is_all = from.cmple(self.lo).all() && to.cmpge(self.hi).all();
            let spacing = (to - from).element_product() / self.length(from, to);
            if is_all || (reach >= SPACINGS * spacing && self.is_around(lo, hi, from, to)) {
                return [from, to];
            }
            reach *= GROWTH;
        }
    }

    /// Whether there are contours on all sides of a tile, and several levels, in a window.
    fn is_around(&self, lo: DVec2, hi: DVec2, from: DVec2, to: DVec2) -> bool {
        let [west, south, east, north] = self.range(from, to);
        let (mut low, mut high) = (DVec2::INFINITY, DVec2::NEG_INFINITY);
        let mut levels: HashSet<u64> = HashSet::new();
        for row in south..north {
            for col in west..east {
                let here = &self.levels[row * self.cols + col];
                if here[0] == NONE {
                    continue;
                }
                let corner = self.lo + self.side * DVec2::new(col as f64, row as f64);
                (low, high) = (low.min(corner), high.max(corner + self.side));
                if levels.len() < LEVELS {
                    levels.extend(here.iter().filter(|level| **level != NONE));
                }
            }
        }
        low.cmple(lo.max(self.lo)).all() && high.cmpge(hi.min(self.hi)).all() && levels.len() >= LEVELS
    }
}

/// Sums over all squares before each column and row.
fn summed(values: &[f64], cols: usize, rows: usize) -> Vec<f64> {
    let mut sums = vec![0.0; (cols + 1) * (rows + 1)];
    for row in 0..rows {
        let mut along = 0.0;
        for col in 0..cols {
            along += values[row * cols + col];
            sums[(row + 1) * (cols + 1) + col + 1] = sums[row * (cols + 1) + col + 1] + along;
        }
    }
    sums
}
