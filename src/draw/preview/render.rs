//! The picture of a map from above.

use glam::DVec2;
use image::RgbImage;
use rayon::prelude::*;
use tiny_skia::{Pixmap, Rect};

use super::canvas::{image_of, pixmap};
use super::color::{self, INK, PAPER, Tint};
use super::sheet::{MARGIN, MAX_COLS, MAX_ROWS, MIN_LEGEND, sheet};
use super::text::Typesetter;
use super::view::Preview;
use super::{legend, lines, patches};
use crate::base::Grid;
use crate::base::error::{Error, Result};
use crate::dem::Dem;
use crate::dem::shade::{ShadeParams, hillshade, steepness};

/// Heights are scaled until the median slope is about this steep, because its hillshade has a good contrast.
const GOOD_SLOPE: f64 = 0.42;
/// The greatest factor on heights.
const EXAGGERATION: (f64, f64) = (0.6, 8.0);

/// Draws the picture.
///
/// # Errors
/// A surface whose size is not one that [`map_grid`](super::map_grid) gives.
pub fn render(input: &Preview<'_>) -> Result<RgbImage> {
    let grid = input.dem.grid;
    let too_large = grid.cols > MAX_COLS || grid.rows > MAX_ROWS[0];
    if too_large || grid.is_empty() || input.dem.values.len() != grid.len() {
        return Err(Error::Parameter(format!(
            "a picture's map has 1 x 1 to {MAX_COLS} x {} cells, one a pixel; this surface has {} x {}",
            MAX_ROWS[0], grid.cols, grid.rows
        )));
    }
    let range = range(&input.dem.values);
    let mut map = relief(input.dem, range)?;
    if let Some(patches) = input.patches {
        patches::draw(&mut map, &grid, patches);
    }
    let covered = input.dem.values.iter().filter(|v| v.is_finite()).count();
    let plan = lines::plan(input.contours, &grid, covered.max(1) as f64);
    lines::draw(&mut map, &grid, input.contours, &plan, input.break_lines);

    let setter = Typesetter::new();
    let room = grid.cols.max(MIN_LEGEND);
    let blocks = legend::blocks(input, &plan, range, room as f32, &setter);
    let left = MARGIN + (room - grid.cols) / 2;
    let (mut sheet, top) = sheet(&map, &blocks, room, input.title, &setter)?;
    frame(&mut sheet, (left, top), &grid);
    Ok(image_of(&sheet))
}

/// The lowest and the highest height.
fn range(values: &[f32]) -> Option<(f64, f64)> {
    let finite = values.iter().copied().filter(|v| v.is_finite()).map(f64::from);
    finite.fold(None, |range, v| Some(range.map_or((v, v), |(low, high): (f64, f64)| (low.min(v), high.max(v)))))
}

/// The tinted and shaded surface.
fn relief(dem: &Dem, range: Option<(f64, f64)>) -> Result<Pixmap> {
    let mut map = pixmap(dem.grid.cols, dem.grid.rows)?;
    let metres_per_unit = dem.metres_per_unit().unwrap_or(DVec2::ONE);
    let exaggeration = exaggeration(&steepness(dem, metres_per_unit));
    let params = ShadeParams { exaggeration, metres_per_unit, ..ShadeParams::soft() };
    let (light, level) = (hillshade(dem, &params), params.level());
    let (low, high) = range.unwrap_or_default();
    let span = if high > low { high - low } else { 1.0 };
    let tint = Tint::new();
    map.data_mut().par_chunks_exact_mut(4).zip(&dem.values).zip(light).for_each(|((pixel, &height), light)| {
        let color = if height.is_finite() {
            color::shaded(tint.at((f64::from(height) - low) / span), f64::from(light) / level)
        } else {
            PAPER
        };
        pixel[..3].copy_from_slice(&color);
        pixel[3] = 255;
    });
    Ok(map)
}

/// The factor on the heights that gives the median slope a good contrast.
fn exaggeration(steepness: &[f32]) -> f64 {
    // Some thousand cells are enough to estimate the median.
    let stride = (steepness.len() / 20_000).max(1) | 1;
    let mut some: Vec<f32> = steepness.iter().step_by(stride).copied().filter(|v| v.is_finite()).collect();
    let middle = some.len() / 2;
    if some.is_empty() {
        return 1.0;
    }
    let (_, median, _) = some.select_nth_unstable_by(middle, f32::total_cmp);
    (GOOD_SLOPE / f64::from(*median).max(1e-9)).clamp(EXAGGERATION.0, EXAGGERATION.1)
}

