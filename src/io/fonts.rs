//! Fonts of the system, for letters that the font of the program does not have.

use std::path::{Path, PathBuf};

use super::ordinary::open_to_read;
use tokosen_core::base::error::{Error, Result};

/// Folders with fonts, on Linux, macOS and Windows; those below the home folder as well.
const FOLDERS: [&str; 7] = [
    "/usr/share/fonts",
    "/usr/local/share/fonts",
    "/System/Library/Fonts",
    "/Library/Fonts",
    "C:\\Windows\\Fonts",
    "/run/current-system/sw/share/X11/fonts",
    "/opt/homebrew/share/fonts",
];
const BELOW_HOME: [&str; 3] = [".fonts", ".local/share/fonts", "Library/Fonts"];
/// Parts of the names of fonts with Japanese letters: plain faces first.
const NAMES: [&str; 14] = [
    "notosanscjk-regular",
    "notosansjp-regular",
    "notosanscjkjp",
    "notosansjp",
    "sourcehansans",
    "biz-udgothicr",
    "yugothm",
    "meiryo",
    "hiragino",
    "ヒラギノ角ゴシック w3",
    "ipaexg",
    "ipag",
    "takaogothic",
    "msgothic",
];
/// Folders below a folder are searched this deep.
const DEPTH: usize = 4;
/// Larger files are no fonts, bytes.
const MOST: u64 = 1 << 27;

/// Reads the file of a font.
///
/// # Errors
/// If it cannot be read, or is far too large for a font.
pub fn read_font(path: &Path) -> Result<Vec<u8>> {
    let length = open_to_read(path)?.metadata().map_err(|e| Error::io("read", path, e))?.len();
    if length > MOST {
        return Err(Error::file(path, "is too large for a font"));
    }
    std::fs::read(path).map_err(|e| Error::io("read", path, e))
}

/// Files of fonts that usually have Japanese letters, the best first.
pub fn font_files() -> impl Iterator<Item = PathBuf> {
    let home = std::env::home_dir();
    let below = home.iter().flat_map(|home| BELOW_HOME.map(|folder| home.join(folder)));
    let mut files = Vec::new();
    for folder in below.chain(FOLDERS.map(PathBuf::from)) {
        collect(&folder, DEPTH, &mut files);
    }
    let mut known: Vec<(usize, PathBuf)> = files.into_iter().filter_map(|path| Some((rank(&path)?, path))).collect();
    known.sort();
    known.into_iter().map(|(_, path)| path)
}

/// The place of a font among those that are known. `None` if it is another one, or no font.
fn rank(path: &Path) -> Option<usize> {
    let extension = path.extension()?.to_str()?.to_ascii_lowercase();
    if !["ttf", "otf", "ttc", "otc"].contains(&extension.as_str()) {
        return None;
    }
    let name = path.file_stem()?.to_str()?.to_lowercase();
    NAMES.iter().position(|known| name.contains(known))
}

fn collect(folder: &Path, depth: usize, files: &mut Vec<PathBuf>) {
    let Ok(entries) = std::fs::read_dir(folder) else { return };
    for path in entries.filter_map(|entry| Some(entry.ok()?.path())) {
        if path.is_file() {
            files.push(path);
        } else if depth > 0 && path.is_dir() {
            collect(&path, depth - 1, files);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fonts_are_known_by_their_names_and_plain_ones_come_first() {
        let rank = |name: &str| rank(Path::new(name));
        assert!(rank("a/NotoSansCJK-Regular.ttc") < rank("b/ipaexg.ttf") && rank("b/ipaexg.ttf").is_some());
        assert_eq!([rank("ipaexg.txt"), rank("DejaVuSans.ttf"), rank("noname")], [None; 3]);
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("fonts/opentype/ipag.otf");
        std::fs::create_dir_all(path.parent().unwrap()).unwrap();
        std::fs::write(&path, b"no font").unwrap();
        let mut found = Vec::new();
        collect(folder.path(), DEPTH, &mut found);
        assert_eq!(found, std::slice::from_ref(&path));
        assert_eq!(read_font(&path).unwrap(), b"no font");
        assert!(read_font(&folder.path().join("missing.ttf")).is_err());
    }
}
