//! Joins pieces of axis to ridge and canyon lines.

use std::collections::BTreeMap;

use glam::DVec3;

use super::axis::{Axis, End};
use super::{BreakKind, BreakLine};
use crate::tin::Tin;

/// Chains the pieces of the axis to polylines, from end to end and from fork to fork.
///
/// A line is a ridge where it runs above the level on both its sides, a canyon where it runs below.
pub fn break_lines(tin: &Tin, axis: &Axis, heights: &[f64]) -> Vec<BreakLine> {
    let mut at: BTreeMap<End, Vec<u32>> = BTreeMap::new();
    for (id, piece) in axis.pieces.iter().enumerate() {
        for &end in piece {
            at.entry(end).or_default().push(id as u32);
        }
    }
    // Tips of different lines may share a contour vertex and are ends all the same.
    let through = |end: End| matches!(end, End::Axis(_)) && at[&end].len() == 2;
    let mut used = vec![false; axis.pieces.len()];
    let mut lines = Vec::new();
    let mut trace = |start: End, first: u32| {
        let mut ends = vec![start];
        let mut piece = first;
        while !std::mem::replace(&mut used[piece as usize], true) {
            let [a, b] = axis.pieces[piece as usize];
            let here = ends[ends.len() - 1];
            let next = if a == here { b } else { a };
            ends.push(next);
            if !through(next) {
                break;
            }
            let [p, q] = [at[&next][0], at[&next][1]];
            piece = if p == piece { q } else { p };
        }
        if ends.len() >= 2 {
            lines.push(line(tin, axis, heights, &ends));
        }
    };
    for (&end, pieces) in at.iter().filter(|(end, _)| !through(**end)) {
        for &piece in pieces {
            trace(end, piece);
        }
    }
    for piece in 0..axis.pieces.len() as u32 {
        trace(axis.pieces[piece as usize][0], piece);
    }
    lines
}

fn line(tin: &Tin, axis: &Axis, heights: &[f64], ends: &[End]) -> BreakLine {
    let points: Vec<DVec3> = ends
        .iter()
        .map(|&end| match end {
            End::Axis(p) => (axis.points[p as usize].position + tin.origin).extend(heights[p as usize]),
            End::Vertex(v) => tin.point(v),
        })
        .collect();
    let above = ends.iter().any(|&end| match end {
        End::Axis(p) => axis.points[p as usize].level.is_some_and(|level| heights[p as usize] > level),
        End::Vertex(_) => false,
    });
    BreakLine { kind: if above { BreakKind::Ridge } else { BreakKind::Canyon }, points }
}
