//! Breaching of pits: water runs off wherever the contours do not say that it stays.
//!
//! A surface through contours dams gullies between one contour and the next. The result is a string of pits that the
//! contours do not show. From each pit, the path to lower ground is searched along which least ground must be removed.
//! The path is then cut to a steady fall (least-cost breaching: Lindsay 2016, Hydrol. Process. 30).

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use foldhash::HashMap;

use super::lattice::Lattice;
use crate::base::Key;
use crate::base::parallel;

/// Largest number of nodes visited in the search from one pit. It limits time. A pit that needs more stays.
const MOST_VISITED: usize = 20_000;
/// Cost of the length of a path, as a cut of this share of the largest depth allowed. It only decides between paths
/// with equal cuts, so any small value will do.
const LENGTH_COST: f32 = 1e-3;

/// Limits of breaching.
pub struct Limits<'a> {
    /// Heights stay at or above this.
    pub lo: &'a [f32],
    /// Every cut is less deep than this: the contour interval. Between neighbouring contours no cut needs to be deeper.
    /// Where contours are broken, a band has no floor, and a deeper cut would go through the hills behind.
    pub depth: f32,
}

/// Breaches pits. Nodes outside the frame are NaN; they drain. `is_bottom` marks ground that the contours show as a
/// hollow; pits there stay.
pub fn breach(heights: &mut [f32], lattice: &Lattice, limits: &Limits<'_>, is_bottom: impl Fn(usize) -> bool + Sync) {
    // The lowest pits come first. Pits above can then use their paths.
    let is_open_pit = |n: &u32| is_pit(heights, lattice, *n as usize) && !is_bottom(*n as usize);
    let mut pits: Vec<u32> = parallel::flat_map(heights.len(), |n| Some(n as u32).filter(is_open_pit));
    pits.sort_by(|&a, &b| heights[a as usize].total_cmp(&heights[b as usize]).then(a.cmp(&b)));
    for pit in pits {
        if is_pit(heights, lattice, pit as usize)
            && let Some(way) = least_cost_path(heights, lattice, limits, pit)
        {
            lower_along(heights, lattice, limits.lo, &way);
        }
    }
}

/// Whether all eight neighbours exist and none is lower or at the same height.
fn is_pit(heights: &[f32], lattice: &Lattice, n: usize) -> bool {
    let here = heights[n];
    let mut count = 0;
    // A comparison with NaN is false, so there is no pit beside the frame.
    neighbours(lattice, n).all(|m| {
        count += 1;
        heights[m] > here
    }) && count == 8
}

fn neighbours(lattice: &Lattice, n: usize) -> impl Iterator<Item = usize> + use<> {
    let (cols, rows) = (lattice.cols as isize, lattice.rows as isize);
    let (i, j) = ((n % lattice.cols) as isize, (n / lattice.cols) as isize);
    let offsets = [(-1, -1), (0, -1), (1, -1), (-1, 0), (1, 0), (-1, 1), (0, 1), (1, 1)];
    offsets
        .into_iter()
        .map(move |(di, dj)| (i + di, j + dj))
        .filter(move |&(i, j)| 0 <= i && i < cols && 0 <= j && j < rows)
        .map(move |(i, j)| (j * cols + i) as usize)
}

/// The nodes of the least-cost path from a pit to lower ground, with both ends. `None` if the floor of a band is in the
/// way, or if the search visits too many nodes.
fn least_cost_path(heights: &[f32], lattice: &Lattice, limits: &Limits<'_>, pit: u32) -> Option<Vec<u32>> {
    let goal = heights[pit as usize];
    // Cost to reach a node, and the node before it on the path.
    let mut best: HashMap<u32, (f32, u32)> = HashMap::from_iter([(pit, (0.0, pit))]);
    let mut open = BinaryHeap::from([Reverse((Key(0.0), pit))]);
    while let Some(Reverse((Key(cost), n))) = open.pop() {
        // Costs are single-precision numbers; the key is wider.
        let cost = cost as f32;
        if best[&n].0 < cost {
            continue;
        }
        let height = heights[n as usize];
        if height < goal || height.is_nan() {
            let mut way = vec![n];
            let mut at = n;
            while at != pit {
                at = best[&at].1;
                way.push(at);
            }
            way.reverse();
            return Some(way);
        }
        if best.len() > MOST_VISITED {
            return None;
        }
        for m in neighbours(lattice, n as usize).map(|m| m as u32) {
            let height = heights[m as usize];
            let lower = height < goal || height.is_nan();
            // Ground that may not be cut below the pit is no way out.
            if !lower && (limits.lo[m as usize] >= goal || height - goal >= limits.depth) {
                continue;
            }
            let depth = if lower { 0.0 } else { height - goal };
            let cost = cost + (depth + LENGTH_COST * limits.depth) * step(lattice, n, m) as f32;
            if best.get(&m).is_none_or(|b| cost < b.0) {
                best.insert(m, (cost, n));
                open.push(Reverse((Key(f64::from(cost)), m)));
            }
        }
    }
    None
}

