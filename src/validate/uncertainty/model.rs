//! The law of the error: what hidden contours teach, carried over to the map with all its levels.
//!
//! Between two contours the error grows with the width between them and is largest half-way. The hidden contours give
//! it there, for widths of twice the usual, as the figure that 68 of 100 errors lie below. From twice the interval to the
//! interval it shrinks by the power that the contours themselves bend with ([`exponent`](crate::spline)): the same
//! law of roughness governs how far a line strays from its chord and how far the ground strays from a surface between
//! lines. Where ground is so level that the error fills the band, it shrinks with the band only; in between the two laws
//! pass into each other. Towards a contour the error falls with half of that power of the product of both distances, as
//! that of any random walk that is tied down at both ends.
//!
//! Ground between contours much further apart than in the mean is level for the interval: there the error shrinks with the
//! band only, too.
//!
//! The smooth surface and that of the triangles with ridge and canyon lines are two guesses from the same contours. Where they
//! are far apart, the contours leave much open, and the error is larger than the distance between contours tells.
//!
//! Beyond the last contour of a top or a pit the height is a guess from the slope: the error is a share of the climb, and
//! that share is what the surface from half of the levels missed its tops by.

use super::residuals::Residual;
use crate::tuning::{ErrorTuning, Tuning};

/// Shares of errors that lie within one and two standard errors: those of a normal distribution, rounded.
const WITHIN: [f64; 2] = [0.68, 0.95];

/// Where the error came from.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Provenance {
    /// From contours that were hidden.
    Hidden {
        /// Places on them.
        places: usize,
    },
    /// There were too few levels or places; the error is that of usual terrain.
    Usual,
}

/// The law of the error.
#[derive(Debug, Clone, PartialEq)]
pub struct ErrorModel {
    /// Where it came from.
    pub provenance: Provenance,
    /// Power of the distance between contours that the error grows with.
    pub exponent: f64,
    /// Share of a climb beyond the last contour that is error.
    pub beyond: f64,
    /// Logarithms of width (map units) and of the standard error half-way (metres), ascending in width.
    curve: Vec<[f64; 2]>,
    interval: f64,
    tuning: ErrorTuning,
}

/// What is known about a place.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Known {
    /// Distances from what is known below and above, map units; infinite if there is nothing.
    pub sides: [f64; 2],
    /// The band that holds the height, metres.
    pub band: [f64; 2],
    /// Height above or below the only contour of the sub-domain and whether that is the lower one; `None` between two.
    pub climb: Option<(f64, bool)>,
    /// How far the smooth surface is from that of the triangles, metres; `None` on the latter.
    pub apart: Option<f64>,
}

impl ErrorModel {
    /// Learns from what was seen. `exponent` is that of the contours, `interval` in metres, `spacing` the mean distance between
    /// contours.
    pub fn learn(seen: &[Residual], exponent: Option<f64>, interval: f64, spacing: f64, tuning: &Tuning) -> Self {
        let (exponent, fewest, tuning) = (tuning.roughness.power(exponent), tuning.trials.min_places, tuning.errors);
        let [least_share, most_share] = tuning.climb_share_limits;
        let (mut between, mut beyond): (Vec<Residual>, Vec<Residual>) =
            seen.iter().partition(|s| s.width().is_finite());
        between.retain(|s| s.width() > 0.0);
        let beyond_usual = tuning.usual_climb_share;
        let curve = usual(interval, spacing, &tuning);
        let usual = Self { provenance: Provenance::Usual, exponent, beyond: beyond_usual, curve, interval, tuning };
        if between.len() < fewest {
            return usual;
        }
        let share = quantile(&mut beyond, |s| s.length, WITHIN[0]) / interval;
        let is_known = beyond.len() >= tuning.min_top_places;
        let beyond = if is_known { share.clamp(least_share, most_share) } else { beyond_usual };
        let classes = classes(&mut between, tuning.width_classes, fewest);
        let curve = classes.into_iter().map(|class| point(class, exponent, interval, spacing, &tuning)).collect();
        Self { provenance: Provenance::Hidden { places: between.len() }, beyond, curve, ..usual }
    }

    /// The standard error at a place, metres: never more than half the band. `fixed` is how far contours cut from the
    /// nodes themselves fix it, 1 for not at all.
    pub fn error(&self, place: &Known, fixed: f64) -> f64 {
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
                // The usual error is that of both guesses.
                let doubt =
                    if self.provenance == Provenance::Usual { 1.0 } else { doubt(place.apart, error, &self.tuning) };
                fixed * error * doubt
            }
        };
        error.min(most)
    }

    /// The standard error half-way between contours so far apart; towards narrower ones than any that were seen it falls
    /// with power `narrow`.
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

