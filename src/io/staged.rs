//! An output that appears complete or not at all.
//!
//! Files are written into a hidden folder beside the target and moved into place at the end. This has three benefits:
//! an output folder that is missing or write-protected is noticed before the long computation; a broken file never
//! replaces a finished one; formats of several files get their final names together.
//!
//! Dropping the output without [`StagedOutput::commit`] removes everything. A process that is ended by a signal runs no
//! destructors: a program that catches the signal calls [`discard_unfinished`]. A process that is killed leaves its
//! hidden folder (`.tokosen-…`) behind. Nothing reads it, and the next run that writes there removes it.

use std::ffi::{OsStr, OsString};
use std::fs::{self, File};
use std::io::ErrorKind;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError};

use tempfile::TempDir;

use super::abandoned::{LOCK, PREFIX, lock, remove_abandoned};
use super::companions::{foreign_prj, stale};
use super::format::VectorFormat;
use super::gpkg;
use super::ordinary::{check_folder, check_replaceable};
use tokosen_core::base::error::{Error, Result};

/// The hidden folders of all unfinished outputs. The list is global because a signal is for the whole process. While
/// this lock is held, no output is being moved into place.
static UNFINISHED: Mutex<Vec<PathBuf>> = Mutex::new(Vec::new());

/// How often the removal of a folder is tried, because another thread may still write to it.
const TRIES: usize = 20;

/// The name of a folder that is replaced, until it is removed.
const FORMER: &str = ".former";

fn unfinished() -> MutexGuard<'static, Vec<PathBuf>> {
    UNFINISHED.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Removes everything that unfinished outputs have written, then runs `last`. No output can be finished during `last`.
///
/// For a process that is about to end by a signal. If an output is just being moved into place, this function waits for
/// it.
pub fn discard_unfinished<T>(last: impl FnOnce() -> T) -> T {
    let mut folders = unfinished();
    for folder in folders.drain(..) {
        // Removal fails if another thread has just created a file in the folder.
        let _ = (0..TRIES).find(|_| fs::remove_dir_all(&folder).is_ok() || !folder.exists());
    }
    last()
}

/// An unfinished output: a target file, or several files beside each other.
#[derive(Debug)]
pub struct StagedOutput {
    /// The final path of the main file. Symbolic links are resolved: a link stays a link.
    target: PathBuf,
    folder: PathBuf,
    /// Open as long as the output is unfinished. It is closed before the folder is removed.
    lock: File,
    staging: TempDir,
}

impl StagedOutput {
    /// Creates the hidden folder beside `target`.
    ///
    /// # Errors
    /// `target` is a folder, a device or not a file name, or its folder is missing or cannot be written to.
    pub fn create(target: &Path) -> Result<Self> {
        // Otherwise "x/" would name the file x.
        let ends_open =
            target.as_os_str().as_encoded_bytes().last().is_some_and(|&b| std::path::is_separator(b.into()));
        if target.file_name().is_none() || ends_open {
            return Err(Error::Parameter(format!("{} is not a file name to write to", target.display())));
        }
        let target = if target.is_symlink() && target.exists() {
            target.canonicalize().map_err(|e| Error::io("follow the link", target, e))?
        } else {
            target.to_owned()
        };
        check_replaceable(&target)?;
        Self::beside(target)
    }

    /// Creates the hidden folder beside `target`, which will be a folder. If it exists, [`StagedOutput::commit`] replaces it as
    /// a whole.
    ///
    /// # Errors
    /// `target` is a file, or its own folder is missing or cannot be written to.
    pub fn create_folder(target: &Path) -> Result<Self> {
        check_folder(target)?;
        Self::beside(target.to_owned())
    }

    fn beside(target: PathBuf) -> Result<Self> {
        let folder = match target.parent() {
            Some(parent) if !parent.as_os_str().is_empty() => parent.to_owned(),
            _ => PathBuf::from("."),
        };
        remove_abandoned(&folder);
        let mut unfinished = unfinished();
        let staging = tempfile::Builder::new()
            .prefix(PREFIX)
            .tempdir_in(&folder)
            .map_err(|e| Error::io("create a file in", &folder, without_path(e)))?;
        // Finished or dropped outputs no longer have a folder on the disk.
        unfinished.retain(|folder| folder.exists());
        unfinished.push(staging.path().to_owned());
        let lock = lock(staging.path()).map_err(|e| Error::io("create a file in", &folder, without_path(e)))?;
        Ok(Self { target, folder, staging, lock })
    }

