//! Joins pieces of the axis to ridge and canyon lines.
//!
//! A line stays in its sub-domain and falls all the way. Where lines meet, the one with the longest way from a source
//! continues; the others end there. Lines share their end points exactly, in one sub-domain and across neighbouring
//! ones.

use std::collections::HashMap;

use glam::DVec3;

use super::flow::{Flow, is_ridge};
use super::line::{LineEnd, SkeletonKind, SkeletonLine};
use super::pieces::{Axis, End};
use crate::base::union_find::UnionFind;
use crate::subdomains::Regions;
use crate::tin::{NONE, Tin, VertexKind};

/// Traces the lines of an axis along its flow, in the order of their first pieces. All run downhill.
pub fn skeleton_lines(tin: &Tin, regions: &Regions, axis: &Axis, flow: &Flow) -> Vec<SkeletonLine> {
    let trunks = Trunks::new(tin, axis, flow);
    let mut lines = Vec::new();
    let mut ends_of: Vec<[End; 2]> = Vec::new();
    for (id, &piece) in axis.pieces.iter().enumerate() {
        let [mut from, mut to] = directed(tin, axis, flow, piece);
        if let End::Axis(p) = from
            && trunks.at[p as usize].through()
            && trunks.at[p as usize].out.id == id as u32
        {
            continue;
        }
        let mut ends = vec![from, to];
        let mut current = id as u32;
        while let End::Axis(p) = to {
            let trunk = &trunks.at[p as usize];
            if !trunk.through() || trunk.into.id != current {
                break;
            }
            current = trunk.out.id;
            [from, to] = directed(tin, axis, flow, axis.pieces[current as usize]);
            debug_assert_eq!(from, End::Axis(p), "a piece goes on where the one before it ends");
            ends.push(to);
        }
        ends_of.push([ends[0], to]);
        lines.push(line(tin, regions, axis, flow, &trunks, ends));
    }
    number_networks(&mut lines, &ends_of);
    lines
}

/// The ends of a piece in the direction of the flow: down in canyons, up on ridges.
fn directed(tin: &Tin, axis: &Axis, flow: &Flow, [a, b]: [End; 2]) -> [End; 2] {
    let forward = match (a, b) {
        (End::Axis(p), End::Axis(q)) => flow.flood_number[p as usize] > flow.flood_number[q as usize],
        (End::Axis(p), End::Vertex(v)) => axis.points[p as usize].level != Some(tin.heights[v as usize]),
        (End::Vertex(v), End::Axis(p)) => axis.points[p as usize].level == Some(tin.heights[v as usize]),
        (End::Vertex(_), End::Vertex(_)) => true,
    };
    if forward { [a, b] } else { [b, a] }
}

/// A piece, and the length of the longest way through it.
#[derive(Debug, Clone, Copy)]
struct Carrier {
    id: u32,
    length: f64,
}

/// The pieces that run through an axis point.
#[derive(Debug, Clone, Copy)]
struct Trunk {
    into: Carrier,
    out: Carrier,
    /// Number of pieces that end here, and of those that begin here.
    count: [u32; 2],
}

impl Trunk {
    fn through(&self) -> bool {
        self.into.id != NONE && self.out.id != NONE
    }
}

/// The trunk at every axis point.
struct Trunks {
    at: Vec<Trunk>,
}

impl Trunks {
    fn new(tin: &Tin, axis: &Axis, flow: &Flow) -> Self {
        let nothing = Carrier { id: NONE, length: f64::NEG_INFINITY };
        let mut at = vec![Trunk { into: nothing, out: nothing, count: [0, 0] }; axis.points.len()];
        let position = |end: End| match end {
            End::Axis(p) => axis.points[p as usize].position,
            End::Vertex(v) => tin.positions[v as usize],
        };
        let carried = |end: End, lengths: &[f64]| match end {
            End::Axis(p) => lengths[p as usize],
            End::Vertex(_) => 0.0,
        };
        for (id, &piece) in axis.pieces.iter().enumerate() {
            let [from, to] = directed(tin, axis, flow, piece);
            let length = position(from).distance(position(to));
            let choose = |best: &mut Carrier, length: f64| {
                if length > best.length {
                    *best = Carrier { id: id as u32, length };
                }
            };
            if let End::Axis(p) = to {
                choose(&mut at[p as usize].into, length + carried(from, &flow.upstream));
                at[p as usize].count[0] += 1;
            }
            if let End::Axis(p) = from {
                choose(&mut at[p as usize].out, length + carried(to, &flow.downstream));
                at[p as usize].count[1] += 1;
            }
        }
        Self { at }
    }
}

