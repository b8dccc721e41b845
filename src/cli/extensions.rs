//! The extensions of files that are written.

use std::path::Path;

use tokosen::io::raster::DEM_EXTENSIONS;
use tokosen::io::{StagedOutput, VectorFormat};

use super::failure::Failure;

/// Refuses a file whose extension is not that of a vector format; `kinds` names those that are.
pub fn check_vector(path: &Path, kinds: &str) -> Result<(), Failure> {
    VectorFormat::from_path(path).map_err(|_| Failure::Usage(format!("{}: {kinds}", path.display())))?;
    Ok(())
}

/// Refuses a file whose extension is not one of `known`. `what` names its contents.
pub fn check_extension(path: &Path, what: &str, known: &[&str]) -> Result<(), Failure> {
    if known.contains(&extension(path).as_str()) {
        return Ok(());
    }
    let known: Vec<String> = known.iter().map(|e| format!(".{e}")).collect();
    Err(Failure::Usage(format!("{}: {what} are written as {}", path.display(), known.join(", "))))
}

/// Opens the file of a raster.
pub fn open_raster(path: &Path) -> Result<StagedOutput, Failure> {
    check_extension(path, "height maps", &DEM_EXTENSIONS)?;
    Ok(StagedOutput::create(path)?)
}

/// Whether a file is a GeoTIFF, by its extension.
pub fn is_tiff(path: &Path) -> bool {
    ["tif", "tiff"].contains(&extension(path).as_str())
}

/// Whether a file is a raster, by its extension.
pub fn is_raster(path: &Path) -> bool {
    DEM_EXTENSIONS.contains(&extension(path).as_str())
}

/// The extension of a file in small letters.
pub fn extension(path: &Path) -> String {
    path.extension().and_then(|e| e.to_str()).unwrap_or_default().to_ascii_lowercase()
}
