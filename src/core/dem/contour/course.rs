//! Gives a traced line a smooth course, with few vertices.
//!
//! A traced line has a bend on every side of a square, because heights are linear there. The ground has no such bends.
//! So the crossings first move along their sides, within their windows, onto a smooth curve: a parabola that is fitted
//! to the neighbours of each crossing, with weights that fall with the distance along the line (local regression,
//! Cleveland 1979). Then straight pieces replace the parts of this curve that are nearly straight. They pass all
//! windows, so lines still do not meet (see [`simplified`]).

use glam::DVec2;

use super::trace::{Course, Crossing};
use crate::slice::simplified;

/// Neighbours count up to this distance along the line, cells.
const REACH: f64 = 4.0;
/// For a ring, at most this share of its length. A longer part of a ring is no parabola.
const REACH_OF_RING: f64 = 0.2;
/// How often the curve is fitted. Each time starts from crossings that are within their windows.
const PASSES: usize = 3;
/// Distances between the smooth curve and the straight pieces, as shares of the tolerance. A line takes the first with
/// which few of its vertices are left. So a gentle line has small bends, and a rough one has not too many vertices.
const STRAIGHT: [f64; 8] = [0.06, 0.1, 0.15, 0.2, 0.3, 0.45, 0.7, 1.0];
/// Few vertices: this share of the crossings, or so many for a ring around some cells.
const FEW: (f64, f64) = (0.26, 6.0);
/// A parabola that misses its side by more than this is not extended to it, cells.
const FARTHEST: f64 = 1.0;

/// Arrays that are used for one line after the other.
#[derive(Default)]
pub(super) struct Workspace {
    line: Vec<Crossing>,
    points: Vec<DVec2>,
    along: Vec<f64>,
    moved: Vec<f64>,
}

/// The vertices of a line, in cells. `tolerance` is the largest distance along sides in x and in y.
pub(super) fn vertices(course: &Course<'_>, tolerance: DVec2, space: &mut Workspace) -> Vec<DVec2> {
    let Workspace { line, points, along, moved } = space;
    line.clear();
    line.extend_from_slice(course.crossings);
    for _ in 0..PASSES {
        smooth(line, course.is_closed, points, along, moved);
    }
    let few = (FEW.0 * line.len() as f64).max(FEW.1) as usize;
    let pieces = |share: f64| {
        let vertex = |k: usize| {
            let crossing = &line[k];
            let narrow = share * if crossing.along_x { tolerance.x } else { tolerance.y };
            let low = crossing.point((crossing.at - narrow).max(crossing.window[0]));
            let high = crossing.point((crossing.at + narrow).min(crossing.window[1]));
            (crossing.point(crossing.at), if crossing.rises { [high, low] } else { [low, high] })
        };
        simplified(line.len(), vertex)
    };
    // A larger share leaves fewer vertices, so the first one that leaves few is found by halving.
    let (mut from, mut to) = (0, STRAIGHT.len() - 1);
    let mut vertices = None;
    while from < to {
        let middle = (from + to) / 2;
        let found = pieces(STRAIGHT[middle]);
        if found.len() <= few {
            (to, vertices) = (middle, Some(found));
        } else {
            from = middle + 1;
        }
    }
    let vertices = vertices.unwrap_or_else(|| pieces(STRAIGHT[to]));
    if vertices.len() < if course.is_closed { 4 } else { 2 } {
        return line.iter().map(|crossing| crossing.point(crossing.at)).collect();
    }
    vertices
}

/// Moves all crossings onto the parabolas through their neighbours. The ends of an open line stay.
fn smooth(line: &mut [Crossing], is_closed: bool, points: &mut Vec<DVec2>, along: &mut Vec<f64>, moved: &mut Vec<f64>) {
    points.clear();
    points.extend(line.iter().map(|crossing| crossing.point(crossing.at)));
    along.clear();
    let mut length = 0.0;
    along.push(0.0);
    along.extend(points.windows(2).map(|pair| {
        length += pair[0].distance(pair[1]);
        length
    }));
    let reach = if is_closed { REACH.min(REACH_OF_RING * length) } else { REACH };
    let neighbours = Neighbours { points, along, is_closed, reach };
    moved.clear();
    moved.extend(line.iter().enumerate().map(|(k, crossing)| {
        let is_end = !is_closed && (k == 0 || k + 1 == line.len());
        if is_end { crossing.at } else { neighbours.fit(k, crossing) }
    }));
    if is_closed && let Some(&first) = moved.first() {
        moved.pop();
        moved.push(first);
    }
    for (crossing, at) in line.iter_mut().zip(moved) {
        crossing.at = at.clamp(crossing.window[0], crossing.window[1]);
    }
}

