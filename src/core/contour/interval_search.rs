//! The vertical interval of a map, from the levels of its lines.
//!
//! Real maps leave levels out. They have auxiliary contours at half or a quarter of the interval where the ground is
//! flat, and some wrong labels. So a greatest common divisor does not help. Instead each plausible step gets a mark
//! from two shares, and the best mark wins:
//! - *explained*: the share of the lines on the step's levels. A step too large leaves half of the lines out.
//! - *filled*: the share of the step's levels that have lines, and as many as a level usually has. A step too small,
//!   fit for the auxiliary contours or a wrong label, leaves its levels empty or nearly so.
//!
//! Steps that maps usually have get a better mark than others.
//!
//! Elevations may be rounded: 15, 30, 46, 61 m are 50 ft. Then the differences of levels are no steps, but their means are, and a
//! level may be off by half of what elevations are rounded to.
//!
//! Lines count by their vertices, so that a short auxiliary contour or one wrong label does not count for a whole level.

use super::levels::Interval;
use super::map::Contour;

/// Exponent of a level's number of vertices in its weight. Below one, so that a single level with very many lines (the
/// shore of a plain) does not outvote the others.
const DAMPING: f64 = 0.75;
/// How far a level may be off the step's own level and still be explained by it, as a share of the step. Wide enough for
/// feet converted to metres and rounded to a decimetre.
const OFF_LEVEL: f64 = 0.02;
/// Weight of *filled* against *explained* (the square of beta in the F measure). Below one: a level that has lines is
/// stronger evidence than one that has none. At one half, main contours can still be distinguished from auxiliary
/// contours at a quarter of all levels.
const FILLED_WEIGHT: f64 = 0.5;
/// The same for elevations that are rounded, at most. Maps are not rounded to a larger share of their interval.
const MOST_ROUNDED: f64 = 0.08;
/// What elevations are rounded to, in metres or feet.
const ROUNDED: [f64; 5] = [1.0, 0.1, 0.01, 0.001, 0.0001];
/// Elevations count as rounded to a unit if this share of the lines is.
const ALL_ROUNDED: f64 = 0.95;
/// Empty levels in a row count at most this many times. So one absurd label does not spoil the true step's mark.
const MAX_GAP: f64 = 4.0;
/// Factor on the mark of a step whose levels do not contain zero. Nearly all maps count from zero.
const OFFSET_MARK: f64 = 0.9;
/// Factor on the mark of a step that maps do not usually have. If few levels leave the choice open, 30 m is a poorer
/// guess than 10 m with levels left out.
const ODD_MARK: f64 = 0.9;
/// First digits of the steps that maps usually have, in metres or feet.
const USUAL_DIGITS: [f64; 6] = [1.0, 2.0, 2.5, 4.0, 5.0, 8.0];
/// Largest deviation from those steps, as a share of them: a survey foot is a foot.
const SAME_DIGITS: f64 = 1e-5;
/// A foot, metres.
const FOOT: f64 = 0.3048;
/// Largest number of levels examined, the heaviest first. So elevations without any step cost little time.
const MAX_LEVELS: usize = 4096;
/// Largest number of level differences that are tried as steps, the heaviest first.
const MAX_DIFFERENCES: usize = 24;
/// Largest number of differences whose common divisors are tried too.
const MAX_DIVIDED: usize = 10;
/// Levels closer than this share of the largest elevation are one level, rounded in two ways.
const SAME_LEVEL: f64 = 1e-9;

/// A level and how much it counts.
#[derive(Clone, Copy)]
struct Weighted {
    z: f64,
    weight: f64,
}

