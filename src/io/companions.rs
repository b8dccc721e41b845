//! The files beside an input that are read with it, and those beside an output that describe it: which of them a new output
//! removes, and which it must not change.

use std::ffi::{OsStr, OsString};
use std::fs;
use std::path::Path;

use super::ordinary::{MAX_DESCRIPTION, check_ordinary, read_small};
use tokosen_core::base::error::{Error, Result};

/// Files beside an output that describe its former content and would be wrong for the new one. The first column is the
/// extension of the output. The second lists endings that replace that extension.
const REPLACED_ENDINGS: &[(&str, &[&str])] =
    &[("shp", &["prj", "qpj", "cpg", "qix", "sbn", "sbx"]), ("asc", &["prj"]), ("png", &["pgw"])];

/// The same, for endings that are appended to the whole name: statistics and overviews of rasters, and the files that a
/// database engine leaves if a database was not closed.
const APPENDED_ENDINGS: &[(&str, &[&str])] = &[
    ("gpkg", &["-journal", "-wal", "-shm"]),
    ("tif", &[".aux.xml", ".ovr", ".msk"]),
    ("tiff", &[".aux.xml", ".ovr", ".msk"]),
    ("png", &[".aux.xml"]),
    ("exr", &[".aux.xml"]),
    ("asc", &[".aux.xml", ".ovr", ".msk"]),
    ("xyz", &[".aux.xml"]),
];

/// Endings of the files beside an input that are read with it: they replace its extension.
const READ_ENDINGS: &[(&str, &[&str])] = &[
    ("shp", &["shx", "dbf", "prj", "cpg"]),
    ("asc", &["prj"]),
    ("xyz", &["prj"]),
    ("png", &["pgw", "wld"]),
    ("tif", &["tfw", "tifw", "wld"]),
    ("tiff", &["tfw", "tiffw", "wld"]),
];

/// The same, for the ending that is appended to the whole name.
const WITH_AUX_XML: [&str; 4] = ["png", "tif", "tiff", "exr"];

/// Files beside an input that hold its data, and may be large.
const WITH_DATA: [&str; 2] = ["shx", "dbf"];

/// Formats whose coordinate reference system is in the `.prj` of their name.
const WITH_PRJ: [&str; 2] = ["shp", "asc"];

/// Files beside an output of this name that only fit its former content.
pub(super) fn stale(name: &OsStr) -> Vec<OsString> {
    let path = Path::new(name);
    let Some(extension) = extension(path) else { return Vec::new() };
    let replaced = endings(REPLACED_ENDINGS, &extension).iter();
    let replaced = replaced.map(|ending| path.with_extension(ending).into_os_string());
    replaced.chain(endings(APPENDED_ENDINGS, &extension).iter().map(|ending| with_ending(name, ending))).collect()
}

/// Files beside an input of this name that are read with it, if they exist.
pub(super) fn read_beside(name: &OsStr) -> Vec<OsString> {
    let path = Path::new(name);
    let Some(extension) = extension(path) else { return Vec::new() };
    let replaced = endings(READ_ENDINGS, &extension).iter();
    let replaced = replaced.map(|ending| path.with_extension(ending).into_os_string());
    let appended = WITH_AUX_XML.contains(&extension.as_str()).then(|| with_ending(name, ".aux.xml"));
    replaced.chain(appended).collect()
}

/// Refuses a file that is no ordinary one, and one beside it that is read with it.
///
/// # Errors
/// As [`open_to_read`], for the file or for one beside it. A file beside it is too large.
pub(super) fn check_input(path: &Path) -> Result<()> {
    check_ordinary(path)?;
    let names = read_beside(path.file_name().unwrap_or_default()).into_iter();
    // Old shapefiles have names in capitals.
    let names = names.flat_map(|name| [in_capitals(&name), name]);
    for beside in names.map(|name| path.with_file_name(name)) {
        let Ok(meta) = fs::metadata(&beside) else { continue };
        check_ordinary(&beside)?;
        let holds_data = beside
            .extension()
            .and_then(OsStr::to_str)
            .is_some_and(|e| WITH_DATA.iter().any(|d| d.eq_ignore_ascii_case(e)));
        if !holds_data && meta.len() > MAX_DESCRIPTION {
            return Err(Error::file(&beside, "is too large for a file that describes another one"));
        }
    }
    Ok(())
}

/// The name with its extension in capitals.
fn in_capitals(name: &OsStr) -> OsString {
    let path = Path::new(name);
    path.extension().map_or_else(OsString::new, |e| path.with_extension(e.to_ascii_uppercase()).into_os_string())
}

