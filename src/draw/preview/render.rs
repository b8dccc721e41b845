//! The picture of a map from above.

use geo::MultiPolygon;
use glam::DVec2;
use image::RgbImage;
use rayon::prelude::*;
use tiny_skia::Pixmap;

use super::canvas::{image_of, pixmap};
use super::color::{self, BORDER, PAPER, Tint};
use super::plan::{Plan, plan};
use super::sheet::{Head, MARGIN, MAX_COLS, MAX_ROWS, MIN_LEGEND, sheet};
use super::stroke::{Style, path, stroke};
use super::text::Typesetter;
use super::view::Preview;
use super::{labels, legend, lines, margin, patches, skeleton_lines};
use crate::coordinates::{Notation, Ticks, ticks};
use crate::scale;
use tokosen_core::base::Grid;
use tokosen_core::base::error::{Error, Result};
use tokosen_core::crs::{Crs, Reprojection};
use tokosen_core::dem::shade::{ShadeParams, hillshade, steepness};
use tokosen_core::raster::Dem;

/// Heights are scaled until the median slope is about this steep, because its hillshade has a good contrast.
const GOOD_SLOPE: f64 = 0.42;
/// The greatest factor on heights.
const EXAGGERATION: (f64, f64) = (0.6, 8.0);

/// The border of a part of the map.
const OUTLINE: Style = Style { color: BORDER, width: 2.2, alpha: 1.0, dashes: None };

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
    let tint = tint(input.dem, input.levels);
    let mut map = relief(input.dem, tint.as_ref())?;
    if let Some(patches) = input.patches {
        patches::draw(&mut map, &grid, patches);
        blank(&mut map, input.dem, input.outline);
    }
    let covered = input.dem.values.iter().filter(|v| v.is_finite()).count();
    let plan = plan(input.contours, &grid);
    let size = (grid.cell.x, covered.max(1) as f64);
    let skeleton_lines = skeleton_lines::choose(input.skeleton_lines, input.frame, size, input.subject);
    let setter = Typesetter::new();
    let labels = labels::place(input.contours, &plan, &grid, input.units.heights, &setter);
    let gaps = labels::gaps(&labels, &grid);
    lines::draw(&mut map, &grid, input.contours, &plan, &skeleton_lines, gaps.as_ref());
    labels::draw(&mut map, &labels, &grid, &setter);
    outline(&mut map, &grid, input.outline);

    let room = grid.cols.max(MIN_LEGEND);
    let (head, remark) = head(input, &plan, room, &setter);
    let metres = input.dem.metres_per_unit().map(|m| m.x * grid.cell.x);
    let bar = scale::bar(grid.cols as f64, metres, grid.cell.x, input.units.heights);
    let scale = legend::Block::Scale { bar, arrow: Some(legend::Arrow), remark };
    let content = legend::Content {
        scale,
        plan: &plan,
        skeleton_lines: &skeleton_lines,
        patches: input.patches,
        tint: tint.as_ref(),
        units: input.units,
    };
    let blocks = legend::blocks(content, room as f32, &setter);
    let mut sheet = sheet(&map, &blocks, room, &head, &setter)?;
    let corner = (MARGIN + (room - grid.cols) / 2, head.top());
    let size = DVec2::new(grid.cols as f64, grid.rows as f64);
    let ticks = coordinates(input, size, grid.cell.x, grid.corner);
    margin::draw(&mut sheet, corner, (grid.cols, grid.rows), &ticks, &setter);
    Ok(image_of(&sheet))
}

/// Turns what was drawn outside of a part into paper again.
pub(crate) fn blank(map: &mut Pixmap, dem: &Dem, part: Option<&MultiPolygon<f64>>) {
    if part.is_some() {
        let [r, g, b] = PAPER;
        let pixels = map.data_mut().chunks_exact_mut(4).zip(&dem.values).filter(|(_, height)| height.is_nan());
        pixels.for_each(|(pixel, _)| pixel.copy_from_slice(&[r, g, b, 255]));
    }
}

/// Draws the border of a part.
fn outline(map: &mut Pixmap, grid: &Grid, part: Option<&MultiPolygon<f64>>) {
    let rings = part.into_iter().flatten().flat_map(|p| std::iter::once(p.exterior()).chain(p.interiors()));
    let lines = rings.map(|ring| ring.coords().map(|c| DVec2::new(c.x, c.y)));
    stroke(map, path(grid, lines), OUTLINE, None);
}

