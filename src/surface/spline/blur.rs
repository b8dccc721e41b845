//! Means over rectangles of nodes.

use rayon::prelude::*;

/// Rows that are one task, or twice the reach if that is more; sums begin anew with each, so that the means are the same for any
/// number of threads.
const STRIP: usize = 128;

/// The mean of the values at most `reach` columns and rows away from each node, as far as there are such.
pub fn blurred(values: &[f32], cols: usize, reach: usize) -> Vec<f32> {
    // However far contours are apart.
    let reach = reach.min(values.len());
    let mut along = vec![0.0f32; values.len()];
    along.par_chunks_mut(cols.max(1)).zip(values.par_chunks(cols.max(1))).for_each(|(out, row)| {
        let mut sum: f64 = row.iter().take(reach).map(|v| f64::from(*v)).sum();
        for i in 0..cols {
            sum += row.get(i + reach).map_or(0.0, |v| f64::from(*v));
            sum -= if i > reach { f64::from(row[i - reach - 1]) } else { 0.0 };
            out[i] = (sum / count(i, reach, cols)) as f32;
        }
    });
    let mut all = vec![0.0f32; values.len()];
    let strip = STRIP.max(2 * reach);
    let strips = all.par_chunks_mut((strip * cols).max(1)).enumerate();
    strips.for_each(|(k, rows)| down(&along, cols, reach, k * strip, rows));
    all
}

/// The mean of the rows at most `reach` away from each, for the rows of a strip from `first` on.
fn down(values: &[f32], cols: usize, reach: usize, first: usize, strip: &mut [f32]) {
    let rows = values.len() / cols;
    let mut sums = vec![0.0f64; cols];
    let add = |sums: &mut [f64], j: usize, sign: f64| {
        sums.iter_mut().zip(&values[j * cols..(j + 1) * cols]).for_each(|(sum, v)| *sum += sign * f64::from(*v));
    };
    (first.saturating_sub(reach + 1)..(first + reach).min(rows)).for_each(|j| add(&mut sums, j, 1.0));
    for (j, out) in (first..).zip(strip.chunks_mut(cols)) {
        if j + reach < rows {
            add(&mut sums, j + reach, 1.0);
        }
        if j > reach {
            add(&mut sums, j - reach - 1, -1.0);
        }
        let count = count(j, reach, rows);
        out.iter_mut().zip(&sums).for_each(|(out, sum)| *out = (sum / count) as f32);
    }
}

/// Number of places at most `reach` from the `i`-th of `count`.
fn count(i: usize, reach: usize, count: usize) -> f64 {
    ((i + reach).min(count - 1) - i.saturating_sub(reach) + 1) as f64
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
