//! Bounds for a surface that does not follow the jitter of noisy contours. Beside a contour, it may leave its band for a
//! while, until it is moved to meet the contours ([`residual`](super::residual)).

use std::borrow::Cow;

use super::at_contour::is_at_contour;
use super::blur::{PASSES, blurred};
use crate::base::parallel;

/// Lowers the lower bound and raises the upper one by `slack` at contours, and by less up to twice `reach` nodes away.
/// Far from contours, no jitter moves the surface. There the band holds. `bounds` are NaN outside the frame.
pub fn loosened([lo, hi]: [&[f32]; 2], slack: f32, reach: usize, cols: usize) -> [Vec<f32>; 2] {
    let at_contour = |n: usize| if is_at_contour(lo, n, cols) { 1.0 } else { 0.0 };
    let mut near: Vec<f32> = parallel::values(lo.len(), at_contour);
    for _ in 0..PASSES {
        near = blurred(&near, cols, reach);
    }
    // The mean over the rectangle is one over its width at a straight contour.
    let width = (2 * reach + 1) as f32;
    let moved = |bound: &[f32], by: f32| parallel::values(bound.len(), |n| bound[n] + by * (near[n] * width).min(1.0));
    [moved(lo, -slack), moved(hi, slack)]
}

/// The bounds of a surface: loosened if there is any slack.
pub fn with_slack<'a>(bounds: [&'a [f32]; 2], slack: f32, reach: usize, cols: usize) -> [Cow<'a, [f32]>; 2] {
    if slack == 0.0 { bounds.map(Cow::Borrowed) } else { loosened(bounds, slack, reach, cols).map(Cow::Owned) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_ground_beside_contours_may_leave_its_band() {
        let (cols, rows, reach) = (60, 30, 3);
        let lo: Vec<f32> = (0..cols * rows).map(|n| if n % cols < 20 { 100.0 } else { 110.0 }).collect();
        let hi: Vec<f32> = lo.iter().map(|lo| lo + 10.0).collect();
        let [low, high] = loosened([&lo, &hi], 5.0, reach, cols);
        let row = 15 * cols;
        assert_eq!([low[row + 19], low[row + 20], high[row + 19]], [95.0, 105.0, 115.0]);
        assert!(low[row + 24] > 105.0 && low[row + 24] < 110.0);
        assert_eq!([low[row + 50], high[row + 50], low[row + 5], high[row + 5]], [110.0, 120.0, 100.0, 110.0]);
        let kept = with_slack([&lo, &hi], 0.0, reach, cols);
        assert!(kept.iter().all(|bound| matches!(bound, Cow::Borrowed(_))));
    }
}
