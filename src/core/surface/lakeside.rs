//! Ground beside lakes. A band may reach down to a contour that is far away from a lake. But ground at the shore lies no lower than
//! the lake, unless lower ground is known to be about as near as the water: there the lake may have its outlet.

use glam::{DVec2, DVec3};

use crate::base::{Grid, KnownLine, parallel};
use crate::spline::Lattice;

/// The ground up to this distance from the water is at its shore, in nodes.
const REACH: usize = 3;
/// Ground is above the level of water by at least this share of the interval.
const ABOVE_WATER: f64 = 1e-3;
/// Lower ground counts that is nearer than so many times the distance to the water.
const NEARER: f64 = 2.0;

/// The lowest known heights at the nodes of a grid: of spot heights, and along lines. Infinity where nothing is known.
pub(super) fn lowest_known(grid: &Grid, spots: impl Iterator<Item = DVec3>, lines: &[KnownLine<'_>]) -> Vec<f32> {
    let lattice = Lattice::of_grid(grid);
    let mut lowest = vec![f32::INFINITY; lattice.len()];
    let mut mark = |p: DVec3| {
        let place = lattice.place(p.truncate()).round();
        let last = DVec2::new(lattice.cols as f64 - 1.0, lattice.rows as f64 - 1.0);
        if place.cmpge(DVec2::ZERO).all() && place.cmple(last).all() {
            let node = place.y as usize * lattice.cols + place.x as usize;
            lowest[node] = lowest[node].min(p.z as f32);
        }
    };
    spots.for_each(&mut mark);
    for pair in lines.iter().flat_map(|line| line.points.windows(2)) {
        let steps = (lattice.place(pair[0].truncate()) - lattice.place(pair[1].truncate())).abs().max_element().ceil();
        (0..=steps as usize).for_each(|k| mark(pair[0].lerp(pair[1], k as f64 / steps.max(1.0))));
    }
    lowest
}

/// Raises the lower bounds of ground at the shores of lakes to their levels. `is_water` marks nodes in lakes, whose upper
/// bound is the level; `lowest` are known heights.
pub(super) fn keep_above_lakes([lo, hi]: [&mut [f32]; 2], is_water: &[bool], lowest: &[f32], cols: usize) {
    let around = |node: usize, reach: usize| {
        let (col, row, rows) = (node % cols, node / cols, is_water.len() / cols);
        let (west, east) = (col.saturating_sub(reach), (col + reach).min(cols - 1));
        (row.saturating_sub(reach)..=(row + reach).min(rows - 1)).flat_map(move |j| {
            (west..=east).map(move |i| (j * cols + i, (i.abs_diff(col).pow(2) + j.abs_diff(row).pow(2)) as f64))
        })
    };
    let mut is_near = vec![false; is_water.len()];
    let on_land = |node: usize| !is_water[node] && lo[node] < hi[node];
    let shore = (0..is_water.len()).filter(|&n| is_water[n] && around(n, 1).any(|(m, _)| on_land(m)));
    shore.flat_map(|n| around(n, REACH)).filter(|(m, _)| on_land(*m)).for_each(|(m, _)| is_near[m] = true);
    let near: Vec<usize> = (0..is_near.len()).filter(|&n| is_near[n]).collect();
    let floor = |&n: &usize| {
        let water = around(n, REACH).filter(|(m, _)| is_water[*m]);
        let (squared, level) =
            water.map(|(m, d)| (d, hi[m])).min_by(|a, b| a.0.total_cmp(&b.0).then(a.1.total_cmp(&b.1)))?;
        let is_lower = |m: usize| hi[m] < level || (hi[m] == level && !is_water[m]) || lowest[m] < level;
        let reach = NEARER * squared.sqrt();
        let mut beside = around(n, reach.ceil() as usize).filter(|(_, d)| *d <= reach * reach);
        (level > lo[n] && level < hi[n] && !beside.any(|(m, _)| is_lower(m))).then_some((n, level))
    };
    let floors = parallel::flat_map_each(&near, floor);
    floors.into_iter().for_each(|(n, level)| lo[n] = level);
}

/// Raises the lower bounds of ground that may come down to the level of water, of the sea as of lakes, a little above it. So a
/// height tells the ground from the water.
pub(super) fn keep_off_water(lo: &mut [f32], hi: &[f32], levels: impl Iterator<Item = f64>, interval: f64) {
    // Adding 0 makes 0 of -0.
    let mut levels: Vec<f32> = levels.map(|level| level as f32 + 0.0).collect();
    levels.sort_unstable_by(f32::total_cmp);
    for (lo, hi) in lo.iter_mut().zip(hi.iter()) {
        let raised = *lo + (ABOVE_WATER * interval) as f32;
        if raised < *hi && levels.binary_search_by(|level| level.total_cmp(&(*lo + 0.0))).is_ok() {
            *lo = raised;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two rows: water at level 5 in the first two columns, then ground between 0 and 10, and beyond column 12 below 0.
    #[test]
    fn only_ground_that_is_nearer_to_the_water_than_to_lower_ground_is_kept_above_it() {
        let cols = 14;
        let water = |n: usize| n % cols < 2;
        let is_water: Vec<bool> = (0..2 * cols).map(water).collect();
        let of = |in_water: f32, near: f32, far: f32| -> Vec<f32> {
            (0..2 * cols)
                .map(|n| {
                    if water(n) {
                        in_water
                    } else if n % cols < 12 {
                        near
                    } else {
                        far
                    }
                })
                .collect()
        };
        let (mut lo, mut hi) = (of(5.0, 0.0, -10.0), of(5.0, 10.0, 0.0));
        let mut lowest = vec![f32::INFINITY; 2 * cols];
        keep_above_lakes([&mut lo, &mut hi], &is_water, &lowest, cols);
        assert_eq!(lo[..cols], [5.0, 5.0, 5.0, 5.0, 5.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, -10.0, -10.0]);
        // A spot height below the lake, where ground begins to fall.
        (lo, lowest[4]) = (of(5.0, 0.0, -10.0), 4.0);
        keep_above_lakes([&mut lo, &mut hi], &is_water, &lowest, cols);
        assert_eq!(lo[..cols], [5.0, 5.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, -10.0, -10.0]);
        assert_eq!(hi, of(5.0, 10.0, 0.0));
    }

    #[test]
    fn ground_that_comes_down_to_water_stays_a_little_above_it() {
        let (mut lo, hi) = ([-0.0, 0.0, 0.0, 5.0, -10.0, f32::NAN], [10.0, 10.0, 0.0, 10.0, 0.0, f32::NAN]);
        keep_off_water(&mut lo, &hi, [0.0, 5.0].into_iter(), 10.0);
        assert_eq!(lo[..5], [0.01, 0.01, 0.0, 5.01, -10.0]);
    }

    #[test]
    fn heights_along_lines_are_known_at_each_node() {
        let grid = Grid { corner: DVec2::new(0.0, 2.0), cell: DVec2::ONE, cols: 5, rows: 2 };
        let points = [DVec3::new(0.5, 1.5, 8.0), DVec3::new(4.5, 1.5, 4.0)];
        let line = KnownLine { points: &points, is_stream: true, sure: &[] };
        let spots = [DVec3::new(2.4, 0.6, 1.0), DVec3::new(-9.0, 0.0, 0.0)];
        let lowest = lowest_known(&grid, spots.into_iter(), &[line]);
        assert_eq!(lowest[..5], [8.0, 7.0, 6.0, 5.0, 4.0]);
        assert_eq!(lowest[7], 1.0);
        assert_eq!(lowest.iter().filter(|z| z.is_finite()).count(), 6);
    }
}
