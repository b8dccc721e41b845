//! Writes the groups of a DXF: a code and a value each.

use std::fmt::Display;
use std::fs::File;
use std::io::{BufWriter, Result as Written, Write};
use std::path::Path;

/// The DXF file that is being written.
pub(crate) struct GroupWriter {
    file: BufWriter<File>,
    /// The next free handle.
    handle: u64,
}

impl GroupWriter {
    /// Creates the file. `handle` is the first handle.
    pub fn create(path: &Path, handle: u64) -> Written<Self> {
        let file = File::create(path)?;
        Ok(Self { file: BufWriter::with_capacity(1 << 16, file), handle })
    }

    /// Flushes the buffer.
    pub fn flush(&mut self) -> Written<()> {
        self.file.flush()
    }

    /// Writes a group.
    pub fn put(&mut self, code: i32, value: impl Display) -> Written<()> {
        writeln!(self.file, "{code:>3}\n{value}")
    }

    /// Writes several groups.
    pub fn pairs(&mut self, pairs: &[(i32, &str)]) -> Written<()> {
        pairs.iter().try_for_each(|(code, value)| self.put(*code, value))
    }

    /// Writes numbers under this code and the following ones, ten apart, as coordinates require.
    pub fn numbers(&mut self, code: i32, numbers: &[f64]) -> Written<()> {
        (code..).step_by(10).zip(numbers).try_for_each(|(code, number)| self.put(code, format_args!("{number:?}")))
    }

    /// Begins an object with a new handle, and returns the handle.
    pub fn begin(&mut self, kind: &str, owner: u64) -> Written<u64> {
        let handle = self.handle;
        self.handle += 1;
        self.put(0, kind)?;
        self.put(5, format_args!("{handle:X}"))?;
        self.put(330, format_args!("{owner:X}"))?;
        Ok(handle)
    }

    /// Begins an entity of a layer with a new handle, and returns the handle.
    pub fn begin_entity(&mut self, kind: &str, owner: u64, layer: &str) -> Written<u64> {
        let handle = self.begin(kind, owner)?;
        self.pairs(&[(100, "AcDbEntity"), (8, layer)])?;
        Ok(handle)
    }
}
