//! The border of a sub-domain by its levels, for distances to them.

use std::cmp::Ordering;
use std::collections::{BTreeMap, BinaryHeap, HashMap};

use glam::DVec2;
use rstar::primitives::{GeomWithData, Line, Rectangle};
use rstar::{AABB, ParentNode, PointDistance, RStarInsertionStrategy, RTree, RTreeNode, RTreeParams};

use super::glimpse::Glimpse;
use super::pieces::AxisPoint;
use super::sight::{Found, Sights, nearest_in_sight};
use crate::base::union_find::UnionFind;
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

/// Nodes of a tree of segments are larger than usual. The trees are made faster, which takes longer than all searches in them.
struct LargeNodes;

impl RTreeParams for LargeNodes {
    const MIN_SIZE: usize = 8;
    const MAX_SIZE: usize = 16;
    const REINSERTION_COUNT: usize = 2;
    type DefaultInsertionStrategy = RStarInsertionStrategy;
}

/// The border of one sub-domain at one level.
pub(super) struct LevelTree {
    pub level: f64,
    tree: RTree<Segment, LargeNodes>,
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
        let mut sights = Sights::new(tin, point.triangle, from);
        let mut shown = |s: &Segment| sights.sees(DVec2::from(s.nearest_point(&p)));
        // A point with a level lies inside its triangle or on an edge of it. A view can spread from there.
        let glimpse = glimpse.filter(|_| point.level.is_some());
        if self.segment.is_none_or(&mut shown)
            || glimpse.is_some_and(|glimpse| glimpse.hides(point.triangle, from, level))
        {
            return self.distance;
        }
        let mut trials = self.tree.tree.nearest_neighbor_iter_with_distance_2(&p).take(SIGHT_TRIALS);
        if let Some((_, d2)) = trials.find(|(s, _)| shown(s)) {
            return d2.sqrt();
        }
        let Some(glimpse) = glimpse else { return self.distance };
        let found = match nearest_in_sight(&mut sights, glimpse.branches(), level) {
            Found::Nearest(found) => found,
            Found::Open(best, cone) => {
                let nearer = cone.nearest(&self.tree.tree, best, |at| sights.sees(at));
                nearer.or(best.is_finite().then_some(best))
            }
        };
        found.unwrap_or(self.distance)
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
        let levels: Vec<&[(f64, u32, u8)]> = segments.chunk_by(|a, b| a.0 == b.0).collect();
        let of_level = |same: &&[(f64, u32, u8)]| LevelTree {
            level: same[0].0,
            tree: RTree::bulk_load_with_params(same.iter().map(line).collect()),
        };
        let trees: Vec<LevelTree> = levels.iter().map(of_level).collect();
        let is_small = |level: &LevelTree| (level.tree.size() as f64) < SMALL_SHARE * segments.len() as f64;
        let mut boxes = Vec::new();
        for ((k, level), same) in (0u32..).zip(&trees).zip(&levels) {
            let mut push = |piece: AABB<[f64; 2]>| boxes.push(GeomWithData::new(Rectangle::from_aabb(piece), k));
            if trees.len() <= FEW_LEVELS {
                push_boxes(level.tree.root(), 0, &mut push);
            } else if !is_small(level) {
                push_boxes(level.tree.root(), BOX_STEPS, &mut push);
            } else {
                // Lines of one level may lie far from each other. A box around segments of two lines would be large.
                for connected in connected_edges(tin, same) {
                    let segments: Vec<Segment> = connected.into_iter().map(line).collect();
                    push_boxes(RTree::bulk_load(segments).root(), usize::MAX, &mut push);
                }
            }
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

    /// The level of a point and its nearest segment.
    pub fn of_point(&self, tin: &Tin, point: &AxisPoint, level: f64) -> Option<NearLevel<'_>> {
        let tree = self.of(level)?;
        // The search is short where it need not go further than to a corner of the point's triangle.
        let corners = tin.triangles[point.triangle as usize].into_iter().map(|v| v as usize);
        let on_level = corners.filter(|&v| tin.heights[v] == level).map(|v| tin.positions[v]);
        let d2 = on_level.map(|corner| corner.distance_squared(point.position)).fold(f64::INFINITY, f64::min);
        let p = point.position.to_array();
        let close = d2.is_finite().then(|| tree.tree.locate_within_distance(p, d2 * (1.0 + ROUNDING)));
        let nearest = close.and_then(|close| {
            let each = close.map(|segment| (segment.distance_2(&p), segment));
            each.min_by(|a, b| a.0.total_cmp(&b.0))
        });
        Some(match nearest {
            Some((d2, segment)) => NearLevel { distance: d2.sqrt(), tree, segment: Some(segment) },
            None => NearLevel::new(tree, point.position),
        })
    }

