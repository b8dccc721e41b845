//! Minimises an energy between bounds: conjugate gradients on the nodes that are free.

use rayon::prelude::*;

use super::energy::Energy;

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
/// Heights are double precision, the steps' directions single: their errors are made good at the next look at the bounds,
/// where the gradient is found from the heights again. The preconditioner is the diagonal.
pub fn minimise(energy: &Energy, lo: &[f32], hi: &[f32], z: &mut [f64], effort: Effort) {
    let n = z.len();
    let (constant, inverse) = energy.constant_and_inverse_diagonal();
    clamp(z, lo, hi);
    let mut gradient = vec![0.0; n];
    let mut residual = vec![0f32; n];
    let mut direction = vec![0f32; n];
    let mut image = vec![0f32; n];
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
        let all = residual.par_iter_mut().zip(&mut weight).zip(&mut direction).enumerate();
        all.for_each(|(i, ((r, w), p))| {
            (*r, *w) = start(i);
            *p = *r * *w;
        });
        let mut rho = dot(&residual, &direction);
        let mut moved = 0.0;
        for _ in 0..RESTART.min(effort.steps - done) {
            if rho <= 0.0 || !rho.is_finite() {
                break;
            }
            energy.apply(&direction, &mut image);
            let curvature = dot(&direction, &image);
            if curvature <= 0.0 {
                break;
            }
            let (next, largest) = step(z, &mut residual, &mut image, &direction, &weight, (rho / curvature) as f32);
            moved += f64::from(largest);
            let beta = (next / rho) as f32;
            rho = next;
            direction.par_iter_mut().zip(&image).for_each(|(p, s)| *p = s + beta * *p);
            done += 1;
        }
        clamp(z, lo, hi);
        if moved < effort.tolerance {
            break;
        }
    }
}

/// One step of length `alpha`. Leaves the preconditioned residual in `image`; gives its product with the residual and the
/// largest change of a height.
fn step(z: &mut [f64], r: &mut [f32], image: &mut [f32], p: &[f32], w: &[f32], alpha: f32) -> (f64, f32) {
    let changed = z.par_chunks_mut(CHUNK).zip(r.par_chunks_mut(CHUNK)).zip(image.par_chunks_mut(CHUNK));
    let parts: Vec<(f64, f32)> = changed
        .zip(p.par_chunks(CHUNK).zip(w.par_chunks(CHUNK)))
        .map(|(((z, r), q), (p, w))| {
            let (mut sum, mut largest) = (0.0, 0f32);
            for i in 0..z.len() {
                let change = alpha * p[i];
                z[i] += f64::from(change);
                largest = largest.max(change.abs());
                if w[i] > 0.0 {
                    r[i] -= alpha * q[i];
                }
                q[i] = r[i] * w[i];
                sum += f64::from(r[i]) * f64::from(q[i]);
            }
            (sum, largest)
        })
        .collect();
    parts.into_iter().fold((0.0, 0.0), |(sum, largest), (s, l)| (sum + s, largest.max(l)))
}

fn dot(a: &[f32], b: &[f32]) -> f64 {
    let part = |(a, b): (&[f32], &[f32])| a.iter().zip(b).map(|(x, y)| f64::from(*x) * f64::from(*y)).sum();
    let parts: Vec<f64> = a.par_chunks(CHUNK).zip(b.par_chunks(CHUNK)).map(part).collect();
    parts.into_iter().sum()
}

fn clamp(z: &mut [f64], lo: &[f32], hi: &[f32]) {
    let limits = lo.par_iter().zip(hi);
    z.par_iter_mut().zip(limits).for_each(|(z, (&lo, &hi))| *z = z.clamp(f64::from(lo), f64::from(hi)));
}
