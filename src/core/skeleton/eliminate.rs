//! Elimination of junction triangles (paper, section 4, figure 3).
//!
//! A junction triangle whose branch is short compared with the triangle itself shows only a small wrinkle of the
//! contour. Such a branch is dropped, and the junction becomes a sleeve.

use super::branches::{is_on_border, strip};
use crate::base::parallel;
use crate::subdomains::Regions;
use crate::tin::{Tin, TriangleKind};

/// The result of the elimination, by triangle.
#[derive(Debug, Clone)]
pub struct Elimination {
    /// Whether the junction triangle was turned into a sleeve.
    pub eliminated: Vec<bool>,
    /// Whether the triangle lies in a dropped branch.
    pub dropped: Vec<bool>,
    /// Number of junction triangles whose own lower limit was above the given resolution. They used that limit.
    pub limited: usize,
}

/// Decides which junction triangles to eliminate.
///
/// A free edge of a junction triangle with both ends on one level cuts off a branch. The comparison parameter is `r =
/// LPCO / (L1 + L2)`: the length of contour around the branch, divided by the lengths of the triangle's other two
/// edges. If `r < w` the branch is dropped. With all three corners on one level, the longest branch is the trunk, and
/// the other two are compared. The one with the smaller `r` is dropped: then a larger w never brings a branch back. A
/// branch that holds further contours is never dropped.
///
/// The paper bounds w from below by `max[L3/(L1+L2), L2/(L1+L3), L1/(L2+L3)]` of the triangle. That limit is at most 1
/// and differs between junctions. So each junction takes the larger of its limit and `resolution`.
///
/// The paper distinguishes three cases by the number of *contours* on which the corners lie. Here it is the number of
/// *levels*. The two differ where two contours of one level face each other, as two tops over a lower contour do. The
/// ground between them is the canyon of the paper's figure 5(a), domain II, bounded by junction triangles with corners
/// on three contours. The edge between the tops crosses that canyon like any other edge. The branch beyond it runs
/// around a contour, so it is never dropped.
pub fn eliminate(tin: &Tin, kinds: &[TriangleKind], regions: &Regions, resolution: f64) -> Elimination {
    let branches = Branches::new(tin, kinds, regions);
    let mut eliminated = vec![false; tin.len()];
    let mut dropped = vec![false; tin.len()];
    let mut limited = 0;
    for t in (0..tin.len() as u32).filter(|&t| kinds[t as usize] == TriangleKind::Junction) {
        let mut edges: Vec<(f64, usize)> =
            (0..3).filter(|&i| is_chord(tin, t, i)).map(|i| (branches.contour_beyond(tin, regions, t, i), i)).collect();
        if edges.is_empty() {
            continue;
        }
        edges.sort_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
        let candidates = if edges.len() == 3 { &edges[1..] } else { &edges[..] };
        let lengths = [0, 1, 2].map(|i| tin.edge_length(t, i));
        let others = |i: usize| lengths[(i + 1) % 3] + lengths[(i + 2) % 3];
        let limit = (0..3).map(|i| lengths[i] / others(i)).fold(0.0, f64::max);
        limited += usize::from(limit > resolution);
        let parameters = candidates.iter().map(|&(beyond, i)| (beyond / others(i), i));
        let least = parameters.min_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        if let Some((r, i)) = least
            && r < resolution.max(limit)
        {
            eliminated[t as usize] = true;
            drop_branch(tin, &mut dropped, t, i);
        }
    }
    Elimination { eliminated, dropped, limited }
}

/// Whether edge `i` of `t` is free and has both ends on contours of one level: it spans a spur, a gully or a top.
pub fn is_chord(tin: &Tin, t: u32, i: usize) -> bool {
    let [u, v] = tin.edge(t, i);
    is_on_border(tin, u)
        && is_on_border(tin, v)
        && tin.heights[u as usize] == tin.heights[v as usize]
        && tin.lake(t).is_none()
        && tin.across(t, i).is_some()
}

/// Marks the triangles beyond edge `i` of `t`. The branch is a tree: its triangles never lead back to `t`.
fn drop_branch(tin: &Tin, dropped: &mut [bool], t: u32, i: usize) {
    let Some(first) = tin.across(t, i) else { return };
    let mut stack = vec![(first, t)];
    while let Some((t, from)) = stack.pop() {
        if std::mem::replace(&mut dropped[t as usize], true) {
            continue;
        }
        stack.extend((0..3).filter_map(|i| tin.across(t, i)).filter(|&n| n != from).map(|n| (n, t)));
    }
}

/// The branches of every sub-domain's dual graph, found by stripping its leaves.
struct Branches {
    /// The neighbour to which a stripped triangle was attached; [`NONE`] for the core and the roots.
    parent: Vec<u32>,
    /// Length of contour around the stripped triangle and all that was attached to it, map units.
    length: Vec<f64>,
    /// By sub-domain: the length of all its contours if its dual graph is a tree, otherwise infinity.
    total: Vec<f64>,
}

impl Branches {
    fn new(tin: &Tin, kinds: &[TriangleKind], regions: &Regions) -> Self {
        let mut total = vec![f64::INFINITY; regions.regions.len()];
        let free = kinds.iter().map(|k| match k {
            TriangleKind::Outside | TriangleKind::Isolated => 0,
            TriangleKind::Terminal => 1,
            TriangleKind::Sleeve => 2,
            TriangleKind::Junction => 3,
        });
        let around =
            |t: u32| (0..3).filter(move |&i| tin.border_level(t, i).is_some()).map(move |i| tin.edge_length(t, i));
        let mut length: Vec<f64> = parallel::values(tin.len(), |t| around(t as u32).sum());
        let parent = strip(tin, free.collect(), |leaf, trunk, is_whole| {
            length[trunk as usize] += length[leaf as usize];
            if is_whole {
                total[regions.of_triangle[trunk as usize] as usize] = length[trunk as usize];
            }
        });
        Self { parent, length, total }
    }

    /// Length of contour beyond edge `i` of `t`; infinite where more than one branch lies there.
    fn contour_beyond(&self, tin: &Tin, regions: &Regions, t: u32, i: usize) -> f64 {
        match tin.across(t, i) {
            Some(n) if self.parent[n as usize] == t => self.length[n as usize],
            Some(n) if self.parent[t as usize] == n => {
                self.total[regions.of_triangle[t as usize] as usize] - self.length[t as usize]
            }
            _ => f64::INFINITY,
        }
    }
}
