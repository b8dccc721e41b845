//! Terraces: whether heights crowd at the levels of contours. A height map made from contours often has terraces at the
//! levels. Natural ground has none there.
//!
//! The height modulo the contour interval is counted in [`BINS`] bins. The two bins at the level cover a tenth of the
//! interval. Their count is compared with that of the two pairs of bins beside them. Over so short a range, heights of
//! the ground are evenly spread, whatever the terrain. Flat triangles between contour vertices of one level put many
//! heights on this level.
//!
//! A lake, a plain or the sea also puts many heights on one level. Terraces occur at the majority of the levels. So the
//! levels vote.

use serde::Serialize;

use super::Precision;
use crate::contour::Interval;

/// Bins of the height modulo the interval.
pub const BINS: usize = 20;
/// A level is terraced if there are this many times more heights near it than expected. On measured ground no level is.
/// On linear triangulations of its contours most levels are, on smooth surfaces few.
const EXCESS: f64 = 1.4;
/// Share of the levels that must be terraced before a height map is said to have terraces. Linear triangulations reach
/// a half where part of the ground is steep, smooth surfaces a fifth.
const MANY_LEVELS: f64 = 1.0 / 3.0;
/// Least number of heights near a level or beside it. With fewer, the level does not vote.
const FEWEST_HEIGHTS: u64 = 100;
/// Least number of levels that vote.
const FEWEST_LEVELS: usize = 3;
/// Largest number of levels between the lowest and the highest height. With more, the interval is not used.
const MOST_INTERVALS: f64 = 1e6;
/// Contour intervals that are tried if none is known, metres: those usual on maps, the smallest first. Beside each, which of
/// [`FINE`] divides it, and how often.
const USUAL: [(f64, usize, i64); 12] = [
    (1.0, 0, 2),
    (2.0, 0, 4),
    (2.5, 0, 5),
    (3.048, 1, 1),
    (5.0, 0, 10),
    (6.096, 1, 2),
    (10.0, 0, 20),
    (12.192, 1, 4),
    (20.0, 0, 40),
    (25.0, 0, 50),
    (50.0, 0, 100),
    (100.0, 0, 200),
];
/// Intervals whose counts give those of all usual ones, metres. So heights are counted twice and not twelve times.
const FINE: [f64; 2] = [0.5, 3.048];

/// Heights modulo the contour interval.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct LevelHistogram {
    /// Contour interval, metres.
    pub interval: f64,
    /// Height of one of the levels, metres.
    pub base: f64,
    /// Share of the heights in each of [`BINS`] bins; the first begins at the level.
    pub shares: Vec<f64>,
    /// Share of the heights that are less than 5 % of the interval from a level: the first and the last bin.
    pub near: f64,
    /// Expected share: half of the share of the next two bins on each side.
    pub expected: f64,
    /// Number of levels that have enough heights near them.
    pub levels: usize,
    /// Number of these levels with at least 1.4 times as many heights near them as expected.
    pub terraced_levels: usize,
    /// Whether the height map has terraces: at least a third of the even-numbered levels and of the odd-numbered ones
    /// are terraced, and more heights than expected are near all levels together. `None` if there are fewer than three levels, or if heights are so coarse that rounding puts them
    /// on levels.
    pub terraced: Option<bool>,
}

/// Counts heights modulo an interval. `None` if there are no heights, or if the interval is too small for them.
pub fn level_histogram(heights: &[f32], interval: &Interval, precision: Option<Precision>) -> Option<LevelHistogram> {
    let mut counts = LevelCounts::new(range(heights), Some(interval), precision);
    counts.add(heights);
    counts.histogram()
}

/// The lowest and the highest height. The first is larger than the second if there is none.
pub(super) fn range(heights: &[f32]) -> (f32, f32) {
    let finite = heights.iter().filter(|h| h.is_finite());
    finite.fold((f32::INFINITY, f32::NEG_INFINITY), |(low, high), &h| (low.min(h), high.max(h)))
}

