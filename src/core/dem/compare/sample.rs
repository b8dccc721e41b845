//! Heights of a height map at any position.

use glam::DVec2;

use crate::base::error::Result;
use crate::base::{Grid, parallel};
use crate::raster::{Dem, RasterRows, uniform};

/// A position nearer to a cell centre than this, in cells, has the height of the cell, even if neighbours have none.
const ON_CENTRE: f64 = 1e-6;

/// The height at a position, bilinear between the four cell centres around it. NaN if one that is needed has no height.
///
/// Heights are not extrapolated beyond the outermost centres.
pub fn height_at(dem: &Dem, place: DVec2) -> f64 {
    height_by(&dem.grid, place, |col, row| dem.values[row * dem.grid.cols + col])
}

/// [`height_at`] with the heights of cells by column and row.
fn height_by(grid: &Grid, place: DVec2, height_of: impl Fn(usize, usize) -> f32) -> f64 {
    let settled = |v: f64| if (v - v.round()).abs() < ON_CENTRE { v.round() } else { v };
    let (x, y) = grid.place(place).to_array().map(settled).into();
    let inside = |v: f64, count: usize| v >= 0.0 && v <= count as f64 - 1.0;
    if !inside(x, grid.cols) || !inside(y, grid.rows) {
        return f64::NAN;
    }
    let (col, row) = (x.floor(), y.floor());
    let (right, down) = (x - col, y - row);
    let corners =
        [(0, 0, 1.0 - right, 1.0 - down), (1, 0, right, 1.0 - down), (0, 1, 1.0 - right, down), (1, 1, right, down)];
    let mut height = 0.0;
    for (i, j, across, along) in corners {
        let weight: f64 = across * along;
        if weight > 0.0 {
            height += weight * f64::from(height_of(col as usize + i, row as usize + j));
        }
    }
    height
}

/// Some rows of a raster, for heights between their cell centres.
#[derive(Debug)]
pub struct Strip {
    grid: Grid,
    first: usize,
    heights: Vec<f32>,
}

impl Strip {
    /// Reads the rows between two y, and those that heights between them need.
    ///
    /// # Errors
    /// As [`RasterRows::read`]. If there is not enough memory.
    pub fn read(source: &dyn RasterRows, (low, high): (f64, f64)) -> Result<Self> {
        let grid = source.grid();
        let row = |y: f64| grid.place(DVec2::new(grid.corner.x, y)).y;
        // Conversion to a whole number takes what is beyond the raster to its border, and NaN to 0.
        let (first, last) = ((row(high) - 1.0).floor() as usize, (row(low) + 2.0).ceil() as usize);
        let end = last.saturating_add(1).min(grid.rows);
        let first = first.min(end);
        let cells = (end - first) * grid.cols;
        let mut heights = uniform(cells, f32::NAN)?;
        source.read(first, &mut heights)?;
        Ok(Self { grid, first, heights })
    }

    /// The height at a position, as [`height_at`]. NaN beyond the rows.
    pub fn height_at(&self, place: DVec2) -> f64 {
        let cols = self.grid.cols;
        height_by(&self.grid, place, |col, row| {
            let height = row.checked_sub(self.first).and_then(|row| self.heights.get(row * cols + col));
            height.copied().unwrap_or(f32::NAN)
        })
    }
}

/// The heights at positions, as [`height_at`].
///
/// # Errors
/// As [`RasterRows::read`].
pub fn heights_at_places(source: &dyn RasterRows, places: &[DVec2]) -> Result<Vec<f64>> {
    let row = |place: DVec2| source.grid().place(place).y.floor();
    let mut order: Vec<usize> = (0..places.len()).collect();
    // A file is read from its first row to its last.
    order.sort_by(|&a, &b| row(places[a]).total_cmp(&row(places[b])));
    let mut heights = vec![f64::NAN; places.len()];
    for same in order.chunk_by(|&a, &b| row(places[a]) == row(places[b])) {
        let ys = same.iter().map(|&k| places[k].y);
        let strip =
            Strip::read(source, (ys.clone().fold(f64::INFINITY, f64::min), ys.fold(f64::NEG_INFINITY, f64::max)))?;
        same.iter().for_each(|&k| heights[k] = strip.height_at(places[k]));
    }
    Ok(heights)
}

/// The heights of `dem` at the cell centres of another grid, see [`height_at`]. `to_dem` converts a position on `grid`
/// to the coordinates of `dem`.
pub fn heights_between(dem: &Dem, grid: &Grid, to_dem: &(impl Fn(DVec2) -> Option<DVec2> + Sync)) -> Vec<f32> {
    let height = |i: usize| {
        let place = to_dem(grid.center(i % grid.cols, i / grid.cols));
        place.map_or(f32::NAN, |place| height_at(dem, place) as f32)
    };
    parallel::values(grid.len(), height)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn dem() -> Dem {
        let grid = Grid { corner: DVec2::new(100.0, 200.0), cell: DVec2::new(10.0, 20.0), cols: 4, rows: 3 };
        let values = (0..12).map(|i| (i % 4) as f32 * 2.0 - (i / 4) as f32 * 8.0).collect();
        Dem { grid, values, crs: None }
    }

    #[test]
    fn a_plane_is_met_between_centres() {
        let dem = dem();
        let height = |x, y| height_at(&dem, DVec2::new(x, y));
        assert_eq!(height(105.0, 190.0), 0.0);
        assert!((height(111.0, 184.0) - (0.6 * 2.0 - 0.3 * 8.0)).abs() < 1e-12);
        assert_eq!(height(135.0, 150.0), 6.0 - 16.0);
        assert!(height(104.0, 190.0).is_nan() && height(120.0, 195.0).is_nan() && height(f64::NAN, 190.0).is_nan());
    }

    #[test]
    fn rows_on_demand_give_the_same_heights() {
        let dem = dem();
        let places: Vec<DVec2> = (0..400)
            .map(|k| DVec2::new(95.0 + f64::from(k * 7 % 53), 205.0 - f64::from(k * 13 % 71)))
            .chain([DVec2::NAN, DVec2::splat(1e300), DVec2::splat(-1e300)])
            .collect();
        let heights = heights_at_places(&dem, &places).unwrap();
        let expected = places.iter().map(|place| height_at(&dem, *place));
        assert!(heights.iter().zip(expected).all(|(a, b)| a.to_bits() == b.to_bits() || (a.is_nan() && b.is_nan())));
    }

    #[test]
    fn a_hole_spoils_what_needs_it_only() {
        let mut dem = dem();
        dem.values[5] = f32::NAN;
        let height = |x, y| height_at(&dem, DVec2::new(x, y));
        assert!(height(115.0, 170.0).is_nan() && height(112.0, 172.0).is_nan());
        // On the centre beside the hole, and on the line between two cells with heights.
        assert_eq!(height(105.0, 170.0), -8.0);
        assert_eq!(height(110.0, 190.0), 1.0);
    }

    #[test]
    fn the_own_grid_gives_the_own_heights() {
        let mut dem = dem();
        dem.values[6] = f32::NAN;
        let same = heights_between(&dem, &dem.grid, &Some);
        assert!(same.iter().zip(&dem.values).all(|(a, b)| a.to_bits() == b.to_bits() || (a.is_nan() && b.is_nan())));
        let empty = Dem { grid: Grid { cols: 0, rows: 0, ..dem.grid }, values: vec![], crs: None };
        assert!(heights_between(&empty, &dem.grid, &Some).iter().all(|h| h.is_nan()));
    }
}
