//! The documents of a path: an XML file, a zip archive as GSI delivers it, or a folder of both.
//!
//! The file name `FG-GML-MESH-ITEM-DATE-NUMBER.xml` gives a document's item. Documents of other items are not unpacked.
//! Documents are visited one at a time, in the order of their names. Archives may contain archives.

use std::collections::hash_map::Entry;
use std::collections::{BTreeMap, HashMap};
use std::io::{BufReader, Read, Seek};
use std::path::{Path, PathBuf};

use zip::ZipArchive;

use crate::meter::{DocumentReader, LimitedReader, MAX_DOCUMENT_LENGTH};
use crate::ordinary::open_to_read;
use crate::xml::unreadable;
use tokosen_core::base::error::{Error, Finding, FindingKind, Result};

/// The largest nesting depth of archives in archives, and of folders in folders.
const MAX_DEPTH: usize = 3;

/// The number of bytes that may be unpacked from an archive of this length.
pub(crate) fn budget(length: u64) -> u64 {
    UNPACKED_FREELY.saturating_add(length.saturating_mul(UNPACKED_RATIO))
}

/// Everything that is unpacked may be this many times as large as the archive. Height maps that are mostly sea compress
/// 200 times, all others less.
const UNPACKED_RATIO: u64 = 500;

/// This many bytes may be unpacked whatever the archive's size.
const UNPACKED_FREELY: u64 = 64 << 20;

/// An archive inside an archive is unpacked in memory up to this size, bytes; a larger one goes into a temporary file.
const INNER_IN_MEMORY: usize = 32 << 20;

const BUFFER: usize = 1 << 17;

/// What the walk through a path found.
#[derive(Default)]
pub(super) struct WalkReport {
    /// Number of documents that were visited.
    pub visited: u64,
    /// Items that were skipped, and how many documents of each.
    pub others: BTreeMap<String, u64>,
    /// The extension of a file in another vector format.
    pub foreign: Option<String>,
    /// The path of each visited document that has a GSI file name, by that name.
    documents: HashMap<String, PathBuf>,
    /// Skipped documents: one of the same name had already been visited.
    repeated: Vec<[PathBuf; 2]>,
}

impl WalkReport {
    /// Reports documents that exist twice, such as in a folder that holds an archive and its unpacked content.
    pub fn note_repeated(&self, findings: &mut Vec<Finding>) {
        for [read, passed] in &self.repeated {
            let message = format!("{} left out: {} has the same name", passed.display(), read.display());
            findings.push(Finding::general(FindingKind::RepeatedFile, message));
        }
    }
}

/// The function that reads a document. The path is the document's name for messages.
pub(super) type Visit<'v> = &'v mut dyn FnMut(&Path, &mut DocumentReader<'_>) -> Result<()>;

struct Walk<'v> {
    wanted: &'v dyn Fn(&str) -> bool,
    visit: Visit<'v>,
    report: WalkReport,
}

/// Visits the documents of a path whose item is `wanted`, or whose name does not give the item. A document that `path`
/// itself names is always visited.
pub(super) fn each_document(path: &Path, wanted: &dyn Fn(&str) -> bool, visit: Visit<'_>) -> Result<WalkReport> {
    let mut walk = Walk { wanted, visit, report: WalkReport::default() };
    let meta = std::fs::metadata(path).map_err(|e| Error::io("read", path, e))?;
    if meta.is_dir() {
        walk.folder(path, 0)?;
    } else {
        walk.file(path)?;
    }
    Ok(walk.report)
}

