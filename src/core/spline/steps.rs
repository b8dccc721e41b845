//! Distances along steps between nodes.

use std::f32::consts::SQRT_2;

/// The distance of each node from the nearest one that `is_start`, in nodes, along steps to the eight neighbours; `most` where it is
/// larger. Beyond the grid, the distance is `beyond`.
pub fn distances(is_start: impl Fn(usize) -> bool, [cols, rows]: [usize; 2], (most, beyond): (f32, f32)) -> Vec<f32> {
    let mut distances: Vec<f32> = (0..cols * rows).map(|n| if is_start(n) { 0.0 } else { most }).collect();
    // Once from the north-west and once from the south-east.
    for _ in 0..2 {
        sweep(&mut distances, cols, beyond);
        distances.reverse();
    }
    distances
}

/// Shortens each distance to what its neighbours to the left and above allow.
fn sweep(distances: &mut [f32], cols: usize, beyond: f32) {
    let mut above = vec![beyond; cols + 2];
    for row in distances.chunks_mut(cols.max(1)) {
        let mut left = beyond;
        for (distance, above) in row.iter_mut().zip(above.windows(3)) {
            let straight = left.min(above[1]) + 1.0;
            let diagonal = above[0].min(above[2]) + SQRT_2;
            *distance = distance.min(straight).min(diagonal);
            left = *distance;
        }
        above[1..=row.len()].copy_from_slice(row);
    }
}
