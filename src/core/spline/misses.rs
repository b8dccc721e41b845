//! What a surface on a grid misses at the contours.
//!
//! Where several contours pass between two nodes, the nodes do not tell where. What the surface misses at the vertices of the
//! contours is then linear in the triangles between them.

use glam::DVec2;

use super::conditions::Conditions;
use super::working_grid::WorkingGrid;
use crate::base::parallel;
use crate::geometry::{Segment, point_distance};
use crate::tin::{NONE, Tin};

/// Distances between contours, in steps between nodes, up to which misses count in full, and from which they do not count. Where
/// contours are further apart, the nodes tell enough.
const REACH: [f64; 2] = [1.0, 2.0];

/// What a surface misses at the contours.
pub(crate) struct Misses<'a> {
    tin: &'a Tin,
    /// At the vertices of the triangulation, metres; 0 off the contours.
    at_vertices: Vec<f32>,
    /// The step between nodes, map units.
    step: f64,
}

impl<'a> Misses<'a> {
    /// `levels` are those of the contours at the vertices of `tin`, NaN elsewhere. `at` gives the surface at a map position;
    /// its nodes are `step` apart.
    pub fn new(tin: &'a Tin, levels: &[f32], step: f64, at: impl Fn(DVec2) -> f32 + Sync) -> Self {
        let missed = |v: usize| {
            let missed = if levels[v].is_nan() { 0.0 } else { levels[v] - at(tin.positions[v] + tin.origin) };
            if missed.is_nan() { 0.0 } else { missed }
        };
        Self { tin, at_vertices: parallel::values(levels.len(), missed), step }
    }

    /// What is missed at a place in triangle `t`, relative to the origin of the triangulation, metres.
    pub fn at(&self, t: u32, place: DVec2) -> f32 {
        let missed = self.tin.triangles[t as usize].map(|v| self.at_vertices[v as usize]);
        let share = if missed == [0.0; 3] { 0.0 } else { self.share(t).min(self.share_beside(t, place, missed)) };
        if share == 0.0 {
            return 0.0;
        }
        // A place at the border of a sliver may have any weights, by rounding.
        let weights = self.tin.weights(t, place).map(|weight| weight.clamp(0.0, 1.0) as f32);
        let sum: f32 = weights.into_iter().zip(missed).map(|(weight, missed)| weight * missed).sum();
        if sum.is_nan() { 0.0 } else { share * sum }
    }

    /// How far the misses count in triangle `t`, 0 to 1. It depends on the shortest way from one level to another.
    fn share(&self, t: u32) -> f32 {
        let heights = self.tin.corner_heights(t);
        let across = (0..3).filter(|&i| heights[i] != heights[(i + 1) % 3]).map(|i| self.tin.edge_length(t, i));
        self.share_within(across.fold(f64::INFINITY, f64::min))
    }

    /// How far they count at a place in triangle `t`, 0 to 1. It depends on the way to the contours of the triangle: long
    /// triangles reach far from them, such as those across lakes.
    fn share_beside(&self, t: u32, place: DVec2, missed: [f32; 3]) -> f32 {
        let corners = self.tin.corners(t);
        let contours = (0..3).filter(|&i| self.tin.contour_level(t, i).is_some());
        let to_contour = contours.map(|i| point_distance(place, &Segment { a: corners[i], b: corners[(i + 1) % 3] }));
        let vertices = corners.into_iter().zip(missed).filter(|(_, missed)| *missed != 0.0);
        let to_vertex = vertices.map(|(corner, _)| corner.distance(place));
        self.share_within(to_contour.chain(to_vertex).fold(f64::INFINITY, f64::min))
    }

    fn share_within(&self, distance: f64) -> f32 {
        let [full, none] = REACH;
        ((none - distance / self.step) / (none - full)).clamp(0.0, 1.0) as f32
    }
}

/// Adds to the nodes what the surface misses at the contours around them. Nodes stay within their bounds `lo` and `hi`.
pub(super) fn add_misses(working: &mut WorkingGrid, conditions: &Conditions<'_>, [lo, hi]: [&[f32]; 2]) {
    let Conditions { tin, levels, triangles, beside_cliffs, grid, .. } = conditions;
    let misses = Misses::new(tin, levels, grid.cell.max_element(), |p| working.at(p));
    parallel::update(&mut working.heights, |n, height| {
        // Across a cliff, the surface between nodes tells nothing.
        if triangles[n] != NONE && beside_cliffs.get(n) != Some(&true) {
            let place = grid.center(n % grid.cols, n / grid.cols) - tin.origin;
            *height = (*height + misses.at(triangles[n], place)).clamp(lo[n], hi[n]);
        }
    });
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tin::{TinInput, VertexKind, triangulate};

    /// What level ground at 0 misses at places (x, 4.3), if contours at these x have the levels of a parabola.
    fn missed(lines: impl Iterator<Item = f64>, places: &[f64]) -> Vec<f32> {
        let mut input = TinInput::new([DVec2::ZERO, DVec2::new(100.0, 8.0)], 0.0);
        for x in lines {
            let line: Vec<DVec2> = (0..=16).map(|k| DVec2::new(x, f64::from(k) / 2.0)).collect();
            input.push_line(&line, x * x, VertexKind::Contour);
        }
        let tin = triangulate(input).unwrap();
        let levels: Vec<f32> = tin.heights.iter().map(|z| *z as f32).collect();
        let misses = Misses::new(&tin, &levels, 1.0, |_| 0.0);
        let at = |&x: &f64| {
            let place = DVec2::new(x, 4.3) - tin.origin;
            misses.at(tin.locate(0, place).unwrap(), place)
        };
        places.iter().map(at).collect()
    }

    #[test]
    fn what_is_missed_between_dense_contours_follows_them_and_ends_where_they_are_far_apart() {
        let places = [0.1, 1.0, 2.37, 7.99];
        let dense = missed((0..=40).map(|k| f64::from(k) / 4.0), &places);
        for (missed, x) in dense.iter().zip(places) {
            assert!((f64::from(*missed) - x * x).abs() < 0.02, "{missed} at {x}");
        }
        let sparse = missed([0.0, 10.0, 20.0].into_iter(), &[1.0, 5.0, 13.0]);
        assert_eq!(sparse, [0.0; 3]);
    }

    #[test]
    fn nothing_is_missed_in_the_middle_of_long_triangles() {
        // Two shores, and a place beside one of them that lies lower.
        let mut input = TinInput::new([DVec2::ZERO, DVec2::new(100.0, 8.0)], 0.0);
        for x in [0.0, 100.0] {
            let line: Vec<DVec2> = (0..=4).map(|k| DVec2::new(x, 2.0 * f64::from(k))).collect();
            input.push_line(&line, 60.0, VertexKind::Contour);
        }
        input.push(DVec2::new(0.5, 5.0), 52.0, VertexKind::Axis);
        let tin = triangulate(input).unwrap();
        let levels: Vec<f32> = tin.heights.iter().map(|z| if *z == 60.0 { 60.0 } else { f32::NAN }).collect();
        let misses = Misses::new(&tin, &levels, 1.0, |_| 55.0);
        let at = |x: f64, y: f64| {
            let place = DVec2::new(x, y) - tin.origin;
            misses.at(tin.locate(0, place).unwrap(), place)
        };
        assert!(at(0.3, 5.0) > 1.0, "{}", at(0.3, 5.0));
        for y in [1.0, 4.9, 5.1, 7.0] {
            assert!([3.0, 20.0, 50.0, 80.0, 97.0].iter().all(|&x| at(x, y) == 0.0), "{y}");
        }
    }
}
