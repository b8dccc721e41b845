//! The energy of a surface on a lattice: bending, tension and distance from the contours.
//!
//! `Σ w δ²` over second differences δ (eastwards, southwards, and the mixed one twice), `+ Σ t (Δz - Δg)²` over first
//! differences of the surface z and of a guide g, `+ Σ λ (z at crossing - level)²` over the crossings of contours with
//! edges of the lattice, where z is linear along the edge, `+ Σ p z²`. It is quadratic in the heights.

use rayon::prelude::*;

use super::lattice::{Crossing, Lattice};

/// Rows that one task works on.
const BLOCK: usize = 32;

/// Single or double precision.
pub trait Real:
    Copy
    + Send
    + Sync
    + From<f32>
    + std::ops::Add<Output = Self>
    + std::ops::Sub<Output = Self>
    + std::ops::Mul<Output = Self>
    + std::ops::AddAssign
    + std::ops::SubAssign
{
}
impl Real for f32 {}
impl Real for f64 {}

/// What the crossings on one edge ask of its ends u and v: `a u² + 2 b u v + c v² - 2 p u - 2 q v`.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
struct EdgeTerm {
    node: u32,
    a: f32,
    b: f32,
    c: f32,
    p: f64,
    q: f64,
}

/// The terms of all eastward or all southward edges, one an edge, by the rows of their first nodes.
#[derive(Debug, Clone, Default)]
pub struct EdgeTerms {
    terms: Vec<EdgeTerm>,
    row_start: Vec<usize>,
}

impl EdgeTerms {
    /// Sums up crossings with their levels. Every crossing has the same weight.
    pub fn new(crossings: &[(Crossing, f64)], weight: f64, lattice: &Lattice) -> Self {
        let term = |&(crossing, level): &(Crossing, f64)| {
            let (v, u) = (crossing.along, 1.0 - crossing.along);
            EdgeTerm {
                node: crossing.node,
                a: (weight * u * u) as f32,
                b: (weight * u * v) as f32,
                c: (weight * v * v) as f32,
                p: weight * u * level,
                q: weight * v * level,
            }
        };
        let mut all: Vec<EdgeTerm> = crossings.iter().map(term).collect();
        all.sort_by_key(|t| t.node);
        let mut terms: Vec<EdgeTerm> = Vec::with_capacity(all.len());
        for t in all {
            match terms.last_mut() {
                Some(last) if last.node == t.node => {
                    last.a += t.a;
                    last.b += t.b;
                    last.c += t.c;
                    last.p += t.p;
                    last.q += t.q;
                }
                _ => terms.push(t),
            }
        }
        let start = |row: usize| terms.partition_point(|t| (t.node as usize) < row * lattice.cols);
        let row_start = (0..=lattice.rows).map(start).collect();
        Self { terms, row_start }
    }

    fn of_row(&self, row: usize) -> &[EdgeTerm] {
        &self.terms[self.row_start[row]..self.row_start[row + 1]]
    }

    /// The first nodes of the edges that contours cross.
    pub fn nodes(&self) -> impl Iterator<Item = usize> {
        self.terms.iter().map(|t| t.node as usize)
    }
}

/// The energy's coefficients. A weight of zero switches a difference off.
#[derive(Debug, Clone)]
pub struct Energy {
    /// Columns and rows of the lattice.
    pub size: [usize; 2],
    /// Weights of the second differences: eastwards and southwards at their middle node, mixed at the north-western one.
    pub bending: [Vec<f32>; 3],
    /// Weights of the first differences to the eastern and to the southern neighbour.
    pub tension: [Vec<f32>; 2],
    /// Heights whose first differences the surface is drawn to; level ground where NaN.
    pub guide: Vec<f32>,
    /// Crossings on eastward and on southward edges.
    pub contours: [EdgeTerms; 2],
    /// Weight of the squared height itself at every node: draws the surface to 0.
    pub pull: f32,
}

impl Energy {
    /// Half the energy's gradient, without its constant part.
    pub fn apply<T: Real>(&self, z: &[T], out: &mut [T]) {
        let cols = self.size[0];
        out.par_chunks_mut(cols * BLOCK).enumerate().for_each(|(k, block)| self.apply_block(z, k * BLOCK, block));
    }

