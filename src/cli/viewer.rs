//! The map page beside tiles: `--viewer FILE.html`.

use std::ffi::OsStr;
use std::path::{Path, PathBuf};

use clap::Args;
use tokosen::base::error::Error;
use tokosen::draw::viewer::{ViewedSet, viewer_page};
use tokosen::io::StagedOutput;
use tokosen::io::tiles::{TileFormat, tile_sets};

use super::console::Console;
use super::extensions::check_extension;
use super::failure::Failure;

/// The flags about maps of tiles.
#[derive(Debug, Clone, Args)]
pub struct ViewerArgs {
    /// Also write a page that shows the tiles in a browser: .html, in the folder of the tiles (.pmtiles or folders). It shows all
    /// sets of tiles there that tokosen made, and needs no other server
    #[arg(long, value_name = "FILE", hide_short_help = true)]
    pub viewer: Option<PathBuf>,
    /// The source of the data, which map tiles state and maps show, such as '地理院タイル' or '© Kartverket'
    #[arg(long, value_name = "TEXT", hide_short_help = true)]
    pub attribution: Option<String>,
}

/// A page to write, whose file was opened before the work.
pub struct Viewer {
    staged: StagedOutput,
    title: String,
    /// The names of this run's sets.
    own: Vec<PathBuf>,
}

impl ViewerArgs {
    /// Checks what can be checked before anything is read. `outputs` are the files that may be tiles.
    pub fn check(&self, outputs: &[&Path]) -> Result<(), Failure> {
        let usage = |message: String| Err(Failure::Usage(message));
        let tiles: Vec<&Path> = outputs.iter().copied().filter(|path| TileFormat::of(path).is_some()).collect();
        let given = [self.viewer.is_some(), self.attribution.is_some()];
        if let (true, Some((flag, _))) =
            (tiles.is_empty(), ["--viewer", "--attribution"].iter().zip(given).find(|(_, is)| *is))
        {
            // A page cannot read .mbtiles.
            let database = if *flag == "--viewer" { "" } else { ", .mbtiles" };
            return usage(format!("{flag} applies to map tiles: .pmtiles{database} or 'FOLDER/{{z}}/{{x}}/{{y}}.pbf'"));
        }
        let Some(page) = &self.viewer else { return Ok(()) };
        check_extension(page, "map pages", &["html", "htm"])?;
        for path in tiles {
            if TileFormat::of(path) == Some(TileFormat::MbTiles) {
                return usage(format!(
                    "--viewer: a page cannot read {}; write .pmtiles, or a folder of tiles",
                    path.display()
                ));
            }
            let target = TileFormat::target(path);
            if !is_same(folder(page), folder(&target)) {
                return usage(format!(
                    "--viewer {}: the page must be in the folder of the tiles: {}",
                    page.display(),
                    target.with_file_name(page.file_name().unwrap_or(OsStr::new("index.html"))).display()
                ));
            }
        }
        Ok(())
    }

    /// Opens the page, if one is asked for. `title` is what the map is called.
    pub fn open(&self, outputs: &[&Path], title: &str) -> Result<Option<Viewer>, Failure> {
        let Some(page) = &self.viewer else { return Ok(None) };
        let own = outputs.iter().filter(|path| TileFormat::of(path).is_some()).map(|path| TileFormat::target(path));
        Ok(Some(Viewer { staged: StagedOutput::create(page)?, title: title.to_owned(), own: own.collect() }))
    }
}

impl Viewer {
    /// Writes the page for the sets that are in its folder now, those of this run first.
    pub fn commit(self, console: &Console) -> Result<(), Failure> {
        let folder = self.staged.folder().to_owned();
        let names = write_viewer(&self.staged, &self.title, &self.own)?;
        console.say(&format!(
            "written    {} (shows {}; open it from a web server that answers range requests, such as 'npx http-server {}')",
            self.staged.commit()?.display(),
            names.join(", "),
            folder.display()
        ));
        Ok(())
    }
}

/// Writes the page for the sets that are in its folder, those of `own` first. Gives the names of all.
///
/// # Errors
/// The folder cannot be read, or the page cannot be written.
pub fn write_viewer(page: &StagedOutput, title: &str, own: &[PathBuf]) -> Result<Vec<String>, Error> {
    let folder = page.folder();
    let mut sets = tile_sets(folder).map_err(|e| Error::io("read", folder, e))?;
    let is_own = |name: &str| own.iter().any(|path| path.file_name() == Some(OsStr::new(name)));
    sets.sort_by_key(|set| !is_own(&set.name));
    let names = sets.iter().map(|set| set.name.clone()).collect();
    let viewed: Vec<ViewedSet> =
        sets.into_iter().map(|set| ViewedSet { name: set.name, extension: set.extension }).collect();
    let path = page.path();
    let written = std::fs::write(&path, viewer_page(title, &viewed));
    written.map_err(|e| page.with_final_name(Error::io("write", &path, e)))?;
    Ok(names)
}

/// What a page is called: the names of the input's files. Where they lie is no matter of those who see it.
pub fn title(files: &[&Path]) -> String {
    let names = files.iter().filter_map(|path| path.file_stem());
    names.map(OsStr::to_string_lossy).collect::<Vec<_>>().join(", ")
}

/// The folder of a file.
fn folder(path: &Path) -> &Path {
    path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."))
}

/// Whether two paths are one folder. One that is missing is reported when its file is opened.
fn is_same(a: &Path, b: &Path) -> bool {
    match (a.canonicalize(), b.canonicalize()) {
        (Ok(a), Ok(b)) => a == b,
        _ => a == b,
    }
}
