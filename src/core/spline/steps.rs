//! Distances along steps between nodes.

use std::f32::consts::SQRT_2;

/// Steps to four of the eight neighbours of a node, and their lengths. The other four are opposite.
const STEPS: [(isize, isize, f32); 4] = [(1, 0, 1.0), (0, 1, 1.0), (1, 1, SQRT_2), (-1, 1, SQRT_2)];

/// The distance of each node from the nearest one that `is_start`, in nodes; `most` where it is larger. Beyond the grid, the distance is
/// `beyond`.
pub fn distances(is_start: impl Fn(usize) -> bool, [cols, rows]: [usize; 2], (most, beyond): (f32, f32)) -> Vec<f32> {
    let mut distances: Vec<f32> = (0..cols * rows).map(|n| if is_start(n) { 0.0 } else { most }).collect();
    let mut shorten = |n: usize, sign: isize| {
        let [i, j] = [(n % cols) as isize, (n / cols) as isize];
        for (east, south, length) in STEPS {
            let [i, j] = [i + sign * east, j + sign * south];
            let is_on_grid = (0..cols as isize).contains(&i) && (0..rows as isize).contains(&j);
            let from = if is_on_grid { distances[j as usize * cols + i as usize] } else { beyond };
            distances[n] = distances[n].min(from + length);
        }
    };
    (0..cols * rows).for_each(|n| shorten(n, -1));
    (0..cols * rows).rev().for_each(|n| shorten(n, 1));
    distances
}
