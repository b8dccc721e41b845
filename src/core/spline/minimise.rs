//! Minimises an energy between bounds: conjugate gradients on the nodes that are free, tile by tile.
//!
//! A step reads all coefficients. On a large lattice they come from memory, which is no faster for two processors than
//! for one. A tile fits into a processor's cache. It takes many steps at once, while the heights around it are held.
//!
//! A sweep is over when every tile has taken its steps. The tiles of the next sweep are shifted by a third of a tile in
//! both directions. So a node is at the edge of a tile in at most two of three sweeps.

use rayon::prelude::*;

use super::energy::Energy;
use super::tile::{Tile, Whole};
use crate::base::parallel;

/// Rows and columns of a tile: it fits into a processor's cache.
const TILE: usize = 96;
/// Shift of the tiles from one sweep to the next, nodes.
const SHIFT: usize = TILE / 3;
/// A lattice with at most this many nodes is one tile, because it fits into the cache as a whole.
const ONE_TILE: usize = 20_000;
/// Steps per tile and sweep: enough to be worth reading its coefficients.
const SWEEP: usize = 20;

/// When to stop.
#[derive(Debug, Clone, Copy)]
pub struct Effort {
    /// Largest number of steps.
    pub steps: usize,
    /// Stop when no height changes by more than this in a sweep, metres.
    pub tolerance: f64,
}

/// Minimises energies on one lattice, one after the other.
#[derive(Default)]
pub struct Minimiser {
    /// Number of sweeps so far.
    sweeps: usize,
}

impl Minimiser {
    /// Moves `z` towards the heights of least energy with `lo <= z <= hi`. NaN is no bound.
    ///
    /// Heights and gradient have double precision, the changes in a sweep single precision.
    pub fn minimise(&mut self, energy: &Energy<'_>, lo: &[f32], hi: &[f32], z: &mut [f64], effort: Effort) {
        parallel::update(z, |n, z| *z = bounded(*z, lo[n], hi[n]));
        let (mut downhill, mut change) = (vec![0.0; z.len()], vec![0.0f32; z.len()]);
        for done in (0..effort.steps).step_by(SWEEP) {
            energy.downhill(z, &mut downhill);
            let whole = Whole { energy, downhill: &downhill, z, lo, hi };
            sweep(&whole, self.sweeps, SWEEP.min(effort.steps - done), &mut change);
            self.sweeps += 1;
            let moves = z.par_iter_mut().zip(&change).zip(lo.par_iter().zip(hi));
            let moved = moves.map(|((z, change), (&lo, &hi))| {
                let before = *z;
                *z = bounded(before + f64::from(*change), lo, hi);
                (*z - before).abs()
            });
            if moved.reduce(|| 0.0, f64::max) < effort.tolerance {
                break;
            }
        }
    }
}

/// The height nearest to `z` between the bounds. NaN is no bound.
fn bounded(z: f64, lo: f32, hi: f32) -> f64 {
    z.max(f64::from(lo)).min(f64::from(hi))
}

/// Lets every tile of sweep `number` take `steps` steps. `change` receives the changes of the heights.
fn sweep(whole: &Whole<'_>, number: usize, steps: usize, change: &mut [f32]) {
    let [cols, rows] = whole.energy.size;
    let is_one = cols * rows <= ONE_TILE;
    let side = if is_one { cols.max(rows) } else { TILE };
    // The shift decides the size of the first row and column of tiles.
    let first = if is_one { side } else { TILE - number % 3 * SHIFT };
    let (north, rest) = change.split_at_mut(first.min(rows) * cols);
    let others = rest.par_chunks_mut(side * cols).enumerate().map(|(k, band)| (first + k * side, band));
    let bands = rayon::iter::once((0, north)).chain(others);
    bands.for_each_init(Tile::default, |tile, (row, band)| {
        let rows = row..row + band.len() / cols;
        let mut start = 0;
        for end in (first..cols).step_by(side).chain([cols]) {
            let moves = tile.descend(whole, rows.clone(), start..end, steps);
            for (row, out) in band.chunks_exact_mut(cols).enumerate() {
                let out = &mut out[start..end];
                if moves { tile.changes(row, out) } else { out.fill(0.0) }
            }
            start = end;
        }
    });
}

#[cfg(test)]
mod tests {
    use super::super::energy::tests::energy;
    use super::*;

    #[test]
    fn the_least_energy_between_bounds_is_found_over_many_tiles() {
        let (cols, rows) = (150, 2 * TILE + 31);
        let energy = energy(cols, rows);
        let n = cols * rows;
        assert!(n > ONE_TILE);
        let (lo, hi): (Vec<f32>, Vec<f32>) = (0..n)
            .map(|i| match i % 7 {
                0 => (0.5, 0.75),
                1 => (-0.01, 0.01),
                2 => (2.0, 2.0),
                _ => (f32::NEG_INFINITY, f32::INFINITY),
            })
            .unzip();
        let mut z: Vec<f64> = (0..n).map(|i| ((i * 37) % 23) as f64).collect();
        Minimiser::default().minimise(&energy, &lo, &hi, &mut z, Effort { steps: 1_000, tolerance: 1e-7 });
        let mut downhill = vec![0.0; n];
        energy.downhill(&z, &mut downhill);
        for (i, (&z, &downhill)) in z.iter().zip(&downhill).enumerate() {
            let (lo, hi) = (f64::from(lo[i]), f64::from(hi[i]));
            assert!((lo..=hi).contains(&z), "node {i}: {z}");
            // Only its bound stops the node.
            assert!(downhill < 1e-4 || z == hi, "node {i} at {z} would rise: {downhill}");
            assert!(downhill > -1e-4 || z == lo, "node {i} at {z} would sink: {downhill}");
        }
    }
}
