//! Stray vertices: the line leaves its course, crosses another line or itself, and comes back.
//!
//! A digitising error, or a wrong digit, moves a vertex. The line then crosses whatever lies between. If such crossings
//! were cut like others, most cuts would open the correct line. The ground on its two sides would then become one. So
//! stray vertices are looked for first: a few vertices in a row without which the line meets nothing. A straight piece
//! from the vertex before to the vertex after replaces them.
//!
//! Leaving out vertices of either line may end a conflict. Of all choices, the one that changes the ground least is taken:
//! the area between the line and the straight piece is the smallest for each conflict that ends.

use std::cmp::Ordering;

use glam::DVec2;
use rayon::prelude::*;

use super::canonical::is_closed;
use super::contacts::{Contact, Placed, contact};
use super::removed::{Removed, Why};
use super::segments::{Runs, Segments};
use super::stretch::{MOST, Stretch, stretches};
use crate::base::error::{Finding, FindingKind};
use crate::base::parallel;
use crate::contour::Contour;
use crate::geometry::{Bounds, BoxTree, Meeting, OrientedBox, Segment, meeting, point_distance};

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
/// Stretches that start within this many segments of a line share one search for the segments around them.
const BLOCK: u32 = 8;

/// Lines without their stray vertices, in no particular order, and what was left out of them.
pub(super) struct Straightened {
    pub(super) lines: Vec<Contour>,
    /// The pieces left out, each from the vertex before to the vertex after.
    pub(super) removed: Vec<Removed>,
    pub(super) findings: Vec<Finding>,
    /// The places where lines have changed.
    pub(super) changed: Vec<Bounds>,
}

/// Segments in conflict with each segment.
struct Opponents {
    /// Where the opponents of each segment start, and at the end the number of all.
    first: Vec<u32>,
    opponents: Vec<u32>,
    /// Whether the two segments overlap.
    overlaps: Vec<bool>,
}

impl Opponents {
    fn new(segments: &Segments, conflicts: &[(u32, u32)]) -> Self {
        let mut both: Vec<(u32, u32)> = conflicts.iter().flat_map(|&(s, t)| [(s, t), (t, s)]).collect();
        both.sort_unstable();
        let mut first = vec![0; segments.len() + 1];
        both.iter().for_each(|pair| first[pair.0 as usize + 1] += 1);
        (1..first.len()).for_each(|s| first[s] += first[s - 1]);
        let is_overlap = |&(s, t): &(u32, u32)| meeting(&segments.get(s), &segments.get(t)) == Meeting::Overlap;
        let overlaps = parallel::map_each(&both, is_overlap);
        Self { first, opponents: both.into_iter().map(|pair| pair.1).collect(), overlaps }
    }

    /// The segments in conflict with one, each with whether it overlaps that one.
    fn of(&self, s: u32) -> impl Iterator<Item = (u32, bool)> {
        let range = self.first[s as usize] as usize..self.first[s as usize + 1] as usize;
        self.opponents[range.clone()].iter().copied().zip(self.overlaps[range].iter().copied())
    }

    /// The segments that are in a conflict.
    fn segments(&self) -> Vec<u32> {
        (0..self.first.len() as u32 - 1).filter(|&s| self.first[s as usize] < self.first[s as usize + 1]).collect()
    }
}

/// A stretch that may be left out.
struct Choice {
    stretch: Stretch,
    /// Number of conflicts that its segments are in.
    ended: f64,
    /// The segments that the straight piece in its place meets.
    met: Vec<u32>,
}

impl Choice {
    fn new(stretch: Stretch, opponents: &Opponents, segments: &Segments, met: Vec<u32>) -> Self {
        let is_own = |t: u32| stretch.ids(segments).any(|s| s == t);
        // A conflict between two of them is counted from both.
        let share = |(t, _)| if is_own(t) { 0.5 } else { 1.0 };
        let ended = stretch.ids(segments).flat_map(|s| opponents.of(s)).map(share).sum();
        Self { stretch, ended, met }
    }

    /// The ground that changes sides, for each conflict that ends. Then the one that ends more conflicts comes first.
    fn compare(&self, other: &Self) -> Ordering {
        let (a, b) = (&self.stretch, &other.stretch);
        let place = |s: &Stretch| (s.count, s.line, s.from);
        (a.swept / self.ended)
            .total_cmp(&(b.swept / other.ended))
            .then(other.ended.total_cmp(&self.ended))
            .then(place(a).cmp(&place(b)))
    }
}

