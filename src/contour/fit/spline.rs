//! One line as a cubic B-spline: least squares, the number of control points, samples along the curve.

use glam::DVec2;

/// Part of the tolerance that the curve may use; the rest is for its polyline.
const CURVE_SHARE: f64 = 0.8;
/// Steps of conjugate gradients. They start near the solution, so that what the points do not determine stays smooth.
const STEPS: usize = 40;

/// A line fitted.
pub(super) struct Line {
    pub(super) points: Vec<DVec2>,
    pub(super) control_points: usize,
}

/// A curve with uniform knots: periodic, or with all its parameters in `0..=spans` and clamped ends.
struct Curve {
    closed: bool,
    control: Vec<DVec2>,
}

impl Curve {
    fn spans(&self) -> usize {
        if self.closed { self.control.len() } else { self.control.len() - 3 }
    }

    fn at(&self, u: f64) -> DVec2 {
        let (first, weights) = basis(u, self.spans(), self.closed);
        (0..4).map(|j| self.control[(first + j) % self.control.len()] * weights[j]).sum()
    }
}

/// The four functions that are not zero at `u`, and the number of the first.
fn basis(u: f64, spans: usize, closed: bool) -> (usize, [f64; 4]) {
    let span = (u.max(0.0) as usize).min(spans - 1);
    let knot = |i: isize| {
        let k = span as isize + i;
        (if closed { k } else { k.clamp(0, spans as isize) }) as f64
    };
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

/// Fits a line; `None` where no curve with fewer control points than points keeps the tolerance.
/// Points put on long segments count too.
pub(super) fn fit(points: &[DVec2], closed: bool, tolerance: f64) -> Option<Line> {
    let origin = points[0];
    let line: Vec<DVec2> = points.iter().map(|&p| p - origin).collect();
    let (data, lengths) = data_of(&line, tolerance);
    let least = if closed { 5 } else { 4 };
    let most = data.len() - 1;
    let attempt = |n: usize| -> Option<Curve> {
        let (curve, deviation) = least_squares(&data, &lengths, closed, n);
        (deviation <= CURVE_SHARE * tolerance).then_some(curve)
    };
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
    while n - low > 1 + n / 32 {
        let middle = low.midpoint(n);
        match attempt(middle) {
            Some(curve) => (best, n) = (curve, middle),
            None => low = middle,
        }
    }
    let mut count = n.max(6);
    while count <= 8 * data.len().max(8) {
        let mut sampled = samples(&best, count);
        if near(&line, &sampled, tolerance) && near(&sampled, &line, tolerance) {
            sampled.iter_mut().for_each(|p| *p += origin);
            let last = sampled.len() - 1;
            if closed {
                sampled[last] = sampled[0];
            } else {
                (sampled[0], sampled[last]) = (points[0], points[points.len() - 1]);
            }
            return Some(Line { points: sampled, control_points: n });
        }
        count += count / 2;
    }
    None
}

/// The vertices, and points on long segments so that the curve cannot swing out between; and the length up to each.
fn data_of(line: &[DVec2], tolerance: f64) -> (Vec<DVec2>, Vec<f64>) {
    let total: f64 = line.windows(2).map(|w| w[0].distance(w[1])).sum();
    let step = (4.0 * tolerance).max(total / (8 * line.len()) as f64);
    let mut data = vec![line[0]];
    for w in line.windows(2) {
        let parts = (w[0].distance(w[1]) / step).ceil().max(1.0) as usize;
        data.extend((1..=parts).map(|k| w[0].lerp(w[1], k as f64 / parts as f64)));
    }
    let lengths = lengths_of(&data);
    (data, lengths)
}

fn lengths_of(line: &[DVec2]) -> Vec<f64> {
    let mut sum = 0.0;
    let steps = line.windows(2).map(|w| {
        sum += w[0].distance(w[1]);
        sum
    });
    std::iter::once(0.0).chain(steps).collect()
}

/// The point at a length along a line.
fn point_at(line: &[DVec2], lengths: &[f64], s: f64) -> DVec2 {
    let k = lengths.partition_point(|&l| l <= s).clamp(1, line.len() - 1);
    let width = lengths[k] - lengths[k - 1];
    if width > 0.0 { line[k - 1].lerp(line[k], ((s - lengths[k - 1]) / width).clamp(0.0, 1.0)) } else { line[k] }
}

/// The curve with `n` control points nearest to the data, and its largest distance at their parameters.
fn least_squares(data: &[DVec2], lengths: &[f64], closed: bool, n: usize) -> (Curve, f64) {
    let spans = if closed { n } else { n - 3 };
    let total = lengths[lengths.len() - 1];
    let scale = spans as f64 / total;
    // Each control point starts on the line, at the middle of its function.
    let start = |i: usize| {
        let middle = if closed {
            (i as f64 - 1.0).rem_euclid(n as f64)
        } else {
            let knot = |k: usize| (k as f64 - 3.0).clamp(0.0, spans as f64);
            (knot(i + 1) + knot(i + 2) + knot(i + 3)) / 3.0
        };
        point_at(data, lengths, middle / scale)
    };
    let mut curve = Curve { closed, control: (0..n).map(start).collect() };
    // Of a closed line the last point is the first again.
    let used = data.len() - usize::from(closed);
    let rows: Vec<(usize, [f64; 4])> = lengths[..used].iter().map(|&s| basis(s * scale, spans, closed)).collect();
    let is_free = |i: usize| closed || (i != 0 && i != n - 1);
    // Upper half of the normal matrix: entry j of row i is that of the functions i and i + j.
    let mut matrix = vec![[0.0; 4]; n];
    let mut residual = vec![DVec2::ZERO; n];
    for (&(first, w), &p) in rows.iter().zip(data) {
        let away = p - (0..4).map(|j| curve.control[(first + j) % n] * w[j]).sum::<DVec2>();
        for a in 0..4 {
            let row = (first + a) % n;
            residual[row] += away * w[a];
            for b in a..4 {
                matrix[row][b - a] += w[a] * w[b];
            }
        }
    }
    let free = |v: &mut [DVec2]| {
        for i in [0, n - 1] {
            if !is_free(i) {
                v[i] = DVec2::ZERO;
            }
        }
    };
    let preconditioned = |r: &[DVec2]| -> Vec<DVec2> {
        r.iter().zip(&matrix).map(|(r, m)| if m[0] > 0.0 { *r / m[0] } else { DVec2::ZERO }).collect()
    };
    let dot = |a: &[DVec2], b: &[DVec2]| a.iter().zip(b).map(|(a, b)| *a * *b).sum::<DVec2>();
    let divide = |a: DVec2, b: DVec2| {
        DVec2::new(if b.x > 0.0 { a.x / b.x } else { 0.0 }, if b.y > 0.0 { a.y / b.y } else { 0.0 })
    };
    free(&mut residual);
    let mut z = preconditioned(&residual);
    let mut direction = z.clone();
    let mut energy = dot(&residual, &z);
    let enough = energy.max_element() * 1e-10;
    for _ in 0..STEPS {
        if energy.max_element() <= enough {
            break;
        }
        let mut image = vec![DVec2::ZERO; n];
        for i in 0..n {
            image[i] += direction[i] * matrix[i][0];
            for (j, &entry) in matrix[i].iter().enumerate().skip(1) {
                let k = if i + j < n { i + j } else { i + j - n };
                image[i] += direction[k] * entry;
                image[k] += direction[i] * entry;
            }
        }
        free(&mut image);
        let step = divide(energy, dot(&direction, &image));
        for i in 0..n {
            curve.control[i] += direction[i] * step;
            residual[i] -= image[i] * step;
        }
        z = preconditioned(&residual);
        let next = dot(&residual, &z);
        let turn = divide(next, energy);
        direction.iter_mut().zip(&z).for_each(|(d, z)| *d = *z + *d * turn);
        energy = next;
    }
    let deviation = rows
        .iter()
        .zip(data)
        .map(|(&(first, w), &p)| p.distance((0..4).map(|j| curve.control[(first + j) % n] * w[j]).sum()))
        .fold(0.0, f64::max);
    (curve, deviation)
}

/// `count` pieces of even length along the curve.
fn samples(curve: &Curve, count: usize) -> Vec<DVec2> {
    let spans = curve.spans();
    let fine = 8 * spans;
    let parameter = |k: usize| k as f64 * spans as f64 / fine as f64;
    let dense: Vec<DVec2> = (0..=fine).map(|k| curve.at(parameter(k))).collect();
    let lengths = lengths_of(&dense);
    let total = lengths[fine];
    let mut k = 1;
    (0..=count)
        .map(|i| {
            let s = total * i as f64 / count as f64;
            while k < fine && lengths[k] < s {
                k += 1;
            }
            let width = lengths[k] - lengths[k - 1];
            let share = if width > 0.0 { ((s - lengths[k - 1]) / width).clamp(0.0, 1.0) } else { 1.0 };
            curve.at(parameter(k - 1) + share * (parameter(k) - parameter(k - 1)))
        })
        .collect()
}

/// Whether every vertex of `a` has `b` within `tolerance`, at about the same share of the length.
fn near(a: &[DVec2], b: &[DVec2], tolerance: f64) -> bool {
    largest_distance(a, b, tolerance) <= tolerance
}

/// Largest distance from a vertex of `a` to `b`, looked for around the same share of the length: never too small.
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
