//! Finds lines and spot heights that fitted lines have passed over: they meet nothing, but lie on the other side than
//! before.
//!
//! A line that meets no other line lies on one side of it as a whole, so one of its points is enough for the test. The
//! test counts how often the other line winds round that point. An open line is closed by the straight way between its
//! ends, which do not move. The point itself moves when its line is fitted. If it crosses that straight way, the count
//! is corrected.

use glam::{DVec2, DVec3};
use robust::{Coord, orient2d};

use crate::base::error::Result;
use crate::base::parallel;
use crate::clean::Segments;
use crate::contour::Contour;

/// A point before and after fitting, and the line to which it belongs; `None` for a spot height.
#[derive(Clone, Copy)]
struct Moved {
    before: DVec2,
    after: DVec2,
    line: Option<usize>,
}

/// Numbers of the lines, ascending, that have passed over something, and of the lines that were passed over.
///
/// The lines meet neither before nor after. No point moved by more than half of `reach`.
pub(super) fn passed(before: &[Contour], after: &[Contour], spots: &[DVec3], reach: f64) -> Result<Vec<usize>> {
    let runs = Segments::new(after)?.runs();
    let of_lines = before.iter().zip(after).enumerate().map(|(line, (b, a))| Moved {
        before: b.points[0],
        after: a.points[0],
        line: Some(line),
    });
    let of_spots = spots.iter().map(|s| Moved { before: s.truncate(), after: s.truncate(), line: None });
    let points: Vec<Moved> = of_lines.chain(of_spots).collect();
    let changed: Vec<bool> = before.iter().zip(after).map(|(b, a)| b.points != a.points).collect();
    let mut pairs: Vec<(usize, usize)> = parallel::flat_map(points.len(), |k| {
        let p = &points[k];
        let near = runs.lines_near(p.after, 1.25 * reach);
        let mut lines: Vec<usize> = near.into_iter().map(|line| line as usize).collect();
        lines.sort_unstable();
        lines.dedup();
        let moves = p.line.is_some_and(|line| changed[line]);
        lines.retain(|&line| Some(line) != p.line && (moves || changed[line]));
        lines.into_iter().map(move |line| (line, k))
    });
    pairs.sort_unstable();
    let of_line: Vec<&[(usize, usize)]> = pairs.chunk_by(|a, b| a.0 == b.0).collect();
    let mut found: Vec<usize> = parallel::flat_map_each(&of_line, |pairs| {
        let line = pairs[0].0;
        let near: Vec<Moved> = pairs.iter().map(|&(_, k)| points[k]).collect();
        let passed = passed_by(&before[line].points, &after[line].points, &near);
        passed.into_iter().flat_map(move |p| [Some(line), p.line].into_iter().flatten()).collect::<Vec<_>>()
    });
    found.sort_unstable();
    found.dedup();
    Ok(found)
}

/// The points that a line has passed over.
fn passed_by(before: &[DVec2], after: &[DVec2], points: &[Moved]) -> Vec<Moved> {
    let old = windings(before, points.iter().map(|p| p.before));
    let new = windings(after, points.iter().map(|p| p.after));
    let (start, end) = (before[0], before[before.len() - 1]);
    let is_passed = |(p, (old, new)): (&Moved, (Option<i32>, Option<i32>))| {
        // A point on the line, where lines of one level touch, is on neither side.
        let (Some(old), Some(new)) = (old, new) else { return None };
        let across = if start == end { 0 } else { crossing(end, start, p.before, p.after) };
        (new != old + across).then_some(*p)
    };
    points.iter().zip(old.into_iter().zip(new)).filter_map(is_passed).collect()
}

fn side(a: DVec2, b: DVec2, p: DVec2) -> f64 {
    let coord = |p: DVec2| Coord { x: p.x, y: p.y };
    orient2d(coord(a), coord(b), coord(p))
}

/// 1 if the way from `p` to `q` crosses that from `a` to `b` from right to left, −1 for left to right, otherwise 0.
fn crossing(a: DVec2, b: DVec2, p: DVec2, q: DVec2) -> i32 {
    let (left_p, left_q) = (side(a, b, p) > 0.0, side(a, b, q) > 0.0);
    let meets = left_p != left_q && (side(p, q, a) > 0.0) != (side(p, q, b) > 0.0);
    if meets { i32::from(left_q) - i32::from(left_p) } else { 0 }
}

/// How often a line, closed by the straight way back, winds round each point; `None` for points on the line.
fn windings(line: &[DVec2], points: impl Iterator<Item = DVec2>) -> Vec<Option<i32>> {
    let points: Vec<DVec2> = points.collect();
    let mut by_y: Vec<usize> = (0..points.len()).collect();
    by_y.sort_unstable_by(|&i, &j| points[i].y.total_cmp(&points[j].y));
    let mut windings = vec![Some(0); points.len()];
    let back = [line[line.len() - 1], line[0]];
    for (k, w) in line.windows(2).chain(std::iter::once(&back[..])).enumerate() {
        let (a, b) = (w[0], w[1]);
        let is_own = k + 1 < line.len();
        let (low, high) = (a.y.min(b.y), a.y.max(b.y));
        let first = by_y.partition_point(|&i| points[i].y < low);
        for &i in by_y[first..].iter().take_while(|&&i| points[i].y <= high) {
            let p = points[i];
            let turn = side(a, b, p);
            if turn == 0.0 && is_own && a.x.min(b.x) <= p.x && p.x <= a.x.max(b.x) {
                windings[i] = None;
            } else if let Some(winding) = &mut windings[i] {
                *winding += i32::from(a.y <= p.y && p.y < b.y && turn > 0.0);
                *winding -= i32::from(b.y <= p.y && p.y < a.y && turn < 0.0);
            }
        }
    }
    windings
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn windings_of_rings_and_bays() {
        let at = |x: f64, y: f64| DVec2::new(x, y);
        let ring = [at(0.0, 0.0), at(4.0, 0.0), at(4.0, 4.0), at(0.0, 4.0), at(0.0, 0.0)];
        let points = [at(1.0, 1.0), at(5.0, 0.0), at(-1.0, 4.0), at(4.0, 2.0), at(2.0, 2.0)];
        assert_eq!(windings(&ring, points.into_iter()), [Some(1), Some(0), Some(0), None, Some(1)]);
        let turned: Vec<DVec2> = ring.iter().rev().copied().collect();
        assert_eq!(windings(&turned, points.into_iter()), [Some(-1), Some(0), Some(0), None, Some(-1)]);
        // The straight way back is no part of an open line.
        assert_eq!(windings(&ring[..4], [at(0.0, 2.0), at(0.1, 2.0)].into_iter())[1], Some(1));
    }

    #[test]
    fn a_point_that_crosses_the_way_back_is_not_passed() {
        let at = |x: f64, y: f64| DVec2::new(x, y);
        let line = [at(0.0, 0.0), at(5.0, 5.0), at(10.0, 0.0)];
        let moved = |before: DVec2, after: DVec2| Moved { before, after, line: None };
        let points =
            [moved(at(5.0, 1.0), at(5.0, -1.0)), moved(at(5.0, -1.0), at(5.0, 1.0)), moved(at(5.0, 1.0), at(5.0, 6.0))];
        let passed = passed_by(&line, &line, &points);
        assert!(passed.len() == 1 && passed[0].after == at(5.0, 6.0));
    }
}
