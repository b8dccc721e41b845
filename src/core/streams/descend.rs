//! A reach that never rises across a contour.
//!
//! A drawn stream may cross one contour three times or more, because the two lines were drawn apart from each other. The
//! detour is replaced by the piece of contour beside it, if that moves the stream by no more than the tolerance.
//! Otherwise the contours win: the detour is cut out, so that as little as possible of the reach is lost (`longest`).

use glam::DVec2;

use super::along::Along;
use super::longest::longest_descent;
use crate::contour::ContourMap;
use crate::geometry::{Segment, point_distance};
use crate::subdomains::{Band, Regions, line_at};
use crate::subdomains::{Course, Crossing, band_of};
use crate::tin::{NONE, Tin};

/// A way along a contour that replaces a detour is at most this many times as long as the detour and the tolerance.
const LONGEST: f64 = 4.0;

/// The map as streams see it.
pub(super) struct Ground<'a> {
    pub map: &'a ContourMap,
    pub tin: &'a Tin,
    pub regions: &'a Regions,
    /// The first point of each contour of the map in the triangulation, as [`line_starts`](crate::subdomains) gives it.
    pub starts: &'a [u32],
}

/// A vertex of a used piece. The height is known on contours and on water.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Vertex {
    /// Position relative to the origin of the triangulation.
    pub place: DVec2,
    pub height: Option<f64>,
    /// The sub-domain.
    pub region: u32,
}

/// A piece of a reach that never rises.
#[derive(Debug, Clone, Default)]
pub(super) struct Piece {
    pub vertices: Vec<Vertex>,
    /// The sub-domains of its first and its last vertex.
    pub regions: [u32; 2],
    /// Whether it begins and ends at the nodes of the reach.
    pub at_nodes: [bool; 2],
}

/// What was done about a detour.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Detour {
    /// The stream was moved along the contour by this distance at most, map units.
    Moved(f64),
    /// The stream was cut at a place on the contour of this level, if it is one. `length` is what was cut out, map units.
    Cut { place: DVec2, level: Option<f64>, length: f64 },
}

/// Divides a reach into pieces that never rise. `points` and the course run downstream.
pub(super) fn descending(
    ground: &Ground<'_>,
    points: &[DVec2],
    course: &Course,
    tolerance: f64,
) -> (Vec<Piece>, Vec<Detour>) {
    let along = Along::new(points);
    let mut pieces: Vec<Piece> = Vec::new();
    let mut detours = Vec::new();
    let mut piece = Piece::default();
    let mut last: Option<usize> = None;
    // A crossing has the level of its contour where `fits` says so, from the bands before and after it.
    let vertex = |k: usize, stretch: usize, fits: fn(f64, Band, Band) -> bool| {
        let Crossing { place, level, .. } = course.crossings[k];
        let band = |k: usize| band_of(ground.regions, course.stretches[k].region);
        let height = level.filter(|level| fits(*level, band(k), band(k + 1)));
        Vertex { place, height, region: course.stretches[stretch].region }
    };
    // A contour that ends in the open may be crossed inside one sub-domain, at the edge of its band. Heights beside it are
    // inside the band, so that level would be a step.
    let crossing = |k: usize| {
        vertex(k, k, |level, before, after| {
            (level < before.hi || level <= before.lo) && (level > after.lo || level >= after.hi)
        })
    };
    // A piece that was cut begins or ends on a contour, with its level only if water comes from above it, or goes on below
    // it.
    let start = |k: usize| vertex(k, k + 1, |level, _, after| level >= after.hi);
    let end = |k: usize| vertex(k, k, |level, before, _| level <= before.lo);
    let bands =
        course.stretches.iter().map(|s| (ground.regions.regions.get(s.region as usize).map(|r| r.band), s.to - s.from));
    for k in longest_descent(&bands.collect::<Vec<_>>()) {
        let stretch = course.stretches[k];
        let arc = last.filter(|last| last + 1 < k).map(|last| detour(ground, course, &along, (last, k), tolerance));
        detours.extend(arc.iter().filter_map(|found| found.1));
        match (last, arc) {
            (Some(last), None) => piece.vertices.push(crossing(last)),
            (Some(_), Some((Some(arc), _))) => piece.vertices.extend(arc),
            (last, _) => {
                piece.vertices.extend(last.map(end));
                let next = Piece { regions: [stretch.region; 2], at_nodes: [k == 0, false], ..Piece::default() };
                pieces.push(std::mem::replace(&mut piece, next));
                piece.vertices.extend(k.checked_sub(1).map(start));
                if last.is_none() && k > 0 {
                    detours.extend(left_out(course, 0..k, k - 1));
                }
            }
        }
        let height = ground.regions.regions[stretch.region as usize].water;
        piece.vertices.extend(along.inside(stretch).map(|place| Vertex { place, height, region: stretch.region }));
        piece.regions[1] = stretch.region;
        last = Some(k);
    }
    if let Some(last) = last {
        piece.at_nodes[1] = last + 1 == course.stretches.len();
        if !piece.at_nodes[1] {
            piece.vertices.push(end(last));
            detours.extend(left_out(course, last + 1..course.stretches.len(), last));
        }
    }
    pieces.push(piece);
    pieces.iter_mut().for_each(|piece| piece.vertices.dedup_by(|b, a| a.place == b.place));
    pieces.retain(|piece| piece.vertices.len() > 1);
    (pieces, detours)
}

