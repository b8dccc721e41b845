//! Groups of a DXF out: a code and a value each.

use std::fmt::Display;
use std::fs::File;
use std::io::{BufWriter, Result as Written, Write};
use std::path::Path;

/// The groups written so far.
pub(super) struct Groups {
    file: BufWriter<File>,
    /// The next handle.
    handle: u64,
}

impl Groups {
    /// Creates the file. `handle` is the first handle.
    pub fn create(path: &Path, handle: u64) -> Written<Self> {
        let file = File::create(path)?;
        Ok(Self { file: BufWriter::with_capacity(1 << 16, file), handle })
    }

    /// Makes sure that the last byte has left the buffer.
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

    /// Writes numbers under this and the following codes, each ten on, as coordinates have them.
    pub fn numbers(&mut self, code: i32, numbers: &[f64]) -> Written<()> {
        (code..).step_by(10).zip(numbers).try_for_each(|(code, number)| self.put(code, format_args!("{number:?}")))
    }

    /// Begins an object with a handle that no other has, and gives that back.
    pub fn begin(&mut self, kind: &str, owner: u64) -> Written<u64> {
        let handle = self.handle;
        self.handle += 1;
        self.put(0, kind)?;
        self.put(5, format_args!("{handle:X}"))?;
        self.put(330, format_args!("{owner:X}"))?;
        Ok(handle)
    }

    /// Begins an entity of a layer with a handle that no other has, and gives that back.
    pub fn begin_entity(&mut self, kind: &str, owner: u64, layer: &str) -> Written<u64> {
        let handle = self.begin(kind, owner)?;
        self.pairs(&[(100, "AcDbEntity"), (8, layer)])?;
        Ok(handle)
    }
}
