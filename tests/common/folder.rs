//! A folder for a test's files, which goes when the test ends. Tests add what they put into it and run in it.

use std::path::PathBuf;

use tempfile::TempDir;

/// The folder.
pub struct Folder(pub TempDir);

impl Folder {
    /// An empty one.
    pub fn new() -> Self {
        Self(tempfile::tempdir().expect("a folder for temporary files"))
    }

    /// A place in it.
    pub fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }
}
