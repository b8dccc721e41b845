//! Stray vertices: the line leaves its course, crosses another line or itself, and comes back.
//!
//! A digitising error, or a wrong digit, moves a vertex. The line then crosses whatever lies between. If such crossings
//! were cut like others, most cuts would open the correct line. The ground on its two sides would then become one. So
//! stray vertices are looked for first: a few vertices in a row without which the line meets nothing. A straight piece
//! from the vertex before to the vertex after replaces them.
//!
//! Leaving out vertices of either line may end a conflict. The fewest vertices are left out. Of choices with equally
//! few, the one with the longest detour is taken.

use std::collections::HashMap;

use glam::DVec2;

use super::canonical::is_closed;
use super::contacts::{Contact, Placed, contact};
use super::removed::{Removed, Why};
use super::segments::{Runs, Segments};
use crate::base::error::{Finding, FindingKind};
use crate::contour::Contour;
use crate::geometry::Segment;
use crate::geometry::{Meeting, meeting, point_distance};

/// Largest number of stray vertices in a row.
const MOST: usize = 4;
/// Passes over the stretches whose straight piece meets nothing. What blocks one stretch may be removed with the next.
const PASSES: usize = 3;
/// Least detour in the last passes, for stray vertices that block each other. There the straight piece may meet other
/// segments, but no more than the stretch did. At a single vertex this detour means that the line turns back to within
/// 60 degrees.
const SHARP: f64 = 2.0;
/// A stretch is left as it is if its line has fewer vertices than this for each stray vertex.
const FEWEST_LEFT: usize = 5;
/// Up to this many pairs of segments in conflict are always examined.
const FEW: usize = 100_000;
/// More pairs are examined up to this share of all segments. Lines with more conflicts do not cross by mistake.
const SHARE: f64 = 0.1;

/// At least two successive segments of a line. The vertices between them may be stray.
#[derive(Debug, Clone, Copy)]
struct Stretch {
    line: u32,
    /// Number of the first segment on the line.
    from: usize,
    /// Number of segments. On a ring they may run across its start.
    count: usize,
    /// Length of the way along the segments, divided by the length of the straight way.
    detour: f64,
}

impl Stretch {
    /// The stretch's vertices, with the one before and the one after those that may be stray.
    fn way(&self, segments: &Segments) -> Vec<DVec2> {
        let points = &segments.lines()[self.line as usize].points;
        (0..=self.count).map(|k| points[wrapped(points, self.from + k)]).collect()
    }

    /// Numbers of the segments among all segments.
    fn ids(&self, segments: &Segments) -> impl Iterator<Item = u32> {
        let start = segments.start(self.line);
        let count = (segments.start(self.line + 1) - start) as usize;
        (self.from..self.from + self.count).map(move |k| start + (k % count) as u32)
    }
}

/// The index of a vertex, which continues at the start of a ring.
fn wrapped(points: &[DVec2], k: usize) -> usize {
    if is_closed(points) { k % (points.len() - 1) } else { k }
}

/// Lines without their stray vertices, in no particular order, and what was left out of them.
pub(super) struct Straightened {
    pub(super) lines: Vec<Contour>,
    /// The pieces left out, each from the vertex before to the vertex after.
    pub(super) removed: Vec<Removed>,
    pub(super) findings: Vec<Finding>,
}

