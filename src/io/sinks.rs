//! Makes sinks from the points and polygons of a file.

use std::path::Path;

use geo::MultiPolygon;

use super::area::united_polygons;
use super::table::{NO_GEOMETRY, Table};
use tokosen_core::base::error::{Error, Finding, FindingKind, Report, Result};
use tokosen_core::clean::is_place;
use tokosen_core::drain::{Sink, SinkShape};

/// The points of a table as sinks, then its polygons. What cannot be one is a finding.
pub(super) fn sinks(path: &Path, mut table: Table) -> Result<Report<Vec<Sink>>> {
    let mut findings = std::mem::take(&mut table.findings);
    let lines = table.features.iter().map(|feature| feature.lines.len() as u64).sum();
    let left_out = table
        .left_out
        .iter()
        .map(|(kind, count)| (if kind == NO_GEOMETRY { "features without geometry" } else { kind.as_str() }, *count));
    for (what, count) in left_out.chain([("lines", lines)]).filter(|(_, count)| *count > 0) {
        let message = format!("{}: {count} {what} left out; sinks are points or polygons", path.display());
        findings.push(Finding::general(FindingKind::SkippedFeature, message));
    }
    if table.features.iter().all(|feature| feature.spots.is_empty() && feature.polygons.is_empty()) {
        let found = table.found_words();
        return Err(Error::file(
            path,
            format!("there is no point and no polygon in it{found}; sinks are one or the other"),
        ));
    }
    let mut sinks = Vec::new();
    for feature in &table.features {
        for spot in &feature.spots {
            if is_place(spot.place) {
                sinks.push(Sink { shape: SinkShape::Point(spot.place), feature: feature.number.into() });
            } else {
                let message = "the sink is a point without valid coordinates; it is left out";
                findings.push(Finding::general(FindingKind::NonFinitePoint, message).of_feature(feature.number));
            }
        }
    }
    let polygons = united_polygons(path, table, |_, _| true)?;
    let area = |polygon| SinkShape::Area(MultiPolygon::new(vec![polygon]));
    sinks.extend(polygons.into_iter().map(|m| Sink { shape: area(m.polygon), feature: m.feature.into() }));
    Ok(Report { value: sinks, findings })
}
