//! The arguments of a run as they are saved.

use std::ffi::OsString;

use crate::cli::failure::Failure;

/// The flag that saves a run; it is not a part of the run.
const FLAG: &str = "--save-run";

/// The arguments without `--save-run` and its value.
pub fn saved_arguments(given: Vec<OsString>) -> Result<Vec<String>, Failure> {
    let mut saved = Vec::new();
    let mut given = given.into_iter();
    let mut is_open = true;
    while let Some(argument) = given.next() {
        let text = argument.into_string().map_err(|argument| {
            Failure::Usage(format!("--save-run holds text, and this argument is none: {}", argument.display()))
        })?;
        // Behind it, everything is a file.
        is_open &= text != "--";
        match text.strip_prefix(FLAG).filter(|_| is_open) {
            Some("") => drop(given.next()),
            Some(value) if value.starts_with('=') => {}
            _ => saved.push(text),
        }
    }
    Ok(saved)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn saved(given: &str) -> String {
        saved_arguments(given.split(' ').map(OsString::from).collect()).unwrap().join(" ")
    }

    #[test]
    fn everything_but_the_flag_and_its_value_is_saved() {
        assert_eq!(saved("dem a.gpkg --save-run r.json -o b.tif"), "dem a.gpkg -o b.tif");
        assert_eq!(saved("--save-run=r.json dem a.gpkg -o b.tif"), "dem a.gpkg -o b.tif");
        assert_eq!(saved("dem -q -- a.gpkg --save-run"), "dem -q -- a.gpkg --save-run");
        assert_eq!(saved("dem a.gpkg --save-runs"), "dem a.gpkg --save-runs");
    }
}