/// Leaves out vertices if conflicts end without them; `None` if there are no such vertices.
///
/// Long because each stretch that is left out changes which others may be.
pub(super) fn leave_out(segments: &Segments, conflicts: &[(u32, u32)], separation: f64) -> Option<Straightened> {
    if conflicts.is_empty() || conflicts.len() > FEW.max((SHARE * segments.len() as f64) as usize) {
        return None;
    }
    let mut conflicts: Vec<(u32, u32)> = conflicts.iter().flat_map(|&(s, t)| [(s, t), (t, s)]).collect();
    conflicts.sort_unstable();
    let mut in_conflict: Vec<u32> = conflicts.iter().map(|pair| pair.0).collect();
    in_conflict.dedup();
    let runs = segments.runs();
    let mut gone = vec![false; segments.len()];
    let mut vertices: HashMap<u32, usize> = HashMap::new();
    let mut taken: Vec<(Stretch, Finding)> = Vec::new();
    let mut rest = stretches(segments, &in_conflict);
    let mut pass = 0;
    while pass <= PASSES {
        let before = taken.len();
        rest.retain(|stretch| {
            let ids: Vec<u32> = stretch.ids(segments).collect();
            let opponents = |s: u32| {
                let from = conflicts.partition_point(|pair| pair.0 < s);
                conflicts[from..].iter().take_while(move |pair| pair.0 == s)
            };
            let pairs: Vec<(u32, u32)> =
                (ids.iter().flat_map(|&s| opponents(s)).copied()).filter(|pair| !gone[pair.1 as usize]).collect();
            let left = vertices.entry(stretch.line).or_insert_with(|| {
                let points = &segments.lines()[stretch.line as usize].points;
                points.len() - usize::from(is_closed(points))
            });
            let overlaps = |&(s, t): &(u32, u32)| meeting(&segments.get(s), &segments.get(t)) == Meeting::Overlap;
            if pairs.is_empty()
                || ids.iter().any(|&s| gone[s as usize])
                || *left < FEWEST_LEFT * (stretch.count - 1)
                || pairs.iter().any(overlaps)
            {
                return false;
            }
            let met = met(stretch, &ids, segments, &runs, &gone, separation);
            let is_better = || {
                let frees = pairs.iter().any(|pair| !met.contains(&pair.1));
                frees && met.len() <= pairs.len() && stretch.detour >= SHARP
            };
            if !met.is_empty() && (pass < PASSES || !is_better()) {
                return true;
            }
            ids.iter().for_each(|&s| gone[s as usize] = true);
            *left -= stretch.count - 1;
            taken.push((*stretch, finding(stretch, segments, &pairs, separation)));
            false
        });
        pass = if taken.len() == before { PASSES.max(pass + 1) } else { pass + 1 };
    }
    if taken.is_empty() {
        return None;
    }
    taken.sort_by_key(|(stretch, _)| (stretch.line, stretch.from));
    let removed = taken
        .iter()
        .map(|(stretch, _)| Removed::new(&segments.lines()[stretch.line as usize], stretch.way(segments), Why::Strays));
    Some(Straightened {
        removed: removed.collect(),
        lines: without(segments.lines(), &taken),
        findings: taken.into_iter().map(|(_, finding)| finding).collect(),
    })
}

/// The stretches that contain the segments, those with the fewest vertices first.
fn stretches(segments: &Segments, of: &[u32]) -> Vec<Stretch> {
    let mut all = Vec::new();
    for &s in of {
        let line = segments.line_number(s);
        let points = &segments.lines()[line].points;
        let (ring, sides) = (is_closed(points), points.len() - 1);
        let number = (s - segments.start(line as u32)) as usize;
        for count in 2..=MOST + 1 {
            for back in 0..count {
                let from = match number.checked_sub(back) {
                    Some(from) if ring || from + count <= sides => from,
                    None if ring && back <= sides => number + sides - back,
                    _ => continue,
                };
                let vertex = |k: usize| points[wrapped(points, from + k)];
                let way: f64 = (0..count).map(|k| vertex(k).distance(vertex(k + 1))).sum();
                let detour = way / vertex(0).distance(vertex(count));
                all.push(Stretch { line: line as u32, from, count, detour });
            }
        }
    }
    let place = |s: &Stretch| (s.line, s.from);
    all.sort_by(|a, b| a.count.cmp(&b.count).then(b.detour.total_cmp(&a.detour)).then(place(a).cmp(&place(b))));
    all.dedup_by_key(|s| (s.line, s.from, s.count));
    all
}

