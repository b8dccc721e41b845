//! The areas at or above levels, put together from the bands between them.

use foldhash::HashMap;
use glam::DVec2;

use super::BandArea;
use super::graph::{Graph, Piece, Side};
use super::nest;
use crate::base::bits::bits;
use crate::base::parallel;

/// The rings of a connected area: the outer one, counter-clockwise, then the holes, clockwise. The first point is repeated.
pub type Rings = Vec<Vec<DVec2>>;

/// For each of the levels, metres: the connected areas where the ground is at or above it. `areas` are those of
/// [`bands`](super::bands) at these levels, or at more of them. Ground of which no level is known is above −∞ alone.
///
/// Borders are pieces of the borders of bands, vertex for vertex, where the ground on one side is above the level and that on the
/// other is not. So areas above a level lie in those above a lower one exactly.
pub fn areas_above(areas: &[BandArea], levels: &[f64]) -> Vec<Vec<Rings>> {
    let from = |area: &BandArea| area.from.unwrap_or(f64::NEG_INFINITY);
    let edges = |area: &BandArea| -> Vec<[[u64; 2]; 2]> {
        area.rings.iter().flat_map(|ring| ring.windows(2)).map(|edge| [bits(edge[0]), bits(edge[1])]).collect()
    };
    let on_left: HashMap<[[u64; 2]; 2], f64> =
        areas.iter().flat_map(|area| edges(area).into_iter().map(move |edge| (edge, from(area)))).collect();
    parallel::map_each(levels, |level| {
        // Feet that became metres differ by rounding.
        let is_above = |from: f64| from >= level - 1e-9 * level.abs().max(1.0) || from == *level;
        let is_border = |edge: &[DVec2]| {
            let across = on_left.get(&[bits(edge[1]), bits(edge[0])]);
            across.is_none_or(|from| !is_above(*from))
        };
        let rings = areas.iter().filter(|area| is_above(from(area))).flat_map(|area| &area.rings);
        let sides = [Side::NOTHING, Side { is_outside: true, ..Side::NOTHING }];
        let pieces = rings.flat_map(|ring| runs(ring, is_border)).map(|points| Piece { points, sides, level: None });
        let graph = Graph::new(pieces.collect());
        nest::areas(&graph).into_iter().filter(|area| !area.side.is_outside).map(|area| area.rings).collect()
    })
}

/// The longest pieces of a ring of which all edges are kept; the ring itself, if all of them are.
pub(crate) fn runs(ring: &[DVec2], is_kept: impl Fn(&[DVec2]) -> bool) -> Vec<Vec<DVec2>> {
    let kept: Vec<bool> = ring.windows(2).map(is_kept).collect();
    // Begins at an edge that is left out, so that no run goes on over the start of the ring.
    let Some(gap) = kept.iter().position(|kept| !kept) else { return vec![ring.to_vec()] };
    let mut runs: Vec<Vec<DVec2>> = Vec::new();
    let mut is_open = false;
    for k in (gap..kept.len()).chain(0..gap) {
        match runs.last_mut().filter(|_| is_open && kept[k]) {
            Some(run) => run.push(ring[k + 1]),
            None if kept[k] => runs.push(ring[k..=k + 1].to_vec()),
            None => {}
        }
        is_open = kept[k];
    }
    runs
}
