//! The direction of flow of each reach.

use std::collections::BinaryHeap;

use super::network::Reach;
use crate::base::rows::Rows;
use crate::subdomains::Regions;
use crate::subdomains::{Course, is_above};
use crate::tin::NONE;

/// Whether each reach flows from its second node to its first.
///
/// A reach that starts and ends between different contours flows to the lower ones. For the others, the network decides:
/// it is flooded from its outlets, the lowest node first (priority flood), and a reach flows from the node that is
/// reached later to the one that is reached earlier. The lowest node of each part of the network is an outlet, and so is
/// each node to which all reaches flow down across contours. `heights` are those of the nodes, metres.
pub(super) fn flows_back(reaches: &[Reach], courses: &[Course], regions: &Regions, heights: &[f64]) -> Vec<bool> {
    let known: Vec<Option<bool>> = courses.iter().map(|course| by_contours(course, regions)).collect();
    let order = flooded(reaches, &known, heights);
    let back = |(reach, known): (&Reach, &Option<bool>)| {
        let [first, second] = reach.nodes;
        known.unwrap_or(order[first] < order[second])
    };
    reaches.iter().zip(&known).map(back).collect()
}

/// Whether the contours let a line flow back; `None` if it starts and ends between the same ones.
fn by_contours(course: &Course, regions: &Regions) -> Option<bool> {
    let bands =
        || course.stretches.iter().filter(|s| s.region != NONE).map(|s| regions.regions[s.region as usize].band);
    let (first, last) = (bands().next()?, bands().next_back()?);
    match (is_above(first, last), is_above(last, first)) {
        (true, _) => Some(false),
        (_, true) => Some(true),
        _ => None,
    }
}

/// The order in which the nodes are reached by the flood.
fn flooded(reaches: &[Reach], known: &[Option<bool>], heights: &[f64]) -> Vec<usize> {
    let count = heights.len();
    let at = Rows::new(count, || {
        reaches.iter().enumerate().flat_map(|(r, reach)| reach.nodes.into_iter().map(move |node| (node, r as u32)))
    });
    let lower = |a: usize, b: usize| heights[a].total_cmp(&heights[b]).then(a.cmp(&b)).is_lt();
    let mut order = vec![usize::MAX; count];
    let mut heap = BinaryHeap::new();
    let mut seen = vec![false; count];
    for first in 0..count {
        if seen[first] {
            continue;
        }
        // One connected part of the network.
        seen[first] = true;
        let (mut members, mut next) = (vec![first], 0);
        while let Some(&node) = members.get(next) {
            next += 1;
            for other in at.of(node).iter().flat_map(|&r| reaches[r as usize].nodes) {
                if !std::mem::replace(&mut seen[other], true) {
                    members.push(other);
                }
            }
        }
        let lowest = members.iter().copied().reduce(|a, b| if lower(b, a) { b } else { a });
        let is_outlet = |node: usize| {
            at.of(node).iter().all(|&r| {
                let reach = &reaches[r as usize];
                known[r as usize].is_some_and(|back| reach.nodes[usize::from(!back)] == node)
            })
        };
        heap.extend(members.into_iter().filter(|&n| Some(n) == lowest || is_outlet(n)).map(|n| Reached(heights[n], n)));
    }
    let mut number = 0;
    while let Some(Reached(height, node)) = heap.pop() {
        if order[node] != usize::MAX {
            continue;
        }
        order[node] = number;
        number += 1;
        for other in at.of(node).iter().flat_map(|&r| reaches[r as usize].nodes) {
            if order[other] == usize::MAX {
                heap.push(Reached(height.max(heights[other]), other));
            }
        }
    }
    order
}

/// An entry of the flood's heap: the lowest comes first, then the one with the least number.
#[derive(PartialEq)]
struct Reached(f64, usize);

impl Eq for Reached {}

impl Ord for Reached {
    fn cmp(&self, other: &Self) -> std::cmp::Ordering {
        other.0.total_cmp(&self.0).then(other.1.cmp(&self.1))
    }
}

impl PartialOrd for Reached {
    fn partial_cmp(&self, other: &Self) -> Option<std::cmp::Ordering> {
        Some(self.cmp(other))
    }
}
