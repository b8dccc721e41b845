//! Reads a whole file that must be text.

use std::io::Read;
use std::path::Path;

use crate::ordinary::open_to_read;
use tokosen_core::base::error::{Error, Result};
use tokosen_core::base::memory::check;

/// Text has no zero byte. This many bytes are checked before the rest is read. That is enough to recognise files that
/// are not text, such as a file that has a length but no content.
const BEGINNING: u64 = 4096;
/// Memory per byte of text: the text itself, and about as much for the data read from it.
const BYTES_PER_BYTE: f64 = 2.0;

/// Reads a file that must be text, in any encoding without zero bytes. `other_format` recognises a file of another kind
/// by its first bytes and gives the message. `memory` is the limit in bytes, if there is one.
///
/// # Errors
/// The file cannot be read, `other_format` recognises it, its beginning has a zero byte, or it needs more memory than
/// the limit.
pub(super) fn read(
    path: &Path,
    memory: Option<u64>,
    other_format: fn(&[u8]) -> Option<&'static str>,
) -> Result<Vec<u8>> {
    let unreadable = |e| Error::io("read", path, e);
    let mut file = open_to_read(path)?;
    let length = file.metadata().map_err(unreadable)?.len();
    let mut bytes = Vec::new();
    (&mut file).take(BEGINNING).read_to_end(&mut bytes).map_err(unreadable)?;
    if let Some(what) = other_format(&bytes) {
        return Err(Error::file(path, what));
    }
    without_zeros(path, &bytes, 0)?;
    let remedy = "clip the map first, or save it as a GeoPackage";
    check(BYTES_PER_BYTE * length as f64, memory, format!("reading {} as a whole", path.display()), remedy)?;
    bytes.reserve_exact(usize::try_from(length).unwrap_or(0).saturating_sub(bytes.len()));
    file.read_to_end(&mut bytes).map_err(unreadable)?;
    Ok(bytes)
}

/// Refuses bytes of a file if one of them is zero. `offset` is their position in the file.
///
/// # Errors
/// The message gives the position of the first zero byte.
pub(super) fn without_zeros(path: &Path, bytes: &[u8], offset: u64) -> Result<()> {
    match bytes.iter().position(|&byte| byte == 0) {
        None => Ok(()),
        Some(at) => {
            let message = format!(
                "is not text: its byte {} is zero; the file is broken, or it is saved as UTF-16: save it as UTF-8",
                offset + at as u64 + 1
            );
            Err(Error::file(path, message))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_of_zeros_is_refused_before_it_is_read() {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("a.geojson");
        // The first length exceeds any memory. The file is sparse: its zeros take no space on the disk.
        for (length, start) in [(1 << 42, ""), (1 << 20, "{\"type\":")] {
            std::fs::write(&path, start).unwrap();
            let file = std::fs::File::options().write(true).open(&path).unwrap();
            if file.set_len(length).is_err() {
                // A file system without sparse files cannot hold this file.
                file.set_len(1 << 20).unwrap();
            }
            let said = read(&path, None, |_| None).unwrap_err().to_string();
            assert!(said.contains(&format!("its byte {} is zero", start.len() + 1)), "{said}");
        }
    }

    #[test]
    fn text_longer_than_its_beginning_is_whole() {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("a.dxf");
        let text = "999\nline\n".repeat(2000);
        std::fs::write(&path, &text).unwrap();
        assert_eq!(read(&path, None, |_| None).unwrap(), text.as_bytes());
    }
}
