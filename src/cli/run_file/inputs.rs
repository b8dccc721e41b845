//! The size and the checksum of the files that a run reads.

use std::collections::HashSet;
use std::io::{BufReader, Read, sink};
use std::path::{Path, PathBuf};

use flate2::CrcReader;
use tokosen::base::error::{Error, Result};
use tokosen::io::{files_of_input, open_to_read};

use super::file::{InputFile, RunFile};

/// Bytes that are read at once.
const BLOCK: usize = 1 << 18;

/// The inputs of a run with sizes and checksums.
///
/// # Errors
/// A file cannot be read. A missing file is no error here: the reader says more about it.
pub fn inputs(paths: &[&Path]) -> Result<Vec<InputFile>> {
    files(paths)?.iter().map(|file| input(file)).collect()
}

/// The files that a repeated run reads and the saved one did not, for instance a new sheet in a folder.
///
/// # Errors
/// A folder cannot be read.
pub fn further(saved: &RunFile, paths: &[&Path]) -> Result<Vec<PathBuf>> {
    let known: HashSet<&PathBuf> = saved.inputs.iter().map(|input| &input.file).collect();
    Ok(files(paths)?.into_iter().filter(|file| !known.contains(file)).collect())
}

/// The files behind the inputs of a run, each once: the files in a folder, and those that belong to a file, such as the
/// `.dbf` of a shapefile.
fn files(paths: &[&Path]) -> Result<Vec<PathBuf>> {
    let mut files = Vec::new();
    for path in paths {
        files.append(&mut files_of_input(path)?);
    }
    files.sort();
    files.dedup();
    Ok(files)
}

/// A file with its size and checksum.
///
/// # Errors
/// The file cannot be read.
pub fn input(path: &Path) -> Result<InputFile> {
    let unread = |e| Error::io("read", path, e);
    let file = open_to_read(path)?;
    let mut reader = CrcReader::new(BufReader::with_capacity(BLOCK, file));
    let bytes = std::io::copy(&mut reader.by_ref(), &mut sink()).map_err(unread)?;
    Ok(InputFile { file: path.to_owned(), bytes, crc32: format!("{:08x}", reader.crc().sum()) })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_checksum_is_the_usual_crc_32() {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("check.txt");
        std::fs::write(&path, "123456789").unwrap();
        let found = input(&path).unwrap();
        assert_eq!((found.bytes, found.crc32.as_str()), (9, "cbf43926"));
        assert!(input(&dir.path().join("missing")).is_err());
    }
}
