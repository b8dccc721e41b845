//! Bad points: coordinates that are no places, elevations that are no heights, repeated points, lines that are mere points.

use glam::DVec2;
use rayon::prelude::*;

use super::canonical::has_repeated_vertex;
use crate::base::error::{Error, Finding, FindingKind, Report, Result};
use crate::contour::Contour;
use crate::geometry::compare_points;

/// Coordinates beyond this, in map units, are no places. The fourth power still is a finite number, which the predicates
/// and distances need.
const LARGEST_COORDINATE: f64 = 1e50;

/// Coordinates smaller than this, in map units, become zero. Their products would underflow, and the predicates would no
/// longer be exact; nor does a triangulation take them.
const SMALLEST_COORDINATE: f64 = 1e-40;

/// Elevations beyond this, in metres, are no heights but marks for a missing one, as 1e30 is. Heights are written as
/// 32-bit numbers, and squares of them must be finite ones.
const LARGEST_ELEVATION: f64 = 1e9;

/// Zero for a number that is as good as zero, negative zero among them, so that equal numbers have equal bits.
fn without_dust(x: f64) -> f64 {
    if x.abs() < SMALLEST_COORDINATE { 0.0 } else { x }
}

/// Whether a point is a place.
pub(crate) fn is_place(p: DVec2) -> bool {
    p.x.abs() <= LARGEST_COORDINATE && p.y.abs() <= LARGEST_COORDINATE
}

/// Whether a number is a height.
pub(crate) fn is_height(z: f64) -> bool {
    z.abs() <= LARGEST_ELEVATION
}

/// A point without dust in its coordinates.
pub(super) fn tidy(p: DVec2) -> DVec2 {
    DVec2::new(without_dust(p.x), without_dust(p.y))
}

/// Drops points and lines that are none.
pub(super) fn drop_bad(contours: Vec<Contour>) -> Report<Vec<Contour>> {
    let (lines, findings): (Vec<Option<Contour>>, Vec<Vec<Finding>>) =
        contours.into_par_iter().map(drop_bad_points).unzip();
    let mut findings = findings.concat();
    // The lines are in the input's order still.
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
        let message = format!("the line of feature {feature} has no elevation that is a height; it was left out");
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
        // That its point is repeated is the same fault.
        findings.retain(|f| f.kind != FindingKind::RepeatedPoint);
        let finding = Finding::new(FindingKind::PointLine, line.points.first().copied(), message);
        findings.push(finding.about(feature, elevation));
        return (None, findings);
    }
    (Some(line), findings)
}

fn kept_points(points: &[DVec2], elevation: f64, feature: u64, findings: &mut Vec<Finding>) -> Vec<DVec2> {
    let mut kept: Vec<DVec2> = Vec::with_capacity(points.len());
    // One finding for a run of the same point, however long.
    let mut in_run = false;
    for (i, &p) in points.iter().enumerate() {
        if !is_place(p) {
            let neighbour = kept.last().or_else(|| points[i..].iter().find(|q| is_place(**q)));
            let message =
                format!("a point of the contour {elevation} m (feature {feature}) is no place; it was left out");
            let finding = Finding::new(FindingKind::NonFinitePoint, neighbour.copied(), message);
            findings.push(finding.about(feature, elevation));
        } else if kept.last() == Some(&p) {
            if !in_run {
                let message =
                    format!("a point of the contour {elevation} m (feature {feature}) is repeated; it was kept once");
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
        "has no elevation that is a height"
    } else if line.points.len() < 2 {
        "has fewer than two points"
    } else if !line.points.iter().all(|p| is_place(*p)) {
        "has a point that is no place"
    } else if has_repeated_vertex(&line.points) {
        "visits a vertex twice"
    } else {
        return Ok(());
    };
    Err(Error::Data(format!("the contour {} m (feature {}) {fault}", line.elevation, line.feature)))
}
