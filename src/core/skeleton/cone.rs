//! The cone of directions that views have left, and the nearest segment in it.
//!
//! A view through a row of many thin triangles spreads through each of them before it reaches anything. A search by distance
//! in the directions of the view finds the same, and looks at none of them.

use std::cmp::Ordering;
use std::collections::BinaryHeap;
use std::f64::consts::PI;

use glam::DVec2;
use rstar::primitives::Line;
use rstar::{AABB, ParentNode, PointDistance, RTree, RTreeNode, RTreeParams};

/// Directions up to this angle (radians) beside the cone count as in it. It is more than lines of sight have.
const BESIDE: f64 = 1e-8;

/// Directions from a place.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Cone {
    from: DVec2,
    /// The right and the left limit, half a turn apart at most; none for all directions.
    limits: Option<[DVec2; 2]>,
}

impl Cone {
    /// The narrowest cone around views from a place, each with its right and left limit.
    pub fn around(from: DVec2, views: impl Iterator<Item = [DVec2; 2]> + Clone) -> Self {
        // Each view adds its middle direction, also if it is half a turn wide or as narrow as a line.
        let middle = |view: [DVec2; 2]| {
            let [right, left] = view.map(DVec2::normalize_or_zero);
            right + left + (right - left).perp()
        };
        let axis: DVec2 = views.clone().map(middle).sum();
        let turn = |way: DVec2| axis.perp_dot(way).atan2(axis.dot(way));
        let by_turn = |a: &DVec2, b: &DVec2| turn(*a).total_cmp(&turn(*b));
        let right = views.clone().map(|[right, _]| right).min_by(by_turn);
        let left = views.map(|[_, left]| left).max_by(by_turn);
        let limits = right.zip(left).map(|(right, left)| [right, left]);
        let is_half_a_turn_at_most = |[right, left]: &[DVec2; 2]| {
            let angle = turn(*left) - turn(*right);
            axis != DVec2::ZERO && (0.0..=PI + BESIDE).contains(&angle)
        };
        Self { from, limits: limits.filter(is_half_a_turn_at_most) }
    }

    /// Whether a direction or a place relative to `from` lies in the cone.
    fn holds(&self, way: DVec2) -> bool {
        self.limits.is_none_or(|[right, left]| is_left_of(right, way) && is_left_of(way, left))
    }

    /// Whether part of a box may lie in the cone.
    fn meets(&self, area: &AABB<[f64; 2]>) -> bool {
        let Some([right, left]) = self.limits else { return true };
        let ([x0, y0], [x1, y1]) = (area.lower(), area.upper());
        let corners = [[x0, y0], [x1, y0], [x1, y1], [x0, y1]].map(|corner| DVec2::from(corner) - self.from);
        corners.iter().any(|&way| is_left_of(right, way)) && corners.iter().any(|&way| is_left_of(way, left))
    }

    /// The distance of the nearest segment whose nearest point lies in the cone and is visible, if it is less than `most`.
    pub fn nearest<P: RTreeParams>(
        &self,
        tree: &RTree<Line<[f64; 2]>, P>,
        most: f64,
        mut is_visible: impl FnMut(DVec2) -> bool,
    ) -> Option<f64> {
        let p = self.from.to_array();
        let mut open = BinaryHeap::from([Near { d2: 0.0, part: Part::Node(tree.root()) }]);
        while let Some(Near { d2, part }) = open.pop() {
            if d2.sqrt() >= most {
                return None;
            }
            let node = match part {
                Part::Node(node) => node,
                Part::Segment(segment) => {
                    let nearest = DVec2::from(segment.nearest_point(&p));
                    if self.holds(nearest - self.from) && is_visible(nearest) {
                        return Some(d2.sqrt());
                    }
                    continue;
                }
            };
            open.extend(node.children().iter().filter_map(|child| match child {
                RTreeNode::Parent(node) => {
                    let area = node.envelope();
                    self.meets(&area).then(|| Near { d2: area.distance_2(&p), part: Part::Node(node) })
                }
                RTreeNode::Leaf(segment) => Some(Near { d2: segment.distance_2(&p), part: Part::Segment(segment) }),
            }));
        }
        None
    }
}

/// Whether `b` lies on the left of `a`, or beside it.
fn is_left_of(a: DVec2, b: DVec2) -> bool {
    a.perp_dot(b) >= -BESIDE * a.length() * b.length()
}

/// A part of a tree.
enum Part<'a> {
    Node(&'a ParentNode<Line<[f64; 2]>>),
    Segment(&'a Line<[f64; 2]>),
}

/// A part with the square of its distance. In a heap, the nearest comes first.
struct Near<'a> {
    d2: f64,
    part: Part<'a>,
}

impl Ord for Near<'_> {
    fn cmp(&self, other: &Self) -> Ordering {
        other.d2.total_cmp(&self.d2)
    }
}

impl PartialOrd for Near<'_> {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl PartialEq for Near<'_> {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other).is_eq()
    }
}

impl Eq for Near<'_> {}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_nearest_segment_in_the_cone_is_that_of_all_in_it() {
        let spoke = |k: u32| {
            let way = DVec2::from_angle(f64::from(k) * 0.618_034) * (20.0 + f64::from(k % 37));
            Line::new(way.to_array(), (way + way.perp() * 0.05).to_array())
        };
        let lines: Vec<Line<[f64; 2]>> = (0..500).map(spoke).collect();
        let tree: RTree<Line<[f64; 2]>> = RTree::bulk_load(lines.clone());
        for k in 0..60 {
            let from = DVec2::from_angle(f64::from(k)) * f64::from(k % 9);
            let view = |turn: f64| [turn - 0.02, turn + 0.03].map(DVec2::from_angle);
            let turn = f64::from(k) * 1.3;
            let views = [view(turn), view(turn + 0.2)];
            let cone = Cone::around(from, views.into_iter());
            let is_visible = |p: DVec2| (p.x * 10.0).fract().abs() > 0.3;
            let of_all = lines.iter().filter(|line| {
                let nearest = DVec2::from(line.nearest_point(&from.to_array()));
                let way = nearest - from;
                views[0][0].perp_dot(way) >= 0.0 && way.perp_dot(views[1][1]) >= 0.0 && is_visible(nearest)
            });
            let distance = of_all.map(|line| line.distance_2(&from.to_array()).sqrt()).fold(f64::INFINITY, f64::min);
            assert_eq!(cone.nearest(&tree, f64::INFINITY, is_visible).unwrap_or(f64::INFINITY), distance, "{k}");
            assert_eq!(cone.nearest(&tree, distance, is_visible), None);
        }
    }

    #[test]
    fn views_all_around_are_no_cone() {
        let views = [[DVec2::X, DVec2::Y], [DVec2::NEG_X, DVec2::NEG_Y]];
        assert_eq!(Cone::around(DVec2::ZERO, views.into_iter()).limits, None);
        let half = [[DVec2::new(1.0, -0.1), DVec2::Y], [DVec2::X, DVec2::NEG_X], [DVec2::NEG_Y, DVec2::X]];
        assert_eq!(Cone::around(DVec2::ZERO, half[1..2].iter().copied()).limits, Some(half[1]));
        assert_eq!(Cone::around(DVec2::ZERO, half[..2].iter().copied()).limits, None);
        assert_eq!(Cone::around(DVec2::ZERO, [half[0], half[2]].into_iter()).limits, Some([DVec2::NEG_Y, DVec2::Y]));
    }
}
