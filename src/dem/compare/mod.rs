//! Comparison of two height maps: statistics of the differences, over all cells and by class.
//!
//! The difference is A − B everywhere; B is the reference. [`compare`] takes heights of both at the same cell centres.
//! A surface is evaluated there ([`heights`](crate::surface::heights)). A height map on another grid is interpolated
//! ([`heights_between`]). The caller chooses which of the two stays as it is. It should be B.
//!
//! All calculations are in double precision, from the heights as they are stored. The results do not depend on the
//! number of threads.
//!
//! Both are read three times, some rows at a time. So the memory does not depend on the number of rows. The first pass finds the
//! range of heights, from which the classes follow. The second one sums up and counts. The third one needs the means of the
//! second, and collects the few differences that the exact quantiles lie between.

mod bands;
mod bins;
mod classes;
mod distance;
mod group;
mod heights;
mod levels;
mod precision;
mod resampled;
mod rows;
mod sample;
mod statistics;
mod tally;

pub use bands::{BandShare, outside_bands};
pub use classes::{Class, SLOPE_BOUNDS};
pub use distance::contour_distances;
pub use heights::{HeightFigures, height_figures};
pub use levels::{BINS, LevelHistogram, find_terraces, level_histogram};
pub use precision::{Precision, precision};
pub use resampled::Resampled;
pub(crate) use sample::Strip;
pub use sample::{height_at, heights_at_places, heights_between};
pub use statistics::{Extreme, Statistics, statistics};

use glam::{DVec2, DVec3};
use serde::Serialize;

use super::{Dem, RasterRows, empty};
use crate::base::Grid;
use crate::base::error::{Error, Result};
use crate::contour::Interval;
use crate::crs::Crs;
use classes::{distance_bounds, elevation_bounds, round_up};
use group::{Group, SecondGroup};
use heights::Scan;
use levels::LevelCounts;
use rows::{Row, each_block, fill};

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
    /// Properties of the heights of A.
    pub a: HeightFigures,
    /// Properties of the heights of B.
    pub b: HeightFigures,
}

/// The difference of slopes, A − B.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct SlopeError {
    /// Cells that have all eight neighbours in both.
    pub cells: usize,
    /// Root mean square difference, degrees.
    pub rmse: f64,
    /// Mean difference, degrees. Below 0 where A is smoother.
    pub bias: f64,
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
    let first = First::of([a, b], params)?;
    let second = Sums::of([a, b], params, &first)?;
    let (slope, beyond) = (second.slopes.error(), second.beyond);
    let levels = [&second.a, &second.b];
    let [of_a, of_b] = std::array::from_fn(|side| first.sides[side].figures(levels[side]));
    let place = |i: usize| grid.center(i % grid.cols, i / grid.cols);
    let [overall, by_slope, by_elevation, by_distance] =
        second.groups.third([a, b], params)?.map(|group| group.classes(&place));
    let Some(overall) = overall.first().and_then(|class| class.statistics) else { return Err(no_overlap()) };
    Ok(Comparison {
        overall,
        by_slope,
        by_elevation,
        by_distance,
        slope,
        significance: params.sigma.map(|sigma| significance(beyond, &overall, sigma)),
        bands: None,
        a: of_a,
        b: of_b,
    })
}

fn no_overlap() -> Error {
    Error::Data("there is no place where both A and B have heights: do they overlap at all?".into())
}

/// What the first pass finds.
struct First {
    sides: [Scan; 2],
    /// The bounds of the classes of elevation and of distance.
    elevations: Vec<f64>,
    distances: Vec<f64>,
}

