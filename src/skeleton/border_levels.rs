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
/// With more levels, a level with less than this share of the border has a box around every few segments. A level with
/// more has fewer boxes: those of its tree, so many steps from the root.
const SMALL_SHARE: f64 = 0.05;
const BOX_STEPS: usize = 2;
/// A bound of a distance may be too large by this share of it, because of rounding.
const ROUNDING: f64 = 1e-12;

/// A piece of the border.
type Segment = Line<[f64; 2]>;

/// The border of one sub-domain at one level.
pub(super) struct LevelTree {
    pub level: f64,
    tree: RTree<Segment>,
}

impl LevelTree {
    /// Distance to the nearest segment, visible or not.
    pub fn distance(&self, from: DVec2) -> f64 {
        self.nearest(from).0
    }

    /// The nearest segment, visible or not, with the distance to it.
    fn nearest(&self, from: DVec2) -> (f64, Option<&Segment>) {
        let p = from.to_array();
        let nearest = self.tree.nearest_neighbor(&p);
        (nearest.map_or(f64::INFINITY, |s| s.distance_2(&p).sqrt()), nearest)
    }
}

/// A level and its nearest segment, visible or not.
#[derive(Clone, Copy)]
pub(super) struct NearLevel<'a> {
    pub distance: f64,
    pub tree: &'a LevelTree,
    segment: Option<&'a Segment>,
}

impl<'a> NearLevel<'a> {
    fn new(tree: &'a LevelTree, from: DVec2) -> Self {
        let (distance, segment) = tree.nearest(from);
        Self { distance, tree, segment }
    }

    /// Distance to the nearest segment whose nearest point is visible; to the nearest segment of all if none is. Points with
    /// a level need a `glimpse`.
    pub fn visible_distance(&self, tin: &Tin, glimpse: Option<&Glimpse>, point: &AxisPoint) -> f64 {
        let (from, level) = (point.position, self.tree.level);
        let p = from.to_array();
        let shown = |s: &Segment| sees(tin, point.triangle, from, DVec2::from(s.nearest_point(&p)));
        // A point with a level lies inside its triangle or on an edge of it. A view can spread from there.
        let glimpse = glimpse.filter(|_| point.level.is_some());
        if self.segment.is_none_or(shown) || glimpse.is_some_and(|glimpse| glimpse.hides(point.triangle, from, level)) {
            return self.distance;
        }
        let trials = self.tree.tree.nearest_neighbor_iter_with_distance_2(&p).take(SIGHT_TRIALS);
        if let Some((_, d2)) = trials.into_iter().find(|(s, _)| shown(s)) {
            return d2.sqrt();
        }
        let spread = |glimpse: &Glimpse| nearest_in_sight(tin, glimpse.branches(), point.triangle, from, level);
        glimpse.and_then(spread).unwrap_or(self.distance)
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
        let is_small = |level: &LevelTree| (level.tree.size() as f64) < SMALL_SHARE * segments.len() as f64;
        let steps = |level: &LevelTree| match () {
            () if trees.len() <= FEW_LEVELS => 0,
            () if is_small(level) => usize::MAX,
            () => BOX_STEPS,
        };
        let mut boxes = Vec::new();
        for (k, level) in (0u32..).zip(&trees) {
            push_boxes(level.tree.root(), steps(level), &mut |piece: AABB<[f64; 2]>| {
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

    /// One level and its nearest segment.
    pub fn near(&self, level: f64, at: DVec2) -> Option<NearLevel<'_>> {
        self.of(level).map(|tree| NearLevel::new(tree, at))
    }

    /// The levels that are wanted. The nearest comes first, whether it is visible or not; of two at one distance, the
    /// lower one.
    pub fn nearest_first<'a>(
        &'a self,
        at: DVec2,
        wanted: impl Fn(f64) -> bool + 'a,
    ) -> impl Iterator<Item = NearLevel<'a>> {
        let mut boxes = self.boxes.nearest_neighbor_iter_with_distance_2(&at.to_array());
        let mut bound = 0.0;
        let mut seen: Vec<u32> = Vec::new();
        let mut found: BinaryHeap<ByDistance> = BinaryHeap::new();
        std::iter::from_fn(move || {
            while found.peek().is_none_or(|nearest| nearest.0.distance >= bound) {
                let Some((piece, d2)) = boxes.next() else { break };
                bound = d2.sqrt() * (1.0 - ROUNDING);
                let tree = &self.trees[piece.data as usize];
                if wanted(tree.level) && !seen.contains(&piece.data) {
                    seen.push(piece.data);
                    found.push(ByDistance(NearLevel::new(tree, at)));
                }
            }
            found.pop().map(|nearest| nearest.0)
        })
    }
}

/// Of levels sorted by their distance, the nearest one by the distance to what is visible of it, and that distance.
pub(super) fn nearest_visible<'a>(
    tin: &Tin,
    glimpse: Option<&Glimpse>,
    point: &AxisPoint,
    nearest_first: impl Iterator<Item = NearLevel<'a>>,
) -> Option<(f64, f64)> {
    let mut best: Option<(f64, f64)> = None;
    for near in nearest_first {
        if best.is_some_and(|(distance, _)| near.distance * (1.0 - ROUNDING) > distance) {
            break;
        }
        let found = (near.visible_distance(tin, glimpse, point), near.tree.level);
        if best.is_none_or(|best| found < best) {
            best = Some(found);
        }
    }
    best
}

/// Passes on the boxes of a tree that are so many steps from a node, or around segments only.
fn push_boxes(node: &ParentNode<Segment>, steps: usize, push: &mut impl FnMut(AABB<[f64; 2]>)) {
    let is_parent = |child: &RTreeNode<_>| matches!(child, RTreeNode::Parent(_));
    if steps == 0 || !node.children().iter().any(is_parent) {
        return push(node.envelope());
    }
    for child in node.children() {
        match child {
            RTreeNode::Parent(parent) => push_boxes(parent, steps - 1, push),
            RTreeNode::Leaf(line) => push(AABB::from_corners(line.from, line.to)),
        }
    }
}

/// In a heap, the nearest level comes first, then the lower one.
struct ByDistance<'a>(NearLevel<'a>);

impl Ord for ByDistance<'_> {
    fn cmp(&self, Self(other): &Self) -> Ordering {
        other.distance.total_cmp(&self.0.distance).then(other.tree.level.total_cmp(&self.0.tree.level))
    }
}

impl PartialOrd for ByDistance<'_> {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl PartialEq for ByDistance<'_> {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other).is_eq()
    }
}

impl Eq for ByDistance<'_> {}
