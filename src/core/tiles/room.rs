//! Makes room for a vertex that finds no free point of the grid.
//!
//! Vertices that have a place keep it when the grid gets finer. Some of them may lie so close to a vertex without a place that
//! no finer grid helps. Then they move by one step away from it.

use std::collections::HashMap;

use glam::DVec2;

use super::moving::{Moving, Obstacles};
use crate::geometry::Bounds;

/// How often a vertex moves away on each grid, at most. So it stays where the search finds its segments.
const MOST: u8 = 2;

/// Moves what lies around a vertex without a place away from it, by one step of the grid at most. `moved` counts how often
/// each vertex did so on this grid.
pub(super) fn make_room(moving: &mut Moving, v: u32, step: f64, moved: &mut HashMap<u32, u8>) {
    let from = moving.at(v);
    let mut around = moving.vertices_near(Bounds { min: from, max: from }.grown(2.0 * step));
    around.retain(|w| *w != v && moving.at(*w).distance(from) <= 3.0 * step);
    for w in around {
        let place = moving.at(w);
        let is_on_grid = (place / step).fract() == DVec2::ZERO;
        let count = moved.entry(w).or_default();
        if !is_on_grid || *count >= MOST {
            continue;
        }
        let mut ways = [(1, 0), (1, 1), (0, 1), (-1, 1), (-1, 0), (-1, -1), (0, -1), (1, -1)]
            .map(|(x, y)| place + DVec2::new(f64::from(x), f64::from(y)) * step);
        ways.sort_by(|a, b| b.distance_squared(from).total_cmp(&a.distance_squared(from)));
        // Only those that lead away.
        if ways[..3].iter().any(|to| moving.try_move(w, *to, Obstacles::All)) {
            *count += 1;
        }
    }
}
