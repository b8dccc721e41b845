//! The matrix of an energy: how the height at each node changes the gradient at the nodes around.
//!
//! The matrix is symmetric and reaches two nodes far. So each node has seven coefficients: its own, and six for the
//! nodes that come after it. Steps of conjugate gradients multiply by it.

use std::borrow::Cow;

use super::energy::Energy;

/// Reach of the matrix, rows and columns.
pub const REACH: usize = 2;
/// Numbers that the processor computes side by side. Vectors are filled up with zeros to a multiple of it.
pub const LANES: usize = 32;

/// The kinds of coefficients, in the order of [`Stencil::of`], that a membrane does not have.
const OF_BENDING: [usize; 4] = [2, 4, 5, 6];

/// The coefficients of a symmetric matrix in a window of a lattice. Those that would cross the border of the lattice
/// are 0.
///
/// They are made anew each time that a window is worked on. The matrix of a large lattice would take most of the
/// memory, and reading it would take about as long as making it.
#[derive(Default)]
pub struct Stencil {
    cols: usize,
    /// Coefficients of the node itself and of its neighbours to the E, EE, S, SS, SE and SW. Each array begins with
    /// [`Stencil::pad`] zeros. Those that a membrane does not have are empty.
    of: [Vec<f32>; 7],
    /// Buffer for the coefficients of nodes that follow one another on the lattice.
    taken: Vec<f32>,
}

impl Stencil {
    /// Takes the matrix of an energy in a window. The window begins [`REACH`] columns and rows before the node in `col`
    /// and `row`.
    #[inline(always)]
    pub fn take(&mut self, energy: &Energy<'_>, [col, row]: [usize; 2], [cols, rows]: [usize; 2]) {
        self.cols = cols;
        let first = self.pad();
        // Columns and rows of the window that lie before the lattice, and the number of those that lie on it.
        let before = [REACH.saturating_sub(col), REACH.saturating_sub(row)];
        let [west, north] = [col + before[0] - REACH, row + before[1] - REACH];
        let width = (cols - before[0]).min(energy.size[0] - west);
        let height = (rows - before[1]).min(energy.size[1] - north);
        // Rows as wide as the lattice follow one another in memory. So they are taken together.
        let together = if width == energy.size[0] { height } else { 1 };
        self.taken.resize(together * width, 0.0);
        for (k, of) in self.of.iter_mut().enumerate() {
            of.clear();
            if energy.is_membrane() && OF_BENDING.contains(&k) {
                continue;
            }
            of.resize(first + (cols * rows).next_multiple_of(LANES), 0.0);
            for j in (0..height).step_by(together) {
                coefficients(energy, k, (north + j) * energy.size[0] + west, &mut self.taken);
                for (i, row) in self.taken.chunks_exact(width).enumerate() {
                    of[first + (before[1] + j + i) * cols + before[0]..][..width].copy_from_slice(row);
                }
            }
        }
    }

    /// Number of zeros before the first node and after the last in a vector: as far as the matrix reaches.
    #[inline(always)]
    pub fn pad(&self) -> usize {
        REACH * self.cols + REACH
    }

    /// The coefficients of the nodes themselves.
    pub fn diagonal(&self) -> &[f32] {
        &self.of[0][self.pad()..]
    }

    /// Changes to scaled heights: each node has its own unit.
    #[inline(always)]
    pub fn scale(&mut self, unit: &[f32]) {
        let (first, cols) = (self.pad(), self.cols);
        let after = [0, 1, 2, cols, 2 * cols, cols + 1, cols - 1];
        for (of, after) in self.of.iter_mut().zip(after).filter(|(of, _)| !of.is_empty()) {
            let (inside, beyond) = of[first..].split_at_mut(unit.len() - after);
            for (of, (u, v)) in inside.iter_mut().zip(unit.iter().zip(&unit[after..])) {
                *of *= u * v;
            }
            beyond.fill(0.0);
        }
    }

