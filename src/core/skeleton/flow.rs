//! The direction in which ridge and canyon lines fall, and heights that fall that way.
//!
//! Equation (1) gives each point a height from the nearest contours. A canyon line then gets bumps wherever its walls
//! come closer or draw apart: a gully becomes a string of pits and dams. But between two contours, water runs from the
//! tips of the upper contour's bends to the lower contour. The rule:
//!
//! 1. A *network* is a connected set of pieces of one sub-domain and one level. In a canyon its *outlets* are the
//!    vertices of the lower contour that it reaches. If there are none, its outlets are the hollows. These are the
//!    lowest point, and each other low point that lies deeper than a share of the band below the pass to a deeper one.
//! 2. The network is flooded from its outlets, the lowest reachable point first (priority flood). Every piece falls
//!    from the point reached later to the point reached earlier. Two floods meet at a *saddle*, the highest point
//!    between two outlets.
//! 3. A point's new height is the mean of two: the highest of its own and all below it on the way down, and the lowest
//!    of its own and all above it. Neither ever rises on the way down, so their mean does not. Points that were in
//!    order keep the height of equation (1).
//! 4. Where this leaves level stretches, they become ramps by distance. A ramp lies between the heights half way to the
//!    next points above and below. Then every piece falls.
//!
//! A ridge is the same upside down. Within one band it rises steadily from the tips of the lower contour to the upper
//! contour, and a saddle is its lowest point between two of them. On a top the outlets are the peaks. No height leaves
//! the open interval between the network's level and the next.

use std::collections::{BinaryHeap, HashMap};

use glam::DVec2;

use super::pieces::{Axis, AxisPoint, End};
use crate::base::rows::Rows;
use crate::base::union_find::UnionFind;
use crate::subdomains::{Regions, Side};
use crate::tin::{NONE, Tin};
use crate::tuning::SkeletonTuning;

/// Slope of a level stretch of a line without a point above or below, as a share of the way to the edge of the
/// band.
const PLATEAU_SPREAD: f64 = 0.01;

/// How the pieces of an axis fall.
#[derive(Debug, Clone, Default)]
pub struct Flow {
    /// Height of each axis point, metres; NaN where the input is.
    pub heights: Vec<f64>,
    /// By axis point: its number in the order of the flood from the outlets. Pieces fall from a higher number to a
    /// lower one.
    pub flood_number: Vec<u32>,
    /// By axis point: length of the longest way upstream to a source (a tip or a saddle), map units.
    pub upstream: Vec<f64>,
    /// By axis point: length of the longest way downstream to an outlet, map units.
    pub downstream: Vec<f64>,
    /// Number of points whose height was changed.
    pub moved: usize,
    /// The largest change, metres.
    pub most_moved: f64,
}

/// Gives all pieces a direction, and makes heights fall along them. `heights` are those of equation (1), one per axis
/// point.
pub fn flow(tin: &Tin, regions: &Regions, axis: &Axis, heights: Vec<f64>, tuning: &SkeletonTuning) -> Flow {
    let count = axis.points.len();
    let graph = Graph {
        tin,
        axis,
        tuning,
        pieces_at: Rows::new(count, || {
            let ends = axis.pieces.iter().enumerate();
            ends.flat_map(|(id, piece)| {
                piece.iter().filter_map(move |end| match end {
                    End::Axis(p) => Some((*p as usize, id as u32)),
                    End::Vertex(_) => None,
                })
            })
        }),
    };
    let mut flow = Flow {
        heights: heights.clone(),
        flood_number: vec![NONE; count],
        upstream: vec![0.0; count],
        downstream: vec![0.0; count],
        ..Flow::default()
    };
    let mut seen = vec![false; count];
    for first in 0..count as u32 {
        if seen[first as usize] || graph.pieces_at.of(first as usize).is_empty() {
            continue;
        }
        let members = graph.network(first, &mut seen);
        let network = Network::new(&graph, regions, members, &mut flow);
        let settled = settle(&network, &flow);
        for (k, &p) in network.order.iter().enumerate() {
            flow.heights[p as usize] = network.sign * settled.heights[k];
            flow.upstream[p as usize] = settled.upstream[k];
            flow.downstream[p as usize] = settled.downstream[k];
        }
    }
    for (new, old) in flow.heights.iter().zip(&heights) {
        let by = (new - old).abs();
        flow.moved += usize::from(by > 0.0);
        flow.most_moved = flow.most_moved.max(by);
    }
    flow
}