impl First {
    fn of(sides: [&dyn RasterRows; 2], params: &CompareParams<'_>) -> Result<Self> {
        let [mut of_a, mut of_b] = [Scan::new(); 2];
        let (mut lowest, mut highest) = (f32::INFINITY, f32::NEG_INFINITY);
        let mut known = Vec::new();
        each_block(sides, |a, b, _| {
            let compared = || a.heights().iter().zip(b.heights()).map(|(a, b)| a.is_finite() && b.is_finite());
            let range = || {
                for (height, _) in b.heights().iter().zip(compared()).filter(|(_, is_compared)| *is_compared) {
                    (lowest, highest) = (lowest.min(*height), highest.max(*height));
                }
            };
            rayon::join(|| of_a.add(a.heights()), || rayon::join(|| of_b.add(b.heights()), range));
            let first = b.rows.start * sides[1].grid().cols;
            let distances = params.distances.and_then(|distances| distances.get(first..)).unwrap_or_default();
            known.extend(distances.iter().zip(compared()).filter(|(_, is_compared)| *is_compared).map(|(d, _)| *d));
        })?;
        if lowest > highest {
            return Err(no_overlap());
        }
        let elevations = elevation_bounds(lowest.into(), highest.into());
        Ok(Self { sides: [of_a, of_b], elevations, distances: distance_bounds(known.into_iter()) })
    }
}

/// Classes: all cells, by slope, by elevation, by distance.
struct Groups<G>([G; 4]);

/// What the second pass sums up.
struct Sums {
    groups: Groups<Group>,
    slopes: Slopes,
    /// Number of differences beyond the accuracy that is stated.
    beyond: usize,
    a: LevelCounts,
    b: LevelCounts,
}

impl Sums {
    fn of(sides: [&dyn RasterRows; 2], params: &CompareParams<'_>, first: &First) -> Result<Self> {
        let Grid { cell, cols, .. } = sides[1].grid();
        let cell = cell * params.metres_per_unit;
        let limit = params.sigma.map_or(f64::INFINITY, |sigma| SIGNIFICANT * sigma);
        let steepness = SLOPE_BOUNDS.map(steepness_of).to_vec();
        let mut all = Group::new(&[f64::NEG_INFINITY, f64::INFINITY]);
        let mut by_slope = Group::compared(&SLOPE_BOUNDS, steepness);
        let (mut by_elevation, mut by_distance) = (Group::new(&first.elevations), Group::new(&first.distances));
        let (mut slopes, mut beyond) = (Slopes::default(), 0);
        let [mut of_a, mut of_b] = [0, 1].map(|side: usize| first.sides[side].levels(params.interval.as_ref()));
        each_block(sides, |a, b, rows| {
            fill(b, rows, |row, out| {
                out.subtract(a.row(row), b.row(row));
                out.compare_slopes(a.around(row), b.around(row), cell);
            });
            let numbered = || b.rows.clone().zip(rows.iter());
            // Each task goes through the rows in order. So sums do not depend on the threads.
            rayon::scope(|scope| {
                scope.spawn(|_| of_a.add(a.heights()));
                scope.spawn(|_| of_b.add(b.heights()));
                scope.spawn(|_| {
                    for (row, Row { differences, slopes: of_row, .. }) in numbered() {
                        all.add(differences, |_| 0.0, row * cols);
                        slopes.add(of_row);
                        beyond += differences.iter().filter(|d| d.abs() > limit).count();
                    }
                });
                scope.spawn(|_| {
                    for (row, Row { differences, steepness, .. }) in numbered() {
                        by_slope.add(differences, |col| steepness[col].into(), row * cols);
                    }
                });
                scope.spawn(|_| {
                    for (row, Row { differences, .. }) in numbered() {
                        let heights = b.row(row);
                        by_elevation.add(differences, |col| heights[col].into(), row * cols);
                    }
                });
                if let Some(distances) = params.distances {
                    let by_distance = &mut by_distance;
                    scope.spawn(move |_| {
                        for (row, Row { differences, .. }) in numbered() {
                            by_distance.add(differences, |col| distances[row * cols + col], row * cols);
                        }
                    });
                }
            });
        })?;
        Ok(Self { groups: Groups([all, by_slope, by_elevation, by_distance]), slopes, beyond, a: of_a, b: of_b })
    }
}

