//! The files beside a `.shp`.

use std::path::{Path, PathBuf};

/// The companion of a `.shp` with this extension, as it is spelled on the disk: in lower case, in capitals, or as it
/// would be written new.
pub(super) fn companion(shp: &Path, extension: &str) -> PathBuf {
    let lower = shp.with_extension(extension);
    let upper = shp.with_extension(extension.to_ascii_uppercase());
    if !lower.exists() && upper.exists() { upper } else { lower }
}