    /// The final path of the main file.
    pub fn target(&self) -> &Path {
        &self.target
    }

    /// The folder in which files appear under their final names. Temporary files may be made there.
    pub fn folder(&self) -> &Path {
        &self.folder
    }

    /// The path at which to write the main file.
    pub fn path(&self) -> PathBuf {
        self.sibling(self.target.file_name().unwrap_or_default())
    }

    /// The path at which to write a file that will be called `name`, beside the target.
    pub fn sibling(&self, name: impl AsRef<OsStr>) -> PathBuf {
        self.staging.path().join(name.as_ref())
    }

    /// Replaces the path in an error about a file of this output: the user knows the final name, not the one in the
    /// hidden folder.
    pub fn with_final_name(&self, error: Error) -> Error {
        let renamed = |path: PathBuf| match path.strip_prefix(self.staging.path()) {
            Ok(name) => self.folder.join(name),
            Err(_) => path,
        };
        match error {
            Error::Io { action, path, source } => Error::Io { action, path: renamed(path), source },
            Error::File { path, message, source } => Error::File { path: renamed(path), message, source },
            Error::InFile { path, error } => Error::InFile { path: renamed(path), error },
            other => other,
        }
    }

    /// Flushes all files to the disk and moves them to the target's folder, the main file last. Returns the target's
    /// path. Layers of a GeoPackage that exists are added to it instead, in one transaction.
    ///
    /// Files that belong to the former content of a target, such as a spatial index or a statistics file, are removed.
    ///
    /// # Errors
    /// The disk is full, a file of that name cannot be replaced, or a `.prj` would be wrong for another file of its name.
    /// Files that were already moved stay.
    pub fn commit(self) -> Result<PathBuf> {
        // The lock makes a signal wait: either all files get their names, or none.
        let _unfinished = unfinished();
        let names = self.staged_names()?;
        // A folder is moved as a whole. It may have a million files.
        for name in names.iter().filter(|name| !self.sibling(name).is_dir()) {
            let path = self.sibling(name);
            File::open(&path)
                .and_then(|file| file.sync_all())
                .map_err(|e| Error::io("write", &self.folder.join(name), e))?;
        }
        foreign_prj(self.staging.path(), &self.folder, &names)?;
        let (mut added, mut moved) = (Vec::new(), Vec::new());
        for name in &names {
            if self.is_added(name)? { added.push(name) } else { moved.push(name) }
        }
        for name in &moved {
            for stale in stale(name).into_iter().filter(|stale| !names.contains(stale)) {
                let path = self.folder.join(stale);
                if path.is_file() {
                    fs::remove_file(&path).map_err(|e| Error::io("remove the outdated", &path, e))?;
                }
            }
        }
        for name in added {
            gpkg::merge(&self.sibling(name), &self.folder.join(name))?;
        }
        for name in moved {
            self.put(name)?;
        }
        // The file names are only safe on the disk after the folder is flushed. Not every file system can do that. The
        // content is already safe, therefore a failure here is ignored.
        if let Ok(folder) = File::open(&self.folder) {
            let _ = folder.sync_all();
        }
        drop(self.lock);
        self.staging.close().map_err(|e| Error::io("remove the temporary folder in", &self.folder, e))?;
        Ok(self.target)
    }

    /// Whether the file's layers are added to a GeoPackage that exists.
    fn is_added(&self, name: &OsStr) -> Result<bool> {
        Ok(is_database(name) && gpkg::is_there(&self.folder.join(name))?)
    }

