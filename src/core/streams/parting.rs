//! Places where a stream parts, and its water runs to different outlets.

use std::collections::HashSet;

use glam::DVec2;

use super::line::StreamLine;
use super::network::Reach;
use crate::base::error::{Finding, FindingKind};
use crate::base::rows::Rows;

/// So many reaches downstream of a parting, its branches are looked for each other. Beyond, they count as different streams.
const FURTHEST: usize = 1000;

/// The findings about nodes from which reaches lead to different outlets. Branches that meet again flow around an island, as
/// rivers do. The reaches run downstream.
pub(super) fn partings(reaches: &[Reach], nodes: usize, lines: &[StreamLine], origin: DVec2) -> Vec<Finding> {
    let out_of = Rows::new(nodes, || reaches.iter().enumerate().map(|(r, reach)| (reach.nodes[0], r as u32)));
    let mut found = Vec::new();
    for node in (0..nodes).filter(|&node| out_of.of(node).len() > 1) {
        let branches: Vec<HashSet<usize>> =
            out_of.of(node).iter().map(|&r| below(reaches[r as usize].nodes[1], reaches, &out_of)).collect();
        let apart = |a: &HashSet<usize>, b: &HashSet<usize>| a.is_disjoint(b);
        let is_parting = branches.iter().enumerate().any(|(k, a)| branches[k + 1..].iter().any(|b| apart(a, b)));
        let Some(first) = out_of.of(node).first().map(|&r| &reaches[r as usize]).filter(|_| is_parting) else {
            continue;
        };
        let message = "the stream parts, and its branches do not meet again. One of them may be drawn wrong, or cross a \
                       watershed";
        let finding = Finding::at(FindingKind::StreamParts, first.points[0] + origin, message);
        found.push(finding.of_feature(lines[first.line].feature));
    }
    found
}

/// The nodes downstream of a node, with it.
fn below(node: usize, reaches: &[Reach], out_of: &Rows<u32>) -> HashSet<usize> {
    let (mut seen, mut open) = (HashSet::from([node]), vec![node]);
    let mut next = 0;
    while let Some(&node) = open.get(next).filter(|_| next < FURTHEST) {
        next += 1;
        for &r in out_of.of(node) {
            let down = reaches[r as usize].nodes[1];
            if seen.insert(down) {
                open.push(down);
            }
        }
    }
    seen
}
