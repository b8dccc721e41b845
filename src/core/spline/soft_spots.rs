//! Spot heights with a standard error.
//!
//! A surface that was found without such a spot has an error of its own there. The best estimate of the height is the mean
//! of both, weighted by the reciprocals of the variances (a Kalman update for each spot alone). The surface then passes
//! through this estimate.

use glam::DVec3;

use super::conditions::Conditions;
use super::working_grid::WorkingGrid;
use crate::contour::SoftSpot;

/// The heights through which the surface should pass at the soft spots. `surface` was found without them; `variances` are
/// those half-way between contours, square metres, at its nodes. `wide` says how far each node is a wide place, 0 to 1. No variance counts as less than `least`.
pub fn estimates(
    conditions: &Conditions<'_>,
    surface: &WorkingGrid,
    variances: &[f32],
    wide: &[f32],
    least: f64,
) -> Vec<DVec3> {
    let [lo, hi] = &conditions.bounds;
    let estimate = |spot: &SoftSpot| {
        let here = f64::from(surface.at(spot.place.truncate()));
        let node = surface.nearest(spot.place.truncate())?;
        let (lo, height) = (f64::from(lo[node]), f64::from(hi[node] - lo[node]));
        // As for the shrinkage: the error is 0 at both levels and largest half-way. In wide places it is large even where
        // the height is close to a level.
        let t = if height > 0.0 { ((here - lo) / height).clamp(0.0, 1.0) } else { 0.0 };
        let variance = f64::from(variances[node]).max(least) * (4.0 * t * (1.0 - t)).max(f64::from(wide[node]));
        let share = variance / (variance + spot.sigma * spot.sigma);
        let z = here + share * (spot.place.z - here);
        z.is_finite().then(|| spot.place.truncate().extend(z))
    };
    conditions.soft_spots.iter().filter_map(estimate).collect()
}
