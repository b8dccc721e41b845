//! Names what is read: a vector file and, if it has several, one of its layers; and the files that a folder or a pattern
//! stands for.

use std::path::{Path, PathBuf};

use super::ReadOptions;
use super::file_box::FileBox;
use super::format::{InputFormat, VectorFormat};
use super::gsi;
use super::in_memory::InMemory;
use tokosen_core::base::error::{Error, Result};

/// The key before the name of a layer, as QGIS writes it: `all.gpkg|layername=Lakes`.
const LAYER_KEY: &str = "layername=";
/// The key before a box.
const BOX_KEY: &str = "bbox=";
/// Other keys that QGIS writes after a path.
const OTHER_KEYS: [&str; 5] = ["layerid=", "subset=", "geometrytype=", "uniquegeometrytype=", "option:"];
/// Signs of a pattern.
const WILDCARDS: [char; 3] = ['*', '?', '['];

/// A vector file, and a layer of it if it is named.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct VectorSource {
    /// The file, or a folder or an archive of 基盤地図情報.
    pub path: PathBuf,
    /// The layer, by its name.
    pub layer: Option<String>,
    /// The box that features must meet, in the coordinates of the file. No features are left out if `None`.
    pub within: Option<FileBox>,
    /// Features in memory, which are read instead of the file. The path is then their name in messages.
    pub features: Option<InMemory>,
}

impl<P: Into<PathBuf>> From<P> for VectorSource {
    fn from(path: P) -> Self {
        Self { path: path.into(), layer: None, within: None, features: None }
    }
}

impl VectorSource {
    /// Features in memory. Messages call them by `name`, such as "streams".
    pub fn in_memory(name: &str, features: InMemory) -> Self {
        Self { features: Some(features), ..Self::from(name) }
    }

    /// How it is read.
    pub fn reading(&self) -> ReadOptions {
        let Self { layer, within, features, .. } = self.clone();
        ReadOptions { layer, within, features, ..ReadOptions::default() }
    }

    /// Takes a path, or a path and a layer as QGIS writes them: `all.gpkg|layername=Lakes`. Also a box that features must meet:
    /// `all.gpkg|bbox=XMIN,YMIN,XMAX,YMAX`.
    ///
    /// # Errors
    /// A sentence if something else is named after the path, or the box is none.
    pub fn from_text(text: &str) -> Result<Self, String> {
        let plain = || Ok(Self::from(text));
        let Some((path, rest)) = text.split_once('|').filter(|_| !Path::new(text).exists()) else { return plain() };
        let mut source = Self::from(path);
        for part in rest.split('|') {
            let lower = part.to_ascii_lowercase();
            if lower.starts_with(LAYER_KEY) {
                source.layer = Some(part[LAYER_KEY.len()..].to_owned());
            } else if lower.starts_with(BOX_KEY) {
                let sides = FileBox::from_text(&part[BOX_KEY.len()..]);
                source.within =
                    Some(sides.ok_or_else(|| format!("{part:?} is no box; write |bbox=XMIN,YMIN,XMAX,YMAX"))?);
            } else if let Some(key) = OTHER_KEYS.iter().find(|key| lower.starts_with(**key)) {
                let key = key.trim_end_matches(['=', ':']);
                return Err(format!("{part:?} is not read ({key}); name a layer as FILE|layername=NAME"));
            } else {
                return plain();
            }
        }
        Ok(source)
    }

    /// The files that this stands for. A pattern (`sheets/*.shp`) gives the files that match, a folder without files of
    /// 基盤地図情報 the vector files in it, both in the order of their names. Everything else gives itself.
    ///
    /// # Errors
    /// No file matches the pattern, the pattern is wrong, or a folder cannot be read or holds no such file.
    pub fn expand(&self) -> Result<Vec<Self>> {
        let text = self.path.to_string_lossy();
        let paths = if self.features.is_some() {
            Vec::new()
        } else if !self.path.exists() && text.contains(WILDCARDS) {
            matching(&self.path, &text)?
        } else if self.path.is_dir() {
            vector_files(&self.path)?
        } else {
            Vec::new()
        };
        if paths.is_empty() {
            return Ok(vec![self.clone()]);
        }
        Ok(paths.into_iter().map(|path| Self { path, ..self.clone() }).collect())
    }
}

fn matching(path: &Path, pattern: &str) -> Result<Vec<PathBuf>> {
    let wrong = |e: glob::PatternError| Error::file(path, format!("is no pattern of file names: {e}"));
    let found = glob::glob(pattern).map_err(wrong)?;
    let paths = found.collect::<Result<Vec<PathBuf>, _>>().map_err(|e| {
        let path = e.path().to_owned();
        Error::io("read", &path, e.into())
    })?;
    if paths.is_empty() {
        return Err(Error::file(path, "no file matches this pattern"));
    }
    Ok(paths)
}

