//! Volumes between heights and level planes: cut and fill, and the storage of a reservoir.
//!
//! Each cell counts with the height at its centre and with its area on the ground. The cells are sorted once; then each level
//! is a search and two sums.

use crate::base::error::{Error, Result};
use crate::raster::{Dem, GroundScale};

/// A cell: its height, or the difference of two heights.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Cell {
    /// Metres.
    height: f64,
    /// Square metres.
    area: f64,
    /// Standard error of the height, metres; NaN if it is not known.
    sigma: f64,
}

/// Heights of cells, ready for volumes.
#[derive(Debug, Clone, PartialEq)]
pub struct Heights {
    /// Heights in ascending order, metres.
    heights: Vec<f64>,
    /// Sums over the cells before each one, and over all.
    sums: Vec<Sums>,
    /// Area over which errors of heights are alike, square metres, if it is known.
    alike: Option<f64>,
}

#[derive(Debug, Clone, Copy, PartialEq, Default)]
struct Sums {
    area: f64,
    volume: f64,
    /// Areas times standard errors, and times their squares.
    sigma: f64,
    variance: f64,
}

/// The volumes above and below a level.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
pub struct Volume {
    /// The level, metres.
    pub level: f64,
    /// Volume of the ground above the level, cubic metres: it has to be cut away.
    pub cut: f64,
    /// Volume between the ground and the level above it, cubic metres: it has to be filled, or holds water.
    pub fill: f64,
    /// Area of the ground above the level, square metres.
    pub cut_area: f64,
    /// Area of the ground below the level, square metres.
    pub fill_area: f64,
    /// Errors of `cut`, `fill` and `net`.
    pub errors: Option<[VolumeError; 3]>,
}

/// The error of a volume, from those of the heights, cubic metres.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
pub struct VolumeError {
    /// The standard error, if it is known over which area errors of heights are alike.
    pub likely: Option<f64>,
    /// The error if all heights are wrong by their standard error, in the same direction.
    pub most: f64,
}

impl Volume {
    /// Cut minus fill, cubic metres.
    pub fn net(&self) -> f64 {
        self.cut - self.fill
    }

    /// The area of all cells, square metres.
    pub fn area(&self) -> f64 {
        self.cut_area + self.fill_area
    }
}

impl Heights {
    /// The heights of a height map; cells without data do not count. `errors` are standard errors of the cells, metres.
    /// Errors are alike over `reach` metres, if that is known.
    ///
    /// # Errors
    /// [`Error::Data`] if no cell has a height.
    pub fn of(dem: &Dem, errors: Option<&[f32]>, reach: Option<f64>) -> Result<Self> {
        let scale = GroundScale::of(dem);
        let cols = dem.grid.cols.max(1);
        let cell = |(i, &height): (usize, &f32)| {
            let size = dem.grid.cell * scale.row(i / cols);
            let sigma = errors.and_then(|errors| errors.get(i)).map_or(f64::NAN, |sigma| f64::from(*sigma));
            Cell { height: f64::from(height), area: size.x * size.y, sigma }
        };
        let cells = dem.values.iter().enumerate().filter(|(_, height)| height.is_finite()).map(cell);
        Self::of_cells(cells.collect(), reach)
    }

    /// Heights of A above B, as [`Heights::of`]. Both are on one grid. Volumes at the level 0 are those of the cut and the fill
    /// that turn A into B.
    ///
    /// # Errors
    /// [`Error::Parameter`] if the grids differ, and as [`Heights::of`].
    pub fn between(a: &Dem, b: &Dem, errors: Option<&[f32]>, reach: Option<f64>) -> Result<Self> {
        if a.grid != b.grid || a.values.len() != b.values.len() {
            return Err(Error::Parameter("volumes between two height maps need the same cells in both".into()));
        }
        let values = a.values.iter().zip(&b.values).map(|(a, b)| (f64::from(*a) - f64::from(*b)) as f32).collect();
        Self::of(&Dem { grid: a.grid, values, crs: a.crs.clone().or_else(|| b.crs.clone()) }, errors, reach)
    }

    fn of_cells(mut cells: Vec<Cell>, reach: Option<f64>) -> Result<Self> {
        if cells.is_empty() {
            return Err(Error::Data("no cell has a height there, so there is no volume".into()));
        }
        cells.sort_unstable_by(|a, b| a.height.total_cmp(&b.height));
        let mut sum = Sums::default();
        let mut sums = vec![sum];
        for cell in &cells {
            sum.area += cell.area;
            sum.volume += cell.area * cell.height;
            sum.sigma += cell.area * cell.sigma;
            sum.variance += cell.area * cell.sigma * cell.sigma;
            sums.push(sum);
        }
        Ok(Self {
            heights: cells.iter().map(|cell| cell.height).collect(),
            sums,
            alike: reach.map(|reach| reach * reach),
        })
    }

