//! Comparison of two height maps: statistics of the differences, over all cells and by class.
//!
//! The difference is A − B everywhere; B is the reference. [`compare`] takes heights of both at the same cell centres.
//! A surface is evaluated there ([`heights`](crate::surface::heights)). A height map on another grid is interpolated
//! ([`heights_between`]). The caller chooses which of the two stays as it is. It should be B.
//!
//! All calculations are in double precision, from the heights as they are stored. The results do not depend on the
//! number of threads.
//!
//! Both are read three times, some rows at a time. So the memory does not depend on the number of rows. The first pass finds
//! the ranges of heights, from which the classes follow. The second one sums up and counts. The third one needs the means
//! of the second, and collects the few differences that the exact quantiles lie between.

mod bands;
mod bins;
mod classes;
mod difference;
mod distance;
mod group;
mod heights;
mod levels;
mod passes;
mod precision;
mod resampled;
mod rows;
mod sample;
mod slopes;
mod statistics;
mod tally;
mod trend;

pub use bands::{BandShare, outside_bands};
pub use classes::{Class, SLOPE_BOUNDS};
#[doc(hidden)]
pub use difference::subtract;
pub use difference::{Difference, difference};
pub use distance::contour_distances;
pub use heights::{HeightFigures, height_figures};
pub use levels::{BINS, LevelHistogram, find_terraces, level_histogram};
pub use precision::{Precision, precision};
pub use resampled::Resampled;
#[doc(hidden)]
pub use sample::Strip;
pub use sample::{height_at, heights_at_places, heights_between};
pub use slopes::SlopeError;
pub use statistics::{Extreme, Statistics, statistics};
pub use trend::{Trend, trend};

use glam::{DVec2, DVec3};
use serde::Serialize;

use crate::base::ElevationUnit;
use crate::base::error::{Error, Result};
use crate::contour::Interval;
use crate::raster::RasterRows;
use classes::round_up;
use passes::{Counted, collect, count, find_ranges};

/// Number of standard deviations that a difference exceeds by chance once in twenty times.
const SIGNIFICANT: f64 = 1.96;

/// Parameters of [`compare`].
#[derive(Debug, Clone, Copy)]
pub struct CompareParams<'a> {
    /// Metres per map unit in x and y, for slopes on maps in feet or degrees.
    pub metres_per_unit: DVec2,
    /// Stated accuracy of the reference heights, as a standard deviation in metres.
    pub sigma: Option<f64>,
    /// The contour interval, if contours are part of the comparison. Without it, the usual intervals are tried.
    pub interval: Option<Interval>,
    /// Distance of every cell to the nearest contour, if there are contours; see [`contour_distances`].
    pub distances: Option<&'a [f64]>,
}

impl Default for CompareParams<'_> {
    fn default() -> Self {
        Self { metres_per_unit: DVec2::ONE, sigma: None, interval: None, distances: None }
    }
}

/// The result of a comparison. In JSON, the keys are the names of these fields.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Comparison {
    /// The unit of differences, of elevations and of distances. Properties of the heights of one side are in metres.
    #[serde(skip)]
    pub unit: ElevationUnit,
    /// Statistics of all cells that have heights in both, metres.
    pub overall: Statistics,
    /// The same by the slope of B, degrees (Horn 1981). At the edge of the data, heights are extrapolated linearly.
    pub by_slope: Vec<Class>,
    /// The same by the elevation of B, metres.
    pub by_elevation: Vec<Class>,
    /// The same by the distance to the nearest contour, map units. Empty if there are no contours.
    pub by_distance: Vec<Class>,
    /// The error of the slopes. `None` if no cell has all its neighbours in both.
    pub slope: Option<SlopeError>,
    /// Comparison with the stated accuracy of the reference. `None` if it is not known.
    pub significance: Option<Significance>,
    /// The heights outside the bands of the contours. `None` if there are no contours. [`compare`] does not set it, see
    /// [`outside_bands`].
    pub bands: Option<BandShare>,
    /// The plane through the differences, if it explains more than half of their squares. [`compare`] does not set it, see [`trend`].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub trend: Option<Trend>,
    /// Properties of the heights of A.
    pub a: HeightFigures,
    /// Properties of the heights of B.
    pub b: HeightFigures,
}

