//! Vertices and lines far from all others, and coordinates in degrees.
//!
//! A wrong digit in a coordinate moves one vertex far out. A wrong zone, or degrees among metres, moves whole lines.
//! These lines are found by splitting the map at the widest gaps between its lines, along x and along y.

use std::collections::BTreeSet;

use glam::DVec2;
use rayon::prelude::*;

use super::shape::{Box2, Shape, median, steps};
use crate::base::error::{Finding, FindingKind};
use crate::base::parallel;
use crate::contour::{Contour, ContourMap};
use crate::crs::{Crs, CrsKind};

/// A vertex is far away if three conditions hold. First: each of its two segments is longer than this many median
/// segments of its line.
const JUMP_STEPS: f64 = 50.0;
/// Second: each is longer than this share of the map's diagonal.
const JUMP_OF_MAP: f64 = 0.05;
/// Third: its neighbours are nearer to each other than this share of the shorter of the two segments.
const JUMP_BACK: f64 = 0.1;

/// Lines are far away if their distance from all others is more than this many diagonals of those. Islands of one map
/// lie within a few of their own sizes; another zone is hundreds of kilometres away.
const FAR: f64 = 10.0;
/// The others must hold at least this share of the vertices.
const MOST: f64 = 0.5;
/// Largest number of gaps at which a map is split.
const GAPS: usize = 64;
/// Coordinates are taken for degrees if they fit in ±180 and ±90, and if the median distance between vertices is below
/// this, map units. Contours in metres have a vertex every one to ten metres.
const DEGREE_SPACING: f64 = 0.02;

/// Finds all of these faults.
pub(super) fn find(map: &ContourMap, shape: &Shape) -> Vec<Finding> {
    let kind = map.crs.as_ref().and_then(Crs::kind);
    let all = shape.boxes.iter().fold(Box2::EMPTY, |b, other| b.with(other));
    if kind != Some(CrsKind::Geographic) && all.fits_degrees() && shape.spacing > 0.0 && shape.spacing < DEGREE_SPACING
    {
        let message = format!(
            "all coordinates lie within 180 and 90, and the median distance between vertices is {:.2e}: they look \
             like degrees, and the coordinate reference system does not say so",
            shape.spacing
        );
        return vec![Finding::general(FindingKind::LooksLikeDegrees, message)];
    }
    if kind == Some(CrsKind::Geographic) && !all.fits_degrees() && shape.spacing > DEGREE_SPACING {
        let message = "the coordinate reference system is in degrees, and coordinates lie beyond 180 and 90: they look \
                       like projected coordinates";
        return vec![Finding::general(FindingKind::LooksLikeDegrees, message)];
    }
    let slips = slips(map, middle_diagonal(map));
    let mut boxes = shape.boxes.clone();
    for slip in &slips {
        boxes[slip.line] = slip.box_without(&map.contours[slip.line]);
    }
    let mut findings: Vec<Finding> = slips.iter().flat_map(|slip| slip.findings(&map.contours[slip.line])).collect();
    findings.extend(far_lines(map, &boxes, kind, shape.spacing));
    findings
}

/// The diagonal of the box around the middle vertices of the lines. Single wrong vertices do not enlarge it.
fn middle_diagonal(map: &ContourMap) -> f64 {
    Box2::of(map.contours.iter().filter_map(|c| c.points.get(c.points.len() / 2).copied())).diagonal()
}

/// The vertices of a line that lie far away.
struct Slip {
    line: usize,
    vertices: Vec<usize>,
}

impl Slip {
    /// The box of the other vertices.
    fn box_without(&self, line: &Contour) -> Box2 {
        let last = line.points.len() - 1;
        let is_out = |i: usize| {
            let i = if i == last && line.is_closed() { 0 } else { i };
            self.vertices.binary_search(&i).is_ok()
        };
        Box2::of((0usize..).zip(&line.points).filter(|(i, _)| !is_out(*i)).map(|(_, p)| *p))
    }

    fn findings(&self, line: &Contour) -> impl Iterator<Item = Finding> {
        self.vertices.iter().map(|&i| {
            let [before, p, after] = with_neighbours(line, i);
            let away = p.distance(before).min(p.distance(after));
            let message = format!(
                "a vertex of the contour {} m (feature {}) lies {away:.3} map units away from those before and after it: \
                 an error in a coordinate",
                line.elevation, line.feature
            );
            Finding::at(FindingKind::FarAway, p, message).about(line.feature, line.elevation)
        })
    }
}

/// A vertex between the vertex before it and the one after it.
fn with_neighbours(line: &Contour, i: usize) -> [DVec2; 3] {
    let n = line.points.len();
    // The first point of a ring is its last point again.
    let before = if i == 0 { n - 2 } else { i - 1 };
    [line.points[before], line.points[i], line.points[i + 1]]
}

fn slips(map: &ContourMap, diagonal: f64) -> Vec<Slip> {
    let of_line = |(line, contour): (usize, &Contour)| {
        let n = contour.points.len();
        let from = usize::from(!contour.is_closed());
        let mut vertices: Vec<usize> = (from..n.saturating_sub(1))
            .filter(|&i| {
                let [before, p, after] = with_neighbours(contour, i);
                let away = p.distance(before).min(p.distance(after));
                away > JUMP_OF_MAP * diagonal && before.distance(after) < JUMP_BACK * away
            })
            .collect();
        // With fewer vertices left, a median length means nothing.
        if vertices.is_empty() || n < vertices.len() + 4 {
            return None;
        }
        let usual = median(&mut steps(contour).collect::<Vec<f64>>());
        vertices.retain(|&i| {
            let [before, p, after] = with_neighbours(contour, i);
            p.distance(before).min(p.distance(after)) > JUMP_STEPS * usual
        });
        (!vertices.is_empty()).then_some(Slip { line, vertices })
    };
    parallel::flat_map(map.contours.len(), |i| of_line((i, &map.contours[i])))
}