/// Finds the vertical (contour) interval from the levels that the lines have.
///
/// It allows for auxiliary contours in places, missing levels, some wrong labels, levels that are no whole numbers
/// (feet in metres) and levels that do not start from zero. `None` if there are fewer than two different levels. With
/// very few levels the answer can be ambiguous: 0, 20 and 50 may mean 10 m, or 20 m and a half level.
pub fn find_interval(contours: &[Contour]) -> Option<Interval> {
    let levels = weighted_levels(contours);
    if levels.len() < 2 {
        return None;
    }
    let unit = rounded_to(&levels);
    candidate_steps(&levels, unit)
        .into_iter()
        .filter_map(|step| fit(&levels, step, unit))
        .map(|interval| (mark(&levels, &interval, off_limit(interval.step, unit)), interval))
        .max_by(|(a, p), (b, q)| a.total_cmp(b).then(p.step.total_cmp(&q.step)).then(q.base.total_cmp(&p.base)))
        .map(|(_, interval)| interval)
}

/// The levels from low to high with their weights. Levels that differ only by rounding are combined.
fn weighted_levels(contours: &[Contour]) -> Vec<Weighted> {
    let mut all: Vec<Weighted> = contours
        .iter()
        .filter(|c| c.elevation.is_finite())
        .map(|c| Weighted { z: c.elevation + 0.0, weight: c.points.len().max(1) as f64 })
        .collect();
    all.sort_unstable_by(|a, b| a.z.total_cmp(&b.z));
    let same = SAME_LEVEL * all.iter().map(|l| l.z.abs()).fold(0.0, f64::max);
    let mut levels: Vec<Weighted> = Vec::new();
    for level in all {
        match levels.last_mut() {
            Some(last) if level.z - last.z <= same => last.weight += level.weight,
            _ => levels.push(level),
        }
    }
    for level in &mut levels {
        level.weight = level.weight.powf(DAMPING);
    }
    if levels.len() > MAX_LEVELS {
        levels.sort_unstable_by(|a, b| b.weight.total_cmp(&a.weight).then(a.z.total_cmp(&b.z)));
        levels.truncate(MAX_LEVELS);
        levels.sort_unstable_by(|a, b| a.z.total_cmp(&b.z));
    }
    levels
}

/// The unit that elevations are rounded to, metres; 0 if there is none.
fn rounded_to(levels: &[Weighted]) -> f64 {
    let total: f64 = levels.iter().map(|l| l.weight).sum();
    let slack = SAME_LEVEL * levels.iter().map(|l| l.z.abs()).fold(0.0, f64::max);
    let units = ROUNDED.into_iter().flat_map(|unit| [unit, unit * FOOT]);
    let is_unit = |unit: &f64| {
        let on = levels.iter().filter(|l| (l.z - (l.z / unit).round() * unit).abs() <= slack);
        on.map(|l| l.weight).sum::<f64>() >= ALL_ROUNDED * total
    };
    units.into_iter().find(is_unit).unwrap_or(0.0)
}

/// Whether a step is a whole number of units, so that its levels need not be rounded.
fn is_whole(step: f64, unit: f64) -> bool {
    unit == 0.0 || ((step / unit) - (step / unit).round()).abs() <= 1e-6
}

/// How far a level may be off the step's own level, as a share of the step.
fn off_limit(step: f64, unit: f64) -> f64 {
    if is_whole(step, unit) { OFF_LEVEL } else { (0.51 * unit / step).clamp(OFF_LEVEL, MOST_ROUNDED) }
}

/// The step that maps usually have which is nearest to a step, if it is within `tolerance`.
fn usual_step(step: f64, tolerance: f64) -> Option<f64> {
    let power = step.log10().floor();
    let powers = || (-1..=1).map(|more| 10f64.powf(power + f64::from(more)));
    let usual = [1.0, FOOT].into_iter().flat_map(|unit| USUAL_DIGITS.map(|digits| unit * digits));
    let all = usual.flat_map(|step| powers().map(move |power| step * power));
    let nearest = all.min_by(|a, b| (a - step).abs().total_cmp(&(b - step).abs()));
    nearest.filter(|usual| (usual - step).abs() <= tolerance)
}