/// Counts heights modulo an interval, or modulo all usual ones.
#[derive(Debug)]
pub(super) struct LevelCounts {
    precision: Option<Precision>,
    interval: Option<Interval>,
    fine: Vec<Counts>,
}

impl LevelCounts {
    /// Counts of heights in a range. Usual intervals are tried if none is given.
    pub fn new(range: (f32, f32), interval: Option<&Interval>, precision: Option<Precision>) -> Self {
        let tried = FINE.map(|step| Interval { step, base: 0.0, rounding: 0.0 });
        let fine = interval.map_or(tried.as_slice(), std::slice::from_ref);
        let fine = fine.iter().filter_map(|interval| Counts::new(range, *interval, precision)).collect();
        Self { precision, interval: interval.copied(), fine }
    }

    /// Counts heights, which are in the range.
    pub fn add(&mut self, heights: &[f32]) {
        let precision = self.precision;
        self.fine.iter_mut().for_each(|counts| counts.add(heights, precision));
    }

    /// The heights modulo the given interval. Without one, modulo the smallest usual interval at whose levels there are terraces.
    ///
    /// At half the true interval, only every second level has terraces. At twice the true interval, all levels have. So the
    /// smallest interval that passes is the true one.
    pub fn histogram(&self) -> Option<LevelHistogram> {
        if let Some(interval) = &self.interval {
            return self.fine.first()?.histogram(1, interval, self.precision);
        }
        USUAL.iter().find_map(|&(step, fine, times)| {
            let found =
                self.fine.get(fine)?.histogram(times, &Interval { step, base: 0.0, rounding: 0.0 }, self.precision);
            found.filter(|h| h.terraced == Some(true))
        })
    }
}

/// Counts of heights in bins, from the lowest height to the highest.
#[derive(Debug)]
struct Counts {
    interval: Interval,
    /// The number of the first bin; bin 0 begins at the base of the interval.
    first: i64,
    counts: Vec<u32>,
}

impl Counts {
    fn new((lowest, highest): (f32, f32), interval: Interval, precision: Option<Precision>) -> Option<Self> {
        let count = f64::from(highest - lowest) / interval.step;
        // The condition is also false for NaN, when there are no heights.
        if !(interval.step > 0.0 && (0.0..MOST_INTERVALS).contains(&count)) {
            return None;
        }
        let [first, last] = [lowest, highest].map(|height| bin(height, &interval, precision));
        Some(Self { interval, first, counts: vec![0; (last - first + 1) as usize] })
    }

    fn add(&mut self, heights: &[f32], precision: Option<Precision>) {
        for &height in heights.iter().filter(|h| h.is_finite()) {
            // A file that is changed between two passes may hold heights beyond the range.
            let place = usize::try_from(bin(height, &self.interval, precision) - self.first);
            if let Some(count) = place.ok().and_then(|place| self.counts.get_mut(place)) {
                *count += 1;
            }
        }
    }

    /// The histogram for an interval that is `times` as long.
    fn histogram(&self, times: i64, interval: &Interval, precision: Option<Precision>) -> Option<LevelHistogram> {
        let mut bins = [0u64; BINS];
        let mut votes = Votes::default();
        let mut level = (i64::MIN, [0u64; BINS]);
        for (fine, &count) in (self.first..).zip(&self.counts).filter(|(_, count)| **count > 0) {
            let bin = fine.div_euclid(times);
            // Half of the bins of a level are below it.
            let number = (bin + BINS as i64 / 2).div_euclid(BINS as i64);
            if number != level.0 {
                votes.add(level.0, &level.1);
                level = (number, [0; BINS]);
            }
            let bin = bin.rem_euclid(BINS as i64) as usize;
            level.1[bin] += u64::from(count);
            bins[bin] += u64::from(count);
        }
        votes.add(level.0, &level.1);
        let total: u64 = bins.iter().sum();
        let (near, beside) = near_and_beside(&bins);
        Some(LevelHistogram {
            interval: interval.step,
            base: interval.base,
            shares: bins.iter().map(|&n| n as f64 / total as f64).collect(),
            near: near as f64 / total as f64,
            expected: beside as f64 / 2.0 / total as f64,
            levels: votes.levels.iter().sum(),
            terraced_levels: votes.terraced.iter().sum(),
            terraced: votes.are_many(interval, precision).map(|are_many| are_many && 2 * near > beside),
        })
    }
}

