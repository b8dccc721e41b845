//! Even ground on flats.
//!
//! On wide, nearly level ground the surface still bends at ridge and canyon lines and at the edges of large triangles. They are lines a
//! node wide, of a few centimetres, and nothing on the map shows them; but a hillshade does, and water follows them. So heights there
//! become the mean of those around, the more often the further they are from all contours and other known heights. No height leaves
//! its band by that: all that is averaged lies in one band.

use glam::DVec2;

use super::at_contour::is_at_contour;
use super::conditions::Conditions;
use super::lattice::{Crossing, Lattice};
use super::steps::distances;
use crate::base::parallel;
use crate::tuning::SplineTuning;

/// How far each round moves a height towards the mean of its four neighbours.
const PACE: f32 = 0.5;

/// Makes level ground even, in rounds: those of a node are as many as it is nodes away from known heights.
pub fn even_out(heights: &mut [f32], conditions: &Conditions<'_>, contour_density: &[f32], tuning: &SplineTuning) {
    even(heights, [conditions.grid.cols, conditions.grid.rows], &known(conditions), contour_density, tuning);
}

fn even(heights: &mut [f32], [cols, rows]: [usize; 2], known: &[bool], contour_density: &[f32], tuning: &SplineTuning) {
    let most = tuning.flat_rounds as f32 + 1.0;
    let distances = distances(|n| known[n], [cols, rows], (most, most));
    let [whole, none] = tuning.flat_densities;
    let share = |n: usize| PACE * ((none - contour_density[n]) / (none - whole)).clamp(0.0, 1.0);
    let is_inner = |n: usize| (1..cols - 1).contains(&(n % cols)) && (1..rows - 1).contains(&(n / cols));
    let is_flat = |n: &usize| distances[*n] > 1.0 && is_inner(*n) && share(*n) > 0.0 && !heights[*n].is_nan();
    let mut flat: Vec<usize> = (0..heights.len()).filter(is_flat).collect();
    for round in 1..=tuning.flat_rounds {
        flat.retain(|n| distances[*n] > round as f32);
        let old = &*heights;
        let moved: Vec<f32> = parallel::values_each(&flat, |&n| {
            let around = [n - 1, n + 1, n - cols, n + cols].map(|m| if old[m].is_nan() { old[n] } else { old[m] });
            old[n] + share(n) * (around.iter().sum::<f32>() / 4.0 - old[n])
        });
        flat.iter().zip(moved).for_each(|(&n, z)| heights[n] = z);
    }
}

/// The nodes at both ends of the edges that contours, streams, break lines and cliffs cross, those around spot heights, and those beside
/// another band, such as at the shores of lakes.
fn known(conditions: &Conditions<'_>) -> Vec<bool> {
    let lattice = Lattice::of_grid(&conditions.grid);
    let cols = conditions.grid.cols;
    let mut known = parallel::values(conditions.grid.len(), |n| {
        conditions.bounds.iter().any(|bound| is_at_contour(bound, n, cols))
    });
    let mut mark = |line: &[DVec2]| {
        let (mut east, mut south) = (Vec::new(), Vec::new());
        lattice.cross(
            line,
            |crossing: Crossing| east.push(crossing.node as usize),
            |crossing| south.push(crossing.node as usize),
        );
        let ends = east.into_iter().flat_map(|n| [n, n + 1]).chain(south.into_iter().flat_map(|n| [n, n + cols]));
        ends.for_each(|n| known[n] = true);
    };
    conditions.contours.iter().for_each(|(_, points)| mark(points));
    conditions.cliffs.iter().for_each(|points| mark(points));
    let streams = conditions.streams.iter().map(|stream| stream.known());
    streams.chain(conditions.known.iter().copied()).for_each(|line| mark(&line.course()));
    let soft = conditions.soft_spots.iter().map(|spot| spot.place);
    for spot in conditions.spots.iter().copied().chain(soft) {
        let near = lattice.place(spot.truncate()).floor();
        for corner in [DVec2::ZERO, DVec2::X, DVec2::Y, DVec2::ONE] {
            let at = near + corner;
            let is_on_grid = at.cmpge(DVec2::ZERO).all() && at.x < cols as f64 && at.y < conditions.grid.rows as f64;
            if is_on_grid {
                known[at.y as usize * cols + at.x as usize] = true;
            }
        }
    }
    known
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_ditch_on_a_flat_goes_and_one_near_a_contour_or_on_a_slope_stays() {
        let (cols, rows) = (40, 21);
        // A ditch a node wide from west to east; the contour is the northern row.
        let depth = |after: &[f32], col: usize, row: usize| after[(row - 1) * cols + col] - after[row * cols + col];
        let evened = |row: usize, density: f32| {
            let mut heights: Vec<f32> = (0..cols * rows).map(|n| if n / cols == row { 9.0 } else { 10.0 }).collect();
            heights[cols * rows - 2] = f32::NAN;
            let known: Vec<bool> = (0..cols * rows).map(|n| n < cols).collect();
            even(&mut heights, [cols, rows], &known, &vec![density; cols * rows], &SplineTuning::default());
            assert!(heights[cols * rows - 2].is_nan());
            assert!(heights.iter().all(|z| z.is_nan() || (9.0..=10.0).contains(z)));
            depth(&heights, 20, row)
        };
        assert!(evened(12, 0.02) < 0.1, "{}", evened(12, 0.02));
        assert_eq!(evened(1, 0.02), 1.0, "beside a contour");
        assert_eq!(evened(12, 1.0), 1.0, "where contours are as dense as usual");
    }
}
