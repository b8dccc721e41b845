//! Pictures of height maps: hillshades and the map of differences, small enough for a page.

use std::ops::Range;

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use glam::DVec2;
use image::codecs::png::PngEncoder;
use image::{ExtendedColorType, ImageEncoder};

use tokosen_core::base::Grid;
use tokosen_core::base::error::{Error, Result};
use tokosen_core::dem::shade::{ShadeParams, hillshade};
use tokosen_core::raster::Dem;

/// Longest side of a picture, pixels.
const LONGEST: usize = 1000;
/// The colour of cells without data.
const VOID: [u8; 3] = [205, 205, 200];
/// Colours of differences from the lowest to the highest; the middle is 0. Most colour-blind people can distinguish
/// blue and red.
const STOPS: [[u8; 3]; 7] =
    [[24, 65, 130], [67, 130, 190], [160, 200, 224], [246, 246, 244], [245, 176, 142], [212, 94, 74], [130, 20, 40]];
/// Share of the hillshade in the map of differences.
const RELIEF: f64 = 0.35;

/// Cells per pixel, along each side.
pub(super) fn reduction(grid: &Grid) -> usize {
    grid.cols.max(grid.rows).div_ceil(LONGEST).max(1)
}

/// The columns and rows of a grid that are shown.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Window {
    pub cols: Range<usize>,
    pub rows: Range<usize>,
}

/// Width of the margin around the cells with data, as a share of the longer side of their bounding box.
const MARGIN: f64 = 0.05;

/// The bounding box of the cells with data.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct DataBox(Option<[usize; 4]>);

impl DataBox {
    /// Takes a row. `is_known` tells whether the cell in a column has data.
    pub fn add(&mut self, row: usize, cols: usize, is_known: impl Fn(usize) -> bool) {
        let Some(first) = (0..cols).find(|col| is_known(*col)) else { return };
        let last = (first..cols).rfind(|col| is_known(*col)).unwrap_or(first);
        let [west, east, north, _] = self.0.unwrap_or([first, last, row, row]);
        self.0 = Some([west.min(first), east.max(last), north, row]);
    }
}

impl Window {
    /// The bounding box of the cells with data, with a margin. Otherwise a small map would be a spot in its pictures.
    pub fn around(data: DataBox, Grid { cols, rows, .. }: &Grid) -> Self {
        let Some([west, east, north, south]) = data.0 else { return Self { cols: 0..*cols, rows: 0..*rows } };
        let margin = (MARGIN * (east - west + 1).max(south - north + 1) as f64).ceil() as usize;
        let with_margin =
            |low: usize, high: usize, count: usize| low.saturating_sub(margin)..(high + margin + 1).min(count);
        Self { cols: with_margin(west, east, *cols), rows: with_margin(north, south, *rows) }
    }

    /// Its cells.
    pub fn of(&self, grid: &Grid) -> Grid {
        let corner = grid.corner + DVec2::new(self.cols.start as f64, -(self.rows.start as f64)) * grid.cell;
        Grid { corner, cell: grid.cell, cols: self.cols.len(), rows: self.rows.len() }
    }
}

/// The mean heights of blocks of cells in a window; no side has more than [`LONGEST`] blocks.
#[derive(Debug)]
pub(super) struct Reduced {
    window: Window,
    step: usize,
    grid: Grid,
    /// The sum and the number of the heights of each block in the row of blocks that is not complete yet.
    sums: Vec<(f64, f64)>,
    values: Vec<f32>,
}

impl Reduced {
    pub fn new(grid: &Grid, window: &Window) -> Self {
        let shown = window.of(grid);
        let step = reduction(&shown);
        let Grid { corner, cell, cols, rows } = shown;
        let grid = Grid { corner, cell: cell * step as f64, cols: cols.div_ceil(step), rows: rows.div_ceil(step) };
        let sums = vec![(0.0, 0.0); grid.cols];
        Self { window: window.clone(), step, grid, sums, values: Vec::with_capacity(grid.len()) }
    }

    /// Takes a row. `height` gives the height in a column. Rows come in order.
    pub fn add(&mut self, row: usize, height: impl Fn(usize) -> f32) {
        let Window { cols, rows } = &self.window;
        if !rows.contains(&row) {
            return;
        }
        for (k, height) in cols.clone().map(height).enumerate().filter(|(_, height)| height.is_finite()) {
            let (sum, count) = &mut self.sums[k / self.step];
            *sum += f64::from(height);
            *count += 1.0;
        }
        if (row + 1 - rows.start).is_multiple_of(self.step) || row + 1 == rows.end {
            let mean = |(sum, count): (f64, f64)| if count > 0.0 { (sum / count) as f32 } else { f32::NAN };
            self.values.extend(self.sums.iter_mut().map(|sum| mean(std::mem::take(sum))));
        }
    }

    /// The map of the means, after the last row.
    pub fn map(self) -> Dem {
        Dem { grid: self.grid, values: self.values, crs: None }
    }
}

/// The hillshade of a reduced height map as a data URI.
pub(super) fn shaded(dem: &Dem, metres_per_unit: DVec2) -> Result<String> {
    let params = ShadeParams { metres_per_unit, ..ShadeParams::soft() };
    let pixels = hillshade(dem, &params).into_iter().flat_map(|light| {
        if light.is_nan() { VOID } else { [(f64::from(light) * 255.0).round().clamp(0.0, 255.0) as u8; 3] }
    });
    data_uri(&dem.grid, &pixels.collect::<Vec<u8>>())
}

