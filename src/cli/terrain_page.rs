//! The page that shows a terrain in 3-D: of `mesh`, and `--page` of `densify` and `compare`.

use std::path::Path;

use tokosen::base::error::Error;
use tokosen::io::StagedOutput;
use tokosen::terrain::{HtmlParams, Terrain};

use super::console::Console;
use super::extensions::check_extension;
use super::failure::Failure;

/// The extensions of pages.
pub const PAGE_EXTENSIONS: [&str; 2] = ["html", "htm"];

/// Opens the file of a page, before anything is read.
pub fn open(path: &Path) -> Result<StagedOutput, Failure> {
    check_extension(path, "pages", &PAGE_EXTENSIONS)?;
    Ok(StagedOutput::create(path)?)
}

/// Writes the page of a terrain.
pub fn write(staged: &StagedOutput, terrain: &Terrain, params: &HtmlParams, console: &Console) -> Result<(), Failure> {
    put(staged, &terrain.to_html(params, console)?, console)
}

/// Writes a page.
pub fn put(staged: &StagedOutput, page: &str, console: &Console) -> Result<(), Failure> {
    let path = staged.path();
    let written = console.step("writing", || std::fs::write(&path, page));
    Ok(written.map_err(|e| staged.with_final_name(Error::io("write", &path, e)))?)
}

/// Gives the page its name.
pub fn commit(staged: StagedOutput, console: &Console) -> Result<(), Failure> {
    let path = staged.commit()?;
    console.say(&format!("written    {} (a page for the browser; it needs no other file)", path.display()));
    Ok(())
}
