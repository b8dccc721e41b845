//! Which segments go, and the lines without them.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use super::canonical::is_closed;
use super::meet;
use super::removed::{Removed, Why};
use super::segments::Segments;
use crate::contour::Contour;

/// Chooses segments so that every conflict loses one of its two: again and again the one in most conflicts, of several
/// such the shortest, then the first.
///
/// Two lines that share a vertex make four conflicts between four segments, and so one of the lines loses both segments
/// at the vertex.
///
/// Gives each chosen segment with one that it was in conflict with when it was chosen, sorted.
pub(super) fn choose(segments: &Segments, conflicts: &[(u32, u32)]) -> Vec<(u32, u32)> {
    let mut both: Vec<(u32, u32)> = conflicts.iter().flat_map(|&(s, t)| [(s, t), (t, s)]).collect();
    both.sort_unstable();
    // One node a segment; its neighbours, as node numbers, are neighbours[first[node]..first[node + 1]].
    let mut nodes: Vec<u32> = both.iter().map(|p| p.0).collect();
    nodes.dedup();
    let node = |segment: u32| nodes.partition_point(|&s| s < segment);
    let mut first: Vec<usize> = nodes.iter().map(|&s| both.partition_point(|p| p.0 < s)).collect();
    first.push(both.len());
    let neighbours: Vec<usize> = both.iter().map(|p| node(p.1)).collect();
    drop(both);

    // Bits of positive numbers are in the numbers' order.
    let lengths: Vec<u64> = nodes
        .iter()
        .map(|&s| {
            let segment = segments.get(s);
            segment.a.distance(segment.b).to_bits()
        })
        .collect();
    let mut degree: Vec<usize> = first.windows(2).map(|w| w[1] - w[0]).collect();
    let entry = |n: usize, degree: usize| (degree, Reverse(lengths[n]), Reverse(n));
    let mut queue: BinaryHeap<_> = degree.iter().enumerate().map(|(n, &d)| entry(n, d)).collect();
    let mut gone = vec![false; nodes.len()];
    let mut chosen = Vec::new();
    while let Some((d, _, Reverse(n))) = queue.pop() {
        // A node that lost conflicts since has an entry further down.
        if gone[n] || d != degree[n] || d == 0 {
            continue;
        }
        gone[n] = true;
        let mut partner = None;
        for &m in neighbours[first[n]..first[n + 1]].iter().filter(|&&m| !gone[m]) {
            partner.get_or_insert(m);
            degree[m] -= 1;
            queue.push(entry(m, degree[m]));
        }
        chosen.extend(partner.map(|m| (nodes[n], nodes[m])));
    }
    chosen.sort_unstable();
    chosen
}

/// What to say about a segment that goes because of another.
pub(super) fn finding(segments: &Segments, segment: u32, because_of: u32) -> Removed {
    let (line, other) = (segments.line_of(segment), segments.line_of(because_of));
    let (s, t) = (segments.get(segment), segments.get(because_of));
    Removed {
        elevation: line.elevation,
        feature: line.feature,
        ends: [s.a, s.b],
        why: Why::Meets { elevation: other.elevation, feature: other.feature, place: meet::place(&s, &t) },
    }
}

/// The lines without the chosen segments. `starts` has the number of each line's first segment.
pub(super) fn apply(lines: Vec<Contour>, starts: &[u32], chosen: &[(u32, u32)]) -> Vec<Contour> {
    let mut left = Vec::with_capacity(lines.len());
    let mut chosen = chosen.iter().map(|c| c.0).peekable();
    for (line, bounds) in lines.into_iter().zip(starts.windows(2)) {
        let mut cuts = Vec::new();
        while let Some(s) = chosen.next_if(|&s| s < bounds[1]) {
            cuts.push((s - bounds[0]) as usize);
        }
        if cuts.is_empty() {
            left.push(line);
        } else {
            left.extend(pieces(&line, &cuts));
        }
    }
    left
}

/// The pieces of a line between the segments that are cut out, which are given in ascending order, one at least.
fn pieces(line: &Contour, cuts: &[usize]) -> Vec<Contour> {
    let mut points = line.points.clone();
    let mut cuts = cuts.to_vec();
    if is_closed(&points) {
        // Started at the first cut, the ring is an open line whose last segment is the one cut out.
        let n = points.len() - 1;
        let start = (cuts[0] + 1) % n;
        points.pop();
        points.rotate_left(start);
        points.push(points[0]);
        cuts.iter_mut().for_each(|c| *c = (*c + n - start) % n);
        cuts.sort_unstable();
    }
    let ends = cuts.iter().copied().chain([points.len() - 1]);
    let starts = [0].into_iter().chain(cuts.iter().map(|c| c + 1));
    starts
        .zip(ends)
        .filter(|(start, end)| end > start)
        .map(|(start, end)| Contour {
            elevation: line.elevation,
            points: points[start..=end].to_vec(),
            feature: line.feature,
        })
        .collect()
}
