//! Splits lines that return to one of their own vertices into lines and rings that do not.
//!
//! Splitting loses nothing, whereas cutting would open the ring. Only spikes are left out: places where a line runs
//! along one segment and straight back. They enclose nothing, and would stand as walls in the surface.

use std::collections::HashMap;
use std::collections::hash_map::Entry;

use glam::DVec2;

use super::canonical::{has_repeated_vertex, normalise};
use super::removed::{Removed, Why};
use crate::base::bits::bits;
use crate::contour::Contour;

/// The result of splitting a line.
pub(super) struct Split {
    /// The lines and rings, each in standard form.
    pub(super) lines: Vec<Contour>,
    /// The spikes and the overruns that were left out.
    pub(super) spikes: Vec<Removed>,
}

/// Splits a line in standard form at the vertices that it visits more than once.
pub(super) fn at_repeated_vertices(line: Contour) -> Split {
    if !has_repeated_vertex(&line.points) {
        return Split { lines: vec![line], spikes: Vec::new() };
    }
    let mut split = Split { lines: Vec::new(), spikes: Vec::new() };
    let piece = |points: Vec<DVec2>| Contour { elevation: line.elevation, points, feature: line.feature };
    // The line from its start without the loops removed so far, and the place of each vertex on it.
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
            // A spike that starts at the last spike's root makes that spike longer.
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
        // A line that runs there and straight back as a whole is not a spike: one of its two runs stays.
        split.lines = split.spikes.iter().map(|s| piece(s.way.clone())).collect();
        split.spikes.iter_mut().for_each(|s| s.why = Why::Doubled);
    }
    split.lines.iter_mut().for_each(|l| normalise(&mut l.points));
    split
}
