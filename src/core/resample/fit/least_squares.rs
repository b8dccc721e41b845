//! The curve with a given number of control points that is nearest to the data. The normal equations are solved
//! directly.
//!
//! Their matrix is banded. For a periodic curve its last three rows wrap round to the first columns, so they are stored
//! apart.

use glam::DVec2;

use super::curve::{Curve, basis};

/// Weight of staying at the start position, relative to a data point. Control points that the data do not determine
/// stay on the line.
const STAY: f64 = 1e-6;

/// Data along a line, and the length up to each.
pub(super) struct Data {
    pub(super) points: Vec<DVec2>,
    pub(super) lengths: Vec<f64>,
}

impl Data {
    /// The point at a length along the line.
    fn at(&self, s: f64) -> DVec2 {
        let (line, lengths) = (&self.points, &self.lengths);
        let k = lengths.partition_point(|&l| l <= s).clamp(1, line.len() - 1);
        let width = lengths[k] - lengths[k - 1];
        if width > 0.0 { line[k - 1].lerp(line[k], ((s - lengths[k - 1]) / width).clamp(0.0, 1.0)) } else { line[k] }
    }
}

/// The curve with `n` control points nearest to the data, if it is within `limit` of the data at their parameters.
pub(super) fn fit(data: &Data, closed: bool, n: usize, limit: f64) -> Option<Curve> {
    let spans = if closed { n } else { n - 3 };
    let scale = spans as f64 / data.lengths[data.lengths.len() - 1];
    // Each control point starts on the line, at the middle of its basis function.
    let start = |i: usize| {
        let middle = if closed {
            (i as f64 - 1.0).rem_euclid(n as f64)
        } else {
            let knot = |k: usize| (k as f64 - 3.0).clamp(0.0, spans as f64);
            (knot(i + 1) + knot(i + 2) + knot(i + 3)) / 3.0
        };
        data.at(middle / scale)
    };
    let mut curve = Curve { closed, control: (0..n).map(start).collect() };
    // The last point of a closed line is its first point again.
    let used = data.points.len() - usize::from(closed);
    let rows = || data.lengths[..used].iter().map(|&s| basis(s * scale, spans, closed)).zip(&data.points);
    let mut matrix = Matrix::new(if closed { n - 3 } else { n }, n);
    let mut right = vec![DVec2::ZERO; n];
    for ((first, w), &p) in rows() {
        let index = |a: usize| if first + a < n { first + a } else { first + a - n };
        let away = p - (0..4).map(|j| curve.control[index(j)] * w[j]).sum::<DVec2>();
        for a in 0..4 {
            right[index(a)] += away * w[a];
            for b in a..4 {
                matrix.add(index(a), index(b), w[a] * w[b]);
            }
        }
    }
    (0..n).for_each(|i| matrix.add(i, i, STAY));
    if !closed {
        for end in [0, n - 1] {
            matrix.fix(end);
            right[end] = DVec2::ZERO;
        }
    }
    matrix.solve(&mut right);
    curve.control.iter_mut().zip(right).for_each(|(c, step)| *c += step);
    let near = rows().all(|((first, w), &p)| {
        let at = (0..4).map(|j| curve.control[if first + j < n { first + j } else { first + j - n }] * w[j]).sum();
        p.distance_squared(at) <= limit * limit
    });
    near.then_some(curve)
}

/// A symmetric matrix: a band of half-width 3, with the rows from `inner` on kept as columns of their own.
struct Matrix {
    inner: usize,
    /// Entry d of row i is that of the columns i − d.
    band: Vec<[f64; 4]>,
    /// For every column, its entries in the last rows.
    border: Vec<[f64; 3]>,
}

impl Matrix {
    fn new(inner: usize, n: usize) -> Self {
        Self { inner, band: vec![[0.0; 4]; inner], border: vec![[0.0; 3]; if inner < n { n } else { 0 }] }
    }

    fn add(&mut self, i: usize, k: usize, value: f64) {
        let (low, high) = (i.min(k), i.max(k));
        if high < self.inner {
            self.band[high][high - low] += value;
        } else {
            self.border[low][high - self.inner] += value;
        }
    }

    /// Makes row and column those of the unit matrix. Only for a matrix without border.
    fn fix(&mut self, i: usize) {
        self.band[i] = [1.0, 0.0, 0.0, 0.0];
        for d in 1..4.min(self.inner - i) {
            self.band[i + d][d] = 0.0;
        }
    }

    /// Solves by Cholesky's method, the inner part first.
    fn solve(mut self, r: &mut [DVec2]) {
        let (m, band, border) = (self.inner, &mut self.band, &mut self.border);
        for i in 0..m {
            for d in (0..4.min(i + 1)).rev() {
                let sum: f64 = (d + 1..4.min(i + 1)).map(|e| band[i][e] * band[i - d][e - d]).sum();
                let rest = band[i][d] - sum;
                band[i][d] = if d == 0 { rest.sqrt() } else { rest / band[i - d][0] };
            }
            let back = |d: usize| r[i - d] * band[i][d];
            let sum: DVec2 = (1..4.min(i + 1)).map(back).sum();
            r[i] = (r[i] - sum) / band[i][0];
        }
        if !border.is_empty() {
            Self::solve_border(m, band, border, r);
        }
        for i in (0..m).rev() {
            let sum: DVec2 = (1..4.min(m - i)).map(|d| r[i + d] * band[i + d][d]).sum();
            r[i] = (r[i] - sum) / band[i][0];
        }
    }

    /// Solves for the three last unknowns, and subtracts their effect on the others.
    fn solve_border(m: usize, band: &[[f64; 4]], border: &mut [[f64; 3]], r: &mut [DVec2]) {
        let mut corner = [[0.0; 3]; 3];
        for p in 0..3 {
            for q in 0..=p {
                corner[p][q] = border[m + q][p];
            }
        }
        let mut rest = [r[m], r[m + 1], r[m + 2]];
        for i in 0..m {
            for p in 0..3 {
                let sum: f64 = (1..4.min(i + 1)).map(|d| border[i - d][p] * band[i][d]).sum();
                border[i][p] = (border[i][p] - sum) / band[i][0];
                rest[p] -= r[i] * border[i][p];
            }
            for p in 0..3 {
                for q in 0..=p {
                    corner[p][q] -= border[i][p] * border[i][q];
                }
            }
        }
        for p in 0..3 {
            for q in 0..=p {
                let sum: f64 = (0..q).map(|e| corner[p][e] * corner[q][e]).sum();
                let value = corner[p][q] - sum;
                corner[p][q] = if p == q { value.sqrt() } else { value / corner[q][q] };
            }
            let sum: DVec2 = (0..p).map(|q| rest[q] * corner[p][q]).sum();
            rest[p] = (rest[p] - sum) / corner[p][p];
        }
        for p in (0..3).rev() {
            let sum: DVec2 = (p + 1..3).map(|q| rest[q] * corner[q][p]).sum();
            rest[p] = (rest[p] - sum) / corner[p][p];
            r[m + p] = rest[p];
        }
        for i in 0..m {
            let taken: DVec2 = (0..3).map(|p| rest[p] * border[i][p]).sum();
            r[i] -= taken;
        }
    }
}