/// The thin line around the map.
fn frame(sheet: &mut Pixmap, (left, top): (usize, usize), grid: &Grid) {
    let (x, y) = (left as f32 - 0.5, top as f32 - 0.5);
    if let Some(rect) = Rect::from_xywh(x, y, grid.cols as f32 + 1.0, grid.rows as f32 + 1.0) {
        let path = tiny_skia::PathBuilder::from_rect(rect);
        lines::stroke(sheet, Some(path), lines::Style { color: INK, width: 1.0, alpha: 1.0, dashes: None });
    }
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::*;
    use crate::contour::{ContourLine, Source};
    use crate::crs::Crs;
    use crate::draw::preview::{MAX_SIDE, Patch, PatchClass, Patches, map_grid};
    use crate::skeleton::{BreakKind, BreakLine, LineEnd};

    /// A round hill on the grid of its extent, with a hole in the north-west corner.
    fn hill(width: f64, height: f64) -> Dem {
        let grid = map_grid(DVec2::new(1000.0, 2000.0), DVec2::new(1000.0 + width, 2000.0 + height)).unwrap();
        let middle = DVec2::new(1000.0 + width / 2.0, 2000.0 + height / 2.0);
        let height_at = |i: usize| {
            let (col, row) = (i % grid.cols, i / grid.cols);
            if col < 40 && row < 40 { f32::NAN } else { (100.0 - grid.center(col, row).distance(middle) / 10.0) as f32 }
        };
        Dem { grid, values: (0..grid.len()).map(height_at).collect(), crs: Some(Crs { epsg: Some(6690), wkt: None }) }
    }

    fn line(elevation: f64, points: &[(f64, f64)], source: Source) -> ContourLine {
        let points = points.iter().map(|&(x, y)| DVec2::new(x, y)).collect();
        ContourLine { elevation, points, source, index: elevation == 50.0, depression: false, expected: None }
    }

    #[test]
    fn the_grid_covers_the_extent_and_fits_the_picture() {
        for (width, height) in
            [(4000.0, 3000.0), (1.0, 1.0), (3.0, 4000.0), (1e7, 2.0), (0.013, 0.02), (1234.5, 1100.1)]
        {
            let (min, max) = (DVec2::new(-7.0, 36.0), DVec2::new(-7.0 + width, 36.0 + height));
            let grid = map_grid(min, max).unwrap();
            assert!(grid.cols <= MAX_COLS && grid.rows <= MAX_ROWS[0] && !grid.is_empty());
            let far = grid.corner + DVec2::new(grid.cols as f64, -(grid.rows as f64)) * grid.cell;
            let slack = grid.cell.x * 1e-6;
            assert!(far.x >= max.x - slack && far.y <= min.y + slack, "{grid:?}");
        }
        assert!(map_grid(DVec2::ZERO, DVec2::new(1.0, 0.0)).is_err());
        assert!(map_grid(DVec2::ZERO, DVec2::new(f64::NAN, 1.0)).is_err());
        assert!(map_grid(DVec2::ONE, DVec2::ZERO).is_err());
    }

    #[test]
    fn pictures_of_any_shape_stay_within_their_size_and_show_what_they_are_given() {
        for (width, height) in [(400.0, 300.0), (300.0, 400.0), (40.0, 400.0), (400.0, 20.0), (300.0, 300.0)] {
            let dem = hill(width, height);
            let (x, y) = (1000.0 + width / 2.0, 2000.0 + height / 2.0);
            let contours = [
                line(50.0, &[(x - 9.0, y), (x + 9.0, y)], Source::Input),
                line(40.0, &[(x, y), (f64::NAN, y), (1e300, -1e300)], Source::Interpolated),
                line(f64::NAN, &[(x, y)], Source::Interpolated),
                line(60.0, &[], Source::Input),
            ];
            let points = vec![DVec3::new(1000.0, y - 2.0, 5.0), DVec3::new(1000.0 + width, y - 2.0, 5.0)];
            let far = DVec2::new(1000.0 + width, 2000.0 + height);
            let class = PatchClass { name: "bottom of a basin".into(), color: [40, 60, 150] };
            let rings =
                vec![vec![DVec2::new(1000.0, 2000.0), DVec2::new(far.x, 2000.0), far, DVec2::new(1000.0, far.y)]];
            let areas = (0..8).map(|class| Patch { class, rings: rings.clone() }).collect();
            let patches = Patches { classes: vec![class; 8], areas };
            let ends = [LineEnd::Peak, LineEnd::Contour];
            let ridge = BreakLine { kind: BreakKind::Ridge, points, region: 0, ends, network: 0 };
            let picture = Preview {
                dem: &dem,
                contours: &contours,
                break_lines: &[ridge],
                patches: Some(&patches).filter(|_| width != height),
                title: Some("Hill 丘"),
            };
            let image = render(&picture).unwrap();
            assert!(image.width().max(image.height()) <= MAX_SIDE as u32, "{}x{}", image.width(), image.height());
            let red = |p: &image::Rgb<u8>| p.0[0] > 150 && p.0[1] < 90 && p.0[2] < 90;
            assert!(image.pixels().filter(|p| red(p)).count() >= dem.grid.cols / 2);
            assert_eq!(image, render(&picture).unwrap());
        }
    }

    #[test]
    fn cells_without_data_are_paper_and_others_are_not() {
        let dem = hill(400.0, 300.0);
        let image =
            render(&Preview { dem: &dem, contours: &[], break_lines: &[], patches: None, title: None }).unwrap();
        let at = |col: u32, row: u32| image.get_pixel(MARGIN as u32 + col, MARGIN as u32 + row).0;
        assert_eq!(at(10, 10), PAPER);
        assert_ne!(at(60, 60), PAPER);
    }

    #[test]
    fn the_picture_is_the_same_for_any_number_of_threads() {
        let dem = hill(400.0, 300.0);
        let images = [1, 3].map(|threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| render(&Preview { dem: &dem, contours: &[], break_lines: &[], patches: None, title: None }))
                .unwrap()
        });
        assert!(images[0] == images[1]);
    }

    #[test]
    fn surfaces_without_heights_or_of_a_wrong_size() {
        let mut dem = hill(400.0, 300.0);
        dem.values.fill(f32::NAN);
        let render = |dem: &Dem| render(&Preview { dem, contours: &[], break_lines: &[], patches: None, title: None });
        assert!(render(&dem).is_ok());
        dem.values.pop();
        assert!(matches!(render(&dem), Err(Error::Parameter(_))));
        dem.values.clear();
        (dem.grid.cols, dem.grid.rows) = (0, 0);
        assert!(render(&dem).is_err());
        (dem.grid.cols, dem.grid.rows) = (MAX_COLS + 1, 1);
        dem.values = vec![0.0; MAX_COLS + 1];
        assert!(render(&dem).is_err());
    }
}
