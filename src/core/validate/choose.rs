//! Chooses the hyper-parameters of the smooth surface by cross-validation on hidden levels, and estimates its accuracy.
//!
//! Every second level is hidden, and a surface is built from the others. Its heights are compared with the hidden
//! contours where these lie between two levels. This is done twice: with the odd levels hidden and with the even ones.
//! Three tensions are tried. A parabola goes through the logarithms of the three errors. The best tension is where it
//! is lowest.
//!
//! The noise of the contours comes from the contours themselves ([`hurst_exponent`]). Hidden levels cannot show it.
//! Between contours twice as far apart, even smooth ground looks rough, and smoothing seems to help where it does not.
//!
//! Three rules keep this from misleading:
//!
//! * Contours are dense on steep ground. So every place on a hidden contour has the weight of the ground that it stands
//!   for: length of contour times distance to the next level.
//! * A surface from half of the levels spans twice the distance. Over this distance, ground is rougher and wants more
//!   tension. Also, hidden levels are few and their errors noisy. So the choice is half-way, on a logarithmic scale,
//!   between the best tension for them and the one that suits most terrain.
//! * Places beside repaired crossings are left out. Otherwise one patch of broken lines would decide for the whole map.
//!
//! The residuals at hidden levels also give the sharpness of ridges and canyons, the standard error half-way between
//! contours, and the curvature gain.

use super::builder::TrialParams;
use super::roughness::hurst_exponent;
use super::trial::{TrialResidual, trials};
use crate::spline::{HyperParameters, SplineParams};
use crate::subdomains::MapExtent;
use crate::tuning::TrialTuning;

/// Number of tensions that are tried: as many as a parabola has coefficients.
const TRIED: usize = 3;
/// Least number of levels. With fewer, one of the halves has no band with a hidden level in it.
const FEWEST_LEVELS: usize = 5;
/// Ratio of an error's root mean square over a band to its size half-way, where a hidden level lies. The error is a
/// parabola from one level to the next. A closed form: the square root of 8/15.
const OVER_BAND: f64 = 0.730_296_743;
/// How far beyond the tensions that are tried the best one may be taken to lie, in steps from one to the next.
const MAX_EXTRAPOLATION: f64 = 0.5;
/// Limits of the IRLS threshold across ridge and canyon lines.
const CREASE_THRESHOLD_LIMITS: [f64; 2] = [0.03, 0.3];

/// The choice of hyper-parameters, and the accuracy that hidden levels show.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Chosen {
    /// The hyper-parameters.
    pub hyper_parameters: HyperParameters,
    /// The reason for the tension.
    pub reason: Reason,
    /// Whether wrong elevations were mended before the choice: lines got their proposed elevations or were left out.
    pub is_mended: bool,
    /// The accuracy at hidden contours; `None` if none were hidden.
    pub hidden: Option<Accuracy>,
    /// The accuracy that this implies for the surface from all contours; `None` if none were hidden.
    ///
    /// With half the contour interval, the error is smaller. It falls with a power of the distance, the Hurst-like
    /// exponent of the contours: 2 for smooth ground, less for rough ground. Also, the error is largest half-way
    /// between two levels, where the hidden ones lie. On known terrain of many kinds, the true error was mostly between
    /// two thirds and one and a half times this figure.
    pub implied: Option<Accuracy>,
}

/// The reason for the tension.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub enum Reason {
    /// Chosen by cross-validation on hidden levels.
    Hidden,
    /// Given as a parameter.
    Given,
    /// The usual tension, because there were too few levels or too few places on hidden contours.
    FellBack,
}

/// The accuracy of heights.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Accuracy {
    /// Root mean square error, metres.
    pub rmse: f64,
    /// 90 % of the errors are smaller, metres.
    pub le90: f64,
    /// Contour interval of the contours that the surface was built from, metres.
    pub interval: f64,
    /// Number of places that were compared.
    pub count: usize,
}

