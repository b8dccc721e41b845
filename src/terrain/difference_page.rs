//! The terrain of a comparison in 3-D with the differences on it, as a page: [`difference_page`].

use glam::DVec2;

use super::compare::Pair;
use super::html::{MOST_CELLS, TOLERANCE, exaggeration};
use tokosen_core::base::error::{Error, Result};
use tokosen_core::base::progress::{Progress, step};
use tokosen_core::base::{Grid, Units};
use tokosen_core::contour::{ContourLayer, Target, clip_lines};
use tokosen_core::crs::{Transform, working_crs};
use tokosen_core::dem::compare::{Comparison, heights_between, round_limit};
use tokosen_core::layers::{LayerParams, contour_layers};
use tokosen_core::mesh::height_mesh;
use tokosen_core::raster::Dem;
use tokosen_core::slice::label_layers;
use tokosen_draw::terrain_page::{Differences, TerrainPage, terrain_page};

/// Largest distance of the triangles from the heights, as a share of the relief, if no contours say more.
const TOLERANCE_OF_RELIEF: f64 = 1.0 / 500.0;
/// How many of the largest differences have a pin.
const PINS: usize = 10;
/// Least distance of pins, as a share of the diagonal of the map.
const APART: f64 = 0.05;

/// A page that shows the terrain of A in 3-D, with the differences A − B as colours and pins at the largest of them: one HTML file,
/// which needs no other file and no network. If A is made from contours, these are drawn, too.
///
/// The page is on a plane in metres: that of the contours, if there are any. Cells of the comparison that are square and in metres
/// are those of the page, or every second, third, … of them if there are more than a million. From others, heights are interpolated.
///
/// # Errors
/// If no plane is known for the cells, a height map cannot be read, or no four neighbouring cells of A have heights.
pub fn difference_page(pair: &Pair, found: &Comparison, progress: &dyn Progress) -> Result<String> {
    let [heights, reference] = step(progress, "cells", || on_plane(pair))?;
    let differences = |(a, b): (&f32, &f32)| a - b;
    let values: Vec<f32> = heights.values.iter().zip(&reference.values).map(differences).collect();
    let relief = heights.values.iter().filter(|height| height.is_finite());
    let (low, high) = relief.fold((f32::MAX, f32::MIN), |(low, high), z| (low.min(*z), high.max(*z)));
    let of_relief = f64::from(high - low).max(1e-3) * TOLERANCE_OF_RELIEF;
    let tolerance = pair.interval().map_or(of_relief, |interval| TOLERANCE * interval.step);
    let mesh = step(progress, "triangles", || height_mesh(&heights, tolerance))?;

    let units = Units { heights: found.unit, ..Units::METRES };
    let contours = contours(pair, progress)?;
    let [lo, hi] = heights.corners();
    let labels = label_layers(&contours, None, (lo, hi), units.heights)?.pop().unwrap_or_default();
    let name = |side: &super::Side| side.source.file.file_name().unwrap_or_default().to_string_lossy().into_owned();
    Ok(terrain_page(&TerrainPage {
        title: &format!("{} − {}", name(&pair.a), name(&pair.b)),
        errors: None,
        differences: Some(Differences {
            places: largest(&heights.grid, &values),
            values,
            limit: found.unit.metres(round_limit(&found.overall)),
        }),
        water: None,
        mesh: &mesh,
        tolerance,
        contours: contours.first().map_or(&[], |layer| &layer.lines),
        labels: &labels,
        lines: Vec::new(),
        spots: Vec::new(),
        findings: &[],
        exaggeration: exaggeration(hi - lo, &mesh),
        units,
        heights: &heights,
    }))
}

/// The contours of A, if it is made from contours.
fn contours(pair: &Pair, progress: &dyn Progress) -> Result<Vec<ContourLayer>> {
    let Some(surface) = pair.a.surface() else { return Ok(Vec::new()) };
    let params = LayerParams { targets: vec![Target::Levels(Vec::new())], ..LayerParams::default() };
    let mut layers = contour_layers(surface, &params, progress)?;
    if let Some(area) = &pair.a.part {
        layers.iter_mut().for_each(|layer| clip_lines(&mut layer.lines, area));
    }
    Ok(layers)
}