/// Leaves out vertices if conflicts end without them; `None` if there are no such vertices. `changed` are the places that the
/// round before has changed: only those around them are looked at again.
///
/// Long because each stretch that is left out changes which others may be.
pub(super) fn leave_out(
    segments: &Segments,
    conflicts: &[(u32, u32)],
    changed: Option<&[Bounds]>,
    separation: f64,
) -> Option<Straightened> {
    if conflicts.is_empty() || conflicts.len() > FEW.max((SHARE * segments.len() as f64) as usize) {
        return None;
    }
    let opponents = Opponents::new(segments, conflicts);
    let mut rest = choices(segments, &opponents, changed, separation);
    let mut gone = vec![false; segments.len()];
    let mut left: Vec<u32> = segments.lines().iter().map(|line| vertex_count(&line.points) as u32).collect();
    let mut taken: Vec<(Stretch, Finding)> = Vec::new();
    let mut pass = 0;
    while pass <= PASSES {
        let before = taken.len();
        rest.retain(|Choice { stretch, met, .. }| {
            let ids = || stretch.ids(segments);
            let stray = stretch.count - 1;
            let left = &mut left[stretch.line as usize];
            let pairs = || ids().flat_map(|s| opponents.of(s).map(move |(t, overlaps)| (s, t, overlaps)));
            let pairs = || pairs().filter(|pair| !gone[pair.1 as usize]);
            if pairs().next().is_none()
                || ids().any(|s| gone[s as usize])
                || (*left as usize) < FEWEST_LEFT * stray as usize
                || pairs().any(|pair| pair.2)
            {
                return false;
            }
            let met = || met.iter().filter(|s| !gone[**s as usize]);
            let is_better = || {
                let frees = pairs().any(|pair| met().all(|s| *s != pair.1));
                frees && met().count() <= pairs().count() && stretch.detour >= SHARP
            };
            if met().next().is_some() && (pass < PASSES || !is_better()) {
                return true;
            }
            let pairs: Vec<(u32, u32)> = pairs().map(|(s, t, _)| (s, t)).collect();
            ids().for_each(|s| gone[s as usize] = true);
            *left -= stray;
            taken.push((*stretch, finding(stretch, segments, &pairs, separation)));
            false
        });
        pass = if taken.len() == before { PASSES.max(pass + 1) } else { pass + 1 };
    }
    if taken.is_empty() {
        return None;
    }
    taken.sort_by_key(|(stretch, _)| (stretch.line, stretch.from));
    let removed = |(stretch, _): &(Stretch, Finding)| {
        Removed::new(&segments.lines()[stretch.line as usize], stretch.way(segments), Why::Strays)
    };
    let removed: Vec<Removed> = taken.iter().map(removed).collect();
    Some(Straightened {
        changed: removed.iter().map(|removed| Bounds::around(&removed.way)).collect(),
        removed,
        lines: without(segments.lines(), &taken),
        findings: taken.into_iter().map(|(_, finding)| finding).collect(),
    })
}

fn vertex_count(points: &[DVec2]) -> usize {
    points.len() - usize::from(is_closed(points))
}

/// The stretches that may be left out, the one that changes the ground least first.
fn choices(segments: &Segments, opponents: &Opponents, changed: Option<&[Bounds]>, separation: f64) -> Vec<Choice> {
    let may_go = |stretch: &Stretch| {
        let points = &segments.lines()[stretch.line as usize].points;
        vertex_count(points) >= FEWEST_LEFT * (stretch.count as usize - 1)
    };
    let mut all = stretches(segments, &opponents.segments());
    all.retain(may_go);
    let runs = segments.runs();
    let blocks: Vec<&[Stretch]> = all.chunk_by(|a, b| (a.line, a.from / BLOCK) == (b.line, b.from / BLOCK)).collect();
    let changed = changed
        .map(|boxes| BoxTree::new(&boxes.iter().map(|b| OrientedBox::upright(b.min, b.max)).collect::<Vec<_>>()));
    let mut all = parallel::flat_map_each(&blocks, |block| {
        let reach = reach(block, segments, separation);
        // What was no choice before is none now if nothing around it has changed.
        let has_changed = |tree: &BoxTree| tree.near(OrientedBox::upright(reach.min, reach.max)).next().is_some();
        if !changed.as_ref().is_none_or(has_changed) {
            return Vec::new();
        }
        let near = Near::new(&reach, segments, &runs);
        let choice = |stretch: &Stretch| {
            let met = near.met(stretch, segments, separation);
            Choice::new(*stretch, opponents, segments, met)
        };
        block.iter().map(choice).collect()
    });
    all.par_sort_unstable_by(Choice::compare);
    all
}

