//! A tree of rotated boxes: each is turned along what it holds.
//!
//! Upright boxes around long oblique segments nearly all meet, even if few of the segments are near each other. Long
//! segments that do not cross lie side by side. Boxes along them are narrow, and so are the boxes around several of
//! them. So about as many pairs of boxes meet as segments are near each other.
//!
//! Boxes are never too small. A search finds everything that is near, and some things that are not.

use std::cmp::{Ordering, Reverse};
use std::collections::BinaryHeap;

use glam::DVec2;
use rayon::prelude::*;

use crate::base::parallel;

/// Number of boxes in a box of the next level.
const FANOUT: usize = 8;
/// Upper bound of the rounding of a few sums and products, as a share of the lengths in them.
const ROUNDING: f64 = 1e-14;

/// A rectangle at any angle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct OrientedBox {
    centre: DVec2,
    /// Unit vector along its length.
    axis: DVec2,
    /// Half its length and half its width.
    half: DVec2,
}

impl OrientedBox {
    /// A box around the points of a line, turned along its ends. An upright box if that is smaller.
    pub fn around(points: &[DVec2]) -> Self {
        let (Some(&first), Some(&last)) = (points.first(), points.last()) else {
            return Self { centre: DVec2::ZERO, axis: DVec2::X, half: DVec2::ZERO };
        };
        let centre = first.midpoint(last);
        Self::smaller((last - first).normalize_or(DVec2::X), centre, || {
            points.iter().map(|&p| (p - centre, DVec2::ZERO))
        })
    }

    /// The upright box between two corners.
    pub fn upright(min: DVec2, max: DVec2) -> Self {
        let centre = min.midpoint(max);
        Self { centre, axis: DVec2::X, half: (max - centre).max(centre - min) }
    }

    /// The box around a centre along a unit vector, by half its length and half its width.
    pub fn turned(centre: DVec2, axis: DVec2, half: DVec2) -> Self {
        Self { centre, axis, half }
    }

    /// A box around boxes, turned along the longest of them. An upright box if that is smaller.
    fn around_boxes(boxes: &[Self]) -> Self {
        let Some(longest) = boxes.iter().max_by(|a, b| a.half.max_element().total_cmp(&b.half.max_element())) else {
            return Self::around(&[]);
        };
        let axis = if longest.half.x >= longest.half.y { longest.axis } else { longest.axis.perp() };
        let centre = longest.centre;
        Self::smaller(axis, centre, || {
            boxes.iter().flat_map(move |b| {
                let [u, v] = [b.axis * b.half.x, b.axis.perp() * b.half.y];
                // The centre with half a diagonal to either side; both diagonals make all corners.
                [(b.centre - centre, u + v), (b.centre - centre, u - v)]
            })
        })
    }

    /// The smaller of two boxes around places: the box along `axis`, or the upright box. Each place is given relative
    /// to `origin`, with the vector by which it extends to both sides.
    fn smaller<I: Iterator<Item = (DVec2, DVec2)>>(axis: DVec2, origin: DVec2, places: impl Fn() -> I) -> Self {
        let along = |axis: DVec2| {
            let (mut min, mut max) = (DVec2::INFINITY, DVec2::NEG_INFINITY);
            for (place, spread) in places() {
                let place = DVec2::new(place.dot(axis), place.dot(axis.perp()));
                let spread = DVec2::new(spread.dot(axis), spread.dot(axis.perp())).abs();
                (min, max) = (min.min(place - spread), max.max(place + spread));
            }
            let (middle, half) = (min.midpoint(max), (max - min) / 2.0);
            let from_origin = min.abs().max(max.abs());
            let half = half + ROUNDING * (from_origin.x + from_origin.y);
            // The centre is rounded as coordinates are, so the box grows by that error.
            let shift = axis * middle.x + axis.perp() * middle.y;
            let centre = origin + shift;
            let off = (centre - origin) - shift;
            Self { centre, axis, half: half + (off.x.abs() + off.y.abs()) }
        };
        let (turned, upright) = (along(axis), along(DVec2::X));
        if turned.area() < upright.area() { turned } else { upright }
    }

    /// Its area.
    pub fn area(&self) -> f64 {
        4.0 * self.half.x * self.half.y
    }

    /// Grown by `margin` on all sides.
    pub fn grown(self, margin: f64) -> Self {
        Self { half: self.half + margin, ..self }
    }

    /// Whether they share a point. Boxes that nearly do may count too.
    pub fn meets(&self, other: &Self) -> bool {
        let between = other.centre - self.centre;
        let cos = self.axis.dot(other.axis).abs();
        let sin = self.axis.perp_dot(other.axis).abs();
        let (a, b) = (self.half, other.half);
        let slack = ROUNDING * (between.x.abs() + between.y.abs() + a.x + a.y + b.x + b.y);
        // Boxes are apart if a line along a side of one separates them.
        !(between.perp_dot(self.axis).abs() > a.y + b.x * sin + b.y * cos + slack
            || between.perp_dot(other.axis).abs() > b.y + a.x * sin + a.y * cos + slack
            || between.dot(self.axis).abs() > a.x + b.x * cos + b.y * sin + slack
            || between.dot(other.axis).abs() > b.x + a.x * cos + a.y * sin + slack)
    }