/// A line from its ends in the direction of the flow.
fn line(tin: &Tin, regions: &Regions, axis: &Axis, flow: &Flow, trunks: &Trunks, ends: Vec<End>) -> SkeletonLine {
    let points = ends.iter().map(|&end| match end {
        End::Axis(p) => (axis.points[p as usize].position + tin.origin).extend(flow.heights[p as usize]),
        End::Vertex(v) => tin.point(v),
    });
    let mut points: Vec<DVec3> = points.collect();
    let on_axis = ends.iter().find_map(|end| match end {
        End::Axis(p) => Some(axis.points[*p as usize]),
        End::Vertex(_) => None,
    });
    let (region, level) = on_axis.map_or((NONE, f64::NAN), |p| (p.region, p.level.unwrap_or(f64::NAN)));
    let ridge = on_axis.is_some() && is_ridge(regions, region, level);
    let kind = if ridge { SkeletonKind::Ridge } else { SkeletonKind::Canyon };
    let first = what_ends(tin, axis, trunks, kind, Place::Start(ends[0]));
    let last = what_ends(tin, axis, trunks, kind, Place::Finish(ends[ends.len() - 1]));
    let mut ends = [first, last];
    if kind == SkeletonKind::Ridge {
        points.reverse();
        ends.reverse();
    }
    SkeletonLine { kind, points, region, ends, network: 0 }
}

/// The two ends of a line in the direction of the flow.
#[derive(Debug, Clone, Copy)]
enum Place {
    Start(End),
    Finish(End),
}

/// What is at an end of a line.
fn what_ends(tin: &Tin, axis: &Axis, trunks: &Trunks, kind: SkeletonKind, place: Place) -> LineEnd {
    let (Place::Start(end) | Place::Finish(end)) = place;
    let End::Axis(p) = end else { return LineEnd::Contour };
    let [ending, beginning] = trunks.at[p as usize].count;
    if ending + beginning == 1
        && let Some(found) = open_side(tin, axis.points[p as usize].triangle)
    {
        return found;
    }
    match (place, ending, beginning) {
        (Place::Finish(_), _, 0) if kind == SkeletonKind::Canyon => LineEnd::Bottom,
        (Place::Finish(_), _, 0) => LineEnd::Peak,
        (Place::Start(_), 0, _) => LineEnd::Saddle,
        _ => LineEnd::Junction,
    }
}

/// Why a line stops at the edge of a triangle: what lies in or beside that triangle.
fn open_side(tin: &Tin, t: u32) -> Option<LineEnd> {
    let around = || (0..3).filter_map(|i| tin.across(t, i)).chain([t]);
    let at_frame = |t: u32| (0..3).any(|i| tin.inner_neighbour(t, i).is_none() || tin.is_barrier(t, i));
    let touches = |t: u32, kind| tin.triangles[t as usize].iter().any(|&v| tin.kinds[v as usize] == kind);
    if around().any(|t| at_frame(t) || touches(t, VertexKind::Frame)) {
        Some(LineEnd::Frame)
    } else if around().any(|t| touches(t, VertexKind::Spot)) {
        Some(LineEnd::Spot)
    } else {
        None
    }
}

/// Gives lines that share end points, directly or through other lines, one network number, in the order of the lines.
fn number_networks(lines: &mut [SkeletonLine], ends: &[[End; 2]]) {
    let mut networks = UnionFind::new(lines.len());
    let mut first_at: HashMap<End, usize> = HashMap::new();
    for (k, pair) in ends.iter().enumerate() {
        for &end in pair {
            networks.unite(k, *first_at.entry(end).or_insert(k));
        }
    }
    let mut next = 0;
    for k in 0..lines.len() {
        // A root is the first line of its network.
        let root = networks.root(k);
        lines[k].network = if root == k {
            next += 1;
            next - 1
        } else {
            lines[root].network
        };
    }
}