    /// Gives a file its final name. If another run has just made a GeoPackage of that name, the layers are added to it.
    fn put(&self, name: &OsStr) -> Result<()> {
        let (staged, goal) = (self.sibling(name), self.folder.join(name));
        // A second name is refused where a file has it; a rename would replace that file. Some file systems have no second
        // names.
        if is_database(name) {
            match fs::hard_link(&staged, &goal) {
                Ok(()) => return fs::remove_file(&staged).map_err(|e| Error::io("replace", &goal, e)),
                Err(e) if e.kind() == ErrorKind::AlreadyExists && gpkg::is_there(&goal)? => {
                    return gpkg::merge(&staged, &goal);
                }
                Err(_) => {}
            }
        }
        if staged.is_dir() && goal.is_dir() {
            // Another program may have put a file there meanwhile.
            check_folder(&goal)?;
            // A folder replaces another one only if that is empty. The former one goes with the hidden folder.
            fs::rename(&goal, self.sibling(FORMER)).map_err(|e| Error::io("replace", &goal, e))?;
        }
        fs::rename(&staged, &goal).map_err(|e| Error::io("replace", &goal, e))
    }

    /// The names of the staged files in order, the main file last.
    fn staged_names(&self) -> Result<Vec<OsString>> {
        let list = || -> std::io::Result<Vec<OsString>> {
            fs::read_dir(self.staging.path())?.map(|entry| entry.map(|e| e.file_name())).collect()
        };
        let mut names = list().map_err(|e| Error::io("read", self.staging.path(), e))?;
        names.retain(|name| name != LOCK);
        let main = self.target.file_name();
        names.sort_by_key(|name| (Some(name.as_os_str()) == main, name.clone()));
        Ok(names)
    }
}

fn is_database(name: &OsStr) -> bool {
    matches!(VectorFormat::from_path(Path::new(name)), Ok(VectorFormat::GeoPackage))
}

