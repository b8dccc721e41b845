//! Joins squares into one height map.
//!
//! Positions are whole numbers of cells from the equator and the zero meridian. Therefore edges meet exactly, for any
//! number of squares.

use std::collections::HashMap;
use std::path::Path;

use glam::DVec2;

use super::dem::Tile;
use super::mesh::{Mesh, in_cells};
use super::product::Product;
use tokosen_core::base::Grid;
use tokosen_core::base::error::{Error, Finding, FindingKind, Result};
use tokosen_core::raster::Dem;

/// The largest number of cells of a height map; they take 4 GB.
const MAX_CELLS: i64 = 1 << 30;

/// Places squares of one product on their common grid. Cells of missing squares have no height.
pub(super) fn mosaic(path: &Path, mut tiles: Vec<Tile>, findings: &mut Vec<Finding>) -> Result<(Dem, Product)> {
    let Some(first) = tiles.first() else {
        return Err(Error::file(path, "there is no height map (DEM) in it"));
    };
    let product = first.product;
    if let Some(other) = tiles.iter().find(|tile| tile.product != product) {
        let message = format!(
            "{} is {} and {} is {}; read one product at a time",
            first.path.display(),
            product.name(),
            other.path.display(),
            other.product.name()
        );
        return Err(Error::file(path, message));
    }
    // If a square occurs twice, the newer edition comes later and overwrites the older one.
    tiles.sort_by(|a, b| a.date.cmp(&b.date));
    note_repeated(&tiles, findings);

    let density = product.cells_per_degree();
    let cells = |seconds: i64| in_cells(seconds, density).expect("squares of a product have whole cells");
    let fold = |of: fn(&Mesh) -> i64, choose: fn(i64, i64) -> i64| {
        let edges = tiles.iter().map(|tile| cells(of(&tile.mesh)));
        edges.reduce(choose).expect("there is a square")
    };
    let (west, east) = (fold(|m| m.west, i64::min), fold(|m| m.west + m.width, i64::max));
    let (south, north) = (fold(|m| m.south, i64::min), fold(|m| m.south + m.height, i64::max));
    let count = (east - west) * (north - south);
    if count > MAX_CELLS {
        let message = format!(
            "the box around all its squares has {} x {} cells, more than {MAX_CELLS}; read fewer squares at a time",
            east - west,
            north - south
        );
        return Err(Error::file(path, message));
    }
    // The limit above is smaller than the range of each type.
    let (cols, rows) = ((east - west) as usize, (north - south) as usize);
    let mut values: Vec<f32> = Vec::new();
    values
        .try_reserve_exact(cols * rows)
        .map_err(|e| Error::file_cause(path, format!("{cols} x {rows} cells do not fit into the memory"), e))?;
    values.resize(cols * rows, f32::NAN);
    for tile in tiles {
        let left = (cells(tile.mesh.west) - west) as usize;
        let top = (north - cells(tile.mesh.south + tile.mesh.height)) as usize;
        for (index, height) in (tile.start..).zip(tile.heights) {
            if !height.is_nan() {
                values[(top + index / tile.cols) * cols + left + index % tile.cols] = height;
            }
        }
    }
    let degrees = |cells: i64| cells as f64 / density as f64;
    let corner = DVec2::new(degrees(west), degrees(north));
    let grid = Grid { corner, cell: DVec2::splat(degrees(1)), cols, rows };
    Ok((Dem { grid, values, crs: None }, product))
}

fn note_repeated(tiles: &[Tile], findings: &mut Vec<Finding>) {
    let mut seen: HashMap<Mesh, &Tile> = HashMap::new();
    for tile in tiles {
        if let Some(older) = seen.insert(tile.mesh, tile) {
            let [[lat, lon], _] = tile.mesh.corners();
            let message = format!(
                "the square {} is in {} and in {}; where both have heights those of the second are taken",
                tile.code,
                older.path.display(),
                tile.path.display()
            );
            findings.push(Finding::at(FindingKind::RepeatedMesh, DVec2::new(lon, lat), message));
        }
    }
}
