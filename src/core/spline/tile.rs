//! A part of a lattice that fits into a processor's cache. Its heights change while those around it are held.
//!
//! Loops run on the widest vector instructions of the processor ([`Arch::dispatch`]). The functions that they call must
//! be inlined. Otherwise they would be compiled for the instructions that every processor has. Closures and folds of
//! iterators may not be inlined, so there is a [`Descent`], and loops count. The results do not depend on the
//! instructions: multiplications and additions are not fused.

use std::ops::Range;

use pulp::{Arch, Simd, WithSimd};

use super::energy::Energy;
use super::stencil::{LANES, REACH, Stencil};

/// A lattice and its heights.
pub struct Whole<'a> {
    /// The energy to minimise.
    pub energy: &'a Energy<'a>,
    /// Half of the negative gradient of the energy.
    pub downhill: &'a [f64],
    /// Heights.
    pub z: &'a [f64],
    /// Lower bounds.
    pub lo: &'a [f32],
    /// Upper bounds.
    pub hi: &'a [f32],
}

/// The working arrays of a tile. It has a margin as wide as the matrix reaches; the nodes of the margin are held.
///
/// Heights are scaled so that the diagonal of the matrix is 1 (diagonal preconditioner). Held nodes have the unit 0, so
/// their coefficients are 0 too.
#[derive(Default)]
pub struct Tile {
    cols: usize,
    stencil: Stencil,
    unit: Vec<f32>,
    change: Vec<f32>,
    residual: Vec<f32>,
    /// Search direction, padded.
    direction: Vec<f32>,
    /// The matrix times the search direction.
    image: Vec<f32>,
}

impl Tile {
    /// Takes at most `steps` steps of conjugate gradients on a part of a lattice. Returns whether any height may change:
    /// where the gradient is 0, as outside the frame, none does.
    pub fn descend(&mut self, whole: &Whole<'_>, rows: Range<usize>, cols: Range<usize>, steps: usize) -> bool {
        let row_of = |row: usize| &whole.downhill[row * whole.energy.size[0]..][cols.clone()];
        let moves = rows.clone().any(|row| row_of(row).iter().any(|downhill| *downhill != 0.0));
        if moves {
            Arch::new().dispatch(Descent { tile: self, whole, rows, cols, steps });
        }
        moves
    }

    /// Takes the steps on the part that was [cut](Self::cut).
    #[inline(always)]
    fn steps(&mut self, steps: usize) {
        let Self { stencil, change, residual, direction, image, .. } = self;
        let pad = stencil.pad();
        let mut rho = product(residual, residual);
        for _ in 0..steps {
            if rho <= 0.0 || !rho.is_finite() {
                break;
            }
            stencil.apply(direction, image);
            let direction = &mut direction[pad..pad + image.len()];
            let curvature = product(direction, image);
            if curvature <= 0.0 {
                break;
            }
            let next = step(change, residual, direction, image, rho / curvature);
            let beta = next / rho;
            rho = next;
            direction.iter_mut().zip(&*residual).for_each(|(p, r)| *p = r + beta * *p);
        }
    }

    /// Writes the changes of the heights in a row of the tile.
    pub fn changes(&self, row: usize, out: &mut [f32]) {
        let first = (row + REACH) * self.cols + REACH;
        let changes = self.change[first..].iter().zip(&self.unit[first..]);
        out.iter_mut().zip(changes).for_each(|(out, (change, unit))| *out = change * unit);
    }

    /// Takes a part of a lattice and finds the nodes that are held.
    #[inline(always)]
    fn cut(&mut self, whole: &Whole<'_>, rows: Range<usize>, cols: Range<usize>) {
        let size = [cols.len() + 2 * REACH, rows.len() + 2 * REACH];
        let n = (size[0] * size[1]).next_multiple_of(LANES);
        self.cols = size[0];
        self.stencil.take(whole.energy, [cols.start, rows.start], size);
        for values in [&mut self.unit, &mut self.change, &mut self.residual, &mut self.image] {
            values.clear();
            values.resize(n, 0.0);
        }
        for (k, row) in rows.clone().enumerate() {
            let from = row * whole.energy.size[0] + cols.start..row * whole.energy.size[0] + cols.end;
            let first = (k + REACH) * size[0] + REACH;
            let to = first..first + cols.len();
            let given = whole.downhill[from.clone()].iter().zip(&self.stencil.diagonal()[to.clone()]);
            let heights = whole.z[from.clone()].iter().zip(&whole.lo[from.clone()]).zip(&whole.hi[from]);
            let taken = self.residual[to.clone()].iter_mut().zip(&mut self.unit[to]);
            for (((residual, unit), (&r, &diagonal)), ((&z, &lo), &hi)) in taken.zip(given).zip(heights) {
                // A node at its bound that would go beyond it is held.
                let is_held = (z <= f64::from(lo) && r < 0.0) || (z >= f64::from(hi) && r > 0.0);
                if diagonal > 0.0 && !is_held {
                    *unit = 1.0 / diagonal.sqrt();
                    *residual = r as f32 * *unit;
                }
            }
        }
        self.stencil.scale(&self.unit);
        let pad = self.stencil.pad();
        self.direction.clear();
        self.direction.resize(pad, 0.0);
        self.direction.extend_from_slice(&self.residual);
        self.direction.resize(n + 2 * pad, 0.0);
    }
}

/// Arguments of [`Tile::descend`].
struct Descent<'a, 'b> {
    tile: &'a mut Tile,
    whole: &'a Whole<'b>,
    rows: Range<usize>,
    cols: Range<usize>,
    steps: usize,
}

impl WithSimd for Descent<'_, '_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        self.tile.cut(self.whole, self.rows, self.cols);
        self.tile.steps(self.steps);
    }
}

/// Takes one step of this length. Returns the square of the new residual.
#[inline(always)]
fn step(change: &mut [f32], residual: &mut [f32], direction: &[f32], image: &[f32], length: f32) -> f32 {
    let (change, residual) = (lanes_mut(change), lanes_mut(residual));
    let (direction, image) = (&lanes(direction)[..change.len()], &lanes(image)[..change.len()]);
    let residual = &mut residual[..change.len()];
    let mut squares = [0.0; LANES];
    for k in 0..change.len() {
        for i in 0..LANES {
            change[k][i] += length * direction[k][i];
            residual[k][i] -= length * image[k][i];
            squares[i] += residual[k][i] * residual[k][i];
        }
    }
    squares.iter().sum()
}

#[inline(always)]
fn product(a: &[f32], b: &[f32]) -> f32 {
    let a = lanes(a);
    let b = &lanes(b)[..a.len()];
    let mut sums = [0.0; LANES];
    for k in 0..a.len() {
        for i in 0..LANES {
            sums[i] += a[k][i] * b[k][i];
        }
    }
    sums.iter().sum()
}

#[inline(always)]
fn lanes(values: &[f32]) -> &[[f32; LANES]] {
    values.as_chunks().0
}

#[inline(always)]
fn lanes_mut(values: &mut [f32]) -> &mut [[f32; LANES]] {
    values.as_chunks_mut().0
}