/// What the contours are, and the coordinate reference system.
pub(crate) fn notes(input: &Preview<'_>, plan: &Plan) -> [Option<String>; 2] {
    let interval =
        |class: &Option<_>| class.as_ref().and_then(super::plan::Class::interval).map(|z| input.units.height(z));
    let contours = match (interval(&plan.input), interval(&plan.interpolated)) {
        (Some(input), Some(new)) => Some(format!("Contours every {new}, from contours every {input}")),
        (Some(one), None) | (None, Some(one)) => Some(format!("Contours every {one}")),
        (None, None) => None,
    };
    let of_drawing = drawing(input).and_then(Reprojection::plane_of_drawing).and_then(legend::crs_label);
    let plane = || input.dem.crs.as_ref().and_then(legend::crs_label);
    let crs = match (degrees(input), of_drawing.or_else(plane)) {
        (Some((crs, _)), Some(plane)) => legend::crs_label(crs).map(|name| format!("{name}, drawn on {plane}")),
        (_, plane) => plane,
    };
    [contours, crs]
}

/// What stands above the map. If there is no room for the coordinate reference system, it is a remark in the legend.
fn head<'a>(input: &Preview<'a>, plan: &Plan, room: usize, setter: &Typesetter) -> (Head<'a>, Option<String>) {
    let [contours, crs] = notes(input, plan);
    let bare = Head { title: input.title, note: None };
    let both: Vec<&str> = contours.iter().chain(&crs).map(String::as_str).collect();
    let both = both.join("  ·  ");
    if !both.is_empty() && bare.has_room_for(&both, room, setter) {
        return (Head { note: Some(both), ..bare }, None);
    }
    let note = contours.filter(|note| bare.has_room_for(note, room, setter));
    (Head { note, ..bare }, crs)
}

/// The system in degrees that the input is in, and the conversion to it.
fn degrees<'a>(input: &Preview<'a>) -> Option<(&'a Crs, &'a Reprojection)> {
    let reprojection = input.reprojection?;
    let crs = reprojection.input_crs().filter(|crs| crs.is_geographic())?;
    let is_on_plane = input.dem.crs.as_ref().is_some_and(|crs| !crs.is_geographic());
    is_on_plane.then_some((crs, reprojection))
}

/// The conversion to the coordinates of a drawing in another unit than metres, for a picture on the plane in metres.
fn drawing<'a>(input: &Preview<'a>) -> Option<&'a Reprojection> {
    let is_on_plane = |known: &&Reprojection| known.working_crs() == input.dem.crs.as_ref();
    input.reprojection.filter(|known| known.plane_of_drawing().is_some()).filter(is_on_plane)
}

/// The coordinates along the edges of a map of some pixels, given the map units in a pixel and the upper left corner: degrees if
/// the input is in degrees, those of a drawing if it is one in another unit than metres, else those of the plane.
pub(crate) fn coordinates(input: &Preview<'_>, size: DVec2, pixel: f64, corner: DVec2) -> Ticks {
    let on_plane = |p: DVec2| corner + DVec2::new(p.x, -p.y) * pixel;
    if let Some((_, reprojection)) = degrees(input) {
        return ticks(size, Notation::Degrees, |p| reprojection.in_input(on_plane(p)));
    }
    if let Some(reprojection) = drawing(input) {
        return ticks(size, Notation::Plain, |p| reprojection.in_input(on_plane(p)));
    }
    ticks(size, Notation::of(input.dem.crs.as_ref()), |p| Some(on_plane(p)))
}

/// The tint from the lowest to the highest height, with bands between levels if there are some. `None` if there is no height.
pub(crate) fn tint(dem: &Dem, levels: &[f64]) -> Option<Tint> {
    let finite = dem.values.iter().copied().filter(|v| v.is_finite()).map(f64::from);
    let range =
        finite.fold(None, |range, v| Some(range.map_or((v, v), |(low, high): (f64, f64)| (low.min(v), high.max(v)))));
    range.map(|range| Tint::over(range, levels))
}

