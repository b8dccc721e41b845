//! Heights along streams.
//!
//! The network is divided into stems. A stem follows the longest way upstream from an outlet to a source; the other
//! streams that meet it begin stems of their own. Stems get their heights one after the other, from the outlets up. A
//! stem has exact heights where it crosses contours and water, and where it meets a stem that has heights already.
//! Between them, a monotone cubic curve gives its heights (Fritsch and Carlson 1980, SIAM J. Numer. Anal. 17).

use glam::DVec2;

use super::descend::{Piece, Vertex};
use crate::base::Sure;
use crate::subdomains::Band;

/// A piece of the network with its nodes, if it begins and ends there.
pub(super) struct Edge {
    pub piece: Piece,
    pub nodes: [Option<usize>; 2],
    /// Heights of its ends where nothing else gives them, metres, and the bands in which they lie.
    pub guesses: [f64; 2],
    pub bands: [Band; 2],
}

impl Edge {
    fn length(&self) -> f64 {
        self.piece.vertices.windows(2).map(|w| w[0].place.distance(w[1].place)).sum()
    }
}

/// Heights of the vertices of each edge, and the Strahler order of each.
pub(super) struct Profiles {
    pub heights: Vec<Vec<f64>>,
    pub sure: Vec<Vec<Sure>>,
    pub orders: Vec<u32>,
    /// The edges, each after those that flow into it.
    pub downstream: Vec<usize>,
}

/// The heights of all vertices. They never rise downstream.
///
/// Between knots that are further apart than `reach`, heights are guessed, map units.
pub(super) fn profiles(edges: &[Edge], nodes: usize, reach: f64) -> Profiles {
    let mut into: Vec<Vec<usize>> = vec![Vec::new(); nodes];
    let mut out_of: Vec<Vec<usize>> = vec![Vec::new(); nodes];
    for (e, edge) in edges.iter().enumerate() {
        if let Some(node) = edge.nodes[0] {
            out_of[node].push(e);
        }
        if let Some(node) = edge.nodes[1] {
            into[node].push(e);
        }
    }
    let order = downstream_order(edges, &into, &out_of);
    let mut upstream = vec![0.0f64; edges.len()];
    let mut orders = vec![1u32; edges.len()];
    for &e in &order {
        let above: &[usize] = edges[e].nodes[0].map_or(&[], |node| &into[node]);
        let longest = above.iter().map(|&a| upstream[a]).fold(0.0, f64::max);
        upstream[e] = longest + edges[e].length();
        if let Some(most) = above.iter().map(|&a| orders[a]).max() {
            orders[e] = most + u32::from(above.iter().filter(|&&a| orders[a] == most).count() > 1);
        }
    }
    // The edge that goes on upstream and the one that goes on downstream at each node.
    let main = |all: &[usize]| all.iter().copied().reduce(|a, b| if upstream[b] > upstream[a] { b } else { a });
    let stem_of = stems(edges, &order, &|node| main(&into[node]), &|node| main(&out_of[node]));
    let mut heights: Vec<Vec<f64>> = edges.iter().map(|e| vec![f64::NAN; e.piece.vertices.len()]).collect();
    let mut sure: Vec<Vec<Sure>> = edges.iter().map(|e| vec![Sure::Guessed; e.piece.vertices.len()]).collect();
    let mut node_heights = vec![(f64::NAN, Sure::Guessed); nodes];
    for stem in stem_of {
        solve(edges, &stem, reach, &mut node_heights, (&mut heights, &mut sure));
    }
    Profiles { heights, sure, orders, downstream: order }
}

/// The edges, each after those above it. Edges in a circle come last.
fn downstream_order(edges: &[Edge], into: &[Vec<usize>], out_of: &[Vec<usize>]) -> Vec<usize> {
    let above = |e: usize| edges[e].nodes[0].map_or(0, |node| into[node].len());
    let mut waiting: Vec<usize> = (0..edges.len()).map(above).collect();
    let mut order: Vec<usize> = (0..edges.len()).filter(|&e| waiting[e] == 0).collect();
    let mut next = 0;
    let mut done = vec![false; edges.len()];
    while let Some(&e) = order.get(next) {
        next += 1;
        done[e] = true;
        for &below in edges[e].nodes[1].map_or(&[][..], |node| &out_of[node]) {
            waiting[below] -= 1;
            if waiting[below] == 0 {
                order.push(below);
            }
        }
    }
    order.extend((0..edges.len()).filter(|&e| !done[e]));
    order
}