/// Differences between levels near each other, the common divisors of the most frequent ones, and, of elevations that are rounded to
/// a unit, the means of differences that are one step but for rounding.
fn candidate_steps(levels: &[Weighted], unit: f64) -> Vec<f64> {
    let mut differences: Vec<(f64, f64)> = Vec::new();
    // A level in between may be auxiliary or wrong, so levels two and three further on count as well.
    for lag in 1..=3 {
        for (low, high) in levels.iter().zip(levels.iter().skip(lag)) {
            differences.push((high.z - low.z, low.weight.min(high.weight)));
        }
    }
    differences.retain(|(d, _)| d.is_finite());
    differences.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.total_cmp(&b.1)));
    let mean = |about: f64| {
        let near = differences.iter().filter(|(d, _)| (d - about).abs() <= unit * (1.0 + 1e-6));
        let (sum, count) = near.fold((0.0, 0.0), |(sum, count), (d, _)| (sum + d, count + 1.0));
        sum / count
    };
    let mut groups: Vec<(f64, f64)> = Vec::new();
    for &(difference, weight) in &differences {
        match groups.last_mut() {
            Some((d, w)) if difference - *d <= 1e-6 * *d => *w += weight,
            _ => groups.push((difference, weight)),
        }
    }
    groups.sort_unstable_by(|a, b| b.1.total_cmp(&a.1).then(b.0.total_cmp(&a.0)));
    groups.truncate(MAX_DIFFERENCES);
    let mut steps: Vec<f64> = groups.iter().map(|g| g.0).collect();
    if unit > 0.0 {
        let means: Vec<f64> = steps.iter().map(|&about| mean(about)).filter(|mean| !is_whole(*mean, unit)).collect();
        steps.extend(means.iter().filter_map(|&mean| usual_step(mean, unit / 2.0)));
        steps.extend(means);
    }
    let divided = &groups[..groups.len().min(MAX_DIVIDED)];
    for (i, a) in divided.iter().enumerate() {
        steps.extend(divided[i + 1..].iter().map(|b| common_divisor(a.0, b.0)));
    }
    steps.sort_unstable_by(f64::total_cmp);
    steps.dedup();
    steps
}

/// Euclid's algorithm on lengths with rounding errors.
fn common_divisor(a: f64, b: f64) -> f64 {
    let tolerance = 1e-3 * a.min(b);
    let (mut a, mut b) = (a.max(b), a.min(b));
    while b > tolerance {
        // With rounding errors, a remainder just below b is as good as one just above zero.
        let remainder = a % b;
        (a, b) = (b, remainder.min(b - remainder));
    }
    a
}

/// The step with its best base: the heaviest set of levels that lie whole steps apart, then a straight line through them.
fn fit(levels: &[Weighted], step: f64, unit: f64) -> Option<Interval> {
    let (limit, is_rounded) = (off_limit(step, unit), !is_whole(step, unit));
    let window = if is_rounded { (unit / step).clamp(OFF_LEVEL, 2.0 * MOST_ROUNDED) } else { OFF_LEVEL };
    let base = heaviest_base(levels, step, window)?;
    let mut interval = Interval { step, base, rounding: 0.0 };
    let mut precision = 0.0;
    // A step from one pair of rounded levels is accurate only near them. Each round reaches further.
    let anchor = levels
        .iter()
        .filter(|l| off_level(&interval, l.z) <= limit)
        .max_by(|a, b| a.weight.total_cmp(&b.weight).then(b.z.total_cmp(&a.z)))?;
    interval.base = anchor.z;
    // Rounded levels are off by twice as much from another rounded one.
    let reached = if is_rounded { 2.0 * limit } else { limit };
    for reach in [10.0, 100.0, f64::INFINITY] {
        let near = levels.iter().filter(|l| {
            let k = (l.z - anchor.z) / interval.step;
            k.abs() <= reach && off_level(&interval, l.z) <= reached
        });
        if let Some((line, error)) = straight_line(near, &interval) {
            (interval, precision) = (line, error);
        }
    }
    let precision = precision.max(1e-10 * interval.step);
    let usual = if is_rounded { usual_step(interval.step, precision) } else { None };
    let step = usual.unwrap_or_else(|| short_decimal(interval.step, precision));
    if !(step.is_finite() && step > 0.0) {
        return None;
    }
    let near: Vec<&Weighted> = levels.iter().filter(|l| off_level(&interval, l.z) <= limit).collect();
    let interval = Interval { step, base: short_base(&near, step), rounding: 0.0 };
    // What is off the levels of a whole number of units is not rounded, but wrong.
    if is_whole(step, unit) {
        return Some(interval);
    }
    let off = levels.iter().map(|l| off_level(&interval, l.z)).filter(|off| *off <= limit).fold(0.0, f64::max);
    Some(Interval { rounding: off * step, ..interval })
}

