//! The error model: residuals at hidden contours, carried over to the map with all its levels.
//!
//! **Between two contours.** The error grows with the width between them and is largest half-way. The hidden contours
//! give it half-way, at twice the usual widths, as the figure below which 68 of 100 errors lie.
//!
//! **From twice the interval to the interval.** The error falls with a power of the width: the Hurst-like exponent of
//! the contours ([`roughness`](crate::validate::roughness)). The same law governs how far a line leaves its chord and
//! how far the ground leaves a surface between lines. On very level ground the error fills the band, so it falls only
//! in proportion to the band. In between, one law passes into the other.
//!
//! **Towards a contour.** The error falls with the product of both distances, raised to half of that exponent. A random
//! walk that is tied at both ends follows the same law.
//!
//! **On level ground.** Where contours are much further apart than the mean spacing, the ground is level in relation to
//! the interval. There too, the error falls only in proportion to the band.
//!
//! **Two surfaces.** The smooth surface and the reference surface are two guesses from the same contours. Where they
//! are far apart, the contours leave much open. The error is then larger than the distance between contours suggests.
//!
//! **Beyond the last contour.** On a top or in a pit, the height is a guess from the slope. The error is a share of the
//! climb. This share comes from the surface from half of the levels, from its errors at tops.

use super::residuals::Residual;
use crate::tuning::{ErrorTuning, Tuning};

/// Shares of errors within one and within two standard errors, as in a normal distribution, rounded.
const WITHIN: [f64; 2] = [0.68, 0.95];
/// The error beyond the last contour, as a share of the climb, where there are too few tops to estimate it.
const USUAL_CLIMB_SHARE: f64 = 0.5;
/// Least number of places beyond the last contour to estimate this share.
const MIN_TOP_PLACES: usize = 50;
/// Where no levels can be hidden: standard error half-way between contours one spacing apart, as a share of the
/// contour interval.
const USUAL_ERROR: f64 = 0.08;
/// Where no levels can be hidden: power with which the standard error grows with the distance between contours.
const USUAL_WIDTH_POWER: f64 = 0.7;
/// Least share of the error that remains where many crossings fix the surface.
const MIN_LEFT: f64 = 0.15;

/// The origin of the error model.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Provenance {
    /// Hidden contours.
    Hidden {
        /// Number of places on them.
        places: usize,
    },
    /// Usual terrain, because there were too few levels or places.
    Usual,
}

/// The error model: the standard error as a function of the distances to contours.
#[derive(Debug, Clone, PartialEq)]
pub struct ErrorModel {
    /// Its origin.
    pub provenance: Provenance,
    /// Power of the distance between contours with which the error grows.
    pub exponent: f64,
    /// The error as a share of the climb beyond the last contour.
    pub beyond: f64,
    /// Logarithms of width (map units) and of the standard error half-way (metres), in ascending order of width.
    curve: Vec<[f64; 2]>,
    interval: f64,
    tuning: ErrorTuning,
}

/// A place, with what the contours show about it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PlaceInBand {
    /// Distances from the known ground below and above, map units. Infinite if there is none.
    pub sides: [f64; 2],
    /// The band that holds the height, metres.
    pub band: [f64; 2],
    /// Height above or below the only contour of the sub-domain, and whether the ground is above this contour. `None`
    /// between two contours.
    pub climb: Option<(f64, bool)>,
    /// Distance between the smooth surface and the reference surface, metres. `None` on the reference surface.
    pub apart: Option<f64>,
}

impl ErrorModel {
    /// Fits the model to residuals. `exponent` is the Hurst-like exponent of the contours, `interval` the contour
    /// interval (metres), `spacing` the mean spacing of the contours (map units).
    pub fn learn(residuals: &[Residual], exponent: Option<f64>, interval: f64, spacing: f64, tuning: &Tuning) -> Self {
        let (exponent, fewest, tuning) = (tuning.roughness.power(exponent), tuning.trials.min_places, tuning.errors);
        let [least_share, most_share] = tuning.climb_share_limits;
        let (mut between, mut beyond): (Vec<Residual>, Vec<Residual>) =
            residuals.iter().partition(|s| s.width().is_finite());
        between.retain(|s| s.width() > 0.0);
        let beyond_usual = USUAL_CLIMB_SHARE;
        let curve = usual(interval, spacing);
        let usual = Self { provenance: Provenance::Usual, exponent, beyond: beyond_usual, curve, interval, tuning };
        if between.len() < fewest {
            return usual;
        }
        let share = quantile(&mut beyond, |s| s.length, WITHIN[0]) / interval;
        let is_known = beyond.len() >= MIN_TOP_PLACES;
        let beyond = if is_known { share.clamp(least_share, most_share) } else { beyond_usual };
        let classes = classes(&mut between, tuning.width_classes, fewest);
        let curve = classes.into_iter().map(|class| point(class, exponent, interval, spacing, &tuning)).collect();
        Self { provenance: Provenance::Hidden { places: between.len() }, beyond, curve, ..usual }
    }

