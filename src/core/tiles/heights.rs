//! Heights on the pixels of map tiles, at all zooms.
//!
//! A pixel of a lower zoom is the mean of the heights of the two by two pixels below it. Colours are made of heights last: the
//! mean of two colours is another height. Map libraries know no pixel without a height, they would show a hole of some
//! kilometres there. So such pixels, also those beyond the height map, get heights from the lower zooms around them.

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
    /// Pixels from the west and the north edge of the map to the first one, which is the first of a tile.
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
    let mut all = vec![ZoomHeights::with_whole_tiles(zoom, side, first, [dem.grid.cols, dem.grid.rows], |col, row| {
        dem.values[row * dem.grid.cols + col]
    })];
    // At zoom 0, a pixel holds the mean of the whole map, for what lies far from it.
    for _ in 0..zoom {
        all.push(all[all.len() - 1].coarser());
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
    /// Heights of columns and rows from `first` on, with NaN around them up to the edges of tiles.
    fn with_whole_tiles(
        zoom: u8,
        side: usize,
        first: [i64; 2],
        size: [usize; 2],
        height: impl Fn(usize, usize) -> f32 + Sync,
    ) -> Self {
        let tile = side as i64;
        let begin = first.map(|c| c.div_euclid(tile) * tile);
        let count = |axis: usize| {
            let last = first[axis] + size[axis] as i64 - 1;
            ((last.div_euclid(tile) + 1) * tile - begin[axis]) as usize
        };
        let (cols, rows) = (count(0), count(1));
        let before = [0, 1].map(|axis| (first[axis] - begin[axis]) as usize);
        let values = parallel::cells(cols, rows, |col, row| {
            let place = [col.wrapping_sub(before[0]), row.wrapping_sub(before[1])];
            if place[0] < size[0] && place[1] < size[1] { height(place[0], place[1]) } else { f32::NAN }
        });
        let is_known = values.iter().map(|height| !height.is_nan()).collect();
        Self { zoom, first: begin, cols, rows, values, is_known, side }
    }

    /// The next lower zoom. NaN where no pixel below has a height.
    fn coarser(&self) -> Self {
        // Tiles have an even number of pixels, so the first pixel is the first of a pair.
        let mean = |col: usize, row: usize| {
            let pixels = [(0, 0), (1, 0), (0, 1), (1, 1)].map(|(x, y)| (2 * row + y) * self.cols + 2 * col + x);
            let known = pixels.into_iter().map(|k| self.values[k]).filter(|height| !height.is_nan());
            let (sum, count) = known.fold((0.0, 0), |(sum, count), height| (sum + f64::from(height), count + 1));
            if count > 0 { (sum / f64::from(count)) as f32 } else { f32::NAN }
        };
        let first = self.first.map(|c| c.div_euclid(2));
        Self::with_whole_tiles(self.zoom - 1, self.side, first, [self.cols / 2, self.rows / 2], mean)
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
            let first = self.first[axis].div_euclid(side);
            first.max(0)..(first + count as i64 / side).min(1 << self.zoom)
        };
        let places = range(1, self.rows).flat_map(|y| range(0, self.cols).map(move |x| (x, y)));
        let places = places.map(|(x, y)| TilePlace { zoom: self.zoom, x: x as u32, y: y as u32 });
        places.filter(|tile| self.pixels(*tile).any(|(_, is_known)| is_known)).collect()
    }

    /// The heights of a tile, row by row from the north, and whether each is that of the height map.
    pub fn pixels(&self, tile: TilePlace) -> impl Iterator<Item = (f32, bool)> + '_ {
        let side = self.side;
        let before =
            [(tile.x, 0), (tile.y, 1)].map(|(k, axis)| (i64::from(k) * side as i64 - self.first[axis]) as usize);
        let rows = (0..side).map(move |row| (before[1] + row) * self.cols + before[0]);
        rows.flat_map(move |first| first..first + side).map(|k| (self.values[k], self.is_known[k]))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::Grid;
    use crate::crs::Crs;

    impl ZoomHeights {
        /// The height of a pixel of the map.
        fn at(&self, place: [i64; 2]) -> f32 {
            self.values[(place[1] - self.first[1]) as usize * self.cols + (place[0] - self.first[0]) as usize]
        }
    }

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
        assert_eq!(all[3].at([902 / 2, 778 / 2]), mean);
        for (k, height) in dem.values.iter().enumerate() {
            assert!(height.is_nan() || *height == all[4].at([901 + k as i64 % 150, 777 + k as i64 / 150]));
        }
        let middle = all[4].at([901 + 40, 777 + 40]);
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
