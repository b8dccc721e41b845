//! Shrinkage of heights towards the centre of their band. The shrunken height is the expected one where the surface has
//! an error.
//!
//! Between two levels, about the same amount of ground lies at each height. So a surface with random errors that comes
//! close to a level is more often too close than not close enough. Let heights be uniform over a band of height H, and
//! errors have the variance s². By linear regression, the mean of the true heights where the surface has the height z
//! is, to the first order,
//!
//! ```text
//! z + 12 s² / H² · (m - z)
//! ```
//!
//! where m is the middle of the band. The variance of uniform heights is H² / 12.
//!
//! The contours themselves are known. So s² is 0 at both levels and largest half-way. It follows 4 t (1 - t), where t
//! is the share of the band below z. A random path between two fixed ends has this variance (Brownian bridge). Hidden
//! contours give its mean half-way.
//!
//! The variance is larger where contours are far apart and where the ground is uneven. On even slopes heights shrink
//! less: the ground between contours is nearly certain there, and shrinkage would show as waves.
//!
//! Heights below a contour move down as much as heights above it move up. So the surface still meets the contour.

use super::blur::{PASSES, blurred};
use super::lattice::{Crossing, Lattice};
use super::unevenness::unevenness;
use crate::base::parallel;
use crate::tuning::ShrinkageTuning;

/// Variance of heights that are uniform over a band, as a share of the square of its height: a closed form.
const EVEN: f32 = 1.0 / 12.0;
/// How far around a spot height the ground is known better, as a share of the distance between contours there.
const SPOT_REACH: f64 = 0.5;

/// The standard error of a surface half-way between contours.
#[derive(Debug, Clone, Copy)]
pub struct HalfWay {
    /// Its root mean square over the places where it was measured, metres.
    pub error: f64,
    /// The mean of the [relative variance](Relative) at these places, on surfaces with half of the levels. If it is 0, the mean
    /// of the surface itself takes its place.
    pub relative: f64,
}

/// The variance half-way between two contours at each node, relative to other nodes.
pub struct Relative {
    /// It grows with the distance between contours and with the unevenness of the ground.
    pub variance: Vec<f32>,
    /// The distance between contours, mean spacings.
    spacing: Vec<f32>,
}

impl Relative {
    /// `spacing` is the mean spacing of the contours, map units. `contour_density` is their relative density. `heights` are NaN
    /// outside the frame.
    pub fn new(
        heights: &[f32],
        contour_density: &[f32],
        spacing: f64,
        lattice: &Lattice,
        tuning: &ShrinkageTuning,
    ) -> Self {
        let nodes = spacing / (lattice.step.x * lattice.step.y).sqrt();
        let mut spacing: Vec<f32> = parallel::values_each(contour_density, |contour_density| 1.0 / contour_density);
        // Outside the frame there is no spacing; the mean of the map takes its place.
        parallel::update(&mut spacing, |n, spacing| {
            if heights[n].is_nan() {
                *spacing = 1.0;
            }
        });
        for _ in 0..PASSES {
            spacing = blurred(&spacing, lattice.cols, (tuning.spacing_reach * nodes) as usize);
        }
        let mut variance = unevenness(heights, lattice, (tuning.unevenness_reach * nodes).max(1.0) as usize);
        parallel::update(&mut variance, |n, v| *v = (*v * spacing[n]).powf(tuning.power));
        Self { variance, spacing }
    }

    /// The variance at each node, square metres. `spots` are places where the ground is known.
    pub fn variances(
        self,
        half_way: HalfWay,
        heights: &[f32],
        (contour_density, spacing): (&[f32], f64),
        lattice: &Lattice,
        spots: &[(Crossing, f64)],
        tuning: &ShrinkageTuning,
    ) -> Vec<f32> {
        let Self { variance: mut variances, spacing: spacings } = self;
        let step = (lattice.step.x * lattice.step.y).sqrt();
        let nodes = spacing / step;
        let inside = || variances.iter().zip(heights).filter(|(_, z)| !z.is_nan());
        let count = inside().count() as f64;
        let relative = match half_way.relative {
            0.0 => inside().map(|(v, _)| f64::from(*v)).sum::<f64>() / count,
            // With half of the levels and nodes twice as far apart, ground looks more uneven.
            known => known / (1.0 + tuning.trial_nodes / nodes),
        };
        let whole = (half_way.error * half_way.error / relative).min(f64::from(f32::MAX)) as f32;
        let whole = if relative > 0.0 { whole } else { 0.0 };
        let known = |spacing: f32| 1.0 + (tuning.half_variance_nodes / (nodes as f32 * spacing)).powi(3);
        parallel::update(&mut variances, |n, v| *v *= whole / known(spacings[n]));
        // At most the mean distance between spot heights. Otherwise many spot heights would take much time.
        let mean_distance = step * (count / spots.len().max(1) as f64).sqrt();
        for (crossing, _) in spots {
            let node = crossing.node as usize;
            let reach = (spacing * SPOT_REACH / f64::from(contour_density[node])).min(mean_distance);
            for_each_near(lattice, node, reach, |n, share| variances[n] *= share);
        }
        variances
    }
}

