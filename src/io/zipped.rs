//! Zip archives that hold one file of another format: zipped shapefiles, and the KML in a `.kmz`.
//!
//! What is unpacked has the limits of the archives of 基盤地図情報, so that a small archive cannot fill the disk.

use std::fs::File;
use std::io::{BufReader, Read, Seek};
use std::path::{Path, PathBuf};

use zip::ZipArchive;

use super::gsi::archive::{budget, has_extension, is_served, unlimited_copy};
use super::meter::{DocumentReader, LimitedReader};
use super::shapefile;
use super::table::{Request, Table};
use super::xml::unreadable;
use crate::ordinary::open_to_read;
use tokosen_core::base::error::{Error, Result};

const BUFFER: usize = 1 << 17;

/// The parts of a shapefile that are read.
const PARTS: [&str; 5] = ["shp", "shx", "dbf", "prj", "cpg"];

/// The names in an archive, each with its number.
type Names = Vec<(String, usize)>;

/// Whether an archive holds shapefiles and no files of 基盤地図情報. Of what cannot be opened, the reader will tell.
pub(super) fn is_shapefile(path: &Path) -> bool {
    let Ok(file) = open_to_read(path) else { return false };
    let Ok(archive) = ZipArchive::new(BufReader::new(file)) else { return false };
    let mut found = false;
    for name in archive.file_names().flatten() {
        let short = file_name(&name);
        if is_served(short) {
            return false;
        }
        found |= is_part(short, "shp");
    }
    found
}

/// Reads a zipped shapefile. The layer is the name of the `.shp` without its extension; it chooses one of several.
pub(super) fn read_shapefile(path: &Path, request: &Request<'_>) -> Result<Table> {
    let (mut archive, names, length) = open(path)?;
    let stem = |name: &str| Path::new(file_name(name)).file_stem().unwrap_or_default().to_string_lossy().into_owned();
    let mut found: Vec<&String> =
        names.iter().map(|(name, _)| name).filter(|name| is_part(file_name(name), "shp")).collect();
    if let Some(layer) = request.layer {
        let layers = found.iter().map(|name| format!("{:?}", stem(name))).collect::<Vec<_>>().join(", ");
        found.retain(|name| stem(name) == layer);
        if found.is_empty() {
            return Err(Error::file(path, format!("there is no layer {layer:?}; its shapefiles are {layers}")));
        }
    }
    let [shp] = found[..] else {
        let layers = found.iter().map(|name| stem(name)).collect();
        return Err(Error::LayerAmbiguous { what: "shapes", layers }.in_file(path));
    };
    let shown = PathBuf::from(format!("{}!{shp}", path.display()));
    let folder = tempfile::tempdir().map_err(|e| Error::io("create a temporary folder for", path, e))?;
    let main = shp[..shp.len() - ".shp".len()].to_owned();
    let mut left = budget(length);
    for part in PARTS {
        let is_it = |name: &str| {
            name.get(..main.len()) == Some(&main) && name[main.len()..].eq_ignore_ascii_case(&format!(".{part}"))
        };
        let Some((name, index)) = names.iter().find(|(name, _)| is_it(name)) else { continue };
        let inner = PathBuf::from(format!("{}!{name}", path.display()));
        let unpacked = folder.path().join(format!("in.{part}"));
        let mut target = File::create(&unpacked).map_err(|e| Error::io("create", &unpacked, e))?;
        unpack(&mut archive, *index, &inner, left, |source| {
            unlimited_copy(source, &mut target).map_err(|e| unreadable(&inner, e))?;
            left = source.remaining();
            Ok(())
        })?;
    }
    let mut table = shapefile::read(&folder.path().join("in.shp"), request).map_err(|error| named(error, &shown))?;
    // The encoding is named in the archive, not in the temporary folder.
    let inside = folder.path().join("in.cpg").display().to_string();
    table.fields_note = table.fields_note.map(|note| note.replace(&inside, &format!("{}.cpg", stem(shp))));
    Ok(table)
}

/// Calls `read` with each document of an archive that has this extension, in the order of the archive.
pub(super) fn each_document(
    path: &Path,
    extension: &str,
    read: &mut dyn FnMut(&Path, &mut DocumentReader<'_>) -> Result<()>,
) -> Result<()> {
    let (mut archive, mut names, length) = open(path)?;
    names.retain(|(name, _)| is_part(file_name(name), extension));
    if names.is_empty() {
        return Err(Error::file(path, format!("the archive holds no .{extension} file")));
    }
    let mut left = budget(length);
    for (name, index) in names {
        let inner = PathBuf::from(format!("{}!{name}", path.display()));
        unpack(&mut archive, index, &inner, left, |source| {
            read(&inner, source)?;
            left = source.remaining();
            Ok(())
        })?;
    }
    Ok(())
}

/// Opens an archive: its names in the order of the archive, and its length in bytes.
fn open(path: &Path) -> Result<(ZipArchive<BufReader<File>>, Names, u64)> {
    let file = open_to_read(path)?;
    let length = file.metadata().map_err(|e| Error::io("read", path, e))?.len();
    let archive = ZipArchive::new(BufReader::with_capacity(BUFFER, file))
        .map_err(|e| Error::file_cause(path, "the file is not a zip archive, or it is not complete", e))?;
    let name = |index| match archive.name_for_index(index) {
        Some(Ok(name)) => Ok((name.into_owned(), index)),
        _ => Err(Error::file(path, format!("the name of file {index} in the archive cannot be read"))),
    };
    let names = (0..archive.len()).map(name).collect::<Result<Names>>()?;
    Ok((archive, names, length))
}

fn unpack<R: Read + Seek, T>(
    archive: &mut ZipArchive<R>,
    index: usize,
    inner: &Path,
    limit: u64,
    read: impl FnOnce(&mut DocumentReader<'_>) -> Result<T>,
) -> Result<T> {
    let entry = archive
        .by_index(index)
        .map_err(|e| Error::file_cause(inner, "it cannot be unpacked; unpack the archive first", e))?;
    let mut entry = BufReader::with_capacity(BUFFER, entry);
    let mut source: DocumentReader<'_> = LimitedReader::new(&mut entry, limit);
    read(&mut source)
}

/// The last part of a name in an archive.
fn file_name(name: &str) -> &str {
    name.rsplit(['/', '\\']).next().unwrap_or_default()
}

/// Whether a file has this extension. Names that begin with a dot are copies that other systems keep for themselves.
fn is_part(name: &str, extension: &str) -> bool {
    !name.starts_with('.') && has_extension(Path::new(name), extension)
}

/// The error with the name that the file has in the archive.
fn named(error: Error, shown: &Path) -> Error {
    let in_archive = |path: &Path| match path.extension() {
        Some(extension) => shown.with_extension(extension),
        None => shown.to_owned(),
    };
    match error {
        Error::File { path, message, source } => Error::File { path: in_archive(&path), message, source },
        Error::Io { action, path, source } => Error::Io { action, path: in_archive(&path), source },
        other => other,
    }
}
