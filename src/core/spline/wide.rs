//! Wide places: ground where contours are much further apart than those around it. Valley floors, plains, lakes,
//! terraces and plateaus are such places.
//!
//! Where a steep slope ends at a floor, a surface of minimum curvature carries the slope on into the floor. But a jump
//! in the distance between contours shows that the slope ends there. So in a wide place
//!
//! * the tension is that of the contours around it ([`tension`](super::density::tension)). A slope then ends within a
//!   share of their spacing, and the floor lies a share of an interval below the last contour;
//! * the tension draws to level ground by a share, and not only to the slopes of the reference surface. The triangles
//!   of that surface are large there and would show as facets;
//! * ridge and canyon lines are no creases. They would show as stars.

use super::at_contour::is_at_contour;
use crate::base::parallel;
use crate::tuning::WideTuning;

/// Number of nodes at contours whose mean is taken as it is. Where there are fewer, nodes further away count too.
const ENOUGH: f32 = 4.0;

/// What the contours around show about each node.
pub struct WidePlaces {
    /// How far the node is a wide place: 0 not at all, 1 in full.
    pub share: Vec<f32>,
    /// Relative density of the contours around.
    pub around: Vec<f32>,
}

impl WidePlaces {
    /// Compares the relative contour density of each node with that of the contours around it. `floor` is the lowest
    /// height that each node may have, NaN outside the frame. It changes from node to node where a contour passes.
    pub fn new(contour_density: &[f32], floor: &[f32], cols: usize, tuning: &WideTuning) -> Self {
        let known = parallel::values(contour_density.len(), |n| {
            let density = contour_density[n];
            let is_known = density.is_finite() && is_at_contour(floor, n, cols);
            if is_known { Mean { sum: density, count: 1.0 } } else { Mean::default() }
        });
        let around = spread(known, cols);
        let [least, most] = tuning.jump_limits.map(|limit| limit as f32);
        let share = parallel::values(contour_density.len(), |n| {
            let share = (around[n] / contour_density[n] / least).ln() / (most / least).ln();
            if share.is_nan() { 0.0 } else { share.clamp(0.0, 1.0) }
        });
        Self { share, around }
    }
}

/// A sum of values and their number.
#[derive(Debug, Clone, Copy, Default)]
struct Mean {
    sum: f32,
    count: f32,
}

/// The mean of the known values around each node. The fewer there are nearby, the larger the surroundings: squares of
/// 2 x 2, 4 x 4, ... nodes, with a steady change from one square to the next.
fn spread(known: Vec<Mean>, cols: usize) -> Vec<f32> {
    let rows = known.len() / cols.max(1);
    if known.is_empty() {
        return Vec::new();
    }
    if known.len() == 1 {
        let Mean { sum, count } = known[0];
        return vec![if count > 0.0 { sum / count } else { 1.0 }];
    }
    let coarse_cols = cols.div_ceil(2);
    let coarse_rows = rows.div_ceil(2);
    let of_square = |i: usize, j: usize| {
        let (col, row) = (2 * i, 2 * j);
        let nodes = [(col, row), (col + 1, row), (col, row + 1), (col + 1, row + 1)];
        let inside = nodes.into_iter().filter(|&(i, j)| i < cols && j < rows).map(|(i, j)| known[j * cols + i]);
        inside.fold(Mean::default(), |a, b| Mean { sum: a.sum + b.sum, count: a.count + b.count })
    };
    let squares = parallel::cells(coarse_cols, coarse_rows, of_square);
    let coarse = spread(squares, coarse_cols);
    let further = |i: usize, j: usize| {
        // Centres of squares lie half a node beside the nodes.
        let place = |i: usize, count: usize| {
            let at = (i as f32 - 0.5) / 2.0;
            let next = (at.floor() + 1.0) as usize;
            (next.saturating_sub(1), next.min(count - 1), at - at.floor())
        };
        let ((west, east, u), (north, south, v)) = (place(i, coarse_cols), place(j, coarse_rows));
        let along = |row: usize| coarse[row * coarse_cols + west] * (1.0 - u) + coarse[row * coarse_cols + east] * u;
        along(north) * (1.0 - v) + along(south) * v
    };
    let at = |i: usize, j: usize| {
        let mean = known[j * cols + i];
        let missing = ENOUGH - mean.count;
        if missing > 0.0 { (mean.sum + missing * further(i, j)) / ENOUGH } else { mean.sum / mean.count }
    };
    parallel::cells(cols, rows, at)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Contours every third column in the west, none in the east: floors and relative densities of the nodes.
    fn toe(cols: usize, rows: usize) -> (Vec<f32>, Vec<f32>) {
        let floor = |i: usize| if i < cols / 2 { 500.0 - 10.0 * (i / 3) as f32 } else { 0.0 };
        let density = |i: usize| if i < cols / 2 { 4.0 } else { 0.1 };
        (0..cols * rows).map(|n| (floor(n % cols), density(n % cols))).unzip()
    }

    #[test]
    fn a_floor_beside_dense_contours_is_wide_and_the_slope_is_not() {
        let (cols, rows) = (61, 33);
        let (floor, density) = toe(cols, rows);
        let wide = WidePlaces::new(&density, &floor, cols, &WideTuning::default());
        let of_column = |i: usize| (0..rows).map(move |j| j * cols + i);
        assert!((0..27).flat_map(of_column).all(|n| wide.share[n] == 0.0 && wide.around[n] > 3.0));
        assert!((33..cols).flat_map(of_column).all(|n| wide.share[n] == 1.0 && wide.around[n] > 2.0));
        // The same density everywhere is no jump, however low it is.
        let even = vec![0.1; density.len()];
        let none = WidePlaces::new(&even, &floor, cols, &WideTuning::default());
        assert!(none.share.iter().all(|share| *share == 0.0));
        // Without contours, nothing is known about the ground around.
        let nothing = WidePlaces::new(&density, &vec![7.0; floor.len()], cols, &WideTuning::default());
        assert!(nothing.around.iter().all(|around| *around == 1.0));
    }
}