    /// The volumes above and below a level, metres.
    pub fn at(&self, level: f64) -> Volume {
        let below = self.sums[self.heights.partition_point(|height| *height < level)];
        let all = self.sums.last().copied().unwrap_or_default();
        let above = Sums {
            area: all.area - below.area,
            volume: all.volume - below.volume,
            sigma: all.sigma - below.sigma,
            variance: all.variance - below.variance,
        };
        let error = |of: Sums| {
            let most = of.sigma.max(0.0);
            // The mean of n independent errors is smaller by the root of n. There is one at least. Where large errors lie in
            // one place, the mean error of the whole area would be too many, but no error is larger than all in one direction.
            let of_means = |alike: f64| (of.variance.max(0.0) * alike.min(of.area.max(0.0))).sqrt();
            VolumeError { likely: self.alike.map(|alike| of_means(alike).min(most)), most }
        };
        let errors = all.sigma.is_finite().then(|| [error(above), error(below), error(all)]);
        Volume {
            level,
            cut: (above.volume - level * above.area).max(0.0),
            fill: (level * below.area - below.volume).max(0.0),
            cut_area: above.area.max(0.0),
            fill_area: below.area,
            errors,
        }
    }

    /// The lowest and the highest height, metres.
    pub fn range(&self) -> [f64; 2] {
        [self.heights.first(), self.heights.last()].map(|height| height.copied().unwrap_or(f64::NAN))
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use glam::DVec2;

    use super::*;
    use crate::base::Grid;

    /// Heights of a function on cells of a metre, 400 by 400 of them around the origin.
    fn dem(height: impl Fn(DVec2) -> f64) -> Dem {
        let grid = Grid { corner: DVec2::new(-200.0, 200.0), cell: DVec2::ONE, cols: 400, rows: 400 };
        let values = (0..grid.len()).map(|i| height(grid.center(i % grid.cols, i / grid.cols)) as f32).collect();
        Dem { grid, values, crs: None }
    }

    fn near(found: f64, wanted: f64) {
        assert!((found - wanted).abs() <= 0.005 * wanted.abs(), "{found} is not {wanted}");
    }

    #[test]
    fn a_cone_a_pyramid_and_a_wedge_have_their_volumes() {
        let cone = Heights::of(&dem(|p| 60.0 - 0.4 * p.length()), None, None).unwrap().at(10.0);
        near(cone.cut, PI * 125.0 * 125.0 * 50.0 / 3.0);
        near(cone.cut_area, PI * 125.0 * 125.0);
        let pyramid = Heights::of(&dem(|p| 60.0 - 0.5 * p.abs().max_element()), None, None).unwrap().at(0.0);
        near(pyramid.cut, 240.0 * 240.0 * 60.0 / 3.0);
        // A wedge from 0 in the west to 40 in the east: cut and fill at 10.
        let wedge = Heights::of(&dem(|p| (p.x + 200.0) * 0.1), None, None).unwrap().at(10.0);
        near(wedge.cut, 300.0 * 30.0 / 2.0 * 400.0);
        near(wedge.fill, 100.0 * 10.0 / 2.0 * 400.0);
        near(wedge.net(), 400.0 * 400.0 * 10.0);
        assert_eq!((wedge.area(), wedge.fill_area), (160_000.0, 40_000.0));
    }

    #[test]
    fn water_in_a_bowl_grows_with_the_level() {
        let bowl = Heights::of(&dem(|p| 700.0 + p.length_squared() / 500.0), None, None).unwrap();
        assert_eq!(bowl.at(699.0).fill, 0.0);
        for depth in [5.0, 20.0, 60.0] {
            // A paraboloid holds half of its cylinder.
            near(bowl.at(700.0 + depth).fill, PI * 500.0 * depth * depth / 2.0);
        }
    }

    #[test]
    fn two_height_maps_are_cut_and_filled() {
        let (a, b) = (dem(|p| p.x * 0.1), dem(|_| 0.0));
        let found = Heights::between(&a, &b, None, None).unwrap().at(0.0);
        near(found.cut, 200.0 * 20.0 / 2.0 * 400.0);
        assert!((found.cut - found.fill).abs() < 1.0 && found.errors.is_none());
        let other = Dem { grid: Grid { cols: 200, rows: 800, ..a.grid }, ..b };
        assert!(matches!(Heights::between(&a, &other, None, None), Err(Error::Parameter(_))));
        assert!(matches!(Heights::of(&dem(|_| f64::NAN), None, None), Err(Error::Data(_))));
    }

    #[test]
    fn errors_are_smaller_where_they_are_independent() {
        let (level, sigma) = (dem(|_| 5.0), vec![0.5; 160_000]);
        let [cut, fill, net] = Heights::of(&level, Some(&sigma), Some(40.0)).unwrap().at(0.0).errors.unwrap();
        // 100 areas of 40 m by 40 m are independent.
        assert_eq!(net.most, 80_000.0);
        near(net.likely.unwrap(), 8_000.0);
        assert_eq!((cut, fill.most), (net, 0.0));
        let unknown = Heights::of(&level, Some(&sigma), None).unwrap().at(0.0).errors.unwrap();
        assert_eq!(unknown[2].likely, None);
        // All of the error lies in a hundredth of the area, and errors are alike over a quarter of it.
        let in_one_place: Vec<f32> = (0..160_000).map(|k| if k < 1600 { 5.0 } else { 0.0 }).collect();
        let placed = Heights::of(&level, Some(&in_one_place), Some(200.0)).unwrap().at(0.0).errors.unwrap();
        assert_eq!((placed[2].likely, placed[2].most), (Some(8_000.0), 8_000.0));
    }
}
