//! The network of streams: reaches between nodes.
//!
//! Lines meet where they share a point, where they cross, and where a line ends at another one.

use std::collections::{HashMap, HashSet};

use glam::DVec2;
use rstar::RTree;
use rstar::primitives::{GeomWithData, Line};

use super::line::StreamLine;
use crate::base::bits::bits;
use crate::base::union_find::UnionFind;
use crate::geometry::{Meeting, Segment, meeting, place};

/// A piece of a line between two nodes.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Reach {
    /// Its course, from the first node to the second.
    pub points: Vec<DVec2>,
    /// Its nodes.
    pub nodes: [usize; 2],
    /// The line that it is a piece of.
    pub line: usize,
}

impl Reach {
    /// The same from its second node to its first.
    pub fn reversed(mut self) -> Self {
        self.points.reverse();
        self.nodes.reverse();
        self
    }

    /// Length, map units.
    pub fn length(&self) -> f64 {
        length(&self.points)
    }
}

/// Reaches and their nodes.
#[derive(Debug, Clone, Default)]
pub(super) struct Network {
    /// Number of nodes.
    pub nodes: usize,
    /// The reaches, in the order of the lines.
    pub reaches: Vec<Reach>,
    /// By line: length of loops and of copies of other reaches, which are no reaches, map units.
    pub left_out: Vec<f64>,
}

/// A place that divides a line: number of the segment, share of it, position.
type Break = (usize, f64, DVec2);

impl Network {
    /// The network of lines. Points nearer to each other than `snap` count as one, map units.
    pub fn new(lines: &[StreamLine], snap: f64) -> Self {
        let mut left_out = vec![0.0; lines.len()];
        let mut seen = HashSet::new();
        // Copies go first: otherwise each of their vertices would be a node.
        let different: Vec<&[DVec2]> = lines
            .iter()
            .zip(&mut left_out)
            .map(|(line, left_out)| {
                let is_new = seen.insert(course_key(&line.points));
                *left_out = if is_new { 0.0 } else { length(&line.points) };
                if is_new { &*line.points } else { &[] }
            })
            .collect();
        let mut reaches = Vec::new();
        for (line, breaks) in breaks(&different, snap).into_iter().enumerate() {
            let mut piece: Vec<DVec2> = Vec::new();
            let push = |piece: &mut Vec<DVec2>, p: DVec2| {
                if piece.last() != Some(&p) {
                    piece.push(p);
                }
            };
            let mut next = breaks.into_iter().peekable();
            for (k, &p) in different[line].iter().enumerate() {
                push(&mut piece, p);
                while let Some((_, _, at)) = next.next_if(|(segment, ..)| *segment == k) {
                    push(&mut piece, at);
                    reaches.push(Reach { points: std::mem::replace(&mut piece, vec![at]), nodes: [0; 2], line });
                }
            }
            reaches.push(Reach { points: piece, nodes: [0; 2], line });
        }
        reaches.retain(|reach| reach.points.len() > 1);
        let nodes = number_nodes(&mut reaches, snap);
        let mut seen = HashSet::new();
        // A loop has no direction. A reach that is shorter than the snap distance is a point.
        reaches.retain(|reach| {
            let is_used = reach.nodes[0] != reach.nodes[1] && seen.insert(course_key(&reach.points));
            if !is_used {
                left_out[reach.line] += reach.length();
            }
            is_used
        });
        Self { nodes, reaches, left_out }
    }
}

/// The same for lines with the same vertices, in one direction or the other.
fn course_key(points: &[DVec2]) -> Vec<[u64; 2]> {
    let mut key: Vec<[u64; 2]> = points.iter().map(|p| bits(*p)).collect();
    if key.first() > key.last() {
        key.reverse();
    }
    key
}

/// Length of a line, map units.
pub(super) fn length(points: &[DVec2]) -> f64 {
    points.windows(2).map(|w| w[0].distance(w[1])).sum()
}

