//! Runs the program in a folder.

#![allow(clippy::unwrap_used, reason = "helpers of tests are tests too")]

use std::path::Path;
use std::process::{Command, Output};
use std::sync::OnceLock;

use crate::common::Folder;

/// The program.
pub fn tokosen() -> Command {
    Command::new(assert_cmd::cargo::cargo_bin!("tokosen"))
}

/// Runs the program with these arguments.
pub fn run(folder: &Path, arguments: &str) -> Output {
    tokosen().current_dir(folder).args(arguments.split_whitespace()).output().unwrap()
}

/// What it said on standard error.
pub fn said(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

/// A folder with a file of samples/ in it, under the name `to`.
pub fn folder_with(sample: &str, to: &str) -> Folder {
    let folder = Folder::new();
    let sample = Path::new(env!("CARGO_MANIFEST_DIR")).join("samples").join(sample);
    std::fs::copy(sample, folder.path(to)).unwrap();
    folder
}

/// A folder with a part of the large sample in it, 3500 x 3000 m, under the name `to`. The smooth surface of the whole map takes ten
/// times as long.
pub fn folder_with_part(to: &str) -> Folder {
    let folder = Folder::new();
    std::fs::write(folder.path(to), part()).unwrap();
    folder
}

/// The file of this part.
pub fn part() -> &'static [u8] {
    static PART: OnceLock<Vec<u8>> = OnceLock::new();
    PART.get_or_init(|| {
        let folder = folder_with("caryville_20m.gpkg", "all.gpkg");
        folder.succeeds("densify all.gpkg -i 20 --extent 745000,4017500,748500,4020500 -o part.gpkg");
        std::fs::read(folder.path("part.gpkg")).unwrap()
    })
}

/// Runs the program in a test's folder.
pub trait Running {
    /// Whether it went well, and what it said on both streams.
    fn run(&self, arguments: &str) -> (bool, String);

    /// Runs the program, which must succeed; gives what it said.
    fn succeeds(&self, arguments: &str) -> String {
        let (well, text) = self.run(arguments);
        assert!(well, "{arguments}: {text}");
        text
    }

    /// Runs the program, which must end with this status; gives what it said on standard error.
    fn ends(&self, arguments: &str, status: i32) -> String;
}

impl<Tests> Running for Folder<Tests> {
    fn run(&self, arguments: &str) -> (bool, String) {
        let output = run(self.0.path(), arguments);
        let text = [output.stdout, output.stderr].map(|bytes| String::from_utf8(bytes).unwrap()).concat();
        assert!(!text.contains("panicked"), "{arguments}: {text}");
        (output.status.success(), text)
    }

    fn ends(&self, arguments: &str, status: i32) -> String {
        let output = run(self.0.path(), arguments);
        assert_eq!(output.status.code(), Some(status), "{arguments}: {}", said(&output));
        said(&output)
    }
}
