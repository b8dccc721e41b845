//! Makes streams and break lines from the lines of a file.

use std::path::Path;

use super::area::single_polygons;
use super::attributes::is_kind_name;
use super::table::{Line, Table, Value};
use tokosen_core::base::FeatureId;
use tokosen_core::base::error::{Error, Finding, FindingKind, Report, Result};
use tokosen_core::break_lines::{Bend, BreakLine};
use tokosen_core::clean::is_place;
use tokosen_core::contour::CliffLine;
use tokosen_core::features::Role;
use tokosen_core::streams::{RiverArea, StreamLine};

/// The lines of a table as cliffs, in the order of the file. What cannot be one is a finding.
pub(super) fn cliffs(path: &Path, table: Table) -> Result<Report<Vec<CliffLine>>> {
    let mut lines = Vec::new();
    let findings = for_each_line(path, table, Role::Cliffs, |feature, _, line| {
        lines.push(CliffLine { points: line.points, feature });
    })?;
    Ok(Report { value: lines, findings })
}

/// The lines and polygons of a table as rivers and streams, in the order of the file. What cannot be one is a finding.
pub(super) fn waterways(path: &Path, mut table: Table) -> Result<Report<(Vec<StreamLine>, Vec<RiverArea>)>> {
    let polygons = table.take_polygons();
    let (mut lines, mut areas) = (Vec::new(), Vec::new());
    let mut findings = Vec::new();
    let has_areas = !polygons.features.is_empty();
    if has_areas {
        match single_polygons(path, polygons) {
            Ok(members) => {
                areas.extend(members.into_iter().map(|m| RiverArea { polygon: m.polygon, feature: m.feature.into() }));
            }
            Err(error) => {
                let message = format!("the river areas are left out: {error}");
                findings.push(Finding::general(FindingKind::StreamLeftOut, message));
            }
        }
    }
    if !has_areas || table.features.iter().any(|feature| !feature.lines.is_empty()) {
        findings.extend(for_each_line(path, table, Role::Streams, |feature, _, line| {
            lines.push(StreamLine { points: line.points, feature });
        })?);
    }
    Ok(Report { value: (lines, areas), findings })
}

/// The lines of a table as break lines, in the order of the file. What cannot be one is a finding. If z is 0 everywhere in
/// the file, the lines have no heights.
pub(super) fn break_lines(path: &Path, table: Table) -> Result<Report<Vec<BreakLine>>> {
    let kind = table.fields.iter().position(|field| is_kind_name(&field.name));
    let all = table.features.iter().flat_map(|feature| &feature.lines);
    let has_heights = all.filter_map(|line| line.z).any(|z| z != [0.0; 2]);
    let mut lines = Vec::new();
    let mut unknown: Option<(usize, String)> = None;
    let mut findings = for_each_line(path, table, Role::BreakLines, |feature, values, line| {
        let value = values.iter().find(|(field, _)| Some(*field) == kind).map_or(&Value::Null, |(_, value)| value);
        let bend = bend(value).unwrap_or_else(|| {
            unknown.get_or_insert((0, value.to_string())).0 += 1;
            Bend::default()
        });
        let heights = if has_heights { line.heights } else { Vec::new() };
        lines.push(BreakLine { points: line.points, heights, bend, feature });
    })?;
    if let Some((count, example)) = unknown {
        let message = format!(
            "{}: the kind of {count} break lines is neither ridge nor valley nor edge, for example {example}; the ground \
             may bend either way there",
            path.display()
        );
        findings.push(Finding::general(FindingKind::BreakLineKind, message));
    }
    Ok(Report { value: lines, findings })
}

/// How the ground bends across a line of this kind; `None` if the kind is not known.
fn bend(kind: &Value) -> Option<Bend> {
    match kind {
        Value::Null => Some(Bend::Either),
        Value::Number(_) | Value::Measured(..) => None,
        Value::Text(text) => match text.trim().to_lowercase().as_str() {
            "" | "edge" => Some(Bend::Either),
            "ridge" => Some(Bend::Ridge),
            "valley" => Some(Bend::Valley),
            _ => None,
        },
    }
}

/// Calls `visit` for each line of two or more different points, with the attributes of its feature. The line has a height
/// for each point, or none at all. Gives what was left out.
fn for_each_line(
    path: &Path,
    mut table: Table,
    role: Role,
    mut visit: impl FnMut(FeatureId, &[(usize, Value)], Line),
) -> Result<Vec<Finding>> {
    table.report_left_out(path, role, None);
    let mut findings = std::mem::take(&mut table.findings);
    if table.features.iter().all(|feature| feature.lines.is_empty()) {
        let found = table.found_words();
        return Err(Error::file(path, format!("there is no line in it{found}; {}", role.sentence())));
    }
    let (one, left_out) = (role.one(), role.left_out());
    for feature in table.features {
        let id = FeatureId::from(feature.number);
        for Line { points, z, heights, is_ring } in feature.lines {
            let count = points.len();
            let level = z.filter(|[lo, hi]| lo == hi).map(|[z, _]| z);
            let height = |k: usize| heights.get(k).copied().or(level);
            let sound: Vec<_> = points.iter().enumerate().filter(|(_, p)| is_place(**p)).collect();
            if sound.len() < count {
                let message =
                    format!("{} points of a {one} have no valid coordinates; they are left out", count - sound.len());
                let finding = Finding::new(FindingKind::NonFinitePoint, sound.first().map(|(_, p)| **p), message);
                findings.push(finding.of_feature(id));
            }
            let mut vertices: Vec<_> = sound.into_iter().map(|(k, p)| (*p, height(k))).collect();
            vertices.dedup_by_key(|(p, _)| *p);
            if vertices.len() > 1 {
                let points = vertices.iter().map(|(p, _)| *p).collect();
                let heights = vertices.iter().filter_map(|(_, z)| *z).collect();
                visit(id, &feature.values, Line { points, z, heights, is_ring });
            } else {
                let message = format!("the {one} is a point; it is left out");
                let finding = Finding::new(left_out, vertices.first().map(|(p, _)| *p), message);
                findings.push(finding.of_feature(id));
            }
        }
    }
    Ok(findings)
}
