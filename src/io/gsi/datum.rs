//! The coordinate reference systems of the documents.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use tokosen_core::base::error::{Error, Finding, FindingKind, Result};
use tokosen_core::crs::{Crs, HeightSystem, mixed_heights};

const JGD2000: u32 = 4612;
/// Also the code of JGD2024, which changed heights but not longitude and latitude.
const JGD2011: u32 = 6668;

/// The EPSG code of a `srsName`. All systems are latitude and longitude in degrees.
fn code(name: &str) -> Option<u32> {
    match name.to_ascii_lowercase().strip_prefix("fguuid:")? {
        "jgd2000.bl" => Some(JGD2000),
        "jgd2011.bl" | "jgd2024.bl" => Some(JGD2011),
        _ => None,
    }
}

/// The systems that documents name, each with the first such document.
#[derive(Default)]
pub(super) struct Datums {
    codes: BTreeMap<u32, PathBuf>,
    /// By the names of the height systems, which change more often.
    heights: BTreeMap<String, PathBuf>,
}

impl Datums {
    /// Records the system of a document's `srsName`.
    pub fn note(&mut self, path: &Path, name: &str) -> Result<()> {
        let Some(code) = code(name) else {
            let message = format!(
                "the coordinate reference system {name:?} is not known; known are fguuid:jgd2000.bl, fguuid:jgd2011.bl \
                 and fguuid:jgd2024.bl"
            );
            return Err(Error::file(path, message));
        };
        self.codes.entry(code).or_insert_with(|| path.to_owned());
        let system = name.split_once(':').map_or(name, |(_, system)| system);
        self.heights.entry(HeightSystem::named(system).name).or_insert_with(|| path.to_owned());
        Ok(())
    }

    /// The height system of all documents together: the newest one. Squares of a download may have different ones, because each
    /// file names that of its date.
    pub fn height_system(&self, findings: &mut Vec<Finding>) -> Option<HeightSystem> {
        let (newest, path) = self.heights.last_key_value()?;
        let newest = HeightSystem { name: newest.clone() };
        for (name, other) in self.heights.iter().filter(|(name, _)| **name != newest.name) {
            let system = HeightSystem { name: name.clone() };
            findings.push(mixed_heights((&other.display(), &system), (&path.display(), &newest)));
        }
        Some(newest)
    }

    /// The system of all documents together. One download may contain both systems, because each file names the one of
    /// its date.
    pub fn crs(self, findings: &mut Vec<Finding>) -> Option<Crs> {
        if let (Some(old), Some(new)) = (self.codes.get(&JGD2000), self.codes.get(&JGD2011)) {
            let message = format!(
                "{} is in JGD2000 and {} in JGD2011: all is taken as JGD2011; the two differ where the ground moved before \
                 2011, by up to 5 m in the north-east of Honshu",
                old.display(),
                new.display()
            );
            findings.push(Finding::general(FindingKind::MixedCrs, message));
        }
        self.codes.into_keys().next_back().map(Crs::from_epsg)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(names: &[&str]) -> (Option<u32>, usize) {
        let mut datums = Datums::default();
        names.iter().try_for_each(|name| datums.note(Path::new("a.xml"), name)).unwrap();
        let mut findings = Vec::new();
        (datums.crs(&mut findings).and_then(|crs| crs.epsg), findings.len())
    }

    #[test]
    fn systems() {
        assert_eq!(of(&["fguuid:jgd2000.bl"]), (Some(4612), 0));
        assert_eq!(of(&["fguuid:jgd2024.bl", "fguuid:jgd2011.bl"]), (Some(6668), 0));
        assert_eq!(of(&["fguuid:jgd2011.bl", "fguuid:jgd2000.bl"]), (Some(6668), 1));
        assert_eq!(of(&[]), (None, 0));
        for name in ["", "fguuid:tokyo.bl", "fguuid:jgd2011.xy", "EPSG:6668"] {
            let error = Datums::default().note(Path::new("a.xml"), name).unwrap_err().to_string();
            assert!(error.starts_with("a.xml: ") && error.contains("jgd2024.bl"), "{error}");
        }
    }
}