/// The way along a contour that replaces the stretches between two that are kept, if there is one within the tolerance,
/// and what is to be reported.
fn detour(
    ground: &Ground<'_>,
    course: &Course,
    along: &Along<'_>,
    (last, next): (usize, usize),
    tolerance: f64,
) -> (Option<Vec<Vertex>>, Option<Detour>) {
    let skipped = &course.stretches[last + 1..next];
    if skipped.iter().any(|s| s.region == NONE) {
        return (None, left_out(course, last + 1..next, last));
    }
    let (out, back) = (course.crossings[last], course.crossings[next - 1]);
    let length: f64 = skipped.iter().map(|s| s.to - s.from).sum();
    let cut = Detour::Cut { place: out.place, level: out.level.or(back.level), length };
    if out.level != back.level {
        return (None, Some(cut));
    }
    let Some(between) = contour_between(ground, out.edge, back.edge, LONGEST * (tolerance + length)) else {
        return (None, Some(cut));
    };
    let way: Vec<DVec2> = [out.place].into_iter().chain(between).chain([back.place]).collect();
    let run = along.between(out.at, back.at);
    let by = farthest(&way, &run).max(farthest(&run, &way));
    if by > tolerance {
        return (None, Some(cut));
    }
    // Beside the contour, not on it: the stream stays in the sub-domain, and its heights between the levels.
    let region = course.stretches[last].region;
    let height = out.level.map(|level| band_of(ground.regions, region).strictly_inside(level));
    (Some(way.into_iter().map(|place| Vertex { place, height, region }).collect()), Some(Detour::Moved(by)))
}

/// The cut at a crossing where these stretches were left out. What lies outside the frame is no contradiction.
fn left_out(course: &Course, stretches: std::ops::Range<usize>, crossing: usize) -> Option<Detour> {
    let inside = course.stretches[stretches].iter().filter(|s| s.region != NONE);
    let length = inside.map(|s| s.to - s.from).reduce(|a, b| a + b)?;
    let Crossing { place, level, .. } = course.crossings[crossing];
    Some(Detour::Cut { place, level, length })
}

/// The vertices of a contour between two of its edges; `None` if the edges lie on different lines, or if the piece is
/// longer than `most`.
fn contour_between(ground: &Ground<'_>, from: [u32; 2], to: [u32; 2], most: f64) -> Option<Vec<DVec2>> {
    let Ground { map, tin, starts, .. } = ground;
    let number = |v: u32| -> Option<(u32, usize)> {
        let line = (v != NONE).then(|| line_at(tin, starts, v)).flatten()?;
        Some((line, (tin.source[v as usize] - starts[line as usize]) as usize))
    };
    let [(line, a0), (l1, a1), (l2, b0), (l3, b1)] =
        [number(from[0])?, number(from[1])?, number(to[0])?, number(to[1])?];
    if [l1, l2, l3].iter().any(|l| *l != line) {
        return None;
    }
    let contour = &map.contours[line as usize];
    let ring = contour.points.len() - usize::from(contour.is_closed());
    let mut same = [a0.min(a1), a0.max(a1)];
    let other = [b0.min(b1), b0.max(b1)];
    if same == other {
        return Some(Vec::new());
    }
    // The edge between the last and the first point of a ring begins at the last one.
    let first_of = |pair: [usize; 2]| if pair[1] - pair[0] > 1 { pair[1] } else { pair[0] };
    same[0] = first_of(same);
    let (i, j) = (same[0], first_of(other));
    let forward = (j + ring - i) % ring;
    let ways = if contour.is_closed() {
        [Some((i, forward, true)), Some((j, ring - forward, false))]
    } else if j > i {
        [Some((i, forward, true)), None]
    } else {
        [Some((j, i - j, false)), None]
    };
    let mut best: Option<(f64, Vec<DVec2>)> = None;
    for (start, count, is_forward) in ways.into_iter().flatten() {
        // Vertices after the first edge up to the one that begins the second.
        let mut points = Vec::new();
        let mut length = 0.0;
        for k in 1..=count {
            let p = contour.points[(start + k) % ring] - tin.origin;
            length += points.last().map_or(0.0, |q: &DVec2| q.distance(p));
            points.push(p);
            if length > most {
                break;
            }
        }
        if length <= most && best.as_ref().is_none_or(|(shortest, _)| length < *shortest) {
            if !is_forward {
                points.reverse();
            }
            best = Some((length, points));
        }
    }
    best.map(|(_, points)| points)
}

/// The greatest distance from one of the points to a line.
fn farthest(points: &[DVec2], line: &[DVec2]) -> f64 {
    let distance = |p: &DVec2| {
        let pairs = line.windows(2).map(|w| point_distance(*p, &Segment { a: w[0], b: w[1] }));
        pairs.fold(f64::INFINITY, f64::min)
    };
    points.iter().map(distance).fold(0.0, f64::max)
}