/// How far `z` is from the nearest level of the interval, as a share of the step.
fn off_level(interval: &Interval, z: f64) -> f64 {
    let k = (z - interval.base) / interval.step;
    (k - k.round()).abs()
}

/// The remainder on division by the step that has the largest weight, within a window of this share of the step.
fn heaviest_base(levels: &[Weighted], step: f64, window: f64) -> Option<f64> {
    let mut remainders: Vec<(f64, f64)> = levels.iter().map(|l| ((l.z / step).rem_euclid(1.0), l.weight)).collect();
    remainders.retain(|(r, _)| r.is_finite());
    remainders.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.total_cmp(&b.1)));
    // Remainders lie on a circle. They are appended once more, so that a window can run across its start.
    let n = remainders.len();
    let at = |i: usize| if i < n { remainders[i] } else { (remainders[i - n].0 + 1.0, remainders[i - n].1) };
    let (mut best, mut sum, mut end) = (None, 0.0, 0);
    for start in 0..n {
        while end < start + n && at(end).0 - at(start).0 <= window {
            sum += at(end).1;
            end += 1;
        }
        if best.is_none_or(|(most, _, _)| sum > most) {
            best = Some((sum, start, end));
        }
        sum -= at(start).1;
    }
    best.map(|(_, start, end)| 0.5 * (at(start).0 + at(end - 1).0) * step)
}

/// The straight line through (k, z), and three standard errors of its slope.
///
/// Least squares over the levels that fit. Medians find these levels first. Otherwise a wrong label far away that
/// happens to lie near a level of the step would tilt the line.
fn straight_line<'a>(levels: impl Iterator<Item = &'a Weighted>, guess: &Interval) -> Option<(Interval, f64)> {
    let mut pairs: Vec<(f64, f64)> =
        levels.map(|l| (((l.z - guess.base) / guess.step).round(), l.z - guess.base)).collect();
    let half = pairs.len() / 2;
    let slopes = pairs.iter().zip(&pairs[half..]).filter(|(a, b)| a.0 != b.0).map(|(a, b)| (b.1 - a.1) / (b.0 - a.0));
    let slope = median(slopes.collect())?;
    let offset = median(pairs.iter().map(|p| p.1 - slope * p.0).collect())?;
    let off = |p: &(f64, f64)| (p.1 - offset - slope * p.0).abs();
    let limit = 4.0 * median(pairs.iter().map(off).collect())? + 1e-9 * guess.step;
    pairs.retain(|p| off(p) <= limit);
    let n = pairs.len() as f64;
    let (mean_k, mean_z) = (pairs.iter().map(|p| p.0).sum::<f64>() / n, pairs.iter().map(|p| p.1).sum::<f64>() / n);
    let kk: f64 = pairs.iter().map(|p| (p.0 - mean_k).powi(2)).sum();
    let kz: f64 = pairs.iter().map(|p| (p.0 - mean_k) * (p.1 - mean_z)).sum();
    let step = kz / kk;
    if !(step.is_finite() && step > 0.0) {
        return None;
    }
    let residuals: f64 = pairs.iter().map(|p| (p.1 - mean_z - step * (p.0 - mean_k)).powi(2)).sum();
    let error = 3.0 * (residuals / (n - 2.0).max(1.0) / kk).sqrt();
    Some((Interval { step, base: guess.base + mean_z - step * mean_k, rounding: 0.0 }, error))
}

