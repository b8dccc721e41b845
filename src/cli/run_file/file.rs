//! The file of a run.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};
use serde_json::Value;
use tokosen::base::error::{Error, Result};
use tokosen::io::{SAVED_RUN, read_small};

/// The version of the layout of the file. A file with another one is refused.
const LAYOUT: u32 = 1;
/// The largest file that is read, bytes. With thousands of inputs, the file has less than a megabyte.
const MAX_BYTES: u64 = 16 << 20;

/// A run: what is needed to repeat it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct RunFile {
    /// Says that this program made the file.
    description: String,
    /// The version of the layout.
    layout: u32,
    /// The version of the program.
    pub version: String,
    /// The verb and its arguments, as they were given, without `--save-run`.
    pub arguments: Vec<String>,
    /// The folder in which they were given: paths in them start there.
    pub folder: PathBuf,
    /// The files that were read.
    pub inputs: Vec<InputFile>,
    /// What was chosen automatically.
    #[serde(default)]
    pub chosen: BTreeMap<String, Value>,
}

/// A file that was read.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct InputFile {
    /// Its path: absolute, or from the folder of the run.
    pub file: PathBuf,
    /// Its size.
    pub bytes: u64,
    /// The CRC-32 of its content, as eight hexadecimal digits.
    pub crc32: String,
}

/// What tells the files of this program, of any layout, from other JSON.
#[derive(Deserialize)]
struct Head {
    description: String,
    layout: u32,
}

impl RunFile {
    /// A run of this version of the program.
    pub fn new(arguments: Vec<String>, folder: PathBuf) -> Self {
        let version = env!("CARGO_PKG_VERSION").to_owned();
        let (inputs, chosen) = (Vec::new(), BTreeMap::new());
        Self { description: SAVED_RUN.into(), layout: LAYOUT, version, arguments, folder, inputs, chosen }
    }

    /// Reads a run.
    ///
    /// # Errors
    /// The file cannot be read, is too large, is no saved run, is broken, or has another layout.
    pub fn read(path: &Path) -> Result<Self> {
        let text = read_small(path, MAX_BYTES, "a saved run")?;
        let head = serde_json::from_slice::<Head>(&text).ok().filter(|head| head.description == SAVED_RUN);
        let Some(head) = head else {
            return Err(Error::file(path, "is no run that 'tokosen VERB ... --save-run FILE.json' saved"));
        };
        if head.layout != LAYOUT {
            let message = format!(
                "has the layout {} of another version of this program, which reads layout {LAYOUT}; use that version, or \
                 save the run again",
                head.layout
            );
            return Err(Error::file(path, message));
        }
        serde_json::from_slice(&text).map_err(|e| Error::file_cause(path, "the saved run is broken", e))
    }

    /// The text of the file.
    ///
    /// # Errors
    /// A path that is no text.
    pub fn text(&self, path: &Path) -> Result<String> {
        let text = serde_json::to_string_pretty(self);
        Ok(text.map_err(|e| Error::file_cause(path, "a path of the run cannot be stored", e))? + "\n")
    }
}