/// The points of a line; the last one of a ring repeats the first.
struct Neighbours<'a> {
    points: &'a [DVec2],
    along: &'a [f64],
    is_closed: bool,
    reach: f64,
}

/// Sums of a weighted fit of a parabola.
#[derive(Default)]
struct Sums {
    powers: [f64; 5],
    points: [DVec2; 3],
}

impl Sums {
    fn add(&mut self, distance: f64, offset: DVec2, weight: f64) {
        let square = distance * distance;
        let (w1, w2) = (weight * distance, weight * square);
        self.powers[0] += weight;
        self.powers[1] += w1;
        self.powers[2] += w2;
        self.powers[3] += w2 * distance;
        self.powers[4] += w2 * square;
        self.points[0] += offset * weight;
        self.points[1] += offset * w1;
        self.points[2] += offset * w2;
    }

    /// Position and direction of the parabola at distance 0, if the points determine it.
    fn solved(&self) -> Option<(DVec2, DVec2)> {
        let [a, b, c, d, e] = self.powers;
        let [p, q, r] = self.points;
        let (m0, m1, m2) = (c * e - d * d, c * d - b * e, b * d - c * c);
        let determinant = a * m0 + b * m1 + c * m2;
        if determinant <= 1e-9 * a * c * e {
            return None;
        }
        let position = (p * m0 + q * m1 + r * m2) / determinant;
        let direction = (p * m1 + q * (a * e - c * c) + r * (b * c - a * d)) / determinant;
        Some((position, direction))
    }
}

impl Neighbours<'_> {
    /// Where the parabola of crossing `k` meets its side.
    fn fit(&self, k: usize, crossing: &Crossing) -> f64 {
        let count = self.points.len();
        let here = self.points[k];
        let length = self.along[count - 1];
        let mut sums = Sums::default();
        // Half of the way to both neighbours: crossings that lie close together do not count more than others.
        let span = |i: usize| {
            let before = if i > 0 { self.along[i] - self.along[i - 1] } else { 0.0 };
            let after = if i + 1 < count { self.along[i + 1] - self.along[i] } else { 0.0 };
            before + after
        };
        let ring_end = |i: usize| self.is_closed && (i == 0 || i + 1 == count);
        let span = |i: usize| if ring_end(i) { span(0) + span(count - 1) } else { span(i) };
        let mut add = |i: usize, distance: f64| {
            let near = 1.0 - (distance / self.reach).powi(2);
            if near <= 0.0 {
                return false;
            }
            sums.add(distance, self.points[i] - here, near * near * span(i));
            true
        };
        add(k, 0.0);
        let mut turned = 0.0;
        let mut i = k;
        loop {
            if i == 0 {
                // The first point of a ring is the last one.
                if !self.is_closed || turned > 0.0 {
                    break;
                }
                (i, turned) = (count - 1, length);
            }
            i -= 1;
            if (turned > 0.0 && i <= k) || !add(i, self.along[i] - turned - self.along[k]) {
                break;
            }
        }
        let (mut turned, mut i) = (0.0, k);
        loop {
            if i + 1 == count {
                if !self.is_closed || turned > 0.0 {
                    break;
                }
                (i, turned) = (0, length);
            }
            i += 1;
            if (turned > 0.0 && i >= k) || !add(i, self.along[i] + turned - self.along[k]) {
                break;
            }
        }
        let Some((position, direction)) = sums.solved() else { return crossing.at };
        let position = here + position;
        let (at, across, rate_at, rate_across) = if crossing.along_x {
            (position.x, position.y, direction.x, direction.y)
        } else {
            (position.y, position.x, direction.y, direction.x)
        };
        let missing = crossing.across - across;
        if missing == 0.0 {
            return at;
        }
        let further = (missing / rate_across).clamp(-FARTHEST, FARTHEST);
        if further.is_finite() { at + rate_at * further } else { at }
    }
}
