//! The border between the cells with heights and those without, and the differences from the base there.

use glam::DVec2;

use super::Join;
use crate::base::{ElevationUnit, Grid};
use crate::raster::Dem;

/// A base in feet fits that much better as feet than as metres.
const CLEARLY: f64 = 0.25;

/// The difference, heights minus base, of every cell at the border that has both: the cell, and the difference.
pub(super) fn differences(dem: &Dem, base: &[f32]) -> Vec<(usize, f32)> {
    let is_border = |k: usize| neighbours(&dem.grid, k).any(|n| dem.values[n].is_nan());
    let cells = dem.values.iter().zip(base).enumerate();
    let known = cells.filter(|(k, (height, base))| !height.is_nan() && !base.is_nan() && is_border(*k));
    known.map(|(k, (height, base))| (k, height - base)).collect()
}

/// The cells beside a cell.
fn neighbours(grid: &Grid, k: usize) -> impl Iterator<Item = usize> {
    let (col, row) = (k % grid.cols, k / grid.cols);
    let sides = [
        (col > 0).then(|| k - 1),
        (col + 1 < grid.cols).then(|| k + 1),
        (row > 0).then(|| k - grid.cols),
        (row + 1 < grid.rows).then(|| k + grid.cols),
    ];
    sides.into_iter().flatten()
}

/// The figures about the differences.
pub(super) fn figures(dem: &Dem, base: &[f32], known: &[(usize, f32)], filled: usize) -> Join {
    let furthest = known.iter().copied().reduce(|a, b| if b.1.abs() > a.1.abs() { b } else { a });
    let of_border = |value: &dyn Fn(f64, f64) -> f64| {
        median(known.iter().map(|&(k, _)| value(f64::from(dem.values[k]), f64::from(base[k]))).collect())
    };
    let as_metres = of_border(&|height, base| (height - base).abs());
    let as_feet = of_border(&|height, base| (height - ElevationUnit::Foot.metres(base)).abs());
    Join {
        filled,
        border: known.len(),
        median: median(known.iter().map(|(_, difference)| f64::from(*difference)).collect()),
        largest: furthest.map_or(f64::NAN, |(_, difference)| f64::from(difference)),
        place: furthest.map(|(k, _)| place(&dem.grid, k)),
        looks_like_feet: as_feet < CLEARLY * as_metres,
    }
}

/// The median; NaN of nothing.
fn median(mut values: Vec<f64>) -> f64 {
    let middle = values.len() / 2;
    if values.is_empty() { f64::NAN } else { *values.select_nth_unstable_by(middle, f64::total_cmp).1 }
}

/// The centre of a cell.
pub(super) fn place(grid: &Grid, k: usize) -> DVec2 {
    grid.center(k % grid.cols, k / grid.cols)
}