/// How far from its ends a place lies on the way between two contours: 0 on either, 1 half-way, also where there is but one.
fn profile([below, above]: [f64; 2]) -> f64 {
    let share = if below.max(above).is_finite() { below / (below + above) } else { 0.5 };
    4.0 * share * (1.0 - share)
}

/// Factor on an error for the distance between two guesses; 1 where there is but one.
fn doubt(apart: Option<f64>, error: f64, tuning: &ErrorTuning) -> f64 {
    let Some(apart) = apart else { return 1.0 };
    let ErrorTuning { agreement_factor, disagreement_slope, max_disagreement, .. } = *tuning;
    let times = apart / error;
    agreement_factor + if times.is_nan() { 0.0 } else { disagreement_slope * times.min(max_disagreement) }
}

/// What is left of the error of nodes whose own heights the contours were cut from, with so many crossings a node around:
/// every crossing of an edge is an equation, and where there are about as many of these as nodes, little is left open.
pub fn left(crossings: f64, tuning: &ErrorTuning) -> f64 {
    let ErrorTuning { fixing_crossings, fixing_power, min_left, .. } = *tuning;
    (1.0 / (1.0 + (crossings / fixing_crossings).powf(fixing_power)).sqrt()).max(min_left)
}

/// The curve where nothing can be hidden.
fn usual(interval: f64, spacing: f64, tuning: &ErrorTuning) -> Vec<[f64; 2]> {
    let ErrorTuning { usual_error, usual_width_power, .. } = *tuning;
    let at = |wide: f64| [(wide * spacing).ln(), (usual_error * interval * wide.powf(usual_width_power)).ln()];
    vec![at(0.1), at(10.0)]
}

/// The places in `count` classes of width that stand for equal areas; without those of fewer places than their part of `fewest`.
fn classes(between: &mut [Residual], count: usize, fewest: usize) -> Vec<Vec<Residual>> {
    between.sort_by(|a, b| a.width().total_cmp(&b.width()));
    let area = |s: &Residual| s.length * s.width();
    let all: f64 = between.iter().map(area).sum();
    let mut classes: Vec<Vec<Residual>> = vec![Vec::new(); count];
    let mut sum = 0.0;
    for seen in between.iter() {
        let class = (sum / all * count as f64) as usize;
        classes[class.min(count - 1)].push(*seen);
        sum += area(seen);
    }
    // A class of very few wide gaps tells too little.
    classes.retain(|class| class.len() >= fewest / count);
    classes
}

/// Width and error of a class, carried from twice the interval to the interval; `spacing` is the mean distance between contours.
fn point(mut class: Vec<Residual>, exponent: f64, interval: f64, spacing: f64, tuning: &ErrorTuning) -> [f64; 2] {
    let ErrorTuning { two_sigma_weight, max_tail, unknown, .. } = *tuning;
    let [level_from, level_at] = tuning.level_spacings;
    let width = class[class.len() / 2].width();
    let area = |s: &Residual| s.length * s.width();
    let usual = quantile(&mut class, area, WITHIN[0]);
    class.iter_mut().for_each(|s| s.by /= doubt(s.apart, usual, tuning));
    let [one, two] = WITHIN.map(|q| quantile(&mut class, area, q));
    let error = if class.iter().all(|s| s.apart.is_none()) {
        tuning.hidden_to_all_triangles * one.max(two / max_tail)
    } else {
        // Between what both figures tell; what the first does, where tails are heavy.
        let both = one.powf(1.0 - two_sigma_weight) * (two / 2.0).powf(two_sigma_weight);
        tuning.hidden_to_all * both.min(one).max(two / max_tail)
    };
    let level = ((width / 2.0 / spacing / level_from).ln() / (level_at / level_from).ln()).clamp(0.0, 1.0);
    let exponent = exponent + level * (exponent.min(1.0) - exponent);
    // An error that fills the band is the same share of every band; a small one falls with its power.
    let share = (error / (2.0 * interval)).clamp(1e-6, 0.98 * unknown);
    let free = share / (1.0 - (share / unknown).powi(2)).sqrt() * 2f64.powf(1.0 - exponent);
    let share = free / (1.0 + (free / unknown).powi(2)).sqrt();
    [(width / 2.0).ln(), (interval * share).ln()]
}

