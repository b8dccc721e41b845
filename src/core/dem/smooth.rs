//! Smooths a height map: a Gaussian, corrected for what it takes away.
//!
//! Each height becomes the weighted mean of the heights around it; cells without data have no weight. A mean lowers tops
//! and raises hollows, and it tilts slopes at the border. So the same mean of the differences that it made is added
//! again ("twicing", Tukey 1977). Then planes and gentle curves stay as they are, also at the border, and what is lost
//! is mostly noise.

use crate::base::error::{Error, Result};
use crate::base::parallel;
use crate::base::progress::{Progress, step};
use crate::raster::Dem;

/// Largest standard deviation, cells. The time is proportional to it.
const LARGEST: f64 = 50.0;
/// Weights end at so many standard deviations.
const REACH: f64 = 3.0;

/// What smoothing did to the heights.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct HeightChange {
    /// Largest change of a height, metres.
    pub largest: f64,
    /// Root mean square of the changes, metres.
    pub rms: f64,
}

/// Smooths the heights with a Gaussian of this standard deviation, map units. Cells without data stay without.
///
/// # Errors
/// If the standard deviation is not more than 0, or more than 50 cells.
pub fn smoothed(dem: &Dem, deviation: f64, progress: &dyn Progress) -> Result<(Dem, HeightChange)> {
    let cells = deviation / dem.grid.cell;
    if !(deviation > 0.0 && cells.max_element() <= LARGEST) {
        return Err(Error::out_of_range("standard deviation of smoothing", deviation, "more than 0, at most 50 cells"));
    }
    Ok(step(progress, "smoothing", || {
        let values = twice(&dem.values, dem.grid.cols, [kernel(cells.x), kernel(cells.y)]);
        let change = change(&dem.values, &values);
        (Dem { grid: dem.grid, values, crs: dem.crs.clone() }, change)
    }))
}

fn twice(values: &[f32], cols: usize, kernels: [Vec<f32>; 2]) -> Vec<f32> {
    let has_data = |value: &f32| !value.is_nan();
    // Small numbers keep more digits.
    let origin = values.iter().copied().find(has_data).unwrap_or_default();
    let weights: Vec<f32> = parallel::values_each(values, |value| f32::from(u8::from(has_data(value))));
    let weights = convolved(&weights, cols, &kernels);
    let mean = |values: &[f32]| {
        let mut means = convolved(values, cols, &kernels);
        parallel::update(&mut means, |n, mean| *mean /= weights[n]);
        means
    };
    let offsets: Vec<f32> = parallel::values_each(values, |z| if z.is_nan() { 0.0 } else { z - origin });
    let mut smooth = mean(&offsets);
    let left = parallel::values(values.len(), |n| if values[n].is_nan() { 0.0 } else { offsets[n] - smooth[n] });
    let again = mean(&left);
    parallel::update(&mut smooth, |n, smooth| {
        *smooth = if values[n].is_nan() { f32::NAN } else { origin + (*smooth + again[n]) };
    });
    smooth
}

/// The weights of a cell and of those on one side of it, by distance.
fn kernel(deviation: f64) -> Vec<f32> {
    let reach = (REACH * deviation).ceil() as usize;
    (0..=reach).map(|d| (-0.5 * (d as f64 / deviation).powi(2)).exp() as f32).collect()
}

/// Weighted sums along rows, then along columns.
fn convolved(values: &[f32], cols: usize, [along_row, along_column]: &[Vec<f32>; 2]) -> Vec<f32> {
    let mut rows = vec![0.0; values.len()];
    parallel::chunks(&mut rows, cols, |r, sums| {
        let row = &values[r * cols..][..cols];
        add(sums, row, along_row[0]);
        for (d, &weight) in along_row.iter().enumerate().skip(1).take_while(|(d, _)| *d < cols) {
            add(&mut sums[d..], row, weight);
            add(sums, &row[d..], weight);
        }
    });
    let mut sums = vec![0.0; values.len()];
    let count = values.len() / cols;
    parallel::chunks(&mut sums, cols, |r, sums| {
        let row = |r: usize| &rows[r * cols..][..cols];
        add(sums, row(r), along_column[0]);
        for (d, &weight) in along_column.iter().enumerate().skip(1) {
            if d <= r {
                add(sums, row(r - d), weight);
            }
            if r + d < count {
                add(sums, row(r + d), weight);
            }
        }
    });
    sums
}

