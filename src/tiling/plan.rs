//! The plan: the map is read, its figures are taken, and it is cut into tiles.

use std::collections::HashSet;
use std::path::{Path, PathBuf};

use geo::{BooleanOps, BoundingRect, MultiPolygon, Rect};
use glam::DVec2;
use rayon::prelude::*;
use tokosen_core::base::error::{Error, Result};
use tokosen_core::base::progress::{Progress, step};
use tokosen_core::base::{ElevationUnit, Grid};
use tokosen_core::contour::{ContourMap, Lake};
use tokosen_core::crs::Reprojection;
use tokosen_core::spline::bytes_on;

use super::beside::in_window;
use super::bytes::Out;
use super::divide::{Block, STEP, divide};
use super::findings::Stored;
use super::folder::{Folder, HEIGHTS, INPUT, LINES, RESULT, TILES};
use super::manifest::{Levels, Manifest, Shared, StoredGround, Task};
use super::pieces::{around, boxes, encode};
use super::squares::Squares;
use super::stored;
use super::window::Window;
use crate::terrain::{Beside, Input, Options, Planned, TileParams, lake_height};

/// Bytes of memory of a task per vertex of contours in its window.
const BYTES_PER_VERTEX: f64 = 700.0;
/// Bytes of memory per cell of the height map in its window.
const BYTES_PER_CELL: f64 = 12.0;
/// Bytes of memory per node of the working grid in its window, if new contours are wanted: the nodes are triangulated.
const BYTES_PER_TRIANGULATED_NODE: f64 = 500.0;
/// Most tiles. Each reads a window many times its size if tiles are small.
const MOST_TILES: f64 = 1e5;
/// Bytes of memory of a task without any map.
const BYTES_OF_PROGRAM: f64 = 50e6;

/// How a map is cut into tiles.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct PlanParams {
    /// The new contours, if they are wanted.
    pub levels: Option<Levels>,
    /// The unit of these levels, and of the heights that are written. In memory heights are metres.
    pub unit: ElevationUnit,
    /// Largest side of a tile, map units. If `None`, only the memory counts.
    pub tile_side: Option<f64>,
    /// Memory that a task may take, bytes. No limit if `None`.
    pub memory: Option<u64>,
}

/// A plan as it was made.
#[derive(Debug, Clone)]
pub struct Plan {
    /// Its manifest.
    pub manifest: Manifest,
    /// Number of results of a former plan that were removed, because the new one does not have their tiles.
    pub removed: usize,
}

/// Cuts the map of an input into tiles, and writes the plan into a folder. The height map is that of the options, if they have
/// a grid. The map and the findings stay in the input.
///
/// # Errors
/// What tiles cannot take is refused, with a sentence that says what to do. As [`Terrain::build`](crate::Terrain::build). The folder
/// cannot be written, or holds other files.
pub fn plan(
    input: &mut Input,
    options: &Options,
    params: &PlanParams,
    folder: &Path,
    progress: &dyn Progress,
) -> Result<Plan> {
    if let Some(size) = params.tile_side.filter(|size| !(size.is_finite() && *size > 0.0)) {
        return Err(Error::out_of_range("size of tiles", size, "more than 0"));
    }
    if options.grid.is_none() && params.levels.is_none() {
        return Err(Error::Parameter("a plan needs cells of a height map, or levels of new contours, or both".into()));
    }
    Folder::make(folder)?;
    let (planned, mut beside) = input.plan(options, progress)?;
    step(progress, "cutting into tiles", || {
        let shared = Shared {
            unit: params.unit,
            kind: options.kind,
            resolution: options.resolution,
            drain: options.drain,
            levels: params.levels.clone(),
            whole: planned.whole.clone(),
            ground: StoredGround::from(&planned.ground),
            cells: planned.cells,
            sea: options.sea,
            coast: planned.coast.clone(),
            stream_tolerance: options.stream_tolerance,
            cliff_reach: planned.cliff_reach,
            units: planned.units,
            working_crs: input.reprojection.working_crs().cloned(),
        };
        let crs = input.reprojection.input_crs().cloned();
        let mut manifest = Manifest::new(input.name().into_owned(), shared, crs);
        manifest.findings = input.findings.iter().map(Stored::from).collect();
        if params.levels.is_some() {
            let lines = stored::write(&folder.join(LINES), 0, &all_lines(&input.map, &input.reprojection))?;
            manifest.lines = Some(format!("{lines:016x}"));
        }
        let squares = Squares::new(&input.map);
        give_lake_heights(&mut beside, (&input.map, &squares), (&planned, options))?;
        manifest.tasks = tasks((&input.map, &beside, &squares), &planned, params, folder)?;
        Folder::store(folder, &manifest)?;
        let removed = remove_others(folder, &manifest)?;
        Ok(Plan { manifest, removed })
    })
}

