//! The standard form and order of lines. Because of it, results do not depend on how the input was written.

use std::cmp::Ordering;

use glam::DVec2;
use rayon::prelude::*;

use crate::base::error::{Finding, FindingKind};
use crate::base::parallel;
use crate::contour::Contour;
use crate::geometry::compare_points;

/// Order by elevation, then by the points in turn, then by feature. Lines that are equal in this order are the same in
/// all.
fn compare_lines(a: &Contour, b: &Contour) -> Ordering {
    a.elevation
        .total_cmp(&b.elevation)
        .then_with(|| compare_runs(a.points.iter(), b.points.iter()))
        .then(a.feature.cmp(&b.feature))
}

fn compare_runs<'a>(a: impl Iterator<Item = &'a DVec2>, b: impl Iterator<Item = &'a DVec2>) -> Ordering {
    a.map(Sortable).cmp(b.map(Sortable))
}

/// A point in the order of [`compare_points`].
struct Sortable<'a>(&'a DVec2);

impl Ord for Sortable<'_> {
    fn cmp(&self, other: &Self) -> Ordering {
        compare_points(self.0, other.0)
    }
}

impl PartialOrd for Sortable<'_> {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl PartialEq for Sortable<'_> {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

impl Eq for Sortable<'_> {}

/// Whether the points are those of a closed line.
pub(super) fn is_closed(points: &[DVec2]) -> bool {
    points.len() >= 4 && points.first() == points.last()
}

/// Whether a vertex occurs twice. The repeated end of a closed line does not count.
pub(super) fn has_repeated_vertex(points: &[DVec2]) -> bool {
    let mut sorted = points[usize::from(is_closed(points))..].to_vec();
    sorted.sort_unstable_by(compare_points);
    sorted.windows(2).any(|w| w[0] == w[1])
}

/// Gives a line its standard direction, and a closed line its standard start.
///
/// Of all the ways to write the line, it becomes the one whose sequence of points comes first in order.
pub(super) fn normalise(points: &mut [DVec2]) {
    if !is_closed(points) {
        if compare_runs(points.iter(), points.iter().rev()) == Ordering::Greater {
            points.reverse();
        }
        return;
    }
    let n = points.len() - 1;
    let ring = &mut points[..n];
    let start = least_rotation(ring);
    ring.rotate_left(start);
    // Usually the first vertex occurs once. Then its two neighbours determine the direction.
    if compare_points(&ring[1], &ring[n - 1]) != Ordering::Less || ring[1..].contains(&ring[0]) {
        let mut reversed: Vec<DVec2> = ring.iter().rev().copied().collect();
        let start = least_rotation(&reversed);
        reversed.rotate_left(start);
        if compare_runs(reversed.iter(), ring.iter()) == Ordering::Less {
            ring.copy_from_slice(&reversed);
        }
    }
    points[n] = points[0];
}

/// The start from which a ring's sequence of points comes first in order. It takes linear time even if points occur
/// many times: two starts advance along the ring, and the one that falls behind skips all points compared so far.
fn least_rotation(ring: &[DVec2]) -> usize {
    let n = ring.len();
    let (mut i, mut j, mut same) = (0, 1, 0);
    while i < n && j < n && same < n {
        match compare_points(&ring[(i + same) % n], &ring[(j + same) % n]) {
            Ordering::Equal => same += 1,
            Ordering::Less => (j, same) = (j + same + 1, 0),
            Ordering::Greater => (i, same) = (i + same + 1, 0),
        }
        if i == j {
            j += 1;
        }
    }
    i.min(j)
}

/// Sorts lines that are in standard form, or are pieces of such lines. Pieces are brought to standard form here.
pub(super) fn sort(lines: &mut [Contour]) {
    parallel::update(lines, |_, line| normalise(&mut line.points));
    lines.par_sort_unstable_by(compare_lines);
}

/// Sorts the lines. Of several equal lines, the one with the smallest feature number stays.
pub(super) fn sort_unique(mut lines: Vec<Contour>, findings: &mut Vec<Finding>) -> Vec<Contour> {
    sort(&mut lines);
    lines.dedup_by(|line, kept| {
        let same = line.elevation == kept.elevation && line.points == kept.points;
        if same {
            let message = format!(
                "the contour {} m (feature {}) is the same line as that of feature {}; only one was kept",
                line.elevation, line.feature, kept.feature
            );
            let finding = Finding::at(FindingKind::DuplicateLine, line.points[0], message);
            findings.push(finding.about(line.feature, line.elevation).about(kept.feature, kept.elevation));
        }
        same
    });
    lines
}
