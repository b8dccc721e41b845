//! Ordinary files: opens them to read, and refuses what is none, as an input and as an output.
//!
//! To open a named pipe means to wait until another program writes to it, and a device may have no end. A file beside an
//! input, such as a `.prj`, is small; one of some gigabytes is not what it should be.

use std::fs::{self, File};
use std::io::Read;
use std::path::Path;

use super::tiles::foreign_entry;
use tokosen_core::base::error::{Error, Result};

/// The largest file beside an input that describes it, bytes. Files with statistics of many bands have some hundred kilobytes.
pub(super) const MAX_DESCRIPTION: u64 = 64 << 20;

/// Opens an ordinary file to read it.
///
/// # Errors
/// The file is missing, may not be read, is a folder, or is no ordinary file: a device, a named pipe, a socket.
pub fn open_to_read(path: &Path) -> Result<File> {
    check_ordinary(path)?;
    File::open(path).map_err(|e| Error::io("read", path, e))
}

/// Reads a file that is small. `what` is its kind in the message, such as "a saved run".
///
/// # Errors
/// As [`open_to_read`], and if the file has more than `most` bytes.
pub fn read_small(path: &Path, most: u64, what: &str) -> Result<Vec<u8>> {
    let failed = |e| Error::io("read", path, e);
    let file = open_to_read(path)?;
    let too_large = |length: u64| length > most;
    let mut bytes = Vec::new();
    if !too_large(file.metadata().map_err(failed)?.len()) {
        file.take(most + 1).read_to_end(&mut bytes).map_err(failed)?;
        if !too_large(bytes.len() as u64) {
            return Ok(bytes);
        }
    }
    Err(Error::file(path, format!("is too large for {what}, which has at most {} MB", most >> 20)))
}

/// Refuses to replace a folder, what is no ordinary file, and a write-protected file.
///
/// # Errors
/// [`Error::File`] names the path.
pub(super) fn check_replaceable(path: &Path) -> Result<()> {
    let refuse = |message: &str| Err(Error::file(path, message));
    match fs::metadata(path) {
        Ok(meta) if meta.is_dir() => refuse("is a folder; name a file in it to write to"),
        Ok(meta) if !meta.is_file() => refuse("is not an ordinary file; name one to write to"),
        // The folder's permissions would allow replacing the file. Its owner protected it, so this is refused.
        Ok(meta) if meta.permissions().readonly() => {
            refuse("is write-protected; take the protection off, or name another file")
        }
        _ => Ok(()),
    }
}

/// Refuses to replace what is no folder by one, and a folder that holds other files than tiles: they would be lost.
///
/// # Errors
/// [`Error::File`] names the path. [`Error::Io`] if a folder cannot be read.
pub(super) fn check_folder(path: &Path) -> Result<()> {
    match fs::symlink_metadata(path) {
        Ok(meta) if !meta.is_dir() => {
            return Err(Error::file(path, "is not a folder; name another one for the tiles"));
        }
        Ok(_) => {}
        Err(_) => return Ok(()),
    }
    match foreign_entry(path).map_err(|e| Error::io("read", path, e))? {
        None => Ok(()),
        Some(entry) => {
            let message =
                "is no tile and would be lost: the folder of tiles is replaced as a whole; name another folder";
            Err(Error::file(&entry, message))
        }
    }
}

/// Refuses a folder, a device, a named pipe and a socket. A link counts as what it leads to.
pub(super) fn check_ordinary(path: &Path) -> Result<()> {
    let meta = fs::metadata(path).map_err(|e| Error::io("read", path, e))?;
    if meta.is_dir() {
        return Err(Error::file(path, "is a folder; name a file in it"));
    }
    if !meta.is_file() {
        return Err(Error::file(
            path,
            "is not an ordinary file, but a device, a pipe or a socket; copy it to a file first",
        ));
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn small_files_are_read_and_large_ones_are_not() {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("a.json");
        let what = "a saved run";
        for (length, is_read) in [(0, true), (1 << 20, true), ((1 << 20) + 1, false), (1 << 32, false)] {
            // The file is sparse: its zeros take no space on the disk.
            File::create(&path).unwrap().set_len(length).unwrap();
            match read_small(&path, 1 << 20, what) {
                Ok(bytes) => assert!(is_read && bytes.len() as u64 == length, "{length}"),
                Err(error) => assert!(!is_read && error.to_string().contains("too large for a saved run"), "{error}"),
            }
        }
        assert!(read_small(dir.path(), 1, what).unwrap_err().to_string().contains("is a folder"));
        assert!(matches!(read_small(&dir.path().join("missing"), 1, what), Err(Error::Io { .. })));
    }

    #[cfg(unix)]
    #[test]
    fn devices_and_sockets_are_refused() {
        let dir = tempfile::tempdir().unwrap();
        let socket = dir.path().join("a.gpkg");
        let _socket = std::os::unix::net::UnixListener::bind(&socket).unwrap();
        let link = dir.path().join("b.gpkg");
        std::os::unix::fs::symlink("/dev/zero", &link).unwrap();
        for path in [Path::new("/dev/null"), &socket, &link] {
            let error = open_to_read(path).unwrap_err().to_string();
            assert!(error.contains("is not an ordinary file"), "{error}");
        }
    }
}
