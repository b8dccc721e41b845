//! Closes the openings between the ends of contours that do not reach the frame.
//!
//! On a ragged outline, along a cliff and at a gap, contours end beside each other. There the strips between them would
//! run together. An edge of the triangulation from one such end to the next closes the opening. It is one of two kinds:
//!
//! - a *gap closure*, a piece of contour, where two ends of one level point at each other across a gap, or where both were
//!   cut at the border of a part that was left out;
//! - a *barrier edge* everywhere else: it separates sub-domains as the frame does, and is no contour.

use std::collections::{HashMap, HashSet};

use super::OpenEnd;
use crate::base::bits::bits;
use crate::tin::{Tin, VertexKind};

/// Largest turn between the end of a line and the gap closure that continues it, as a cosine: 60 degrees.
const COS_CLOSURE_TURN: f64 = 0.5;

/// Longest gap closure, as a share of the length of the shorter line.
const CLOSURE_SHARE: f64 = 0.5;

/// Edges that close openings between the ends of contours, as pairs of vertices.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct GapEdges {
    /// Gap closures: pieces of contour across gaps.
    pub closures: Vec<[u32; 2]>,
    /// Barrier edges: they close openings between strips.
    pub barriers: Vec<[u32; 2]>,
}

/// Finds the edges that close openings between `ends`. An edge joins two ends of one level, or of two levels at most
/// `step` apart. At least one of the two does not reach the frame.
pub fn close_gaps(tin: &Tin, ends: &[OpenEnd], step: f64) -> GapEdges {
    let mut gaps = GapEdges::default();
    if ends.iter().all(|e| e.at_frame) {
        return gaps;
    }
    let by_place: HashMap<[u64; 2], &OpenEnd> = ends.iter().rev().map(|e| (bits(e.position - tin.origin), e)).collect();
    let end_at: HashMap<u32, &OpenEnd> = (0..tin.positions.len() as u32)
        .filter(|&v| tin.kinds[v as usize] == VertexKind::Contour)
        .filter_map(|v| Some((v, *by_place.get(&bits(tin.positions[v as usize]))?)))
        .collect();
    for t in (0..tin.len() as u32).filter(|&t| tin.is_inside(t)) {
        for i in 0..3 {
            let [u, v] = tin.edge(t, i);
            let first_of_two = tin.inner_neighbour(t, i).is_some_and(|n| t < n);
            if !first_of_two || tin.is_constraint(t, i) {
                continue;
            }
            let (Some(a), Some(b)) = (end_at.get(&u), end_at.get(&v)) else { continue };
            if (a.at_frame && b.at_frame) || (a.elevation - b.elevation).abs() > 1.001 * step {
                continue;
            }
            if is_closure(a, b) {
                gaps.closures.push([u, v]);
            } else if a.contour != b.contour {
                gaps.barriers.push([u, v]);
            }
        }
    }
    gaps.keep_single_closures(tin);
    gaps
}

fn is_closure(a: &OpenEnd, b: &OpenEnd) -> bool {
    let across = b.position - a.position;
    let length = across.length();
    let ahead = |end: &OpenEnd, way: glam::DVec2| end.outwards.dot(way) >= COS_CLOSURE_TURN * length;
    let is_facing = length <= CLOSURE_SHARE * a.length.min(b.length) && ahead(a, across) && ahead(b, -across);
    // Where a part of the map was left out, contours certainly go on.
    a.elevation == b.elevation && (is_facing || a.is_cut && b.is_cut)
}

impl GapEdges {
    /// Leaves each end its shortest gap closure; the longer ones become barrier edges.
    fn keep_single_closures(&mut self, tin: &Tin) {
        let length = |[u, v]: [u32; 2]| tin.positions[u as usize].distance(tin.positions[v as usize]);
        self.closures.sort_by(|a, b| length(*a).total_cmp(&length(*b)).then(a.cmp(b)));
        let mut taken = HashSet::new();
        let (kept, rest) = std::mem::take(&mut self.closures).into_iter().partition(|[u, v]| {
            let free = !taken.contains(u) && !taken.contains(v);
            if free {
                taken.extend([*u, *v]);
            }
            free
        });
        self.closures = kept;
        self.barriers.extend::<Vec<_>>(rest);
    }
}

#[cfg(test)]
mod tests {
    use glam::DVec2;

    use super::*;
    use crate::contour::{Contour, ContourMap, Interval};
    use crate::subdomains::{Band, Frame, extend_open_ends, frame_ring, regions};
    use crate::tin::{TinInput, triangulate};

    fn gaps_of(lines: &[(f64, &[(f64, f64)])]) -> (Tin, GapEdges) {
        gaps_with(lines, &[])
    }