    /// The standard error at a place, metres, at most half of the band. `fixed` is the share of the error that remains
    /// where contours were cut from the nodes themselves; 1 elsewhere.
    pub fn error(&self, place: &PlaceInBand, fixed: f64) -> f64 {
        let [below, above] = place.sides;
        let near = below.min(above);
        let most = (place.band[1] - place.band[0]) / 2.0;
        if !near.is_finite() {
            return self.tuning.unknown.min(0.5) * 2.0 * most;
        }
        if near <= 0.0 {
            return 0.0;
        }
        let error = match place.climb {
            Some((climb, upwards)) => {
                let (contour, other) = if upwards { (below, above) } else { (above, below) };
                let open = if other.is_finite() { other / (contour + other) } else { 1.0 };
                (self.beyond * climb.abs() * open)
                    .max(self.halfway(self.tuning.lone_contour_width * near, self.exponent))
            }
            None => {
                let width = if below.max(above).is_finite() { below + above } else { 2.0 * near };
                let profile = profile(place.sides);
                let tied = self.halfway(width, 0.0) * profile.powf(self.tuning.profile_power * self.exponent);
                let error = tied.max(self.halfway(profile * width, self.exponent));
                // The usual error is an average over places where the two surfaces agree and where they do not.
                let factor = if self.provenance == Provenance::Usual {
                    1.0
                } else {
                    disagreement_factor(place.apart, error, &self.tuning)
                };
                fixed * error * factor
            }
        };
        error.min(most)
    }

    /// The standard error half-way between contours that are `width` apart, metres. Below the narrowest width of the
    /// curve, it falls with the power `narrow`.
    fn halfway(&self, width: f64, narrow: f64) -> f64 {
        let at = width.max(f64::MIN_POSITIVE).ln();
        let (Some(first), Some(last)) = (self.curve.first(), self.curve.last()) else { return 0.0 };
        let log = if at <= first[0] {
            first[1] + (at - first[0]) * narrow
        } else if at >= last[0] {
            last[1]
        } else {
            let next = self.curve.partition_point(|p| p[0] <= at).min(self.curve.len() - 1);
            let ([xa, ya], [xb, yb]) = (self.curve[next - 1], self.curve[next]);
            ya + (yb - ya) * (at - xa) / (xb - xa).max(f64::MIN_POSITIVE)
        };
        log.exp().min(self.tuning.unknown * self.interval)
    }
}

/// Relative position between two contours: 0 at either, 1 half-way. With one contour only, 1.
fn profile([below, above]: [f64; 2]) -> f64 {
    let share = if below.max(above).is_finite() { below / (below + above) } else { 0.5 };
    4.0 * share * (1.0 - share)
}

/// Factor on the error for the distance between the two surfaces; 1 where there is only one.
fn disagreement_factor(apart: Option<f64>, error: f64, tuning: &ErrorTuning) -> f64 {
    let Some(apart) = apart else { return 1.0 };
    let ErrorTuning { agreement_factor, disagreement_slope, max_disagreement, .. } = *tuning;
    let times = apart / error;
    agreement_factor + if times.is_nan() { 0.0 } else { disagreement_slope * times.min(max_disagreement) }
}

/// The share of the error that remains at nodes whose heights the contours were cut from. `crossings` is the number of
/// crossings per node. Every crossing of an edge is an equation. With about as many equations as nodes, little is left
/// open.
pub fn unfixed_share(crossings: f64, tuning: &ErrorTuning) -> f64 {
    let ErrorTuning { fixing_crossings, fixing_power, .. } = *tuning;
    (1.0 / (1.0 + (crossings / fixing_crossings).powf(fixing_power)).sqrt()).max(MIN_LEFT)
}

