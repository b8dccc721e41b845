//! What the pictures and charts of a report need of the heights, in two passes over their rows.

use super::charts::{Bars, Pairs};
use super::maps::{DataBox, Reduced, Window};
use tokosen_core::base::error::Result;
use tokosen_core::dem::compare::{Comparison, subtract};
use tokosen_core::raster::{Dem, RasterRows, each_pair};

/// What the passes find.
pub(super) struct Survey {
    /// The part of the grid that is shown.
    pub window: Window,
    /// The reduced heights of A and of B, and their reduced differences.
    pub a: Dem,
    pub b: Dem,
    pub difference: Dem,
    pub bars: Bars,
    pub pairs: Pairs,
}

/// Goes through the heights of A and B.
pub(super) fn survey(a: &dyn RasterRows, b: &dyn RasterRows, found: &Comparison) -> Result<Survey> {
    let grid = b.grid();
    let mut data = DataBox::default();
    let (mut lowest, mut highest) = (f32::INFINITY, f32::NEG_INFINITY);
    each_row([a, b], |row, a, b| {
        let is_known = |col: usize| a[col].is_finite() && b[col].is_finite();
        data.add(row, grid.cols, is_known);
        for col in (0..grid.cols).filter(|col| is_known(*col)) {
            (lowest, highest) = (lowest.min(a[col]).min(b[col]), highest.max(a[col]).max(b[col]));
        }
    })?;
    let window = Window::around(data, &grid);
    let [mut small_a, mut small_b, mut small] = std::array::from_fn(|_| Reduced::new(&grid, &window));
    let (mut bars, mut pairs) = (Bars::new(found), Pairs::new((lowest, highest)));
    each_row([a, b], |row, a, b| {
        small_a.add(row, |col| a[col]);
        small_b.add(row, |col| b[col]);
        small.add(row, |col| subtract(a[col], b[col]));
        for (&a, &b) in a.iter().zip(b) {
            let difference = subtract(a, b);
            if difference.is_finite() {
                bars.add(difference);
                pairs.add(a, b);
            }
        }
    })?;
    let (a, b, difference) = (small_a.map(), small_b.map(), small.map());
    Ok(Survey { window, a, b, difference, bars, pairs })
}

/// Calls `of_row` with the number of each row and the heights of both.
fn each_row(sides: [&dyn RasterRows; 2], mut of_row: impl FnMut(usize, &[f32], &[f32])) -> Result<()> {
    each_pair(sides, |a, b| b.rows.clone().for_each(|row| of_row(row, a.row(row), b.row(row))))
}
