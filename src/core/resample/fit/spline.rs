//! Fits one line: a cubic B-spline with the smallest number of control points, and vertices along the curve.

use glam::DVec2;

use super::curve::Curve;
use super::least_squares::{self, Data};
use super::vertices::{self, near};

/// Share of the tolerance for the curve. The rest is for the polyline of its vertices.
const CURVE_SHARE: f64 = 0.8;

/// A fitted line.
pub(super) struct Line {
    pub(super) points: Vec<DVec2>,
    /// The curve's parameter at each point.
    pub(super) parameters: Vec<f64>,
    pub(super) curve: Curve,
    /// The origin of the curve's coordinates.
    pub(super) origin: DVec2,
}

/// Fits a line. `None` if no curve with fewer control points than points keeps the tolerance. Points added on long
/// segments count as points too.
///
/// The number of control points is doubled until the curve is near enough. Bisecting then finds a number that is enough
/// while one less is not.
pub(super) fn fit(points: &[DVec2], closed: bool, tolerance: f64, placing: vertices::Placing) -> Option<Line> {
    let origin = points[0];
    let line: Vec<DVec2> = points.iter().map(|&p| p - origin).collect();
    let data = data_of(&line, tolerance);
    let least = if closed { 5 } else { 4 };
    let most = data.points.len() - 1;
    let attempt = |n: usize| least_squares::fit(&data, closed, n, CURVE_SHARE * tolerance);
    let (mut low, mut n) = (least - 1, least);
    let mut best = loop {
        if n > most {
            return None;
        }
        if let Some(curve) = attempt(n) {
            break curve;
        }
        low = n;
        n *= 2;
    };
    while n - low > 1 {
        let middle = low.midpoint(n);
        match attempt(middle) {
            Some(curve) => (best, n) = (curve, middle),
            None => low = middle,
        }
    }
    let is_near = |placed: &[DVec2]| near(&line, placed, tolerance) && near(placed, &line, tolerance);
    let (mut points_on, parameters) =
        vertices::place(&best, placing, (1.0 - CURVE_SHARE) * tolerance, 8 * data.points.len().max(8), is_near)?;
    points_on.iter_mut().for_each(|p| *p += origin);
    let last = points_on.len() - 1;
    if closed {
        points_on[last] = points_on[0];
    } else {
        (points_on[0], points_on[last]) = (points[0], points[points.len() - 1]);
    }
    Some(Line { points: points_on, parameters, curve: best, origin })
}

/// The vertices, and further points on long segments, so that the curve cannot swing out between vertices.
fn data_of(line: &[DVec2], tolerance: f64) -> Data {
    let total: f64 = line.windows(2).map(|w| w[0].distance(w[1])).sum();
    let step = (4.0 * tolerance).max(total / (8 * line.len()) as f64);
    let mut points = vec![line[0]];
    for w in line.windows(2) {
        let parts = (w[0].distance(w[1]) / step).ceil().max(1.0) as usize;
        points.extend((1..=parts).map(|k| w[0].lerp(w[1], k as f64 / parts as f64)));
    }
    let lengths = vertices::lengths_of(&points);
    Data { points, lengths }
}