/// The middle value, if there is any.
fn median(mut values: Vec<f64>) -> Option<f64> {
    values.sort_unstable_by(f64::total_cmp);
    values.get(values.len() / 2).copied()
}

/// The number with the fewest decimals within `tolerance`.
fn short_decimal(value: f64, tolerance: f64) -> f64 {
    (-2..=9)
        .map(|decimals| {
            let scale = 10f64.powi(decimals);
            (value * scale).round() / scale
        })
        .find(|short| (short - value).abs() <= tolerance)
        .unwrap_or(value)
}

/// The base, at least 0 and less than the step: the middle one of the levels' remainders.
fn short_base(levels: &[&Weighted], step: f64) -> f64 {
    let Some(first) = levels.first() else { return 0.0 };
    let off = |l: &&Weighted| l.z - first.z - ((l.z - first.z) / step).round() * step;
    let middle = median(levels.iter().map(off).collect()).unwrap_or(0.0);
    let spread = median(levels.iter().map(|l| (off(l) - middle).abs()).collect()).unwrap_or(0.0);
    let tolerance = (2.0 * spread).max(1e-9 * step);
    let base = (first.z + middle).rem_euclid(step);
    if base.min(step - base) <= tolerance { 0.0 } else { short_decimal(base, tolerance) }
}

/// The interval's mark, from 0 to 1.
fn mark(levels: &[Weighted], interval: &Interval, limit: f64) -> f64 {
    let total: f64 = levels.iter().map(|l| l.weight).sum();
    // Of several levels at one level of the interval, only the heaviest is explained. Otherwise a step as large as the
    // map is high would explain them all.
    let mut on: Vec<(f64, f64)> = Vec::new();
    for level in levels.iter().filter(|l| off_level(interval, l.z) <= limit) {
        let k = ((level.z - interval.base) / interval.step).round();
        match on.last_mut() {
            Some(last) if last.0 == k => last.1 = last.1.max(level.weight),
            _ => on.push((k, level.weight)),
        }
    }
    let weight: f64 = on.iter().map(|l| l.1).sum();
    if on.len() < 2 {
        return 0.0;
    }
    // The usual weight of a level: the mean over the vertices, not over the levels.
    let usual = on.iter().map(|l| l.1 * l.1).sum::<f64>() / weight;
    // An empty level counts as much as the lighter level beside it. So empty levels beside one wrong label hardly
    // count.
    let empty = |w: &[(f64, f64)]| (w[1].0 - w[0].0 - 1.0).clamp(0.0, MAX_GAP) * (w[0].1.min(w[1].1) / usual).min(1.0);
    let slots = on.len() as f64 + on.windows(2).map(empty).sum::<f64>();
    let filled = on.iter().map(|l| (l.1 / usual).min(1.0)).sum::<f64>() / slots;
    let explained = weight / total;
    let f = (1.0 + FILLED_WEIGHT) * explained * filled / (FILLED_WEIGHT * explained + filled);
    f * if interval.base == 0.0 { 1.0 } else { OFFSET_MARK } * if is_usual(interval.step) { 1.0 } else { ODD_MARK }
}

/// Whether maps usually have such a step.
fn is_usual(step: f64) -> bool {
    [1.0, FOOT].iter().any(|unit| {
        let steps = step / unit;
        let digits = steps / 10f64.powf((steps * (1.0 + SAME_DIGITS)).log10().floor());
        USUAL_DIGITS.iter().any(|usual| (digits - usual).abs() <= SAME_DIGITS * usual)
    })
}

#[cfg(test)]
mod tests {
    use glam::DVec2;
    use proptest::prelude::*;

    use super::*;

    fn line(elevation: f64, vertices: usize) -> Contour {
        Contour { elevation, points: (0..vertices).map(|i| DVec2::new(i as f64, 0.0)).collect(), feature: 0.into() }
    }

    fn found(levels: &[f64]) -> Option<Interval> {
        find_interval(&levels.iter().map(|&z| line(z, 10)).collect::<Vec<_>>())
    }