/// The tinted and shaded surface.
pub(crate) fn relief(dem: &Dem, tint: Option<&Tint>) -> Result<Pixmap> {
    let mut map = pixmap(dem.grid.cols, dem.grid.rows)?;
    let metres_per_unit = dem.metres_per_unit().unwrap_or(DVec2::ONE);
    let exaggeration = exaggeration(&steepness(dem, metres_per_unit));
    let params = ShadeParams { exaggeration, metres_per_unit, ..ShadeParams::soft() };
    let (light, level) = (hillshade(dem, &params), params.level());
    map.data_mut().par_chunks_exact_mut(4).zip(&dem.values).zip(light).for_each(|((pixel, &height), light)| {
        let color = match tint.filter(|_| height.is_finite()) {
            Some(tint) => color::shaded(tint.of(f64::from(height)), f64::from(light) / level),
            None => PAPER,
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

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::*;
    use crate::preview::{MAX_SIDE, Patch, PatchClass, Patches, map_grid};
    use tokosen_core::contour::{ContourLine, Source};
    use tokosen_core::crs::Crs;
    use tokosen_core::skeleton::{LineEnd, SkeletonKind, SkeletonLine};

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
        ContourLine {
            elevation,
            points,
            source,
            index: elevation == 50.0,
            kind: None,
            depression: false,
            expected: None,
        }
    }

    /// Whether a pixel has the purple of ridge lines, mixed with what lies below. Nothing else has it.
    fn is_ridge(pixel: &image::Rgb<u8>) -> bool {
        let [r, g, b] = pixel.0.map(i32::from);
        r > g + 30 && b > g + 20
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
            let ridge = SkeletonLine { kind: SkeletonKind::Ridge, points, region: 0, ends, network: 0 };
            let picture = Preview {
                skeleton_lines: &[ridge],
                patches: Some(&patches).filter(|_| width != height),
                title: Some("Hill 丘"),
                ..Preview::new(&dem, &contours)
            };
            let image = render(&picture).unwrap();
            assert!(image.width().max(image.height()) <= MAX_SIDE as u32, "{}x{}", image.width(), image.height());
            assert!(image.pixels().filter(|p| is_ridge(p)).count() >= dem.grid.cols / 2);
            assert_eq!(image, render(&picture).unwrap());
        }
    }

    #[test]
    fn ridge_lines_along_the_frame_are_not_drawn() {
        let dem = hill(400.0, 300.0);
        let corners = [(1000.0, 2000.0), (1400.0, 2000.0), (1400.0, 2300.0), (1000.0, 2300.0)];
        let corners = corners.map(|(x, y)| DVec2::new(x, y));
        let frame: Vec<[DVec2; 2]> = (0..4).map(|k| [corners[k], corners[(k + 1) % 4]]).collect();
        let ridge = |points: &[(f64, f64)]| SkeletonLine {
            kind: SkeletonKind::Ridge,
            points: points.iter().map(|&(x, y)| DVec3::new(x, y, 5.0)).collect(),
            region: 0,
            ends: [LineEnd::Frame; 2],
            network: 0,
        };
        let drawn = |ridge: SkeletonLine| {
            let image =
                render(&Preview { skeleton_lines: &[ridge], frame: &frame, ..Preview::new(&dem, &[]) }).unwrap();
            // The legend is not a part of the map.
            let map = image.rows().take(MARGIN + 20 + dem.grid.rows).flatten();
            map.filter(|p| is_ridge(p)).count()
        };
        assert_eq!(drawn(ridge(&[(1000.0, 2000.0), (1400.0, 2000.0), (1400.0, 2300.0)])), 0);
        assert_eq!(drawn(ridge(&[(1000.0, 2001.0), (1200.0, 2002.0), (1399.0, 2001.0)])), 0);
        assert!(drawn(ridge(&[(1000.0, 2150.0), (1400.0, 2150.0)])) > dem.grid.cols / 2);
    }

    #[test]
    fn cells_without_data_are_paper_and_others_are_not() {
        let dem = hill(400.0, 300.0);
        let image = render(&Preview::new(&dem, &[])).unwrap();
        // The name of the system stands above the map.
        let top = Head { title: None, note: Some(String::new()) }.top() as u32;
        let at = |col: u32, row: u32| image.get_pixel(MARGIN as u32 + col, top + row).0;
        assert_eq!(at(10, 10), PAPER);
        assert_ne!(at(60, 60), PAPER);
    }

    #[test]
    fn the_picture_is_the_same_for_any_number_of_threads() {
        let dem = hill(400.0, 300.0);
        let images = [1, 3].map(|threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| render(&Preview::new(&dem, &[]))).unwrap()
        });
        assert!(images[0] == images[1]);
    }

    #[test]
    fn surfaces_without_heights_or_of_a_wrong_size() {
        let mut dem = hill(400.0, 300.0);
        dem.values.fill(f32::NAN);
        let render = |dem: &Dem| render(&Preview::new(dem, &[]));
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
