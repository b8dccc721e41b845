//! Heights on the pixels of map tiles, at all zooms.
//!
//! A pixel of a lower zoom is the mean of the heights of the two by two pixels below it. Colours are made of heights last: the
//! mean of two colours is another height. Map libraries know no pixel without a height, they would show a hole of some
//! kilometres there. So such pixels get heights from the lower zooms around them.

use glam::DVec2;

use super::mercator::{HALF_WIDTH, TilePlace, tile_size};
use crate::base::error::{Error, Result};
use crate::base::parallel;
use crate::raster::Dem;

/// Most that cells may lie beside the pixels of tiles, as a share of a pixel.
const BESIDE: f64 = 1e-3;

/// The heights of a zoom.
#[derive(Debug, Clone, PartialEq)]
pub struct ZoomHeights {
    /// The zoom.
    pub zoom: u8,
    /// Pixels from the west and the north edge of the map to the first one.
    first: [i64; 2],
    cols: usize,
    rows: usize,
    /// The heights, metres, row by row from the north.
    values: Vec<f32>,
    /// Whether each height is that of the height map.
    is_known: Vec<bool>,
    /// Pixels of a tile's side.
    side: usize,
}

/// The heights of all zooms from `lowest` to `zoom`, in this order. The cells of the height map are the pixels of the highest
/// zoom, where a tile's side has `side` of them.
///
/// # Errors
/// The cells are not those pixels, or none has a height.
pub fn zoom_heights(dem: &Dem, zoom: u8, lowest: u8, side: usize) -> Result<Vec<ZoomHeights>> {
    let pixel = tile_size(zoom) / side as f64;
    let from_edge = DVec2::new(dem.grid.corner.x + HALF_WIDTH, HALF_WIDTH - dem.grid.corner.y) / pixel;
    let beside = (from_edge - from_edge.round()).abs().max_element();
    if beside > BESIDE || (dem.grid.cell - pixel).abs().max_element() > BESIDE * pixel / dem.grid.cols.max(1) as f64 {
        return Err(Error::Parameter("the cells of the height map are not the pixels of tiles".into()));
    }
    if dem.values.iter().all(|height| height.is_nan()) {
        return Err(Error::Data("no cell of the height map has a height, so there is no tile to write".into()));
    }
    let first = from_edge.round().to_array().map(|c| c as i64);
    let is_known = dem.values.iter().map(|height| !height.is_nan()).collect();
    let (cols, rows) = (dem.grid.cols, dem.grid.rows);
    let mut all = vec![ZoomHeights { zoom, first, cols, rows, values: dem.values.clone(), is_known, side }];
    // Below the lowest zoom, pixels become so large that each has a known height in it.
    while let Some(last) =
        all.last().filter(|last| last.zoom > 0 && (last.zoom > lowest || last.is_known.contains(&false)))
    {
        let coarser = last.coarser();
        all.push(coarser);
    }
    all.reverse();
    all[0].fill_with_mean();
    for k in 1..all.len() {
        let (below, above) = all.split_at_mut(k);
        above[0].fill_from(&below[k - 1]);
    }
    all.retain(|heights| heights.zoom >= lowest);
    Ok(all)
}

impl ZoomHeights {
    /// The next lower zoom. NaN where no pixel below has a height.
    fn coarser(&self) -> Self {
        let first = self.first.map(|c| c.div_euclid(2));
        let last = [self.cols, self.rows].map(|n| n as i64 - 1);
        let size = |axis: usize| ((self.first[axis] + last[axis]).div_euclid(2) - first[axis] + 1) as usize;
        let (cols, rows) = (size(0), size(1));
        let mean = |col: usize, row: usize| {
            let begin = [col, row].map(|k| k as i64 * 2);
            let (mut sum, mut count) = (0.0, 0);
            for (x, y) in [(0, 0), (1, 0), (0, 1), (1, 1)] {
                let x = 2 * first[0] + begin[0] + x - self.first[0];
                let y = 2 * first[1] + begin[1] + y - self.first[1];
                if x < 0 || y < 0 || x > last[0] || y > last[1] {
                    continue;
                }
                let height = self.values[y as usize * self.cols + x as usize];
                if !height.is_nan() {
                    (sum, count) = (sum + f64::from(height), count + 1);
                }
            }
            if count > 0 { (sum / f64::from(count)) as f32 } else { f32::NAN }
        };
        let values = parallel::cells(cols, rows, mean);
        let is_known = values.iter().map(|height| !height.is_nan()).collect();
        Self { zoom: self.zoom - 1, first, cols, rows, values, is_known, side: self.side }
    }

    fn fill_with_mean(&mut self) {
        let known = || self.values.iter().filter(|height| !height.is_nan());
        let mean = known().map(|height| f64::from(*height)).sum::<f64>() / known().count().max(1) as f64;
        self.values.iter_mut().filter(|height| height.is_nan()).for_each(|height| *height = mean as f32);
    }

    /// Fills pixels without a height from the filled ones of the next lower zoom, between their centres.
    fn fill_from(&mut self, lower: &Self) {
        let (first, cols) = (self.first, self.cols);
        parallel::chunks(&mut self.values, cols, |row, heights| {
            for (col, height) in heights.iter_mut().enumerate().filter(|(_, height)| height.is_nan()) {
                let place = [(first[0] + col as i64, 0), (first[1] + row as i64, 1)]
                    .map(|(pixel, axis)| (pixel as f64 + 0.5) / 2.0 - 0.5 - lower.first[axis] as f64);
                *height = lower.between(place) as f32;
            }
        });
    }

