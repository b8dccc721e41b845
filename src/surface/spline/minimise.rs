//! Minimises an energy between bounds: conjugate gradients on the nodes that are free.

use rayon::prelude::*;

use super::energy::Energy;
use super::stencil::{CHUNK, LANES, Stencil, dot};

/// Steps between two looks at which nodes are held at their bounds.
const RESTART: usize = 20;

/// When to stop.
#[derive(Debug, Clone, Copy)]
pub struct Effort {
    /// At most so many steps.
    pub steps: usize,
    /// When no height changes by more than this between two looks at the bounds, metres.
    pub tolerance: f64,
}

/// Minimises energies on one lattice, one after the other: what it works with is large and kept.
pub struct Minimiser {
    stencil: Stencil,
    residual: Vec<f32>,
    /// The direction of a step, padded.
    direction: Vec<f32>,
    /// The matrix times that.
    image: Vec<f32>,
    change: Vec<f32>,
    /// Of the preconditioner; zero where a node is held.
    weight: Vec<f32>,
}

impl Minimiser {
    /// For energies on the lattice of this one.
    pub fn new(energy: &Energy) -> Self {
        let n = energy.size[0] * energy.size[1];
        let stencil = Stencil::new(energy);
        let direction = vec![0.0; n + 2 * stencil.pad()];
        let zeros = || vec![0.0; n];
        Self { stencil, residual: zeros(), direction, image: zeros(), change: zeros(), weight: zeros() }
    }

    /// Goes from `z` towards the heights of least energy with `lo <= z <= hi`. The energy is the one that was [set](Self::set)
    /// last.
    ///
    /// Heights and gradient are double precision, the steps between two looks at the bounds single: the gradient changes by
    /// what they changed the heights, so that their errors do not add up. The preconditioner is the diagonal.
    pub fn minimise(&mut self, energy: &Energy, lo: &[f32], hi: &[f32], z: &mut [f64], effort: Effort) {
        let Self { stencil, residual, direction, image, change, weight } = self;
        let (n, pad) = (z.len(), stencil.pad());
        clamp(z, lo, hi);
        let mut downhill = energy.downhill(z);
        let mut done = 0;
        while done < effort.steps {
            // A node at its bound that wants to go beyond it stays.
            let is_held =
                |i: usize, r: f64| (z[i] <= f64::from(lo[i]) && r < 0.0) || (z[i] >= f64::from(hi[i]) && r > 0.0);
            let of_node = residual.par_iter_mut().zip(&mut *weight).zip(&mut direction[pad..pad + n]);
            let of_node = of_node.zip(&mut *change).zip(&downhill).zip(stencil.diagonal()).enumerate();
            of_node.for_each(|(i, (((((residual, weight), p), change), &r), &diagonal))| {
                let is_free = diagonal > 0.0 && !is_held(i, r);
                (*residual, *weight) = if is_free { (r as f32, 1.0 / diagonal) } else { (0.0, 0.0) };
                *p = *residual * *weight;
                *change = 0.0;
            });
            let parts = residual.par_chunks(CHUNK).zip(direction[pad..pad + n].par_chunks(CHUNK));
            let mut rho: f64 = parts.map(|(r, p)| dot(r, p)).collect::<Vec<f64>>().into_iter().sum();
            let mut moved = 0.0;
            for _ in 0..RESTART.min(effort.steps - done) {
                if rho <= 0.0 || !rho.is_finite() {
                    break;
                }
                let curvature = stencil.apply(direction, image);
                if curvature <= 0.0 {
                    break;
                }
                let direction = &mut direction[pad..pad + n];
                let (next, largest) = step(change, residual, image, direction, weight, (rho / curvature) as f32);
                moved += f64::from(largest);
                let beta = (next / rho) as f32;
                rho = next;
                let all = direction.par_chunks_mut(CHUNK).zip(residual.par_chunks(CHUNK)).zip(weight.par_chunks(CHUNK));
                all.for_each(|((p, r), w)| {
                    for ((p, r), w) in p.iter_mut().zip(r).zip(w) {
                        *p = r * w + beta * *p;
                    }
                });
                done += 1;
            }
            let moves = z.par_iter_mut().zip(&*change).zip(&mut direction[pad..pad + n]).zip(lo.par_iter().zip(hi));
            moves.for_each(|(((z, change), moved), (&lo, &hi))| {
                let to = (*z + f64::from(*change)).clamp(f64::from(lo), f64::from(hi));
                *moved = (to - *z) as f32;
                *z = to;
            });
            if moved < effort.tolerance {
                break;
            }
            stencil.apply(direction, image);
            downhill.par_iter_mut().zip(&*image).for_each(|(downhill, by)| *downhill -= f64::from(*by));
        }
    }

    /// Takes another energy on the same lattice.
    pub fn set(&mut self, energy: &Energy) {
        self.stencil.set(energy);
    }
}

/// One step of length `alpha`. Gives the product of the residual with the preconditioned one, and the largest change of a
/// height. Where `w` is 0, nodes are held: their residual stays 0.
fn step(change: &mut [f32], r: &mut [f32], image: &[f32], p: &[f32], w: &[f32], alpha: f32) -> (f64, f32) {
    let changed = change.par_chunks_mut(CHUNK).zip(r.par_chunks_mut(CHUNK));
    let read = image.par_chunks(CHUNK).zip(p.par_chunks(CHUNK)).zip(w.par_chunks(CHUNK));
    let parts = changed.zip(read).map(|((change, r), ((q, p), w))| {
        let (mut sum, mut largest) = ([0.0; LANES], [0f32; LANES]);
        let changed = change.chunks_mut(LANES).zip(r.chunks_mut(LANES));
        let read = q.chunks(LANES).zip(p.chunks(LANES)).zip(w.chunks(LANES));
        for ((change, r), ((q, p), w)) in changed.zip(read) {
            let changed = change.iter_mut().zip(r).zip(q.iter().zip(p).zip(w));
            for (((change, r), ((q, p), w)), (sum, largest)) in changed.zip(sum.iter_mut().zip(&mut largest)) {
                let by = alpha * p;
                *change += by;
                *r = if *w > 0.0 { *r - alpha * q } else { *r };
                *largest = if by.abs() > *largest { by.abs() } else { *largest };
                *sum += f64::from(*r * (*r * w));
            }
        }
        (sum.iter().sum::<f64>(), largest.into_iter().fold(0f32, f32::max))
    });
    let parts: Vec<(f64, f32)> = parts.collect();
    parts.into_iter().fold((0.0, 0.0), |(sum, largest), (s, l)| (sum + s, largest.max(l)))
}

fn clamp(z: &mut [f64], lo: &[f32], hi: &[f32]) {
    let limits = lo.par_iter().zip(hi);
    z.par_iter_mut().zip(limits).for_each(|(z, (&lo, &hi))| *z = z.clamp(f64::from(lo), f64::from(hi)));
}
