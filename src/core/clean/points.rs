//! Bad points: invalid coordinates, invalid elevations, repeated points, and lines that are a single point.

use glam::DVec2;
use rayon::prelude::*;

use super::canonical::has_repeated_vertex;
use crate::base::FeatureId;
use crate::base::error::{Error, Finding, FindingKind, Report, Result};
use crate::contour::Contour;
use crate::geometry::compare_points;

/// Largest valid coordinate, map units. Its fourth power is still finite, which the predicates and distances need.
const LARGEST_COORDINATE: f64 = 1e50;

/// Coordinates smaller than this become zero, map units. Their products would underflow, and the predicates would no
/// longer be exact. The triangulation does not accept them either.
const SMALLEST_COORDINATE: f64 = 1e-40;

/// Largest valid elevation, metres. Larger numbers, such as 1e30, mark a missing elevation. Heights are written as
/// 32-bit numbers, and their squares must be finite.
const LARGEST_ELEVATION: f64 = 1e9;

/// Zero for a number that is practically zero. −0 becomes 0 too, so that equal numbers have equal bits.
fn without_dust(x: f64) -> f64 {
    if x.abs() < SMALLEST_COORDINATE { 0.0 } else { x }
}

/// Whether a point has valid coordinates.
pub fn is_place(p: DVec2) -> bool {
    p.x.abs() <= LARGEST_COORDINATE && p.y.abs() <= LARGEST_COORDINATE
}

/// Whether a number is a valid height.
pub(crate) fn is_height(z: f64) -> bool {
    z.abs() <= LARGEST_ELEVATION
}

/// A point whose tiny coordinates are set to zero.
pub(super) fn tidy(p: DVec2) -> DVec2 {
    DVec2::new(without_dust(p.x), without_dust(p.y))
}

/// Removes invalid points, and lines without elevation or length.
pub(super) fn drop_bad(contours: Vec<Contour>) -> Report<Vec<Contour>> {
    let (lines, findings): (Vec<Option<Contour>>, Vec<Vec<Finding>>) =
        contours.into_par_iter().map(drop_bad_points).unzip();
    let mut findings = findings.concat();
    // The lines are still in the input's order.
    findings.sort_by(|a, b| {
        (a.kind.cmp(&b.kind))
            .then_with(|| match (&a.place, &b.place) {
                (Some(p), Some(q)) => compare_points(p, q),
                (p, q) => p.is_some().cmp(&q.is_some()),
            })
            .then_with(|| a.message.cmp(&b.message))
    });
    Report { value: lines.into_iter().flatten().collect(), findings }
}

fn drop_bad_points(mut line: Contour) -> (Option<Contour>, Vec<Finding>) {
    let (elevation, feature) = (line.elevation, line.feature);
    if !is_height(elevation) {
        let message = format!("the line of feature {feature} has no valid elevation; it was left out");
        let place = line.points.iter().find(|p| is_place(**p)).copied();
        return (None, vec![Finding::new(FindingKind::MissingElevation, place, message).about(feature, elevation)]);
    }
    line.elevation += 0.0;
    line.points.iter_mut().for_each(|p| *p = tidy(*p));
    let mut findings = Vec::new();
    if line.points.len() < 2
        || line.points.iter().any(|p| !is_place(*p))
        || line.points.windows(2).any(|w| w[0] == w[1])
    {
        line.points = kept_points(&line.points, elevation, feature, &mut findings);
    }
    if line.points.len() < 2 {
        let message = format!(
            "the contour {elevation} m (feature {feature}) has fewer than two different points; it was left out"
        );
        // The repeated point is part of the same fault.
        findings.retain(|f| f.kind != FindingKind::RepeatedPoint);
        let finding = Finding::new(FindingKind::PointLine, line.points.first().copied(), message);
        findings.push(finding.about(feature, elevation));
        return (None, findings);
    }
    (Some(line), findings)
}

fn kept_points(points: &[DVec2], elevation: f64, feature: FeatureId, findings: &mut Vec<Finding>) -> Vec<DVec2> {
    let mut kept: Vec<DVec2> = Vec::with_capacity(points.len());
    // One finding per run of equal points, however long.
    let mut in_run = false;
    for (i, &p) in points.iter().enumerate() {
        if !is_place(p) {
            let neighbour = kept.last().or_else(|| points[i..].iter().find(|q| is_place(**q)));
            let message = format!(
                "a point of the contour {elevation} m (feature {feature}) has no valid coordinates; it was left out"
            );
            let finding = Finding::new(FindingKind::NonFinitePoint, neighbour.copied(), message);
            findings.push(finding.about(feature, elevation));
        } else if kept.last() == Some(&p) {
            if !in_run {
                let message =
                    format!("a point of the contour {elevation} m (feature {feature}) is repeated; only one was kept");
                findings.push(Finding::at(FindingKind::RepeatedPoint, p, message).about(feature, elevation));
            }
            in_run = true;
        } else {
            kept.push(p);
            in_run = false;
        }
    }
    kept
}

/// Checks a single line's points.
pub(super) fn validate(line: &Contour) -> Result<()> {
    let fault = if !is_height(line.elevation) {
        "has no valid elevation"
    } else if line.points.len() < 2 {
        "has fewer than two points"
    } else if !line.points.iter().all(|p| is_place(*p)) {
        "has a point without valid coordinates"
    } else if has_repeated_vertex(&line.points) {
        "visits a vertex twice"
    } else {
        return Ok(());
    };
    Err(Error::Data(format!("the contour {} m (feature {}) {fault}", line.elevation, line.feature)))
}