impl Walk<'_> {
    fn folder(&mut self, path: &Path, depth: usize) -> Result<()> {
        let failed = |e| Error::io("read", path, e);
        let mut entries = Vec::new();
        for entry in std::fs::read_dir(path).map_err(failed)? {
            let entry = entry.map_err(failed)?;
            let is_folder = entry.file_type().map_err(failed)?.is_dir();
            entries.push((entry.file_name(), is_folder));
        }
        entries.sort();
        for (name, is_folder) in entries {
            let inner = path.join(&name);
            let name = name.to_string_lossy();
            if is_folder {
                if depth < MAX_DEPTH {
                    self.folder(&inner, depth + 1)?;
                }
            } else if !is_served(&name) {
                self.note_foreign(&name);
            } else if self.is_wanted(&name) {
                self.file(&inner)?;
            }
        }
        Ok(())
    }

    fn file(&mut self, path: &Path) -> Result<()> {
        let file = open_to_read(path)?;
        let length = file.metadata().map_err(|e| Error::io("read", path, e))?.len();
        if has_extension(path, "zip") {
            return self.archive(path, BufReader::with_capacity(BUFFER, file), 0, &mut budget(length));
        }
        if self.is_repeated(path, &path.file_name().unwrap_or_default().to_string_lossy()) {
            return Ok(());
        }
        let mut file = BufReader::with_capacity(BUFFER, file);
        self.report.visited += 1;
        (self.visit)(path, &mut LimitedReader::new(&mut file, MAX_DOCUMENT_LENGTH))
    }

    /// Whether a document of this name was visited before; if so, it is noted. Only names in GSI's form are compared.
    fn is_repeated(&mut self, path: &Path, name: &str) -> bool {
        if !is_served(name) {
            return false;
        }
        match self.report.documents.entry(name.to_ascii_lowercase()) {
            Entry::Occupied(entry) => {
                self.report.repeated.push([entry.get().clone(), path.to_owned()]);
                true
            }
            Entry::Vacant(entry) => {
                entry.insert(path.to_owned());
                false
            }
        }
    }

    /// Visits the documents of an archive. `budget` is the number of bytes that may still be unpacked.
    fn archive<R: Read + Seek>(&mut self, path: &Path, file: R, depth: usize, budget: &mut u64) -> Result<()> {
        let mut archive = ZipArchive::new(file)
            .map_err(|e| Error::file_cause(path, "the file is not a zip archive, or it is not complete", e))?;
        let mut names: Vec<(String, usize)> = Vec::new();
        for index in 0..archive.len() {
            match archive.name_for_index(index) {
                Some(Ok(name)) => names.push((name.into_owned(), index)),
                _ => return Err(Error::file(path, format!("the name of file {index} in the archive cannot be read"))),
            }
        }
        names.sort();
        let file_name = |name: &str| name.rsplit(['/', '\\']).next().unwrap_or_default().to_owned();
        let is_document = |name: &str| has_extension(Path::new(name), "xml") || has_extension(Path::new(name), "zip");
        // If no file has a GSI name, all documents are read: they may have been renamed.
        let any_served = names.iter().any(|(name, _)| is_served(&file_name(name)));
        for (name, index) in names {
            let short = file_name(&name);
            if !is_document(&short) || (any_served && !is_served(&short)) {
                self.note_foreign(&short);
                continue;
            }
            if !self.is_wanted(&short) {
                continue;
            }
            let inner = PathBuf::from(format!("{}!{name}", path.display()));
            if has_extension(Path::new(&short), "xml") && self.is_repeated(&inner, &short) {
                continue;
            }
            let entry = archive
                .by_index(index)
                .map_err(|e| Error::file_cause(&inner, "it cannot be unpacked; unpack the archive first", e))?;
            let limit = MAX_DOCUMENT_LENGTH.min(*budget);
            let mut entry = BufReader::with_capacity(BUFFER, entry);
            let mut source: DocumentReader<'_> = LimitedReader::new(&mut entry, limit);
            if has_extension(Path::new(&short), "zip") {
                if depth >= MAX_DEPTH {
                    return Err(Error::file(&inner, "the archives are nested too deep; unpack them first"));
                }
                let mut unpacked = tempfile::SpooledTempFile::new(INNER_IN_MEMORY);
                unlimited_copy(&mut source, &mut unpacked).map_err(|e| unreadable(&inner, e))?;
                *budget = budget.saturating_sub(limit - source.remaining());
                unpacked.rewind().map_err(|e| unreadable(&inner, e))?;
                self.archive(&inner, BufReader::with_capacity(BUFFER, unpacked), depth + 1, budget)?;
            } else {
                self.report.visited += 1;
                (self.visit)(&inner, &mut source)?;
                *budget = budget.saturating_sub(limit - source.remaining());
            }
        }
        Ok(())
    }

    /// Whether a document may be useful, judged by its name. If not, it is counted.
    fn is_wanted(&mut self, name: &str) -> bool {
        let Some(item) = item_of(name).filter(|item| item != "ALL") else { return true };
        if (self.wanted)(&item) {
            return true;
        }
        *self.report.others.entry(item).or_default() += 1;
        false
    }

    fn note_foreign(&mut self, name: &str) {
        let extension = Path::new(name).extension().and_then(|e| e.to_str()).unwrap_or_default().to_ascii_lowercase();
        if ["shp", "geojson", "json", "gpkg", "fgb", "dxf", "kml", "gml"].contains(&extension.as_str()) {
            self.report.foreign.get_or_insert(extension);
        }
    }
}

