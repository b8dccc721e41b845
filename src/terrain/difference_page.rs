//! The terrain of a comparison in 3-D with the differences on it, as a page: [`difference_page`].

use glam::DVec2;

use super::compare::Pair;
use super::html::{MOST_CELLS, TOLERANCE, exaggeration, of_relief};
use super::plane_cells::{Window, cells_on_plane, plane_of};
use tokosen_core::base::error::{Error, Result};
use tokosen_core::base::progress::{Progress, step};
use tokosen_core::base::{Grid, Units};
use tokosen_core::contour::{ContourLayer, Target, clip_lines};
use tokosen_core::crs::Transform;
use tokosen_core::dem::compare::{Comparison, round_limit};
use tokosen_core::layers::{LayerParams, contour_layers};
use tokosen_core::mesh::height_mesh;
use tokosen_core::raster::Dem;
use tokosen_core::slice::label_layers;
use tokosen_draw::terrain_page::{Differences, TerrainPage, terrain_page};

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
    let tolerance = pair.interval().map_or_else(|| of_relief(&heights), |interval| TOLERANCE * interval.step);
    let mesh = step(progress, "triangles", || height_mesh(&heights, None, Some(tolerance)))?;

    let units = Units { heights: found.unit, ..Units::METRES };
    let contours = contours(pair, progress)?;
    let [lo, hi] = heights.corners();
    let labels = label_layers(&contours, None, (lo, hi), units.heights)?.pop().unwrap_or_default();
    let name = |side: &super::Side| side.source.file.file_name().unwrap_or_default().to_string_lossy().into_owned();
    Ok(terrain_page(&TerrainPage {
        title: &format!("{} − {}", name(&pair.a), name(&pair.b)),
        differences: Some(Differences {
            places: largest(&heights.grid, &values),
            values,
            limit: found.unit.metres(round_limit(&found.overall)),
        }),
        tolerance,
        contours: contours.first().map_or(&[], |layer| &layer.lines),
        labels: &labels,
        exaggeration: exaggeration(hi - lo, &mesh),
        units,
        ..TerrainPage::of_heights(&heights, &mesh)
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
    let window = Window::of([&a, &b]).ok_or_else(|| Error::Data("no cell has a height in both".into()))?;
    let (grid, crs) = (a.grid, b.crs.as_ref());
    // The contours of A are drawn on their plane.
    let with_surface = [&pair.a, &pair.b].into_iter().find_map(|side| Some((side, side.surface()?)));
    let (plane, to_plane) = match with_surface {
        Some((side, surface)) => (surface.map.crs.clone(), side.transform_from(crs, &pair.b.source.file)?),
        None => {
            let plane = plane_of(crs, window.border(&grid))?;
            let way = Transform::between_known(crs, plane.as_ref())?;
            (plane, way)
        }
    };
    cells_on_plane([&a, &b], &window, (plane.as_ref(), to_plane.as_ref()), MOST_CELLS)
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
    fn the_largest_differences_are_apart() {
        let grid = Grid { corner: DVec2::ZERO, cell: DVec2::ONE, cols: 100, rows: 1 };
        let differences: Vec<f32> = (0..100).map(|k| if k == 7 { f32::NAN } else { -(k as f32) }).collect();
        let places = largest(&grid, &differences);
        assert_eq!((places.len(), places[0]), (PINS, (DVec2::new(99.5, -0.5), -99.0)));
        assert!(places.windows(2).all(|pair| pair[0].0.x - pair[1].0.x >= APART * 100.0));
    }
}
