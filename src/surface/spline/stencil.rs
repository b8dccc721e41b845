//! The matrix of an energy: what a height at each node adds to the gradient at the nodes around.
//!
//! It is symmetric and reaches two nodes far, so that each node has a coefficient of its own and six for the nodes that come
//! after it. Steps of conjugate gradients multiply by it, hundreds of times for an energy.

use std::borrow::Cow;

use pulp::Arch;
use rayon::prelude::*;

use super::energy::Energy;

/// Nodes that one task works on.
const CHUNK: usize = 1 << 13;
/// Rows and columns that the matrix reaches.
pub const REACH: usize = 2;

/// The coefficients of a symmetric matrix over a lattice. Those that would leave the lattice are 0.
#[derive(Default)]
pub struct Stencil {
    cols: usize,
    /// Of the node itself and of its neighbours to the E, EE, S, SS, SE and SW, each after [`Stencil::pad`] zeros.
    of: [Vec<f32>; 7],
}

impl Stencil {
    /// The matrix of an energy.
    pub fn new(energy: &Energy) -> Self {
        let [cols, rows] = energy.size;
        let pad = REACH * cols + REACH;
        let mut stencil = Self { cols, of: std::array::from_fn(|_| vec![0.0; pad + cols * rows]) };
        stencil.set(energy);
        stencil
    }

    /// Takes the matrix of an energy on the same lattice.
    pub fn set(&mut self, energy: &Energy) {
        let pad = self.pad();
        for (k, of) in self.of.iter_mut().enumerate() {
            let chunks = of[pad..].par_chunks_mut(CHUNK).enumerate();
            chunks.for_each(|(chunk, out)| coefficients(energy, k, chunk * CHUNK, out));
        }
    }

    /// Zeros that vectors have before the first node and after the last: as far as the matrix reaches.
    #[inline(always)]
    pub fn pad(&self) -> usize {
        REACH * self.cols + REACH
    }

    /// The coefficients of the nodes themselves.
    pub fn diagonal(&self) -> &[f32] {
        &self.of[0][self.pad()..]
    }

    /// Number of columns of the lattice.
    pub fn cols(&self) -> usize {
        self.cols
    }

    /// Takes the coefficients of a window of another lattice, for heights in units of their own.
    ///
    /// The window begins [`REACH`] columns and rows before the node in `col` and `row`. Coefficients beyond the lattice are 0.
    pub fn cut(&mut self, from: &Self, [col, row]: [usize; 2], [cols, rows]: [usize; 2], unit: &[f32]) {
        self.cols = cols;
        let pad = self.pad();
        // Columns of the window that lie west of the lattice, and the first one that does not.
        let beyond = REACH.saturating_sub(col);
        let first = col + beyond - REACH;
        let width = (cols - beyond).min(from.cols - first);
        let after = [0, 1, 2, cols, 2 * cols, cols + 1, cols - 1];
        for ((to, all), after) in self.of.iter_mut().zip(&from.of).zip(after) {
            to.clear();
            to.resize(pad + unit.len(), 0.0);
            for k in REACH.saturating_sub(row)..rows {
                let start = from.pad() + (row + k - REACH) * from.cols + first;
                let Some(all) = all.get(start..start + width) else { break };
                let n = k * cols + beyond;
                let Some(other) = unit.get(n + after..) else { break };
                let units = unit[n..].iter().zip(other);
                to[pad + n..].iter_mut().zip(all).zip(units).for_each(|((to, of), (u, v))| *to = of * u * v);
            }
        }
    }

    /// Multiplies `z`, which is padded.
    pub fn apply(&self, z: &[f32], out: &mut [f32]) {
        let chunks = out.par_chunks_mut(CHUNK).enumerate();
        chunks.for_each(|(k, out)| Arch::new().dispatch(|| self.apply_from(z, self.pad() + k * CHUNK, out)));
    }

