//! The branches of sub-domains, as trees of triangles.
//!
//! Triangles are the nodes of a graph, and free edges join them. Where this graph ends in trees, their leaves can be
//! stripped one after the other. What is left is the core: the rings of triangles around contours.

use crate::base::parallel;
use crate::tin::{NONE, Tin, VertexKind};

/// Strips leaf after leaf. `free` is the number of free edges of each triangle. Calls `attach` with each leaf, the
/// triangle to which it was attached, and whether that triangle is the root of a whole sub-domain.
///
/// Returns the triangle to which each one was attached, [`NONE`] for the core and the roots.
pub(super) fn strip(tin: &Tin, mut free: Vec<u8>, mut attach: impl FnMut(u32, u32, bool)) -> Vec<u32> {
    let mut parent = vec![NONE; tin.len()];
    let mut leaves: Vec<u32> = (0..tin.len() as u32).filter(|&t| free[t as usize] == 1).collect();
    while let Some(leaf) = leaves.pop() {
        if free[leaf as usize] != 1 {
            continue;
        }
        free[leaf as usize] = 0;
        let trunk = (0..3).filter_map(|i| tin.across(leaf, i)).find(|&n| parent[n as usize] != leaf);
        let Some(trunk) = trunk else { continue };
        parent[leaf as usize] = trunk;
        free[trunk as usize] -= 1;
        attach(leaf, trunk, free[trunk as usize] == 0);
        if free[trunk as usize] == 1 {
            leaves.push(trunk);
        }
    }
    parent
}

/// The levels in each branch.
pub(super) struct BranchLevels {
    parent: Vec<u32>,
    /// By triangle: the lowest and the highest level at the corners of the branch that ends with it.
    range: Vec<[f64; 2]>,
}

impl BranchLevels {
    /// Collects the levels in the branches of all sub-domains.
    pub fn new(tin: &Tin) -> Self {
        let free = |t: u32| (0..3).filter(|&i| tin.across(t, i).is_some()).count() as u8;
        let free = parallel::values(tin.len(), |t| if tin.is_inside(t as u32) { free(t as u32) } else { 0 });
        let of_corners = |t: usize| {
            let levels = tin.triangles[t].into_iter().filter(|&v| is_on_border(tin, v));
            let levels = levels.map(|v| tin.heights[v as usize]);
            levels.fold([f64::INFINITY, f64::NEG_INFINITY], |[lo, hi], level| [level.min(lo), level.max(hi)])
        };
        let mut range: Vec<[f64; 2]> = parallel::values(tin.len(), of_corners);
        let parent = strip(tin, free, |leaf, trunk, _| {
            let ([lo, hi], of_trunk) = (range[leaf as usize], &mut range[trunk as usize]);
            *of_trunk = [of_trunk[0].min(lo), of_trunk[1].max(hi)];
        });
        Self { parent, range }
    }

    /// Whether triangle `n` is the first of a branch, seen from its neighbour `t`, and the branch holds no corner on a
    /// level.
    pub fn is_without(&self, t: u32, n: u32, level: f64) -> bool {
        let [lo, hi] = self.range[n as usize];
        self.parent[n as usize] == t && !(lo <= level && level <= hi)
    }
}

/// Whether a vertex may lie on the border of a sub-domain: on a contour or a shore.
pub(super) fn is_on_border(tin: &Tin, v: u32) -> bool {
    matches!(tin.kinds[v as usize], VertexKind::Contour | VertexKind::Shore)
}