/// The stems, each as its edges downstream. A stem comes after the one that it flows into.
fn stems(
    edges: &[Edge],
    order: &[usize],
    main_in: &dyn Fn(usize) -> Option<usize>,
    main_out: &dyn Fn(usize) -> Option<usize>,
) -> Vec<Vec<usize>> {
    let goes_on = |e: usize| {
        let node = edges[e].nodes[1]?;
        main_out(node).filter(|_| main_in(node) == Some(e))
    };
    let mut taken = vec![false; edges.len()];
    let mut found = Vec::new();
    // From below: the edge at the lower end of a stem comes first.
    for &last in order.iter().rev() {
        if taken[last] || goes_on(last).is_some_and(|below| !taken[below]) {
            continue;
        }
        let mut stem = Vec::new();
        let mut at = Some(last);
        while let Some(e) = at.filter(|&e| !std::mem::replace(&mut taken[e], true)) {
            stem.push(e);
            at = edges[e].nodes[0].filter(|&node| main_out(node) == Some(e)).and_then(main_in);
        }
        stem.reverse();
        found.push(stem);
    }
    // Edges in a circle.
    found.extend(taken.iter().enumerate().filter(|(_, taken)| !**taken).map(|(e, _)| vec![e]));
    found
}

/// Heights along one stem.
fn solve(
    edges: &[Edge],
    stem: &[usize],
    reach: f64,
    node_heights: &mut [(f64, Sure)],
    (heights, sure): (&mut [Vec<f64>], &mut [Vec<Sure>]),
) {
    let (Some(&first), Some(&last)) = (stem.first(), stem.last()) else { return };
    // Distance and height of each vertex whose height is known.
    let mut knots: Vec<(f64, f64)> = Vec::new();
    let mut walked = 0.0;
    let mut at: Vec<Vec<f64>> = Vec::with_capacity(stem.len());
    for &e in stem {
        let mut own = Vec::with_capacity(edges[e].piece.vertices.len());
        let mut before: Option<DVec2> = None;
        for Vertex { place, height, .. } in &edges[e].piece.vertices {
            walked += before.map_or(0.0, |b: DVec2| b.distance(*place));
            before = Some(*place);
            own.push(walked);
            knots.extend(height.map(|z| (walked, z)));
        }
        at.push(own);
    }
    // Known heights must not rise. Those of contours never do here. Those of two lakes may: then the upper lake counts.
    let mut least = f64::INFINITY;
    knots.retain(|&(_, z)| {
        let falls = z <= least;
        least = if falls { z } else { least };
        falls
    });
    let known = |node: Option<usize>| node.map(|n| node_heights[n]).filter(|(z, _)| z.is_finite());
    let inside = |z: f64, band: Band| if z.is_finite() { band.strictly_inside(z) } else { band.lo.midpoint(band.hi) };
    // How much longer the gap at either end counts. What is known on one side only reaches half as far. A guess that would
    // rise from it tells nothing.
    let factor = |sure: Sure, rises: bool| match sure {
        Sure::Guessed if rises => f64::INFINITY,
        Sure::Guessed => 2.0,
        _ => 1.0,
    };
    let mut factors = [1.0; 2];
    if knots.last().is_none_or(|&(s, _)| s < walked) {
        let edge = &edges[last];
        let highest = knots.last().map_or(f64::INFINITY, |k| k.1);
        let (z, sure) = known(edge.nodes[1]).unwrap_or((inside(edge.guesses[1], edge.bands[1]), Sure::Guessed));
        knots.push((walked, z.min(highest)));
        factors[1] = factor(sure, z >= highest);
    }
    if knots.first().is_none_or(|&(s, _)| s > 0.0) {
        let edge = &edges[first];
        let lowest = knots.first().map_or(f64::NEG_INFINITY, |k| k.1);
        let (z, sure) = known(edge.nodes[0]).unwrap_or((inside(edge.guesses[0], edge.bands[0]), Sure::Guessed));
        knots.insert(0, (0.0, z.max(lowest)));
        factors[0] = factor(sure, z <= lowest);
    }
    let curve = Monotone::new(&knots);
    let sure_at = |s: f64| {
        let after = knots.partition_point(|k| k.0 <= s).clamp(1, knots.len() - 1);
        let at_ends = [after == 1, after + 1 == knots.len()];
        let of_ends = factors.iter().zip(at_ends).filter(|(_, at_end)| *at_end).map(|(factor, _)| factor);
        let gap = (knots[after].0 - knots[after - 1].0) * of_ends.product::<f64>();
        let is_open = at_ends == [true; 2] && factors.iter().all(|factor| *factor > 1.0);
        if gap <= reach && !is_open { Sure::Between } else { Sure::Guessed }
    };
    for (&e, at) in stem.iter().zip(&at) {
        heights[e] = at.iter().map(|&s| curve.at(s)).collect();
        // Rounding must not make the line rise.
        let mut highest = f64::INFINITY;
        for z in &mut heights[e] {
            *z = z.min(highest);
            highest = *z;
        }
        let vertices = edges[e].piece.vertices.iter().zip(at);
        let sure_of =
            |((v, &s), &z): ((&Vertex, &f64), &f64)| if v.height == Some(z) { Sure::Exact } else { sure_at(s) };
        sure[e] = vertices.zip(&heights[e]).map(sure_of).collect();
        let ends = [(heights[e].first(), sure[e].first()), (heights[e].last(), sure[e].last())];
        for (node, end) in edges[e].nodes.into_iter().zip(ends) {
            if let (Some(node), (Some(&z), Some(&sure))) = (node, end) {
                node_heights[node] = (z, sure);
            }
        }
    }
}