/// Whether the ground around a line at this level of a sub-domain lies above the level: then the line is a ridge.
pub(super) fn is_ridge(regions: &Regions, region: u32, level: f64) -> bool {
    regions.regions[region as usize].side(level) != Some(Side::Below)
}

/// Axis points and the pieces at each.
struct Graph<'a> {
    tin: &'a Tin,
    axis: &'a Axis,
    tuning: &'a SkeletonTuning,
    pieces_at: Rows<u32>,
}

impl Graph<'_> {
    /// The points connected with `first`.
    fn network(&self, first: u32, seen: &mut [bool]) -> Vec<u32> {
        seen[first as usize] = true;
        let mut members = vec![first];
        let mut next = 0;
        while let Some(&p) = members.get(next) {
            next += 1;
            for (end, _) in self.neighbours(p) {
                if let End::Axis(q) = end
                    && !std::mem::replace(&mut seen[q as usize], true)
                {
                    members.push(q);
                }
            }
        }
        members
    }

    /// The other ends of the pieces at a point, with the lengths of the pieces.
    fn neighbours(&self, p: u32) -> impl Iterator<Item = (End, f64)> + '_ {
        self.pieces_at.of(p as usize).iter().map(move |&id| {
            let [a, b] = self.axis.pieces[id as usize];
            let other = if a == End::Axis(p) { b } else { a };
            (other, self.axis.points[p as usize].position.distance(self.position(other)))
        })
    }

    fn position(&self, end: End) -> DVec2 {
        match end {
            End::Axis(p) => self.axis.points[p as usize].position,
            End::Vertex(v) => self.tin.positions[v as usize],
        }
    }
}

/// The other end of a piece, seen along the flow. Points are given by their flood number.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Neighbour {
    /// A point further down.
    Below(usize),
    /// A point further up.
    Above(usize),
    /// An outlet at this height.
    Outlet(f64),
    /// The tip of a bend: the flow begins at the network's own level.
    Source,
}

/// One network. For a ridge, heights are upside down here: the flow always falls.
struct Network<'a> {
    graph: &'a Graph<'a>,
    /// 1 in a canyon, -1 on a ridge.
    sign: f64,
    /// Ends of the open interval in which the heights lie.
    floor: f64,
    ceiling: f64,
    /// The points in the order of the flood.
    order: Vec<u32>,
}

impl<'a> Network<'a> {
    /// Floods a network from its outlets.
    fn new(graph: &'a Graph<'a>, regions: &Regions, members: Vec<u32>, flow: &mut Flow) -> Self {
        let AxisPoint { region, level, .. } = graph.axis.points[members[0] as usize];
        let level = level.unwrap_or(f64::NAN);
        let ridge = is_ridge(regions, region, level);
        let sign = if ridge { -1.0 } else { 1.0 };
        let band = regions.regions[region as usize].band;
        let floor = if ridge { -band.hi } else { band.lo };
        let mut network = Self { graph, sign, floor, ceiling: sign * level, order: Vec::new() };
        let height = |p: u32, flow: &Flow| sign * flow.heights[p as usize];
        let leads_out =
            |p: &u32| graph.neighbours(*p).any(|(end, _)| network.outlet(end).is_some_and(|out| out.is_finite()));
        let mut roots: Vec<u32> = members.iter().copied().filter(leads_out).collect();
        if roots.is_empty() {
            roots = network.hollows(&members, flow);
        }
        // A member's flood number is set when the point is taken from the heap.
        let mut heap: BinaryHeap<Reached> = BinaryHeap::new();
        let mut number = 0;
        let mut reach = |heap: &mut BinaryHeap<Reached>, point: u32, height: f64| {
            heap.push(Reached { height, number, point });
            number += 1;
        };
        for &p in &roots {
            reach(&mut heap, p, height(p, flow));
        }
        while let Some(Reached { height: reached, point, .. }) = heap.pop() {
            if flow.flood_number[point as usize] != NONE {
                continue;
            }
            flow.flood_number[point as usize] = network.order.len() as u32;
            network.order.push(point);
            for (end, _) in graph.neighbours(point) {
                if let End::Axis(q) = end
                    && flow.flood_number[q as usize] == NONE
                {
                    reach(&mut heap, q, reached.max(height(q, flow)));
                }
            }
        }
        network
    }

