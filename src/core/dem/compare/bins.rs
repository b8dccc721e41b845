//! Counts of differences in narrow bins, and which bins hold a quantile. So quantiles are exact, although the differences are
//! never in memory all at once.
//!
//! A first pass over the rasters counts. The counts tell which few bins hold the values that a quantile lies between. A second
//! pass collects the differences in these bins, and [`Part::quantile`] sorts them.

use std::ops::Range;

/// Bits of the mantissa that are dropped. A bin is as wide as a 2048th of its values or narrower.
const DROPPED: u32 = 12;
/// Bins for each power of two.
const PER_POWER: u32 = 1 << (23 - DROPPED);
/// The powers of two between which bins are narrow, as single precision stores them. Smaller and larger values share a bin.
const POWERS: Range<u32> = 127 - 14..127 + 18;
/// Number of bins on one side of zero.
const SIDE: usize = (PER_POWER * (POWERS.end - POWERS.start)) as usize;
/// Number of all bins.
const COUNT: usize = 2 * SIDE;
/// Steps of a bisection. It only has to end: every end gives the right result.
const STEPS: usize = 64;

/// The bin of a difference. Bins are in the order of the differences.
pub(super) fn bin(difference: f64) -> usize {
    let single = difference as f32;
    let size = single.abs().to_bits() >> DROPPED;
    let k = size.clamp(POWERS.start * PER_POWER, POWERS.end * PER_POWER - 1) - POWERS.start * PER_POWER;
    if single < 0.0 { SIDE - 1 - k as usize } else { SIDE + k as usize }
}

/// Sizes that those of a bin on one side of zero lie between. They may reach a little into the bins beside it.
fn sizes(k: usize) -> (f64, f64) {
    let edge = |k: usize| (POWERS.start * PER_POWER + k as u32) << DROPPED;
    // Rounding to single precision may have moved a value across an edge.
    let low = if k == 0 { -f64::from(f32::MIN_POSITIVE) } else { f64::from(f32::from_bits(edge(k) - 1)) };
    let high = if k + 1 == SIDE { f64::INFINITY } else { f64::from(f32::from_bits(edge(k + 1))) };
    (low, high)
}

/// The smallest and the largest difference that a bin may hold.
fn bounds(bin: usize) -> (f64, f64) {
    if bin >= SIDE {
        return sizes(bin - SIDE);
    }
    let (low, high) = sizes(SIDE - 1 - bin);
    (-high, -low)
}

/// Counts of differences in bins. A raster has fewer cells than 32 bits can count.
#[derive(Debug)]
pub(super) struct Counts(Vec<u32>);

impl Counts {
    pub fn new() -> Self {
        Self(vec![0; COUNT])
    }

    pub fn add(&mut self, difference: f64) {
        self.0[bin(difference)] += 1;
    }

    /// The ranks of the differences, all of which are from `lowest` to `highest`.
    pub fn ranks(&self, (lowest, highest): (f64, f64)) -> Ranks {
        let mut sum = 0;
        let before = self.0.iter().map(|&count| {
            sum += u64::from(count);
            sum - u64::from(count)
        });
        let mut below: Vec<u64> = before.collect();
        below.push(sum);
        Ranks { below, lowest, highest }
    }
}

/// Which bins hold the differences of a rank.
#[derive(Debug)]
pub(super) struct Ranks {
    /// The number of differences below each bin, and at the end that of all.
    below: Vec<u64>,
    lowest: f64,
    highest: f64,
}

/// The differences that must be known for a quantile: those in some bins.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Part {
    /// The bins, one range or two.
    pub bins: Vec<Range<usize>>,
    /// Number of values that are below all of these.
    below: u64,
    /// Rank of the quantile among all values, counted from 0, with a fraction.
    rank: f64,
}

impl Ranks {
    fn total(&self) -> u64 {
        self.below[COUNT]
    }

    fn rank(&self, share: f64) -> f64 {
        share * (self.total() - 1) as f64
    }

    fn in_bins(&self, bins: &Range<usize>) -> u64 {
        if bins.is_empty() { 0 } else { self.below[bins.end] - self.below[bins.start] }
    }

    /// The part that decides a quantile of the differences.
    pub fn quantile(&self, share: f64) -> Part {
        let rank = self.rank(share);
        let bin_of = |rank: u64| self.below.partition_point(|&sum| sum <= rank).max(1) - 1;
        let first = bin_of(rank.floor() as u64);
        let last = bin_of((rank.floor() as u64 + 1).min(self.total() - 1));
        Part { bins: std::iter::once(first..last + 1).collect(), below: self.below[first], rank }
    }

