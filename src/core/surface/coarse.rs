//! The error of a smooth surface whose nodes are further apart than the contours ask for.

use glam::DVec2;

use super::groups::Groups;
use super::params::SurfaceParams;
use crate::base::Grid;
use crate::base::error::{Finding, FindingKind};
use crate::spline::{PASSES, WorkingGrids, blurred, coarser_than_asked};
use crate::subdivision::Subdivision;
use crate::subdomains::MapExtent;
use crate::validate::{Accuracy, Chosen};

/// Most places on contours at which the surface is compared with them, about.
const PLACES: f64 = 100_000.0;
/// Places that a mean of the misfit around a node is taken over, about.
const PLACES_AROUND: f64 = 20.0;
/// 90 % of normally distributed errors are within this many standard errors.
const WITHIN_90: f64 = 1.645;

/// How far a surface misses the contours that it was made from.
pub(super) struct Misfit {
    /// Places on contours, each with the square of its difference, square metres.
    squares: Vec<(DVec2, f64)>,
    /// Root mean square over all places, metres.
    rms: f64,
}

/// Reports a surface whose nodes are too far apart, and adds its misfit at the contours to the expected error of the whole map.
pub(super) fn account_for_coarse_nodes(
    subdivision: &Subdivision,
    groups: &Groups,
    working: &WorkingGrids,
    params: &SurfaceParams,
    chosen: Option<&mut Chosen>,
) -> Option<(Finding, Misfit)> {
    let coarser = |extent: &MapExtent<'_>| coarser_than_asked(extent, params.spline.wanted, &params.tuning.spline.grid);
    let of_groups = groups.extents(subdivision, coarser).into_iter().flatten();
    let [asked, least] = of_groups.max_by(|[a, b], [c, d]| (b / a).total_cmp(&(d / c)))?;
    let misfit = Misfit::of(subdivision, working, least);
    let rms = misfit.rms;
    if let Some(implied) = chosen.and_then(|chosen| chosen.implied.as_mut()) {
        let Accuracy { rmse, le90, .. } = *implied;
        *implied = Accuracy { rmse: rmse.hypot(rms), le90: le90.hypot(WITHIN_90 * rms), ..*implied };
    }
    let message = format!(
        "the nodes of the smooth surface are {least:.1} map units apart, and the contours ask for {asked:.1} map units: the map \
         is too wide for its number of vertices. The surface misses the contours by {rms:.2} m (RMS). Set the border of the map \
         with --frame, or make parts of it with --extent"
    );
    Some((Finding::general(FindingKind::CoarseNodes, message), misfit))
}

impl Misfit {
    /// The misfit at places about `step` apart along the contours, or further if there would be too many.
    fn of(subdivision: &Subdivision, working: &WorkingGrids, step: f64) -> Self {
        let contours = &subdivision.map.contours;
        let step = step.max(contours.iter().map(|line| line.length()).sum::<f64>() / PLACES);
        let square = |p: DVec2, level: f64| (p, (f64::from(working.at(p)) - level).powi(2));
        let squares = contours.iter().flat_map(|line| places(&line.points, step).map(|p| square(p, line.elevation)));
        let squares: Vec<(DVec2, f64)> = squares.filter(|(_, square)| square.is_finite()).collect();
        let rms = (squares.iter().map(|(_, square)| square).sum::<f64>() / squares.len().max(1) as f64).sqrt();
        Self { squares, rms }
    }

    /// The root mean square around each node of a grid, metres. Far from all places it is that of the whole map.
    pub(super) fn at_nodes(&self, grid: &Grid) -> Vec<f32> {
        let mut sums = vec![0.0f32; grid.len()];
        let mut counts = sums.clone();
        for (p, square) in &self.squares {
            let place = grid.place(*p).round();
            let size = DVec2::new(grid.cols as f64, grid.rows as f64);
            if place.cmpge(DVec2::ZERO).all() && place.cmplt(size).all() {
                let node = place.y as usize * grid.cols + place.x as usize;
                sums[node] += *square as f32;
                counts[node] += 1.0;
            }
        }
        let nodes_around = PLACES_AROUND * grid.len() as f64 / self.squares.len().max(1) as f64;
        let reach = (0.5 * nodes_around.sqrt()).ceil();
        for _ in 0..PASSES {
            [&mut sums, &mut counts]
                .into_iter()
                .for_each(|values| *values = blurred(values, grid.cols, reach as usize));
        }
        // One more place with the misfit of the whole map: a few places around a node say little.
        let further = 1.0 / (2.0 * reach + 1.0).powi(2);
        let mean = |sum: f32, count: f32| (f64::from(sum) + further * self.rms.powi(2)) / (f64::from(count) + further);
        sums.iter().zip(&counts).map(|(sum, count)| mean(sum.max(0.0), count.max(0.0)).sqrt() as f32).collect()
    }
}

/// Places along a line, `step` apart, from its first vertex on.
fn places(line: &[DVec2], step: f64) -> impl Iterator<Item = DVec2> + '_ {
    let mut next = 0.0;
    line.windows(2).flat_map(move |ends| {
        let (first, length) = (next, ends[0].distance(ends[1]));
        let count = ((length - first) / step).ceil().max(0.0);
        next = first + count * step - length;
        (0..count as usize).map(move |k| ends[0].lerp(ends[1], (first + k as f64 * step) / length))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn places_are_a_step_apart_along_the_line() {
        let line = [DVec2::ZERO, DVec2::new(2.5, 0.0), DVec2::new(2.5, 0.2), DVec2::new(2.5, 3.0)];
        let found: Vec<DVec2> = places(&line, 1.0).collect();
        let expected = [(0.0, 0.0), (1.0, 0.0), (2.0, 0.0), (2.5, 0.5), (2.5, 1.5), (2.5, 2.5)].map(DVec2::from);
        assert!(found.len() == 6 && found.iter().zip(expected).all(|(p, q)| p.distance(q) < 1e-12), "{found:?}");
    }

    #[test]
    fn the_misfit_around_a_node_is_that_of_the_places_there() {
        let grid = Grid { corner: DVec2::new(0.0, 50.0), cell: DVec2::ONE, cols: 200, rows: 50 };
        // Along the western third of the map the surface misses by 3 m, along the middle third by nothing.
        let place = |k: usize| DVec2::new(0.5 + (k % 133) as f64, 0.5 + (k / 133) as f64);
        let squares = (0..133 * 50).map(|k| (place(k), if k % 133 < 66 { 9.0 } else { 0.0 })).collect();
        let misfit = Misfit { squares, rms: 2.0 };
        let found = misfit.at_nodes(&grid);
        let at = |col: usize| f64::from(found[25 * grid.cols + col]);
        assert!((at(10) - 3.0).abs() < 0.1 && at(120) < 0.5, "{} {}", at(10), at(120));
        assert!((at(190) - 2.0).abs() < 1e-6, "{}", at(190));
        assert!(at(66) > 1.0 && at(66) < 3.0, "{}", at(66));
    }
}