/// The part of the differences that the stated accuracy of the reference does not explain.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Significance {
    /// Stated accuracy, as a standard deviation in metres.
    pub sigma: f64,
    /// 1.96 times the stated accuracy, metres.
    pub limit: f64,
    /// Share of the cells where |d| is larger than the limit. If A had no errors, about 0.05 would exceed it by chance.
    pub share: f64,
    /// Root of rmse² − sigma², metres: the error of A if the errors of both are independent; at least 0.
    pub rmse_beyond: f64,
}

/// Compares two height maps on the same grid.
///
/// # Errors
/// [`Error::Parameter`] when the grids differ. [`Error::OutOfRange`] when a parameter is out of range. [`Error::Data`] when no
/// cell has a height in both. As [`RasterRows::read`].
pub fn compare(a: &dyn RasterRows, b: &dyn RasterRows, params: &CompareParams<'_>) -> Result<Comparison> {
    let grid = b.grid();
    if a.grid() != grid {
        return Err(Error::Parameter(
            "height maps are compared on one grid: evaluate A at the cells of B first".into(),
        ));
    }
    if let Some(sigma) = params.sigma
        && !(sigma.is_finite() && sigma > 0.0)
    {
        let (name, must) = ("standard deviation", "more than 0");
        return Err(Error::OutOfRange { name, value: sigma, unit: " m", must });
    }
    let no_overlap =
        || Error::Data("there is no place where both A and B have heights: do they overlap at all?".into());
    let ranges = find_ranges([a, b], params)?.ok_or_else(no_overlap)?;
    let Counted { groups, slopes, beyond, levels } = count([a, b], params, &ranges)?;
    let [of_a, of_b] = std::array::from_fn(|side| ranges.sides[side].figures(&levels[side]));
    let place = |i: usize| grid.center(i % grid.cols, i / grid.cols);
    let [overall, by_slope, by_elevation, by_distance] =
        collect([a, b], params, groups)?.map(|group| group.statistics(&place));
    let overall = overall.first().and_then(|class| class.statistics).ok_or_else(no_overlap)?;
    Ok(Comparison {
        unit: ElevationUnit::Metre,
        overall,
        by_slope,
        by_elevation,
        by_distance,
        slope: slopes.error(),
        significance: params.sigma.map(|sigma| significance(beyond, &overall, sigma)),
        bands: None,
        trend: None,
        a: of_a,
        b: of_b,
    })
}

/// Statistics of height − check height. `heights` are the heights of a surface or a height map at the check points, NaN
/// where there is none.
pub fn at_check_points(heights: &[f64], points: &[DVec3]) -> Option<Statistics> {
    let differences: Vec<f64> = heights.iter().zip(points).map(|(h, p)| h - p.z).collect();
    statistics(&differences, &|i| points[i].truncate(), &|_| true)
}

/// A round number of metres that nearly all differences are within. It is the limit of a colour scale.
pub fn round_limit(statistics: &Statistics) -> f64 {
    let most = statistics.le95.max(1e-3);
    round_up(most)
}

