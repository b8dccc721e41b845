//! Tables and charts that a verb writes: .csv, .svg, .png.

use std::path::{Path, PathBuf};

use tokosen::base::error::Error;
use tokosen::draw::chart::Chart;
use tokosen::io::StagedOutput;
use tokosen::io::raster::write_picture;

use super::console::Console;
use super::extensions::check_extension;
use super::failure::Failure;

/// The files of a table and of charts, under temporary names until the work is done.
pub struct Results {
    staged: Vec<(StagedOutput, PathBuf)>,
}

impl Results {
    /// Opens the files.
    pub fn open(paths: &[PathBuf]) -> Result<Self, Failure> {
        for path in paths {
            check_extension(path, "tables and charts", &["csv", "svg", "png"])?;
        }
        let open = |path: &PathBuf| Ok((StagedOutput::create(path)?, path.clone()));
        Ok(Self { staged: paths.iter().map(open).collect::<Result<_, Failure>>()? })
    }

    /// Whether a chart is among them.
    pub fn have_chart(&self) -> bool {
        self.staged.iter().any(|(_, path)| !is(path, "csv"))
    }

    /// Writes the table and the charts.
    pub fn write(&self, table: &str, chart: impl Fn() -> Chart, console: &Console) -> Result<(), Failure> {
        for (staged, path) in &self.staged {
            let there = staged.path();
            let as_text = |text: &str| std::fs::write(&there, text).map_err(|e| Error::io("write", &there, e));
            let written = console.step("writing", || match () {
                () if is(path, "csv") => as_text(table),
                () if is(path, "svg") => as_text(&chart().svg()?),
                () => write_picture(&there, &chart().png()?),
            });
            written.map_err(|error| staged.with_final_name(error))?;
        }
        Ok(())
    }

    /// Gives the files their names.
    pub fn commit(self, console: &Console) -> Result<(), Failure> {
        for (staged, _) in self.staged {
            console.say(&format!("written    {}", staged.commit()?.display()));
        }
        Ok(())
    }
}

fn is(path: &Path, extension: &str) -> bool {
    path.extension().is_some_and(|own| own.eq_ignore_ascii_case(extension))
}

/// A number in a table; nothing if it is not known.
pub fn cell(value: f64, decimals: usize) -> String {
    if value.is_finite() { format!("{value:.decimals$}") } else { String::new() }
}
