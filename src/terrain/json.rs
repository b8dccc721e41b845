//! Findings and comparisons as JSON, for programs.

use std::collections::BTreeMap;

use glam::DVec2;
use serde::Serialize;
use serde_json::{Value, json};

use super::compare::{Pair, SideSource};
use super::input::Input;
use super::prepare::is_repair;
use tokosen_core::base::error::{Error, Finding, Proposal, Result, Severity};
use tokosen_core::contour::{ContourMap, distinct_levels, find_interval};
use tokosen_core::crs::Crs;
use tokosen_core::dem::compare::Comparison;

/// A description of the input, the counts of its findings, and each finding; places are in the input's coordinates.
/// `map` is the map that [`Input::judge`] gave.
pub fn check_json(input: &Input, map: &ContourMap) -> Value {
    let Input { findings, reprojection, .. } = input;
    let place = |p: DVec2| if reprojection.are_unmoved() { Some(p) } else { reprojection.in_input(p) };
    let place = |p: DVec2| place(p).map_or(Value::Null, |p| json!([p.x, p.y]));
    let proposal = |proposal: &Proposal| match proposal {
        Proposal::Relabel { from, to } => json!({ "do": "relabel", "from": from, "to": to }),
        Proposal::LeaveOut => json!({ "do": "leave-out" }),
        Proposal::Join { ends: [a, b] } => json!({ "do": "join", "ends": [place(*a), place(*b)] }),
    };
    let finding = |finding: &Finding| {
        json!({
            "code": finding.kind.code(),
            "severity": finding.kind.severity().name(),
            "place": finding.place.map_or(Value::Null, place),
            "features": finding.features,
            "elevations": finding.elevations,
            "message": finding.message,
            "proposal": finding.proposal.as_ref().map(proposal),
            "repaired": is_repair(finding),
        })
    };
    let mut codes: BTreeMap<&str, usize> = BTreeMap::new();
    for finding in findings {
        *codes.entry(finding.kind.code()).or_default() += 1;
    }
    let count = |severity: Severity| findings.iter().filter(|f| f.kind.severity() == severity).count();
    let levels = distinct_levels(&map.contours);
    json!({
        "input": input.name(),
        "crs": reprojection.input_crs().and_then(Crs::name),
        "plane_unit": reprojection.input_crs().and_then(Crs::length_unit).map(|unit| unit.name),
        "lines": map.contours.len(),
        "vertices": map.vertex_count(),
        "levels": { "lowest": levels.first(), "highest": levels.last(), "count": levels.len() },
        "interval": find_interval(&map.contours).map(|interval| interval.step),
        "counts": {
            "error": count(Severity::Error),
            "warning": count(Severity::Warning),
            "note": count(Severity::Note),
        },
        "codes": codes,
        "findings": findings.iter().map(finding).collect::<Vec<_>>(),
    })
}

/// A comparison for programs.
#[derive(Serialize)]
struct Json<'a> {
    /// What A and B are.
    sources: [&'a SideSource; 2],
    /// How they were brought onto one grid.
    notes: &'a [String],
    /// Columns and rows.
    size: [usize; 2],
    /// Cell width and height, map units.
    cell: DVec2,
    #[serde(flatten)]
    found: &'a Comparison,
    /// Findings about the inputs.
    findings: &'a [Finding],
}

/// All figures as JSON, with what A and B are and the findings about them.
///
/// # Errors
/// [`Error::Data`] if a figure cannot be written as JSON.
pub fn comparison_json(pair: &Pair, found: &Comparison, findings: &[Finding]) -> Result<String> {
    let grid = pair.b_heights.grid();
    let json = Json {
        sources: [&pair.a.source, &pair.b.source],
        notes: &pair.notes,
        size: [grid.cols, grid.rows],
        cell: grid.cell,
        found,
        findings,
    };
    serde_json::to_string_pretty(&json).map_err(|e| Error::Data(format!("cannot be written as JSON: {e}")))
}
