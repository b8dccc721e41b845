//! Fitting: smooth lines in place of ragged ones (Zhang, Konno and Tokuyama 2005, section 3.1).
//!
//! Each line is approximated by a cubic B-spline with uniform knots and chord-length parameters. The spline is periodic
//! for a closed line, and clamped at both ends for an open one. Doubling and bisecting find a small number of control
//! points. Vertices lie on the curve, dense where it bends, or at even distances for sampling. A line is fitted again
//! with half the tolerance if it would meet another line, or pass over a line or a spot height. If that does not help,
//! it is left unchanged.

mod curve;
mod least_squares;
mod over;
mod spline;
#[cfg(test)]
mod tests;
mod vertices;

use glam::DVec2;

use self::vertices::{Placing, largest_distance, near as is_near};
use super::sample::{self, Cut, SampleParams};
use crate::base::error::{Error, Report, Result};
use crate::base::parallel;
use crate::clean::{self, CleanParams};
use crate::contour::{Contour, ContourMap};

/// Largest number of times that the tolerance of a line is halved. After that the line is left unchanged.
const HALVINGS: u8 = 3;
/// Rounds in which conflicts are looked for. After them each line in a conflict is left unchanged.
const ROUNDS: usize = 6;

/// How near the fitted lines must stay.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FitParams {
    /// Largest distance of a line's vertices from the fitted line and back, map units.
    pub tolerance: f64,
    /// If given, vertices lie at even distances along the curves, as dense as [`sample`](fn@sample::sample) asks
    /// wherever they can lie on the curve. If `None`, they are dense where the curves bend.
    pub sampling: Option<SampleParams>,
}

/// A fitted map, with figures.
#[derive(Debug, Clone, PartialEq)]
pub struct Fitted {
    /// The fitted lines, in standard form and order as after cleaning.
    pub map: ContourMap,
    /// Control points of all fitted lines.
    pub control_points: usize,
    /// Largest distance from an input vertex to the fitted line or back, map units. It is an upper bound, looked for
    /// near the same share of the lines' lengths.
    pub deviation: f64,
    /// Vertices of the input.
    pub vertices_before: usize,
    /// Vertices of the fitted map.
    pub vertices_after: usize,
    /// Lines fitted with a half, a quarter and an eighth of the tolerance, because they met or passed over others.
    pub narrowed: [usize; HALVINGS as usize],
    /// Lines left unchanged, because they met others, have too few points, or no curve is near enough.
    pub unchanged: usize,
}

/// A line and the result of its fit.
struct State {
    line: Contour,
    halvings: u8,
    control_points: usize,
    /// The curve, if more points of it may be needed.
    curve: Option<spline::Line>,
}

/// Fits all lines of a clean map; see the module's first lines.
///
/// The ends of open lines stay bit for bit. The result passes [`validate`](clean::validate). Spot heights that would
/// lie on a contour are left out, with a finding.
///
/// # Errors
/// [`Error::OutOfRange`] for a tolerance that is not above 0. [`Error::Data`] if the map is not clean.
pub fn fit(map: ContourMap, params: &FitParams, near: &CleanParams) -> Result<Report<Fitted>> {
    if !(params.tolerance.is_finite() && params.tolerance > 0.0) {
        return Err(Error::out_of_range("fitting tolerance", params.tolerance, "more than 0"));
    }
    clean::validate(&map, near)?;
    let near = &near.on(&map);
    if let Some(sampling) = &params.sampling {
        sampling.check()?;
    }
    let tolerance = |halvings: u8| params.tolerance / f64::from(1u32 << halvings);
    let placing = if params.sampling.is_some() { Placing::Even } else { Placing::Bends };
    let mut states: Vec<State> = parallel::map_each(&map.contours, |c| fit_line(c, 0, params.tolerance, placing));
    let mut round = 0;
    loop {
        let lines: Vec<Contour> = states.iter().map(|s| s.line.clone()).collect();
        let trouble = in_trouble(&map, &lines, params.tolerance, near)?;
        drop(lines);
        let again: Vec<usize> = trouble.into_iter().filter(|&i| states[i].control_points > 0).collect();
        if again.is_empty() {
            break;
        }
        round += 1;
        let refitted: Vec<State> = parallel::map_each(&again, |&i| {
            let halvings = if round > ROUNDS { HALVINGS } else { states[i].halvings } + 1;
            fit_line(&map.contours[i], halvings, tolerance(halvings), placing)
        });
        for (i, state) in again.into_iter().zip(refitted) {
            states[i] = state;
        }
    }
    if let Some(sampling) = &params.sampling {
        let wanted: Vec<f64> = states.iter().map(|s| tolerance(s.halvings)).collect();
        refine(&map, &mut states, &wanted, sampling, near)?;
    }
    let deviation = deviation(&states, &map.contours, tolerance);
    let fitted = |s: &&State| s.control_points > 0;
    let narrowed =
        std::array::from_fn(|k| states.iter().filter(fitted).filter(|s| usize::from(s.halvings) == k + 1).count());
    let control_points = states.iter().map(|s| s.control_points).sum();
    let unchanged = states.iter().filter(|s| s.control_points == 0).count();
    let vertices_before = map.vertex_count();
    let contours = clean::in_standard_order(states.into_iter().map(|s| s.line).collect());
    let Report { value: spots, findings } = clean::spots_off_contours(map.spots, &contours, near)?;
    let map = ContourMap { contours, spots, ..map };
    clean::validate(&map, near)?;
    let vertices_after = map.vertex_count();
    let value = Fitted { map, control_points, deviation, vertices_before, vertices_after, narrowed, unchanged };
    Ok(Report { value, findings })
}

