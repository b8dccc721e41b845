//! The folder of a plan.

use std::ffi::OsStr;
use std::path::{Path, PathBuf};

use tokosen_core::base::error::{Error, Result};
use tokosen_io::StagedOutput;

use super::manifest::{Manifest, NAME, Task};
use super::stored;

/// The folder in it with the files of the tiles.
pub(super) const TILES: &str = "tiles";
/// The kinds of files in it: the lines around a tile, its heights, and what else its task found.
pub(super) const INPUT: &str = "lines";
pub(super) const HEIGHTS: &str = "heights";
pub(super) const RESULT: &str = "result";
/// The file with all lines of the map.
pub(super) const LINES: &str = "lines.bin";

/// Whether a name is that of the hidden folder of an unfinished output.
fn is_unfinished(name: &OsStr) -> bool {
    name.to_string_lossy().starts_with(".tokosen-")
}

/// The folder of a plan, with its manifest.
#[derive(Debug, Clone)]
pub struct Folder {
    path: PathBuf,
    /// The manifest.
    pub manifest: Manifest,
}

impl Folder {
    /// Opens the folder of a plan.
    ///
    /// # Errors
    /// There is no manifest in it, or it is broken or of another version.
    pub fn open(path: &Path) -> Result<Self> {
        let file = path.join(NAME);
        if path.is_dir() && !file.exists() {
            return Err(Error::file(path, "holds no plan: 'tokosen plan' makes one"));
        }
        Ok(Self { path: path.to_owned(), manifest: Manifest::read(&file)? })
    }

    /// Makes the folder for a plan that is still to come. A folder that holds a plan is used again; results that belong to the
    /// new plan too are kept.
    ///
    /// # Errors
    /// The folder cannot be made, or holds other files.
    pub(super) fn make(path: &Path) -> Result<()> {
        let failed = |e| Error::io("create", path, e);
        if path.is_dir() {
            // A plan that failed leaves some of its files.
            let is_other = |name: &OsStr| ![TILES, LINES].iter().any(|own| name == *own) && !is_unfinished(name);
            let mut entries = std::fs::read_dir(path).map_err(|e| Error::io("read", path, e))?;
            let has_others = entries.any(|entry| entry.is_ok_and(|entry| is_other(&entry.file_name())));
            if !path.join(NAME).exists() && has_others {
                return Err(Error::file(path, "holds other files; name a new folder for the plan"));
            }
        }
        std::fs::create_dir_all(path.join(TILES)).map_err(failed)
    }

    /// Stores a manifest: the last file of a plan.
    pub(super) fn store(path: &Path, manifest: &Manifest) -> Result<()> {
        let file = path.join(NAME);
        let staged = StagedOutput::create(&file)?;
        std::fs::write(staged.path(), manifest.text()?).map_err(|e| Error::io("write", &file, e))?;
        staged.commit()?;
        Ok(())
    }

    /// The path of a file of the plan.
    pub(super) fn file(&self, name: &str) -> PathBuf {
        self.path.join(name)
    }

    /// The path of a result of a task, of some kind.
    pub(super) fn result(&self, task: &Task, kind: &str) -> Option<PathBuf> {
        let is_it = |name: &&String| Path::new(name).extension().is_some_and(|own| own == kind);
        task.outputs.iter().find(is_it).map(|name| self.file(name))
    }

    /// The task of a name.
    ///
    /// # Errors
    /// There is none.
    pub fn task(&self, id: &str) -> Result<&Task> {
        self.manifest.tasks.iter().find(|task| task.id == id).ok_or_else(|| {
            let names = match self.manifest.tasks.as_slice() {
                [] => String::new(),
                [only] => format!("; its only task is {}", only.id),
                [first, .., last] => format!("; its tasks are {} to {}", first.id, last.id),
            };
            Error::Parameter(format!("the plan has no task {id}{names}"))
        })
    }

    /// Whether all results of a task are there and whole.
    ///
    /// # Errors
    /// The manifest cannot be stored.
    pub fn is_done(&self, task: &Task) -> Result<bool> {
        let source = self.manifest.source(task)?;
        Ok(task.outputs.iter().all(|name| stored::whole(&self.file(name)).is_some_and(|head| head.source == source)))
    }

    /// Checks that all tasks are done.
    ///
    /// # Errors
    /// Names those that are not.
    pub fn check_done(&self) -> Result<()> {
        let mut open = Vec::new();
        for task in &self.manifest.tasks {
            if !self.is_done(task)? {
                open.push(task.id.as_str());
            }
        }
        let some = open[..open.len().min(5)].join(", ");
        match open.len() {
            0 => Ok(()),
            n @ 1..=5 => Err(self.undone(n, &some)),
            n => Err(self.undone(n, &format!("{some}, ..."))),
        }
    }

    fn undone(&self, count: usize, names: &str) -> Error {
        let of = self.manifest.tasks.len();
        let message = format!(
            "{count} of {of} tasks are not done, or their files are damaged: {names}; 'tokosen work' does them"
        );
        Error::file(&self.path, message)
    }
}