    /// Multiplies the matrix by `direction`, which is padded. All slices get the same length first, so that the loop
    /// has no branch.
    #[inline(always)]
    pub fn apply(&self, direction: &[f32], out: &mut [f32]) {
        let (z, n, cols, len) = (direction, self.pad(), self.cols, out.len());
        let [own, e, ee, s, ss, se, sw] = &self.of;
        if ee.is_empty() {
            return self.apply_membrane(direction, out);
        }
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

    /// [`Stencil::apply`] for a membrane, whose matrix reaches one node far.
    #[inline(always)]
    fn apply_membrane(&self, direction: &[f32], out: &mut [f32]) {
        let (z, n, cols, len) = (direction, self.pad(), self.cols, out.len());
        let [own, e, _, s, ..] = &self.of;
        let row = &z[n - 1..n + len + 1];
        let (north, south) = (&z[n - cols..][..len], &z[n + cols..][..len]);
        let (own, e) = (&own[n..][..len], &e[n - 1..][..len + 1]);
        let (s, to_s) = (&s[n - cols..][..len], &s[n..][..len]);
        for i in 0..len {
            let beside = e[i] * row[i] + e[i + 1] * row[i + 2];
            out[i] = own[i] * row[i + 1] + beside + (s[i] * north[i] + to_s[i] * south[i]);
        }
    }
}

/// The coefficients of kind `k`, in the order of [`Stencil::of`], for the nodes from `first` on.
#[inline(always)]
fn coefficients(energy: &Energy<'_>, k: usize, first: usize, out: &mut [f32]) {
    let cols = energy.size[0];
    let ([xx, yy, xy], [east, south]) = (&energy.bending, &energy.tension);
    let len = out.len();
    let back = |weights, by: usize| shifted(weights, first as isize - by as isize, len);
    let next = |weights, by: usize| shifted(weights, (first + by) as isize, len);
    let here = |weights| next(weights, 0);
    out.fill(if k == 0 { energy.pull } else { 0.0 });
    // Each second difference counts once for every pair of its nodes, and so does each first difference.
    match k {
        0 if energy.is_membrane() => {
            add([here(east), back(east, 1), here(south), back(south, cols)].map(|weights| (1.0, weights)), out)
        }
        1 if energy.is_membrane() => add([(-1.0, here(east))], out),
        3 if energy.is_membrane() => add([(-1.0, here(south))], out),
        0 => {
            let along = [(1.0, back(xx, 1)), (4.0, here(xx)), (1.0, next(xx, 1))];
            let across = [(1.0, back(yy, cols)), (4.0, here(yy)), (1.0, next(yy, cols))];
            let mixed = [here(xy), back(xy, 1), back(xy, cols), back(xy, cols + 1)].map(|weights| (1.0, weights));
            let tension = [here(east), back(east, 1), here(south), back(south, cols)].map(|weights| (1.0, weights));
            add(along, out);
            add(across, out);
            add(mixed, out);
            add(tension, out);
        }
        1 => add(
            [(-2.0, here(xx)), (-2.0, next(xx, 1)), (-1.0, here(xy)), (-1.0, back(xy, cols)), (-1.0, here(east))],
            out,
        ),
        2 => out.copy_from_slice(&next(xx, 1)),
        3 => add(
            [(-2.0, here(yy)), (-2.0, next(yy, cols)), (-1.0, here(xy)), (-1.0, back(xy, 1)), (-1.0, here(south))],
            out,
        ),
        4 => out.copy_from_slice(&next(yy, cols)),
        5 => out.copy_from_slice(&here(xy)),
        _ => out.copy_from_slice(&back(xy, 1)),
    }
    let [eastward, southward] = &energy.contours;
    let nodes = first..first + out.len();
    match k {
        0 => {
            let starting = [eastward, southward].map(|terms| terms.starting_in(nodes.clone()));
            starting.into_iter().flatten().for_each(|t| out[t.node as usize - first] += t.a);
            let ending = eastward.starting_in(nodes.start.saturating_sub(1)..nodes.end - 1);
            ending.iter().for_each(|t| out[t.node as usize + 1 - first] += t.c);
            let ending = southward.starting_in(nodes.start.saturating_sub(cols)..nodes.end.saturating_sub(cols));
            ending.iter().for_each(|t| out[t.node as usize + cols - first] += t.c);
        }
        1 => eastward.starting_in(nodes).iter().for_each(|t| out[t.node as usize - first] += t.b),
        3 => southward.starting_in(nodes).iter().for_each(|t| out[t.node as usize - first] += t.b),
        _ => {}
    }
}

/// Adds the weights, each times its factor.
#[inline(always)]
fn add<const N: usize>(parts: [(f32, Cow<'_, [f32]>); N], out: &mut [f32]) {
    let parts = parts.each_ref().map(|(factor, weights)| (*factor, &weights[..out.len()]));
    for i in 0..out.len() {
        out[i] += parts.iter().fold(0.0, |sum, (factor, weights)| sum + factor * weights[i]);
    }
}

/// `len` weights from `first` on. Beyond the ends they are 0.
fn shifted(weights: &[f32], first: isize, len: usize) -> Cow<'_, [f32]> {
    let at = |k: isize| usize::try_from(k).ok().and_then(|k| weights.get(k)).copied().unwrap_or(0.0);
    match usize::try_from(first).ok().and_then(|first| weights.get(first..first + len)) {
        Some(weights) => Cow::Borrowed(weights),
        None => (first..first + len as isize).map(at).collect(),
    }
}