    /// A lower bound of the distance from `p` to the box.
    fn distance_at_least(&self, p: DVec2) -> f64 {
        let to = p - self.centre;
        let beyond = (DVec2::new(to.dot(self.axis), to.perp_dot(self.axis)).abs() - self.half).max(DVec2::ZERO);
        let slack = ROUNDING * (to.x.abs() + to.y.abs() + self.half.x + self.half.y);
        (beyond.length() - slack).max(0.0)
    }
}

/// Numbered boxes, and a tree to find those near a position.
#[derive(Debug)]
pub struct BoxTree {
    /// The boxes of all levels: the given boxes first, then boxes around up to [`FANOUT`] boxes of the level before.
    boxes: Vec<OrientedBox>,
    /// Numbers of the given boxes, in the order of `boxes`.
    numbers: Vec<u32>,
    /// Where each level starts, and at the end the number of all boxes.
    starts: Vec<usize>,
}

/// A box of the tree, by its level and its index in `boxes`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct Node {
    level: usize,
    at: usize,
}

impl BoxTree {
    /// Builds the tree. Boxes are numbered in their order.
    pub fn new(given: &[OrientedBox]) -> Self {
        let min = given.iter().fold(DVec2::INFINITY, |m, b| m.min(b.centre));
        let max = given.iter().fold(DVec2::NEG_INFINITY, |m, b| m.max(b.centre));
        let scale = f64::from(u16::MAX) / (max - min).max_element().max(f64::MIN_POSITIVE);
        // The conversion cuts numbers off at the end of the range.
        let cell = |b: &OrientedBox| ((b.centre - min) * scale).to_array().map(|v| v as u16);
        let mut order: Vec<(u32, u32)> = parallel::map(given.len(), |i| (along_curve(cell(&given[i])), i as u32));
        order.par_sort_unstable();
        let mut boxes: Vec<OrientedBox> = order.iter().map(|&(_, i)| given[i as usize]).collect();
        let mut starts = vec![0];
        let mut level = 0;
        while boxes.len() - level > 1 {
            let chunks: Vec<&[OrientedBox]> = boxes[level..].chunks(FANOUT).collect();
            let next = parallel::map_each(&chunks, |boxes| OrientedBox::around_boxes(boxes));
            level = boxes.len();
            starts.push(level);
            boxes.extend(next);
        }
        starts.push(boxes.len());
        Self { boxes, numbers: order.into_iter().map(|(_, i)| i).collect(), starts }
    }

    fn root(&self) -> Option<Node> {
        let at = self.boxes.len().checked_sub(1)?;
        Some(Node { level: self.starts.len() - 2, at })
    }

    /// The boxes inside a box that is not one of the given boxes.
    fn inside(&self, node: Node) -> impl Iterator<Item = Node> + use<> {
        let level = node.level - 1;
        let first = self.starts[level] + (node.at - self.starts[node.level]) * FANOUT;
        (first..(first + FANOUT).min(self.starts[node.level])).map(move |at| Node { level, at })
    }

    /// Numbers of the boxes that meet `area`, in no particular order.
    pub fn near(&self, area: OrientedBox) -> impl Iterator<Item = u32> {
        let mut open: Vec<Node> = self.root().filter(|root| self.boxes[root.at].meets(&area)).into_iter().collect();
        std::iter::from_fn(move || {
            while let Some(node) = open.pop() {
                if node.level == 0 {
                    return Some(self.numbers[node.at]);
                }
                open.extend(self.inside(node).filter(|n| self.boxes[n.at].meets(&area)));
            }
            None
        })
    }

    /// Numbers of the boxes, the nearest to `p` first, each with a lower bound of its distance.
    pub fn nearest_first(&self, p: DVec2) -> impl Iterator<Item = (u32, f64)> {
        let candidate =
            move |node: Node| Reverse(Candidate { distance: self.boxes[node.at].distance_at_least(p), node });
        let mut open: BinaryHeap<Reverse<Candidate>> = self.root().map(candidate).into_iter().collect();
        std::iter::from_fn(move || {
            while let Some(Reverse(Candidate { distance, node })) = open.pop() {
                if node.level == 0 {
                    return Some((self.numbers[node.at], distance));
                }
                open.extend(self.inside(node).map(candidate));
            }
            None
        })
    }
}

/// A box and a lower bound of its distance.
struct Candidate {
    distance: f64,
    node: Node,
}

impl Ord for Candidate {
    fn cmp(&self, other: &Self) -> Ordering {
        self.distance.total_cmp(&other.distance).then(self.node.at.cmp(&other.node.at))
    }
}