/// Removes the files of tiles of a former plan that the new one does not have, and counts the results among them.
fn remove_others(folder: &Path, manifest: &Manifest) -> Result<usize> {
    let mut results = 0;
    let tiles = folder.join(TILES);
    let named: HashSet<PathBuf> = manifest
        .tasks
        .iter()
        .flat_map(|task| task.inputs.iter().chain(&task.outputs))
        .map(|name| folder.join(name))
        .collect();
    let entries = std::fs::read_dir(&tiles).map_err(|e| Error::io("read", &tiles, e))?;
    for path in entries.filter_map(|entry| Some(entry.ok()?.path())).filter(|path| !named.contains(path)) {
        let is_ours = path.extension().is_some_and(|kind| [INPUT, HEIGHTS, RESULT].iter().any(|own| kind == *own));
        if is_ours && path.is_file() {
            std::fs::remove_file(&path).map_err(|e| Error::io("remove the outdated", &path, e))?;
            results += usize::from(path.extension().is_some_and(|kind| kind == RESULT));
        }
    }
    Ok(results)
}

/// All lines with the coordinates that they have in the input.
fn all_lines(map: &ContourMap, reprojection: &Reprojection) -> Vec<u8> {
    let mut out = Out::default();
    out.count(map.contours.len());
    for line in &map.contours {
        out.number(line.elevation);
        let given: Vec<DVec2> = line.points.iter().map(|&p| reprojection.in_input(p).unwrap_or(p)).collect();
        out.points(&given);
    }
    out.0
}

/// Cuts the map into tiles, and writes the input of each.
fn tasks(
    (map, beside, squares): (&ContourMap, &Beside, &Squares),
    planned: &Planned,
    params: &PlanParams,
    folder: &Path,
) -> Result<Vec<Task>> {
    // Tiles consist of whole cells; without a height map, of whole cells of the working grid.
    let grid = planned.cells.unwrap_or(planned.whole.grid);
    let size = Size { squares, grid: &grid, planned, params };
    let all = Block { col: 0, row: 0, cols: grid.cols, rows: grid.rows };
    size.check(&all)?;
    let blocks = divide(all, &|block| size.fits(block));
    blocks.iter().try_for_each(|block| size.check_memory(block))?;
    let (boxes, ground) = (boxes(map), planned.ground.area());
    let on_ground = |block: &Block| {
        let [lo, hi] = box_of(&grid, block);
        let tile = MultiPolygon::from(Rect::new((lo.x, lo.y), (hi.x, hi.y)).to_polygon());
        !ground.intersection(&tile).0.is_empty()
    };
    let blocks: Vec<Block> = blocks.into_iter().filter(on_ground).collect();
    let digits = blocks.len().to_string().len();
    let task = |(k, block): (usize, &Block)| {
        let id = format!("t{:0digits$}", k + 1);
        let [lo, hi] = box_of(&grid, block);
        let window = squares.window(lo, hi);
        let [from, to] = window;
        let window = Window::new(window);
        let around = around(map, &boxes, &window);
        let vertices = around.0.vertex_count();
        let bytes = encode(&around, &in_window(beside, &window));
        let name = |kind: &str| format!("{TILES}/{id}.{kind}");
        let input = name(INPUT);
        let checksum = stored::write(&folder.join(&input), 0, &bytes)?;
        let heights = planned.cells.is_some().then(|| name(HEIGHTS));
        Ok(Task {
            needs: Vec::new(),
            inputs: vec![input],
            outputs: std::iter::once(name(RESULT)).chain(heights).collect(),
            checksum: format!("{checksum:016x}"),
            vertices,
            tile: [lo.x, lo.y, hi.x, hi.y],
            window: [from.x, from.y, to.x, to.y],
            cells: planned.cells.is_some().then_some(*block),
            id,
        })
    };
    blocks.iter().enumerate().map(task).collect()
}

/// Gives heights to the lakes that have none. A tile may see too little of a shore to know it, and two tiles could disagree.
fn give_lake_heights(
    beside: &mut Beside,
    (map, squares): (&ContourMap, &Squares),
    (planned, options): (&Planned, &Options),
) -> Result<()> {
    let boxes = boxes(map);
    let height = |lake: &Lake| {
        let Some(rect) = lake.polygon.bounding_rect().filter(|_| lake.height.is_none()) else { return Ok(lake.height) };
        let [lo, hi] = [rect.min(), rect.max()].map(|c| DVec2::new(c.x, c.y));
        let window = squares.window(lo, hi);
        let (near, _) = around(map, &boxes, &Window::new(window));
        let [from, to] = window;
        let tile = TileParams {
            options: options.clone(),
            planned: planned.clone(),
            core: [lo.x, lo.y, hi.x, hi.y],
            window: [from.x, from.y, to.x, to.y],
            beside: Beside::default(),
        };
        lake_height(near, &tile, lake)
    };
    let lakes = &mut beside.features.lakes;
    let heights: Vec<Result<Option<f64>>> = lakes.par_iter().map(height).collect();
    for (lake, height) in lakes.iter_mut().zip(heights) {
        lake.height = height?;
    }
    Ok(())
}