/// The error that a share of the weight lies below; 0 without any.
fn quantile(seen: &mut [Residual], weight: impl Fn(&Residual) -> f64, share: f64) -> f64 {
    seen.sort_by(|a, b| a.by.total_cmp(&b.by));
    let all: f64 = seen.iter().map(&weight).sum();
    let mut below = 0.0;
    let reached = seen.iter().find(|s| {
        below += weight(s);
        below >= share * all
    });
    reached.map_or(0.0, |s| s.by)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn learn(seen: &[Residual], exponent: Option<f64>, interval: f64, spacing: f64) -> ErrorModel {
        ErrorModel::learn(seen, exponent, interval, spacing, &Tuning::default())
    }

    /// Errors of all sizes up to `most`, in no order, on contours between others that are `width` apart.
    fn places(most: f64, width: f64) -> Vec<Residual> {
        let at = |k: i32| {
            let by = most * f64::from(k * 617 % 1000) / 999.0;
            Residual { by, apart: None, sides: [width / 2.0; 2], length: 1.0 }
        };
        (0..1000).map(at).collect()
    }

    fn between(below: f64, above: f64) -> Known {
        Known { sides: [below, above], band: [10.0, 20.0], climb: None, apart: None }
    }

    #[test]
    fn errors_shrink_by_the_power_that_contours_bend_with() {
        for exponent in [1.0, 1.5, 2.0] {
            let model = learn(&places(1.0, 100.0), Some(exponent), 10.0, 50.0);
            assert_eq!(model.provenance, Provenance::Hidden { places: 1000 });
            let halfway = model.error(&between(25.0, 25.0), 1.0);
            let expected = 0.68 * ErrorTuning::default().hidden_to_all_triangles * 0.5f64.powf(exponent);
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
                let error = model.error(&Known { sides, band: [10.0, 20.0], climb, apart: None }, 1.0);
                assert!(error > 1.0 && error <= 5.0, "{sides:?} {climb:?} {error}");
            }
        }
    }

    #[test]
    fn a_spot_height_ends_the_doubt_about_a_top() {
        let model = learn(&[], None, 10.0, 50.0);
        assert_eq!(model.provenance, Provenance::Usual);
        let top = |spot: f64| Known { sides: [30.0, spot], band: [10.0, 20.0], climb: Some((8.0, true)), apart: None };
        assert_eq!(model.error(&top(0.0), 1.0), 0.0);
        assert!(model.error(&top(3.0), 1.0) < model.error(&top(f64::INFINITY), 1.0));
    }

    #[test]
    fn contours_cut_from_the_nodes_fix_them_where_they_are_dense() {
        let left = |crossings: f64| left(crossings, &ErrorTuning::default());
        assert!(left(0.3) > 0.99 && left(0.5) > 0.9 && left(1.0) < 0.5);
        assert_eq!(left(9.0), 0.15);
    }

    #[test]
    fn errors_are_larger_where_two_guesses_are_far_apart() {
        // Errors in proportion to how far they are.
        let mut seen = places(1.0, 100.0);
        seen.iter_mut().for_each(|s| s.apart = Some(s.by));
        let model = learn(&seen, Some(1.0), 10.0, 50.0);
        let tuning = ErrorTuning::default();
        let [least, slope, most] = [tuning.agreement_factor, tuning.disagreement_slope, tuning.max_disagreement];
        let at = |apart: f64| model.error(&Known { apart: Some(apart), ..between(25.0, 25.0) }, 1.0);
        assert!((at(0.0) / at(1e9) - least / (least + slope * most)).abs() < 1e-12);
        assert!(at(0.0) < at(0.1) && at(0.1) < at(0.3) && at(0.3) < at(1e9));
        // Without the other guess there is one error for all.
        let plain = learn(&places(1.0, 100.0), Some(1.0), 10.0, 50.0).error(&between(25.0, 25.0), 1.0);
        assert!(at(0.0) < plain && plain < at(1e9));
        let contour = Known { apart: Some(1.0), ..between(0.0, 50.0) };
        assert_eq!(model.error(&contour, 1.0), 0.0);
        let usual = learn(&[], Some(1.0), 10.0, 50.0);
        let of_usual = |apart: f64| usual.error(&Known { apart: Some(apart), ..between(25.0, 25.0) }, 1.0);
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