/// The segments that the straight piece in place of a stretch meets.
fn met(stretch: &Stretch, ids: &[u32], segments: &Segments, runs: &Runs, gone: &[bool], separation: f64) -> Vec<u32> {
    let contour = &segments.lines()[stretch.line as usize];
    let vertex = |k: usize| contour.points[wrapped(&contour.points, stretch.from + k)];
    let segment = Segment { a: vertex(0), b: vertex(stretch.count) };
    let straight = Placed { segment, contour, line: stretch.line, number: 0 };
    let is_apart = |line: u32, number: usize| {
        let other = &segments.lines()[line as usize];
        let piece = Segment { a: other.points[number], b: other.points[number + 1] };
        if line == stretch.line {
            let has_end = |p: DVec2| p == piece.a || p == piece.b;
            match meeting(&segment, &piece) {
                Meeting::Apart => true,
                Meeting::Touch => has_end(segment.a) || has_end(segment.b),
                Meeting::Cross | Meeting::Overlap => false,
            }
        } else {
            let placed = Placed { segment: piece, contour: other, line, number };
            matches!(contact(&straight, &placed, separation), Contact::None | Contact::Allowed)
        }
    };
    let reach = segment.bounds().grown(2.0 * separation);
    let near = runs.near(&reach).map(|run| &runs.runs[run as usize]);
    let near = near.flat_map(|run| (run.from..run.to).map(|number| (run.line, number)));
    let met = near.filter_map(|(line, number)| {
        let id = segments.start(line) + number;
        let is_met = !gone[id as usize] && !ids.contains(&id) && !is_apart(line, number as usize);
        is_met.then_some(id)
    });
    met.collect()
}

/// The lines without the stray vertices of the stretches.
fn without(lines: &[Contour], taken: &[(Stretch, Finding)]) -> Vec<Contour> {
    let mut lines = lines.to_vec();
    for of_line in taken.chunk_by(|a, b| a.0.line == b.0.line) {
        let points = &mut lines[of_line[0].0.line as usize].points;
        let mut stays = vec![true; points.len()];
        for (stretch, _) in of_line {
            (1..stretch.count).for_each(|k| stays[wrapped(points, stretch.from + k)] = false);
        }
        let ring = is_closed(points);
        if ring {
            points.pop();
        }
        let mut stays = stays.into_iter();
        points.retain(|_| stays.next() == Some(true));
        if ring {
            points.push(points[0]);
        }
    }
    lines
}

/// The finding about a stretch, at its vertex furthest from the straight piece. `pairs` are its segments with those
/// that they meet.
fn finding(stretch: &Stretch, segments: &Segments, pairs: &[(u32, u32)], separation: f64) -> Finding {
    let Contour { elevation, feature, .. } = segments.lines()[stretch.line as usize];
    let other = segments.line_of(pairs[0].1);
    let meetings = || pairs.iter().map(|&(s, t)| meeting(&segments.get(s), &segments.get(t)));
    let how = if meetings().any(|m| m == Meeting::Cross) {
        "crosses".to_owned()
    } else if meetings().any(|m| m != Meeting::Apart) {
        "touches".to_owned()
    } else {
        format!("comes nearer than {separation} map units to")
    };
    let whom = if other.elevation == elevation && other.feature == feature {
        "itself".to_owned()
    } else {
        format!("the contour {} m (feature {})", other.elevation, other.feature)
    };
    let way = stretch.way(segments);
    let straight = Segment { a: way[0], b: way[stretch.count] };
    let inside = way[1..stretch.count].iter().map(|&p| (point_distance(p, &straight), p));
    let (off, place) = inside.fold((0.0, way[1]), |far, p| if p.0 > far.0 { p } else { far });
    let what = match stretch.count - 1 {
        1 => format!("a vertex of it, {off:.3} map units off its course, was left out"),
        n => format!("{n} vertices of it, up to {off:.3} map units off its course, were left out"),
    };
    let kind = if other.elevation == elevation { FindingKind::SelfCross } else { FindingKind::LevelsCross };
    let message = format!("the contour {elevation} m (feature {feature}) {how} {whom}; {what}");
    let first = Finding::at(kind, place, message).about(feature, elevation);
    pairs.iter().map(|pair| segments.line_of(pair.1)).fold(first, |f, line| f.about(line.feature, line.elevation))
}