impl Groups<Group> {
    /// The third pass.
    fn third(self, sides: [&dyn RasterRows; 2], params: &CompareParams<'_>) -> Result<[SecondGroup; 4]> {
        let Grid { cell, cols, .. } = sides[1].grid();
        let cell = cell * params.metres_per_unit;
        let [mut all, mut by_slope, mut by_elevation, mut by_distance] = self.0.map(Group::second);
        each_block(sides, |a, b, rows| {
            fill(b, rows, |row, out| {
                out.subtract(a.row(row), b.row(row));
                out.incline(b.around(row), cell);
            });
            let numbered = || b.rows.clone().zip(rows.iter());
            rayon::scope(|scope| {
                scope.spawn(|_| numbered().for_each(|(_, row)| all.add(&row.differences, |_| 0.0)));
                scope.spawn(|_| {
                    for (_, Row { differences, steepness, .. }) in numbered() {
                        by_slope.add(differences, |col| steepness[col].into());
                    }
                });
                scope.spawn(|_| {
                    for (row, Row { differences, .. }) in numbered() {
                        let heights = b.row(row);
                        by_elevation.add(differences, |col| heights[col].into());
                    }
                });
                if let Some(distances) = params.distances {
                    let by_distance = &mut by_distance;
                    scope.spawn(move |_| {
                        for (row, Row { differences, .. }) in numbered() {
                            by_distance.add(differences, |col| distances[row * cols + col]);
                        }
                    });
                }
            });
        })?;
        Ok([all, by_slope, by_elevation, by_distance])
    }
}

/// Sums of the differences of slopes.
#[derive(Debug, Default)]
struct Slopes {
    cells: usize,
    sum: f64,
    squares: f64,
}

impl Slopes {
    fn add(&mut self, row: &[f64]) {
        self.cells += row.len();
        self.sum += row.iter().sum::<f64>();
        self.squares += row.iter().map(|d| d * d).sum::<f64>();
    }

    fn error(&self) -> Option<SlopeError> {
        let count = self.cells as f64;
        let error = || SlopeError { cells: self.cells, rmse: (self.squares / count).sqrt(), bias: self.sum / count };
        (self.cells > 0).then(error)
    }
}

/// The difference A − B of two height maps on one grid. NaN where one of them has no height.
///
/// # Errors
/// As [`RasterRows::read`]. If there is not enough memory.
pub fn difference(a: &dyn RasterRows, b: &dyn RasterRows) -> Result<Dem> {
    Ok(Difference { a, b }.whole()?.into_owned())
}

/// The difference A − B of two height maps on one grid, computed when its rows are read.
#[derive(Debug, Clone, Copy)]
pub struct Difference<'a> {
    /// The heights that are compared.
    pub a: &'a dyn RasterRows,
    /// The heights that are subtracted.
    pub b: &'a dyn RasterRows,
}

impl RasterRows for Difference<'_> {
    fn grid(&self) -> Grid {
        self.b.grid()
    }

    fn crs(&self) -> Option<&Crs> {
        self.b.crs()
    }

    fn read(&self, first: usize, values: &mut [f32]) -> Result<()> {
        let mut heights = empty(values.len())?;
        heights.resize(values.len(), f32::NAN);
        let (of_a, of_b) = rayon::join(|| self.a.read(first, values), || self.b.read(first, &mut heights));
        of_a.and(of_b)?;
        values.iter_mut().zip(heights).for_each(|(a, b)| *a = subtract(*a, b));
        Ok(())
    }
}

/// The difference of two heights. NaN if one of them is no number.
pub(crate) fn subtract(a: f32, b: f32) -> f32 {
    if a.is_finite() && b.is_finite() { (f64::from(a) - f64::from(b)) as f32 } else { f32::NAN }
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

fn degrees(steepness: f32) -> f64 {
    f64::from(steepness).atan().to_degrees()
}

/// The smallest slope, as rise over run in single precision, of at least some degrees. Slopes are compared with it, which takes
/// less time than their arc tangents.
fn steepness_of(bound: f64) -> f64 {
    let (mut low, mut high) = (0, f32::INFINITY.to_bits());
    while low < high {
        let middle = low.midpoint(high);
        if degrees(f32::from_bits(middle)) >= bound { high = middle } else { low = middle + 1 }
    }
    f32::from_bits(low).into()
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
