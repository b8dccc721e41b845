//! A cubic B-spline with uniform knots.

use glam::DVec2;

/// A curve with uniform knots: periodic, or with all its parameters in `0..=spans` and clamped ends.
pub(super) struct Curve {
    pub(super) closed: bool,
    pub(super) control: Vec<DVec2>,
}

impl Curve {
    pub(super) fn spans(&self) -> usize {
        if self.closed { self.control.len() } else { self.control.len() - 3 }
    }

    pub(super) fn at(&self, u: f64) -> DVec2 {
        let (first, weights) = basis(u, self.spans(), self.closed);
        (0..4).map(|j| self.control[(first + j) % self.control.len()] * weights[j]).sum()
    }
}

/// The four functions that are not zero at `u`, and the number of the first.
pub(super) fn basis(u: f64, spans: usize, closed: bool) -> (usize, [f64; 4]) {
    let span = (u.max(0.0) as usize).min(spans - 1);
    if closed || (span >= 2 && span + 3 <= spans) {
        // Far from clamped ends all functions are shifted copies of one.
        let t = u - span as f64;
        let (s, t2, t3) = (1.0 - t, t * t, t * t * t);
        return (
            span,
            [s * s * s / 6.0, (3.0 * t3 - 6.0 * t2 + 4.0) / 6.0, (3.0 * (t + t2 - t3) + 1.0) / 6.0, t3 / 6.0],
        );
    }
    let knot = |i: isize| (span as isize + i).clamp(0, spans as isize) as f64;
    let mut weights = [1.0, 0.0, 0.0, 0.0];
    for degree in 1..=3usize {
        let mut saved = 0.0;
        for (r, weight) in weights.iter_mut().enumerate().take(degree) {
            let (right, left) = (knot(r as isize + 1), knot(r as isize + 1 - degree as isize));
            let share = *weight / (right - left);
            *weight = saved + (right - u) * share;
            saved = (u - left) * share;
        }
        weights[degree] = saved;
    }
    (span, weights)
}
