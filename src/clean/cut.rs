//! Which segments go, and the lines without them.

use std::collections::BinaryHeap;

use rayon::prelude::*;

use super::canonical::is_closed;
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
    both.par_sort_unstable();
    // One node a segment; its neighbours, as node numbers, are neighbours[first[node]..first[node + 1]].
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

    // The queue holds numbers only, whose upper half is a node's degree, and whose lower half says how late it comes.
    let (late, by_lateness) = lateness(segments, &nodes);
    let mut degree: Vec<u32> = first.windows(2).map(|w| (w[1] - w[0]) as u32).collect();
    let entry = |n: usize, degree: u32| u64::from(degree) << 32 | u64::from(u32::MAX - late[n]);
    let mut queue: BinaryHeap<u64> = degree.iter().enumerate().map(|(n, &d)| entry(n, d)).collect();
    let mut gone = vec![false; nodes.len()];
    let mut chosen = Vec::new();
    while let Some(top) = queue.pop() {
        let (d, n) = ((top >> 32) as u32, by_lateness[(u32::MAX - top as u32) as usize] as usize);
        if d != degree[n] {
            // It has lost conflicts since it was put in. Degrees only fall, so no entry stands too far down.
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

/// The nodes' places in the order by length and then by number, and the nodes in that order.
fn lateness(segments: &Segments, nodes: &[u32]) -> (Vec<u32>, Vec<u32>) {
    let mut order: Vec<(f64, u32)> = (0u32..)
        .zip(nodes)
        .map(|(n, &s)| {
            let segment = segments.get(s);
            (segment.a.distance(segment.b), n)
        })
        .collect();
    order.par_sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
    let mut late = vec![0; nodes.len()];
    for (i, &(_, n)) in (0u32..).zip(&order) {
        late[n as usize] = i;
    }
    (late, order.into_iter().map(|o| o.1).collect())
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
