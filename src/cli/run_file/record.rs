//! What a run notes about itself for `--save-run`.

use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError};

use serde_json::{Value, json};
use tokosen::base::error::{Error, Result};
use tokosen::io::StagedOutput;
use tokosen::surface::Surface;

use super::file::RunFile;
use super::inputs::inputs;
use crate::cli::extensions::check_extension;
use crate::cli::failure::Failure;

/// The notes of a run, and the file that they go to.
#[derive(Debug)]
pub struct Record {
    path: PathBuf,
    staged: StagedOutput,
    run: Mutex<RunFile>,
}

impl Record {
    /// Opens the file. `arguments` are those of the run, without `--save-run`.
    pub fn open(path: &Path, arguments: Vec<String>) -> std::result::Result<Self, Failure> {
        check_extension(path, "saved runs", &["json"])?;
        let here = Path::new(".");
        let folder = std::env::current_dir().map_err(|e| Error::io("find", here, e))?;
        let staged = StagedOutput::create(path)?;
        Ok(Self { path: path.to_owned(), staged, run: Mutex::new(RunFile::new(arguments, folder)) })
    }

    /// The file.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Notes the files that the run will read.
    ///
    /// # Errors
    /// A file cannot be read, or a path is no text.
    pub fn note_inputs(&self, paths: &[&Path]) -> Result<()> {
        let found = inputs(paths)?;
        let mut run = self.run();
        run.inputs = found;
        run.text(&self.path).map(drop)
    }

    /// Notes what was chosen for a surface.
    pub fn note_surface(&self, surface: &Surface) {
        let mut run = self.run();
        let mut note = |name: &str, value: Value| run.chosen.insert(name.to_owned(), value);
        note("interval", json!(surface.interval.step));
        note("working_crs", json!(surface.map.crs.as_ref().and_then(|crs| crs.name())));
        if let Some(chosen) = &surface.chosen {
            let numbers = &chosen.hyper_parameters;
            note("tension", json!(numbers.tension));
            note("noise", json!(numbers.noise));
            note("crease_threshold", json!(numbers.crease_threshold));
            note("curvature_gain", json!(numbers.curvature_gain));
        }
    }

    /// Writes the file and puts it in its place.
    ///
    /// # Errors
    /// The file cannot be written.
    pub fn commit(self) -> Result<PathBuf> {
        let text = self.run().text(&self.path)?;
        let path = self.staged.path();
        std::fs::write(&path, text).map_err(|e| self.staged.with_final_name(Error::io("write", &path, e)))?;
        self.staged.commit()
    }

    fn run(&self) -> MutexGuard<'_, RunFile> {
        self.run.lock().unwrap_or_else(PoisonError::into_inner)
    }
}
