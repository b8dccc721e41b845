//! Statistics of the differences of one class of cells, in two passes over the cells: a [`Tally`] counts, then a [`Collector`]
//! collects.
//!
//! Sums are taken over each row, and then over the rows in order. So they do not depend on how many rows are read at once, nor
//! on the number of threads.

use glam::DVec2;

use super::bins::{Collected, Counts, Part, bin};
use super::statistics::{Extreme, NORMAL, Statistics};

/// What takes the differences of the cells of a class, row by row.
pub(super) trait Take {
    /// Takes a difference and the index of its cell. Cells come in order.
    fn add(&mut self, d: f64, cell: usize);

    /// Ends a row of cells.
    fn end_row(&mut self);
}

/// A difference and the index of its cell.
type At = (f64, usize);

/// Sums and counts of differences.
#[derive(Debug)]
pub(super) struct Tally {
    cells: usize,
    /// The sums of d, d² and |d|, and those in the row that has not ended.
    sums: [f64; 3],
    row: [f64; 3],
    lowest: At,
    highest: At,
    counts: Counts,
}

impl Tally {
    pub fn new() -> Self {
        let (lowest, highest) = ((f64::INFINITY, 0), (f64::NEG_INFINITY, 0));
        Self { cells: 0, sums: [0.0; 3], row: [0.0; 3], lowest, highest, counts: Counts::new() }
    }

    /// What takes the same differences in the next pass. `None` if there are none.
    pub fn collector(self) -> Option<Collector> {
        if self.cells == 0 {
            return None;
        }
        let ranks = self.counts.ranks((self.lowest.0, self.highest.0));
        let median = ranks.quantile(0.5);
        let around = ranks.around(&median);
        let nmad = ranks.quantile_around(around, 0.5);
        let [le90, le95] = [0.9, 0.95].map(|share| ranks.quantile_around((0.0, 0.0), share));
        let parts = [median, nmad, le90, le95];
        let bins = parts.iter().flat_map(|part| &part.bins);
        let first = bins.clone().map(|bins| bins.start).min().unwrap_or(0);
        let mut is_wanted = vec![false; bins.clone().map(|bins| bins.end).max().unwrap_or(0) - first];
        bins.for_each(|bins| is_wanted[bins.start - first..bins.end - first].fill(true));
        let [bias, square, size] = self.sums.map(|sum| sum / self.cells as f64);
        let Self { cells, lowest, highest, .. } = self;
        let figures = Figures { cells, bias, rmse: square.sqrt(), mae: size, lowest, highest };
        Some(Collector { figures, parts, first, is_wanted, collected: Collected::default(), sum: 0.0, row: 0.0 })
    }
}

impl Take for Tally {
    fn add(&mut self, d: f64, cell: usize) {
        self.cells += 1;
        self.row[0] += d;
        self.row[1] += d * d;
        self.row[2] += d.abs();
        if d < self.lowest.0 {
            self.lowest = (d, cell);
        }
        if d > self.highest.0 {
            self.highest = (d, cell);
        }
        self.counts.add(d);
    }

    fn end_row(&mut self) {
        self.sums.iter_mut().zip(&mut self.row).for_each(|(sum, row)| *sum += std::mem::take(row));
    }
}

/// The figures that a tally gives.
#[derive(Debug)]
struct Figures {
    cells: usize,
    bias: f64,
    rmse: f64,
    mae: f64,
    lowest: At,
    highest: At,
}

/// Collects the differences that quantiles lie between.
#[derive(Debug)]
pub(super) struct Collector {
    figures: Figures,
    /// Those of the median, of the distance from it, and of the two sizes.
    parts: [Part; 4],
    /// The first bin that is wanted, and whether each bin from there on is.
    first: usize,
    is_wanted: Vec<bool>,
    collected: Collected,
    /// The sum of (d − bias)², and that in the row that has not ended.
    sum: f64,
    row: f64,
}

impl Collector {
    /// The statistics. `place` gives the position of a cell.
    pub fn statistics(mut self, place: impl Fn(usize) -> DVec2) -> Statistics {
        let collected = self.collected.counts();
        let [median, nmad, le90, le95] = &self.parts;
        let median = median.quantile(collected, |d| d);
        let Figures { cells, bias, rmse, mae, lowest, highest } = self.figures;
        let extreme = |(value, cell): At| Extreme { value, place: place(cell) };
        Statistics {
            cells,
            bias,
            rmse,
            rmse_debiased: (self.sum / cells as f64).sqrt(),
            mae,
            median,
            nmad: NORMAL * nmad.quantile(collected, |d| (d - median).abs()),
            le90: le90.quantile(collected, f64::abs),
            le95: le95.quantile(collected, f64::abs),
            lowest: extreme(lowest),
            highest: extreme(highest),
        }
    }
}

impl Take for Option<Collector> {
    fn add(&mut self, d: f64, _: usize) {
        let Some(Collector { figures, first, is_wanted, collected, row, .. }) = self else { return };
        *row += (d - figures.bias) * (d - figures.bias);
        if is_wanted.get(bin(d).wrapping_sub(*first)).copied().unwrap_or(false) {
            collected.add(d);
        }
    }

    fn end_row(&mut self) {
        if let Some(collector) = self {
            collector.sum += std::mem::take(&mut collector.row);
        }
    }
}