impl PartialOrd for Candidate {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl PartialEq for Candidate {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

impl Eq for Candidate {}

/// The position of a cell along Hilbert's curve through a square of cells. Successive cells of the curve are
/// neighbours.
pub fn along_curve(cell: [u16; 2]) -> u32 {
    let [mut x, mut y] = cell.map(u32::from);
    let mut place = 0;
    for bit in (0..u16::BITS).rev() {
        let (right, up) = (x >> bit & 1, y >> bit & 1);
        place = place << 2 | (3 * right) ^ up;
        if up == 0 {
            if right == 1 {
                (x, y) = (!x, !y);
            }
            std::mem::swap(&mut x, &mut y);
        }
    }
    place
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Numbers from 0 to 1 that look random.
    fn numbers() -> impl FnMut() -> f64 {
        let mut state = 1u64;
        move || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 11) as f64 / (1u64 << 53) as f64
        }
    }

    fn segments(count: usize, length: f64, origin: DVec2) -> Vec<[DVec2; 2]> {
        let mut next = numbers();
        let segment = |_| {
            let a = origin + 1000.0 * DVec2::new(next(), next());
            [a, a + length * next() * DVec2::from_angle(7.0 * next())]
        };
        (0..count).map(segment).collect()
    }

    fn tree(segments: &[[DVec2; 2]]) -> BoxTree {
        BoxTree::new(&segments.iter().map(|s| OrientedBox::around(s)).collect::<Vec<_>>())
    }

    #[test]
    fn whatever_touches_is_found_far_from_the_origin_too() {
        use geo::Intersects;
        let line = |s: &[DVec2; 2]| geo::Line::new((s[0].x, s[0].y), (s[1].x, s[1].y));
        for (length, origin) in [(30.0, DVec2::ZERO), (900.0, DVec2::new(-3e7, 4e7))] {
            let mut all = segments(500, length, origin);
            // Each end is touched by the start of another, so that some touch at one point alone.
            let more: Vec<[DVec2; 2]> =
                all.iter().zip(segments(500, length, DVec2::ZERO)).map(|(s, t)| [s[1], s[1] + t[1] - t[0]]).collect();
            all.extend(more);
            let tree = tree(&all);
            let mut touching = 0;
            for s in &all {
                let mut found: Vec<u32> = tree.near(OrientedBox::around(s)).collect();
                found.sort_unstable();
                assert!(found.windows(2).all(|w| w[0] < w[1]), "each once");
                for (j, _) in (0u32..).zip(&all).filter(|(_, t)| line(s).intersects(&line(t))) {
                    assert!(found.binary_search(&j).is_ok());
                    touching += 1;
                }
            }
            assert!(touching > 2000, "{touching}");
        }
    }

    #[test]
    fn the_nearest_come_first_and_no_distance_is_too_large() {
        let all = segments(400, 200.0, DVec2::new(1e6, -2e6));
        let tree = tree(&all);
        for p in segments(50, 0.0, DVec2::new(1e6, -2e6)).into_iter().map(|s| s[0]) {
            let found: Vec<(u32, f64)> = tree.nearest_first(p).collect();
            assert_eq!(found.len(), all.len());
            assert!(found.windows(2).all(|w| w[0].1 <= w[1].1));
            for (i, least) in found {
                let [a, b] = all[i as usize];
                let share = ((p - a).dot(b - a) / (b - a).length_squared()).clamp(0.0, 1.0);
                assert!(least <= p.distance(a.lerp(b, share)) + 1e-9);
            }
        }
    }

    #[test]
    fn long_slanting_lines_side_by_side_meet_few_boxes() {
        for angle in [0.1, 0.4, std::f64::consts::FRAC_PI_4, 2.0] {
            let (along, across) = (DVec2::from_angle(angle), DVec2::from_angle(angle).perp());
            let all: Vec<[DVec2; 2]> =
                (0..2000).map(|i| f64::from(i) * across).map(|a| [a, a + 10_000.0 * along]).collect();
            let tree = tree(&all);
            let met: usize = all.iter().map(|s| tree.near(OrientedBox::around(s).grown(0.01)).count()).sum();
            assert_eq!(met, all.len(), "each meets itself alone at {angle}");
        }
    }

    #[test]
    fn no_boxes_and_one_box_are_trees() {
        assert_eq!(BoxTree::new(&[]).near(OrientedBox::upright(DVec2::ZERO, DVec2::ONE)).count(), 0);
        assert_eq!(BoxTree::new(&[]).nearest_first(DVec2::ZERO).count(), 0);
        let one = BoxTree::new(&[OrientedBox::upright(DVec2::ZERO, DVec2::ONE)]);
        assert_eq!(one.near(OrientedBox::upright(DVec2::ONE, DVec2::ONE)).collect::<Vec<_>>(), [0]);
        assert_eq!(
            one.nearest_first(DVec2::new(3.0, 1.0)).map(|(i, d)| (i, d.round())).collect::<Vec<_>>(),
            [(0, 2.0)]
        );
    }

    #[test]
    fn coordinates_without_end_are_never_lost() {
        let tree = tree(&[[DVec2::splat(-f64::MAX), DVec2::splat(f64::MAX)], [DVec2::ZERO, DVec2::ONE]]);
        assert!(tree.near(OrientedBox::upright(DVec2::ZERO, DVec2::ONE)).any(|i| i == 1));
    }
}