    fn interval(step: f64, base: f64) -> Option<Interval> {
        Some(Interval { step, base, rounding: 0.0 })
    }

    #[test]
    fn too_few_levels_have_no_interval() {
        assert_eq!(found(&[]), None);
        assert_eq!(found(&[10.0, 10.0]), None);
        assert_eq!(found(&[f64::NAN, 10.0, f64::INFINITY]), None);
        assert_eq!(found(&[0.3, 0.1 + 0.2]), None);
    }

    #[test]
    fn plain_levels() {
        assert_eq!(found(&[100.0, 110.0]), interval(10.0, 0.0));
        assert_eq!(found(&[-20.0, -10.0, 0.0, 10.0]), interval(10.0, 0.0));
        assert_eq!(found(&[5.0, 15.0, 25.0, 35.0]), interval(10.0, 5.0));
        assert_eq!(found(&[10.0, 20.0, 40.0, 50.0, 80.0]), interval(10.0, 0.0));
        assert_eq!(found(&[0.0, 20.0, 40.0, 50.0, 70.0]), interval(10.0, 0.0));
    }

    #[test]
    fn few_levels_have_a_step_that_maps_are_drawn_with() {
        assert_eq!(found(&[0.0, 10.0, 30.0, 60.0, 90.0, 110.0]), interval(10.0, 0.0));
        assert_eq!(found(&[0.0, 30.0, 60.0, 90.0, 100.0, 130.0]), interval(10.0, 0.0));
        assert_eq!(found(&[0.0, 30.0, 60.0, 90.0, 120.0, 150.0]), interval(30.0, 0.0));
        assert!([0.25, 10.0, 3.048, 12_000.0 / 3937.0, 12.192, 1e-3, 400.0].into_iter().all(is_usual));
        assert!(![30.0, 7.5, 0.3, 15.0, 60.0].into_iter().any(is_usual));
    }

    #[test]
    fn steps_that_are_no_whole_numbers() {
        let times = |step: f64| (1..60).map(|k| k as f64 * step).collect::<Vec<_>>();
        assert_eq!(found(&times(0.1)), interval(0.1, 0.0));
        assert_eq!(found(&times(2.5)), interval(2.5, 0.0));
        assert_eq!(found(&times(3.048)), interval(3.048, 0.0));
        assert_eq!(found(&times(0.25)), interval(0.25, 0.0));
        let survey = 12_000.0 / 3937.0;
        let got = found(&times(survey)).expect("a step");
        assert!((got.step - survey).abs() < 1e-9 && got.base == 0.0, "{got:?}");
    }

    #[test]
    fn feet_rounded_to_centimetres() {
        let rounded: Vec<f64> = (1..400).map(|k| (k as f64 * 304.8).round() / 100.0).collect();
        let got = found(&rounded).unwrap();
        assert_eq!((got.step, got.base), (3.048, 0.0));
        assert!(got.rounding > 0.003 && got.rounding <= 0.005, "{got:?}");
    }

    #[test]
    fn feet_rounded_to_metres_and_metres_rounded_to_feet() {
        let metres = |feet: f64, first: i32, count: i32| {
            (first..first + count).map(|k| (f64::from(k) * feet * FOOT).round()).collect::<Vec<_>>()
        };
        for (feet, first, count) in [(50.0, 5, 28), (50.0, 1, 12), (25.0, 10, 60), (40.0, 3, 30), (100.0, 2, 15)] {
            let got = found(&metres(feet, first, count)).unwrap();
            assert!((got.step - feet * FOOT).abs() < 1e-9 && got.base == 0.0, "{feet} ft: {got:?}");
            assert!(got.rounding > 0.2 && got.rounding <= 0.5 + 1e-9, "{got:?}");
            assert!(metres(feet, first, count).iter().all(|level| got.is_level(*level)));
        }
        let feet = |unit: f64, of: f64| {
            (7..35).map(|k| (f64::from(k) * 10.0 / FOOT / of).round() * of * unit).collect::<Vec<_>>()
        };
        // Whole feet, and thousandths; once as if they were metres.
        for (unit, of) in [(1.0, 1.0), (FOOT, 1.0), (FOOT, 0.001), (FOOT, 0.1)] {
            let got = found(&feet(unit, of)).unwrap();
            let share = got.step / (10.0 / FOOT * unit) - 1.0;
            assert!(share.abs() < 1e-3 && got.base == 0.0, "{unit} {of}: {got:?}");
            assert!(feet(unit, of).iter().all(|level| got.is_level(*level)), "{unit} {of}: {got:?}");
        }
    }