    /// The part that decides a quantile of the distances from a centre, which is somewhere between two numbers.
    pub fn quantile_around(&self, (from, to): (f64, f64), share: f64) -> Part {
        let rank = self.rank(share);
        let known = rank.floor() as u64;
        let needed = (known + 2).min(self.total());
        // No value at `known` or above is nearer than `near`, and none at `needed` − 1 or below is farther than `far`.
        let may_be_within = |r: f64| self.in_bins(&self.touching(from - r, to + r));
        let are_within = |r: f64| self.in_bins(&self.inside(to - r, from + r));
        let (mut near, mut far) = (None, (self.highest - from).max(to - self.lowest).max(0.0));
        let (mut low, mut high) = (0.0, far);
        for _ in 0..STEPS {
            let middle = (low + high) / 2.0;
            if may_be_within(middle) <= known {
                (near, low) = (Some(middle), middle);
            } else {
                high = middle;
            }
        }
        let mut low = 0.0;
        for _ in 0..STEPS {
            let middle = (low + far) / 2.0;
            if are_within(middle) >= needed { far = middle } else { low = middle }
        }
        if let Some(near) = near {
            let (left, right) = (self.touching(from - far, to - near), self.touching(from + near, to + far));
            if left.end <= right.start {
                let below = self.in_bins(&(left.end..right.start));
                return Part { bins: vec![left, right], below, rank };
            }
        }
        Part { bins: vec![self.touching(from - far, to + far)], below: 0, rank }
    }

    /// Two numbers that the quantile of a part lies between.
    pub fn around(&self, part: &Part) -> (f64, f64) {
        let ends = part.bins.iter().flat_map(|bins| [bins.start, bins.end - 1]).map(|bin| self.bounds(bin));
        ends.fold((f64::INFINITY, f64::NEG_INFINITY), |all, one| (all.0.min(one.0), all.1.max(one.1)))
    }

    fn bounds(&self, bin: usize) -> (f64, f64) {
        let (low, high) = bounds(bin);
        (low.max(self.lowest), high.min(self.highest))
    }

    /// The bins that may hold a difference from `low` to `high`.
    fn touching(&self, low: f64, high: f64) -> Range<usize> {
        let start = first(|bin| self.bounds(bin).1 >= low);
        start..first(|bin| self.bounds(bin).0 > high).max(start)
    }

    /// The bins that hold no other differences than those from `low` to `high`.
    fn inside(&self, low: f64, high: f64) -> Range<usize> {
        let start = first(|bin| self.bounds(bin).0 >= low);
        start..first(|bin| self.bounds(bin).1 > high).max(start)
    }
}

/// The first bin for which `is_so` holds, as it does for all bins after it.
fn first(is_so: impl Fn(usize) -> bool) -> usize {
    let (mut low, mut high) = (0, COUNT);
    while low < high {
        let middle = (low + high) / 2;
        if is_so(middle) { high = middle } else { low = middle + 1 }
    }
    low
}

impl Part {
    /// The quantile of `value` of all differences. `collected` are the differences in its bins, each with its number.
    pub fn quantile(&self, collected: &[(f64, u64)], value: impl Fn(f64) -> f64) -> f64 {
        let is_mine = |d: f64| self.bins.iter().any(|bins| bins.contains(&bin(d)));
        let mine = collected.iter().filter(|(d, _)| is_mine(*d));
        let mut values: Vec<(f64, u64)> = mine.map(|&(d, count)| (value(d), count)).collect();
        values.sort_unstable_by(|a, b| a.0.total_cmp(&b.0));
        let at = |rank: u64| {
            let mut sum = self.below;
            let found = values.iter().find(|(_, count)| {
                sum += count;
                sum > rank
            });
            found.map(|(value, _)| *value)
        };
        let below = self.rank.floor() as u64;
        match (at(below), at(below + 1)) {
            (Some(value), Some(next)) => value + (self.rank - self.rank.floor()) * (next - value),
            (value, _) => value.unwrap_or(f64::NAN),
        }
    }
}

/// Differences that were collected, equal ones together. So many equal differences take little memory.
#[derive(Debug, Default)]
pub(super) struct Collected {
    loose: Vec<f64>,
    counted: Vec<(f64, u64)>,
}

impl Collected {
    /// Number of differences that are counted together at the least.
    const FEWEST: usize = 1 << 12;

