//! The slope of the reference surface goes on beyond the frame.

use super::inside::MARGIN;
use crate::base::parallel;

/// The slope that goes on is that over so many steps between nodes, or over fewer where the frame is narrow. On contours that
/// lie on no raster, the RMSE of four maps is 0.5 % smaller in the mean than with one step, as it is with 6 and 24.
const STEPS: isize = 12;

/// Carries heights on over the nodes beyond the frame that belong to the surface, by straight lines. Heights are NaN there
/// before.
///
/// The tension draws the slopes to those of the reference surface. Without heights beyond the frame it would draw them to
/// level ground there, and slopes at the frame would become less steep.
pub fn carry_on(heights: &mut [f32], cols: usize) {
    let rows = heights.len() / cols.max(1);
    for _ in 0..MARGIN {
        let before = &*heights;
        let carried = |n: usize| {
            let (i, j) = (n % cols, n / cols);
            let at = |x: isize, y: isize| {
                let (i, j) = (i.checked_add_signed(x)?, j.checked_add_signed(y)?);
                (i < cols && j < rows).then(|| before[j * cols + i]).filter(|z| !z.is_nan())
            };
            let steps = [(1, 0), (-1, 0), (0, 1), (0, -1), (1, 1), (1, -1), (-1, 1), (-1, -1)];
            let found = steps.into_iter().filter_map(|(x, y)| {
                let first = at(x, y)?;
                let (k, last) = (1..=STEPS).map_while(|k| Some((k, at((k + 1) * x, (k + 1) * y)?))).last()?;
                Some(first + (first - last) / k as f32)
            });
            let (sum, count) = found.fold((0.0, 0.0), |(sum, count), z| (sum + z, count + 1.0));
            (count > 0.0).then_some((n, sum / count))
        };
        let is_beyond = |n: &usize| before[*n].is_nan();
        let found = parallel::map(rows, |j| -> Vec<(usize, f32)> {
            (j * cols..(j + 1) * cols).filter(is_beyond).filter_map(carried).collect()
        });
        found.into_iter().flatten().for_each(|(n, z)| heights[n] = z);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_slope_goes_on_beyond_the_frame() {
        let (cols, rows) = (12, 10);
        let slope = |n: usize| 3.0 * (n % cols) as f32 - 2.0 * (n / cols) as f32 + 100.0;
        let inside = |n: usize| (4..8).contains(&(n % cols)) && (3..7).contains(&(n / cols));
        let mut heights: Vec<f32> = (0..cols * rows).map(|n| if inside(n) { slope(n) } else { f32::NAN }).collect();
        carry_on(&mut heights, cols);
        let carried: Vec<usize> = (0..cols * rows).filter(|&n| !heights[n].is_nan()).collect();
        assert!(carried.iter().all(|&n| heights[n] == slope(n)));
        let near = |n: usize| (2..10).contains(&(n % cols)) && (1..9).contains(&(n / cols));
        assert!(carried.iter().filter(|&&n| near(n)).count() > 16 + 32, "{}", carried.len());
    }
}