/// Copies with a fresh limit for every block, because an archive is not one item of a document.
pub(crate) fn unlimited_copy(source: &mut DocumentReader<'_>, target: &mut impl std::io::Write) -> std::io::Result<()> {
    let mut buffer = vec![0; BUFFER];
    loop {
        source.next_item();
        let length = source.read(&mut buffer)?;
        if length == 0 {
            return Ok(());
        }
        target.write_all(&buffer[..length])?;
    }
}

/// Whether a file name has the form of GSI's downloads: `FG-GML-….xml`, `FG-GML-….zip`, `PackDLMap.zip`.
pub(crate) fn is_served(name: &str) -> bool {
    let path = Path::new(name);
    let upper = name.to_ascii_uppercase();
    let is_zip = has_extension(path, "zip");
    (upper.starts_with("FG-GML-") && (is_zip || has_extension(path, "xml")))
        || (upper.starts_with("PACKDLMAP") && is_zip)
}

/// Whether the path has this extension, in any letter case.
pub(crate) fn has_extension(path: &Path, extension: &str) -> bool {
    path.extension().and_then(|e| e.to_str()).is_some_and(|e| e.eq_ignore_ascii_case(extension))
}

/// The item in a document's name: `Cntr`, `DEM10B`, `ALL`.
pub(super) fn item_of(name: &str) -> Option<String> {
    let stem = Path::new(name).file_stem()?.to_str()?;
    let rest = stem.get(..7).filter(|start| start.eq_ignore_ascii_case("FG-GML-")).map(|_| &stem[7..])?;
    let item = rest.split(['-', '_']).find(|part| part.starts_with(|c: char| c.is_ascii_alphabetic()))?;
    let is_dem = item.get(..3).is_some_and(|start| start.eq_ignore_ascii_case("dem"));
    Some(if is_dem { item.to_ascii_uppercase() } else { item.to_owned() })
}

/// An error that states what was expected and what was found.
pub(super) fn nothing(path: &Path, report: &WalkReport, wanted: &str) -> Error {
    if let Some(foreign) = report.foreign.as_ref().filter(|_| report.visited == 0 && report.others.is_empty()) {
        let message = match path.is_dir() {
            true => {
                format!("is a folder without files of 基盤地図情報 (FG-GML-….xml or .zip); name its .{foreign} file")
            }
            false => format!("the archive holds a .{foreign} file; unpack it and name that file"),
        };
        return Error::file(path, message);
    }
    let mut found: Vec<String> = report.others.iter().map(|(item, count)| format!("{count} {item}")).collect();
    if report.visited > 0 {
        let noun = if report.visited == 1 { "document" } else { "documents" };
        found.push(format!("{} {noun} without one", report.visited));
    }
    let found = if found.is_empty() {
        "no file FG-GML-….xml or FG-GML-….zip is in it".to_owned()
    } else {
        format!("found: {}", found.join(", "))
    };
    Error::file(path, format!("there is no {wanted} of 基盤地図情報 in it ({found})"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_tell_the_item() {
        for (name, item) in [
            ("FG-GML-5437-45-dem10b-20161001.xml", Some("DEM10B")),
            ("FG-GML-3624-30-DEM5B.zip", Some("DEM5B")),
            ("FG-GML-5238-74-00-DEM5A-20161001.xml", Some("DEM5A")),
            ("FG-GML-543745-Cntr-20160401-0001.xml", Some("Cntr")),
            ("fg-gml-543745-ALL-20160401.zip", Some("ALL")),
            ("FG-GML-543745.xml", None),
            ("fmdid15-3101.xml", None),
            ("等高線図面.xml", None),
        ] {
            assert_eq!(item_of(name).as_deref(), item, "{name}");
        }
    }

    #[test]
    fn served_names() {
        assert!(is_served("FG-GML-543745-Cntr-20160401-0001.XML") && is_served("PackDLMap.zip"));
        assert!(!is_served("FGD_GMLSchema.xsd") && !is_served("fmdid15-3101.xml") && !is_served("FG-GML-1.txt"));
    }
}