/// Distance between two nodes, map units.
fn step(lattice: &Lattice, a: u32, b: u32) -> f64 {
    let (a, b) = (a as usize, b as usize);
    let dx = (a % lattice.cols).abs_diff(b % lattice.cols) as f64 * lattice.step.x;
    let dy = (a / lattice.cols).abs_diff(b / lattice.cols) as f64 * lattice.step.y;
    dx.hypot(dy)
}

/// Lowers the nodes between the ends of a path to a steady fall, where they are above it.
fn lower_along(heights: &mut [f32], lattice: &Lattice, lo: &[f32], way: &[u32]) {
    let length: f64 = way.windows(2).map(|w| step(lattice, w[0], w[1])).sum();
    let top = heights[way[0] as usize];
    let end = heights[way[way.len() - 1] as usize];
    // Outside the frame there is no height. The path then only just falls.
    let end = if end.is_nan() { top - f32::EPSILON * top.abs() * way.len() as f32 } else { end };
    let mut travelled = 0.0;
    for w in way.windows(2) {
        travelled += step(lattice, w[0], w[1]);
        let n = w[1] as usize;
        let fall = top + (end - top) * (travelled / length) as f32;
        if heights[n] > fall {
            heights[n] = fall.max(lo[n]);
        }
    }
}

#[cfg(test)]
mod tests {
    use glam::DVec2;

    use super::*;

    fn grid(cols: usize, rows: usize) -> Lattice {
        Lattice { first: DVec2::ZERO, step: DVec2::ONE, cols, rows }
    }

    fn pits(heights: &[f32], lattice: &Lattice) -> usize {
        (0..heights.len()).filter(|&n| is_pit(heights, lattice, n)).count()
    }

    /// A valley that falls to the east, with dams across.
    fn dammed(cols: usize, rows: usize) -> Vec<f32> {
        let at = |n: usize| {
            let (i, j) = ((n % cols) as f32, (n / cols) as f32);
            let dam = if (n % cols) % 7 == 3 { 3.0 } else { 0.0 };
            100.0 - 0.3 * i + 2.0 * (j - (rows / 2) as f32).abs() + dam
        };
        (0..cols * rows).map(at).collect()
    }

    #[test]
    fn dams_across_a_valley_are_cut() {
        let grid = grid(40, 9);
        let mut heights = dammed(40, 9);
        let before = heights.clone();
        assert!(pits(&heights, &grid) > 3);
        breach(&mut heights, &grid, &Limits { lo: &[0.0; 360], depth: 20.0 }, |_| false);
        assert_eq!(pits(&heights, &grid), 0);
        assert!(heights.iter().zip(&before).all(|(now, then)| now <= then));
        // Most of the ground is as before.
        assert!(heights.iter().zip(&before).filter(|(now, then)| now != then).count() < 40);
    }

    #[test]
    fn a_way_keeps_to_low_ground_behind_the_pass() {
        let grid = grid(14, 13);
        let at = |n: usize| {
            let (i, j) = (n % 14, n / 14);
            match i.abs_diff(3).max(j.abs_diff(6)) {
                _ if i == 13 => 9.0,
                0 => 10.0,
                1 => 18.0,
                _ if j == 9 => 10.5,
                _ => 15.0,
            }
        };
        let before: Vec<f32> = (0..14 * 13).map(at).collect();
        let mut heights = before.clone();
        breach(&mut heights, &grid, &Limits { lo: &[0.0; 14 * 13], depth: 20.0 }, |_| false);
        assert_eq!(pits(&heights, &grid), 0);
        let cut: f32 = before.iter().zip(&heights).map(|(then, now)| then - now).sum();
        assert!(cut < 25.0, "{cut} m were cut away, not along the valley floor");
    }

    #[test]
    fn the_floor_of_the_band_and_hollows_are_kept() {
        let grid = grid(40, 9);
        let before = dammed(40, 9);
        let mut heights = before.clone();
        breach(&mut heights, &grid, &Limits { lo: &before, depth: 20.0 }, |_| false);
        assert_eq!(heights, before, "nothing may be cut");
        breach(&mut heights, &grid, &Limits { lo: &[0.0; 360], depth: 20.0 }, |_| true);
        assert_eq!(heights, before, "all are hollows");
        breach(&mut heights, &grid, &Limits { lo: &[0.0; 360], depth: 1.0 }, |_| false);
        assert_eq!(heights, before, "the dams are higher than that");
    }
}
