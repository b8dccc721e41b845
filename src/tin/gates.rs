//! Closes the openings between the ends of contours that do not reach the frame.
//!
//! On a ragged outline, along a cliff, at a gap, contours end beside each other and the strips between them open into one
//! another. An edge of the triangulation from one such end to the next closes the opening: as a *bridge*, a piece of
//! contour, where two ends of one level point at each other across a gap; else as a *gate*, which divides sub-domains as
//! the frame does and is no contour.

use std::collections::{HashMap, HashSet};

use super::{OpenEnd, Tin, VertexKind};

/// The largest turn between a line's end and a bridge that goes on from it: 60 degrees.
const COS_BRIDGE_TURN: f64 = 0.5;

/// A bridge is at most this share of the shorter line's length.
const BRIDGE_SHARE: f64 = 0.5;

/// Edges between ends of contours, as pairs of vertices.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Gaps {
    /// Pieces of contour across gaps.
    pub bridges: Vec<[u32; 2]>,
    /// Openings between strips.
    pub gates: Vec<[u32; 2]>,
}

/// Finds the edges that close openings between `ends`. Neighbouring ends are those of one level or of two that are no
/// further apart than `step`; at least one of them does not reach the frame.
pub fn close_gaps(tin: &Tin, ends: &[OpenEnd], step: f64) -> Gaps {
    let mut gaps = Gaps::default();
    if ends.iter().all(|e| e.at_frame) {
        return gaps;
    }
    let bits = |p: glam::DVec2| [p.x.to_bits(), p.y.to_bits()];
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
            if is_bridge(a, b) {
                gaps.bridges.push([u, v]);
            } else if a.contour != b.contour {
                gaps.gates.push([u, v]);
            }
        }
    }
    gaps.keep_single_bridges(tin);
    gaps
}

fn is_bridge(a: &OpenEnd, b: &OpenEnd) -> bool {
    let across = b.position - a.position;
    let length = across.length();
    let ahead = |end: &OpenEnd, way: glam::DVec2| end.outwards.dot(way) >= COS_BRIDGE_TURN * length;
    a.elevation == b.elevation
        && length <= BRIDGE_SHARE * a.length.min(b.length)
        && ahead(a, across)
        && ahead(b, -across)
}

impl Gaps {
    /// Leaves each end its shortest bridge; the longer ones become gates.
    fn keep_single_bridges(&mut self, tin: &Tin) {
        let length = |[u, v]: [u32; 2]| tin.positions[u as usize].distance(tin.positions[v as usize]);
        self.bridges.sort_by(|a, b| length(*a).total_cmp(&length(*b)).then(a.cmp(b)));
        let mut taken = HashSet::new();
        let (kept, rest) = std::mem::take(&mut self.bridges).into_iter().partition(|[u, v]| {
            let free = !taken.contains(u) && !taken.contains(v);
            if free {
                taken.extend([*u, *v]);
            }
            free
        });
        self.bridges = kept;
        self.gates.extend::<Vec<_>>(rest);
    }
}