    /// ... for the nodes from `first` on, padding counted. All is cut to the same length first: the loop has no branch.
    #[inline(always)]
    pub fn apply_from(&self, z: &[f32], first: usize, out: &mut [f32]) {
        let (n, cols, len) = (first, self.cols, out.len());
        let [own, e, ee, s, ss, se, sw] = &self.of;
        let row = &z[n - 2..n + len + 2];
        let (north, south) = (&z[n - cols - 1..n - cols + len + 1], &z[n + cols - 1..n + cols + len + 1]);
        let (north2, south2) = (&z[n - 2 * cols..][..len], &z[n + 2 * cols..][..len]);
        let (own, e, ee) = (&own[n..][..len], &e[n - 1..][..len + 1], &ee[n - 2..][..len + 2]);
        let (s, to_s) = (&s[n - cols..][..len], &s[n..][..len]);
        let (ss, to_ss) = (&ss[n - 2 * cols..][..len], &ss[n..][..len]);
        let (se, to_se) = (&se[n - cols - 1..][..len], &se[n..][..len]);
        let (sw, to_sw) = (&sw[n - cols + 1..][..len], &sw[n..][..len]);
        for i in 0..len {
            let beside = e[i] * row[i + 1] + e[i + 1] * row[i + 3] + ee[i] * row[i] + ee[i + 2] * row[i + 4];
            let above = s[i] * north[i + 1] + se[i] * north[i] + sw[i] * north[i + 2] + ss[i] * north2[i];
            let below = to_s[i] * south[i + 1] + to_se[i] * south[i + 2] + to_sw[i] * south[i] + to_ss[i] * south2[i];
            out[i] = own[i] * row[i + 2] + beside + (above + below);
        }
    }
}

/// The coefficients of kind `k`, in the order of [`Stencil::of`], of the nodes from `first` on.
fn coefficients(energy: &Energy, k: usize, first: usize, out: &mut [f32]) {
    let cols = energy.size[0];
    let ([xx, yy, xy], [east, south]) = (&energy.bending, &energy.tension);
    let back = |weights, by: usize| shifted(weights, first as isize - by as isize, out.len());
    let next = |weights, by: usize| shifted(weights, (first + by) as isize, out.len());
    let here = |weights| next(weights, 0);
    // Each second difference once for every pair of its nodes, each first one alike.
    let parts: &[(f32, Cow<[f32]>)] = match k {
        0 => &[
            (1.0, back(xx, 1)),
            (4.0, here(xx)),
            (1.0, next(xx, 1)),
            (1.0, back(yy, cols)),
            (4.0, here(yy)),
            (1.0, next(yy, cols)),
            (1.0, here(xy)),
            (1.0, back(xy, 1)),
            (1.0, back(xy, cols)),
            (1.0, back(xy, cols + 1)),
            (1.0, here(east)),
            (1.0, back(east, 1)),
            (1.0, here(south)),
            (1.0, back(south, cols)),
        ],
        1 => &[(-2.0, here(xx)), (-2.0, next(xx, 1)), (-1.0, here(xy)), (-1.0, back(xy, cols)), (-1.0, here(east))],
        2 => &[(1.0, next(xx, 1))],
        3 => &[(-2.0, here(yy)), (-2.0, next(yy, cols)), (-1.0, here(xy)), (-1.0, back(xy, 1)), (-1.0, here(south))],
        4 => &[(1.0, next(yy, cols))],
        5 => &[(1.0, here(xy))],
        _ => &[(1.0, back(xy, 1))],
    };
    out.fill(if k == 0 { energy.pull } else { 0.0 });
    for (factor, weights) in parts {
        out.iter_mut().zip(&**weights).for_each(|(out, weight)| *out += factor * weight);
    }
    for (terms, step, along) in [(&energy.contours[0], 1, 1), (&energy.contours[1], cols, 3)] {
        let here = terms.starting_in(first..first + out.len());
        if k == 0 {
            here.iter().for_each(|t| out[t.node as usize - first] += t.a);
            let before = first.saturating_sub(step)..(first + out.len()).saturating_sub(step);
            let ending = terms.starting_in(before).iter().filter(|t| t.node as usize + step >= first);
            ending.for_each(|t| out[t.node as usize + step - first] += t.c);
        } else if k == along {
            here.iter().for_each(|t| out[t.node as usize - first] += t.b);
        }
    }
}

/// `len` of the weights from `first` on; 0 where there are none.
fn shifted(weights: &[f32], first: isize, len: usize) -> Cow<'_, [f32]> {
    let at = |k: isize| usize::try_from(k).ok().and_then(|k| weights.get(k)).copied().unwrap_or(0.0);
    match usize::try_from(first).ok().and_then(|first| weights.get(first..first + len)) {
        Some(weights) => Cow::Borrowed(weights),
        None => (first..first + len as isize).map(at).collect(),
    }
}
