//! Statistics of the differences of one class of cells, in two passes over the cells.
//!
//! Sums are taken over each row, and then over the rows in order. So they do not depend on how many rows are read at once, nor
//! on the number of threads.

use glam::DVec2;

use super::bins::{Collected, Counts, Part, bin};
use super::statistics::{Extreme, NORMAL, Statistics};

/// A difference and the index of its cell.
type At = (f64, usize);

/// What the first pass counts.
#[derive(Debug)]
pub(super) struct Tally {
    cells: usize,
    /// The sums of d, d² and |d|.
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

    /// Counts a difference. Cells come in order.
    pub fn add(&mut self, d: f64, cell: usize) {
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

    /// Ends a row of cells.
    pub fn end_row(&mut self) {
        self.sums.iter_mut().zip(&mut self.row).for_each(|(sum, row)| *sum += std::mem::take(row));
    }

    /// What the second pass needs. `None` if there are no cells.
    pub fn second(self) -> Option<Second> {
        if self.cells == 0 {
            return None;
        }
        let mut sums = self.counts.sums();
        (sums.lowest, sums.highest) = (self.lowest.0, self.highest.0);
        let median = sums.quantile(0.5);
        let around = sums.around(&median);
        let nmad = sums.quantile_around(around, 0.5);
        let [le90, le95] = [0.9, 0.95].map(|share| sums.quantile_around((0.0, 0.0), share));
        let parts = [median, nmad, le90, le95];
        let bins = parts.iter().flat_map(|part| &part.bins);
        let first = bins.clone().map(|bins| bins.start).min().unwrap_or(0);
        let mut is_wanted = vec![false; bins.clone().map(|bins| bins.end).max().unwrap_or(0) - first];
        bins.for_each(|bins| is_wanted[bins.start - first..bins.end - first].fill(true));
        let [bias, square, size] = self.sums.map(|sum| sum / self.cells as f64);
        let Self { cells, lowest, highest, .. } = self;
        let figures = Figures { cells, bias, rmse: square.sqrt(), mae: size, lowest, highest };
        Some(Second { figures, parts, first, is_wanted, collected: Collected::default(), sum: 0.0, row: 0.0 })
    }
}

/// The figures that are known after the first pass.
#[derive(Debug)]
struct Figures {
    cells: usize,
    bias: f64,
    rmse: f64,
    mae: f64,
    lowest: At,
    highest: At,
}

/// What the second pass collects.
#[derive(Debug)]
pub(super) struct Second {
    figures: Figures,
    /// Those of the median, of the distance from it, and of the two sizes.
    parts: [Part; 4],
    /// The first bin that is wanted, and whether each bin from there on is.
    first: usize,
    is_wanted: Vec<bool>,
    collected: Collected,
    /// The sum of (d − bias)².
    sum: f64,
    row: f64,
}

impl Second {
    /// Takes a difference.
    pub fn add(&mut self, d: f64) {
        self.row += (d - self.figures.bias) * (d - self.figures.bias);
        if self.is_wanted.get(bin(d).wrapping_sub(self.first)).copied().unwrap_or(false) {
            self.collected.add(d);
        }
    }

    /// Ends a row of cells.
    pub fn end_row(&mut self) {
        self.sum += std::mem::take(&mut self.row);
    }

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
