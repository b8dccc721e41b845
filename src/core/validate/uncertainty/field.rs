//! The expected error of a surface at the nodes of the working grid, on cells and along lines.

use glam::DVec2;

use super::model::{ErrorModel, PlaceInBand, unfixed_share};
use super::residuals::hidden_residuals;
use super::sides::sides;
use crate::base::{Grid, parallel};
use crate::contour::LineError;
use crate::raster::{heights_at, locate};
use crate::spline::{blurred, slopes};
use crate::subdivision::Subdivision;
use crate::subdomains::{MapExtent, Region, Side};
use crate::tuning::Tuning;
use crate::validate::builder::TrialParams;
use crate::validate::choose::Chosen;
use crate::validate::roughness;

/// The expected error of a surface.
#[derive(Debug, Clone, PartialEq)]
pub struct ErrorField {
    /// The error model that it follows.
    pub model: ErrorModel,
    /// The errors on each working grid.
    pub parts: Vec<ErrorGrid>,
}

/// The expected error of a surface at the nodes of a working grid.
#[derive(Debug, Clone, PartialEq)]
pub struct ErrorGrid {
    /// The working grid. The centres of its cells are the nodes.
    pub grid: Grid,
    /// Standard error at each node, metres; NaN outside the frame.
    pub errors: Vec<f32>,
    /// Slope at each node, rise over run.
    slopes: Vec<f32>,
    /// Distance of each node from the farther one of the contours on both sides, map units.
    reaches: Vec<f32>,
    /// Nodes whose height the contours hardly determine.
    inferred: Vec<bool>,
}

/// The expected error of a surface that was built from `subdivision`. `chosen` belongs to the smooth surface. If some labels
/// are wrong, levels of `trusted` are hidden instead. `nodes` are the working grids, with the heights of the smooth surface.
pub fn error_field(
    subdivision: &Subdivision,
    trusted: Option<MapExtent<'_>>,
    params: &TrialParams<'_>,
    chosen: Option<&Chosen>,
    nodes: &[(Grid, Option<&[f32]>)],
) -> ErrorField {
    let extent = subdivision.extent();
    let spacing = extent.spacing;
    let exponent = roughness::hurst_exponent(&extent, &params.tuning.roughness);
    let residuals = hidden_residuals(&trusted.unwrap_or(extent), params, chosen.map(|c| c.hyper_parameters));
    let model = ErrorModel::learn(&residuals, exponent, subdivision.interval.step, spacing, params.tuning);
    drop(residuals);
    let on_grid = |&(grid, heights): &(Grid, Option<&[f32]>)| {
        errors_on(grid, heights, subdivision, spacing, &model, (chosen, params.tuning))
    };
    let parts = nodes.iter().map(on_grid).collect();
    ErrorField { model, parts }
}

/// The expected error at the nodes of a working grid. `spacing` is the mean spacing of the contours, map units.
fn errors_on(
    grid: Grid,
    smooth: Option<&[f32]>,
    subdivision: &Subdivision,
    spacing: f64,
    model: &ErrorModel,
    (chosen, all_tuning): (Option<&Chosen>, &Tuning),
) -> ErrorGrid {
    let tuning = &all_tuning.errors;
    let triangles = locate(&subdivision.tin, &grid, &());
    let sides = sides(subdivision, &grid, &triangles);
    let reference = heights_at(&subdivision.tin, &grid, &triangles);
    drop(triangles);
    let heights = smooth.unwrap_or(&reference);
    let fixing = (sides.share_at_vertices > tuning.min_share_at_vertices)
        .then(|| blurred(&sides.crossings, grid.cols, tuning.fixing_reach));
    let at = |n: usize| {
        let Some(region) = subdivision.regions.regions.get(sides.regions[n] as usize) else {
            return (f32::NAN, f32::NAN, false);
        };
        let height = f64::from(heights[n]);
        let distances = sides.of_node(n);
        if height.is_nan() {
            return (f32::NAN, f32::NAN, false);
        }
        let between = distances.into_iter().all(f64::is_finite);
        let fixed =
            fixing.as_ref().filter(|_| between).map_or(1.0, |crossings| unfixed_share(f64::from(crossings[n]), tuning));
        let apart = smooth.map(|_| (height - f64::from(reference[n])).abs());
        let place = PlaceInBand {
            sides: distances,
            band: [region.band.lo, region.band.hi],
            climb: climb(region, height),
            apart,
        };
        let error = if region.water.is_some() { 0.0 } else { model.error(&place, fixed) };
        let band = region.band.hi - region.band.lo;
        let error = chosen.map_or(error, |c| c.hyper_parameters.error_left(error, band, &all_tuning.spline));
        let reach = distances.into_iter().filter(|d| d.is_finite()).fold(0.0, f64::max);
        let inferred = region.water.is_none()
            && (place.climb.is_some() || distances[0] + distances[1] > tuning.inferred_spacings * spacing);
        (error as f32, reach as f32, inferred)
    };
    let nodes: Vec<(f32, f32, bool)> = parallel::values(grid.len(), at);
    ErrorGrid {
        slopes: slopes(heights, &grid),
        grid,
        errors: nodes.iter().map(|(error, _, _)| *error).collect(),
        reaches: nodes.iter().map(|(_, reach, _)| *reach).collect(),
        inferred: nodes.iter().map(|(_, _, inferred)| *inferred).collect(),
    }
}

