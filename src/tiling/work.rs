//! One task: the surface of a tile, its heights and its new lines.

use tokosen_core::base::error::{Report, Result};
use tokosen_core::base::progress::Progress;
use tokosen_core::base::{ElevationUnit, Grid};
use tokosen_core::contour::Source;
use tokosen_core::layers::{LayerParams, SIMPLIFIED, contour_layers};
use tokosen_core::slice::ascends_right;
use tokosen_core::surface::{Surface, Triangles, Uncertainty, height_map};
use tokosen_core::tin::NONE;
use tokosen_core::tuning::Tuning;

use super::cut::Tile;
use super::divide::Block;
use super::folder::{Folder, HEIGHTS, RESULT};
use super::manifest::{Levels, Task};
use super::pieces::Around;
use super::result::{LinePiece, TileLayer, TileResult};
use super::stored;
use crate::terrain::{Options, Preparation, TileParams, tile_surface};

/// What became of a task.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Work {
    /// It was done now.
    Done,
    /// All its files were there and whole.
    WasDone,
}

/// Does a task, unless its results are there and whole. `memory` is what it may take, bytes.
///
/// # Errors
/// The input of the task is missing or damaged. As [`build`](fn@tokosen_core::surface::build) and [`contour_layers`]. A result cannot be
/// written.
pub fn work(folder: &Folder, task: &Task, memory: Option<u64>, progress: &dyn Progress) -> Result<Work> {
    if folder.is_done(task)? {
        return Ok(Work::WasDone);
    }
    let (shared, source) = (&folder.manifest.shared, folder.manifest.source(task)?);
    let mut around = None;
    for name in &task.inputs {
        let file = folder.file(name);
        let bytes = stored::read_known(&file, &task.checksum)?;
        around = Some(Around::decode(&bytes, &file)?);
    }
    let planned = shared.planned();
    let triangles = if shared.levels.is_some() { Triangles::Smooth } else { Triangles::Reference };
    let options = Options {
        kind: shared.kind,
        resolution: shared.resolution,
        drain: shared.drain,
        sea: shared.sea,
        stream_tolerance: shared.stream_tolerance,
        triangles,
        memory,
        // The figures of the whole map hold them, or a plan refuses them. All are named, so that none is forgotten.
        preparation: Preparation::default(),
        tension: None,
        noise: None,
        base_fade: None,
        grid: None,
        uncertainty: Uncertainty::Unknown,
        tuning: Tuning::default(),
    };
    let mut result = TileResult::default();
    let mut heights = None;
    if let Some(mut around) = around.filter(|around| !around.map.contours.is_empty()) {
        around.map.crs.clone_from(&shared.working_crs);
        let beside = std::mem::take(&mut around.beside);
        let tile = TileParams { options, planned, core: task.tile, window: task.window, beside };
        let map = std::mem::take(&mut around.map);
        let Report { value: surface, findings } = tile_surface(map, &tile, progress)?;
        result.findings = findings;
        heights =
            task.cells.zip(shared.cells).map(|(cells, grid)| tile_heights(&surface, &grid, &cells, &tile, progress));
        if let Some(levels) = &shared.levels {
            let core = Tile::new(task.tile);
            result.sides = sides(&surface, &around, &core);
            let surface = only_near(surface, &core);
            let tolerance = SIMPLIFIED * shared.whole.spacing;
            result.layers = new_lines(&surface, levels, &core, (shared.unit, tolerance, memory), progress)?;
        }
    }
    if let (Some(file), Some(cells)) = (folder.result(task, HEIGHTS), task.cells) {
        // A tile without contours around it has no heights.
        let values = heights.unwrap_or_else(|| vec![f32::NAN; cells.cols * cells.rows]);
        let bytes: Vec<u8> = values.iter().flat_map(|value| value.to_le_bytes()).collect();
        stored::write(&file, source, &bytes)?;
    }
    if let Some(file) = folder.result(task, RESULT) {
        stored::write(&file, source, &result.encode()?)?;
    }
    Ok(Work::Done)
}