/// The usual curve, for maps where no levels can be hidden.
fn usual(interval: f64, spacing: f64) -> Vec<[f64; 2]> {
    let at = |wide: f64| [(wide * spacing).ln(), (USUAL_ERROR * interval * wide.powf(USUAL_WIDTH_POWER)).ln()];
    vec![at(0.1), at(10.0)]
}

/// Divides the places into `count` classes of width with equal areas. Classes with fewer places than their part of
/// `fewest` are dropped.
fn classes(between: &mut [Residual], count: usize, fewest: usize) -> Vec<Vec<Residual>> {
    between.sort_by(|a, b| a.width().total_cmp(&b.width()));
    let area = |s: &Residual| s.length * s.width();
    let all: f64 = between.iter().map(area).sum();
    let mut classes: Vec<Vec<Residual>> = vec![Vec::new(); count];
    let mut sum = 0.0;
    for residual in between.iter() {
        let class = (sum / all * count as f64) as usize;
        classes[class.min(count - 1)].push(*residual);
        sum += area(residual);
    }
    // A class with very few places shows too little.
    classes.retain(|class| class.len() >= fewest / count);
    classes
}

/// Width and error of a class, carried from twice the interval to the interval. `spacing` is the mean spacing of the
/// contours.
fn point(mut class: Vec<Residual>, exponent: f64, interval: f64, spacing: f64, tuning: &ErrorTuning) -> [f64; 2] {
    let ErrorTuning { max_tail, unknown, .. } = *tuning;
    let [level_from, level_at] = tuning.level_spacings;
    let width = class[class.len() / 2].width();
    let area = |s: &Residual| s.length * s.width();
    let usual = quantile(&mut class, area, WITHIN[0]);
    class.iter_mut().for_each(|s| s.by /= disagreement_factor(s.apart, usual, tuning));
    let [one, two] = WITHIN.map(|q| quantile(&mut class, area, q));
    let error = if class.iter().all(|s| s.apart.is_none()) {
        tuning.hidden_to_all_triangles * one.max(two / max_tail)
    } else {
        // Where few errors are large, half of the two-sigma figure is the smaller one.
        tuning.hidden_to_all * one.min(two / 2.0).max(two / max_tail)
    };
    let level = ((width / 2.0 / spacing / level_from).ln() / (level_at / level_from).ln()).clamp(0.0, 1.0);
    let exponent = exponent + level * (exponent.min(1.0) - exponent);
    // An error that fills the band is the same share of every band. A small error falls with its power.
    let share = (error / (2.0 * interval)).clamp(1e-6, 0.98 * unknown);
    let free = share / (1.0 - (share / unknown).powi(2)).sqrt() * 2f64.powf(1.0 - exponent);
    let share = free / (1.0 + (free / unknown).powi(2)).sqrt();
    [(width / 2.0).ln(), (interval * share).ln()]
}

