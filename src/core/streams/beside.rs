//! Reaches that run beside their valleys.

use glam::DVec2;

use super::along::Along;
use super::descend::Ground;
use super::shift::{Shift, arms, beside_tips};
use crate::subdomains::{Course, Crossing};
use crate::tuning::StreamTuning;

/// Places within the tolerance at which a bend is looked for.
const PLACES: i32 = 9;
/// Fewest crossings that tell.
const FEWEST: usize = 3;

/// Where a reach runs instead of in the bends of the contours.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Beside {
    /// So far from the tips of other bends, map units.
    Tips(f64),
    /// On a slope or over a ridge.
    Slope,
}

/// Whether a reach runs beside the valleys of the contours: nearer to the tips of other bends, or where the contours do not
/// bend upstream. `points` and the course run downstream; `shifts` are those that the tolerance allows.
pub(super) fn beside(
    ground: &Ground<'_>,
    points: &[DVec2],
    course: &Course,
    (tolerance, shifts): (f64, &[Shift]),
    tuning: &StreamTuning,
) -> Option<Beside> {
    if let Some(off) = beside_tips(ground, points, course, (tolerance, shifts), tuning) {
        return Some(Beside::Tips(off));
    }
    if tolerance <= 0.0 {
        return None;
    }
    let along = Along::new(points);
    let crossings = course.crossings.iter().filter(|crossing| crossing.level.is_some());
    let told: Vec<bool> =
        crossings.filter_map(|crossing| is_on_slope(ground, &along, crossing, tolerance, tuning)).collect();
    let on_slope = told.iter().filter(|on_slope| **on_slope).count();
    (told.len() >= FEWEST && on_slope >= 2 && 2 * on_slope >= told.len()).then_some(Beside::Slope)
}

/// Whether a contour runs upstream on one side of a crossing or on both, and bends upstream nowhere within the tolerance.
/// None where the contour is too short to tell.
fn is_on_slope(
    ground: &Ground<'_>,
    along: &Along<'_>,
    crossing: &Crossing,
    tolerance: f64,
    tuning: &StreamTuning,
) -> Option<bool> {
    let arm = tuning.slope_arm * tolerance;
    let [before, after] = [crossing.at - arm, crossing.at + arm].map(|at| along.place(at));
    let down = (after - before).normalize_or_zero();
    let sides = arms(ground, crossing, arm + tolerance);
    // How far upstream the contour is, so far along it from the crossing.
    let upstream = |at: f64| {
        let side = &sides[usize::from(at >= 0.0)];
        let mut from = crossing.place;
        let mut left = at.abs();
        for &p in side {
            let step = from.distance(p);
            if step >= left && step > 0.0 {
                return Some((crossing.place - from.lerp(p, left / step)).dot(down));
            }
            left -= step;
            from = p;
        }
        None
    };
    // How far both arms run downstream from there, per length.
    let depth = |at: f64| {
        let [left, tip, right] = [upstream(at - arm)?, upstream(at)?, upstream(at + arm)?];
        Some((tip - left).min(tip - right) / arm)
    };
    let places = (0..PLACES).map(|k| tolerance * (2.0 * f64::from(k) / f64::from(PLACES - 1) - 1.0));
    let deepest = places.filter_map(depth).reduce(f64::max)?;
    let [left, right] = [upstream(-arm)? / arm, upstream(arm)? / arm];
    // On a slope one arm runs upstream and the other one downstream; on a ridge both run upstream.
    let slope = left.max(right).min((-left).max(-right)).max(left.min(right));
    Some(deepest < tuning.least_valley && slope > tuning.least_slope)
}