/// The lines on the lighter side of a gap, and the width of the gap.
struct SplitOff {
    lines: Vec<u32>,
    gap: f64,
}

/// One finding per group of lines that is far from the others.
fn far_lines(map: &ContourMap, boxes: &[Box2], kind: Option<CrsKind>, spacing: f64) -> Vec<Finding> {
    let weight = |lines: &[u32]| lines.iter().map(|&i| map.contours[i as usize].points.len()).sum::<usize>();
    let mut body: Vec<u32> = (0u32..).zip(boxes).filter(|(_, b)| !b.is_empty()).map(|(i, _)| i).collect();
    let all = weight(&body) as f64;
    let mut parts: Vec<SplitOff> = Vec::new();
    // The last split whose gap was wide enough: the number of parts that were split off by then, and the box of the
    // rest.
    let mut found: Option<(usize, Box2)> = None;
    while parts.len() < GAPS {
        let Some((gap, low, high)) = widest_gap(&body, boxes) else { break };
        let (heavy, light) = if weight(&low) >= weight(&high) { (low, high) } else { (high, low) };
        if (weight(&heavy) as f64) < MOST * all {
            break;
        }
        parts.push(SplitOff { lines: light, gap });
        body = heavy;
        let size = box_of(&body, boxes);
        if gap > FAR * size.diagonal() {
            found = Some((parts.len(), size));
        }
    }
    let Some((count, body)) = found else { return Vec::new() };
    parts.truncate(count);
    parts.retain(|part| part.gap > FAR * body.diagonal());
    let in_degrees = kind != Some(CrsKind::Geographic) && body.fits_degrees() && spacing < DEGREE_SPACING;
    let mut findings: Vec<Finding> =
        parts.iter().map(|part| finding(map, part, &box_of(&part.lines, boxes), &body, kind)).collect();
    if in_degrees && parts.iter().any(|part| !box_of(&part.lines, boxes).fits_degrees()) {
        let message = "most lines look like degrees, and others do not: there are several coordinate reference systems";
        findings = vec![Finding::general(FindingKind::LooksLikeDegrees, message)];
    }
    findings
}

fn box_of(lines: &[u32], boxes: &[Box2]) -> Box2 {
    lines.iter().fold(Box2::EMPTY, |b, &i| b.with(&boxes[i as usize]))
}

/// The widest gap along x or y between lines, and the lines on its two sides.
fn widest_gap(lines: &[u32], boxes: &[Box2]) -> Option<(f64, Vec<u32>, Vec<u32>)> {
    let mut best: Option<(f64, usize, f64)> = None;
    for axis in 0..2 {
        let mut spans: Vec<[f64; 2]> =
            lines.iter().map(|&i| &boxes[i as usize]).map(|b| [b.min[axis], b.max[axis]]).collect();
        spans.par_sort_unstable_by(|a, b| a[0].total_cmp(&b[0]));
        let mut reach = spans.first()?[1];
        for span in &spans {
            let gap = span[0] - reach;
            if gap > best.map_or(0.0, |b| b.0) {
                best = Some((gap, axis, span[0]));
            }
            reach = reach.max(span[1]);
        }
    }
    let (gap, axis, from) = best?;
    let (high, low) = lines.iter().partition(|&&i| boxes[i as usize].min[axis] >= from);
    Some((gap, low, high))
}

fn finding(map: &ContourMap, part: &SplitOff, around: &Box2, body: &Box2, kind: Option<CrsKind>) -> Finding {
    let line = |i: &u32| &map.contours[*i as usize];
    let looks_so = kind != Some(CrsKind::Geographic) && around.fits_degrees() && !body.fits_degrees();
    let (code, why) = if looks_so {
        (FindingKind::LooksLikeDegrees, "their coordinates look like degrees")
    } else {
        (FindingKind::FarAway, "they are in another zone, or their coordinates have an error")
    };
    let files: BTreeSet<u32> = part.lines.iter().filter_map(|i| line(i).feature.file()).collect();
    let of_file =
        if let [file] = *files.iter().collect::<Vec<_>>() { format!(" of file {file}") } else { String::new() };
    let message = format!(
        "lines ({}{of_file}) lie {:.3} map units away from all others, which lie within {:.3} map units: {why}",
        part.lines.len(),
        part.gap,
        body.diagonal()
    );
    let first = part.lines.iter().flat_map(|i| &line(i).points).copied().filter(|p| p.is_finite());
    let place = first.min_by(|p, q| p.x.total_cmp(&q.x).then(p.y.total_cmp(&q.y)));
    let mut finding = Finding::new(code, place, message);
    finding.features = part.lines.iter().map(|i| line(i).feature).collect();
    finding.features.sort_unstable();
    finding.features.dedup();
    finding.elevations = part.lines.iter().map(|i| line(i).elevation).filter(|z| z.is_finite()).collect();
    finding.elevations.sort_unstable_by(f64::total_cmp);
    finding.elevations.dedup();
    finding
}
