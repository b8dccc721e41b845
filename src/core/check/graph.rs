//! The graph of the sub-domains: its nodes are the sub-domains, its edges the contours between them.
//!
//! Contours do not cross, and they close or end on the frame. So the graph is a tree; barrier edges and lines that
//! touch can add cycles. A contour with the same sub-domain on both sides separates nothing: it ends inside the map.

use std::collections::BTreeMap;

use rayon::prelude::*;

use super::grid::{Label, LevelGrid};
use crate::contour::ContourMap;
use crate::subdomains::{GapEdges, Regions, line_starts, piece_of};
use crate::tin::{NONE, Tin};

/// Sub-domains at the frame with this many barrier edges lie beyond a ragged outline. They border on every level and
/// show nothing.
const RAGGED_BARRIERS: u32 = 8;

/// The part of a line between two given sub-domains.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Stretch {
    /// The contour's number.
    pub line: u32,
    /// Sub-domains on its sides, the smaller number first; [`NONE`] beyond the frame.
    pub sides: [u32; 2],
    /// Length, map units.
    pub length: f64,
    /// Share of the contour's length inside the frame.
    pub share: f64,
}

impl Stretch {
    /// Whether it ends inside the map: the same sub-domain lies on both sides.
    pub fn dangles(&self) -> bool {
        self.sides[0] == self.sides[1]
    }
}

/// Two neighbouring sub-domains and the lines between them.
#[derive(Debug, Clone)]
pub struct Pair {
    /// The sub-domains.
    pub sides: [u32; 2],
    /// Length of their common border, map units.
    pub length: f64,
    /// Labels of the lines, each with the sum over its lines of their share of length here.
    pub labels: Vec<(Label, f64)>,
}

/// The graph of neighbouring sub-domains.
#[derive(Debug, Clone)]
pub struct Graph {
    /// By line, the longest first within a line.
    pub stretches: Vec<Stretch>,
    /// Pairs of sub-domains that a contour separates, by their numbers.
    pub pairs: Vec<Pair>,
    /// By sub-domain: labels of lines that have it on one side only (beyond is the frame or a ragged outline), with
    /// shares.
    pub one_sided: Vec<Vec<(Label, f64)>>,
    /// By sub-domain: labels of lines that end inside it, with shares.
    pub dangling: Vec<Vec<(Label, f64)>>,
    /// By sub-domain: whether it lies beyond a ragged outline.
    pub ragged: Vec<bool>,
}

impl Graph {
    /// Collects the borders of all sub-domains.
    pub fn new(map: &ContourMap, tin: &Tin, regions: &Regions, gaps: &GapEdges, grid: &LevelGrid) -> Self {
        let count = regions.regions.len();
        let stretches = stretches(map, tin, regions);
        let (explained, ragged) = barriers(tin, regions, gaps, grid);
        let label = |s: &Stretch| grid.label(map.contours[s.line as usize].elevation);
        let mut one_sided = vec![Vec::new(); count];
        let mut dangling = explained;
        let mut pairs: BTreeMap<[u32; 2], Pair> = BTreeMap::new();
        for s in &stretches {
            let [a, b] = s.sides;
            let outside = |r: u32| r == NONE || ragged[r as usize];
            let item = (label(s), s.share);
            match (outside(a), outside(b)) {
                (true, true) => {}
                (false, true) => add(&mut one_sided[a as usize], item),
                (true, false) => add(&mut one_sided[b as usize], item),
                (false, false) if s.dangles() => add(&mut dangling[a as usize], item),
                (false, false) => {
                    let new = || Pair { sides: s.sides, length: 0.0, labels: Vec::new() };
                    let pair = pairs.entry(s.sides).or_insert_with(new);
                    pair.length += s.length;
                    add(&mut pair.labels, item);
                }
            }
        }
        let pairs = pairs.into_values().collect();
        Self { stretches, pairs, one_sided, dangling, ragged }
    }
}

fn add(labels: &mut Vec<(Label, f64)>, (label, share): (Label, f64)) {
    match labels.iter_mut().find(|(l, _)| *l == label) {
        Some((_, sum)) => *sum += share,
        None => labels.push((label, share)),
    }
}

fn stretches(map: &ContourMap, tin: &Tin, regions: &Regions) -> Vec<Stretch> {
    let start = line_starts(map);
    let mut pieces: Vec<(u32, [u32; 2], u32, f64)> = tin.flat_map_inside(|t| {
        let start = &start;
        (0..3).filter_map(move |i| {
            tin.contour_level(t, i)?;
            let other = tin.inner_neighbour(t, i);
            if other.is_some_and(|n| n < t) {
                return None;
            }
            let [u, v] = tin.edge(t, i);
            let (line, _) = piece_of(map, tin, start, u, v)?;
            let (a, b) = (regions.of_triangle[t as usize], other.map_or(NONE, |n| regions.of_triangle[n as usize]));
            Some((line, [a.min(b), a.max(b)], t, tin.edge_length(t, i)))
        })
    });
    pieces.par_sort_unstable_by(|a, b| (a.0, a.1, a.2).cmp(&(b.0, b.1, b.2)).then(a.3.total_cmp(&b.3)));
    let mut stretches: Vec<Stretch> = Vec::new();
    for (line, sides, _, length) in pieces {
        match stretches.last_mut() {
            Some(last) if last.line == line && last.sides == sides => last.length += length,
            _ => stretches.push(Stretch { line, sides, length, share: 0.0 }),
        }
    }
    for of_line in stretches.chunk_by_mut(|a, b| a.line == b.line) {
        let total: f64 = of_line.iter().map(|s| s.length).sum();
        of_line.iter_mut().for_each(|s| s.share = s.length / total.max(f64::MIN_POSITIVE));
        of_line.sort_by(|a, b| b.length.total_cmp(&a.length).then(a.sides.cmp(&b.sides)));
    }
    stretches
}

/// By sub-domain: the levels whose lines end at one of its barrier edges, and whether it lies beyond a ragged outline.
fn barriers(tin: &Tin, regions: &Regions, gaps: &GapEdges, grid: &LevelGrid) -> (Vec<Vec<(Label, f64)>>, Vec<bool>) {
    let count = regions.regions.len();
    let (mut explained, mut number) = (vec![Vec::new(); count], vec![0u32; count]);
    if !gaps.barriers.is_empty() {
        for t in (0..tin.len() as u32).filter(|&t| tin.is_inside(t)) {
            for i in (0..3).filter(|&i| tin.is_barrier(t, i)) {
                let region = regions.of_triangle[t as usize] as usize;
                let heights = tin.edge(t, i).map(|v| tin.heights[v as usize]);
                heights.iter().for_each(|&z| add(&mut explained[region], (grid.label(z), 0.0)));
                number[region] += u32::from(heights[0] != heights[1]);
            }
        }
    }
    let ragged = regions.regions.iter().zip(number).map(|(r, n)| r.outer && n >= RAGGED_BARRIERS).collect();
    (explained, ragged)
}
