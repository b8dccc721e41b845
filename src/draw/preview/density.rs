//! How dense lines are, place by place.
//!
//! The mean over a map says little: plains have no lines, slopes have many. So the length of the lines is counted in
//! square blocks. The spacing of the lines in a block is its area divided by their length.

use glam::DVec2;

use super::stroke::{clip, rim, to_pixels};
use tokosen_core::base::Grid;

/// Side of a block, pixels.
const BLOCK: f64 = 16.0;
/// Longest piece of a line that is counted in the block of its middle, pixels.
const PIECE: f64 = 6.0;

/// Length of lines per area in blocks, 1/pixel.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Density {
    cols: usize,
    values: Vec<f64>,
}

impl Density {
    /// No lines on a map.
    pub fn none(grid: &Grid) -> Self {
        let count = |pixels: usize| (pixels as f64 / BLOCK).ceil() as usize;
        let (cols, rows) = (count(grid.cols), count(grid.rows));
        Self { cols, values: vec![0.0; cols * rows] }
    }

    /// The density of lines in map units, averaged over neighbouring blocks.
    pub fn of<'a>(grid: &Grid, lines: impl Iterator<Item = &'a [DVec2]>) -> Self {
        let mut found = Self::none(grid);
        let rows = found.rows();
        let size = DVec2::new(grid.cols as f64, grid.rows as f64);
        for line in lines {
            for pair in line.windows(2) {
                let Some((a, b)) = clip(to_pixels(grid, pair[0]), to_pixels(grid, pair[1]), rim(grid)) else {
                    continue;
                };
                let length = a.distance(b);
                let pieces = (length / PIECE).ceil().max(1.0);
                for k in 0..pieces as usize {
                    let middle = a.lerp(b, (k as f64 + 0.5) / pieces);
                    if middle.cmpge(DVec2::ZERO).all() && middle.cmplt(size).all() {
                        let [col, row] = (middle / BLOCK).to_array().map(|v| v as usize);
                        found.values[row.min(rows - 1) * found.cols + col.min(found.cols - 1)] += length / pieces;
                    }
                }
            }
        }
        found.averaged(size)
    }

    fn rows(&self) -> usize {
        self.values.len() / self.cols.max(1)
    }

    /// Lengths as densities over each block and its eight neighbours.
    fn averaged(&self, size: DVec2) -> Self {
        let (cols, rows) = (self.cols, self.rows());
        let side = |k: usize, whole: f64| (whole - k as f64 * BLOCK).min(BLOCK);
        let around = |k: usize, count: usize| k.saturating_sub(1)..(k + 2).min(count);
        let mean = |i: usize| {
            let (col, row) = (i % cols, i / cols);
            let blocks = around(row, rows).flat_map(|r| around(col, cols).map(move |c| (c, r)));
            let (length, area) = blocks.fold((0.0, 0.0), |(length, area), (c, r)| {
                (length + self.values[r * cols + c], area + side(c, size.x) * side(r, size.y))
            });
            length / area
        };
        Self { cols, values: (0..self.values.len()).map(mean).collect() }
    }

    /// The same lines thinned out to one of `every`.
    pub fn thinned(&self, every: u32) -> Self {
        Self { cols: self.cols, values: self.values.iter().map(|v| v / f64::from(every)).collect() }
    }

    /// These lines and others on the same map.
    pub fn and(&self, other: &Self) -> Self {
        Self { cols: self.cols, values: self.values.iter().zip(&other.values).map(|(a, b)| a + b).collect() }
    }

    /// The share of these lines that lie where `all` lines have at least a spacing, pixels; 1 if there are no lines.
    pub fn share_with_room(&self, all: &Self, spacing: f64) -> f64 {
        let (mut length, mut with_room) = (0.0, 0.0);
        for (own, all) in self.values.iter().zip(&all.values) {
            length += own;
            with_room += if all * spacing <= 1.0 { *own } else { 0.0 };
        }
        if length > 0.0 { with_room / length } else { 1.0 }
    }

    /// The share of the area with such lines where `all` lines have at least a spacing, pixels; 1 if there are none.
    pub fn area_with_room(&self, all: &Self, spacing: f64) -> f64 {
        let blocks = self.values.iter().zip(&all.values).filter(|(own, _)| **own > 0.0);
        let with_room = blocks.clone().filter(|(_, all)| *all * spacing <= 1.0).count();
        let count = blocks.count();
        if count > 0 { with_room as f64 / count as f64 } else { 1.0 }
    }

    /// The spacing that a piece of line has on average, pixels; without end if there are no lines.
    pub fn spacing(&self) -> f64 {
        let (sum, squares) = self.values.iter().fold((0.0, 0.0), |(sum, squares), v| (sum + v, squares + v * v));
        if squares > 0.0 { sum / squares } else { f64::INFINITY }
    }

    /// The density around a pixel, between the centres of blocks in proportion.
    pub fn at(&self, col: usize, row: usize) -> f64 {
        let rows = self.rows();
        let near = |pixel: usize, count: usize| {
            let at = ((pixel as f64 + 0.5) / BLOCK - 0.5).clamp(0.0, (count - 1) as f64);
            let first = (at as usize).min(count.saturating_sub(2));
            (first, (first + 1).min(count - 1), at - first as f64)
        };
        let ((left, right, x), (top, bottom, y)) = (near(col, self.cols), near(row, rows));
        let value = |c: usize, r: usize| self.values[r * self.cols + c];
        let across = |r: usize| value(left, r) * (1.0 - x) + value(right, r) * x;
        across(top) * (1.0 - y) + across(bottom) * y
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const GRID: Grid = Grid { corner: DVec2::new(0.0, 320.0), cell: DVec2::ONE, cols: 320, rows: 320 };

    #[test]
    fn lines_of_even_spacing_have_that_spacing_everywhere() {
        let lines: Vec<Vec<DVec2>> =
            (0..64).map(|k| [0.0, 320.0].map(|x| DVec2::new(x, 2.5 + 5.0 * f64::from(k))).to_vec()).collect();
        let density = Density::of(&GRID, lines.iter().map(Vec::as_slice));
        assert!((density.spacing() - 5.0).abs() < 0.1, "{}", density.spacing());
        assert!((density.at(160, 160) - 0.2).abs() < 0.02);
        assert!((density.thinned(4).spacing() - 20.0).abs() < 0.4);
        assert!((density.and(&density).spacing() - 2.5).abs() < 0.05);
        assert_eq!((density.share_with_room(&density, 4.0), density.share_with_room(&density, 6.0)), (1.0, 0.0));
    }

    #[test]
    fn a_crowded_corner_counts_as_crowded_on_a_map_that_is_empty_elsewhere() {
        let lines: Vec<Vec<DVec2>> =
            (0..40).map(|k| [0.0, 80.0].map(|x| DVec2::new(x, 240.5 + 2.0 * f64::from(k))).to_vec()).collect();
        let density = Density::of(&GRID, lines.iter().map(Vec::as_slice));
        assert!((1.9..3.0).contains(&density.spacing()), "{}", density.spacing());
        assert!(density.at(20, 40) > 0.45 && density.at(300, 300) == 0.0);
        assert!(density.share_with_room(&density, 4.0) < 0.25);
        assert!(density.share_with_room(&density, 4.0) < density.area_with_room(&density, 4.0));
        assert_eq!(Density::none(&GRID).spacing(), f64::INFINITY);
    }
}
