//! Heights that are averaged the more the further contours are away.
//!
//! Far from contours the reference surface has a few large triangles. Nothing is known there at their size, and their edges
//! would show as ditches and spokes on floors and lakes.

use super::at_contour::is_at_contour;
use crate::base::parallel;

/// The heights of the nodes, averaged by the share of each node over squares that no contour passes: squares of 2 x 2,
/// 4 x 4, ... nodes, with a steady change from one size to the next. Even slopes stay.
///
/// `floor` is as for [`is_at_contour`]. Heights that are NaN stay so.
pub fn averaged(heights: &[f32], floor: &[f32], cols: usize, share: &[f32]) -> Vec<f32> {
    let is_crossed = parallel::values(floor.len(), |n| floor[n].is_nan() || is_at_contour(floor, n, cols));
    let far = average(heights, &is_crossed, cols);
    parallel::values(heights.len(), |n| heights[n] + share[n] * (far[n] - heights[n]))
}

fn average(heights: &[f32], is_crossed: &[bool], cols: usize) -> Vec<f32> {
    let rows = heights.len() / cols.max(1);
    let (coarse_cols, coarse_rows) = (cols / 2, rows / 2);
    if coarse_cols.min(coarse_rows) < 3 {
        return heights.to_vec();
    }
    let nodes = |i: usize, j: usize| [0, 1, cols, cols + 1].map(|step| 2 * j * cols + 2 * i + step);
    let crossed = parallel::cells(coarse_cols, coarse_rows, |i, j| nodes(i, j).iter().any(|&n| is_crossed[n]));
    let is_free = |i: usize, j: usize| {
        let inner = i > 0 && j > 0 && i + 1 < coarse_cols && j + 1 < coarse_rows;
        inner && (j - 1..=j + 1).all(|j| (i - 1..=i + 1).all(|i| !crossed[j * coarse_cols + i]))
    };
    let free = parallel::cells(coarse_cols, coarse_rows, |i, j| if is_free(i, j) { 1.0f32 } else { 0.0 });
    if free.iter().all(|free| *free == 0.0) {
        return heights.to_vec();
    }
    let means =
        parallel::cells(coarse_cols, coarse_rows, |i, j| nodes(i, j).iter().map(|&n| heights[n]).sum::<f32>() / 4.0);
    let means = average(&means, &crossed, coarse_cols);
    parallel::cells(cols, rows, |i, j| {
        let own = heights[j * cols + i];
        let share = between(&free, [coarse_cols, coarse_rows], i, j);
        if share > 0.0 { own + share * (between(&means, [coarse_cols, coarse_rows], i, j) - own) } else { own }
    })
}

/// The value at a node from those at the centres of squares of 2 x 2 nodes, which lie half a node beside the nodes.
fn between(values: &[f32], [cols, rows]: [usize; 2], i: usize, j: usize) -> f32 {
    // A node has three quarters of its own square and a quarter of the next one.
    let place = |i: usize, count: usize| {
        let own = (i / 2).min(count - 1);
        let next = if i.is_multiple_of(2) { own.saturating_sub(1) } else { (own + 1).min(count - 1) };
        [own, next]
    };
    let ([near, far], [above, below]) = (place(i, cols), place(j, rows));
    let along = |row: usize| 0.75 * values[row * cols + near] + 0.25 * values[row * cols + far];
    0.75 * along(above) + 0.25 * along(below)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn edges_far_from_contours_go_and_even_slopes_stay() {
        let (cols, rows) = (96, 80);
        // One contour runs down the column 8.
        let floor: Vec<f32> = (0..cols * rows).map(|n| if n % cols < 8 { 0.0 } else { 10.0 }).collect();
        let slope: Vec<f32> = (0..cols * rows).map(|n| (n % cols) as f32 - 0.5 * (n / cols) as f32).collect();
        let all = vec![1.0; cols * rows];
        let found = averaged(&slope, &floor, cols, &all);
        assert!(slope.iter().zip(&found).all(|(a, b)| (a - b).abs() < 1e-3));
        let bent: Vec<f32> = (0..cols * rows).map(|n| (n / cols).abs_diff(40) as f32).collect();
        let found = averaged(&bent, &floor, cols, &all);
        let at = |i: usize, j: usize| found[j * cols + i];
        let bend =
            |i: usize| (39..42).map(|j| (at(i, j + 1) - 2.0 * at(i, j) + at(i, j - 1)).abs()).fold(0.0, f32::max);
        assert!(bend(50) < 0.3, "{}", bend(50));
        assert_eq!(bend(8), 2.0);
        assert_eq!(averaged(&bent, &floor, cols, &vec![0.0; cols * rows]), bent);
    }

    #[test]
    fn nothing_comes_from_outside_the_frame() {
        let (cols, rows) = (64, 64);
        let is_outside = |n: usize| n % cols < 20;
        let values: Vec<f32> = (0..cols * rows).map(|n| if is_outside(n) { f32::NAN } else { 7.0 }).collect();
        let found = averaged(&values, &values, cols, &vec![1.0; cols * rows]);
        assert!(found.iter().enumerate().all(|(n, z)| if is_outside(n) { z.is_nan() } else { *z == 7.0 }));
    }
}