/// A curve through knots that falls, or stays level, from each to the next.
struct Monotone<'a> {
    knots: &'a [(f64, f64)],
    slopes: Vec<f64>,
}

impl<'a> Monotone<'a> {
    /// `knots` are distances, ascending, with heights that never rise.
    fn new(knots: &'a [(f64, f64)]) -> Self {
        let secant = |k: usize| {
            let ((s0, z0), (s1, z1)) = (knots[k], knots[k + 1]);
            if s1 > s0 { (z1 - z0) / (s1 - s0) } else { 0.0 }
        };
        let count = knots.len();
        let slopes = (0..count)
            .map(|k| match k {
                _ if count < 2 => 0.0,
                0 => secant(0),
                k if k + 1 == count => secant(k - 1),
                k => {
                    let (before, after) = (secant(k - 1), secant(k));
                    let (h0, h1) = (knots[k].0 - knots[k - 1].0, knots[k + 1].0 - knots[k].0);
                    if before * after <= 0.0 {
                        return 0.0;
                    }
                    // The weighted harmonic mean keeps the curve monotone (Fritsch and Butland 1984).
                    let (w0, w1) = (2.0 * h1 + h0, h1 + 2.0 * h0);
                    (w0 + w1) / (w0 / before + w1 / after)
                }
            })
            .collect();
        Self { knots, slopes }
    }

    fn at(&self, s: f64) -> f64 {
        let after = self.knots.partition_point(|k| k.0 <= s);
        if after == 0 || after == self.knots.len() {
            return self.knots[after.saturating_sub(1)].1;
        }
        let ((s0, z0), (s1, z1)) = (self.knots[after - 1], self.knots[after]);
        let h = s1 - s0;
        let t = (s - s0) / h;
        let (t2, t3) = (t * t, t * t * t);
        let (m0, m1) = (self.slopes[after - 1] * h, self.slopes[after] * h);
        let z =
            (2.0 * t3 - 3.0 * t2 + 1.0) * z0 + (t3 - 2.0 * t2 + t) * m0 + (3.0 * t2 - 2.0 * t3) * z1 + (t3 - t2) * m1;
        z.clamp(z1, z0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_curve_meets_its_knots_and_never_rises() {
        let knots = [(0.0, 50.0), (10.0, 40.0), (12.0, 30.0), (40.0, 20.0), (41.0, 20.0), (90.0, 10.0)];
        let curve = Monotone::new(&knots);
        for (s, z) in knots {
            assert_eq!(curve.at(s), z);
        }
        let heights: Vec<f64> = (0..=900).map(|k| curve.at(f64::from(k) / 10.0)).collect();
        assert!(heights.windows(2).all(|w| w[1] <= w[0]));
        // It is no chain of straight pieces.
        assert!((curve.at(26.0) - 25.0).abs() > 0.5);
    }

    #[test]
    fn an_end_whose_guess_would_rise_is_not_sure() {
        // From the contour of 200 m on, 30 map units to the end of the stream.
        let sure_at_end = |guess: f64| {
            let vertex = |x: f64, height| Vertex { place: DVec2::new(x, 0.0), height, region: 0 };
            let vertices =
                vec![vertex(0.0, Some(400.0)), vertex(20.0, Some(200.0)), vertex(35.0, None), vertex(50.0, None)];
            let piece = Piece { vertices, ..Piece::default() };
            let band = Band { lo: 100.0, hi: 1000.0 };
            let edge = Edge { piece, nodes: [None; 2], guesses: [f64::NAN, guess], bands: [band; 2] };
            let Profiles { heights, sure, .. } = profiles(&[edge], 0, 100.0);
            assert!(heights[0].is_sorted_by(|a, b| a >= b), "{heights:?}");
            sure[0][3]
        };
        assert_eq!([130.0, 200.0, 230.0].map(sure_at_end), [Sure::Between, Sure::Guessed, Sure::Guessed]);
    }
}
