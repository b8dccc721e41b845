//! Residuals at hidden contours of a surface from every second level, with the distances to the contours that are left.

use glam::DVec2;
use rayon::prelude::*;

use super::sides::sides;
use crate::spline::{HyperParameters, spline};
use crate::subdomains::MapExtent;
use crate::tin::NONE;
use crate::validate::builder::TrialParams;
use crate::validate::trial::{HiddenPlace, LevelSubset, Trial, between, cell, parts, trial};

/// The residual at a place on a hidden contour.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Residual {
    /// The size of the residual, metres, without sign.
    pub by: f64,
    /// Distance between the smooth surface and the reference surface, metres. `None` on the reference surface.
    pub apart: Option<f64>,
    /// Distances to the contours below and above, map units. One of them is infinite where there is no contour.
    pub sides: [f64; 2],
    /// Length of the hidden contour that the place stands for, map units.
    pub length: f64,
}

impl Residual {
    /// Distance from the contour below to the place, and on to the contour above.
    pub fn width(&self) -> f64 {
        self.sides[0] + self.sides[1]
    }
}

/// Residuals at all places on hidden contours. The odd and the even levels are hidden in turn. `hyper_parameters` are
/// those of the smooth surface; `None` for the surface of triangles.
pub fn hidden_residuals(
    extent: &MapExtent<'_>,
    params: &TrialParams<'_>,
    hyper_parameters: Option<HyperParameters>,
) -> Vec<Residual> {
    // Cells are as small as with all levels. So the error is not that of coarse cells.
    let cell = cell(extent, params, 1);
    let parts = parts(extent, params, cell);
    let both: Vec<_> = parts.iter().flat_map(|(map, frame)| [0, 1].map(|phase| (map, frame, phase))).collect();
    let found = both.into_par_iter().filter_map(|(map, frame, phase)| {
        let kept = LevelSubset { every: 2, phase };
        Some(of_trial(&trial((map, frame), kept, extent.interval, cell, params)?, hyper_parameters, params))
    });
    found.collect::<Vec<_>>().concat()
}

fn of_trial(trial: &Trial, hyper_parameters: Option<HyperParameters>, params: &TrialParams<'_>) -> Vec<Residual> {
    let Trial { subdivision, skeleton_lines, places, grid } = trial;
    let conditions = params.builder.conditions(subdivision, skeleton_lines, grid);
    let triangles = &conditions.triangles;
    let sides = sides(subdivision, grid, triangles);
    // No shrinkage: all hidden contours lie half-way, which is where heights shrink to.
    let tuning = &params.tuning.spline;
    let smooth = hyper_parameters.map(|hyper_parameters| {
        spline(&conditions, &HyperParameters { half_way_error: 0.0, ..hyper_parameters }, tuning, &()).heights
    });
    let ask = |place: &HiddenPlace| {
        let DVec2 { x: col, y: row } = grid.place(place.at);
        let (col, row) = (col.round(), row.round());
        if col < 0.0 || row < 0.0 || col >= grid.cols as f64 || row >= grid.rows as f64 {
            return None;
        }
        let near = triangles[row as usize * grid.cols + col as usize];
        let t = if near == NONE { None } else { subdivision.tin.locate(near, place.at - subdivision.tin.origin) }?;
        let band = subdivision.regions.region(t)?.band;
        let sides = sides.at(place.at, subdivision.regions.of_triangle[t as usize])?;
        let reference = f64::from(between(grid, &conditions.reference, place.at)?);
        let height = match &smooth {
            Some(heights) => f64::from(between(grid, heights, place.at)?),
            None => reference,
        };
        let apart = smooth.is_some().then(|| (height - reference).abs());
        let by = (height - place.level).abs();
        // A band that a broken contour has joined to another is wrong, so only places between two levels count.
        let asked = band.lo < place.level && place.level < band.hi && sides.iter().any(|d| d.is_finite());
        (asked && by.is_finite() && place.length > 0.0).then_some(Residual { by, apart, sides, length: place.length })
    };
    places.iter().filter_map(ask).collect()
}
