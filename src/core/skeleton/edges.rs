//! The edges that junction triangles add to the curve mesh (paper, section 4).

use glam::DVec3;

use super::build::Skeleton;
use crate::subdomains::Regions;
use crate::tin::{Tin, TriangleKind};

/// An edge of a junction triangle that was kept.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct JunctionEdge {
    /// Its two ends, vertices of contours (map units, metres).
    pub ends: [DVec3; 2],
    /// The sub-domain.
    pub region: u32,
}

/// The edges of all junction triangles that were neither eliminated nor lie in a dropped branch, each once.
pub fn junction_edges(tin: &Tin, regions: &Regions, skeleton: &Skeleton) -> Vec<JunctionEdge> {
    let reserved = |t: u32| {
        let t = t as usize;
        let elimination = &skeleton.elimination;
        skeleton.kinds[t] == TriangleKind::Junction && !elimination.eliminated[t] && !elimination.dropped[t]
    };
    let mut edges = Vec::new();
    for t in (0..tin.len() as u32).filter(|&t| reserved(t)) {
        for i in 0..3 {
            // Of two junctions that share an edge, the one with the lower number adds it.
            if tin.across(t, i).is_none_or(|n| t < n || !reserved(n)) {
                let ends = tin.edge(t, i).map(|v| tin.point(v));
                edges.push(JunctionEdge { ends, region: regions.of_triangle[t as usize] });
            }
        }
    }
    edges
}