/// The system's message, without the temporary file's name, which means nothing to the user.
fn without_path(error: std::io::Error) -> std::io::Error {
    let text = error.to_string();
    match text.split_once(" at path ") {
        Some((words, _)) => std::io::Error::new(error.kind(), words),
        None => error,
    }
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;

    /// The names in a folder, sorted.
    pub(crate) fn names_in(folder: &Path) -> Vec<String> {
        let mut names: Vec<String> =
            fs::read_dir(folder).unwrap().map(|e| e.unwrap().file_name().into_string().unwrap()).collect();
        names.sort();
        names
    }

    #[test]
    fn commit_moves_every_file_and_leaves_no_folder() {
        let dir = tempfile::tempdir().unwrap();
        fs::write(dir.path().join("a.shp"), "old").unwrap();
        let staged = StagedOutput::create(&dir.path().join("a.shp")).unwrap();
        fs::write(staged.path(), "new").unwrap();
        fs::write(staged.sibling("a.shx"), "index").unwrap();
        assert_eq!(fs::read_to_string(dir.path().join("a.shp")).unwrap(), "old");
        staged.commit().unwrap();
        assert_eq!(names_in(dir.path()), ["a.shp", "a.shx"]);
        assert_eq!(fs::read_to_string(dir.path().join("a.shp")).unwrap(), "new");
    }

    #[test]
    fn drop_leaves_the_folder_as_it_was() {
        let dir = tempfile::tempdir().unwrap();
        fs::write(dir.path().join("a.gpkg"), "old").unwrap();
        let staged = StagedOutput::create(&dir.path().join("a.gpkg")).unwrap();
        fs::write(staged.path(), "half").unwrap();
        drop(staged);
        assert_eq!(names_in(dir.path()), ["a.gpkg"]);
        assert_eq!(fs::read_to_string(dir.path().join("a.gpkg")).unwrap(), "old");
    }

    #[test]
    fn errors_name_the_final_file() {
        let dir = tempfile::tempdir().unwrap();
        let staged = StagedOutput::create(&dir.path().join("a.tif")).unwrap();
        let full = std::io::Error::from(std::io::ErrorKind::StorageFull);
        let error = staged.with_final_name(Error::io("write", &staged.path(), full));
        assert_eq!(error.to_string(), format!("cannot write {}", dir.path().join("a.tif").display()));
        let elsewhere = staged.with_final_name(Error::file(Path::new("/b.tif"), "is odd"));
        assert_eq!(elsewhere.to_string(), "/b.tif: is odd");
    }

    #[test]
    fn bad_targets_are_refused_before_anything_is_made() {
        let dir = tempfile::tempdir().unwrap();
        let missing = StagedOutput::create(&dir.path().join("no/such/a.gpkg")).unwrap_err();
        assert!(missing.to_string().contains("no/such"), "{missing}");
        let cause = std::error::Error::source(&missing).unwrap().to_string();
        assert!(!cause.contains(".tokosen"), "{cause}");
        assert!(StagedOutput::create(dir.path()).unwrap_err().to_string().contains("is a folder"));
        assert!(StagedOutput::create(Path::new("")).is_err());
        assert!(StagedOutput::create(Path::new("/")).is_err());
        assert!(StagedOutput::create(&dir.path().join("a/")).is_err());
        assert!(StagedOutput::create(&dir.path().join("..")).is_err());
        assert!(names_in(dir.path()).is_empty());
    }

    #[test]
    fn a_protected_file_is_not_replaced() {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("a.gpkg");
        fs::write(&path, "old").unwrap();
        let mut permissions = fs::metadata(&path).unwrap().permissions();
        permissions.set_readonly(true);
        fs::set_permissions(&path, permissions).unwrap();
        assert!(StagedOutput::create(&path).unwrap_err().to_string().contains("is write-protected"));
        assert_eq!(names_in(dir.path()), ["a.gpkg"]);
    }

    #[test]
    fn what_is_discarded_is_what_is_unfinished() {
        let dir = tempfile::tempdir().unwrap();
        let done = StagedOutput::create(&dir.path().join("a.tif")).unwrap();
        fs::write(done.path(), "whole").unwrap();
        done.commit().unwrap();
        let begun = StagedOutput::create(&dir.path().join("b.tif")).unwrap();
        fs::write(begun.path(), "half").unwrap();
        let folder = begun.staging.path().to_owned();
        // Other tests may have unfinished outputs too.
        assert!(unfinished().contains(&folder));
        drop(begun);
        drop(StagedOutput::create(&dir.path().join("c.tif")).unwrap());
        assert!(!unfinished().contains(&folder), "the next one looks after those that were dropped");
        assert_eq!(names_in(dir.path()), ["a.tif"]);
    }

    #[test]
    fn a_geopackage_that_appears_meanwhile_keeps_its_layers() {
        use crate::layer::{Geometry, Layer};
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("a.gpkg");
        let layer = |name| [Layer { name, geometry: Geometry::Lines, columns: &[], rows: Vec::new() }];
        let staged = ["one", "two"].map(|name| {
            let staged = StagedOutput::create(&path).unwrap();
            crate::write_layers(&staged, &layer(name), None).unwrap();
            staged
        });
        // As if both runs had looked at the same moment, and seen that there is no file.
        for staged in staged {
            staged.put(OsStr::new("a.gpkg")).unwrap();
        }
        assert!(gpkg::check_layers(&path, &["one"], false, true).is_err(), "the layer is there");
        assert!(gpkg::check_layers(&path, &["two"], false, true).is_err(), "the layer is there");
    }

    #[cfg(unix)]
    #[test]
    fn a_device_is_refused_and_a_link_is_followed() {
        assert!(StagedOutput::create(Path::new("/dev/null")).unwrap_err().to_string().contains("ordinary"));
        let dir = tempfile::tempdir().unwrap();
        let real = dir.path().join("real");
        fs::create_dir(&real).unwrap();
        fs::write(real.join("b.tif"), "old").unwrap();
        std::os::unix::fs::symlink(real.join("b.tif"), dir.path().join("link.tif")).unwrap();
        let staged = StagedOutput::create(&dir.path().join("link.tif")).unwrap();
        fs::write(staged.path(), "new").unwrap();
        staged.commit().unwrap();
        assert!(dir.path().join("link.tif").is_symlink());
        assert_eq!(fs::read_to_string(real.join("b.tif")).unwrap(), "new");
    }
}