/// The box around some stretches of one line, in their order, with a margin.
fn reach(stretches: &[Stretch], segments: &Segments, separation: f64) -> Bounds {
    let first = stretches[0];
    let points = &segments.lines()[first.line as usize].points;
    // The line reaches no further than the longest stretch after the last start.
    let last = stretches[stretches.len() - 1].from - first.from + MOST as u32 + 1;
    let places = (0..=last as usize).filter_map(|k| points.get(first.index(points, k)).copied());
    Bounds::around(&places.collect::<Vec<_>>()).grown(2.0 * separation)
}

/// A segment near some stretches.
struct Neighbour {
    line: u32,
    number: u32,
    segment: Segment,
    bounds: Bounds,
}

/// All segments near some stretches of one line.
struct Near(Vec<Neighbour>);

impl Near {
    fn new(reach: &Bounds, segments: &Segments, runs: &Runs) -> Self {
        let mut near: Vec<Neighbour> = Vec::new();
        for run in runs.near(reach).map(|run| &runs.runs[run as usize]) {
            let line = &segments.lines()[run.line as usize].points;
            near.extend((run.from..run.to).filter_map(|number| {
                let segment = Segment { a: line[number as usize], b: line[number as usize + 1] };
                let bounds = segment.bounds();
                bounds.meets(reach).then_some(Neighbour { line: run.line, number, segment, bounds })
            }));
        }
        Self(near)
    }

    /// The segments that the straight piece in place of a stretch meets.
    fn met(&self, stretch: &Stretch, segments: &Segments, separation: f64) -> Vec<u32> {
        let contour = &segments.lines()[stretch.line as usize];
        let vertex = |k: usize| contour.points[stretch.index(&contour.points, k)];
        let segment = Segment { a: vertex(0), b: vertex(stretch.count as usize) };
        let straight = Placed { segment, contour, line: stretch.line, number: 0 };
        let is_apart = |other: &Neighbour| {
            let piece = other.segment;
            if other.line == stretch.line {
                let has_end = |p: DVec2| p == piece.a || p == piece.b;
                match meeting(&segment, &piece) {
                    Meeting::Apart => true,
                    Meeting::Touch => has_end(segment.a) || has_end(segment.b),
                    Meeting::Cross | Meeting::Overlap => false,
                }
            } else {
                let contour = &segments.lines()[other.line as usize];
                let placed = Placed { segment: piece, contour, line: other.line, number: other.number as usize };
                matches!(contact(&straight, &placed, separation), Contact::None | Contact::Allowed)
            }
        };
        let reach = segment.bounds().grown(2.0 * separation);
        let met = self.0.iter().filter(|other| reach.meets(&other.bounds)).filter_map(|other| {
            let id = segments.start(other.line) + other.number;
            let is_own = || stretch.ids(segments).any(|own| own == id);
            (!is_own() && !is_apart(other)).then_some(id)
        });
        met.collect()
    }
}

/// The lines without the stray vertices of the stretches.
fn without(lines: &[Contour], taken: &[(Stretch, Finding)]) -> Vec<Contour> {
    let mut lines = lines.to_vec();
    for of_line in taken.chunk_by(|a, b| a.0.line == b.0.line) {
        let points = &mut lines[of_line[0].0.line as usize].points;
        let mut stays = vec![true; points.len()];
        for (stretch, _) in of_line {
            (1..stretch.count as usize).for_each(|k| stays[stretch.index(points, k)] = false);
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
    let straight = Segment { a: way[0], b: way[stretch.count as usize] };
    let inside = way[1..stretch.count as usize].iter().map(|&p| (point_distance(p, &straight), p));
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
