//! Vertices along a fitted curve, and how far two lines are from each other.

use glam::DVec2;

use super::curve::Curve;

/// Points per span at which the curve is computed.
const FINE: usize = 8;
/// Vertices are at most this many of those points apart.
const WIDEST: usize = 512;
/// The search for the next vertex ends after this many points in a row that cannot be it.
const MISSES: usize = 64;
/// Number of times that the chords are halved before the line counts as impossible to fit.
const TRIALS: usize = 4;

/// Where vertices are put.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Placing {
    /// At even distances along the curve.
    Even,
    /// As the curve needs them: few where it is straight, many where it bends.
    Bends,
}

/// Vertices on the curve that are near enough, with their parameters; `None` if `most` are not enough. `sagitta` is the
/// largest distance of chords from the curve.
pub(super) fn place(
    curve: &Curve,
    placing: Placing,
    sagitta: f64,
    most: usize,
    is_near: impl Fn(&[DVec2]) -> bool,
) -> Option<(Vec<DVec2>, Vec<f64>)> {
    let dense =
        |fine: usize| -> Vec<DVec2> { (0..=fine * curve.spans()).map(|k| curve.at(k as f64 / fine as f64)).collect() };
    if placing == Placing::Bends {
        for finer in (0..TRIALS).map(|trial| 1 << trial) {
            let fine = FINE * finer;
            let dense = dense(fine);
            let chosen = by_bends(&dense, sagitta / finer as f64, WIDEST * finer);
            let points: Vec<DVec2> = chosen.iter().map(|&k| dense[k]).collect();
            if is_near(&points) {
                return Some((points, chosen.into_iter().map(|k| k as f64 / fine as f64).collect()));
            }
        }
        return None;
    }
    let lengths = lengths_of(&dense(FINE));
    let mut count = curve.control.len().max(6);
    while count <= most {
        let parameters = even(&lengths, count);
        let points: Vec<DVec2> = parameters.iter().map(|&u| curve.at(u)).collect();
        if is_near(&points) {
            return Some((points, parameters));
        }
        count += count / 2;
    }
    None
}

/// Parameters at even lengths.
fn even(lengths: &[f64], count: usize) -> Vec<f64> {
    let fine = lengths.len() - 1;
    let mut k = 1;
    let parameter = |i: usize| {
        let s = lengths[fine] * i as f64 / count as f64;
        while k < fine && lengths[k] < s {
            k += 1;
        }
        let width = lengths[k] - lengths[k - 1];
        let share = if width > 0.0 { ((s - lengths[k - 1]) / width).clamp(0.0, 1.0) } else { 1.0 };
        ((k - 1) as f64 + share) / FINE as f64
    };
    (0..=count).map(parameter).collect()
}

/// Numbers of points such that the chords between them pass all other points within `sagitta`. Seen from a chord's
/// start, the directions that do so form a wedge. Each chord goes as far as the wedge allows, and over at most `widest`
/// points.
fn by_bends(dense: &[DVec2], sagitta: f64, widest: usize) -> Vec<usize> {
    let last = dense.len() - 1;
    let widest = (last / 6).clamp(1, widest);
    let mut chosen = vec![0];
    let mut from = 0;
    while from < last {
        let mut wedge: Option<(DVec2, DVec2)> = None;
        let mut to = from + 1;
        for (k, &p) in dense.iter().enumerate().take(last.min(from + widest) + 1).skip(from + 1) {
            let away = p - dense[from];
            let is_in = |(left, right): (DVec2, DVec2)| {
                left.perp_dot(away) <= 0.0 && right.perp_dot(away) >= 0.0 && (left + right).dot(away) > 0.0
            };
            if wedge.is_none_or(is_in) {
                to = k;
            } else if k - to > MISSES {
                break;
            }
            let distance = away.length();
            if distance <= sagitta {
                if wedge.is_some() {
                    break;
                }
                continue;
            }
            let sine = sagitta / distance;
            let turn = DVec2::new((1.0 - sine * sine).max(0.0).sqrt(), sine);
            let (left, right) = (turn.rotate(away), DVec2::new(turn.x, -turn.y).rotate(away));
            let (left, right) = match wedge {
                None => (left, right),
                Some((l, r)) => {
                    (if l.perp_dot(left) < 0.0 { left } else { l }, if r.perp_dot(right) > 0.0 { right } else { r })
                }
            };
            if left.perp_dot(right) >= 0.0 {
                break;
            }
            wedge = Some((left, right));
        }
        chosen.push(to);
        from = to;
    }
    chosen
}

/// The length up to each vertex.
pub(super) fn lengths_of(line: &[DVec2]) -> Vec<f64> {
    let mut sum = 0.0;
    let steps = line.windows(2).map(|w| {
        sum += w[0].distance(w[1]);
        sum
    });
    std::iter::once(0.0).chain(steps).collect()
}

/// Whether each vertex of `a` is within `tolerance` of `b`, at about the same share of the length.
pub(super) fn near(a: &[DVec2], b: &[DVec2], tolerance: f64) -> bool {
    largest_distance(a, b, tolerance) <= tolerance
}

/// Largest distance from a vertex of `a` to `b`, looked for around the same share of the length. It is never too small.
pub(super) fn largest_distance(a: &[DVec2], b: &[DVec2], tolerance: f64) -> f64 {
    let (at, along) = (lengths_of(a), lengths_of(b));
    let scale = along[along.len() - 1] / at[at.len() - 1];
    let reach = 8.0 * tolerance + (along[along.len() - 1] - at[at.len() - 1]).abs();
    let (mut first, mut worst) = (0, 0.0f64);
    for (p, s) in a.iter().zip(at) {
        let s = s * scale;
        while first + 2 < b.len() && along[first + 1] < s - reach {
            first += 1;
        }
        let mut best = f64::INFINITY;
        for k in first..b.len() - 1 {
            if along[k] > s + reach || best <= 0.2 * tolerance {
                break;
            }
            best = best.min(distance(*p, b[k], b[k + 1]));
        }
        worst = worst.max(best);
    }
    worst
}

pub(super) fn distance(p: DVec2, a: DVec2, b: DVec2) -> f64 {
    let along = b - a;
    let share = ((p - a).dot(along) / along.length_squared()).clamp(0.0, 1.0);
    if share.is_nan() { p.distance(a) } else { p.distance(a + along * share) }
}
