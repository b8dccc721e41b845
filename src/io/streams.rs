//! Makes streams from the lines of a file.

use std::path::Path;

use super::table::{NO_GEOMETRY, Table};
use crate::base::error::{Error, Finding, FindingKind, Report, Result};
use crate::clean::is_place;
use crate::streams::StreamLine;

/// The lines of a table as streams, in the order of the file. What cannot be one is a finding.
pub(super) fn streams(path: &Path, table: Table) -> Result<Report<Vec<StreamLine>>> {
    let mut findings = table.findings.clone();
    for (kind, count) in &table.left_out {
        let what = if kind == NO_GEOMETRY { "features without geometry" } else { kind };
        let message = format!("{}: {count} {what} left out; streams are lines", path.display());
        findings.push(Finding::general(FindingKind::SkippedFeature, message));
    }
    if table.features.iter().all(|feature| feature.lines.is_empty()) {
        let found = table.found_words();
        return Err(Error::file(path, format!("there is no line in it{found}; streams are lines")));
    }
    let mut lines = Vec::new();
    for feature in table.features {
        for line in feature.lines {
            let mut points = line.points;
            let count = points.len();
            points.retain(|p| is_place(*p));
            if points.len() < count {
                let message =
                    format!("{} points of a stream have no valid coordinates; they are left out", count - points.len());
                let finding = Finding::new(FindingKind::NonFinitePoint, points.first().copied(), message);
                findings.push(finding.of_feature(feature.number));
            }
            points.dedup();
            if points.len() > 1 {
                lines.push(StreamLine { points, feature: feature.number.into() });
            } else {
                let message = "the stream is a point; it is left out";
                let finding = Finding::new(FindingKind::StreamLeftOut, points.first().copied(), message);
                findings.push(finding.of_feature(feature.number));
            }
        }
    }
    Ok(Report { value: lines, findings })
}