/// The map of reduced differences, coloured from −limit to limit over the relief of `ground`, as a data URI.
pub(super) fn differences(difference: &Dem, ground: &Dem, limit: f64, metres_per_unit: DVec2) -> Result<String> {
    data_uri(&difference.grid, &difference_pixels(difference, ground, limit, metres_per_unit))
}

/// The red, green and blue of this map, cell by cell.
pub(super) fn difference_pixels(difference: &Dem, ground: &Dem, limit: f64, metres_per_unit: DVec2) -> Vec<u8> {
    let params = ShadeParams { metres_per_unit, ..ShadeParams::soft() };
    let level = params.level();
    let light = hillshade(ground, &params);
    let pixels = difference.values.iter().zip(light).flat_map(|(&d, light)| {
        if d.is_nan() {
            return VOID;
        }
        let relief = if light.is_nan() { 1.0 } else { 1.0 - RELIEF * (1.0 - f64::from(light) / level) };
        color(f64::from(d) / limit).map(|c| (f64::from(c) * relief).round().clamp(0.0, 255.0) as u8)
    });
    pixels.collect()
}

/// The colour of a share of the limit, −1 to 1.
pub(super) fn color(share: f64) -> [u8; 3] {
    let at = (share.clamp(-1.0, 1.0) + 1.0) / 2.0 * (STOPS.len() - 1) as f64;
    let first = (at as usize).min(STOPS.len() - 2);
    let weight = at - first as f64;
    std::array::from_fn(|i| {
        (f64::from(STOPS[first][i]) * (1.0 - weight) + f64::from(STOPS[first + 1][i]) * weight).round() as u8
    })
}

/// A picture of 8-bit colours, as PNG in a data URI.
fn data_uri(grid: &Grid, pixels: &[u8]) -> Result<String> {
    let mut bytes = Vec::new();
    let (width, height) = (grid.cols as u32, grid.rows as u32);
    PngEncoder::new(&mut bytes)
        .write_image(pixels, width, height, ExtendedColorType::Rgb8)
        .map_err(|e| Error::Data(format!("a picture of the report cannot be made: {e}")))?;
    Ok(format!("data:image/png;base64,{}", STANDARD.encode(bytes)))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn around_data(dem: &Dem) -> Window {
        let mut data = DataBox::default();
        let cols = dem.grid.cols;
        (0..dem.grid.rows).for_each(|row| data.add(row, cols, |col| dem.values[row * cols + col].is_finite()));
        Window::around(data, &dem.grid)
    }

    fn reduced(dem: &Dem, window: &Window) -> Dem {
        let mut reduced = Reduced::new(&dem.grid, window);
        (0..dem.grid.rows).for_each(|row| reduced.add(row, |col| dem.values[row * dem.grid.cols + col]));
        reduced.map()
    }

    #[test]
    fn large_height_maps_are_averaged() {
        let grid = Grid { corner: DVec2::ZERO, cell: DVec2::ONE, cols: 1501, rows: 3 };
        let mut values: Vec<f32> = (0..grid.len()).map(|i| (i % 1501) as f32).collect();
        values[0] = f32::NAN;
        let dem = Dem { grid, values, crs: None };
        let small = reduced(&dem, &Window { cols: 0..1501, rows: 0..3 });
        assert_eq!((small.grid.cols, small.grid.rows, small.grid.cell), (751, 2, DVec2::splat(2.0)));
        assert_eq!((small.values[0], small.values[1], small.values[750]), (2.0 / 3.0, 2.5, 1500.0));
    }

    #[test]
    fn pictures_are_of_the_cells_with_data() {
        let grid = Grid { corner: DVec2::new(100.0, 50.0), cell: DVec2::new(2.0, 3.0), cols: 40, rows: 30 };
        let inside = |i: usize| (10..30).contains(&(i % 40)) && (28..30).contains(&(i / 40));
        let values = (0..grid.len()).map(|i| if inside(i) { i as f32 } else { f32::NAN }).collect();
        let dem = Dem { grid, values, crs: None };
        // A cell of margin around 20 x 2 cells, and none beyond the last row.
        let window = around_data(&dem);
        assert_eq!(window, Window { cols: 9..31, rows: 27..30 });
        let small = reduced(&dem, &window);
        assert_eq!(small.grid, Grid { corner: DVec2::new(118.0, -31.0), cols: 22, rows: 3, ..grid });
        assert_eq!((small.values[23], small.values[42]), ((28 * 40 + 10) as f32, (28 * 40 + 29) as f32));
        assert!(small.values[22].is_nan() && small.values[..22].iter().all(|v| v.is_nan()));
        let empty = Dem { values: vec![f32::NAN; grid.len()], ..dem };
        assert_eq!(around_data(&empty), Window { cols: 0..40, rows: 0..30 });
    }

    #[test]
    fn colours_run_from_blue_to_red_over_white() {
        assert_eq!((color(-2.0), color(0.0), color(1.0)), (STOPS[0], STOPS[3], STOPS[6]));
        assert_eq!(color(f64::NAN).len(), 3);
    }
}