/// The vector files in a folder, by name. None if it may hold files of 基盤地図情報, which are read as one map anyway. Files in
/// formats that are only read, and KML, count if there are no others: an archive or a KML beside a file is mostly a copy of it.
fn vector_files(folder: &Path) -> Result<Vec<PathBuf>> {
    let failed = |e| Error::io("read", folder, e);
    let entries = std::fs::read_dir(folder).map_err(failed)?;
    let (mut files, mut further): (Vec<PathBuf>, Vec<PathBuf>) = Default::default();
    for entry in entries {
        let path = entry.map_err(failed)?.path();
        if gsi::is_source(&path) {
            return Ok(Vec::new());
        }
        let extension = path.extension().and_then(|e| e.to_str()).unwrap_or_default().to_ascii_lowercase();
        // Files of these names may hold anything.
        let is_vague = ["json", "csv", "tsv"].contains(&extension.as_str());
        match InputFormat::from_path(&path) {
            Ok(InputFormat::Written(format)) if !is_vague && format != VectorFormat::Kml => files.push(path),
            Ok(_) if !is_vague => further.push(path),
            _ => {}
        }
    }
    if files.is_empty() {
        files = further;
    }
    if files.is_empty() {
        let message = "the folder holds no contours: no .gpkg, .geojson, .shp, .fgb, .parquet, .dxf, .kml or .gml, and nothing of 基盤地図情報 (.xml, .zip)";
        return Err(Error::file(folder, message));
    }
    files.sort();
    Ok(files)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_layer_is_named_as_in_qgis() {
        let read = |text: &str| VectorSource::from_text(text);
        let layer =
            |path: &str, layer: &str| VectorSource { layer: Some(layer.to_owned()), ..VectorSource::from(path) };
        assert_eq!(read("all.gpkg"), Ok("all.gpkg".into()));
        assert_eq!(read("a b/all.gpkg|layername=Inns jø"), Ok(layer("a b/all.gpkg", "Inns jø")));
        assert_eq!(read("all.gpkg|LayerName=x"), Ok(layer("all.gpkg", "x")));
        assert_eq!(read("odd|name.gpkg"), Ok("odd|name.gpkg".into()));
        let part = read("all.parquet|layername=a|bbox=-1, 2.5,3,4e5").expect("a box");
        assert_eq!((part.layer.as_deref(), part.within), (Some("a"), FileBox::from_text("-1,2.5,3,4e5")));
        for wrong in ["1,2,3", "1,2,0,4", "1,2,3,NaN", ""] {
            assert!(
                read(&format!("a.parquet|bbox={wrong}")).is_err_and(|message| message.contains("no box")),
                "{wrong}"
            );
        }
        for wrong in ["all.gpkg|layerid=0", "all.gpkg|layername=x|subset=\"elev\" > 3"] {
            assert!(read(wrong).is_err_and(|message| message.contains("|layername=NAME")), "{wrong}");
        }
    }

    #[test]
    fn patterns_and_folders_are_their_files_in_order() {
        let folder = tempfile::tempdir().expect("a folder");
        for name in ["b.shp", "a.shp", "a.shx", "a.dbf", "notes.json", "c.gpkg", "copy.kml", "points.csv"] {
            std::fs::write(folder.path().join(name), "").expect("a file");
        }
        let names = |path: &str| -> Vec<String> {
            let found = VectorSource::from(folder.path().join(path)).expand().expect("files");
            found.iter().map(|s| s.path.file_name().unwrap_or_default().to_string_lossy().into_owned()).collect()
        };
        assert_eq!(names("*.shp"), ["a.shp", "b.shp"]);
        assert_eq!(names(""), ["a.shp", "b.shp", "c.gpkg"]);
        assert_eq!(names("missing.shp"), ["missing.shp"]);
        let further = tempfile::tempdir().expect("a folder");
        for name in ["b.kml", "a.gml", "points.csv"] {
            std::fs::write(further.path().join(name), "").expect("a file");
        }
        let found = VectorSource::from(further.path()).expand().expect("files");
        assert_eq!(found, ["a.gml", "b.kml"].map(|name| VectorSource::from(further.path().join(name))));
        let empty = tempfile::tempdir().expect("a folder");
        let nothing = VectorSource::from(empty.path()).expand();
        assert!(nothing.is_err_and(|e| e.to_string().contains("holds no contours")));
        let none = VectorSource::from(folder.path().join("*.dxf")).expand();
        assert!(none.is_err_and(|e| e.to_string().contains("no file matches")));
        std::fs::write(folder.path().join("FG-GML-1-ALL.zip"), "").expect("a file");
        let kept = VectorSource::from(folder.path()).expand().expect("the folder");
        assert_eq!(kept, [VectorSource::from(folder.path())]);
    }
}
