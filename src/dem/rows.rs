//! Values of a raster, some rows at a time. So a raster may be larger than the memory.

use std::borrow::Cow;
use std::fmt::Debug;
use std::sync::Arc;

use super::height_map::Dem;
use crate::base::Grid;
use crate::base::error::{Error, Finding, Result};
use crate::crs::Crs;

/// Cells of a block of rows.
const BLOCK: usize = 1 << 19;

/// A raster whose rows are read or computed on demand: a [`Dem`], a file, or what follows from one. Values are heights in metres
/// where nothing else is said.
///
/// Reading row after row is fast. A file may have to decode many rows for one.
pub trait RasterRows: Debug + Send + Sync {
    /// The grid of cells.
    fn grid(&self) -> Grid;

    /// The coordinate reference system, if known.
    fn crs(&self) -> Option<&Crs>;

    /// Reads whole rows from the row `first` on: as many as `heights` has room for. Heights are in metres; NaN where there is no
    /// data.
    ///
    /// # Errors
    /// If the file cannot be read or is broken.
    fn read(&self, first: usize, heights: &mut [f32]) -> Result<()>;

    /// Findings about the heights of all rows that were read so far.
    fn findings(&self) -> Vec<Finding> {
        Vec::new()
    }

    /// All heights.
    ///
    /// # Errors
    /// As [`RasterRows::read`]. If there is not enough memory.
    fn whole(&self) -> Result<Cow<'_, Dem>> {
        let grid = self.grid();
        let mut values = empty(grid.len())?;
        values.resize(grid.len(), f32::NAN);
        self.read(0, &mut values)?;
        Ok(Cow::Owned(Dem { grid, values, crs: self.crs().cloned() }))
    }
}

/// An empty vector with room for the values of `cells` cells.
///
/// # Errors
/// [`Error::Data`] if there is not enough memory.
pub(crate) fn empty<T>(cells: usize) -> Result<Vec<T>> {
    let mut values = Vec::new();
    let room = values.try_reserve_exact(cells);
    room.map_err(|_| {
        Error::Data(format!(
            "there is not enough memory for {cells} cells; cut the raster first, for example with gdalwarp"
        ))
    })?;
    Ok(values)
}

impl RasterRows for Dem {
    fn grid(&self) -> Grid {
        self.grid
    }

    fn crs(&self) -> Option<&Crs> {
        self.crs.as_ref()
    }

    fn read(&self, first: usize, heights: &mut [f32]) -> Result<()> {
        let start = first * self.grid.cols;
        let Some(values) = self.values.get(start..start + heights.len()) else {
            let Grid { cols, rows, .. } = self.grid;
            let message = format!("a height map of {cols} x {rows} cells cannot have {} values", self.values.len());
            return Err(Error::Parameter(message));
        };
        heights.copy_from_slice(values);
        Ok(())
    }

    fn whole(&self) -> Result<Cow<'_, Dem>> {
        Ok(Cow::Borrowed(self))
    }
}

/// A raster in another coordinate reference system than it states.
#[derive(Debug)]
pub struct WithCrs {
    /// The raster.
    pub rows: Arc<dyn RasterRows>,
    /// The system.
    pub crs: Option<Crs>,
}

impl RasterRows for WithCrs {
    fn grid(&self) -> Grid {
        self.rows.grid()
    }

    fn crs(&self) -> Option<&Crs> {
        self.crs.as_ref()
    }

    fn read(&self, first: usize, heights: &mut [f32]) -> Result<()> {
        self.rows.read(first, heights)
    }

    fn findings(&self) -> Vec<Finding> {
        self.rows.findings()
    }
}

/// A block of rows, with the row above and the row below if there are such.
#[derive(Debug)]
pub(crate) struct Block {
    cols: usize,
    /// The rows of the block.
    pub rows: std::ops::Range<usize>,
    /// The rows that are held.
    held: std::ops::Range<usize>,
    heights: Vec<f32>,
}

impl Block {
    /// The heights of a row of the raster. `None` if it is not held.
    fn held(&self, row: usize) -> Option<&[f32]> {
        let k = self.held.contains(&row).then(|| row - self.held.start)?;
        self.heights.get(k * self.cols..(k + 1) * self.cols)
    }

    /// The heights of a row of the block.
    pub fn row(&self, row: usize) -> &[f32] {
        self.held(row).unwrap_or_default()
    }

    /// A row of the block, and the rows above and below it, which the border of the raster does not have.
    pub fn around(&self, row: usize) -> [Option<&[f32]>; 3] {
        [row.checked_sub(1).and_then(|above| self.held(above)), self.held(row), self.held(row + 1)]
    }

    /// The heights of all rows of the block.
    pub fn heights(&self) -> &[f32] {
        let above = self.rows.start - self.held.start;
        &self.heights[above * self.cols..(above + self.rows.len()) * self.cols]
    }
}

/// Reads a raster block by block, from the first row to the last.
#[derive(Debug)]
pub(crate) struct Blocks<'a> {
    source: &'a dyn RasterRows,
    grid: Grid,
    length: usize,
    block: Block,
}

impl<'a> Blocks<'a> {
    pub fn of(source: &'a dyn RasterRows) -> Self {
        let grid = source.grid();
        Self::of_length(source, (BLOCK / grid.cols.max(1)).max(1))
    }

    /// Blocks of `length` rows.
    pub fn of_length(source: &'a dyn RasterRows, length: usize) -> Self {
        let grid = source.grid();
        let block = Block { cols: grid.cols, rows: 0..0, held: 0..0, heights: Vec::new() };
        Self { source, grid, length, block }
    }

    /// Reads the next block. `None` after the last one.
    ///
    /// # Errors
    /// As [`RasterRows::read`].
    pub fn next(&mut self) -> Result<Option<&Block>> {
        let Self { source, grid: Grid { cols, rows, .. }, length, ref mut block } = *self;
        let first = block.rows.end;
        if first >= rows || cols == 0 {
            return Ok(None);
        }
        let end = rows.min(first + length);
        let (held, known) = (first.saturating_sub(1)..rows.min(end + 1), block.held.end);
        block.heights.drain(..(held.start - block.held.start) * cols);
        block.heights.resize(held.len() * cols, f32::NAN);
        let from = known.max(held.start);
        source.read(from, &mut block.heights[(from - held.start) * cols..])?;
        (block.rows, block.held) = (first..end, held);
        Ok(Some(&self.block))
    }
}

#[cfg(test)]
mod tests {
    use glam::DVec2;

    use super::*;

    #[test]
    fn blocks_hold_the_rows_beside_them() {
        let grid = Grid { corner: DVec2::ZERO, cell: DVec2::ONE, cols: 2, rows: 7 };
        let dem = Dem { grid, values: (0..14).map(|i| i as f32).collect(), crs: None };
        for length in 1..9 {
            let mut blocks = Blocks::of_length(&dem, length);
            let mut next = 0;
            while let Some(block) = blocks.next().unwrap() {
                assert_eq!(block.heights(), &dem.values[block.rows.start * 2..block.rows.end * 2]);
                for row in block.rows.clone() {
                    assert_eq!(row, next);
                    next += 1;
                    let line = |row: usize| (row < 7).then(|| &dem.values[row * 2..row * 2 + 2]);
                    assert_eq!(block.around(row), [row.checked_sub(1).and_then(line), line(row), line(row + 1)]);
                    assert_eq!(Some(block.row(row)), line(row));
                }
            }
            assert_eq!(next, 7, "{length}");
        }
    }
}