/// The largest distance between a contour and its fitted line, there and back, map units.
fn deviation(states: &[State], contours: &[Contour], tolerance: impl Fn(u8) -> f64 + Sync) -> f64 {
    let of_line = |i: usize| {
        let (s, c) = (&states[i], &contours[i]);
        if s.control_points == 0 {
            return 0.0;
        }
        let t = tolerance(s.halvings);
        let there = largest_distance(&c.points, &s.line.points, t);
        there.max(largest_distance(&s.line.points, &c.points, t))
    };
    parallel::map(states.len(), of_line).into_iter().fold(0.0, f64::max)
}

/// Lines that meet others; if there are none, those that have passed over others or were passed over.
fn in_trouble(map: &ContourMap, lines: &[Contour], tolerance: f64, near: &CleanParams) -> Result<Vec<usize>> {
    let met = clean::lines_in_conflict(lines, near)?;
    if met.is_empty() { over::passed(&map.contours, lines, &map.spots, 2.0 * tolerance) } else { Ok(met) }
}

fn fit_line(contour: &Contour, halvings: u8, tolerance: f64, placing: Placing) -> State {
    let fitted = (halvings <= HALVINGS && contour.points.len() > 5)
        .then(|| spline::fit(&contour.points, contour.is_closed(), tolerance, placing))
        .flatten();
    if let Some(mut fitted) = fitted {
        let line = Contour { points: std::mem::take(&mut fitted.points), ..*contour };
        if clean::is_sound(&line) {
            let control_points = fitted.curve.control.len();
            return State { line, halvings, control_points, curve: (placing == Placing::Even).then_some(fitted) };
        }
    }
    State { line: contour.clone(), halvings, control_points: 0, curve: None }
}

/// Adds points of the curves where sampling asks for them. Lines that would then be in trouble stay as they were.
fn refine(
    map: &ContourMap,
    states: &mut [State],
    tolerances: &[f64],
    sampling: &SampleParams,
    near: &CleanParams,
) -> Result<()> {
    let coarse: Vec<Contour> = states.iter().map(|s| s.line.clone()).collect();
    let plan = sample::plan(&coarse, sampling)?;
    let mut lines: Vec<Contour> = parallel::map(states.len(), |i| {
        let (state, input, tolerance) = (&states[i], &map.contours[i], tolerances[i]);
        let fine = state
            .curve
            .as_ref()
            .map(|curve| Contour { points: points_of(&state.line.points, curve, &plan.cuts[i]), ..state.line });
        let is_good = |fine: &Contour| {
            clean::is_sound(fine)
                && is_near(&input.points, &fine.points, tolerance)
                && is_near(&fine.points, &input.points, tolerance)
        };
        fine.filter(is_good).unwrap_or_else(|| state.line.clone())
    });
    let largest = tolerances.iter().copied().fold(0.0, f64::max);
    loop {
        let mut trouble = in_trouble(map, &lines, largest, near)?;
        trouble.retain(|&i| lines[i].points.len() != coarse[i].points.len());
        if trouble.is_empty() {
            break;
        }
        for i in trouble {
            lines[i] = coarse[i].clone();
        }
    }
    states.iter_mut().zip(lines).for_each(|(state, line)| state.line = line);
    Ok(())
}

/// The points of a line with those of its curve at the cuts.
fn points_of(points: &[DVec2], fitted: &spline::Line, cuts: &[Cut]) -> Vec<DVec2> {
    let mut all = Vec::with_capacity(points.len() + cuts.len());
    let mut cuts = cuts.iter().peekable();
    for (k, (&p, u)) in (0u32..).zip(points.iter().zip(fitted.parameters.windows(2))) {
        all.push(p);
        while let Some(cut) = cuts.next_if(|cut| cut.segment == k) {
            all.push(fitted.origin + fitted.curve.at(u[0] + cut.share * (u[1] - u[0])));
        }
    }
    all.extend(points.last());
    all
}
