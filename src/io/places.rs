//! Points and lines of a file that stand for places, such as outlets or the line of a profile.

use std::path::Path;

use glam::DVec2;

use super::table::{NO_GEOMETRY, Purpose};
use super::{ReadOptions, read_table};
use tokosen_core::base::error::{Error, Finding, FindingKind, Report, Result};
use tokosen_core::crs::Crs;
use tokosen_core::features::Role;

/// Places that a file names.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Places {
    /// Each place with the number of its feature, in the order of the file.
    pub places: Vec<(DVec2, u64)>,
    /// Their coordinate reference system, if the file names one.
    pub crs: Option<Crs>,
}

/// Lines that a file names.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Paths {
    /// The vertices of each line with the number of its feature, in the order of the file.
    pub lines: Vec<(Vec<DVec2>, u64)>,
    /// Their coordinate reference system, if the file names one.
    pub crs: Option<Crs>,
}

/// Reads the lines of a file, such as the line of a profile. Heights and attributes do not count. Vertices without valid
/// coordinates, and repeated ones, are left out.
///
/// # Errors
/// The file cannot be read or has no line.
pub fn read_paths(path: &Path, options: &ReadOptions) -> Result<Report<Paths>> {
    let mut table = read_table(path, options, Purpose::Features(Role::BreakLines))?;
    let findings = std::mem::take(&mut table.findings);
    let found = table.found_words();
    let (mut lines, mut without_length) = (Vec::new(), None);
    for feature in table.features {
        for line in feature.lines {
            let mut points: Vec<DVec2> = line.points.into_iter().filter(|p| p.is_finite()).collect();
            points.dedup();
            if points.len() > 1 {
                lines.push((points, feature.number));
            } else {
                without_length = without_length.or(Some(feature.number));
            }
        }
    }
    if let (true, Some(feature)) = (lines.is_empty(), without_length) {
        return Err(Error::file(
            path,
            format!("no line in it has a length (feature {feature}); name a file with lines"),
        ));
    }
    if lines.is_empty() {
        return Err(Error::file(path, format!("there is no line in it{found}; name a file with lines")));
    }
    Ok(Report { value: Paths { lines, crs: table.crs }, findings })
}

/// Reads the points of a file, such as the outlets of catchments. Heights and attributes do not count. Lines and polygons are
/// left out, and points without valid coordinates, each with a finding.
///
/// # Errors
/// The file cannot be read or has no point.
pub fn read_places(path: &Path, options: &ReadOptions) -> Result<Report<Places>> {
    let mut table = read_table(path, options, Purpose::Places)?;
    let mut findings = std::mem::take(&mut table.findings);
    let found = table.found_words();
    let mut places = Vec::new();
    for feature in &table.features {
        for spot in &feature.spots {
            if spot.place.is_finite() {
                places.push((spot.place, feature.number));
            } else {
                let message = "the point has no valid coordinates; it is left out";
                findings.push(Finding::general(FindingKind::NonFinitePoint, message).of_feature(feature.number));
            }
        }
    }
    if places.is_empty() {
        return Err(Error::file(path, format!("there is no point in it{found}; name a file with points")));
    }
    let lines: u64 = table.features.iter().map(|feature| feature.lines.len() as u64).sum();
    let others = table.left_out.into_iter().chain([("lines".to_owned(), lines)]).filter(|(_, count)| *count > 0);
    for (kind, count) in others {
        let kind = if kind == NO_GEOMETRY { "features without geometry".into() } else { kind };
        let message = format!("{}: {count} {kind} left out; only points are read", path.display());
        findings.push(Finding::general(FindingKind::SkippedFeature, message));
    }
    Ok(Report { value: Places { places, crs: table.crs }, findings })
}
