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

use std::collections::BTreeMap;

use rayon::prelude::*;
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
/// Contour intervals that are tried if none is known, metres: those usual on maps, the smallest first.
const USUAL: [f64; 12] = [1.0, 2.0, 2.5, 3.048, 5.0, 6.096, 10.0, 12.192, 20.0, 25.0, 50.0, 100.0];

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
    /// are terraced. `None` if there are fewer than three levels, or if heights are so coarse that rounding puts them
    /// on levels.
    pub terraced: Option<bool>,
}

/// Counts heights modulo an interval. `None` if there are no heights, or if the interval is too small for them.
pub fn level_histogram(heights: &[f32], interval: &Interval, precision: Option<Precision>) -> Option<LevelHistogram> {
    let (lowest, highest) = heights
        .par_iter()
        .filter(|h| h.is_finite())
        .map(|&h| (h, h))
        .reduce(|| (f32::INFINITY, f32::NEG_INFINITY), |a, b| (a.0.min(b.0), a.1.max(b.1)));
    let count = f64::from(highest - lowest) / interval.step;
    // The condition is also false for NaN, when there are no heights.
    if !(interval.step > 0.0 && (0.0..MOST_INTERVALS).contains(&count)) {
        return None;
    }
    let tally = |mut levels: BTreeMap<i64, [u64; BINS]>, height: &f32| {
        if height.is_finite() {
            let height = precision.map_or(f64::from(*height), |p| p.decimal(*height));
            let bin = (BINS as f64 * (height - interval.base) / interval.step).floor() as i64;
            // Half of the bins of a level are below it.
            let level = (bin + BINS as i64 / 2).div_euclid(BINS as i64);
            levels.entry(level).or_insert([0; BINS])[bin.rem_euclid(BINS as i64) as usize] += 1;
        }
        levels
    };
    let merge = |mut a: BTreeMap<i64, [u64; BINS]>, b: BTreeMap<i64, [u64; BINS]>| {
        for (level, bins) in b {
            a.entry(level).or_insert([0; BINS]).iter_mut().zip(bins).for_each(|(a, b)| *a += b);
        }
        a
    };
    let by_level = heights.par_iter().fold(BTreeMap::new, tally).reduce(BTreeMap::new, merge);

    let mut bins = [0u64; BINS];
    by_level.values().for_each(|level| bins.iter_mut().zip(level).for_each(|(sum, n)| *sum += n));
    let total: u64 = bins.iter().sum();
    // Counts by parity of the level: levels with enough heights, and those of them with terraces.
    let (mut levels, mut terraced) = ([0usize; 2], [0usize; 2]);
    for (level, bins) in &by_level {
        let (near, beside) = near_and_beside(bins);
        if near + beside >= FEWEST_HEIGHTS {
            let parity = level.rem_euclid(2) as usize;
            levels[parity] += 1;
            terraced[parity] += usize::from(near as f64 >= EXCESS * beside as f64 / 2.0);
        }
    }
    let (near, beside) = near_and_beside(&bins);
    let too_coarse = precision.is_some_and(|p| !divides(p.step(), interval.step / 10.0));
    let can_tell = levels.iter().sum::<usize>() >= FEWEST_LEVELS && !too_coarse;
    // At half the true interval every second level has terraces and the others have none.
    let are_many = (0..2).all(|parity| terraced[parity] as f64 >= MANY_LEVELS * levels[parity] as f64);
    Some(LevelHistogram {
        interval: interval.step,
        base: interval.base,
        shares: bins.iter().map(|&n| n as f64 / total as f64).collect(),
        near: near as f64 / total as f64,
        expected: beside as f64 / 2.0 / total as f64,
        levels: levels.iter().sum(),
        terraced_levels: terraced.iter().sum(),
        terraced: can_tell.then_some(are_many),
    })
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
///
/// At half the true interval, only every second level has terraces. At twice the true interval, all levels have. So the
/// smallest interval that passes is the true one.
pub fn find_terraces(heights: &[f32], precision: Option<Precision>) -> Option<LevelHistogram> {
    USUAL.iter().find_map(|&step| {
        level_histogram(heights, &Interval { step, base: 0.0 }, precision).filter(|h| h.terraced == Some(true))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    const TEN: Interval = Interval { step: 10.0, base: 0.0 };

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
    fn a_lake_is_no_terrace() {
        let mut heights = slope(0.0);
        heights.extend([50.0; 50_000]);
        let h = level_histogram(&heights, &TEN, None).unwrap();
        assert!(h.near > 3.0 * h.expected);
        assert_eq!((h.terraced, h.terraced_levels), (Some(false), 1));
    }

    #[test]
    fn whole_metres_are_no_terraces() {
        let whole: Vec<f32> = slope(0.0).iter().map(|h| h.round()).collect();
        assert_eq!(level_histogram(&whole, &TEN, Some(Precision::WholeMetres)).unwrap().terraced, Some(false));
        let five = Interval { step: 5.0, base: 0.0 };
        assert_eq!(level_histogram(&whole, &five, Some(Precision::WholeMetres)).unwrap().terraced, None);
        assert_eq!(find_terraces(&whole, Some(Precision::WholeMetres)), None);
    }

    #[test]
    fn nothing_comes_of_nothing() {
        assert_eq!(level_histogram(&[], &TEN, None), None);
        assert_eq!(level_histogram(&[f32::NAN], &TEN, None), None);
        assert_eq!(level_histogram(&[0.0, 1e9], &Interval { step: 1e-9, base: 0.0 }, None), None);
        assert_eq!(level_histogram(&[0.0, 1.0], &Interval { step: 0.0, base: 0.0 }, None), None);
        assert_eq!(level_histogram(&[0.0, f32::MAX], &TEN, None), None);
        assert_eq!(level_histogram(&[5.0], &TEN, None).unwrap().terraced, None);
    }
}