    /// ... for some rows. Differences are formed once a row and kept while a row below needs them.
    fn apply_block<T: Real>(&self, z: &[T], first: usize, block: &mut [T]) {
        let [cols, rows] = self.size;
        let zero = T::from(0.0);
        let row_of = |j: usize| j * cols..(j + 1) * cols;
        let blank = || vec![zero; cols];
        let mut xx = blank();
        let mut yy = [blank(), blank(), blank()];
        let mut mixed = [blank(), blank()];
        let mut south = [blank(), blank()];
        // Rows are numbered from one here, so that the row above the first can be asked for.
        let fill_yy = |j: usize, out: &mut [T]| {
            if j < 2 || j > rows - 1 {
                return out.fill(zero);
            }
            let (n, m, s) = (&z[row_of(j - 2)], &z[row_of(j - 1)], &z[row_of(j)]);
            let w = &self.bending[1][row_of(j - 1)];
            for i in 0..cols {
                out[i] = T::from(w[i]) * (n[i] - m[i] - m[i] + s[i]);
            }
        };
        let fill_pairs = |j: usize, mixed: &mut [T], south: &mut [T]| {
            if j < 1 || j > rows - 1 {
                mixed.fill(zero);
                return south.fill(zero);
            }
            let (n, s) = (&z[row_of(j - 1)], &z[row_of(j)]);
            let (w, t) = (&self.bending[2][row_of(j - 1)], &self.tension[1][row_of(j - 1)]);
            for i in 0..cols - 1 {
                mixed[i] = T::from(w[i]) * (n[i] - n[i + 1] - s[i] + s[i + 1]);
            }
            for i in 0..cols {
                south[i] = T::from(t[i]) * (n[i] - s[i]);
            }
        };
        fill_yy(first, &mut yy[0]);
        fill_yy(first + 1, &mut yy[1]);
        fill_pairs(first, &mut mixed[0], &mut south[0]);
        for (dj, out) in block.chunks_exact_mut(cols).enumerate() {
            let j = first + dj;
            fill_yy(j + 2, &mut yy[2]);
            fill_pairs(j + 1, &mut mixed[1], &mut south[1]);
            let m = &z[row_of(j)];
            let (w, t) = (&self.bending[0][row_of(j)], &self.tension[0][row_of(j)]);
            for i in 1..cols - 1 {
                xx[i] = T::from(w[i]) * (m[i - 1] - m[i] - m[i] + m[i + 1]);
            }
            for i in 0..cols {
                let bend = yy[0][i] - yy[1][i] - yy[1][i] + yy[2][i] - xx[i] - xx[i] + T::from(self.pull) * m[i];
                out[i] = bend + mixed[1][i] - mixed[0][i] + south[1][i] - south[0][i];
            }
            for i in 1..cols {
                out[i] += xx[i - 1] - mixed[1][i - 1] + mixed[0][i - 1];
                out[i - 1] += xx[i];
            }
            for i in 0..cols - 1 {
                let east = T::from(t[i]) * (m[i] - m[i + 1]);
                out[i] += east;
                out[i + 1] -= east;
            }
            for e in self.contours[0].of_row(j) {
                let i = e.node as usize - j * cols;
                out[i] += T::from(e.a) * m[i] + T::from(e.b) * m[i + 1];
                out[i + 1] += T::from(e.b) * m[i] + T::from(e.c) * m[i + 1];
            }
            for e in self.contours[1].of_row(j) {
                let i = e.node as usize - j * cols;
                out[i] += T::from(e.a) * m[i] + T::from(e.b) * z[e.node as usize + cols];
            }
            if j > 0 {
                for e in self.contours[1].of_row(j - 1) {
                    let i = e.node as usize - (j - 1) * cols;
                    out[i] += T::from(e.b) * z[e.node as usize] + T::from(e.c) * m[i];
                }
            }
            yy.rotate_left(1);
            mixed.swap(0, 1);
            south.swap(0, 1);
        }
    }

    /// The constant part of half the gradient, and one over the diagonal of the linear part (0 where that is 0).
    pub fn constant_and_inverse_diagonal(&self) -> (Vec<f64>, Vec<f32>) {
        let cols = self.size[0];
        let count = self.guide.len();
        let mut constant = vec![0.0; count];
        let mut diagonal = vec![self.pull; count];
        for (side, step) in [1, cols].into_iter().enumerate() {
            for e in &self.contours[side].terms {
                let (u, v) = (e.node as usize, e.node as usize + step);
                constant[u] += e.p;
                constant[v] += e.q;
                diagonal[u] += e.a;
                diagonal[v] += e.c;
            }
            for n in (0..count).filter(|&n| self.tension[side][n] > 0.0) {
                let (t, m) = (self.tension[side][n], n + step);
                let fall = f64::from(self.guide[n]) - f64::from(self.guide[m]);
                let pull = if fall.is_nan() { 0.0 } else { f64::from(t) * fall };
                constant[n] += pull;
                constant[m] -= pull;
                diagonal[n] += t;
                diagonal[m] += t;
            }
            for n in (0..count).filter(|&n| self.bending[side][n] > 0.0) {
                let w = self.bending[side][n];
                diagonal[n] += 4.0 * w;
                diagonal[n - step] += w;
                diagonal[n + step] += w;
            }
        }
        for n in (0..count).filter(|&n| self.bending[2][n] > 0.0) {
            for m in [n, n + 1, n + cols, n + cols + 1] {
                diagonal[m] += self.bending[2][n];
            }
        }
        let inverse = diagonal.into_iter().map(|d| if d > 0.0 { 1.0 / d } else { 0.0 }).collect();
        (constant, inverse)
    }