fn add(sums: &mut [f32], values: &[f32], weight: f32) {
    sums.iter_mut().zip(values).for_each(|(sum, value)| *sum += weight * value);
}

fn change(before: &[f32], after: &[f32]) -> HeightChange {
    // In order, so that the sum does not depend on the number of threads.
    let changes = before.iter().zip(after).filter(|(z, _)| !z.is_nan()).map(|(a, b)| f64::from(*b) - f64::from(*a));
    let (count, largest, sum) =
        changes.fold((0_u64, 0.0_f64, 0.0), |(n, largest, sum), d| (n + 1, largest.max(d.abs()), sum + d * d));
    HeightChange { largest, rms: (sum / count.max(1) as f64).sqrt() }
}

#[cfg(test)]
mod tests {
    use glam::DVec2;

    use super::*;
    use crate::base::Grid;

    fn dem(height: impl Fn(f64, f64) -> f64) -> Dem {
        let grid = Grid { corner: DVec2::new(500.0, 900.0), cell: DVec2::new(2.0, 3.0), cols: 70, rows: 50 };
        let at = |i: usize| grid.center(i % 70, i / 70) - grid.center(0, 0);
        Dem { grid, values: (0..grid.len()).map(|i| height(at(i).x, at(i).y) as f32).collect(), crs: None }
    }

    #[test]
    fn planes_stay_inside_and_nearly_at_the_border_and_beside_holes() {
        let mut plane = dem(|x, y| 700.0 + 0.5 * x - 0.25 * y);
        plane.values[25 * 70 + 30] = f32::NAN;
        let (smooth, change) = smoothed(&plane, 6.0, &()).unwrap();
        assert!(smooth.values[25 * 70 + 30].is_nan());
        assert_eq!(smooth.values.iter().filter(|z| z.is_nan()).count(), 1);
        let error = |i: usize| (smooth.values[i] - plane.values[i]).abs();
        assert!(error(10 * 70 + 50) < 1e-3, "{}", error(10 * 70 + 50));
        // A Gaussian without correction moves a corner by 0.8 deviations of both slopes, 3.6 m.
        assert!(change.largest < 1.8, "{change:?}");
        assert!(change.rms < 0.25 && change.rms <= change.largest);
    }

    #[test]
    fn noise_goes_and_hills_stay() {
        let hill = |x: f64, y: f64| 100.0 + 20.0 * (x / 20.0).sin() * (y / 25.0).cos();
        let noise = |x: f64, y: f64| ((x * 12.9898 + y * 78.233).sin() * 43_758.545_3).rem_euclid(1.0) - 0.5;
        let rough = dem(|x, y| hill(x, y) + noise(x, y));
        let (smooth, change) = smoothed(&rough, 4.0, &()).unwrap();
        let error = |dem: &Dem| {
            let truth = self::dem(hill);
            let inner = (0..dem.grid.len()).filter(|i| (6..64).contains(&(i % 70)) && (5..45).contains(&(i / 70)));
            let squares = inner.map(|i| f64::from(dem.values[i] - truth.values[i]).powi(2));
            (squares.clone().sum::<f64>() / squares.count() as f64).sqrt()
        };
        assert!(error(&smooth) < 0.5 * error(&rough), "{} of {}", error(&smooth), error(&rough));
        assert!((0.2..0.4).contains(&change.rms), "the noise is 0.29: {change:?}");
    }

    #[test]
    fn a_deviation_without_sense_is_refused() {
        let flat = dem(|_, _| 1.0);
        for bad in [0.0, -1.0, f64::NAN, f64::INFINITY, 101.0] {
            assert!(matches!(smoothed(&flat, bad, &()), Err(Error::OutOfRange { .. })), "{bad}");
        }
        let (same, change) = smoothed(&flat, 0.01, &()).unwrap();
        assert_eq!((same, change), (flat, HeightChange { largest: 0.0, rms: 0.0 }));
    }
}