/// The heights of A and of B in square cells on a plane in metres, around the cells that both have heights in.
fn on_plane(pair: &Pair) -> Result<[Dem; 2]> {
    let (a, b) = (pair.a_heights.whole()?, pair.b_heights.whole()?);
    let window = known(&a, &b).ok_or_else(|| Error::Data("no cell has a height in both".into()))?;
    let (grid, crs) = (a.grid, b.crs.as_ref());
    // The contours of A are drawn on their plane.
    let with_surface = [&pair.a, &pair.b].into_iter().find_map(|side| Some((side, side.surface()?)));
    let border = || window.border(&grid);
    let (plane, to_plane) = match with_surface {
        Some((side, surface)) => (surface.map.crs.clone(), side.transform_from(crs, &pair.b.source.file)?),
        None => {
            let plane = crs.map(|crs| working_crs(crs, border().into_iter())).transpose()?;
            let way = Transform::between_known(crs, plane.as_ref())?;
            (plane, way)
        }
    };
    let count = window.size.element_product();
    let is_square = (grid.cell.x - grid.cell.y).abs() <= 1e-9 * grid.cell.x;
    let Some(way) = &to_plane else {
        if is_square {
            let every = (count / MOST_CELLS).sqrt().ceil().max(1.0) as usize;
            return Ok([a, b].map(|dem| window.picked(&dem, every)));
        }
        let (lo, hi) = window.corners(&grid);
        let cells = Grid::on_multiples(lo, hi, (grid.cell.element_product() * (count / MOST_CELLS).max(1.0)).sqrt());
        let values = |dem: &Dem| heights_between(dem, &cells, &Some);
        return Ok([a, b].map(|dem| Dem { grid: cells, values: values(&dem), crs: plane.clone() }));
    };
    let bounds = border().into_iter().filter_map(|p| way.forward(p));
    let (lo, hi) = bounds.fold((DVec2::INFINITY, DVec2::NEG_INFINITY), |(lo, hi), p| (lo.min(p), hi.max(p)));
    let area = (hi - lo).element_product();
    if !area.is_finite() {
        return Err(Error::Data("the cells of the comparison have no places on a plane".into()));
    }
    let cells = Grid::on_multiples(lo, hi, (area / count.min(MOST_CELLS)).sqrt());
    let values = |dem: &Dem| heights_between(dem, &cells, &|p| way.inverse(p));
    Ok([a, b].map(|dem| Dem { grid: cells, values: values(&dem), crs: plane.clone() }))
}

/// Columns and rows of a grid.
struct Window {
    first: [usize; 2],
    size: DVec2,
}

/// The box around the cells that have heights in both.
fn known(a: &Dem, b: &Dem) -> Option<Window> {
    let cols = a.grid.cols;
    let both = (0..a.values.len()).filter(|&k| a.values[k].is_finite() && b.values[k].is_finite());
    let none = ([usize::MAX; 2], [0; 2]);
    let (first, last) = both.fold(none, |(first, last), k| {
        let at = [k % cols, k / cols];
        (std::array::from_fn(|i| first[i].min(at[i])), std::array::from_fn(|i| last[i].max(at[i])))
    });
    let size = (first[0] <= last[0]).then(|| [0, 1].map(|i| (last[i] - first[i] + 1) as f64))?;
    Some(Window { first, size: size.into() })
}

impl Window {
    /// The lower left and the upper right corner.
    fn corners(&self, grid: &Grid) -> (DVec2, DVec2) {
        let [col, row] = self.first.map(|at| at as f64);
        let upper_left = grid.corner + DVec2::new(col, -row) * grid.cell;
        let size = self.size * grid.cell;
        (upper_left - DVec2::new(0.0, size.y), upper_left + DVec2::new(size.x, 0.0))
    }