    /// The height between the centres of pixels, columns and rows from the first.
    fn between(&self, place: [f64; 2]) -> f64 {
        let at = |x: f64, y: f64| {
            let x = x.clamp(0.0, self.cols as f64 - 1.0) as usize;
            let y = y.clamp(0.0, self.rows as f64 - 1.0) as usize;
            f64::from(self.values[y * self.cols + x])
        };
        let [x, y] = place.map(f64::floor);
        let (u, v) = (place[0] - x, place[1] - y);
        let line = |y: f64| at(x, y) * (1.0 - u) + at(x + 1.0, y) * u;
        line(y) * (1.0 - v) + line(y + 1.0) * v
    }

    /// The tiles that have a known height, from the north, row by row.
    pub fn tiles(&self) -> Vec<TilePlace> {
        let side = self.side as i64;
        let range = |axis: usize, count: usize| {
            let most = (1_i64 << self.zoom) - 1;
            let last = self.first[axis] + count as i64 - 1;
            self.first[axis].div_euclid(side).max(0)..=last.div_euclid(side).min(most)
        };
        let places = range(1, self.rows).flat_map(|y| range(0, self.cols).map(move |x| (x, y)));
        let places = places.map(|(x, y)| TilePlace { zoom: self.zoom, x: x as u32, y: y as u32 });
        places.filter(|tile| self.pixels(*tile).any(|(_, is_known)| is_known)).collect()
    }

    /// The heights of a tile, row by row from the north, and whether each is known. Beyond the height map, they are those of
    /// its nearest pixel.
    pub fn pixels(&self, tile: TilePlace) -> impl Iterator<Item = (f32, bool)> + '_ {
        let side = self.side as i64;
        let corner = [tile.x, tile.y].map(|k| i64::from(k) * side);
        let count = [self.cols, self.rows].map(|n| n as i64);
        (0..side * side).map(move |k| {
            let place = [k % side + corner[0] - self.first[0], k / side + corner[1] - self.first[1]];
            let [x, y] = [place[0].clamp(0, count[0] - 1), place[1].clamp(0, count[1] - 1)];
            let index = y as usize * self.cols + x as usize;
            (self.values[index], [x, y] == place && self.is_known[index])
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::Grid;
    use crate::crs::Crs;

    /// A plane in Web Mercator, with a hole.
    fn dem(zoom: u8, side: usize) -> Dem {
        let pixel = tile_size(zoom) / side as f64;
        let grid = Grid {
            corner: DVec2::new(901.0 * pixel - HALF_WIDTH, HALF_WIDTH - 777.0 * pixel),
            cell: DVec2::splat(pixel),
            cols: 150,
            rows: 90,
        };
        let height = |k: usize| match (k % 150, k / 150) {
            (20..60, 20..60) => f32::NAN,
            (col, row) => 100.0 + 4.0 * col as f32 - row as f32,
        };
        Dem { grid, values: (0..150 * 90).map(height).collect(), crs: Some(Crs::from_epsg(3857)) }
    }

    #[test]
    fn lower_zooms_are_means_and_holes_are_filled_between_their_sides() {
        let dem = dem(9, 16);
        let all = zoom_heights(&dem, 9, 5, 16).unwrap();
        assert_eq!(all.iter().map(|level| level.zoom).collect::<Vec<_>>(), [5, 6, 7, 8, 9]);
        let (low, high) = (100.0 - 89.0, 100.0 + 4.0 * 149.0);
        for level in &all {
            assert!(level.values.iter().all(|height| (low..=high).contains(height)), "zoom {}", level.zoom);
        }
        // Column 901 is the right one of a pair, 902 and 903 are one pixel of the zoom below; the same of rows 778 and 779.
        let mean = (104.0 - 1.0 + 108.0 - 1.0 + 104.0 - 2.0 + 108.0 - 2.0) / 4.0;
        assert_eq!(all[3].values[all[3].cols + 1], mean);
        for (height, known) in dem.values.iter().zip(&all[4].values) {
            assert!(height.is_nan() || height == known);
        }
        let middle = all[4].values[40 * 150 + 40];
        assert!((middle - 220.0).abs() < 40.0, "{middle}");
    }

    #[test]
    fn tiles_hold_all_pixels_and_those_without_heights_are_left_out() {
        let mut dem = dem(9, 16);
        let all = zoom_heights(&dem, 9, 9, 16).unwrap();
        let tiles = all[0].tiles();
        let known: usize =
            tiles.iter().map(|tile| all[0].pixels(*tile).filter(|(_, is_known)| *is_known).count()).sum();
        assert_eq!(known, 150 * 90 - 40 * 40);
        let cover = (901 / 16..=1050 / 16, 777 / 16..=866 / 16);
        let whole: Vec<u32> = tiles.iter().map(|tile| tile.x).collect();
        assert!(whole.iter().all(|x| cover.0.contains(x)) && tiles.iter().all(|tile| cover.1.contains(&tile.y)));
        assert_eq!(tiles.len(), 10 * 7 - 4, "four tiles in the hole are left out");
        dem.values.fill(f32::NAN);
        assert!(zoom_heights(&dem, 9, 9, 16).is_err());
        dem.values.fill(1.0);
        dem.grid.corner.x += 0.1 * dem.grid.cell.x;
        assert!(zoom_heights(&dem, 9, 9, 16).is_err());
    }
}
