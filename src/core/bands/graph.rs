//! Lines as chains between common vertices, and the walks along them around the plane.
//!
//! A chain has two sides, and each side belongs to one walk. A walk keeps the ground on its left. At a vertex it takes the
//! next chain clockwise from the one it came along, so it never crosses another.

use std::cmp::Ordering;
use std::collections::{HashMap, HashSet};

use glam::DVec2;
use rayon::prelude::*;
use robust::{Coord, orient2d};

use crate::base::bits::bits;

/// What is known about the ground on one side of a chain, or all around an area.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Side {
    /// The levels that it lies between, metres; `from` is above `to` where none is known.
    pub from: f64,
    pub to: f64,
    /// Whether lines disagree about these levels.
    pub is_mixed: bool,
    /// Whether it is outside the frame.
    pub is_outside: bool,
    /// Number of the water that covers it.
    pub water: Option<u32>,
}

impl Side {
    /// Nothing is known.
    pub const NOTHING: Self =
        Self { from: f64::INFINITY, to: f64::NEG_INFINITY, is_mixed: false, is_outside: false, water: None };

    /// Ground between two levels.
    pub fn between(from: f64, to: f64) -> Self {
        Self { from, to, ..Self::NOTHING }
    }

    /// What both know together.
    pub fn and(self, other: Self) -> Self {
        // Feet that became metres differ by rounding.
        let differ = |a: f64, b: f64| a != b && (a - b).abs() > 1e-9 * a.abs().max(1.0);
        let both_known = self.from <= self.to && other.from <= other.to;
        Self {
            from: self.from.min(other.from),
            to: self.to.max(other.to),
            is_mixed: self.is_mixed
                || other.is_mixed
                || (both_known && (differ(self.from, other.from) || differ(self.to, other.to))),
            is_outside: self.is_outside || other.is_outside,
            water: self.water.or(other.water),
        }
    }
}

/// A line with what is known on its left and on its right. The first point of a closed one is repeated.
pub(super) struct Piece {
    pub points: Vec<DVec2>,
    pub sides: [Side; 2],
    /// The level, metres, of a contour.
    pub level: Option<f64>,
}

/// A part of a line between two vertices that it has in common with others.
struct Chain {
    points: Vec<DVec2>,
    sides: [Side; 2],
    level: Option<f64>,
    ends: [u32; 2],
}

/// Chains and the walks along them. Step `2 c` follows chain `c`, step `2 c + 1` follows it backwards.
pub(super) struct Graph {
    chains: Vec<Chain>,
    nodes: usize,
    /// The step after each step.
    next: Vec<u32>,
}

impl Graph {
    /// Cuts lines into chains. Lines meet in common vertices only, or run along each other from vertex to vertex.
    pub fn new(mut pieces: Vec<Piece>) -> Self {
        pieces.par_iter_mut().for_each(|piece| piece.points.dedup());
        pieces.retain(|piece| piece.points.len() > 1);
        let shared = shared(&pieces);
        let mut graph = Self { chains: Vec::new(), nodes: 0, next: Vec::new() };
        let mut numbers: HashMap<[u64; 2], u32> = HashMap::new();
        // Chains of one segment by their ends: lines along each other consist of such chains.
        let mut segments: HashMap<[u32; 2], usize> = HashMap::new();
        for piece in pieces {
            for points in split(piece.points, &shared) {
                let ends = [points[0], points[points.len() - 1]].map(|p| {
                    let count = numbers.len() as u32;
                    *numbers.entry(bits(p)).or_insert(count)
                });
                let chain = Chain { ends, points, sides: piece.sides, level: piece.level };
                if chain.points.len() > 2 {
                    graph.chains.push(chain);
                    continue;
                }
                match segments.entry([ends[0].min(ends[1]), ends[0].max(ends[1])]) {
                    std::collections::hash_map::Entry::Occupied(at) => graph.chains[*at.get()].unite(&chain),
                    std::collections::hash_map::Entry::Vacant(at) => {
                        at.insert(graph.chains.len());
                        graph.chains.push(chain);
                    }
                }
            }
        }
        graph.nodes = numbers.len();
        graph.connect();
        graph
    }

    /// Number of vertices at which chains end.
    pub fn nodes(&self) -> usize {
        self.nodes
    }

    /// Number of steps.
    pub fn steps(&self) -> usize {
        self.next.len()
    }

    /// The node that a step begins at.
    pub fn start(&self, step: usize) -> u32 {
        self.chains[step / 2].ends[step % 2]
    }

    /// The node that a step ends at.
    pub fn end(&self, step: usize) -> u32 {
        self.start(step ^ 1)
    }

    /// What is known on the left of a step.
    pub fn left(&self, step: usize) -> Side {
        self.chains[step / 2].sides[step % 2]
    }

    /// The points of each chain.
    pub fn courses(&self) -> impl Iterator<Item = &[DVec2]> {
        self.chains.iter().map(|chain| chain.points.as_slice())
    }

    /// Appends the points of a step but the last.
    pub fn append(&self, step: usize, ring: &mut Vec<DVec2>) {
        let points = &self.chains[step / 2].points;
        let most = points.len() - 1;
        match step % 2 {
            0 => ring.extend(&points[..most]),
            _ => ring.extend(points[1..].iter().rev()),
        }
    }

