//! A folder for a test's files, which goes when the test ends. Tests add what they put into it and run in it.

use std::marker::PhantomData;
use std::path::PathBuf;

use tempfile::TempDir;

/// The folder. `Tests` is a type of each module of tests, so that the methods that one adds are its own.
pub struct Folder<Tests = ()>(pub TempDir, PhantomData<Tests>);

impl<Tests> Folder<Tests> {
    /// An empty one.
    pub fn new() -> Self {
        Self(tempfile::tempdir().expect("a folder for temporary files"), PhantomData)
    }

    /// A place in it.
    pub fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }
}