/// The error below which a share of the weight lies; 0 without residuals.
fn quantile(residuals: &mut [Residual], weight: impl Fn(&Residual) -> f64, share: f64) -> f64 {
    residuals.sort_by(|a, b| a.by.total_cmp(&b.by));
    let all: f64 = residuals.iter().map(&weight).sum();
    let mut below = 0.0;
    let reached = residuals.iter().find(|s| {
        below += weight(s);
        below >= share * all
    });
    reached.map_or(0.0, |s| s.by)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tuning::RoughnessTuning;

    fn learn(residuals: &[Residual], exponent: Option<f64>, interval: f64, spacing: f64) -> ErrorModel {
        ErrorModel::learn(residuals, exponent, interval, spacing, &Tuning::default())
    }

    /// Residuals of all sizes up to `most`, in no order, on contours between others that are `width` apart.
    fn places(most: f64, width: f64) -> Vec<Residual> {
        let at = |k: i32| {
            let by = most * f64::from(k * 617 % 1000) / 999.0;
            Residual { by, apart: None, sides: [width / 2.0; 2], length: 1.0 }
        };
        (0..1000).map(at).collect()
    }

    fn between(below: f64, above: f64) -> PlaceInBand {
        PlaceInBand { sides: [below, above], band: [10.0, 20.0], climb: None, apart: None }
    }

    #[test]
    fn errors_shrink_by_the_power_that_contours_bend_with() {
        for exponent in [1.0, 1.5, 2.0] {
            let model = learn(&places(1.0, 100.0), Some(exponent), 10.0, 50.0);
            assert_eq!(model.provenance, Provenance::Hidden { places: 1000 });
            let halfway = model.error(&between(25.0, 25.0), 1.0);
            let power = RoughnessTuning::default().power(Some(exponent));
            let expected = 0.68 * ErrorTuning::default().hidden_to_all_triangles * 0.5f64.powf(power);
            assert!((halfway / expected - 1.0).abs() < 0.02, "{exponent}: {halfway} {expected}");
        }
    }

    #[test]
    fn errors_are_zero_on_contours_and_never_beyond_the_band() {
        let model = learn(&places(19.0, 100.0), None, 10.0, 50.0);
        assert_eq!(model.error(&between(0.0, 50.0), 1.0), 0.0);
        let mut last = 0.0;
        for below in [0.1, 1.0, 5.0, 20.0] {
            let error = model.error(&between(below, 50.0 - below), 1.0);
            assert!(error > last && error <= 5.0, "{below}: {error}");
            last = error;
        }
        for sides in [[f64::INFINITY; 2], [1e9, f64::INFINITY], [1e9, 1e9]] {
            for climb in [None, Some((10.0, true))] {
                let error = model.error(&PlaceInBand { sides, band: [10.0, 20.0], climb, apart: None }, 1.0);
                assert!(error > 1.0 && error <= 5.0, "{sides:?} {climb:?} {error}");
            }
        }
    }

    #[test]
    fn a_spot_height_ends_the_doubt_about_a_top() {
        let model = learn(&[], None, 10.0, 50.0);
        assert_eq!(model.provenance, Provenance::Usual);
        let top =
            |spot: f64| PlaceInBand { sides: [30.0, spot], band: [10.0, 20.0], climb: Some((8.0, true)), apart: None };
        assert_eq!(model.error(&top(0.0), 1.0), 0.0);
        assert!(model.error(&top(3.0), 1.0) < model.error(&top(f64::INFINITY), 1.0));
    }

    #[test]
    fn contours_cut_from_the_nodes_fix_them_where_they_are_dense() {
        let share = |crossings: f64| unfixed_share(crossings, &ErrorTuning::default());
        assert!(share(0.3) > 0.99 && share(0.5) > 0.9 && share(1.0) < 0.5);
        assert_eq!(share(9.0), 0.15);
    }

    #[test]
    fn errors_are_larger_where_two_guesses_are_far_apart() {
        // Errors are as large as the distance between the two surfaces, or twice as large.
        let [model, other] = [1.0, 2.0].map(|times| {
            let mut residuals = places(1.0, 100.0);
            residuals.iter_mut().for_each(|s| s.apart = Some(s.by / times));
            learn(&residuals, Some(1.0), 10.0, 50.0)
        });
        let tuning = ErrorTuning::default();
        let [least, slope, most] = [tuning.agreement_factor, tuning.disagreement_slope, tuning.max_disagreement];
        let of = |model: &ErrorModel, apart: f64| {
            model.error(&PlaceInBand { apart: Some(apart), ..between(25.0, 25.0) }, 1.0)
        };
        let at = |apart: f64| of(&model, apart);
        assert!((at(0.0) / at(1e9) - least / (least + slope * most)).abs() < 1e-12);
        assert!(at(0.0) < at(0.1) && at(0.1) < at(0.3) && at(0.3) < at(1e9));
        // With one surface only, there is one error for all.
        let plain = learn(&places(1.0, 100.0), Some(1.0), 10.0, 50.0).error(&between(25.0, 25.0), 1.0);
        assert!(at(0.0) < plain && of(&other, 0.0) < plain && plain < of(&other, 1e9));
        let contour = PlaceInBand { apart: Some(1.0), ..between(0.0, 50.0) };
        assert_eq!(model.error(&contour, 1.0), 0.0);
        let usual = learn(&[], Some(1.0), 10.0, 50.0);
        let of_usual = |apart: f64| usual.error(&PlaceInBand { apart: Some(apart), ..between(25.0, 25.0) }, 1.0);
        assert_eq!(of_usual(0.0), of_usual(1.0));
    }

    #[test]
    fn errors_on_level_ground_shrink_with_the_band_only() {
        let share = |spacing: f64| {
            let model = learn(&places(1.0, 100.0), Some(2.0), 10.0, spacing);
            model.error(&between(25.0, 25.0), 1.0)
        };
        assert!((share(50.0 / 7.0) / share(50.0) - 2.0).abs() < 0.05);
    }
}
