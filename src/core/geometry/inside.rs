//! Whether positions lie inside rings.
//!
//! A ray to the east of a position crosses an odd number of edges if the position is inside. In an outline with long
//! spikes, a ray crosses most of the edges. So the edges are not counted one by one. The plane is divided into strips
//! between the heights of the corners, and pairs of strips are joined into wider ones, as in a binary tree. Each edge is
//! kept in the few widest strips that it crosses from side to side. The edges of a strip do not cross each other, so they
//! are in order from west to east. Bisection then finds how many of them lie east of a position.

use std::cmp::Ordering;

use glam::DVec2;
use rayon::prelude::*;
use robust::orient2d;

use super::Segment;

/// The edges of rings in strips.
#[derive(Debug)]
pub(super) struct Inside {
    /// The edges, each from its lower end to its upper one. Level edges are left out, because no ray crosses them.
    edges: Vec<Segment>,
    /// The heights between strips, ascending.
    heights: Vec<f64>,
    /// By strip: where its edges begin in `order`; at the end the number of all. Strip 1 is the whole plane; strip `n` has
    /// the halves `2 n` and `2 n + 1`.
    starts: Vec<u32>,
    /// Numbers of edges, strip by strip, and in a strip from west to east.
    order: Vec<u32>,
}

impl Inside {
    /// Takes the edges of rings that do not cross themselves or each other.
    pub(super) fn new(edges: impl Iterator<Item = Segment>) -> Self {
        let upwards = |s: Segment| if s.a.y < s.b.y { s } else { Segment { a: s.b, b: s.a } };
        let edges: Vec<Segment> = edges.map(upwards).filter(|s| s.a.y < s.b.y).collect();
        let mut heights: Vec<f64> = edges.iter().flat_map(|s| [s.a.y, s.b.y]).collect();
        heights.par_sort_unstable_by(f64::total_cmp);
        heights.dedup();
        let leaves = heights.len().next_power_of_two();
        let at = |y: f64| heights.partition_point(|h| *h < y);
        let mut placed: Vec<(u32, f64, u32)> = Vec::new();
        for (number, edge) in (0u32..).zip(&edges) {
            let (mut from, mut to) = (at(edge.a.y) + leaves, at(edge.b.y) + leaves);
            let mut width = 1;
            // The strips that the edge crosses from side to side, from narrow ones to wide ones.
            let mut place = |strip: usize, width: usize| {
                let first = strip * width - leaves;
                let last = (first + width).min(heights.len() - 1);
                let middle = heights[first].midpoint(heights[last]);
                placed.push((strip as u32, x_at(edge, middle), number));
            };
            while from < to {
                if from & 1 == 1 {
                    place(from, width);
                    from += 1;
                }
                if to & 1 == 1 {
                    to -= 1;
                    place(to, width);
                }
                (from, to, width) = (from / 2, to / 2, width * 2);
            }
        }
        placed.par_sort_unstable_by(|a, b| a.0.cmp(&b.0).then(a.1.total_cmp(&b.1)).then(a.2.cmp(&b.2)));
        let mut starts = vec![0u32; 2 * leaves + 1];
        placed.iter().for_each(|(strip, ..)| starts[*strip as usize + 1] += 1);
        (0..2 * leaves).for_each(|k| starts[k + 1] += starts[k]);
        let mut order: Vec<u32> = placed.into_iter().map(|(.., number)| number).collect();
        for strip in starts.windows(2) {
            settle(&mut order[strip[0] as usize..strip[1] as usize], &edges);
        }
        Self { edges, heights, starts, order }
    }

    /// Whether a position lies inside. On the border it counts as inside where the interior is to the east of it.
    pub(super) fn contains(&self, p: DVec2) -> bool {
        let below = self.heights.partition_point(|h| *h <= p.y);
        if below == 0 || below == self.heights.len() {
            return false;
        }
        let mut strip = self.heights.len().next_power_of_two() + below - 1;
        let mut crossed = 0;
        while strip > 0 {
            let edges = &self.order[self.starts[strip] as usize..self.starts[strip + 1] as usize];
            crossed += edges.len() - edges.partition_point(|&e| !is_west(p, &self.edges[e as usize]));
            strip /= 2;
        }
        crossed % 2 == 1
    }
}

/// Puts edges that are in order up to rounding in order.
fn settle(numbers: &mut [u32], edges: &[Segment]) {
    for end in 1..numbers.len() {
        let mut at = end;
        while at > 0 && by_place(&edges[numbers[at - 1] as usize], &edges[numbers[at] as usize]).is_gt() {
            numbers.swap(at - 1, at);
            at -= 1;
        }
    }
}

