//! Fitting: smooth, evenly spaced lines in place of ragged ones (Zhang, Konno and Tokuyama 2005, section 3.1).
//!
//! Each line is approximated by a cubic B-spline with uniform knots and chord-length parameters, periodic for a closed
//! line, clamped at both ends for an open one, with few control points: their number is doubled, then bisected to about
//! a thirtieth. Lines that would meet others are fitted again with half the tolerance, in the end left as they are.
//!
//! Known limitation: a line can pass over another that lies wholly within the tolerance of it without meeting it.

mod spline;
#[cfg(test)]
mod tests;

use rayon::prelude::*;

use super::clean::{self, CleanParams};
use super::{Contour, ContourMap};
use crate::error::{Error, Report, Result};

/// How often the tolerance of a line is halved before the line is left as it is.
const HALVINGS: u8 = 3;
/// Rounds of looking for conflicts after which every line in one is left as it is.
const ROUNDS: usize = 6;

/// How near the fitted lines stay.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FitParams {
    /// Largest distance of a line's vertices from the fitted line and back, map units.
    pub tolerance: f64,
}

/// A fitted map, with figures.
#[derive(Debug, Clone, PartialEq)]
pub struct Fitted {
    /// The fitted lines, in standard form and order as after cleaning.
    pub map: ContourMap,
    /// Control points of all fitted lines.
    pub control_points: usize,
    /// Largest distance from an input vertex to the fitted line or back, map units. An upper bound: looked for near the
    /// same share of the lines' lengths.
    pub deviation: f64,
    /// Vertices of the input.
    pub vertices_before: usize,
    /// Vertices of the fitted map.
    pub vertices_after: usize,
    /// Lines fitted with half the tolerance, a quarter, an eighth, because they met others.
    pub narrowed: [usize; HALVINGS as usize],
    /// Lines left as they are, because they met others have too few points, or no curve is
    /// near enough.
    pub unchanged: usize,
}

/// A line with what its fit came to.
struct State {
    line: Contour,
    halvings: u8,
    control_points: usize,
}

/// Fits all lines of a clean map; see the module's first lines.
///
/// The ends of open lines stay bit for bit. The result passes [`validate`](clean::validate). Spot heights that come to
/// lie on a contour are left out, with a finding.
///
/// # Errors
/// [`Error::Parameter`] for a tolerance that is not above 0. [`Error::Data`] if the map is not clean.
pub fn fit(map: ContourMap, params: &FitParams, near: &CleanParams) -> Result<Report<Fitted>> {
    if !(params.tolerance.is_finite() && params.tolerance > 0.0) {
        return Err(Error::Parameter(format!(
            "the fitting tolerance must be more than 0 map units, not {}",
            params.tolerance
        )));
    }
    clean::validate(&map, near)?;
    let tolerance = |halvings: u8| params.tolerance / f64::from(1u32 << halvings);
    let mut states: Vec<State> = map.contours.par_iter().map(|c| fit_line(c, 0, params.tolerance)).collect();
    let mut round = 0;
    loop {
        let lines: Vec<Contour> = states.iter().map(|s| s.line.clone()).collect();
        let met = clean::lines_in_conflict(&lines, near)?;
        drop(lines);
        let again: Vec<usize> = met.into_iter().filter(|&i| states[i].control_points > 0).collect();
        if again.is_empty() {
            break;
        }
        round += 1;
        let refitted: Vec<State> = again
            .par_iter()
            .map(|&i| {
                let halvings = if round > ROUNDS { HALVINGS } else { states[i].halvings } + 1;
                fit_line(&map.contours[i], halvings, tolerance(halvings))
            })
            .collect();
        for (i, state) in again.into_iter().zip(refitted) {
            states[i] = state;
        }
    }
    let deviation = states
        .par_iter()
        .zip(&map.contours)
        .filter(|(s, _)| s.control_points > 0)
        .map(|(s, c)| {
            let t = tolerance(s.halvings);
            let there = spline::largest_distance(&c.points, &s.line.points, t);
            there.max(spline::largest_distance(&s.line.points, &c.points, t))
        })
        .reduce(|| 0.0, f64::max);
    let fitted = |s: &&State| s.control_points > 0;
    let narrowed =
        std::array::from_fn(|k| states.iter().filter(fitted).filter(|s| usize::from(s.halvings) == k + 1).count());
    let control_points = states.iter().map(|s| s.control_points).sum();
    let unchanged = states.iter().filter(|s| s.control_points == 0).count();
    let vertices_before = map.vertex_count();
    let contours = clean::in_standard_order(states.into_iter().map(|s| s.line).collect());
    let Report { value: spots, findings } = clean::spots_off_contours(map.spots, &contours, near)?;
    let map = ContourMap { contours, spots, depressions: map.depressions, crs: map.crs };
    clean::validate(&map, near)?;
    let vertices_after = map.vertex_count();
    let value = Fitted { map, control_points, deviation, vertices_before, vertices_after, narrowed, unchanged };
    Ok(Report { value, findings })
}

fn fit_line(contour: &Contour, halvings: u8, tolerance: f64) -> State {
    let fitted = (halvings <= HALVINGS && contour.points.len() > 5)
        .then(|| spline::fit(&contour.points, contour.is_closed(), tolerance))
        .flatten()
        .filter(|f| clean::is_sound(&Contour { points: f.points.clone(), ..*contour }));
    match fitted {
        Some(f) => State { line: Contour { points: f.points, ..*contour }, halvings, control_points: f.control_points },
        None => State { line: contour.clone(), halvings, control_points: 0 },
    }
}
