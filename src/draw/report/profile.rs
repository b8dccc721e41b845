//! The profile: heights of A and B along a line through the largest difference, in the direction of the slope there.

use glam::DVec2;

use tokosen_core::base::error::Result;
use tokosen_core::dem::compare::{Comparison, Strip};
use tokosen_core::raster::RasterRows;

/// Cells from the middle of the line to each end.
const REACH: f64 = 60.0;
/// Points per cell.
const DENSITY: f64 = 2.0;
/// Distance on each side over which the direction of the slope is computed, cells.
const LOOK: f64 = 3.0;

/// A profile.
pub(super) struct Profile {
    /// Ends of the line, map units.
    pub ends: [DVec2; 2],
    /// Distance from the first end, metres, and the heights of A and B; NaN where there is no height.
    pub points: Vec<(f64, [f64; 2])>,
}

/// The profile through the larger of the two extreme differences.
pub(super) fn profile(
    found: &Comparison,
    a: &dyn RasterRows,
    b: &dyn RasterRows,
    metres_per_unit: DVec2,
) -> Result<Profile> {
    let (lowest, highest) = (found.overall.lowest, found.overall.highest);
    let middle = if lowest.value.abs() > highest.value.abs() { lowest.place } else { highest.place };
    let cell = b.grid().cell;
    let size = (cell * metres_per_unit).min_element();
    let reach = (REACH * size / metres_per_unit.y).max(LOOK * cell.y);
    let near = (middle.y - reach, middle.y + reach);
    let (a, b) = (Strip::read(a, near)?, Strip::read(b, near)?);
    let rise = |step: DVec2| {
        let d = b.height_at(middle + step * LOOK) - b.height_at(middle - step * LOOK);
        if d.is_finite() { d } else { 0.0 }
    };
    let east = rise(DVec2::new(cell.x, 0.0)) / (cell.x * metres_per_unit.x);
    let north = rise(DVec2::new(0.0, cell.y)) / (cell.y * metres_per_unit.y);
    let down = DVec2::new(-east, -north).try_normalize().unwrap_or(DVec2::X);
    // From west to east, as a map is read.
    let ahead = if down.x < 0.0 { -down } else { down };
    let step = ahead * size / metres_per_unit / DENSITY;
    let count = (REACH * DENSITY) as i32;
    let is_known = |k: i32| b.height_at(middle + step * f64::from(k)).is_finite();
    let (mut first, mut last) = (0, 0);
    (-count..=count).filter(|&k| is_known(k)).for_each(|k| {
        first = first.min(k);
        last = last.max(k);
    });
    let at = |k: i32| middle + step * f64::from(k);
    let points = (first..=last)
        .map(|k| (f64::from(k - first) * size / DENSITY, [a.height_at(at(k)), b.height_at(at(k))]))
        .collect();
    Ok(Profile { ends: [at(first), at(last)], points })
}
