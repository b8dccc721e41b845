//! Chooses the segments to remove, and removes them from the lines.

use std::collections::BinaryHeap;

use rayon::prelude::*;

use super::canonical::is_closed;
use super::segments::Segments;
use crate::contour::Contour;

/// Chooses segments so that each conflict loses one of its two. The choice is greedy: the segment in most conflicts
/// goes first. Of several such segments the shortest goes, then the first.
///
/// Two lines that share a vertex have four conflicts between four segments. So one of the lines loses both of its
/// segments at the vertex.
///
/// Returns each chosen segment with one that it was in conflict with when it was chosen, sorted.
pub(super) fn choose(segments: &Segments, conflicts: &[(u32, u32)]) -> Vec<(u32, u32)> {
    let mut both: Vec<(u32, u32)> = conflicts.iter().flat_map(|&(s, t)| [(s, t), (t, s)]).collect();
    both.par_sort_unstable();
    // One node per segment. The neighbours of a node, as node numbers, are neighbours[first[node]..first[node + 1]].
    let mut nodes: Vec<u32> = Vec::new();
    let mut first: Vec<usize> = Vec::new();
    let mut node_of = vec![u32::MAX; segments.len()];
    for (i, &(s, _)) in both.iter().enumerate() {
        if nodes.last() != Some(&s) {
            node_of[s as usize] = nodes.len() as u32;
            nodes.push(s);
            first.push(i);
        }
    }
    first.push(both.len());
    let neighbours: Vec<u32> = both.iter().map(|p| node_of[p.1 as usize]).collect();
    drop((both, node_of));

    // Each entry of the queue is one number. Its upper half is a node's degree; its lower half is larger for a lower
    // rank.
    let (rank, by_rank) = ranks(segments, &nodes);
    let mut degree: Vec<u32> = first.windows(2).map(|w| (w[1] - w[0]) as u32).collect();
    let entry = |n: usize, degree: u32| u64::from(degree) << 32 | u64::from(u32::MAX - rank[n]);
    let mut queue: BinaryHeap<u64> = degree.iter().enumerate().map(|(n, &d)| entry(n, d)).collect();
    let mut gone = vec![false; nodes.len()];
    let mut chosen = Vec::new();
    while let Some(top) = queue.pop() {
        let (d, n) = ((top >> 32) as u32, by_rank[(u32::MAX - top as u32) as usize] as usize);
        if d != degree[n] {
            // The node has lost conflicts since this entry was made. Degrees only fall, so no entry stands too far
            // down.
            queue.push(entry(n, degree[n]));
            continue;
        }
        if d == 0 {
            break;
        }
        gone[n] = true;
        let mut partner = None;
        for &m in neighbours[first[n]..first[n + 1]].iter().filter(|&&m| !gone[m as usize]) {
            let m = m as usize;
            partner.get_or_insert(m);
            degree[m] -= 1;
        }
        chosen.extend(partner.map(|m| (nodes[n], nodes[m])));
    }
    chosen.sort_unstable();
    chosen
}

/// The rank of each node by length, then by number; and the nodes in this order.
fn ranks(segments: &Segments, nodes: &[u32]) -> (Vec<u32>, Vec<u32>) {
    let mut order: Vec<(f64, u32)> = (0u32..)
        .zip(nodes)
        .map(|(n, &s)| {
            let segment = segments.get(s);
            (segment.a.distance(segment.b), n)
        })
        .collect();
    order.par_sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
    let mut rank = vec![0; nodes.len()];
    for (i, &(_, n)) in (0u32..).zip(&order) {
        rank[n as usize] = i;
    }
    (rank, order.into_iter().map(|o| o.1).collect())
}

/// The lines without the chosen segments. `starts` holds the number of each line's first segment.
pub(super) fn apply(lines: Vec<Contour>, starts: &[u32], chosen: &[(u32, u32)]) -> Vec<Contour> {
    let mut kept = Vec::with_capacity(lines.len());
    let mut chosen = chosen.iter().map(|c| c.0).peekable();
    for (line, bounds) in lines.into_iter().zip(starts.windows(2)) {
        let mut cuts = Vec::new();
        while let Some(s) = chosen.next_if(|&s| s < bounds[1]) {
            cuts.push((s - bounds[0]) as usize);
        }
        if cuts.is_empty() {
            kept.push(line);
        } else {
            kept.extend(pieces(&line, &cuts));
        }
    }
    kept
}

/// The pieces of a line between the segments that are cut out. These are given in ascending order, at least one.
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