/// The box around some cells. At the edge of the grid, it reaches a cell further: all ground lies inside of tiles.
fn box_of(grid: &Grid, block: &Block) -> [DVec2; 2] {
    let further = |is_edge: bool, cell: f64| if is_edge { cell } else { 0.0 };
    let x = |col: usize| grid.corner.x + col as f64 * grid.cell.x;
    let y = |row: usize| grid.corner.y - row as f64 * grid.cell.y;
    let (east, south) = (block.col + block.cols, block.row + block.rows);
    let Grid { cell, .. } = grid;
    let lo = DVec2::new(x(block.col) - further(block.col == 0, cell.x), y(south) - further(south == grid.rows, cell.y));
    let hi = DVec2::new(x(east) + further(east == grid.cols, cell.x), y(block.row) + further(block.row == 0, cell.y));
    [lo, hi]
}

/// How large tiles may be.
struct Size<'a> {
    squares: &'a Squares,
    grid: &'a Grid,
    planned: &'a Planned,
    params: &'a PlanParams,
}

impl Size<'_> {
    fn fits(&self, block: &Block) -> bool {
        let side = (block.cols as f64 * self.grid.cell.x).max(block.rows as f64 * self.grid.cell.y);
        self.params.tile_side.is_none_or(|most| side <= most * (1.0 + 1e-9))
            && self.params.memory.is_none_or(|most| self.bytes(block) <= most as f64)
    }

    /// Refuses sizes that give far too many tiles, before they are cut.
    fn check(&self, all: &Block) -> Result<()> {
        let [west, north] = [all.cols / 2, all.rows / 2].map(|middle| middle - middle % STEP);
        let smallest =
            Block { col: west, row: north, cols: STEP.min(all.cols - west), rows: STEP.min(all.rows - north) };
        self.check_memory(&smallest)?;
        let side = self.grid.cell * STEP as f64;
        let side = self.params.tile_side.map_or(side, |size| side.max(DVec2::splat(size)));
        let tiles = (self.grid.cell * DVec2::new(all.cols as f64, all.rows as f64) / side).element_product();
        match self.params.tile_side.filter(|_| tiles > MOST_TILES) {
            Some(size) => Err(Error::Parameter(format!(
                "tiles of {size} on this map are {tiles:.0} tasks or more: choose a larger size of tiles"
            ))),
            None => Ok(()),
        }
    }

    fn check_memory(&self, block: &Block) -> Result<()> {
        let bytes = self.bytes(block);
        match self.params.memory.filter(|most| bytes > *most as f64) {
            Some(_) => Err(Error::Parameter(format!(
                "the smallest possible tile takes about {:.0} MB of memory, more than a task may take: allow more memory, or \
                 choose a larger cell",
                bytes / 1e6
            ))),
            None => Ok(()),
        }
    }

    /// About how much memory the task of a tile takes.
    fn bytes(&self, block: &Block) -> f64 {
        let [lo, hi] = box_of(self.grid, block);
        let [from, to] = self.squares.window(lo, hi);
        let count = |grid: &Grid| {
            let [west, north] = [from.x.max(grid.corner.x), to.y.min(grid.corner.y)];
            let size = grid.cell * DVec2::new(grid.cols as f64, grid.rows as f64);
            let [east, south] = [to.x.min(grid.corner.x + size.x), from.y.max(grid.corner.y - size.y)];
            let count = (DVec2::new(east - west, north - south) / grid.cell).max(DVec2::ONE);
            Grid { cols: count.x as usize + 1, rows: count.y as usize + 1, ..*grid }
        };
        let nodes = count(&self.planned.whole.grid);
        let triangulated = if self.params.levels.is_some() { BYTES_PER_TRIANGULATED_NODE } else { 0.0 };
        BYTES_OF_PROGRAM
            + BYTES_PER_VERTEX * self.squares.vertices(from, to)
            + bytes_on(&nodes, self.squares.length(from, to))
            + triangulated * nodes.len() as f64
            + self.planned.cells.map_or(0.0, |cells| BYTES_PER_CELL * count(&cells).len() as f64)
    }
}