    /// The same where lines were cut at some of their ends.
    fn gaps_with(lines: &[(f64, &[(f64, f64)])], cut: &[(f64, f64)]) -> (Tin, GapEdges) {
        let contours = lines.iter().map(|&(elevation, points)| Contour {
            elevation,
            points: points.iter().map(|&p| p.into()).collect(),
            feature: 0.into(),
        });
        let cut_ends = cut.iter().map(|&p| p.into()).collect();
        let map = ContourMap { contours: contours.collect(), cut_ends, ..ContourMap::default() };
        let ring = frame_ring(&map, &Frame::Hull);
        let (ends, extensions) = extend_open_ends(&map, &ring, None, 1e-7);
        let mut input = TinInput::new([DVec2::ZERO, DVec2::splat(300.0)], 1e-7);
        for c in &map.contours {
            input.push_line(&c.points, c.elevation, VertexKind::Contour);
        }
        for extension in &extensions {
            input.push_line(&[extension.end, extension.frame], extension.elevation, VertexKind::Contour);
        }
        let tin = triangulate(input).unwrap();
        let gaps = close_gaps(&tin, &ends, 10.0);
        (tin.clone().with_gap_edges(&gaps.closures, &gaps.barriers), gaps)
    }

    #[test]
    fn ends_that_were_cut_are_closed_wherever_they_point() {
        // An arc around a top that was left out: both of its ends point to the north.
        let arc: &[(f64, f64)] = &[(100.0, 150.0), (100.0, 100.0), (150.0, 60.0), (200.0, 100.0), (200.0, 150.0)];
        let frame: &[(f64, f64)] = &[(0.0, 0.0), (300.0, 0.0), (300.0, 300.0), (0.0, 300.0), (0.0, 0.0)];
        let lines = [(10.0, frame), (20.0, arc)];
        assert!(gaps_of(&lines).1.closures.is_empty());
        let (tin, gaps) = gaps_with(&lines, &[(100.0, 150.0), (200.0, 150.0)]);
        assert_eq!(gaps.closures.len(), 1);
        let ends = gaps.closures[0].map(|v| tin.positions[v as usize] + tin.origin);
        assert!(ends.contains(&DVec2::new(100.0, 150.0)) && ends.contains(&DVec2::new(200.0, 150.0)), "{ends:?}");
    }

    #[test]
    fn a_ragged_outline_is_closed_by_barrier_edges() {
        // Lines whose right ends draw back from the hull in the middle.
        let (tin, gaps) = gaps_of(&[
            (0.0, &[(0.0, 0.0), (100.0, 0.0), (300.0, 0.0)]),
            (10.0, &[(0.0, 20.0), (60.0, 20.0), (120.0, 20.0)]),
            (20.0, &[(0.0, 40.0), (60.0, 40.0), (110.0, 40.0)]),
            (30.0, &[(0.0, 60.0), (60.0, 60.0), (120.0, 60.0)]),
            (40.0, &[(0.0, 80.0), (100.0, 80.0), (300.0, 80.0)]),
        ]);
        let levels = |pair: &[u32; 2]| pair.map(|v| tin.heights[v as usize]);
        assert!(gaps.closures.is_empty());
        assert!(gaps.barriers.iter().any(|g| levels(g) == [10.0, 20.0] || levels(g) == [20.0, 10.0]));
        assert!(gaps.barriers.iter().any(|g| levels(g) == [20.0, 30.0] || levels(g) == [30.0, 20.0]));
        let found = regions(&tin, &Interval { step: 10.0, base: 0.0, rounding: 0.0 });
        for band in [Band { lo: 10.0, hi: 20.0 }, Band { lo: 20.0, hi: 30.0 }] {
            assert!(found.regions.iter().any(|r| r.band == band), "{band:?}");
        }
    }

    #[test]
    fn a_gap_is_closed_where_the_ends_point_at_each_other() {
        let (tin, gaps) = gaps_of(&[
            (0.0, &[(0.0, 0.0), (50.0, 0.0), (100.0, 0.0)]),
            (10.0, &[(0.0, 20.0), (25.0, 20.0), (47.0, 20.0)]),
            (10.0, &[(53.0, 20.0), (75.0, 20.0), (100.0, 20.0)]),
            (20.0, &[(0.0, 40.0), (50.0, 40.0), (100.0, 40.0)]),
        ]);
        assert_eq!(gaps.closures.len(), 1);
        assert!(gaps.barriers.is_empty());
        let found = regions(&tin, &Interval { step: 10.0, base: 0.0, rounding: 0.0 });
        assert_eq!(found.regions.len(), 2, "the two strips are apart");
    }
}