/// The places that divide each line, in its direction.
fn breaks(lines: &[&[DVec2]], snap: f64) -> Vec<Vec<Break>> {
    let mut segments = Vec::new();
    for (l, points) in lines.iter().enumerate() {
        let pairs = points.windows(2).enumerate();
        segments.extend(pairs.map(|(k, w)| GeomWithData::new(Line::new(w[0].to_array(), w[1].to_array()), (l, k))));
    }
    let tree = RTree::bulk_load(segments);
    let mut found: Vec<Vec<Break>> = vec![Vec::new(); lines.len()];
    let mut divide = |(l, k): (usize, usize), at: DVec2| {
        let points = lines[l];
        let is_end = [points.first(), points.last()].into_iter().flatten().any(|end| end.distance(at) <= snap);
        if !is_end {
            let (a, b) = (points[k], points[k + 1]);
            let share = ((at - a).dot(b - a) / (b - a).length_squared()).clamp(0.0, 1.0);
            found[l].push((k, share, at));
        }
    };
    for (l, points) in lines.iter().enumerate() {
        for end in [points.first(), points.last()].into_iter().flatten() {
            for near in tree.locate_within_distance(end.to_array(), snap * snap) {
                if near.data.0 != l {
                    divide(near.data, *end);
                }
            }
        }
    }
    for (s, t) in tree.intersection_candidates_with_other_tree(&tree) {
        if s.data.0 >= t.data.0 {
            continue;
        }
        let [a, b] = [s, t].map(|s| Segment { a: s.geom().from.into(), b: s.geom().to.into() });
        if matches!(meeting(&a, &b), Meeting::Cross | Meeting::Touch) {
            let at = place(&a, &b);
            divide(s.data, at);
            divide(t.data, at);
        }
    }
    for breaks in &mut found {
        breaks.sort_by(|a, b| a.0.cmp(&b.0).then(a.1.total_cmp(&b.1)));
        breaks.dedup_by(|a, b| a.2.distance(b.2) <= snap);
    }
    found
}

/// Numbers the nodes at the ends of the reaches. Ends at one node get one position.
fn number_nodes(reaches: &mut [Reach], snap: f64) -> usize {
    let mut number: HashMap<[u64; 2], usize> = HashMap::new();
    let mut places: Vec<DVec2> = Vec::new();
    for reach in reaches.iter_mut() {
        for (k, at) in [0, reach.points.len() - 1].into_iter().enumerate() {
            let place = reach.points[at];
            reach.nodes[k] = *number.entry(bits(place)).or_insert_with(|| {
                places.push(place);
                places.len() - 1
            });
        }
    }
    let tree = RTree::bulk_load(places.iter().enumerate().map(|(k, p)| GeomWithData::new(p.to_array(), k)).collect());
    let mut groups = UnionFind::new(places.len());
    for (k, p) in places.iter().enumerate() {
        let mut near: Vec<usize> = tree.locate_within_distance(p.to_array(), snap * snap).map(|n| n.data).collect();
        near.sort_unstable();
        for other in near {
            let (a, b) = (groups.root(k), groups.root(other));
            if a != b {
                groups.hang(a.max(b), a.min(b));
            }
        }
    }
    let mut numbered: Vec<Option<usize>> = vec![None; places.len()];
    let mut count = 0;
    for reach in reaches {
        let last = reach.points.len() - 1;
        for (k, at) in [0, last].into_iter().enumerate() {
            let root = groups.root(reach.nodes[k]);
            reach.points[at] = places[root];
            reach.nodes[k] = *numbered[root].get_or_insert_with(|| {
                count += 1;
                count - 1
            });
        }
    }
    count
}

#[cfg(test)]
mod tests {
    use super::*;

    fn line(points: &[(f64, f64)]) -> StreamLine {
        StreamLine { points: points.iter().map(|&p| p.into()).collect(), feature: 0.into() }
    }

    #[test]
    fn lines_are_divided_where_others_end_touch_or_cross() {
        let lines = [
            line(&[(0.0, 0.0), (10.0, 0.0), (20.0, 0.0)]),
            // Ends a little beside the first line.
            line(&[(5.0, 8.0), (5.0, 0.004)]),
            // Shares a vertex with the first one, and crosses the second.
            line(&[(0.0, 4.0), (8.0, 4.0), (10.0, 0.0), (12.0, -3.0)]),
        ];
        let network = Network::new(&lines, 0.01);
        let count = |line: usize| network.reaches.iter().filter(|r| r.line == line).count();
        assert_eq!([count(0), count(1), count(2)], [3, 2, 3]);
        assert_eq!(network.nodes, 8);
        let degree = |n: usize| network.reaches.iter().flat_map(|r| r.nodes).filter(|&m| m == n).count();
        let mut degrees: Vec<usize> = (0..network.nodes).map(degree).collect();
        degrees.sort_unstable();
        assert_eq!(degrees, [1, 1, 1, 1, 1, 3, 4, 4]);
    }

    #[test]
    fn loops_points_and_copies_are_no_reaches() {
        let lines = [
            line(&[(0.0, 0.0), (10.0, 0.0)]),
            line(&[(10.0, 0.0), (0.0, 0.0)]),
            line(&[(3.0, 3.0), (4.0, 3.0), (4.0, 4.0), (3.0, 3.0)]),
            line(&[(7.0, 7.0), (7.0, 7.001)]),
        ];
        let network = Network::new(&lines, 0.01);
        assert_eq!(network.reaches.len(), 1);
        assert_eq!([network.left_out[0], network.left_out[1]], [0.0, 10.0]);
        assert!((network.left_out[2] - (2.0 + 2f64.sqrt())).abs() < 1e-9, "{:?}", network.left_out);
    }
}