fn significance(beyond: usize, overall: &Statistics, sigma: f64) -> Significance {
    Significance {
        sigma,
        limit: SIGNIFICANT * sigma,
        share: beyond as f64 / overall.cells as f64,
        rmse_beyond: (overall.rmse * overall.rmse - sigma * sigma).max(0.0).sqrt(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::Grid;
    use crate::raster::Dem;

    fn plane(height: impl Fn(f64, f64) -> f64) -> Dem {
        let grid = Grid { corner: DVec2::new(1000.0, 2000.0), cell: DVec2::splat(10.0), cols: 20, rows: 10 };
        let values = (0..200).map(|i| height((i % 20) as f64, (i / 20) as f64) as f32).collect();
        Dem { grid, values, crs: None }
    }

    #[test]
    fn a_shifted_plane_is_off_by_the_shift() {
        let b = plane(|x, y| 100.0 + 4.0 * x - 2.0 * y);
        let a = plane(|x, y| 103.0 + 4.0 * x - 2.0 * y);
        let found = compare(&a, &b, &CompareParams { sigma: Some(2.0), ..CompareParams::default() }).unwrap();
        let s = found.overall;
        assert_eq!((s.cells, s.bias, s.rmse, s.mae, s.median, s.le90, s.le95), (200, 3.0, 3.0, 3.0, 3.0, 3.0, 3.0));
        assert_eq!((s.rmse_debiased, s.nmad), (0.0, 0.0));
        assert_eq!((s.lowest.place, s.highest.place), (DVec2::new(1005.0, 1995.0), DVec2::new(1005.0, 1995.0)));
        // atan(sqrt(0.4² + 0.2²)) = 24.1 degrees: all cells are in the third class, those at the edge too.
        assert_eq!(
            found.by_slope.iter().map(|c| c.statistics.map_or(0, |s| s.cells)).collect::<Vec<_>>(),
            [0, 0, 200, 0, 0]
        );
        let slope = found.slope.unwrap();
        assert_eq!((slope.cells, slope.rmse, slope.bias), (18 * 8, 0.0, 0.0));
        let significance = found.significance.unwrap();
        assert_eq!((significance.share, significance.limit), (0.0, 3.92));
        assert!((significance.rmse_beyond - 5f64.sqrt()).abs() < 1e-12);
        assert_eq!(found.by_elevation.iter().filter_map(|c| c.statistics).map(|s| s.cells).sum::<usize>(), 200);
        assert!(found.by_distance.is_empty() && found.bands.is_none());
        assert_eq!(found.a.precision, Some(Precision::WholeMetres));
        assert_eq!(difference(&a, &b).unwrap().values, vec![3.0f32; 200]);
    }

    #[test]
    fn slopes_differ_by_what_the_planes_differ() {
        let found = compare(&plane(|x, _| 10.0 * x), &plane(|_, _| 5.0), &CompareParams::default()).unwrap();
        let slope = found.slope.unwrap();
        assert!((slope.rmse - 45.0).abs() < 1e-9 && (slope.bias - 45.0).abs() < 1e-9);
        // In feet the same planes are steeper.
        let feet = CompareParams { metres_per_unit: DVec2::splat(0.5), ..CompareParams::default() };
        let found = compare(&plane(|x, _| 10.0 * x), &plane(|_, _| 5.0), &feet).unwrap();
        assert!((found.slope.unwrap().rmse - 2f64.atan().to_degrees()).abs() < 1e-5);
    }

    #[test]
    fn classes_share_the_cells_among_them() {
        let distances: Vec<f64> = (0..200).map(|i| if i < 10 { f64::NAN } else { f64::from(i % 20) }).collect();
        let params = CompareParams { distances: Some(&distances), ..CompareParams::default() };
        let found = compare(&plane(|x, _| x), &plane(|x, _| x * x), &params).unwrap();
        let cells = |classes: &[Class]| classes.iter().filter_map(|c| c.statistics).map(|s| s.cells).sum::<usize>();
        assert_eq!((cells(&found.by_slope), cells(&found.by_elevation), cells(&found.by_distance)), (200, 200, 190));
        assert_eq!(found.by_distance.last().unwrap().to, None);
    }

    #[test]
    fn what_cannot_be_compared_is_an_error() {
        let (a, b) = (plane(|_, _| f64::NAN), plane(|_, _| 1.0));
        let error = compare(&a, &b, &CompareParams::default()).unwrap_err();
        assert!(matches!(&error, Error::Data(m) if m.contains("overlap")), "{error}");
        let mut other = b.clone();
        other.grid.corner.x += 1.0;
        assert!(matches!(compare(&other, &b, &CompareParams::default()), Err(Error::Parameter(_))));
        for sigma in [0.0, -1.0, f64::NAN] {
            let params = CompareParams { sigma: Some(sigma), ..CompareParams::default() };
            assert!(matches!(compare(&b, &b, &params), Err(Error::OutOfRange { .. })));
        }
    }

    #[test]
    fn check_points_count_where_there_are_heights() {
        let points = [DVec3::new(1.0, 2.0, 10.0), DVec3::new(3.0, 4.0, 20.0), DVec3::new(5.0, 6.0, 30.0)];
        let s = at_check_points(&[11.0, f64::NAN, 28.0], &points).unwrap();
        assert_eq!((s.cells, s.bias, s.lowest.place), (2, -0.5, DVec2::new(5.0, 6.0)));
        assert_eq!(at_check_points(&[f64::NAN], &points[..1]), None);
    }
}