    #[test]
    fn levels_of_a_whole_number_of_units_are_not_rounded() {
        let mut levels: Vec<f64> = (10..40).map(|k| k as f64 * 10.0).collect();
        levels.push(200.1);
        assert_eq!(found(&levels), interval(10.0, 0.0));
    }

    #[test]
    fn auxiliary_contours_in_places() {
        let mut lines: Vec<Contour> = (10..40).map(|k| line(k as f64 * 10.0, 500)).collect();
        lines.extend([105.0, 115.0, 205.0, 207.5].map(|z| line(z, 30)));
        assert_eq!(find_interval(&lines), interval(10.0, 0.0));
        // At every level, but short.
        lines.extend((10..40).map(|k| line(k as f64 * 10.0 + 5.0, 60)));
        assert_eq!(find_interval(&lines), interval(10.0, 0.0));
    }

    #[test]
    fn wrong_labels() {
        let mut levels: Vec<f64> = (10..40).map(|k| k as f64 * 10.0).collect();
        levels.extend([13.0, 1300.0, 99_999.0, -32_768.0]);
        assert_eq!(found(&levels), interval(10.0, 0.0));
    }

    #[test]
    fn elevations_without_a_step_cost_little() {
        let mut z = 0.0f64;
        let levels: Vec<f64> = (0..20_000u32)
            .map(|i| {
                z = (z * 1.37 + f64::from(i) * 0.618_033_988).rem_euclid(977.0);
                z
            })
            .collect();
        assert!(found(&levels).is_some_and(|i| i.step > 0.0));
        assert!(found(&[1e-300, 2e-300, f64::MAX, f64::MIN]).is_none_or(|i| i.step > 0.0));
    }

    proptest! {
        #![proptest_config(crate::draws::draws())]

        #[test]
        fn subsets_have_the_step_of_the_whole(
            step in prop::sample::select(vec![0.1, 0.5, 1.0, 2.0, 2.5, 5.0, 10.0, 20.0, 25.0, 50.0, 100.0, 3.048, 12.192]),
            shift in prop::sample::select(vec![0.0, 0.0, 0.5]),
            first in -200i64..400,
            rows in prop::collection::vec((0u32..100, 50usize..200, 0u32..100), 12..60),
            wrong in prop::collection::vec(-500.0..3000.0f64, 0..2),
        ) {
            let truth = Interval { step, base: step * shift, rounding: 0.0 };
            let mut lines = Vec::new();
            for (k, &(missing, vertices, auxiliary)) in rows.iter().enumerate() {
                let z = truth.base + (first + k as i64) as f64 * step;
                if missing >= 10 {
                    lines.push(line(z, vertices));
                }
                if auxiliary < 5 {
                    lines.push(line(z + 0.5 * step, 5));
                }
            }
            let (main, auxiliary) = (
                lines.iter().filter(|l| l.points.len() > 5).count(),
                lines.iter().filter(|l| l.points.len() == 5).count(),
            );
            prop_assume!(main * 10 >= rows.len() * 8 && auxiliary * 5 <= main);
            lines.extend(wrong.iter().map(|&z| line(z, 20)));
            let got = find_interval(&lines).expect("levels enough");
            prop_assert!((got.step - step).abs() <= 1e-9 * step, "{got:?} for {truth:?}");
            prop_assert!((got.base - truth.base).abs() <= 1e-9 * step, "{got:?} for {truth:?}");
        }
    }
}
