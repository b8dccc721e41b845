//! Spot heights: removes those that are invalid, repeated, or on a contour.

use glam::{DVec2, DVec3};
use rstar::RTree;
use rstar::primitives::GeomWithData;

use super::points::{is_height, is_place, tidy};
use super::segments::{Runs, Segments};
use crate::base::error::{Finding, FindingKind, Report, Result};
use crate::base::parallel;
use crate::contour::Contour;
use crate::geometry::compare_points;
use crate::geometry::{Bounds, Segment};
use crate::geometry::{Meeting, meeting, point_distance};

/// Heights that differ by no more than this are equal, metres.
const SAME_HEIGHT: f64 = 1e-9;

/// Removes spot heights that are invalid, or that contradict a contour or another spot height at their place.
///
/// `contours` must be clean. Returns the spot heights sorted by x, y and height.
pub(super) fn clean(spots: Vec<DVec3>, contours: &[Contour], separation: f64) -> Result<Report<Vec<DVec3>>> {
    let mut findings = Vec::new();
    let (mut spots, mut bad): (Vec<DVec3>, Vec<DVec3>) = spots
        .into_iter()
        .map(|s| tidy(s.truncate()).extend(s.z + 0.0))
        .partition(|s| is_place(s.truncate()) && is_height(s.z));
    bad.sort_unstable_by(compare_spots);
    findings.extend(bad.into_iter().map(|s| {
        let message = "a spot height has no valid position or height; it was left out";
        let place = Some(s.truncate()).filter(|p| is_place(*p));
        Finding::new(FindingKind::NonFinitePoint, place, message).of_elevations([s.z])
    }));
    if spots.is_empty() {
        return Ok(Report { value: spots, findings });
    }
    spots.sort_unstable_by(compare_spots);
    spots.dedup();
    let spots = off_contours(spots, contours, separation, &mut findings)?;
    let spots = off_each_other(spots, separation, &mut findings);
    Ok(Report { value: spots, findings })
}

/// By x, y and height.
fn compare_spots(a: &DVec3, b: &DVec3) -> std::cmp::Ordering {
    compare_points(&a.truncate(), &b.truncate()).then(a.z.total_cmp(&b.z))
}

fn off_contours(
    spots: Vec<DVec3>,
    contours: &[Contour],
    separation: f64,
    findings: &mut Vec<Finding>,
) -> Result<Vec<DVec3>> {
    let segments = Segments::new(contours)?;
    let runs = segments.runs();
    let touched: Vec<Option<&Contour>> = parallel::map_each(&spots, |s| contour_at(s, &segments, &runs, separation));
    let mut kept = Vec::with_capacity(spots.len());
    for (spot, contour) in spots.into_iter().zip(touched) {
        match contour {
            None => kept.push(spot),
            Some(c) if (c.elevation - spot.z).abs() <= SAME_HEIGHT => (),
            Some(c) => {
                let message = format!(
                    "the spot height {} m lies on the contour {} m (feature {}); it was left out",
                    spot.z, c.elevation, c.feature
                );
                let finding = Finding::at(FindingKind::SpotOnLine, spot.truncate(), message);
                findings.push(finding.of_elevations([spot.z]).about(c.feature, c.elevation));
            }
        }
    }
    Ok(kept)
}

/// The contour on which a spot height lies. Of several, the one nearest in height; then the first.
fn contour_at<'a>(spot: &DVec3, segments: &Segments<'a>, runs: &Runs, separation: f64) -> Option<&'a Contour> {
    let p = spot.truncate();
    // Wider than necessary, so that the rounding of boxes has no effect.
    let reach = Bounds { min: p, max: p }.grown(2.0 * separation);
    let line = runs
        .near(&reach)
        .filter(|&i| {
            let run = &runs.runs[i as usize];
            let points = &segments.lines()[run.line as usize].points[run.from as usize..=run.to as usize];
            points.windows(2).any(|w| is_at(p, &Segment { a: w[0], b: w[1] }, separation))
        })
        .map(|i| runs.runs[i as usize].line)
        .min_by(|&i, &j| {
            let off = |line: u32| (segments.lines()[line as usize].elevation - spot.z).abs();
            off(i).total_cmp(&off(j)).then(i.cmp(&j))
        })?;
    Some(&segments.lines()[line as usize])
}

/// Whether a point lies exactly on a segment, or nearer to it than `separation`.
fn is_at(p: DVec2, s: &Segment, separation: f64) -> bool {
    if p == s.a || p == s.b || point_distance(p, s) < separation {
        return true;
    }
    s.bounds().meets(&Bounds { min: p, max: p }) && meeting(s, &Segment { a: p, b: s.b }) == Meeting::Overlap
}

/// Keeps the first of several spot heights at one place.
fn off_each_other(spots: Vec<DVec3>, separation: f64, findings: &mut Vec<Finding>) -> Vec<DVec3> {
    let places = (0usize..).zip(&spots).map(|(i, s)| GeomWithData::new([s.x, s.y], i));
    let tree = RTree::bulk_load(places.collect());
    let mut dropped = vec![false; spots.len()];
    for (i, spot) in spots.iter().enumerate() {
        if dropped[i] {
            continue;
        }
        let near = tree.locate_within_distance([spot.x, spot.y], separation * separation);
        let mut near: Vec<usize> = near.map(|n| n.data).filter(|&j| j > i && !dropped[j]).collect();
        near.retain(|&j| {
            let (p, q) = (spot.truncate(), spots[j].truncate());
            p == q || p.distance(q) < separation
        });
        near.sort_unstable();
        for j in near {
            dropped[j] = true;
            if (spots[j].z - spot.z).abs() > SAME_HEIGHT {
                let message = format!(
                    "the spot height {} m lies at the place of another of {} m; it was left out",
                    spots[j].z, spot.z
                );
                let finding = Finding::at(FindingKind::SpotOnLine, spots[j].truncate(), message);
                findings.push(finding.of_elevations([spots[j].z, spot.z]));
            }
        }
    }
    spots.into_iter().zip(dropped).filter(|(_, dropped)| !dropped).map(|(spot, _)| spot).collect()
}