    /// Whether a segment of another level is nearer than `near`, a level and its distance from `at`.
    pub fn has_nearer_other(&self, near: &NearLevel, at: DVec2) -> bool {
        let (p, d2) = (at.to_array(), near.distance * near.distance * (1.0 + ROUNDING));
        let mut seen: Vec<u32> = Vec::new();
        self.boxes.locate_within_distance(p, d2).any(|piece| {
            let LevelTree { level, tree } = &self.trees[piece.data as usize];
            let is_new = *level != near.tree.level && !seen.contains(&piece.data);
            is_new && {
                seen.push(piece.data);
                tree.locate_within_distance(p, d2).any(|segment| segment.distance_2(&p).sqrt() < near.distance)
            }
        })
    }

    /// The distance of the nearest level that is wanted, and this level. Of two at one distance, it is the lower one.
    /// `distance` tells how far a level is. That is never less than the distance of its nearest segment. It takes time, so it is
    /// called for few levels.
    pub fn nearest(
        &self,
        at: DVec2,
        wanted: impl Fn(f64) -> bool,
        distance: impl Fn(&NearLevel) -> f64,
    ) -> Option<(f64, f64)> {
        let mut best: Option<(f64, f64)> = None;
        let is_too_far = |best: Option<(f64, f64)>, bound: f64| best.is_some_and(|(distance, _)| bound > distance);
        let mut boxes = self.boxes.nearest_neighbor_iter_with_distance_2(&at.to_array());
        let mut seen: Vec<u32> = Vec::new();
        let mut found: BinaryHeap<ByDistance> = BinaryHeap::new();
        loop {
            let piece = boxes.next();
            let bound = piece.map_or(f64::INFINITY, |(_, d2)| d2.sqrt()) * (1.0 - ROUNDING);
            while found.peek().is_some_and(|nearest| nearest.0.distance < bound) {
                let Some(ByDistance(near)) = found.pop() else { break };
                if is_too_far(best, near.distance * (1.0 - ROUNDING)) {
                    return best;
                }
                let found = (distance(&near), near.tree.level);
                if best.is_none_or(|best| found < best) {
                    best = Some(found);
                }
            }
            let Some((piece, _)) = piece.filter(|_| !is_too_far(best, bound)) else { return best };
            let tree = &self.trees[piece.data as usize];
            if wanted(tree.level) && !seen.contains(&piece.data) {
                seen.push(piece.data);
                found.push(ByDistance(NearLevel::new(tree, at)));
            }
        }
    }
}

/// Groups edges (level, triangle and number of the edge) that share vertices.
fn connected_edges<'a>(tin: &Tin, edges: &'a [(f64, u32, u8)]) -> Vec<Vec<&'a (f64, u32, u8)>> {
    let mut sets = UnionFind::new(edges.len());
    let mut first_at: HashMap<u32, usize> = HashMap::new();
    for (k, &(_, t, i)) in edges.iter().enumerate() {
        for v in tin.edge(t, i as usize) {
            sets.unite(*first_at.entry(v).or_insert(k), k);
        }
    }
    let mut groups: BTreeMap<usize, Vec<_>> = BTreeMap::new();
    for (k, edge) in edges.iter().enumerate() {
        groups.entry(sets.root(k)).or_default().push(edge);
    }
    groups.into_values().collect()
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
