//! Checks that the files of a run do not overwrite each other.

use std::path::{Path, PathBuf};

use crate::base::error::{Error, Result};

/// Refuses to write over an input, or to write two outputs into one file.
///
/// # Errors
/// [`Error::Parameter`] names the first output that conflicts.
pub fn check_paths(inputs: &[&Path], outputs: &[&Path]) -> Result<()> {
    let inputs: Vec<PathBuf> = inputs.iter().map(|path| identity(path)).collect();
    let mut taken = Vec::new();
    for path in outputs {
        let file = identity(path);
        if inputs.contains(&file) {
            return Err(Error::Parameter(format!(
                "{} is an input: choose another name for the output",
                path.display()
            )));
        }
        if taken.contains(&file) {
            return Err(Error::Parameter(format!("{} is the name of two outputs", path.display())));
        }
        taken.push(file);
    }
    Ok(())
}

/// A form of the path that is the same for all paths of one file, even if the file does not exist yet.
fn identity(path: &Path) -> PathBuf {
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let made = || Some(folder.canonicalize().ok()?.join(path.file_name()?));
    path.canonicalize().ok().or_else(made).unwrap_or_else(|| path.to_owned())
}