/// The bin of a height.
fn bin(height: f32, interval: &Interval, precision: Option<Precision>) -> i64 {
    let height = precision.map_or(f64::from(height), |p| p.decimal(height));
    let place = BINS as f64 * (height - interval.base) / interval.step;
    // As `floor`, which is a call of a function on most processors.
    let whole = place as i64;
    whole - i64::from(whole as f64 > place)
}

/// Counts of levels by parity: those with enough heights, and those of them with terraces.
#[derive(Default)]
struct Votes {
    levels: [usize; 2],
    terraced: [usize; 2],
}

impl Votes {
    fn add(&mut self, level: i64, bins: &[u64; BINS]) {
        let (near, beside) = near_and_beside(bins);
        if near + beside >= FEWEST_HEIGHTS {
            let parity = level.rem_euclid(2) as usize;
            self.levels[parity] += 1;
            self.terraced[parity] += usize::from(near as f64 >= EXCESS * beside as f64 / 2.0);
        }
    }

    /// Whether many levels have terraces, if that can be told.
    fn are_many(&self, interval: &Interval, precision: Option<Precision>) -> Option<bool> {
        let too_coarse = precision.is_some_and(|p| !divides(p.step(), interval.step / 10.0));
        let can_tell = self.levels.iter().sum::<usize>() >= FEWEST_LEVELS && !too_coarse;
        // At half the true interval every second level has terraces and the others have none, or hardly any heights.
        let share = |parity: usize| {
            let [terraced, all] = [self.terraced[parity], self.levels[parity]];
            all > 0 && terraced as f64 >= MANY_LEVELS * all as f64
        };
        can_tell.then(|| (0..2).all(share))
    }
}

/// Whether a range is a whole number of steps. Only then do ranges of this size hold equally many heights.
fn divides(step: f64, range: f64) -> bool {
    let count = (range / step).round();
    count >= 1.0 && (range / step - count).abs() < 1e-6
}

/// Number of heights within 5 % of the interval from the level, and from 5 % to 15 % on both sides.
fn near_and_beside(bins: &[u64; BINS]) -> (u64, u64) {
    (bins[0] + bins[BINS - 1], bins[1] + bins[2] + bins[BINS - 2] + bins[BINS - 3])
}

/// The smallest usual contour interval at whose levels the heights have terraces, if there is one.
pub fn find_terraces(heights: &[f32], precision: Option<Precision>) -> Option<LevelHistogram> {
    let mut counts = LevelCounts::new(range(heights), None, precision);
    counts.add(heights);
    counts.histogram()
}

#[cfg(test)]
mod tests {
    use super::*;

    const TEN: Interval = Interval { step: 10.0, base: 0.0, rounding: 0.0 };

    /// Heights 0 to 100 in even steps; `pull` of those within 2 m of a level are on it.
    fn slope(pull: f64) -> Vec<f32> {
        let height = |i: u32| {
            let h = f64::from(i) / 1000.0;
            let level = (h / 10.0).round() * 10.0;
            let moved = (h - level).abs() < 2.0 && f64::from(i % 100) < 100.0 * pull;
            (if moved { level } else { h }) as f32
        };
        (0..100_000).map(height).collect()
    }

    #[test]
    fn even_heights_fill_all_bins_alike() {
        let h = level_histogram(&slope(0.0), &TEN, None).unwrap();
        assert!(h.shares.iter().all(|s| (s - 0.05).abs() < 1e-3), "{h:?}");
        assert!((h.near - 0.1).abs() < 1e-3 && (h.expected - 0.1).abs() < 1e-3);
        assert_eq!((h.terraced, h.terraced_levels), (Some(false), 0));
        assert_eq!(find_terraces(&slope(0.0), None), None);
    }