    /// The walks, and the number of the walk that each step belongs to.
    pub fn walks(&self) -> (Vec<Vec<usize>>, Vec<u32>) {
        let mut of_step = vec![u32::MAX; self.steps()];
        let mut walks: Vec<Vec<usize>> = Vec::new();
        for first in 0..self.steps() {
            if of_step[first] != u32::MAX {
                continue;
            }
            let (mut step, mut walk) = (first, Vec::new());
            while of_step[step] == u32::MAX {
                of_step[step] = walks.len() as u32;
                walk.push(step);
                step = self.next[step] as usize;
            }
            walks.push(walk);
        }
        (walks, of_step)
    }

    /// Takes out the chains with one walk on both sides, which part nothing. Returns an open end or another vertex of each
    /// that is a contour, with its level, metres.
    pub fn remove_bridges(&mut self) -> Vec<(DVec2, f64)> {
        let (_, of_step) = self.walks();
        let is_bridge = |c: usize| of_step[2 * c] == of_step[2 * c + 1];
        let mut ends = vec![0u32; self.nodes];
        self.chains.iter().flat_map(|chain| chain.ends).for_each(|node| ends[node as usize] += 1);
        let mut removed = Vec::new();
        let mut number = 0;
        self.chains.retain(|chain| {
            number += 1;
            if is_bridge(number - 1) {
                let free = usize::from(ends[chain.ends[1] as usize] == 1) * (chain.points.len() - 1);
                removed.extend(chain.level.map(|level| (chain.points[free], level)));
            }
            !is_bridge(number - 1)
        });
        if number > self.chains.len() {
            self.connect();
        }
        removed
    }

    /// Finds the step after each step.
    fn connect(&mut self) {
        let steps = 2 * self.chains.len();
        let mut leaving: Vec<u32> = (0..steps as u32).collect();
        let ahead = |step: u32| {
            let points = &self.chains[step as usize / 2].points;
            if step.is_multiple_of(2) {
                [points[0], points[1]]
            } else {
                [points[points.len() - 1], points[points.len() - 2]]
            }
        };
        leaving.par_sort_unstable_by(|&a, &b| {
            let by_node = self.start(a as usize).cmp(&self.start(b as usize));
            by_node.then_with(|| by_direction(ahead(a), ahead(b))).then(a.cmp(&b))
        });
        let mut next = vec![0; steps];
        for around in leaving.chunk_by(|&a, &b| self.start(a as usize) == self.start(b as usize)) {
            for (k, &step) in around.iter().enumerate() {
                // The step that arrives is the same chain backwards.
                next[step as usize ^ 1] = around[(k + around.len() - 1) % around.len()];
            }
        }
        self.next = next;
    }
}

impl Chain {
    /// Takes over what another chain along the same segment knows.
    fn unite(&mut self, other: &Self) {
        let [left, right] = if self.ends == other.ends { other.sides } else { [other.sides[1], other.sides[0]] };
        // Where two polygons of the frame meet, both sides are inside.
        let is_inner =
            |mine: Side, others: Side, across: Side| mine.is_outside && across.is_outside && !others.is_outside;
        let inner = is_inner(self.sides[0], left, right) || is_inner(self.sides[1], right, left);
        self.sides = [self.sides[0].and(left), self.sides[1].and(right)];
        if inner {
            self.sides.iter_mut().for_each(|side| side.is_outside = false);
        }
        self.level = self.level.or(other.level);
    }
}

/// The vertices that occur more than once, in different lines or in one.
fn shared(pieces: &[Piece]) -> HashSet<[u64; 2]> {
    let own = |piece: &Piece| {
        let is_closed = piece.points.first() == piece.points.last();
        piece.points.len() - usize::from(is_closed)
    };
    let mut all: Vec<[u64; 2]> =
        pieces.par_iter().flat_map_iter(|piece| piece.points[..own(piece)].iter().map(|&p| bits(p))).collect();
    all.par_sort_unstable();
    all.windows(2).filter(|pair| pair[0] == pair[1]).map(|pair| pair[0]).collect()
}

/// A line in parts that end at its shared vertices. A ring begins at one of them, if it has any.
fn split(mut points: Vec<DVec2>, shared: &HashSet<[u64; 2]>) -> Vec<Vec<DVec2>> {
    let is_shared = |p: &DVec2| shared.contains(&bits(*p));
    if points.first() == points.last()
        && let Some(first) = points.iter().position(is_shared)
    {
        points.pop();
        points.rotate_left(first);
        points.push(points[0]);
    }
    let last = points.len() - 1;
    let stops: Vec<usize> = (1..last).filter(|&k| is_shared(&points[k])).chain([last]).collect();
    if stops.len() == 1 {
        return vec![points];
    }
    let mut from = 0;
    let part = |to: usize| points[std::mem::replace(&mut from, to)..=to].to_vec();
    stops.into_iter().map(part).collect()
}

/// The order counter-clockwise from the direction of x of two segments that begin at the same vertex. It is exact.
fn by_direction([vertex, a]: [DVec2; 2], [_, b]: [DVec2; 2]) -> Ordering {
    let is_lower = |p: DVec2| p.y < vertex.y || (p.y == vertex.y && p.x < vertex.x);
    let coord = |p: DVec2| Coord { x: p.x, y: p.y };
    let turn = || orient2d(coord(vertex), coord(b), coord(a)) + 0.0;
    is_lower(a).cmp(&is_lower(b)).then_with(|| turn().total_cmp(&0.0))
}
