//! The border of a sub-domain by its levels, for distances to them.

use std::cmp::Ordering;
use std::collections::BinaryHeap;

use glam::DVec2;
use rstar::primitives::{GeomWithData, Line, Rectangle};
use rstar::{AABB, ParentNode, PointDistance, RTree, RTreeNode};

use super::glimpse::Glimpse;
use super::pieces::AxisPoint;
use super::sight::{nearest_in_sight, sees};
use crate::tin::Tin;

/// Number of segments tested for visibility one by one, before the search by views begins. It limits the time.
const SIGHT_TRIALS: usize = 16;
/// Up to this number of levels, one box around each is enough.
const FEW_LEVELS: usize = 8;
/// With more levels, the boxes around pieces of a level are those of its tree, so many steps from the root.
const BOX_STEPS: usize = 2;
/// A bound of a distance may be too large by this share of it, because of rounding.
const ROUNDING: f64 = 1e-12;

/// The border of one sub-domain at one level.
pub(super) struct LevelTree {
    pub level: f64,
    tree: RTree<Line<[f64; 2]>>,
}

impl LevelTree {
    /// Distance to the nearest segment, visible or not.
    pub fn distance(&self, from: DVec2) -> f64 {
        let p = from.to_array();
        self.tree.nearest_neighbor(&p).map_or(f64::INFINITY, |s| s.distance_2(&p).sqrt())
    }

    /// Distance to the nearest segment whose nearest point is visible; to the nearest segment of all if none is.
    pub fn visible_distance(&self, tin: &Tin, glimpse: &Glimpse, point: &AxisPoint) -> f64 {
        let from = point.position;
        let p = from.to_array();
        let Some(nearest) = self.tree.nearest_neighbor(&p) else { return f64::INFINITY };
        let straight = nearest.distance_2(&p).sqrt();
        let shown = |s: &Line<[f64; 2]>| sees(tin, point.triangle, from, DVec2::from(s.nearest_point(&p)));
        // A point with a level lies inside its triangle or on an edge of it. A view can spread from there.
        let can_spread = point.level.is_some();
        if shown(nearest) || (can_spread && glimpse.hides(point.triangle, from, self.level)) {
            return straight;
        }
        let trials = self.tree.nearest_neighbor_iter_with_distance_2(&p).take(SIGHT_TRIALS);
        if let Some((_, d2)) = trials.into_iter().find(|(s, _)| shown(s)) {
            return d2.sqrt();
        }
        let spread = || nearest_in_sight(tin, glimpse.branches(), point.triangle, from, self.level);
        can_spread.then(spread).flatten().unwrap_or(straight)
    }
}

/// The border of one sub-domain, by level.
pub(super) struct BorderLevels {
    /// By ascending level.
    trees: Vec<LevelTree>,
    /// Boxes around pieces of each level, with its number.
    boxes: RTree<GeomWithData<Rectangle<[f64; 2]>, u32>>,
}

impl BorderLevels {
    /// Indexes the pieces of contour and shore on a border, by triangle and edge.
    pub fn new(tin: &Tin, borders: &[(u32, u8)]) -> Self {
        let mut segments: Vec<(f64, u32, u8)> =
            borders.iter().filter_map(|&(t, i)| tin.border_level(t, i as usize).map(|level| (level, t, i))).collect();
        segments.sort_by(|a, b| a.0.total_cmp(&b.0));
        let line = |&(_, t, i): &(f64, u32, u8)| {
            let [u, v] = tin.edge(t, i as usize).map(|v| tin.positions[v as usize].to_array());
            Line::new(u, v)
        };
        let of_level = |same: &[(f64, u32, u8)]| LevelTree {
            level: same[0].0,
            tree: RTree::bulk_load(same.iter().map(line).collect()),
        };
        let trees: Vec<LevelTree> = segments.chunk_by(|a, b| a.0 == b.0).map(of_level).collect();
        let steps = if trees.len() <= FEW_LEVELS { 0 } else { BOX_STEPS };
        let mut boxes = Vec::new();
        for (k, level) in (0u32..).zip(&trees) {
            push_boxes(level.tree.root(), steps, &mut |piece: AABB<[f64; 2]>| {
                boxes.push(GeomWithData::new(Rectangle::from_aabb(piece), k));
            });
        }
        Self { trees, boxes: RTree::bulk_load(boxes) }
    }

    /// One level.
    pub fn of(&self, level: f64) -> Option<&LevelTree> {
        let k = self.trees.partition_point(|tree| tree.level < level);
        self.trees.get(k).filter(|tree| tree.level == level)
    }

    /// The levels that are wanted with the distances to their nearest segments, visible or not, up to a distance and
    /// some beyond. The nearest comes first, and of two at one distance the lower one.
    pub fn nearest_first(
        &self,
        at: DVec2,
        within: f64,
        wanted: impl Fn(f64) -> bool,
    ) -> impl Iterator<Item = (f64, &LevelTree)> {
        let mut boxes = self.boxes.nearest_neighbor_iter_with_distance_2(&at.to_array());
        let mut bound = 0.0;
        let mut seen: Vec<u32> = Vec::new();
        let mut found: BinaryHeap<Candidate> = BinaryHeap::new();
        std::iter::from_fn(move || {
            while bound <= within && found.peek().is_none_or(|nearest| nearest.distance >= bound) {
                let Some((piece, d2)) = boxes.next() else { break };
                bound = d2.sqrt() * (1.0 - ROUNDING);
                let k = piece.data;
                if wanted(self.trees[k as usize].level) && !seen.contains(&k) {
                    seen.push(k);
                    found.push(Candidate { distance: self.trees[k as usize].distance(at), tree: k });
                }
            }
            found.pop().map(|nearest| (nearest.distance, &self.trees[nearest.tree as usize]))
        })
    }

    /// The nearest wanted level, by the distance to what is visible of it, and that distance.
    pub fn nearest_visible(
        &self,
        tin: &Tin,
        glimpse: &Glimpse,
        point: &AxisPoint,
        wanted: impl Fn(f64) -> bool,
    ) -> Option<(f64, f64)> {
        let mut best: Option<(f64, f64)> = None;
        for (straight, tree) in self.nearest_first(point.position, f64::INFINITY, wanted) {
            if best.is_some_and(|(distance, _)| straight * (1.0 - ROUNDING) > distance) {
                break;
            }
            let found = (tree.visible_distance(tin, glimpse, point), tree.level);
            if best.is_none_or(|best| found < best) {
                best = Some(found);
            }
        }
        best
    }
}

/// Passes on the boxes of a tree that are so many steps from a node.
fn push_boxes(node: &ParentNode<Line<[f64; 2]>>, steps: usize, push: &mut impl FnMut(AABB<[f64; 2]>)) {
    if steps == 0 {
        return push(node.envelope());
    }
    for child in node.children() {
        match child {
            RTreeNode::Parent(parent) => push_boxes(parent, steps - 1, push),
            RTreeNode::Leaf(line) => push(AABB::from_corners(line.from, line.to)),
        }
    }
}

/// A level and its distance. In a heap, the nearest comes first, then the lower one.
#[derive(PartialEq)]
struct Candidate {
    distance: f64,
    tree: u32,
}

impl Eq for Candidate {}

impl Ord for Candidate {
    fn cmp(&self, other: &Self) -> Ordering {
        other.distance.total_cmp(&self.distance).then(other.tree.cmp(&self.tree))
    }
}

impl PartialOrd for Candidate {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}