    /// The height of an outlet; none for anything else.
    fn outlet(&self, end: End) -> Option<f64> {
        let End::Vertex(v) = end else { return None };
        let height = self.sign * self.graph.tin.heights[v as usize];
        (height != self.ceiling).then_some(height)
    }

    /// The lowest point, and all points deep enough below the pass to a lower one.
    fn hollows(&self, members: &[u32], flow: &Flow) -> Vec<u32> {
        let height = |k: usize| self.sign * flow.heights[members[k] as usize];
        let mut sorted: Vec<usize> = (0..members.len()).collect();
        sorted.sort_by(|&a, &b| height(a).total_cmp(&height(b)).then(a.cmp(&b)));
        let number: HashMap<u32, usize> = members.iter().enumerate().map(|(k, &p)| (p, k)).collect();
        let depth = self.graph.tuning.hollow_depth * (self.ceiling - self.floor);
        // The water rises everywhere at once. The root of each pool is its lowest point.
        let mut pools = UnionFind::new(members.len());
        let mut wet = vec![false; members.len()];
        let mut found = vec![members[sorted[0]]];
        for &k in &sorted {
            wet[k] = true;
            for (end, _) in self.graph.neighbours(members[k]) {
                let End::Axis(q) = end else { continue };
                let other = number[&q];
                if !wet[other] {
                    continue;
                }
                let (a, b) = (pools.root(k), pools.root(other));
                if a == b {
                    continue;
                }
                let lower = |a: usize, b: usize| height(a).total_cmp(&height(b)).then(a.cmp(&b)).is_lt();
                let (deep, shallow) = if lower(a, b) { (a, b) } else { (b, a) };
                if height(k) - height(shallow) > depth {
                    found.push(members[shallow]);
                }
                pools.hang(shallow, deep);
            }
        }
        found
    }

