//! Minimises an energy between bounds: conjugate gradients on the nodes that are free.

use rayon::prelude::*;

use super::energy::{Energy, LANES, dot};

/// Steps between two looks at which nodes are held at their bounds.
const RESTART: usize = 20;
/// Nodes that one task works on. Sums are added up in this order whatever the number of threads.
const CHUNK: usize = 1 << 14;

/// When to stop.
#[derive(Debug, Clone, Copy)]
pub struct Effort {
    /// At most so many steps.
    pub steps: usize,
    /// When no height changes by more than this between two looks at the bounds, metres.
    pub tolerance: f64,
}

/// Goes from `z` towards the heights of least energy with `lo <= z <= hi`.
///
/// Heights are double precision, the steps between two looks at the bounds single: their errors are made good at the next look,
/// where the gradient is found from the heights again. The preconditioner is the diagonal.
pub fn minimise(energy: &Energy, lo: &[f32], hi: &[f32], z: &mut [f64], effort: Effort) {
    let n = z.len();
    let (constant, inverse) = energy.constant_and_inverse_diagonal();
    clamp(z, lo, hi);
    let mut gradient = vec![0.0; n];
    let mut residual = vec![0f32; n];
    let mut direction = vec![0f32; n];
    let mut image = vec![0f32; n];
    let mut change = vec![0f32; n];
    // Zero where a node is held.
    let mut weight = vec![0f32; n];
    let mut done = 0;
    while done < effort.steps {
        energy.apply(z, &mut gradient);
        let start = |i: usize| {
            let r = constant[i] - gradient[i];
            // A node at its bound that wants to go beyond it stays.
            let held = (z[i] <= f64::from(lo[i]) && r < 0.0) || (z[i] >= f64::from(hi[i]) && r > 0.0);
            if held { (0.0, 0.0) } else { (r as f32, inverse[i]) }
        };
        let all = residual.par_iter_mut().zip(&mut weight).zip(&mut direction).zip(&mut change).enumerate();
        all.for_each(|(i, (((r, w), p), change))| {
            (*r, *w) = start(i);
            *p = *r * *w;
            *change = 0.0;
        });
        let parts = residual.par_chunks(CHUNK).zip(direction.par_chunks(CHUNK)).map(|(r, p)| dot(r, p));
        let mut rho: f64 = parts.collect::<Vec<f64>>().into_iter().sum();
        let mut moved = 0.0;
        for _ in 0..RESTART.min(effort.steps - done) {
            if rho <= 0.0 || !rho.is_finite() {
                break;
            }
            let curvature = energy.apply(&direction, &mut image);
            if curvature <= 0.0 {
                break;
            }
            let (next, largest) =
                step(&mut change, &mut residual, &image, &direction, &weight, (rho / curvature) as f32);
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
        z.par_iter_mut().zip(&change).for_each(|(z, change)| *z += f64::from(*change));
        clamp(z, lo, hi);
        if moved < effort.tolerance {
            break;
        }
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
                *sum += f64::from(*r) * f64::from(*r * w);
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
