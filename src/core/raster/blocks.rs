//! Blocks of rows, in which a raster is read from its first row to its last.

use super::rows::{RasterRows, reserve};
use crate::base::Grid;
use crate::base::error::Result;

/// Cells of a block of rows.
const BLOCK: usize = 1 << 18;

/// A block of rows, with the row above and the row below if there are such.
#[derive(Debug)]
pub struct Block {
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
pub struct Blocks<'a> {
    source: &'a dyn RasterRows,
    grid: Grid,
    length: usize,
    block: Block,
}

impl<'a> Blocks<'a> {
    /// Blocks of a usual length.
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
        reserve(&mut block.heights, held.len() * cols)?;
        block.heights.resize(held.len() * cols, f32::NAN);
        let from = known.max(held.start);
        source.read(from, &mut block.heights[(from - held.start) * cols..])?;
        (block.rows, block.held) = (first..end, held);
        Ok(Some(&self.block))
    }
}

/// Calls `of_block` with the blocks of two rasters on one grid, from the first rows to the last.
///
/// # Errors
/// As [`RasterRows::read`].
pub fn each_pair([a, b]: [&dyn RasterRows; 2], mut of_block: impl FnMut(&Block, &Block)) -> Result<()> {
    let (mut a, mut b) = (Blocks::of(a), Blocks::of(b));
    loop {
        let (block_a, block_b) = rayon::join(|| a.next(), || b.next());
        let (Some(block_a), Some(block_b)) = (block_a?, block_b?) else { return Ok(()) };
        of_block(block_a, block_b);
    }
}

#[cfg(test)]
mod tests {
    use glam::DVec2;

    use super::*;
    use crate::raster::Dem;

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