/// Height above the only level of a sub-domain, metres (below 0 for below), and whether the ground is above this level.
fn climb(region: &Region, height: f64) -> Option<(f64, bool)> {
    let [(level, side)] = region.levels[..] else { return None };
    Some((height - level, side == Side::Above))
}

impl ErrorField {
    /// The distance over which errors are alike, map units. Between two contours, the surface is too high or too low over the whole
    /// width, which is about twice the distance from the farther one. Wide places have the large errors, so the mean is
    /// that of the squares, weighted with the variance. `None` if there is no error.
    pub fn reach(&self) -> Option<f64> {
        let nodes = self.parts.iter().flat_map(|part| part.errors.iter().zip(&part.reaches));
        let known =
            nodes.map(|(error, reach)| (f64::from(*error), f64::from(*reach))).filter(|(error, _)| *error > 0.0);
        let (sum, weights) = known.fold((0.0, 0.0), |(sum, weights), (error, reach)| {
            (sum + error * error * reach * reach, weights + error * error)
        });
        (weights > 0.0).then(|| 2.0 * (sum / weights).sqrt())
    }

    /// The same for a surface that misses its contours: `misfit` is by how much at each node of a grid, metres. Water has no
    /// error all the same.
    pub fn with_misfit(mut self, misfit: impl Fn(&Grid) -> Vec<f32>) -> Self {
        let has_error = |(error, _): &(&mut f32, f32)| **error > 0.0;
        for part in &mut self.parts {
            let misfit = misfit(&part.grid);
            part.errors
                .iter_mut()
                .zip(misfit)
                .filter(has_error)
                .for_each(|(error, misfit)| *error = error.hypot(misfit));
        }
        self
    }

    /// The standard error at a map position, metres. A node has its own; elsewhere it is interpolated. NaN outside the
    /// frame.
    pub fn at(&self, p: DVec2) -> f32 {
        self.part(p).map_or(f32::NAN, |part| part.between(&part.errors, p))
    }

    /// The errors on the working grid around a map position.
    fn part(&self, p: DVec2) -> Option<&ErrorGrid> {
        self.parts.iter().find(|part| part.holds(p))
    }
}

impl ErrorGrid {
    /// Whether a map position lies between nodes, or beside the outermost ones by less than a cell.
    fn holds(&self, p: DVec2) -> bool {
        let Grid { corner, cell, cols, rows } = self.grid;
        let place = (p - corner) / cell * DVec2::new(1.0, -1.0);
        let reach = DVec2::new(cols as f64, rows as f64) + 1.0;
        place.cmpge(DVec2::splat(-1.0)).all() && place.cmple(reach).all()
    }

    /// A value interpolated between those of the four nodes around that have one.
    fn between(&self, values: &[f32], p: DVec2) -> f32 {
        let grid = &self.grid;
        let first = grid.center(0, 0);
        let place = DVec2::new((p.x - first.x) / grid.cell.x, (first.y - p.y) / grid.cell.y);
        let whole = place.floor();
        let (mut sum, mut weights) = (0.0, 0.0);
        for (i, j) in [(0.0, 0.0), (1.0, 0.0), (0.0, 1.0), (1.0, 1.0)] {
            let node = whole + DVec2::new(i, j);
            if node.x < 0.0 || node.y < 0.0 || node.x >= grid.cols as f64 || node.y >= grid.rows as f64 {
                continue;
            }
            let value = values[node.y as usize * grid.cols + node.x as usize];
            let [x, y] = (1.0 - (place - node).abs()).to_array();
            // A place at a node, but for rounding, has the value of the node.
            let weight = if x * y > 1.0 - 1e-6 { 1e12 } else { x * y };
            if value.is_finite() && weight > 0.0 {
                sum += weight * f64::from(value);
                weights += weight;
            }
        }
        (sum / weights) as f32
    }

    /// Whether the contours hardly determine the height of the node nearest to a map position.
    fn is_inferred(&self, p: DVec2) -> bool {
        let grid = &self.grid;
        let first = grid.center(0, 0);
        let (col, row) = (((p.x - first.x) / grid.cell.x).round(), ((first.y - p.y) / grid.cell.y).round());
        let on_grid = col >= 0.0 && row >= 0.0 && col < grid.cols as f64 && row < grid.rows as f64;
        on_grid && self.inferred[row as usize * grid.cols + col as usize]
    }
}

/// The expected error of a line on the surface. `None` if the line has no length inside the frame.
pub fn line_error(field: &ErrorField, points: &[DVec2]) -> Option<LineError> {
    let (mut vertical, mut horizontal, mut inferred, mut length) = (0.0, 0.0, 0.0, 0.0);
    for ends in points.windows(2) {
        let (middle, piece) = ((ends[0] + ends[1]) / 2.0, ends[0].distance(ends[1]));
        let Some(part) = field.part(middle) else { continue };
        let error = f64::from(part.between(&part.errors, middle));
        if !error.is_finite() || piece <= 0.0 {
            continue;
        }
        let [slope, reach] = [&part.slopes, &part.reaches].map(|values| f64::from(part.between(values, middle)));
        let reach = if reach.is_finite() { reach } else { 0.0 };
        let astray = if slope > 0.0 { (error / slope).min(reach) } else { reach };
        vertical += piece * error * error;
        horizontal += piece * astray * astray;
        inferred += if part.is_inferred(middle) { piece } else { 0.0 };
        length += piece;
    }
    (length > 0.0).then(|| LineError {
        vertical: (vertical / length).sqrt(),
        horizontal: (horizontal / length).sqrt(),
        inferred: inferred > length / 2.0,
    })
}