/// Calls `at` for the nodes that are nearer than `reach` to a node. The share grows from 0 at the node to 1 at `reach`.
fn for_each_near(lattice: &Lattice, node: usize, reach: f64, mut at: impl FnMut(usize, f32)) {
    let (col, row) = (node % lattice.cols, node / lattice.cols);
    let [across, down] = [reach / lattice.step.x, reach / lattice.step.y].map(|nodes| nodes as usize);
    for j in row.saturating_sub(down)..(row + down + 1).min(lattice.rows) {
        for i in col.saturating_sub(across)..(col + across + 1).min(lattice.cols) {
            let [x, y] = [i.abs_diff(col) as f64 * lattice.step.x, j.abs_diff(row) as f64 * lattice.step.y];
            let left = 1.0 - (x * x + y * y) / (reach * reach);
            if left > 0.0 {
                at(j * lattice.cols + i, (1.0 - left * left) as f32);
            }
        }
    }
}

/// Shrinks heights between `bounds` towards the centre of the band, by at most `most` of their distance from it
/// ([`ShrinkageTuning::max_share`]).
pub fn shrink(heights: &mut [f32], bounds: [&[f32]; 2], variances: &[f32], most: f32) {
    parallel::update(heights, |n, z| {
        let (lo, height) = (bounds[0][n], bounds[1][n] - bounds[0][n]);
        if height > 0.0 {
            let t = ((*z - lo) / height).clamp(0.0, 1.0);
            let by = share(variances[n] / (height * height), most) * 4.0 * t * (1.0 - t) * (0.5 - t);
            *z = (*z + height * by).clamp(lo, bounds[1][n]);
        }
    });
}

/// The shrinkage as a share of the distance from the centre. `variance` is in squares of the height of the band.
fn share(variance: f32, most: f32) -> f32 {
    (variance / EVEN).min(most)
}

/// The standard error that remains after shrinkage, in a band of `height`.
pub fn remaining_error(error: f64, height: f64, most: f32) -> f64 {
    let share = if height > 0.0 { share((error / height).powi(2) as f32, most) } else { 0.0 };
    error * (1.0 - f64::from(share)).sqrt()
}

#[cfg(test)]
mod tests {
    use glam::DVec2;

    use super::super::lattice::CrossingKind;
    use super::*;

    const LATTICE: Lattice = Lattice { first: DVec2::ZERO, step: DVec2::ONE, cols: 400, rows: 60 };
    const MOST: f32 = 0.5;

    fn variances(heights: &[f32], contour_density: &[f32], spacing: f64, spots: &[(Crossing, f64)]) -> Vec<f32> {
        let (tuning, half_way) = (ShrinkageTuning::default(), HalfWay { error: 2.0, relative: 0.0 });
        let relative = Relative::new(heights, contour_density, spacing, &LATTICE, &tuning);
        relative.variances(half_way, heights, (contour_density, spacing), &LATTICE, spots, &tuning)
    }

    #[test]
    fn levels_and_the_middle_stay_and_heights_keep_their_order() {
        let count = 101;
        for variance in [1.0, 20.0, 1e9] {
            let mut z: Vec<f32> = (0..count).map(|k| 200.0 + 20.0 * k as f32 / 100.0).collect();
            let before = z.clone();
            let bounds = [vec![200.0; count], vec![220.0; count]];
            shrink(&mut z, [&bounds[0], &bounds[1]], &vec![variance; count], MOST);
            assert_eq!([z[0], z[50], z[100]], [200.0, 210.0, 220.0]);
            assert!(z.windows(2).all(|w| w[0] < w[1]), "{variance}: {z:?}");
            for k in 1..50 {
                assert!(z[k] > before[k] && (z[k] + z[100 - k] - 420.0).abs() < 1e-3, "{variance} {k}");
            }
        }
        // 12 · 1 / 400 of 5 m, three quarters of it because t is a quarter.
        let mut quarter = [205.0];
        shrink(&mut quarter, [&[200.0], &[220.0]], &[1.0], MOST);
        assert!((quarter[0] - 205.0 - 0.75 * 12.0 / 400.0 * 5.0).abs() < 1e-4, "{quarter:?}");
        let mut water = [7.0, f32::NAN];
        shrink(&mut water, [&[7.0, f32::NAN], &[7.0, f32::NAN]], &[1.0, 1.0], MOST);
        assert!(water[0] == 7.0 && water[1].is_nan());
    }