/// Chooses the hyper-parameters that `given` leaves open.
///
/// The result does not depend on the number of threads. On large maps, only some squares are tried. So the choice takes
/// at most about as long as the surface itself.
pub fn choose(extent: &MapExtent<'_>, given: &SplineParams, params: &TrialParams<'_>) -> Chosen {
    let SplineParams { tension, noise, .. } = *given;
    let (roughness, tuning) = (&params.tuning.roughness, &params.tuning.trials);
    let exponent = hurst_exponent(extent, roughness);
    let noise = noise.unwrap_or_else(|| tuning.noise * roughness.noisy_share(exponent));
    let usual_threshold = tuning.usual_crease_threshold;
    let hyper_parameters = |tension: f64| HyperParameters {
        tension,
        noise,
        crease_threshold: usual_threshold,
        half_way_error: 0.0,
        relative_variance: 0.0,
        curvature_gain: 0.0,
    };
    let chosen =
        |hyper_parameters, reason| Chosen { hyper_parameters, reason, is_mended: false, hidden: None, implied: None };
    let without = |tension, reason| chosen(hyper_parameters(tension), reason);
    if let Some(tension) = tension {
        return without(tension, Reason::Given);
    }
    let fallback = without(tuning.usual_tension, Reason::FellBack);
    if levels(extent) < FEWEST_LEVELS {
        return fallback;
    }
    let mut residuals = trials(extent, params, tried(tuning).map(hyper_parameters));
    if residuals[0].len() < tuning.min_places {
        return fallback;
    }
    let errors = residuals.each_ref().map(|m| rmse(m));
    if !errors.iter().all(|e| e.is_finite()) {
        return fallback;
    }
    let logarithms = errors.map(|e| e.max(f64::MIN_POSITIVE).ln());
    let best = tuning.tension_factor.powf(lowest(logarithms, MAX_EXTRAPOLATION));
    let nearest = (0..TRIED).fold(0, |best, k| if errors[k] < errors[best] { k } else { best });
    let step = extent.interval.step;
    let hidden = Accuracy {
        rmse: errors[nearest],
        le90: le90(&mut residuals[nearest]),
        interval: 2.0 * step,
        count: residuals[nearest].len(),
    };
    let half_way = 0.5f64.powf(roughness.power(exponent));
    let share = OVER_BAND * half_way;
    let implied = Accuracy { rmse: share * hidden.rmse, le90: share * hidden.le90, interval: step, ..hidden };
    let half_way_error = half_way * hidden.rmse;
    let tension = (tuning.usual_tension * best).sqrt();
    let gain = curvature_gain(&residuals, tension, tuning);
    let hyper_parameters = HyperParameters {
        crease_threshold: crease_threshold(&hidden, tuning),
        half_way_error,
        relative_variance: relative_variance(&residuals[nearest]),
        curvature_gain: gain,
        ..hyper_parameters(tension)
    };
    Chosen { hidden: Some(hidden), implied: Some(implied), ..chosen(hyper_parameters, Reason::Hidden) }
}

/// The IRLS threshold across ridge and canyon lines. Where surfaces meet the hidden contours well, the contours are
/// dense enough to show round ridges, and the threshold is high. Where the ground has more detail than the contours,
/// ridges are sharp, and the threshold is low.
fn crease_threshold(hidden: &Accuracy, tuning: &TrialTuning) -> f64 {
    let [least, most] = CREASE_THRESHOLD_LIMITS;
    let ratio = hidden.rmse / hidden.interval / tuning.usual_hidden_error;
    (tuning.usual_crease_threshold / ratio.powi(2)).clamp(least, most)
}

/// The tensions that are tried.
fn tried(tuning: &TrialTuning) -> [f64; TRIED] {
    let factor = tuning.tension_factor;
    [1.0, factor, factor * factor]
}

/// The curvature gain of a surface with a tension, as a share of the standard error. It is the regression of the
/// residuals on [`TrialResidual::unit_gain`], interpolated between the tensions that were tried. A surface that curves
/// more than the ground gets none.
fn curvature_gain(residuals: &[Vec<TrialResidual>; TRIED], tension: f64, tuning: &TrialTuning) -> f64 {
    let gain_of = |residuals: &Vec<TrialResidual>| {
        let sum = |value: fn(&TrialResidual) -> f64| residuals.iter().map(value).sum::<f64>();
        -sum(|m| m.weight * m.by * m.unit_gain) / sum(|m| m.weight * m.unit_gain * m.unit_gain) / rmse(residuals)
    };
    let place = (tension.ln() / tuning.tension_factor.ln()).clamp(0.0, (TRIED - 1) as f64);
    let below = (place as usize).min(TRIED - 2);
    let [near, far] = [below, below + 1].map(|k| gain_of(&residuals[k]));
    let share = tuning.gain_share * (near + (place - below as f64) * (far - near));
    // If no place has a unit gain, there is no gain.
    if share.is_nan() { 0.0 } else { share.clamp(0.0, 1.0) }
}

/// Number of levels that are whole intervals.
fn levels(extent: &MapExtent<'_>) -> usize {
    let interval = extent.interval;
    let on = extent.map.contours.iter().filter(|c| interval.is_level(c.elevation));
    let mut numbers: Vec<i64> = on.map(|c| interval.index_of(c.elevation)).collect();
    numbers.sort_unstable();
    numbers.dedup();
    numbers.len()
}

/// Where the parabola through three values at 0, 1 and 2 is lowest, at most `beyond` outside their range.
fn lowest([a, b, c]: [f64; TRIED], beyond: f64) -> f64 {
    let (slope, bend) = ((c - a) / 2.0, a - 2.0 * b + c);
    let at = if bend > 0.0 {
        1.0 - slope / bend
    } else if a < c {
        f64::NEG_INFINITY
    } else {
        f64::INFINITY
    };
    at.clamp(-beyond, 2.0 + beyond)
}

