//! Makes lines of a coast from the lines and polygons of a file.

use std::path::Path;

use super::ReadOptions;
use super::elevation::{Heights, coast_heights};
use super::table::{NO_GEOMETRY, Table};
use tokosen_core::base::error::{Error, Finding, FindingKind, Report, Result};
use tokosen_core::contour::{CoastLine, StatedUnit};

/// The lines of a table, and the rings of its polygons, in the order of the file. What cannot be a coast is a finding.
/// Also gives the unit that the file states for their levels.
pub(super) fn coast(
    path: &Path,
    mut table: Table,
    options: &ReadOptions,
) -> Result<Report<(Vec<CoastLine>, Option<StatedUnit>)>> {
    let mut findings = std::mem::take(&mut table.findings);
    let spots = table.features.iter().map(|feature| feature.spots.len() as u64).sum();
    let left_out = table
        .left_out
        .iter()
        .map(|(kind, count)| (if kind == NO_GEOMETRY { "features without geometry" } else { kind.as_str() }, *count));
    for (what, count) in left_out.chain([("points", spots)]).filter(|(_, count)| *count > 0) {
        let message = format!("{}: {count} {what} left out; a coast is lines or polygons", path.display());
        findings.push(Finding::general(FindingKind::SkippedFeature, message));
    }
    if table.features.iter().all(|feature| feature.lines.is_empty() && feature.polygons.is_empty()) {
        let found = table.found_words();
        return Err(Error::file(
            path,
            format!("there is no line and no polygon in it{found}; a coast is one or the other"),
        ));
    }
    let Heights { of: heights, stated_unit, findings: mut about_heights } = coast_heights(path, &mut table, options)?;
    findings.append(&mut about_heights);
    let mut lines = Vec::new();
    for feature in table.features {
        let level = heights.get(&feature.number).copied();
        let own = feature.lines.into_iter().map(|line| line.points);
        let rings = feature.polygons.into_iter().flatten().map(|mut ring| {
            if ring.first() != ring.last() {
                ring.extend(ring.first().copied());
            }
            ring
        });
        lines.extend(own.chain(rings).map(|points| CoastLine { points, level, feature: feature.number.into() }));
    }
    Ok(Report { value: (lines, stated_unit), findings })
}
