//! The height map of all tiles, read row by row from their files.

use std::fs::File;
use std::io::{Read, Seek, SeekFrom};
use std::path::{Path, PathBuf};

use tokosen_core::base::Grid;
use tokosen_core::base::error::{Error, Result};
use tokosen_core::crs::Crs;
use tokosen_core::raster::RasterRows;

use super::divide::Block;
use super::folder::{Folder, HEIGHTS};
use super::manifest::Task;
use super::stored::HEADER;

/// The height map of a plan. Rows are read from the files of the tiles when they are needed.
#[derive(Debug)]
pub struct Mosaic {
    grid: Grid,
    crs: Option<Crs>,
    tiles: Vec<(Block, PathBuf)>,
}

impl Mosaic {
    /// The height map of a plan whose tasks are done.
    ///
    /// # Errors
    /// The plan has no height map, or tasks are not done.
    pub fn open(folder: &Folder) -> Result<Self> {
        let shared = &folder.manifest.shared;
        let Some(grid) = shared.cells else {
            return Err(Error::Parameter("this plan has no height map".into()));
        };
        folder.check_done()?;
        let heights = |task: &Task| Some((task.cells?, folder.result(task, HEIGHTS)?));
        let tiles = folder.manifest.tasks.iter().filter_map(heights);
        Ok(Self { grid, crs: shared.working_crs.clone(), tiles: tiles.collect() })
    }

    /// Reads the rows of a tile among some rows of the height map.
    fn read_tile(&self, block: &Block, path: &Path, first: usize, heights: &mut [f32]) -> Result<()> {
        let failed = |e| Error::io("read", path, e);
        let end = first + heights.len() / self.grid.cols;
        let rows = first.max(block.row)..end.min(block.row + block.rows);
        if rows.is_empty() {
            return Ok(());
        }
        let mut file = File::open(path).map_err(failed)?;
        let skipped = (rows.start - block.row) * block.cols * size_of::<f32>();
        file.seek(SeekFrom::Start(HEADER + skipped as u64)).map_err(failed)?;
        let mut bytes = vec![0; block.cols * size_of::<f32>()];
        for row in rows {
            file.read_exact(&mut bytes).map_err(failed)?;
            let into = &mut heights[(row - first) * self.grid.cols + block.col..][..block.cols];
            for (value, four) in into.iter_mut().zip(bytes.as_chunks().0) {
                *value = f32::from_le_bytes(*four);
            }
        }
        Ok(())
    }
}

impl RasterRows for Mosaic {
    fn grid(&self) -> Grid {
        self.grid
    }

    fn crs(&self) -> Option<&Crs> {
        self.crs.as_ref()
    }

    fn read(&self, first: usize, heights: &mut [f32]) -> Result<()> {
        heights.fill(f32::NAN);
        self.tiles.iter().try_for_each(|(block, path)| self.read_tile(block, path, first, heights))
    }
}
