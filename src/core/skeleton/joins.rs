//! Makes lines of neighbouring sub-domains meet in one vertex of the contour between them.
//!
//! A line that crosses a contour ends at the contour vertex of the last triangle in its sub-domain. The line beyond
//! starts at the tip of the contour's bend, the middle of the bend as its own triangles see it. These are often two
//! vertices. On a walk from the tip inwards, each triangle passes one vertex of the bend. From that vertex the midpoint
//! of the triangle's next edge can be reached inside the triangle. So the line beyond can start at any vertex of the
//! bend. It starts where another line arrives.

use std::collections::{HashMap, HashSet};

use super::axis_builder::{AxisBuilder, beyond};
use super::eliminate::Elimination;
use super::pieces::End;
use crate::subdomains::{Regions, Side};
use crate::tin::{NONE, Tin};

/// Moves the ends of lines at the tips of bends to the vertices where lines from the other side of the contour arrive.
///
/// Returns for each piece whether it must be removed.
///
/// If no line arrives at the tip itself, the nearest arrival replaces the end at the tip. Further arrivals are joined
/// by side lines. Arrivals up to `reach` times the width of the bend from the tip, along the axis, are joined.
///
/// Long because each walk from a tip must see what earlier walks removed and added.
pub(super) fn join(
    tin: &Tin,
    regions: &Regions,
    elimination: &Elimination,
    builder: &mut AxisBuilder,
    reach: f64,
) -> Vec<bool> {
    let mut arrivals: HashMap<u32, Vec<(u32, Option<Side>)>> = HashMap::new();
    for arrival in &builder.arrivals {
        let side = beyond(tin, regions, arrival);
        arrivals.entry(arrival.vertex).or_default().push((arrival.region, side));
    }
    let mut removed = vec![false; builder.axis.pieces.len()];
    let mut added = Vec::new();
    // Points where lines were joined. A walk from another tip must not remove these lines.
    let mut held = HashSet::new();
    for t in (0..tin.len() as u32).filter(|&t| tin.is_inside(t)) {
        let piece = builder.piece_of[t as usize];
        if piece == NONE {
            continue;
        }
        let [End::Axis(first), End::Vertex(tip)] = builder.axis.pieces[piece as usize] else { continue };
        let level = builder.axis.points[first as usize].level;
        if level != Some(tin.heights[tip as usize]) {
            continue;
        }
        let region = regions.of_triangle[t as usize];
        let side = level.and_then(|level| regions.regions[region as usize].side(level));
        let arrives = |v: u32| {
            arrivals.get(&v).is_some_and(|from| from.iter().any(|&(other, way)| other != region && way == side))
        };
        let mut ends_here = arrives(tip);
        let mut passed = vec![piece];
        let mut length = builder.axis.points[first as usize].position.distance(tin.positions[tip as usize]);
        let Some(edge) = (0..3).find(|&i| builder.of_edge[t as usize][i] == first) else { continue };
        let (mut t, mut edge) = (t, edge);
        while let Some(step) = next_chord(tin, elimination, builder, t, edge) {
            (t, edge) = (step.triangle, step.edge);
            let here = builder.of_edge[t as usize][edge];
            let width = tin.edge_length(t, edge);
            let position = builder.axis.points[here as usize].position;
            length += position.distance(builder.axis.points[step.from as usize].position);
            if length > reach * width || held.contains(&here) {
                break;
            }
            passed.push(builder.piece_of[t as usize]);
            if arrives(step.left) && builder.crossed.insert(t) {
                held.insert(here);
                added.push([End::Axis(here), End::Vertex(step.left)]);
                if !std::mem::replace(&mut ends_here, true) {
                    passed.iter().for_each(|&p| removed[p as usize] = true);
                }
            }
        }
    }
    for t in 0..tin.len() {
        if builder.piece_of[t] != NONE && removed[builder.piece_of[t] as usize] {
            builder.piece_of[t] = NONE;
        }
    }
    builder.axis.pieces.extend(added);
    removed
}

/// A step of the walk from a tip inwards.
struct Step {
    triangle: u32,
    /// The edge through which the walk continues.
    edge: usize,
    /// The axis point on the edge through which it came.
    from: u32,
    /// The vertex that it passes.
    left: u32,
}

/// The step through the triangle across edge `edge` of `t`, if exactly one line runs through it. None at forks and at
/// the end.
fn next_chord(tin: &Tin, elimination: &Elimination, builder: &AxisBuilder, t: u32, edge: usize) -> Option<Step> {
    let n = tin.across(t, edge)?;
    let piece = builder.piece_of[n as usize];
    if piece == NONE || elimination.dropped[n as usize] {
        return None;
    }
    let from = builder.of_edge[t as usize][edge];
    let [a, b] = builder.axis.pieces[piece as usize];
    let on = if a == End::Axis(from) { b } else { a };
    let End::Axis(on) = on else { return None };
    let edge = builder.of_edge[n as usize].iter().position(|&p| p == on)?;
    Some(Step { triangle: n, edge, from, left: tin.triangles[n as usize][(edge + 2) % 3] })
}
