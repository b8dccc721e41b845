//! Which parts of which lines a tile shows.

use super::mercator::TilePlace;
use super::network::{LineOnGrid, Network};

/// A tile shows lines up to this far outside of it, as a share of its side. Map libraries draw wide lines and labels there.
pub const BUFFER: f64 = 1.0 / 64.0;

/// A part of a line in a tile.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Run {
    /// The tile.
    pub tile: TilePlace,
    /// The number of the line in the network.
    pub line: u32,
    /// The number of its first vertex on the line.
    pub first: u32,
    /// The number of its segments.
    pub segments: u32,
}

/// The parts of all lines whose level is shown, line by line. A tile takes each segment whose upright box meets the tile or
/// its buffer, as a whole.
pub fn runs(network: &Network, is_shown: impl Fn(u32) -> bool) -> Vec<Run> {
    let extent = i64::from(network.extent());
    let buffer = (extent as f64 * BUFFER) as i64;
    let tiles = 1_i64 << network.zoom();
    let mut all = Vec::new();
    let mut open: Vec<Run> = Vec::new();
    for k in 0..network.count() {
        let line = network.line(k);
        if !is_shown(line.level) {
            continue;
        }
        let from = all.len();
        let segments = line.count() - usize::from(!line.is_ring);
        for first in 0..segments {
            let [a, b] = [line.vertex(first), line.vertex(first + 1)];
            let range = |axis: usize| {
                let (low, high) = (a[axis].min(b[axis]) - buffer, a[axis].max(b[axis]) + buffer);
                low.div_euclid(extent).max(0)..=high.div_euclid(extent).min(tiles - 1)
            };
            for (x, y) in range(1).flat_map(|y| range(0).map(move |x| (x, y))) {
                let tile = TilePlace { zoom: network.zoom(), x: x as u32, y: y as u32 };
                match open.iter_mut().find(|run| run.tile == tile && run.first + run.segments == first as u32) {
                    Some(run) => run.segments += 1,
                    None => open.push(Run { tile, line: k as u32, first: first as u32, segments: 1 }),
                }
            }
            // What does not reach this segment is over.
            let over = |run: &Run| run.first as usize + run.segments as usize <= first;
            all.extend(open.iter().filter(|run| over(run)));
            open.retain(|run| !over(run));
        }
        all.append(&mut open);
        if line.is_ring {
            close(&line, &mut all, from);
        }
    }
    all
}

/// Joins runs of a ring that end at its last vertex with those that begin at its first one, in the same tile.
fn close(line: &LineOnGrid<'_>, all: &mut Vec<Run>, from: usize) {
    let count = line.count() as u32;
    let mut of_line = all.split_off(from);
    let heads: Vec<Run> = of_line.iter().filter(|run| run.first == 0 && run.segments < count).copied().collect();
    for head in heads {
        let tail =
            of_line.iter_mut().find(|run| run.tile == head.tile && run.first > 0 && run.first + run.segments == count);
        if let Some(tail) = tail {
            tail.segments += head.segments;
            of_line.retain(|run| *run != head);
        }
    }
    all.append(&mut of_line);
}
