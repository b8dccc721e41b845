//! Faults that the lines show by themselves, before cleaning and triangulation:
//!
//! - elevations that jump where two pieces of a line meet;
//! - lines and vertices far from all others;
//! - coordinates in degrees;
//! - elevations that stand for no data;
//! - lines of almost no length;
//! - vertices that stand out of a smooth line.
//!
//! All of them are reported. Only jumps and vertices that stand out have a correction, because the rest of the line
//! shows the right value. The result does not depend on the order of the input's features.

mod ends;
mod far;
mod jumps;
mod levels;
mod shape;
mod short;
mod strays;

use std::cmp::Ordering;
use std::collections::HashSet;

use super::Judged;
use crate::base::FeatureId;
use crate::base::bits::bits;
use crate::base::error::{Finding, FindingKind};
use crate::contour::ContourMap;

/// Tolerance of the checks.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LineParams {
    /// Ends no further apart than this meet, map units. As [`CleanParams::snap`](crate::clean::CleanParams::snap).
    pub snap: f64,
}

/// Checks the lines of a map as they were read, in the projected plane in which the map is processed.
///
/// Line numbers in the corrections are those of `map`. So [`correct`](fn@super::correct) has to apply them before
/// cleaning. Coordinates and elevations may have any value; those that are not finite are left to cleaning.
pub fn examine(map: &ContourMap, params: &LineParams) -> Judged {
    let shape = shape::of_map(map);
    let ends = ends::find(map, params.snap);
    let mut judged = jumps::find(map, &ends);
    judged.findings.extend(far::find(map, &shape));
    let strays = strays::find(map);
    // A vertex that is very far off is reported as far away, not as standing out.
    let far = places(&judged.findings, |kind| kind == FindingKind::FarAway);
    judged.findings.extend(strays.findings.into_iter().filter(|f| !far.contains(&place(f))));
    judged.corrections.extend(strays.corrections);
    judged.findings.extend(levels::find(map));
    let reported =
        judged.findings.iter().filter(|f| matches!(f.kind, FindingKind::FarAway | FindingKind::LooksLikeDegrees));
    let reported: HashSet<FeatureId> = reported.flat_map(|f| f.features.iter().copied()).collect();
    judged.findings.extend(short::find(map, &shape, &ends, &reported));
    judged.findings.sort_by(compare);
    judged
}

/// The lines and vertices that lie far from all others, and coordinates that look like degrees.
pub fn far_lines(map: &ContourMap) -> Vec<Finding> {
    far::find(map, &shape::of_map(map))
}

/// Joins the findings about the lines with those of cleaning, each fault once. Two levels that meet where an elevation
/// jumps are reported with the jump. A vertex that cleaning left out, because its line strays across another, is
/// reported by cleaning only. Positions within `reach` (map units) count as one.
pub fn merged(mut reported: Vec<Finding>, cleaning: Vec<Finding>, reach: f64) -> Vec<Finding> {
    let left_out = places(&cleaning, |kind| matches!(kind, FindingKind::LevelsCross | FindingKind::SelfCross));
    reported.retain(|f| f.kind != FindingKind::StrayVertex || !left_out.contains(&place(f)));
    let jumps: Vec<usize> = (0..reported.len()).filter(|&i| reported[i].kind == FindingKind::LevelJump).collect();
    // Sorted by x, to look only at those near a position.
    let mut jumps: Vec<(f64, usize)> = jumps.into_iter().filter_map(|i| Some((reported[i].place?.x, i))).collect();
    jumps.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
    let mut rest = Vec::with_capacity(cleaning.len());
    for finding in cleaning {
        let jump = finding.place.filter(|_| finding.kind == FindingKind::LevelsCross).and_then(|place| {
            let from = jumps.partition_point(|j| j.0 < place.x - reach);
            let near = jumps[from..].iter().take_while(|j| j.0 <= place.x + reach);
            near.map(|j| j.1).find(|&i| {
                reported[i].place.is_some_and(|p| p.distance(place) <= reach)
                    && finding.elevations.iter().all(|z| reported[i].elevations.contains(z))
            })
        });
        match jump {
            Some(i) => reported[i].message = format!("{}; {}", reported[i].message, finding.message),
            None => rest.push(finding),
        }
    }
    reported.append(&mut rest);
    reported
}

/// The positions of findings of some kinds.
fn places(findings: &[Finding], of: impl Fn(FindingKind) -> bool) -> HashSet<Option<[u64; 2]>> {
    findings.iter().filter(|f| of(f.kind)).map(place).collect()
}

/// A finding's position, as exact bits.
fn place(finding: &Finding) -> Option<[u64; 2]> {
    finding.place.map(bits)
}

/// The order of findings: by kind, position and message.
fn compare(a: &Finding, b: &Finding) -> Ordering {
    let places = match (&a.place, &b.place) {
        (Some(p), Some(q)) => p.x.total_cmp(&q.x).then(p.y.total_cmp(&q.y)),
        (p, q) => p.is_some().cmp(&q.is_some()),
    };
    a.kind.cmp(&b.kind).then(places).then_with(|| a.message.cmp(&b.message))
}

#[cfg(test)]
mod tests;