    pub fn add(&mut self, difference: f64) {
        self.loose.push(difference);
        if self.loose.len() >= Self::FEWEST.max(self.counted.len()) {
            self.count();
        }
    }

    /// The differences and the number of each.
    pub fn counts(&mut self) -> &[(f64, u64)] {
        self.count();
        &self.counted
    }

    fn count(&mut self) {
        self.counted.extend(self.loose.drain(..).map(|d| (d, 1)));
        self.counted.sort_unstable_by(|a, b| a.0.total_cmp(&b.0));
        self.counted.dedup_by(|next, kept| {
            let is_equal = next.0.to_bits() == kept.0.to_bits();
            if is_equal {
                kept.1 += next.1;
            }
            is_equal
        });
    }
}

#[cfg(test)]
mod tests {
    use super::super::statistics::quantile;
    use super::*;

    /// The quantiles of differences by bins: the median, the median distance from it, and two of the sizes.
    fn by_bins(values: &[f64]) -> [f64; 4] {
        let mut counts = Counts::new();
        values.iter().for_each(|v| counts.add(*v));
        let lowest = values.iter().copied().fold(f64::INFINITY, f64::min);
        let highest = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let ranks = counts.ranks((lowest, highest));
        let median = ranks.quantile(0.5);
        let around = ranks.around(&median);
        let parts = [
            median,
            ranks.quantile_around(around, 0.5),
            ranks.quantile_around((0.0, 0.0), 0.9),
            ranks.quantile_around((0.0, 0.0), 0.95),
        ];
        let mut collected = Collected::default();
        let is_wanted = |d: f64| parts.iter().flat_map(|part| &part.bins).any(|bins| bins.contains(&bin(d)));
        values.iter().filter(|d| is_wanted(**d)).for_each(|d| collected.add(*d));
        let collected = collected.counts();
        let median = parts[0].quantile(collected, |d| d);
        [
            median,
            parts[1].quantile(collected, |d| (d - median).abs()),
            parts[2].quantile(collected, f64::abs),
            parts[3].quantile(collected, f64::abs),
        ]
    }

    /// The same by sorting.
    fn by_sorting(values: &[f64]) -> [f64; 4] {
        let median = quantile(&mut values.to_vec(), 0.5);
        let of = |value: &dyn Fn(f64) -> f64, share| {
            quantile(&mut values.iter().map(|d| value(*d)).collect::<Vec<_>>(), share)
        };
        [median, of(&|d| (d - median).abs(), 0.5), of(&f64::abs, 0.9), of(&f64::abs, 0.95)]
    }

    #[test]
    fn bins_are_in_order_and_hold_what_they_say() {
        let mut last = 0;
        for d in [-1e9, -3.5, -3.4999, -1.0, -1e-3, -1e-20, 0.0, 1e-20, 1e-4, 0.1, 1.0, 1.0 + 1e-9, 1.001, 4e4, 1e300] {
            let k = bin(d);
            assert!(k >= last && bounds(k).0 <= d && d <= bounds(k).1, "{d} {k} {:?}", bounds(k));
            last = k;
        }
    }

    #[test]
    fn quantiles_are_those_of_sorted_values() {
        let noise = |k: u32, scale: f64| {
            let at = f64::from(k) * 12.9898;
            ((at.sin() * 43_758.545).fract() + (at.cos() * 9731.17).fract()) * scale
        };
        let sets: [Vec<f64>; 9] = [
            vec![3.0],
            vec![0.0; 50],
            vec![1.0, 2.0],
            vec![-5.0, 7.0, 7.0],
            (0..10_000).map(|k| noise(k, 1.0) - 0.2).collect(),
            (0..10_001).map(|k| noise(k, 40.0).round()).collect(),
            (0..5000).map(|k| noise(k, 1e-7)).collect(),
            (0..5000).map(|k| noise(k, 1e7) + 3e6).collect(),
            (0..999).map(|k| if k % 3 == 0 { -100.0 } else { noise(k, 0.01) + 100.0 }).collect(),
        ];
        for values in sets {
            assert_eq!(by_bins(&values), by_sorting(&values), "{:?}", &values[..values.len().min(5)]);
        }
    }

    #[test]
    fn few_differences_are_collected() {
        let mut counts = Counts::new();
        (0..100_000).for_each(|k| counts.add(f64::from(k) * 1e-5));
        let ranks = counts.ranks((0.0, 1.0));
        let part = ranks.quantile_around((0.0, 0.0), 0.9);
        assert!(part.bins.iter().map(|bins| ranks.in_bins(bins)).sum::<u64>() < 1000);
    }
}
