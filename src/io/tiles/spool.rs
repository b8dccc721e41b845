//! Tiles of one zoom, waiting in a temporary file.

use std::fs::File;
use std::io::{BufWriter, Read, Seek, SeekFrom, Write};
use std::path::Path;

use tokosen_core::base::error::{Error, Result};
use tokosen_core::tiles::TilePlace;

/// Tiles in the order in which archives have them.
pub(super) struct Spool {
    out: BufWriter<File>,
    tiles: Vec<(TilePlace, u32)>,
}

impl Spool {
    /// A new file in `folder`. It has no name, and goes with the program.
    pub fn new(folder: &Path) -> Result<Self> {
        let file = tempfile::tempfile_in(folder).map_err(|e| Error::io("create a file in", folder, e))?;
        Ok(Self { out: BufWriter::with_capacity(1 << 20, file), tiles: Vec::new() })
    }

    pub fn add(&mut self, tile: TilePlace, bytes: &[u8]) -> std::io::Result<()> {
        self.tiles.push((tile, bytes.len() as u32));
        self.out.write_all(bytes)
    }

    /// Calls `take` with each tile.
    pub fn read(
        self,
        mut take: impl FnMut(TilePlace, &[u8]) -> Result<()>,
        wrong: impl Fn(std::io::Error) -> Error,
    ) -> Result<()> {
        let mut file = self.out.into_inner().map_err(|e| wrong(e.into_error()))?;
        file.seek(SeekFrom::Start(0)).map_err(&wrong)?;
        let mut file = std::io::BufReader::with_capacity(1 << 20, file);
        let mut bytes = Vec::new();
        for (tile, length) in self.tiles {
            bytes.resize(length as usize, 0);
            file.read_exact(&mut bytes).map_err(&wrong)?;
            take(tile, &bytes)?;
        }
        Ok(())
    }
}
