//! Hidden folders of runs that were killed: their outputs are never finished, so the next run in the same place removes
//! them.
//!
//! Every run holds a lock on a file in its hidden folder. The system releases it when the process ends, however it ends.

use std::fs::{self, File, TryLockError};
use std::path::Path;
use std::time::Duration;

/// Beginning of the names of hidden folders.
pub(super) const PREFIX: &str = ".tokosen-";
/// The name of the locked file.
pub(super) const LOCK: &str = ".lock";
/// A younger folder may belong to a run that is about to lock it.
const YOUNG: Duration = Duration::from_secs(60);

/// Creates the file in the hidden folder `staging` and locks it. The lock holds as long as the file is open.
pub(super) fn lock(staging: &Path) -> std::io::Result<File> {
    let file = File::create(staging.join(LOCK))?;
    // Some network file systems have no locks. Then nothing is ever removed.
    let _ = file.try_lock();
    Ok(file)
}

/// Removes the hidden folders in `folder` whose runs have ended. What cannot be removed stays: it disturbs nothing.
pub(super) fn remove_abandoned(folder: &Path) {
    let Ok(entries) = fs::read_dir(folder) else { return };
    let is_hidden = |name: &std::ffi::OsStr| name.to_string_lossy().starts_with(PREFIX);
    for entry in entries.flatten().filter(|entry| is_hidden(&entry.file_name())) {
        let path = entry.path();
        if is_abandoned(&path) {
            let _ = fs::remove_dir_all(&path);
        }
    }
}

fn is_abandoned(staging: &Path) -> bool {
    let path = staging.join(LOCK);
    let meta = fs::metadata(&path).ok().filter(fs::Metadata::is_file);
    let age = meta.and_then(|meta| meta.modified().ok()).and_then(|time| time.elapsed().ok());
    if age.is_none_or(|age| age <= YOUNG) {
        return false;
    }
    let Ok(file) = File::options().write(true).open(&path) else { return false };
    !matches!(file.try_lock(), Err(TryLockError::WouldBlock | TryLockError::Error(_)))
}

#[cfg(test)]
mod tests {
    use std::time::SystemTime;

    use super::*;

    #[test]
    fn only_folders_of_runs_that_have_ended_are_removed() {
        let dir = tempfile::tempdir().unwrap();
        let make = |name: &str, age: u64| {
            let staging = dir.path().join(name);
            fs::create_dir(&staging).unwrap();
            fs::write(staging.join("half.gpkg"), "half").unwrap();
            let file = lock(&staging).unwrap();
            file.set_modified(SystemTime::now() - Duration::from_secs(age)).unwrap();
            file
        };
        let running = make(".tokosen-running", 600);
        drop(make(".tokosen-ended", 600));
        drop(make(".tokosen-young", 5));
        drop(make("other", 600));
        fs::create_dir(dir.path().join(".tokosen-without")).unwrap();
        remove_abandoned(dir.path());
        let mut names: Vec<_> = fs::read_dir(dir.path()).unwrap().map(|e| e.unwrap().file_name()).collect();
        names.sort();
        assert_eq!(names, [".tokosen-running", ".tokosen-without", ".tokosen-young", "other"]);
        drop(running);
        remove_abandoned(dir.path());
        assert!(!dir.path().join(".tokosen-running").exists());
    }
}
