//! The order in which the points and edges of long spikes are inserted.
//!
//! Usually, points are inserted from the middle outwards. That is fast, but slow where long edges lie close to each other:
//! a point that is far from all others sees many of them, and takes over the triangles of the point before. A random
//! order bears any input (Amenta, Choi and Rote, "Incremental constructions con BRIO", 2003). It has rounds, of which
//! each is about twice as long as the one before. In a round, a point follows one near it, so that its place is found soon.
//! The edges of a round follow its points.

use glam::DVec2;
use rayon::prelude::*;

use crate::base::parallel;
use crate::geometry::along_curve;

/// An edge is long if it is this many times as long as the steps from its ends to points near them.
const LONG: f64 = 64.0;
/// With a smaller share of long edges, points are inserted from the middle outwards.
const MANY: f64 = 1.0 / 16.0;
/// So many points are inserted soon in any order.
const FEW: usize = 4096;

/// The points and edges of a round, by their numbers. The points come first.
#[derive(Debug, Clone, Default, PartialEq)]
pub(super) struct Round {
    pub points: Vec<u32>,
    pub edges: Vec<u32>,
}

/// Random rounds, if many edges are long.
pub(super) fn in_rounds(positions: &[DVec2], edges: &[[u32; 2]]) -> Option<Vec<Round>> {
    if positions.len() <= FEW {
        return None;
    }
    let extent = (DVec2::INFINITY, DVec2::NEG_INFINITY);
    let (min, max) = positions.iter().fold(extent, |(lo, hi), &p| (lo.min(p), hi.max(p)));
    let scale = f64::from(u16::MAX) / (max - min).max_element().max(f64::MIN_POSITIVE);
    let cell = |v: usize| ((positions[v] - min) * scale).to_array().map(|c| c as u16);
    let mut way: Vec<(u32, u32)> = parallel::values(positions.len(), |v| (along_curve(cell(v)), v as u32));
    way.par_sort_unstable();
    let length = |u: u32, v: u32| positions[u as usize].distance(positions[v as usize]);
    let mut step = vec![f64::INFINITY; positions.len()];
    for pair in way.windows(2) {
        let (u, v) = (pair[0].1, pair[1].1);
        let length = length(u, v);
        [u, v].into_iter().for_each(|v| step[v as usize] = length.min(step[v as usize]));
    }
    let is_long = |&[u, v]: &[u32; 2]| length(u, v) > LONG * step[u as usize].max(step[v as usize]);
    let count = edges.par_iter().filter(|edge| is_long(edge)).count();
    if (count as f64) < MANY * edges.len().max(positions.len()) as f64 {
        return None;
    }
    // A point comes with the first of its edges. So edges come while there are few points between them, and cross few triangles.
    let mut first = vec![None; positions.len()];
    let mut rounds = vec![Round::default(); u32::BITS as usize + 1];
    for (e, edge) in (0u32..).zip(edges) {
        rounds[round(e)].edges.push(e);
        edge.iter().for_each(|&v| first[v as usize] = first[v as usize].max(Some(round(e))));
    }
    way.into_iter().for_each(|(_, v)| rounds[first[v as usize].unwrap_or_else(|| round(v))].points.push(v));
    rounds.reverse();
    Some(rounds)
}

/// The round of a point or an edge, counted from the last one, which holds half of them. The multiplication mixes the
/// digits of the number (Knuth, The Art of Computer Programming 3, section 6.4).
fn round(number: u32) -> usize {
    number.wrapping_add(1).wrapping_mul(0x9e37_79b9).leading_zeros() as usize
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn spikes_are_inserted_in_rounds_and_rings_are_not() {
        let count = 8000;
        let ring = |radius: fn(u32) -> f64| -> Vec<DVec2> {
            let angle = |k: u32| f64::from(k) * std::f64::consts::TAU / f64::from(count);
            (0..count).map(|k| DVec2::from_angle(angle(k)) * radius(k)).collect()
        };
        let edges: Vec<[u32; 2]> = (0..count).map(|k| [k, (k + 1) % count]).collect();
        assert_eq!(in_rounds(&ring(|_| 1.0), &edges), None);
        let rounds = in_rounds(&ring(|k| if k % 2 == 0 { 1.0 } else { 0.5 }), &edges).unwrap();
        let of_last = rounds.last().unwrap().edges.len() as u32;
        assert!((count / 2 - 100..count / 2 + 100).contains(&of_last), "{of_last}");
        let mut is_there = vec![false; count as usize];
        for round in &rounds {
            round.points.iter().for_each(|&v| assert!(!std::mem::replace(&mut is_there[v as usize], true)));
            assert!(round.edges.iter().flat_map(|&e| edges[e as usize]).all(|v| is_there[v as usize]));
        }
        assert!(is_there.into_iter().all(|is_there| is_there));
        assert_eq!(rounds.iter().map(|round| round.edges.len()).sum::<usize>(), edges.len());
    }
}
