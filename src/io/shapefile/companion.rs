//! The files beside a `.shp`.

use std::path::{Path, PathBuf};

/// The companion of a `.shp` with this extension, in the spelling found on the disk: lower case or capitals. If there
/// is none, the name that a new file would get.
pub(super) fn companion(shp: &Path, extension: &str) -> PathBuf {
    let lower = shp.with_extension(extension);
    let upper = shp.with_extension(extension.to_ascii_uppercase());
    if !lower.exists() && upper.exists() { upper } else { lower }
}