    #[test]
    fn an_estimate_of_uniform_heights_is_nearer_to_them_after_shrinkage() {
        // Heights are uniform over a band, and errors end at its levels.
        let next = |state: &mut u64| {
            *state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (*state >> 40) as f32 / (1u64 << 24) as f32
        };
        let mut state = 7;
        let (mut before, mut after, deviation) = (0.0, 0.0, 1.5f32);
        for _ in 0..20_000 {
            let truth = 10.0 * next(&mut state);
            let wide = (truth / 10.0 * (1.0 - truth / 10.0) * 4.0).sqrt() * deviation * 3.0f32.sqrt();
            let mut z = [(truth + wide * (2.0 * next(&mut state) - 1.0)).clamp(0.0, 10.0)];
            before += (z[0] - truth).powi(2);
            shrink(&mut z, [&[0.0], &[10.0]], &[deviation * deviation], MOST);
            after += (z[0] - truth).powi(2);
        }
        assert!(after < 0.95 * before, "{after} {before}");
    }

    #[test]
    fn the_variance_is_that_of_hidden_contours_in_the_mean_and_none_at_a_spot_height() {
        let tuning = ShrinkageTuning::default();
        let (count, cols, east) = (LATTICE.len(), LATTICE.cols, 30 * 400 + 300);
        let spot = Crossing { node: east as u32, along: 0.0, kind: CrossingKind::Chord };
        // Contours are three times as close in the west as in the east.
        let contour_density: Vec<f32> = (0..count).map(|n| if n % cols < cols / 2 { 1.5 } else { 0.5 }).collect();
        // Level ground counts as uneven everywhere.
        let level = vec![0.0; count];
        let found = |spacing: f64, spots: &[(Crossing, f64)]| variances(&level, &contour_density, spacing, spots);
        let free = found(30.0, &[]);
        assert!((free.iter().sum::<f32>() / count as f32 - 4.0).abs() < 0.05);
        assert!((free[east] / free[0] - 3f32.powf(tuning.power)).abs() < 0.05);
        // There is no step between the two halves.
        assert!(free.windows(2).take(cols - 1).all(|w| (w[1] - w[0]).abs() < 0.1 * free[east]));
        // Where there is hardly a node between contours, there is hardly an error.
        assert!(found(1.0, &[])[0] < 0.01 * free[0]);
        let known = found(30.0, &[(spot, 5.0)]);
        assert_eq!((known[east], known[east + 31]), (0.0, free[east + 31]));
        assert!(known[east + 9] > 0.0 && known[east + 9] < free[east + 9]);
    }

    #[test]
    fn even_slopes_have_hardly_any_of_the_variance() {
        let cols = LATTICE.cols;
        // A plane in the west, hills in the east.
        let hills = |i: f32, j: f32| if i < 200.0 { 0.3 * i } else { 60.0 + 9.0 * (i / 5.0).sin() * (j / 5.0).cos() };
        let heights: Vec<f32> = (0..LATTICE.len()).map(|n| hills((n % cols) as f32, (n / cols) as f32)).collect();
        let found = variances(&heights, &vec![1.0; heights.len()], 30.0, &[]);
        assert!((found.iter().sum::<f32>() / found.len() as f32 - 4.0).abs() < 0.05);
        assert!(found[30 * cols + 100] < 0.01 && found[30 * cols + 300] > 5.0);
        let plane: Vec<f32> = (0..LATTICE.len()).map(|n| (n % cols) as f32).collect();
        let found = variances(&plane, &vec![1.0; plane.len()], 30.0, &[]);
        assert!(found.iter().all(|v| v.is_finite()));
    }

    #[test]
    fn less_is_left_of_errors_that_are_large_for_the_band() {
        assert_eq!((remaining_error(0.0, 10.0, MOST), remaining_error(1.0, 0.0, MOST)), (0.0, 1.0));
        assert!((remaining_error(1.0, 10.0, MOST) - 0.88f64.sqrt()).abs() < 1e-6);
        assert!((remaining_error(9.0, 10.0, MOST) - 9.0 * 0.5f64.sqrt()).abs() < 1e-6);
    }
}
