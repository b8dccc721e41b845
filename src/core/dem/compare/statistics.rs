//! Statistics of a set of differences. Sums are taken over blocks of a fixed size, and then over the blocks in order.
//! So they do not depend on the number of threads. Quantiles are exact.

use glam::DVec2;

use crate::base::{ElevationUnit, parallel};
use serde::Serialize;

/// Number of values per block. The sums of blocks are added up in order.
const BLOCK: usize = 1 << 16;
/// Factor from the median of absolute deviations to the standard deviation of a normal distribution.
pub(super) const NORMAL: f64 = 1.4826;

/// A difference and its position.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Extreme {
    /// The difference, metres.
    pub value: f64,
    /// Its position: x and y in map units.
    pub place: DVec2,
}

/// Statistics of differences d, in metres.
///
/// A quantile lies between the two values that surround it by rank, in proportion (the usual definition, number 7 of
/// Hyndman and Fan 1996).
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Statistics {
    /// Number of differences.
    pub cells: usize,
    /// Mean of d.
    pub bias: f64,
    /// Root of the mean of d².
    pub rmse: f64,
    /// Root of the mean of (d − bias)².
    pub rmse_debiased: f64,
    /// Mean of |d|.
    pub mae: f64,
    /// Median of d.
    pub median: f64,
    /// 1.4826 times the median of |d − median|. For normally distributed differences, it is the standard deviation.
    /// Outliers hardly change it.
    pub nmad: f64,
    /// The 90 % quantile of |d|.
    pub le90: f64,
    /// The 95 % quantile of |d|.
    pub le95: f64,
    /// The smallest difference; of equal ones, the first.
    pub lowest: Extreme,
    /// The largest difference; of equal ones, the first.
    pub highest: Extreme,
}

impl Statistics {
    /// The same of differences in a unit.
    pub fn in_unit(self, unit: ElevationUnit) -> Self {
        let extreme = |extreme: Extreme| Extreme { value: unit.about(extreme.value), ..extreme };
        Self {
            cells: self.cells,
            bias: unit.about(self.bias),
            rmse: unit.about(self.rmse),
            rmse_debiased: unit.about(self.rmse_debiased),
            mae: unit.about(self.mae),
            median: unit.about(self.median),
            nmad: unit.about(self.nmad),
            le90: unit.about(self.le90),
            le95: unit.about(self.le95),
            lowest: extreme(self.lowest),
            highest: extreme(self.highest),
        }
    }
}

/// The statistics of the differences that are finite and whose index `is_member` accepts. `None` if there are none.
pub fn statistics(
    differences: &[f64],
    place: &dyn Fn(usize) -> DVec2,
    is_member: &(dyn Fn(usize) -> bool + Sync),
) -> Option<Statistics> {
    let members: Vec<usize> =
        parallel::flat_map(differences.len(), |i| (differences[i].is_finite() && is_member(i)).then_some(i));
    let by_value = |a: &&usize, b: &&usize| differences[**a].total_cmp(&differences[**b]).then(a.cmp(b));
    let lowest = *members.iter().min_by(by_value)?;
    let first_of_highest = |a: &&usize, b: &&usize| differences[**a].total_cmp(&differences[**b]).then(b.cmp(a));
    let highest = *members.iter().max_by(first_of_highest)?;
    let extreme = |i: usize| Extreme { value: differences[i], place: place(i) };

    let mut values: Vec<f64> = members.iter().map(|&i| differences[i]).collect();
    let count = values.len() as f64;
    let bias = sum(&values, |d| d) / count;
    let rmse = (sum(&values, |d| d * d) / count).sqrt();
    let rmse_debiased = (sum(&values, |d| (d - bias) * (d - bias)) / count).sqrt();
    let mae = sum(&values, f64::abs) / count;
    let median = quantile(&mut values, 0.5);
    let mut sizes: Vec<f64> = values.iter().map(|d| d.abs()).collect();
    let (le90, le95) = (quantile(&mut sizes, 0.9), quantile(&mut sizes, 0.95));
    values.iter_mut().for_each(|d| *d = (*d - median).abs());
    let nmad = NORMAL * quantile(&mut values, 0.5);
    let (lowest, highest) = (extreme(lowest), extreme(highest));
    Some(Statistics { cells: values.len(), bias, rmse, rmse_debiased, mae, median, nmad, le90, le95, lowest, highest })
}