/// The order from west to east of two edges that have heights in common and do not cross.
pub(super) fn by_place(s: &Segment, t: &Segment) -> Ordering {
    // The higher one of the lower ends is at a height of both edges, and so is the lower one of the upper ends.
    let of = |edge: &Segment, p: DVec2| side(edge, p).total_cmp(&0.0).reverse();
    let low = if s.a.y >= t.a.y { of(t, s.a) } else { of(s, t.a).reverse() };
    let high = || if s.b.y <= t.b.y { of(t, s.b) } else { of(s, t.b).reverse() };
    low.then_with(high)
}

/// Above zero if the position lies to the west of an upward edge, below zero if to the east. The sign is exact.
fn side(edge: &Segment, p: DVec2) -> f64 {
    let coord = |p: DVec2| robust::Coord { x: p.x, y: p.y };
    // Adding zero makes no negative zero.
    orient2d(coord(edge.a), coord(edge.b), coord(p)) + 0.0
}

pub(super) fn is_west(p: DVec2, edge: &Segment) -> bool {
    side(edge, p) > 0.0
}

/// Where an edge is at a height, up to rounding.
fn x_at(edge: &Segment, y: f64) -> f64 {
    let share = (y - edge.a.y) / (edge.b.y - edge.a.y);
    edge.a.x + share * (edge.b.x - edge.a.x)
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use super::*;

    fn edges(ring: &[DVec2]) -> Vec<Segment> {
        (0..ring.len()).map(|k| Segment { a: ring[k], b: ring[(k + 1) % ring.len()] }).collect()
    }

    /// The definition: a ray to the east crosses an odd number of edges.
    fn by_counting(edges: &[Segment], p: DVec2) -> bool {
        let crosses = |s: &&Segment| {
            let (low, high) = if s.a.y < s.b.y { (s.a, s.b) } else { (s.b, s.a) };
            low.y <= p.y && p.y < high.y && is_west(p, &Segment { a: low, b: high })
        };
        edges.iter().filter(crosses).count() % 2 == 1
    }

    fn star(count: u32, inner: f64, outer: f64, centre: DVec2) -> Vec<DVec2> {
        let radius = |k: u32| if k.is_multiple_of(2) { outer } else { inner };
        (0..count).map(|k| centre + radius(k) * DVec2::from_angle(TAU * f64::from(k) / f64::from(count))).collect()
    }

    #[test]
    fn rays_are_counted_at_and_beside_corners_and_edges() {
        for (count, inner, outer) in [(4, 1.0, 1.0), (7, 1.0, 1.0), (60, 0.1, 1.0), (501, 0.9, 1.0), (64, 1e-9, 1.0)] {
            for centre in [DVec2::ZERO, DVec2::new(5e5, 4e6)] {
                let ring = edges(&star(count, inner, outer, centre));
                let inside = Inside::new(ring.iter().copied());
                let steps = [-1.1, -0.5, 0.0, 1e-9, 0.3, 0.95];
                let around = steps.iter().flat_map(|x| steps.iter().map(move |y| centre + DVec2::new(*x, *y)));
                let on = ring.iter().flat_map(|s| [s.a, s.a.midpoint(s.b), DVec2::new(s.a.x, s.b.y)]);
                for p in around.chain(on) {
                    assert_eq!(inside.contains(p), by_counting(&ring, p), "{p} {count} {inner}");
                }
            }
        }
    }

    #[test]
    fn holes_and_shared_edges_count_each() {
        let square = |from: f64, to: f64| {
            edges(&[(from, from), (to, from), (to, to), (from, to)].map(|(x, y)| DVec2::new(x, y)))
        };
        let all: Vec<Segment> = [square(0.0, 9.0), square(3.0, 6.0), square(9.0, 12.0)].concat();
        let inside = Inside::new(all.iter().copied());
        for (x, y, expected) in
            [(1.0, 4.0, true), (4.0, 4.0, false), (7.0, 4.0, true), (9.5, 9.5, true), (8.0, 9.5, false)]
        {
            assert_eq!(inside.contains(DVec2::new(x, y)), expected, "{x} {y}");
        }
        assert!(!inside.contains(DVec2::NAN));
        assert!(!Inside::new(std::iter::empty()).contains(DVec2::ZERO));
    }

    #[test]
    fn many_spikes_are_kept_in_few_strips() {
        let count = 20_000;
        let inside = Inside::new(edges(&star(count, 0.5, 1.0, DVec2::ZERO)).into_iter());
        assert!(inside.order.len() < 40 * count as usize, "{}", inside.order.len());
    }
}