    /// The other ends of the pieces at the point of flood number `k`, with the lengths of the pieces.
    fn directed(&self, k: usize, flood_number: &'a [u32]) -> impl Iterator<Item = (Neighbour, f64)> + '_ {
        self.graph.neighbours(self.order[k]).map(move |(end, length)| {
            let neighbour = match end {
                End::Axis(q) if (flood_number[q as usize] as usize) < k => {
                    Neighbour::Below(flood_number[q as usize] as usize)
                }
                End::Axis(q) => Neighbour::Above(flood_number[q as usize] as usize),
                End::Vertex(_) => self.outlet(end).map_or(Neighbour::Source, Neighbour::Outlet),
            };
            (neighbour, length)
        })
    }
}

/// Lengths along the flow and steady heights of one network, by flood number.
struct Settled {
    upstream: Vec<f64>,
    downstream: Vec<f64>,
    heights: Vec<f64>,
}

fn settle(network: &Network, flow: &Flow) -> Settled {
    let count = network.order.len();
    let flood_number = &flow.flood_number;
    let own: Vec<f64> = network.order.iter().map(|&p| network.sign * flow.heights[p as usize]).collect();
    let (mut downstream, mut upstream) = (vec![0.0f64; count], vec![0.0f64; count]);
    let (mut highest, mut lowest) = (own.clone(), own);
    for k in 0..count {
        for (neighbour, length) in network.directed(k, flood_number) {
            match neighbour {
                Neighbour::Below(j) => {
                    downstream[k] = downstream[k].max(length + downstream[j]);
                    highest[k] = highest[k].max(highest[j]);
                }
                Neighbour::Outlet(_) => downstream[k] = downstream[k].max(length),
                _ => {}
            }
        }
    }
    for k in (0..count).rev() {
        for (neighbour, length) in network.directed(k, flood_number) {
            match neighbour {
                Neighbour::Above(j) => {
                    upstream[k] = upstream[k].max(length + upstream[j]);
                    lowest[k] = lowest[k].min(lowest[j]);
                }
                Neighbour::Source => upstream[k] = upstream[k].max(length),
                _ => {}
            }
        }
    }
    let mut heights: Vec<f64> = highest.iter().zip(&lowest).map(|(a, b)| a.midpoint(*b)).collect();
    // NaN means that no contour borders the sub-domain: there is nothing to put in order.
    if heights.iter().all(|h| h.is_finite()) {
        ramps(network, flood_number, &mut heights);
        for k in 0..count {
            // Rounding may make two points of the ramp level again.
            for (neighbour, _) in network.directed(k, flood_number) {
                if let Neighbour::Below(j) = neighbour
                    && heights[k] <= heights[j]
                {
                    heights[k] = heights[j].next_up();
                }
            }
        }
    }
    Settled { upstream, downstream, heights }
}

/// Turns level stretches into ramps by distance, between the heights half way to the neighbours above and below.
fn ramps(network: &Network, flood_number: &[u32], heights: &mut [f64]) {
    let count = heights.len();
    let level = heights.to_vec();
    let mut seen = vec![false; count];
    let (mut down, mut up) = (vec![0.0f64; count], vec![0.0f64; count]);
    for first in 0..count {
        if std::mem::replace(&mut seen[first], true) {
            continue;
        }
        let height = level[first];
        let mut stretch = vec![first];
        let mut next = 0;
        let (mut above, mut below) = (f64::INFINITY, f64::NEG_INFINITY);
        while let Some(&k) = stretch.get(next) {
            next += 1;
            for (neighbour, _) in network.directed(k, flood_number) {
                match neighbour {
                    Neighbour::Below(j) | Neighbour::Above(j) if level[j] == height => {
                        if !std::mem::replace(&mut seen[j], true) {
                            stretch.push(j);
                        }
                    }
                    Neighbour::Below(j) => below = below.max(level[j]),
                    Neighbour::Above(j) => above = above.min(level[j]),
                    Neighbour::Outlet(out) => below = below.max(out),
                    Neighbour::Source => above = above.min(network.ceiling),
                }
            }
        }
        if stretch.len() < 2 {
            continue;
        }
        let spread = PLATEAU_SPREAD;
        let bottom =
            if below.is_finite() { height.midpoint(below) } else { height - spread * (height - network.floor) };
        let top = if above.is_finite() { height.midpoint(above) } else { height + spread * (network.ceiling - height) };
        stretch.sort_unstable();
        for &k in &stretch {
            for (neighbour, length) in network.directed(k, flood_number) {
                match neighbour {
                    Neighbour::Below(j) if level[j] == height => down[k] = down[k].max(length + down[j]),
                    Neighbour::Below(_) | Neighbour::Outlet(_) => down[k] = down[k].max(length),
                    _ => {}
                }
            }
        }
        for &k in stretch.iter().rev() {
            for (neighbour, length) in network.directed(k, flood_number) {
                match neighbour {
                    Neighbour::Above(j) if level[j] == height => up[k] = up[k].max(length + up[j]),
                    Neighbour::Above(_) | Neighbour::Source => up[k] = up[k].max(length),
                    _ => {}
                }
            }
            let all = down[k] + up[k];
            let share = if all > 0.0 { down[k] / all } else { 0.5 };
            heights[k] = bottom + (top - bottom) * share;
        }
    }
}

/// An entry of the flood's heap: the lowest comes first, then the earlier one.
#[derive(PartialEq)]
struct Reached {
    height: f64,
    number: u32,
    point: u32,
}

impl Eq for Reached {}

impl Ord for Reached {
    fn cmp(&self, other: &Self) -> std::cmp::Ordering {
        other.height.total_cmp(&self.height).then(other.number.cmp(&self.number))
    }
}

impl PartialOrd for Reached {
    fn partial_cmp(&self, other: &Self) -> Option<std::cmp::Ordering> {
        Some(self.cmp(other))
    }
}