/// The mean of the relative variance over the ground.
fn relative_variance(residuals: &[TrialResidual]) -> f64 {
    let (sum, weights) =
        residuals.iter().fold((0.0, 0.0), |(s, w), m| (s + m.weight * m.relative_variance, w + m.weight));
    sum / weights
}

fn rmse(residuals: &[TrialResidual]) -> f64 {
    let (sum, weights) = residuals.iter().fold((0.0, 0.0), |(s, w), m| (s + m.weight * m.by * m.by, w + m.weight));
    (sum / weights).sqrt()
}

/// The error below which nine tenths of the weight lie.
fn le90(residuals: &mut [TrialResidual]) -> f64 {
    residuals.sort_by(|a, b| a.by.abs().total_cmp(&b.by.abs()));
    let all: f64 = residuals.iter().map(|m| m.weight).sum();
    let mut below = 0.0;
    let reached = residuals.iter().find(|m| {
        below += m.weight;
        below >= 0.9 * all
    });
    reached.map_or(0.0, |m| m.by.abs())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_lowest_place_is_between_or_a_little_beyond() {
        assert!((lowest([1.0, 0.0, 1.0], 0.5) - 1.0).abs() < 1e-12);
        assert!((lowest([0.25, 0.25, 2.25], 0.5) - 0.5).abs() < 1e-12);
        assert_eq!(lowest([0.0, 1.0, 2.0], 0.5), -0.5);
        assert_eq!(lowest([2.0, 1.5, 0.0], 0.5), 2.5);
        assert_eq!(lowest([1.0, 1.0, 1.0], 0.5), 2.5);
    }

    #[test]
    fn ridges_are_sharper_where_contours_show_less() {
        const MISSED: f64 = 0.14;
        let hidden = |rmse: f64| Accuracy { rmse, le90: rmse, interval: 20.0, count: 1 };
        let threshold = |rmse: f64| crease_threshold(&hidden(rmse), &TrialTuning::default());
        assert_eq!(threshold(MISSED * 20.0), 0.1);
        assert!((threshold(0.7 * MISSED * 20.0) - 0.1 / 0.49).abs() < 1e-12);
        assert_eq!([threshold(0.0), threshold(20.0)], [0.3, 0.03]);
    }

    #[test]
    fn a_part_of_the_curvature_gain_at_hidden_contours_is_applied() {
        // Errors are two metres, up and down. Where the surface bulges, it is too low by a share of them.
        let of = |share: f64| -> Vec<TrialResidual> {
            let place = |k: i32| {
                let (error, unit_gain) = (if k % 2 == 0 { 2.0 } else { -2.0 }, f64::from(k % 4 - 2).signum() * 0.5);
                TrialResidual { by: error - 2.0 * share * unit_gain, weight: 1.0, unit_gain, relative_variance: 1.0 }
            };
            (0..400).map(place).collect()
        };
        let rmse_of = |share: f64| rmse(&of(share));
        let tuning = TrialTuning::default();
        let gain = |residuals: &[Vec<TrialResidual>; TRIED], tension: f64| curvature_gain(residuals, tension, &tuning);
        let expected = |share: f64| tuning.gain_share * 2.0 * share / rmse_of(share);
        let residuals = [of(0.2), of(0.4), of(0.8)];
        assert!((gain(&residuals, 1.0) - expected(0.2)).abs() < 1e-9, "{}", gain(&residuals, 1.0));
        assert!(
            gain(&residuals, tuning.tension_factor) > gain(&residuals, 1.0)
                && gain(&residuals, 100.0) > gain(&residuals, tuning.tension_factor)
        );
        assert_eq!(gain(&residuals, 1e9), gain(&residuals, tried(&tuning)[2]));
        assert_eq!(gain(&[of(-0.5), of(-0.5), of(-0.5)], 3.0), 0.0);
        let none = || vec![TrialResidual { by: 1.0, weight: 1.0, unit_gain: 0.0, relative_variance: 1.0 }];
        assert_eq!(gain(&[none(), none(), none()], 3.0), 0.0);
    }

    #[test]
    fn errors_count_by_weight() {
        let of = |weight: f64, by: f64| TrialResidual { by, weight, unit_gain: 0.0, relative_variance: 1.0 };
        let mut residuals = vec![of(8.9, 1.0), of(1.0, -4.0), of(0.1, 9.0)];
        assert!((rmse(&residuals).powi(2) - (8.9 + 16.0 + 8.1) / 10.0).abs() < 1e-12);
        assert_eq!(le90(&mut residuals), 4.0);
    }
}