/// The endings for an extension.
fn endings(table: &[(&str, &'static [&'static str])], extension: &str) -> &'static [&'static str] {
    table.iter().find(|(ext, _)| *ext == extension).map_or(&[], |(_, endings)| endings)
}

/// A name with an ending.
fn with_ending(name: &OsStr, ending: &str) -> OsString {
    let mut whole = name.to_owned();
    whole.push(ending);
    whole
}

/// Refuses to change a `.prj` that also belongs to a file of another format: the shapefile `a.shp` and the grid `a.asc`
/// both take their coordinate reference system from `a.prj`. `names` are the files that move from `staging` to `folder`.
///
/// # Errors
/// [`Error::File`] names the `.prj` and the other file.
pub(super) fn foreign_prj(staging: &Path, folder: &Path, names: &[OsString]) -> Result<()> {
    let with_prj = |name: &&OsString| extension(Path::new(name)).is_some_and(|e| WITH_PRJ.contains(&e.as_str()));
    for name in names.iter().filter(with_prj) {
        let prj = Path::new(name).with_extension("prj");
        let others = WITH_PRJ.iter().map(|extension| Path::new(name).with_extension(extension));
        let Some(other) = others.filter(|other| other.as_os_str() != name).find(|o| folder.join(o).is_file()) else {
            continue;
        };
        let text = |folder: &Path| read_small(&folder.join(&prj), MAX_DESCRIPTION, "a .prj").ok();
        if !names.contains(&other.clone().into_os_string()) && text(staging) != text(folder) {
            let message = format!(
                "also gives the coordinate reference system of {}, which is another one; choose another name for the output",
                other.display()
            );
            return Err(Error::file(&folder.join(prj), message));
        }
    }
    Ok(())
}

/// The extension in small letters.
fn extension(path: &Path) -> Option<String> {
    path.extension().and_then(OsStr::to_str).map(str::to_ascii_lowercase)
}

#[cfg(test)]
mod tests {
    use std::fs;

    use super::*;
    use crate::StagedOutput;
    use crate::staged::tests::names_in;

    #[test]
    fn companions_of_the_former_content_go_and_others_stay() {
        let dir = tempfile::tempdir().unwrap();
        for name in ["a.shp", "a.prj", "a.qix", "a.txt", "b.qix", "c.tif.ovr"] {
            fs::write(dir.path().join(name), "old").unwrap();
        }
        let staged = StagedOutput::create(&dir.path().join("a.shp")).unwrap();
        fs::write(staged.path(), "new").unwrap();
        fs::write(staged.sibling("a.prj"), "new").unwrap();
        staged.commit().unwrap();
        assert_eq!(names_in(dir.path()), ["a.prj", "a.shp", "a.txt", "b.qix", "c.tif.ovr"]);
        assert_eq!(fs::read_to_string(dir.path().join("a.prj")).unwrap(), "new");
    }

    #[test]
    fn the_prj_of_a_former_grid_goes_and_that_of_a_shapefile_stays() {
        let dir = tempfile::tempdir().unwrap();
        let write = |name: &str| fs::write(dir.path().join(name), "old").unwrap();
        ["a.asc", "a.prj", "b.prj", "b.shp"].into_iter().for_each(write);
        let commit = |prj: Option<&str>, name: &str| {
            let staged = StagedOutput::create(&dir.path().join(name)).unwrap();
            fs::write(staged.path(), "new").unwrap();
            if let Some(text) = prj {
                fs::write(staged.sibling(Path::new(name).with_extension("prj")), text).unwrap();
            }
            staged.commit()
        };
        commit(None, "a.asc").unwrap();
        assert_eq!(names_in(dir.path()), ["a.asc", "b.prj", "b.shp"]);
        for prj in [None, Some("another")] {
            let error = commit(prj, "b.asc").unwrap_err().to_string();
            assert!(error.contains("b.prj") && error.contains("b.shp"), "{error}");
            assert_eq!(names_in(dir.path()), ["a.asc", "b.prj", "b.shp"]);
        }
        commit(Some("old"), "b.asc").unwrap();
        commit(Some("new"), "a.shp").unwrap_err();
        assert_eq!(names_in(dir.path()), ["a.asc", "b.asc", "b.prj", "b.shp"]);
    }

    #[test]
    fn a_file_beside_an_input_is_checked_with_it() {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("a.shp");
        fs::write(&path, "shapes").unwrap();
        assert!(check_input(&path).is_ok());
        let beside =
            |name: &str, length: u64| fs::File::create(dir.path().join(name)).unwrap().set_len(length).unwrap();
        beside("a.dbf", 1 << 32);
        assert!(check_input(&path).is_ok(), "a table may be large");
        beside("a.prj", 1 << 32);
        assert!(check_input(&path).unwrap_err().to_string().contains("a.prj: is too large"));
    }
}
