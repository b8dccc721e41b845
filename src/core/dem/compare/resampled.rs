//! A height map on another grid of the same coordinate reference system, interpolated when its rows are read.

use std::sync::Arc;

use super::sample::Strip;
use crate::base::error::{Finding, Result};
use crate::base::{Grid, parallel};
use crate::crs::Crs;
use crate::raster::RasterRows;

/// Most cells of the source that are read at once, if one row needs no more.
const STRIP: usize = 1 << 21;

/// Heights of `source` at the cell centres of `grid`, bilinear between the cell centres of `source`.
#[derive(Debug)]
pub struct Resampled {
    /// The height map.
    pub source: Arc<dyn RasterRows>,
    /// The cells at whose centres heights are computed.
    pub grid: Grid,
    /// The coordinate reference system that is stated. Coordinates in it are those of `source`.
    pub crs: Option<Crs>,
}

impl Resampled {
    /// How many rows are computed at once.
    fn step(&self) -> usize {
        let source = self.source.grid();
        let cells = self.grid.cell.y / source.cell.y * source.cols as f64;
        ((STRIP as f64 / cells) as usize).max(1)
    }
}

impl RasterRows for Resampled {
    fn grid(&self) -> Grid {
        self.grid
    }

    fn crs(&self) -> Option<&Crs> {
        self.crs.as_ref()
    }

    fn read(&self, first: usize, heights: &mut [f32]) -> Result<()> {
        let (grid, step) = (&self.grid, self.step());
        for (k, rows) in heights.chunks_mut(step * grid.cols).enumerate() {
            let first = first + k * step;
            let last = first + rows.len() / grid.cols - 1;
            let strip = Strip::read(&*self.source, (grid.center(0, last).y, grid.center(0, first).y))?;
            parallel::chunks(rows, grid.cols, |row, line| {
                for (col, height) in line.iter_mut().enumerate() {
                    *height = strip.height_at(grid.center(col, first + row)) as f32;
                }
            });
        }
        Ok(())
    }

    fn findings(&self) -> Vec<Finding> {
        self.source.findings()
    }
}

#[cfg(test)]
mod tests {
    use glam::DVec2;

    use super::super::heights_between;
    use super::*;
    use crate::raster::Dem;

    #[test]
    fn rows_are_those_of_the_whole() {
        let grid = Grid { corner: DVec2::new(10.0, 90.0), cell: DVec2::new(2.0, 3.0), cols: 30, rows: 25 };
        let mut values: Vec<f32> = (0..grid.len()).map(|i| ((i * i) % 97) as f32 * 0.1).collect();
        values[333] = f32::NAN;
        let dem = Dem { grid, values, crs: None };
        for cell in [0.7, 1.0, 2.5, 40.0] {
            let other = Grid { corner: DVec2::new(8.3, 95.1), cell: DVec2::splat(cell), cols: 33, rows: 41 };
            let expected = heights_between(&dem, &other, &Some);
            let rows = Resampled { source: Arc::new(dem.clone()), grid: other, crs: None };
            let mut found = vec![0.0; other.len()];
            found.chunks_mut(7 * other.cols).enumerate().for_each(|(k, part)| rows.read(7 * k, part).unwrap());
            let same = |(a, b): (&f32, &f32)| a.to_bits() == b.to_bits() || (a.is_nan() && b.is_nan());
            assert!(found.iter().zip(&expected).all(same), "{cell}");
        }
    }
}
