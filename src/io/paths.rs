//! Checks before the work that no file is lost: no input, and no file that another program made.

use std::path::{Path, PathBuf};

use super::companions::read_beside;
use super::format::VectorFormat;
use super::ordinary::{check_folder, check_replaceable};
use super::tiles::TileFormat;
use super::{gpkg, maker};
use tokosen_core::base::error::{Error, Result};

/// A file to write.
#[derive(Debug, Clone, Copy)]
pub struct PlannedOutput<'a> {
    /// Its path.
    pub path: &'a Path,
    /// The names of the layers that go into it, if it is a GeoPackage.
    pub layers: &'a [&'a str],
}

impl<'a> From<&'a Path> for PlannedOutput<'a> {
    fn from(path: &'a Path) -> Self {
        Self { path, layers: &[] }
    }
}

/// Refuses to write over an input, to write two outputs into one file, and to replace what another program made.
///
/// A GeoPackage that exists keeps its layers, and gets further ones. So an input may also be an output there, if no layer
/// of it is replaced. Files and layers that this program made are replaced, so that a script can run twice. Where a
/// format has no place to name the program (`.shp`, `.asc`, `.xyz`), a file counts as made by another one. `overwrite`
/// allows replacing all files, and layers of a GeoPackage, except inputs.
///
/// # Errors
/// [`Error::Parameter`] names the first output that conflicts with an input or another output, [`Error::Exists`] and
/// [`Error::LayerExists`] the first that would be lost. [`Error::File`] if a GeoPackage cannot be read, and if an output is
/// a folder, no ordinary file, or write-protected.
pub fn check_paths(inputs: &[&Path], outputs: &[PlannedOutput<'_>], overwrite: bool) -> Result<()> {
    let inputs: Vec<PathBuf> = inputs.iter().map(|path| identity(path)).collect();
    let mut taken: Vec<PathBuf> = Vec::new();
    let folders: Vec<PathBuf> =
        outputs.iter().filter_map(|output| Some(identity(&TileFormat::folder(output.path)?.0))).collect();
    for PlannedOutput { path, layers } in outputs {
        let is_folder = TileFormat::folder(path).is_some();
        let path: &Path = &TileFormat::target(path);
        let file = identity(path);
        let is_input = inputs.contains(&file);
        let is_database = matches!(VectorFormat::from_path(path), Ok(VectorFormat::GeoPackage));
        if is_input && !is_database {
            return Err(Error::Parameter(format!(
                "{} is an input: choose another name for the output",
                path.display()
            )));
        }
        if taken.contains(&file) {
            return Err(Error::Parameter(format!("{} is the name of two outputs", path.display())));
        }
        if let Some(folder) = folders.iter().find(|folder| file != **folder && file.starts_with(folder)) {
            return Err(Error::Parameter(format!(
                "{} lies in the folder of the tiles, {}, which is replaced as a whole: choose another place for it",
                path.display(),
                folder.display()
            )));
        }
        parts(path).try_for_each(|part| if is_folder { check_folder(&part) } else { check_replaceable(&part) })?;
        if is_database {
            gpkg::check_layers(path, layers, overwrite, is_input)?;
        } else if !overwrite && let Some(path) = parts(path).find(|path| path.exists() && !maker::is_own(path)) {
            return Err(Error::Exists { path });
        }
        taken.push(file);
    }
    Ok(())
}

/// The files that are read for an input, if they exist: the file, and those beside it that belong to it, such as the `.dbf`
/// of a shapefile; or all files in a folder and the folders in it, by name.
///
/// # Errors
/// A folder cannot be read.
pub fn files_of_input(path: &Path) -> Result<Vec<PathBuf>> {
    let mut files = Vec::new();
    if path.is_dir() {
        let list = || std::fs::read_dir(path)?.map(|entry| Ok(entry?.path())).collect::<std::io::Result<Vec<_>>>();
        let mut entries = list().map_err(|e| Error::io("read", path, e))?;
        entries.sort();
        // A link to a folder could lead around in a circle.
        for entry in entries.into_iter().filter(|entry| entry.is_file() || !entry.is_symlink()) {
            files.append(&mut files_of_input(&entry)?);
        }
        return Ok(files);
    }
    let name = path.file_name().unwrap_or_default();
    let beside = read_beside(name).into_iter().map(|name| path.with_file_name(name));
    files.extend(std::iter::once(path.to_owned()).chain(beside).filter(|file| file.is_file()));
    Ok(files)
}

/// The files of an output that hold data.
fn parts(path: &Path) -> impl Iterator<Item = PathBuf> {
    let is_shapefile = matches!(VectorFormat::from_path(path), Ok(VectorFormat::Shapefile));
    let others =
        ["shx", "dbf"].into_iter().filter(move |_| is_shapefile).map(|extension| path.with_extension(extension));
    std::iter::once(path.to_owned()).chain(others)
}

/// A form of the path that is the same for all paths of one file, even if the file does not exist yet.
fn identity(path: &Path) -> PathBuf {
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let made = || Some(folder.canonicalize().ok()?.join(path.file_name()?));
    path.canonicalize().ok().or_else(made).unwrap_or_else(|| path.to_owned())
}
