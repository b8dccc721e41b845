//! Means over rectangles of nodes.

use rayon::prelude::*;

use crate::base::parallel;

/// Rows per task, or twice the reach if that is more. Each task begins its sums anew. So the means do not depend on the
/// number of threads.
const STRIP: usize = 128;

/// Number of passes of the mean. Two passes weigh the nodes like a tent. A single one would leave a step wherever a
/// node enters the rectangle.
pub const PASSES: usize = 2;

/// The mean of the values at most `reach` columns and rows away from each node. At the border only existing nodes
/// count.
pub fn blurred(values: &[f32], cols: usize, reach: usize) -> Vec<f32> {
    let cols = cols.max(1);
    let rows = values.len() / cols;
    // A reach beyond the grid changes nothing.
    let [across, down] = [cols, rows].map(|count| reach.min(count));
    let shares: Vec<f64> = (0..cols).map(|i| share(i, across, cols)).collect();
    let mut along = vec![0.0f32; values.len()];
    let all = along.par_chunks_mut(cols).zip(values.par_chunks(cols));
    all.for_each_init(Vec::new, |padded, (out, row)| means_along(row, across, &shares, padded, out));
    let mut all = vec![0.0f32; values.len()];
    let strip = STRIP.max(2 * down);
    parallel::chunks(&mut all, strip * cols, |k, rows| means_down(&along, cols, down, k * strip, rows));
    all
}

/// The mean of the values at most `reach` away from each in a row. `padded` is a buffer for the row with zeros at both
/// ends, so that the ends need no special case.
fn means_along(row: &[f32], reach: usize, shares: &[f64], padded: &mut Vec<f64>, out: &mut [f32]) {
    padded.clear();
    padded.resize(reach + 1, 0.0);
    padded.extend(row.iter().map(|v| f64::from(*v)));
    padded.resize(row.len() + 2 * reach + 1, 0.0);
    let mut sum: f64 = padded[..2 * reach + 1].iter().sum();
    let changes = padded[2 * reach + 1..].iter().zip(&*padded);
    for ((out, share), (entering, leaving)) in out.iter_mut().zip(shares).zip(changes) {
        sum += entering - leaving;
        *out = (sum * share) as f32;
    }
}

/// The mean of the rows at most `reach` away from each, for the rows of a strip that starts at row `first`.
fn means_down(values: &[f32], cols: usize, reach: usize, first: usize, strip: &mut [f32]) {
    let (rows, none) = (values.len() / cols, vec![0.0; cols]);
    let row = |j: Option<usize>| j.filter(|j| *j < rows).map_or(&*none, |j| &values[j * cols..(j + 1) * cols]);
    let mut sums = vec![0.0f64; cols];
    for j in first.saturating_sub(reach + 1)..first + reach {
        sums.iter_mut().zip(row(Some(j))).for_each(|(sum, v)| *sum += f64::from(*v));
    }
    for (j, out) in (first..).zip(strip.chunks_mut(cols)) {
        let share = share(j, reach, rows);
        let changes = row(Some(j + reach)).iter().zip(row(j.checked_sub(reach + 1)));
        for ((out, sum), (entering, leaving)) in out.iter_mut().zip(&mut sums).zip(changes) {
            *sum += f64::from(*entering) - f64::from(*leaving);
            *out = (*sum * share) as f32;
        }
    }
}

/// Weight of one value in the mean at place `i` of `count`: one over the number of places at most `reach` away.
fn share(i: usize, reach: usize, count: usize) -> f64 {
    1.0 / ((i + reach).min(count - 1) - i.saturating_sub(reach) + 1) as f64
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn means_are_those_of_the_nodes_around() {
        let (cols, rows) = (7, 300);
        let values: Vec<f32> = (0..cols * rows).map(|n| ((n * 37) % 11) as f32).collect();
        for reach in [0, 1, 2, 6, 40, 90, usize::MAX] {
            let found = blurred(&values, cols, reach);
            for (n, found) in found.iter().enumerate() {
                let near = |m: &usize| (m % cols).abs_diff(n % cols) <= reach && (m / cols).abs_diff(n / cols) <= reach;
                let around: Vec<f32> = (0..values.len()).filter(near).map(|m| values[m]).collect();
                let mean = around.iter().sum::<f32>() / around.len() as f32;
                assert!((found - mean).abs() < 1e-4, "{reach} {n}: {found} {mean}");
            }
        }
        assert!(blurred(&[], 0, 3).is_empty());
    }
}
