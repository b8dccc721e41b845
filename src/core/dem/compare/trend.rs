//! Whether the differences of two height maps look like those of two height systems: smooth, and much larger than what is
//! left of them.

use glam::{DMat3, DVec2, DVec3};
use serde::Serialize;

use super::difference::Difference;
use crate::base::error::Result;
use crate::raster::{RasterRows, uniform};

/// Rows that are read at a time.
const ROWS: usize = 64;

/// The plane that fits the differences best (least squares).
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Trend {
    /// The share of the sum of squared differences that the plane explains, 0 to 1.
    pub explained: f64,
    /// The lowest and the highest difference of the plane in the box around the cells, metres.
    pub lowest: f64,
    /// See `lowest`.
    pub highest: f64,
}

/// The plane through the differences A − B of two height maps on one grid. `None` if they have no cell in common, or no
/// difference.
///
/// # Errors
/// As [`RasterRows::read`]. If there is not enough memory.
pub fn trend(a: &dyn RasterRows, b: &dyn RasterRows) -> Result<Option<Trend>> {
    let grid = b.grid();
    let half = DVec2::new(grid.cols as f64, grid.rows as f64) / 2.0;
    let differences = Difference { a, b };
    let (mut normal, mut right, mut squares) = (DMat3::ZERO, DVec3::ZERO, 0.0);
    let (mut low, mut high) = (DVec2::INFINITY, DVec2::NEG_INFINITY);
    for first in (0..grid.rows).step_by(ROWS) {
        let mut values = uniform(grid.cols * ROWS.min(grid.rows - first), f32::NAN)?;
        differences.read(first, &mut values)?;
        for (cell, difference) in values.into_iter().enumerate().filter(|(_, difference)| difference.is_finite()) {
            // Places from -1 to 1, so that the equations are well conditioned.
            let cell = DVec2::new((cell % grid.cols) as f64, (first + cell / grid.cols) as f64);
            let place = (cell + 0.5 - half) / half;
            let (terms, difference) = (place.extend(1.0), f64::from(difference));
            normal += DMat3::from_cols(terms * terms.x, terms * terms.y, terms);
            right += terms * difference;
            squares += difference * difference;
            (low, high) = (low.min(place), high.max(place));
        }
    }
    if squares == 0.0 {
        return Ok(None);
    }
    // Cells in one row or column determine no plane: then the mean alone is fitted.
    let is_plane = normal.determinant() > 1e-9 * normal.z_axis.z.powi(3);
    let plane = if is_plane { normal.inverse() * right } else { DVec3::Z * (right.z / normal.z_axis.z) };
    let corners = [low, high, DVec2::new(low.x, high.y), DVec2::new(high.x, low.y)].map(|p| plane.dot(p.extend(1.0)));
    Ok(Some(Trend {
        explained: (plane.dot(right) / squares).clamp(0.0, 1.0),
        lowest: corners.into_iter().fold(f64::INFINITY, f64::min),
        highest: corners.into_iter().fold(f64::NEG_INFINITY, f64::max),
    }))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::Grid;
    use crate::raster::Dem;

    fn dem(height: impl Fn(f64, f64) -> f64) -> Dem {
        let grid = Grid { corner: DVec2::new(1000.0, 2000.0), cell: DVec2::splat(10.0), cols: 100, rows: 150 };
        let values = (0..grid.len()).map(|i| height((i % 100) as f64, (i / 100) as f64) as f32).collect();
        Dem { grid, values, crs: None }
    }

    #[test]
    fn a_tilt_is_told_from_roughness() {
        let ground = |x: f64, y: f64| 100.0 + 5.0 * (x / 9.0).sin() * (y / 7.0).cos();
        let rough = |x: f64, y: f64| 0.1 * (x * 2.1 + y * 1.7).sin();
        let b = dem(ground);
        let tilted = dem(|x, y| ground(x, y) + 0.3 + 0.002 * x + rough(x, y));
        let found = trend(&tilted, &b).unwrap().unwrap();
        assert!(found.explained > 0.95, "{found:?}");
        assert!((found.lowest - 0.3).abs() < 0.01 && (found.highest - 0.498).abs() < 0.01, "{found:?}");
        let found = trend(&dem(|x, y| ground(x, y) + rough(x, y)), &b).unwrap().unwrap();
        assert!(found.explained < 0.05, "{found:?}");
        assert_eq!(trend(&b, &b).unwrap(), None);
        let row = dem(|_, y| if y == 3.0 { 5.0 } else { f64::NAN });
        let level = dem(|_, _| 4.0);
        let found = trend(&row, &level).unwrap().unwrap();
        assert!((found.explained - 1.0).abs() < 1e-9 && (found.lowest - 1.0).abs() < 1e-9, "{found:?}");
    }
}
