//! Lines that come back to one of their own vertices, split there into lines and rings that do not.
//!
//! Nothing gets lost that way, whereas cutting would open the ring. What is left out are spikes, places where a line
//! runs along one segment and straight back: they enclose nothing and would stand as walls in the surface.

use std::collections::HashMap;
use std::collections::hash_map::Entry;

use glam::DVec2;

use super::canonical::{has_repeated_vertex, normalise};
use super::removed::{Removed, Why};
use crate::base::bits::bits;
use crate::contour::Contour;

/// What became of a line.
pub(super) struct Split {
    /// The lines and rings, each in standard form.
    pub(super) lines: Vec<Contour>,
    /// The spikes that were left out.
    pub(super) spikes: Vec<Removed>,
}

/// Splits a line in standard form at the vertices that it visits more than once.
pub(super) fn at_repeated_vertices(line: Contour) -> Split {
    if !has_repeated_vertex(&line.points) {
        return Split { lines: vec![line], spikes: Vec::new() };
    }
    let mut split = Split { lines: Vec::new(), spikes: Vec::new() };
    let piece = |points: Vec<DVec2>| Contour { elevation: line.elevation, points, feature: line.feature };
    // The way from the line's start without the loops taken off so far, and where on it a vertex is.
    let mut way: Vec<DVec2> = Vec::new();
    let mut at: HashMap<[u64; 2], usize> = HashMap::new();
    for &p in &line.points {
        let from = match at.entry(bits(p)) {
            Entry::Vacant(place) => {
                place.insert(way.len());
                way.push(p);
                continue;
            }
            Entry::Occupied(place) => *place.get(),
        };
        let loop_points = way.split_off(from + 1);
        for q in &loop_points {
            at.remove(&bits(*q));
        }
        if let [tip] = loop_points[..] {
            // What runs back on from a spike's root makes the same spike longer.
            match split.spikes.last_mut().filter(|spike| spike.way.last() == Some(&tip)) {
                Some(spike) => spike.way.push(p),
                None => split.spikes.push(Removed::new(&line, vec![tip, p], Why::Spike)),
            }
        } else {
            split.lines.push(piece([&[p], &loop_points[..], &[p]].concat()));
        }
    }
    if way.len() > 1 {
        split.lines.push(piece(way));
    }
    if split.lines.is_empty() {
        // A line that was drawn there and back as a whole is no spike: one of its two runs stays.
        split.lines = split.spikes.iter().map(|s| piece(s.way.clone())).collect();
        split.spikes.iter_mut().for_each(|s| s.why = Why::Doubled);
    }
    split.lines.iter_mut().for_each(|l| normalise(&mut l.points));
    split
}