    #[test]
    fn terraces_are_seen_and_their_interval_found() {
        let h = level_histogram(&slope(0.5), &TEN, None).unwrap();
        assert_eq!(h.terraced, Some(true), "{h:?}");
        assert_eq!(find_terraces(&slope(0.5), None).map(|h| h.interval), Some(10.0));
    }

    #[test]
    fn levels_without_heights_do_not_vote_for_a_smaller_interval() {
        let height = |i: u32| {
            let h = f64::from(i) / 10.0;
            let level = (h / 20.0).round() * 20.0;
            (if (h - level).abs() < 8.0 { level } else { h }) as f32
        };
        let heights: Vec<f32> = (0..2000).map(height).collect();
        assert_eq!(find_terraces(&heights, None).map(|h| h.interval), Some(20.0));
    }

    #[test]
    fn a_lake_is_no_terrace() {
        let mut heights = slope(0.0);
        heights.extend([50.0; 50_000]);
        let h = level_histogram(&heights, &TEN, None).unwrap();
        assert!(h.near > 3.0 * h.expected);
        assert_eq!((h.terraced, h.terraced_levels), (Some(false), 1));
    }

    #[test]
    fn regular_steps_between_levels_are_no_terraces() {
        // Half metres, of which about as many are near multiples of 10 feet as elsewhere.
        let plane: Vec<f32> = (0..40_000).map(|i| 1.25 + 0.5 * (i % 200) as f32).collect();
        let feet = Interval { step: 3.048, base: 0.0, rounding: 0.0 };
        let h = level_histogram(&plane, &feet, None).unwrap();
        assert!(h.near <= h.expected && h.terraced_levels > h.levels / 3, "{h:?}");
        assert_eq!(h.terraced, Some(false));
    }

    #[test]
    fn whole_metres_are_no_terraces() {
        let whole: Vec<f32> = slope(0.0).iter().map(|h| h.round()).collect();
        assert_eq!(level_histogram(&whole, &TEN, Some(Precision::WholeMetres)).unwrap().terraced, Some(false));
        let five = Interval { step: 5.0, base: 0.0, rounding: 0.0 };
        assert_eq!(level_histogram(&whole, &five, Some(Precision::WholeMetres)).unwrap().terraced, None);
        assert_eq!(find_terraces(&whole, Some(Precision::WholeMetres)), None);
    }

    #[test]
    fn nothing_comes_of_nothing() {
        assert_eq!(level_histogram(&[], &TEN, None), None);
        assert_eq!(level_histogram(&[f32::NAN], &TEN, None), None);
        assert_eq!(level_histogram(&[0.0, 1e9], &Interval { step: 1e-9, base: 0.0, rounding: 0.0 }, None), None);
        assert_eq!(level_histogram(&[0.0, 1.0], &Interval { step: 0.0, base: 0.0, rounding: 0.0 }, None), None);
        assert_eq!(level_histogram(&[0.0, f32::MAX], &TEN, None), None);
        assert_eq!(level_histogram(&[5.0], &TEN, None).unwrap().terraced, None);
    }

    #[test]
    fn fine_counts_are_those_of_each_usual_interval() {
        let height = |k: u32| ((f64::from(k) * 12.9898).sin() * 43_758.545).fract() * 900.0;
        for precision in [None, Some(Precision::WholeMetres), Some(Precision::Tenths)] {
            let step = precision.map_or(1e-3, Precision::step);
            let heights: Vec<f32> = (0..60_000).map(|k| ((height(k) / step).round() * step) as f32).collect();
            let mut all = LevelCounts::new(range(&heights), None, precision);
            all.add(&heights);
            for (step, fine, times) in USUAL {
                let interval = Interval { step, base: 0.0, rounding: 0.0 };
                let found = all.fine[fine].histogram(times, &interval, precision);
                assert_eq!(found, level_histogram(&heights, &interval, precision), "{step} {precision:?}");
            }
        }
    }
}