    /// The second difference of `z` that a bending weight at `node` belongs to; the weight must not be 0.
    pub fn second_difference(&self, kind: usize, node: usize, z: &[f64]) -> f64 {
        let cols = self.size[0];
        match kind {
            0 => z[node - 1] - 2.0 * z[node] + z[node + 1],
            1 => z[node - cols] - 2.0 * z[node] + z[node + cols],
            _ => z[node] - z[node + 1] - z[node + cols] + z[node + cols + 1],
        }
    }
}

#[cfg(test)]
mod tests {
    use glam::DVec2;

    use super::*;

    /// Coefficients without pattern on a small lattice; weights are 0 where their difference would leave it.
    fn energy(cols: usize, rows: usize) -> Energy {
        let mut state = 7u32;
        let mut random = || {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            (state >> 16) as f32 / 65_536.0
        };
        let mut weights = |keep: &dyn Fn(usize, usize) -> bool| -> Vec<f32> {
            (0..cols * rows).map(|n| if keep(n % cols, n / cols) { random() } else { 0.0 }).collect()
        };
        let bending = [
            weights(&|i, _| i > 0 && i + 1 < cols),
            weights(&|_, j| j > 0 && j + 1 < rows),
            weights(&|i, j| i + 1 < cols && j + 1 < rows),
        ];
        let tension = [weights(&|i, _| i + 1 < cols), weights(&|_, j| j + 1 < rows)];
        let guide = weights(&|_, _| true);
        let lattice = Lattice { first: DVec2::ZERO, step: DVec2::ONE, cols, rows };
        let crossing = |node: usize, along: f64| (Crossing { node: node as u32, along }, 100.0 * along);
        let contours = [
            EdgeTerms::new(&[crossing(cols, 0.25), crossing(cols, 0.5), crossing(0, 1.0)], 3.0, &lattice),
            EdgeTerms::new(&[crossing(cols + 1, 0.75), crossing(1, 0.1)], 3.0, &lattice),
        ];
        Energy { size: [cols, rows], bending, tension, guide, contours, pull: 0.25 }
    }

    /// The energy by its definition.
    fn value(e: &Energy, z: &[f64]) -> f64 {
        let cols = e.size[0];
        let mut sum = 0.0;
        for n in 0..z.len() {
            sum += f64::from(e.pull) * z[n] * z[n];
            for k in 0..3 {
                if e.bending[k][n] > 0.0 {
                    sum += f64::from(e.bending[k][n]) * e.second_difference(k, n, z).powi(2);
                }
            }
            for (k, step) in [1, cols].into_iter().enumerate() {
                if e.tension[k][n] > 0.0 {
                    let fall = f64::from(e.guide[n]) - f64::from(e.guide[n + step]);
                    sum += f64::from(e.tension[k][n]) * (z[n] - z[n + step] - fall).powi(2);
                }
            }
        }
        for (k, step) in [1, cols].into_iter().enumerate() {
            for t in &e.contours[k].terms {
                let (u, v) = (z[t.node as usize], z[t.node as usize + step]);
                sum += f64::from(t.a) * u * u + 2.0 * f64::from(t.b) * u * v + f64::from(t.c) * v * v;
                sum -= 2.0 * (t.p * u + t.q * v);
            }
        }
        sum
    }

    #[test]
    fn the_gradient_is_that_of_the_energy() {
        // More rows than a block has.
        let (cols, rows) = (5, BLOCK + 3);
        let e = energy(cols, rows);
        let z: Vec<f64> = (0..cols * rows).map(|n| ((n * 37) % 23) as f64).collect();
        let mut gradient = vec![0.0; z.len()];
        e.apply(&z, &mut gradient);
        let (constant, inverse) = e.constant_and_inverse_diagonal();
        for n in 0..z.len() {
            let at = |step: f64| {
                let mut moved = z.clone();
                moved[n] += step;
                value(&e, &moved)
            };
            // Exact for a quadratic function, up to rounding.
            let slope = (at(1.0) - at(-1.0)) / 4.0;
            let curve = (at(1.0) - 2.0 * at(0.0) + at(-1.0)) / 2.0;
            assert!((slope - (gradient[n] - constant[n])).abs() < 1e-6 * slope.abs().max(100.0), "node {n}");
            assert!((curve * f64::from(inverse[n]) - 1.0).abs() < 1e-4, "node {n}: {curve} {}", inverse[n]);
        }
    }
}
