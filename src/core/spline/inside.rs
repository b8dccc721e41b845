//! The nodes of a lattice that belong to the surface.

use std::ops::Range;

use crate::base::parallel;

/// Number of nodes beyond the frame that belong to the surface. So every place inside the frame lies between nodes.
pub const MARGIN: usize = 2;

/// The nodes inside the frame and a margin of [`MARGIN`] nodes around them.
pub struct Inside {
    cols: usize,
    is_inside: Vec<bool>,
    /// For each row: the columns from the first node inside to the last one. Where the frame is no rectangle, much of the
    /// lattice lies beyond them.
    spans: Vec<Range<usize>>,
}

impl Inside {
    /// The frame is where the `bound` of the heights is not NaN.
    pub fn new(bound: &[f32], cols: usize) -> Self {
        let rows = bound.len() / cols.max(1);
        let mut inside: Vec<bool> = parallel::values_each(bound, |v| !v.is_nan());
        for _ in 0..MARGIN {
            let before = inside.clone();
            parallel::chunks(&mut inside, cols, |j, row| {
                for (i, inside) in row.iter_mut().enumerate() {
                    let n = j * cols + i;
                    *inside |= (i > 0 && before[n - 1])
                        || (i + 1 < cols && before[n + 1])
                        || (j > 0 && before[n - cols])
                        || (j + 1 < rows && before[n + cols]);
                }
            });
        }
        let span = |row: &[bool]| {
            let first = row.iter().position(|inside| *inside)?;
            let last = row.iter().rposition(|inside| *inside)?;
            Some(first..last + 1)
        };
        let spans = parallel::map(rows, |j| span(&inside[j * cols..(j + 1) * cols]).unwrap_or(0..0));
        Self { cols, is_inside: inside, spans }
    }

    /// Whether all these nodes are inside.
    pub fn all(&self, nodes: &[usize]) -> bool {
        nodes.iter().all(|&n| self.is_inside[n])
    }

    /// The results of `f` for the columns and rows of all nodes. `f` must give the default for nodes outside, because it is
    /// not asked for most of them.
    pub fn values<R: Copy + Default + Send>(&self, f: impl Fn(usize, usize) -> R + Sync) -> Vec<R> {
        let mut values = vec![R::default(); self.is_inside.len()];
        parallel::chunks(&mut values, self.cols, |j, row| {
            let span = self.spans[j].clone();
            for (i, value) in span.clone().zip(&mut row[span]) {
                *value = f(i, j);
            }
        });
        values
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_of_all_nodes_inside_are_asked_for() {
        // A frame that is a ring, with one row that is all outside.
        let (cols, rows) = (40, 30);
        let ring = |n: usize| (6..=9).contains(&(n % cols).abs_diff(20).max((n / cols).abs_diff(15)));
        let bound: Vec<f32> = (0..cols * rows).map(|n| if ring(n) { 7.0 } else { f32::NAN }).collect();
        let inside = Inside::new(&bound, cols);
        let steps = |a: usize, b: usize| (a % cols).abs_diff(b % cols) + (a / cols).abs_diff(b / cols);
        let near = |n: usize| (0..bound.len()).any(|m| ring(m) && steps(n, m) <= MARGIN);
        let expected: Vec<usize> = (0..bound.len()).map(|n| if near(n) { n } else { 0 }).collect();
        let found = inside.values(|i, j| if inside.all(&[j * cols + i]) { j * cols + i } else { 0 });
        assert_eq!(found, expected);
        let asked = inside.values(|_, _| true).iter().filter(|asked| **asked).count();
        assert!(asked < 600, "{asked} of {} nodes", bound.len());
    }
}