    /// Places along its border.
    fn border(&self, grid: &Grid) -> Vec<DVec2> {
        const STEPS: u32 = 20;
        let (lo, hi) = self.corners(grid);
        let shares = || (0..=STEPS).map(|k| f64::from(k) / f64::from(STEPS));
        let sides = shares().flat_map(|s| [(s, 0.0), (s, 1.0), (0.0, s), (1.0, s)]);
        sides.map(|share| lo + (hi - lo) * DVec2::from(share)).collect()
    }

    /// Every so many of its cells of a height map.
    fn picked(&self, dem: &Dem, every: usize) -> Dem {
        let Grid { cell, cols: width, .. } = dem.grid;
        let [cols, rows] = self.size.to_array().map(|size| (size as usize).div_ceil(every));
        let [col, row] = self.first;
        let values = (0..rows).flat_map(|r| (0..cols).map(move |c| (row + r * every) * width + col + c * every));
        let cell = cell * every as f64;
        let corner = dem.grid.center(col, row) + DVec2::new(-0.5, 0.5) * cell;
        let values = values.map(|k| dem.values[k]).collect();
        Dem { grid: Grid { corner, cell, cols, rows }, values, crs: dem.crs.clone() }
    }
}

/// The places of the largest differences, each some distance from the others, the largest first.
fn largest(grid: &Grid, differences: &[f32]) -> Vec<(DVec2, f64)> {
    let mut order: Vec<usize> = (0..differences.len()).filter(|&k| differences[k].is_finite()).collect();
    order.sort_by(|&a, &b| differences[b].abs().total_cmp(&differences[a].abs()).then(a.cmp(&b)));
    let apart = APART * (grid.cell * DVec2::new(grid.cols as f64, grid.rows as f64)).length();
    let mut places: Vec<(DVec2, f64)> = Vec::new();
    for k in order {
        let place = grid.center(k % grid.cols, k / grid.cols);
        if places.iter().all(|(other, _)| other.distance(place) >= apart) {
            places.push((place, f64::from(differences[k])));
        }
        if places.len() == PINS {
            break;
        }
    }
    places
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cells_are_picked_around_those_that_both_have() {
        let grid = Grid { corner: DVec2::new(1000.0, 2000.0), cell: DVec2::splat(10.0), cols: 9, rows: 8 };
        let values = (0..72).map(|k| k as f32).collect();
        let a = Dem { grid, values, crs: None };
        // B begins at the second column and the third row, and has a gap.
        let missing = |k: usize| k % 9 < 1 || k / 9 < 2 || k == 40;
        let b = Dem { values: (0..72).map(|k| if missing(k) { f32::NAN } else { 0.0 }).collect(), ..a.clone() };
        let window = known(&a, &b).unwrap();
        assert_eq!((window.first, window.size), ([1, 2], DVec2::new(8.0, 6.0)));
        assert_eq!(window.corners(&grid), (DVec2::new(1010.0, 1920.0), DVec2::new(1090.0, 1980.0)));
        for (every, cols, rows) in [(1, 8, 6), (3, 3, 2)] {
            let picked = window.picked(&a, every);
            assert_eq!((picked.grid.cols, picked.grid.rows), (cols, rows));
            for (k, height) in picked.values.iter().enumerate() {
                let at = grid.place(picked.grid.center(k % cols, k / cols));
                assert_eq!(f64::from(*height), at.x + 9.0 * at.y, "every {every}");
            }
        }
        let nowhere = Dem { values: vec![f32::NAN; 72], ..a.clone() };
        assert!(known(&a, &nowhere).is_none());
    }

    #[test]
    fn the_largest_differences_are_apart() {
        let grid = Grid { corner: DVec2::ZERO, cell: DVec2::ONE, cols: 100, rows: 1 };
        let differences: Vec<f32> = (0..100).map(|k| if k == 7 { f32::NAN } else { -(k as f32) }).collect();
        let places = largest(&grid, &differences);
        assert_eq!((places.len(), places[0]), (PINS, (DVec2::new(99.5, -0.5), -99.0)));
        assert!(places.windows(2).all(|pair| pair[0].0.x - pair[1].0.x >= APART * 100.0));
    }
}