/// The heights of the cells of a tile. They are taken out of a height map of the whole window, so that pits at its border have the ways out
/// that they have in the whole map.
fn tile_heights(surface: &Surface, grid: &Grid, cells: &Block, tile: &TileParams, progress: &dyn Progress) -> Vec<f32> {
    let [west, south, east, north] = tile.window;
    let limit = |v: f64, most: usize| v.clamp(0.0, most as f64) as usize;
    let col = limit(((west - grid.corner.x) / grid.cell.x).floor(), cells.col);
    let row = limit(((grid.corner.y - north) / grid.cell.y).floor(), cells.row);
    let end_col = limit(((east - grid.corner.x) / grid.cell.x).ceil(), grid.cols).max(cells.col + cells.cols);
    let end_row = limit(((grid.corner.y - south) / grid.cell.y).ceil(), grid.rows).max(cells.row + cells.rows);
    let corner = glam::DVec2::new(grid.corner.x + col as f64 * grid.cell.x, grid.corner.y - row as f64 * grid.cell.y);
    let around = Grid { corner, cols: end_col - col, rows: end_row - row, ..*grid };
    let dem = height_map(surface, &around, None, None, progress);
    let rows = cells.row - row..cells.row - row + cells.rows;
    rows.flat_map(|r| &dem.values[r * around.cols + cells.col - col..][..cells.cols]).copied().collect()
}

/// The surface without the triangles that do not meet a tile. New lines are traced only in the others.
fn only_near(mut surface: Surface, tile: &Tile) -> Surface {
    let tin = &surface.tin;
    let is_near = |t: u32| {
        let corners = tin.corners(t).map(|p| p + tin.origin);
        let [lo, hi] = corners.iter().fold([corners[0]; 2], |[lo, hi], &p| [lo.min(p), hi.max(p)]);
        hi.cmpge(tile.lo).all() && lo.cmple(tile.hi).all()
    };
    let keep: Vec<bool> = (0..tin.len() as u32).map(is_near).collect();
    surface.tin = surface.tin.only(&keep);
    // Ground outside of the frame belongs to no sub-domain.
    let of_triangle = surface.regions.of_triangle.iter_mut().zip(&keep);
    of_triangle.filter(|(_, keep)| !**keep).for_each(|(region, _)| *region = NONE);
    surface
}

/// Which side of the contours in a tile is high.
fn sides(surface: &Surface, around: &Around, tile: &Tile) -> Vec<(u32, f64)> {
    let right = ascends_right(&surface.map, &surface.tin, &surface.regions);
    let side = |(line, right): (&tokosen_core::contour::Contour, bool)| {
        let pieces = tile.pieces(&line.points);
        let length: f64 = pieces.iter().flat_map(|p| p.points.windows(2)).map(|w| w[0].distance(w[1])).sum();
        let number = around.line_of(&line.points).filter(|_| length > 0.0)?;
        Some((number, if right { length } else { -length }))
    };
    surface.map.contours.iter().zip(right).filter_map(side).collect()
}

/// The new lines of each layer in a tile.
fn new_lines(
    surface: &Surface,
    levels: &Levels,
    tile: &Tile,
    (unit, tolerance, memory): (ElevationUnit, f64, Option<u64>),
    progress: &dyn Progress,
) -> Result<Vec<TileLayer>> {
    let params = LayerParams {
        targets: levels.targets.clone(),
        unit,
        index_every: levels.index_every,
        simplify: Some(tolerance),
        keep_input: levels.keep_input,
        memory,
    };
    let layers = contour_layers(surface, &params, progress)?;
    let layer = layers.into_iter().map(|layer| {
        let new = layer.lines.iter().filter(|line| line.source == Source::Interpolated);
        let pieces = new.flat_map(|line| {
            let piece = |piece| LinePiece { elevation: line.elevation, index: line.index, piece };
            tile.pieces(&line.points).into_iter().map(piece)
        });
        TileLayer { pieces: pieces.collect(), artefact_rings: layer.artefact_rings, dead_ends: layer.dead_ends }
    });
    Ok(layer.collect())
}