/// The sum of a term over all values. It does not depend on the number of threads.
pub(super) fn sum(values: &[f64], term: impl Fn(f64) -> f64 + Sync) -> f64 {
    let of_block = |block: usize| values[block * BLOCK..].iter().take(BLOCK).map(|&v| term(v)).sum::<f64>();
    parallel::map(values.len().div_ceil(BLOCK), of_block).iter().sum()
}

/// The quantile of values, which must be numbers. They are reordered. NaN if there are none.
pub(super) fn quantile(values: &mut [f64], share: f64) -> f64 {
    if values.is_empty() {
        return f64::NAN;
    }
    let rank = share * (values.len() - 1) as f64;
    let below = rank.floor() as usize;
    let (_, &mut value, above) = values.select_nth_unstable_by(below, f64::total_cmp);
    match above.iter().copied().reduce(f64::min) {
        Some(next) => value + (rank - rank.floor()) * (next - value),
        None => value,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(values: &[f64]) -> Option<Statistics> {
        statistics(values, &|i| DVec2::new(i as f64, 0.0), &|_| true)
    }

    fn close(a: f64, b: f64) -> bool {
        (a - b).abs() < 1e-12
    }

    #[test]
    fn figures_are_those_of_a_hand_calculation() {
        let s = of(&[1.0, f64::NAN, -2.0, 4.0, 4.0, f64::INFINITY, 3.0]).unwrap();
        assert_eq!(s.cells, 5);
        assert!(close(s.bias, 2.0) && close(s.rmse, 46f64.sqrt() / 5f64.sqrt()), "{s:?}");
        assert!(close(s.rmse_debiased, (26.0f64 / 5.0).sqrt()) && close(s.mae, 14.0 / 5.0), "{s:?}");
        // |d − 3| is 2, 5, 1, 1, 0: the middle one is 1.
        assert!(close(s.median, 3.0) && close(s.nmad, 1.4826), "{s:?}");
        // |d| in order is 1, 2, 3, 4, 4; ranks 3.6 and 3.8.
        assert!(close(s.le90, 4.0) && close(s.le95, 4.0), "{s:?}");
        assert_eq!((s.lowest.value, s.lowest.place.x), (-2.0, 2.0));
        assert_eq!((s.highest.value, s.highest.place.x), (4.0, 3.0));
    }

    #[test]
    fn quantiles_lie_between_ranks() {
        assert!(close(quantile(&mut [4.0, 1.0, 3.0, 2.0], 0.5), 2.5));
        assert!(close(quantile(&mut [10.0, 0.0], 0.9), 9.0));
        assert!(close(quantile(&mut [7.0], 0.9), 7.0));
        assert!(quantile(&mut [], 0.5).is_nan());
    }

    #[test]
    fn members_alone_count_and_none_gives_nothing() {
        let s = statistics(&[1.0, 2.0, 3.0], &|_| DVec2::ZERO, &|i| i > 0).unwrap();
        assert_eq!((s.cells, s.bias, s.lowest.value), (2, 2.5, 2.0));
        assert_eq!(of(&[f64::NAN]), None);
        assert_eq!(of(&[]), None);
    }

    #[test]
    fn sums_do_not_depend_on_threads() {
        let values: Vec<f64> = (0..300_000).map(|i| f64::from(i).sin() * 1e3).collect();
        let sums = [1, 4].map(|threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| of(&values)).unwrap()
        });
        assert_eq!(sums[0], sums[1]);
        assert_eq!(sums[0].rmse.to_bits(), sums[1].rmse.to_bits());
    }
}
