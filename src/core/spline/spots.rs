//! Makes the surface pass through spot heights.
//!
//! The solution comes near them: their heights are conditions on the edges between nodes. What is left is spread over the
//! ground around each, as a smooth bump that ends where the next contour or the next spot height is.

use glam::{DVec2, DVec3};
use rstar::RTree;

use super::lattice::Lattice;
use super::working_grid::WorkingGrid;

/// A spot height that the surface misses by less than this share of the contour interval is met.
const MET: f64 = 1e-4;
/// Most rounds. The bumps of neighbouring spot heights overlap, and between nodes the surface follows only some of a bump.
const ROUNDS: usize = 20;
/// Least radius of a bump, in steps between nodes. It holds the four nodes around any place.
const LEAST: f64 = 1.5;

/// Moves nodes around spot heights that the surface misses. Nodes stay within their bounds `lo` and `hi`. `spacing` is the mean
/// spacing of the contours, map units; no bump is wider.
pub(super) fn meet(spots: &[DVec3], working: &mut WorkingGrid, [lo, hi]: [&[f32]; 2], spacing: f64, interval: f64) {
    let lattice = Lattice::of_grid(&working.grid);
    let most = spacing / lattice.step.min_element();
    let places = spots.iter().map(|spot| lattice.place(spot.truncate()).to_array());
    let places: RTree<[f64; 2]> = RTree::bulk_load(places.collect());
    let bump = |spot: &DVec3| {
        let place = lattice.place(spot.truncate()).to_array();
        let other = places.nearest_neighbor_iter_with_distance_2(&place).map(|(_, d2)| d2).find(|&d2| d2 > 0.0);
        Bump::new(*spot, &lattice, [lo, hi], other.map_or(most, |d2| most.min(d2.sqrt())))
    };
    let bumps: Vec<Bump> = spots.iter().filter_map(bump).collect();
    for _ in 0..ROUNDS {
        let mut is_met = true;
        for bump in &bumps {
            let missed = bump.spot.z - f64::from(working.at(bump.spot.truncate()));
            if missed.abs() > MET * interval {
                is_met = false;
                bump.add(missed, &mut working.heights, &lattice, [lo, hi]);
            }
        }
        if is_met {
            break;
        }
    }
}

/// The ground that is moved with a spot height.
struct Bump {
    spot: DVec3,
    /// Column and row.
    place: DVec2,
    /// In steps between nodes.
    radius: f64,
}

impl Bump {
    /// A bump that reaches to the nearest node at which the height of the spot is not allowed. `None` off the grid.
    fn new(spot: DVec3, lattice: &Lattice, [lo, hi]: [&[f32]; 2], most: f64) -> Option<Self> {
        let place = lattice.place(spot.truncate());
        let size = DVec2::new(lattice.cols as f64, lattice.rows as f64);
        if place.cmplt(DVec2::ZERO).any() || place.cmpgt(size - 1.0).any() {
            return None;
        }
        let z = spot.z as f32;
        let whole = Self { spot, place, radius: most.max(LEAST) };
        let beyond = whole.nodes(lattice).filter(|&(n, _)| !(lo[n] <= z && z <= hi[n])).map(|(_, distance)| distance);
        let radius = beyond.fold(whole.radius, f64::min).max(LEAST);
        Some(Self { radius, ..whole })
    }

    /// The nodes within the radius, with their distances, in steps.
    fn nodes(&self, lattice: &Lattice) -> impl Iterator<Item = (usize, f64)> {
        let (place, radius, cols) = (self.place, self.radius, lattice.cols);
        let range = |at: f64, count: usize| {
            let last = count as f64 - 1.0;
            (at - radius).ceil().clamp(0.0, last) as usize..=(at + radius).floor().clamp(0.0, last) as usize
        };
        let columns = range(place.x, cols);
        range(place.y, lattice.rows)
            .flat_map(move |row| columns.clone().map(move |col| (row * cols + col, DVec2::new(col as f64, row as f64))))
            .map(move |(node, at)| (node, at.distance(place)))
            .filter(move |(_, distance)| *distance < radius)
    }

    fn add(&self, by: f64, heights: &mut [f32], lattice: &Lattice, [lo, hi]: [&[f32]; 2]) {
        for (n, distance) in self.nodes(lattice) {
            let share = 1.0 - (distance / self.radius).powi(2);
            let height = f64::from(heights[n]) + by * share * share;
            if !height.is_nan() && !lo[n].is_nan() {
                heights[n] = (height as f32).clamp(lo[n], hi[n]);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::Grid;

    #[test]
    fn the_surface_passes_through_spot_heights_and_stays_in_its_band() {
        let grid = Grid { corner: DVec2::new(-0.5, 40.5), cell: DVec2::ONE, cols: 41, rows: 41 };
        // Ground that rises to the east, and a contour at its middle.
        let ground = |n: usize| (n % 41) as f32 / 2.0;
        let lo: Vec<f32> = (0..grid.len()).map(|n| if n % 41 < 20 { 0.0 } else { 10.0 }).collect();
        let hi: Vec<f32> = lo.iter().map(|lo| lo + 10.0).collect();
        let spots = [
            DVec3::new(10.0, 20.0, 5.6),
            DVec3::new(12.3, 20.8, 6.0),
            DVec3::new(17.5, 31.2, 8.9),
            DVec3::new(30.5, 8.5, 14.4),
            DVec3::new(99.0, 8.5, 14.4),
        ];
        let mut working = WorkingGrid { grid, heights: (0..grid.len()).map(ground).collect() };
        meet(&spots, &mut working, [&lo, &hi], 9.0, 10.0);
        let mut moved = 0;
        for (n, &height) in working.heights.iter().enumerate() {
            assert!(lo[n] <= height && height <= hi[n]);
            let p = DVec2::new((n % 41) as f64, 40.0 - (n / 41) as f64);
            let is_near = spots.iter().any(|spot| spot.truncate().distance(p) < 9.0);
            assert!(is_near || height == ground(n), "{p}");
            moved += usize::from(height != ground(n));
        }
        assert!(moved > 100);
        for spot in &spots[..4] {
            let missed = (f64::from(working.at(spot.truncate())) - spot.z).abs();
            assert!(missed <= MET * 10.0, "{spot}: {missed}");
        }
    }

    #[test]
    fn spot_heights_close_to_each_other_are_met() {
        let grid = Grid { corner: DVec2::new(-0.5, 60.5), cell: DVec2::ONE, cols: 61, rows: 61 };
        let (lo, hi) = (vec![0.0; grid.len()], vec![20.0; grid.len()]);
        // Rough ground, known at every third node.
        let ground = |x: f64, y: f64| 10.0 + 4.0 * (x * 0.9).sin() * (y * 0.7).cos();
        let spots: Vec<DVec3> = (1..400)
            .map(|k| DVec2::new(f64::from(k % 20) * 3.0, f64::from(k / 20) * 3.0))
            .map(|p| p.extend(ground(p.x, p.y)))
            .collect();
        let mut working = WorkingGrid { grid, heights: vec![10.0; grid.len()] };
        meet(&spots, &mut working, [&lo, &hi], 30.0, 20.0);
        for spot in &spots {
            let missed = (f64::from(working.at(spot.truncate())) - spot.z).abs();
            assert!(missed <= MET * 20.0, "{spot}: {missed}");
        }
    }
}
