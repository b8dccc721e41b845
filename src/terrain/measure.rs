//! All figures of a comparison: heights, distances from contours, bands, check points.

use std::path::Path;

use glam::DVec2;

use super::compare::{Kind, Pair};
use tokosen_core::base::error::{Error, Result};
use tokosen_core::base::progress::{Progress, step};
use tokosen_core::base::{ElevationUnit, Grid, parallel};
use tokosen_core::contour::{Interval, SpotHeights};
use tokosen_core::crs::{Transform, converted};
use tokosen_core::dem::compare::{
    BandShare, CompareParams, Comparison, Trend, at_check_points, compare, contour_distances, height_figures,
    outside_bands, trend,
};
use tokosen_core::raster::{InUnit, locate};
use tokosen_core::tin::{NONE, Tin};

/// Differences of which a plane explains more than this share of the squares look like those of two height systems.
const LIKE_A_DATUM: f64 = 0.5;

/// Optional parameters of a comparison.
#[derive(Debug, Clone, Copy, Default)]
pub struct MeasureOptions {
    /// Stated accuracy as a standard deviation, metres; that of the product if `None`.
    pub sigma: Option<f64>,
    /// Contour interval at whose levels terraces are searched for, metres; that of the contours if `None`.
    pub interval: Option<f64>,
    /// The unit of the figures. Of those in feet, distances are in feet too.
    pub unit: ElevationUnit,
}

/// The figures of a comparison.
///
/// # Errors
/// As [`compare`](fn@compare).
pub fn measure(pair: &Pair, options: &MeasureOptions, progress: &dyn Progress) -> Result<Comparison> {
    let (a, b) = (&*pair.a_heights, &*pair.b_heights);
    let unit = options.unit;
    let distances = match pair.side_with_surface() {
        Some((side, surface)) => {
            let transform = side.transform_from(b.crs(), &pair.b.source.file)?;
            let to_map = |p: DVec2| converted(transform.as_ref(), p);
            let (a, b) = (a.whole()?, b.whole()?);
            let known = |i: usize| a.values[i].is_finite() && b.values[i].is_finite();
            let contours = &surface.map.contours;
            Some(step(progress, "measuring distances", || contour_distances(contours, &b.grid, &to_map, known)))
        }
        None => None,
    };
    let interval = options.interval.map(|step| Interval { step, base: 0.0, rounding: 0.0 }).or(pair.interval());
    // The accuracy of the reference or, if it states none, that of A.
    let sigma = options.sigma.or(pair.b.sigma).or(pair.a.sigma);
    let distances = distances.map(|distances| distances.into_iter().map(|d| unit.about(d)).collect::<Vec<f64>>());
    let params = CompareParams {
        metres_per_unit: pair.metres_per_unit() * unit.about(1.0),
        sigma: sigma.map(|sigma| unit.about(sigma)),
        interval,
        distances: distances.as_deref(),
    };
    let [a_shown, b_shown] = [&pair.a_heights, &pair.b_heights].map(|heights| InUnit::of(heights, unit));
    let mut found = step(progress, "comparing", || compare(&*a_shown, &*b_shown, &params))?;
    found.unit = unit;
    if unit.is_foot() {
        // Steps and terraces are those of the heights as they are stored.
        (found.a, found.b) = (height_figures(a, interval.as_ref())?, height_figures(b, interval.as_ref())?);
    }
    for (figures, side) in [(&mut found.a, &pair.a), (&mut found.b, &pair.b)] {
        // Interpolation changes decimals and removes terraces, so the original heights are examined.
        if let Kind::Dem(dem) = &side.kind
            && (dem.grid() != b.grid() || dem.crs() != b.crs())
        {
            *figures = height_figures(&**dem, interval.as_ref())?;
        }
    }
    // Two height systems differ by nearly the same everywhere on a map: such a plane does not cross zero.
    let is_like_a_datum = |trend: &Trend| trend.explained > LIKE_A_DATUM && trend.lowest * trend.highest > 0.0;
    found.trend = trend(a, b)?.filter(is_like_a_datum);
    found.bands = bands(pair, progress)?.map(|bands| bands.in_unit(unit));
    Ok(found)
}

/// Adds the figures at check points, whose heights are in metres. `path` is their file, for errors.
///
/// # Errors
/// If no check point lies where a side has heights, or their system cannot be converted to that of a side.
pub fn add_check_points(found: &mut Comparison, pair: &Pair, checks: &SpotHeights, path: &Path) -> Result<()> {
    for (figures, side) in [(&mut found.a, &pair.a), (&mut found.b, &pair.b)] {
        let points = at_check_points(&side.at(path, checks)?, &checks.points);
        figures.points = points.map(|points| points.in_unit(found.unit));
    }
    if found.a.points.is_none() && found.b.points.is_none() {
        return Err(Error::file(path, "no check point lies where A or B have heights"));
    }
    Ok(())
}

/// The share of the height map outside the contours' bands. `None` for two surfaces, which stay inside their bands.
fn bands(pair: &Pair, progress: &dyn Progress) -> Result<Option<BandShare>> {
    let (side, surface, dem) = match (&pair.a.kind, &pair.b.kind) {
        (Kind::Surface(surface), Kind::Dem(_)) => (&pair.a, surface, &pair.b_heights),
        (Kind::Dem(_), Kind::Surface(surface)) => (&pair.b, surface, &pair.a_heights),
        _ => return Ok(None),
    };
    let dem = &*dem.whole()?;
    let transform = side.transform_from(dem.crs.as_ref(), &side.source.file)?;
    let triangles = match &transform {
        None => locate(&surface.tin, &dem.grid, progress),
        Some(transform) => step(progress, "looking for bands", || triangles_at(&surface.tin, &dem.grid, transform)),
    };
    // On water, a small difference of height does not contradict a contour.
    let band = |i: usize| {
        let t = Some(triangles[i]).filter(|&t| t != NONE)?;
        surface.regions.region(t).filter(|region| region.water.is_none()).map(|region| region.band)
    };
    Ok(outside_bands(dem, band))
}

/// The triangles of cell centres in another system, found by walking along each row.
fn triangles_at(tin: &Tin, grid: &Grid, transform: &Transform) -> Vec<u32> {
    let row = |row: usize| {
        let mut near = 0;
        (0..grid.cols).map(move |col| {
            let Some(p) = transform.forward(grid.center(col, row)) else { return NONE };
            let found = tin.walk(near, p - tin.origin);
            near = found.unwrap_or_else(|left| left);
            found.unwrap_or(NONE)
        })
    };
    if tin.is_empty() { vec![NONE; grid.len()] } else { parallel::flat_map(grid.rows, row) }
}
