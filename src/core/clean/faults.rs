//! Findings about lines that meet: one finding per place, even if many pairs of segments meet there.
//!
//! Two lines with a common vertex have four pairs of segments that meet. Two lines that overlap have hundreds. Pairs of
//! the same two lines are one fault if they share a place, or a stretch from place to place. Each clean crossing is a
//! fault of its own.

use std::collections::BTreeMap;

use glam::DVec2;
use rayon::prelude::*;

use super::segments::Segments;
use crate::base::error::{Finding, FindingKind};
use crate::base::parallel;
use crate::base::union_find::UnionFind;
use crate::contour::Contour;
use crate::geometry::Segment;
use crate::geometry::{self, Meeting, meeting, point_distance};

/// Up to this many pairs, or as many as there are segments, all pairs are reported. If there are more, only those that
/// led to a cut are.
const REPORTED_PAIRS: usize = 1_000_000;
/// Upper bound of the rounding of coordinates, as a share of their size.
const ROUNDING: f64 = 1e-15;
/// Lines overlap if they stay near each other for this many times the distance that counts as near.
const ALONG: f64 = 100.0;

/// Two segments that meet.
struct Pair {
    segments: (u32, u32),
    meeting: Meeting,
    /// The ends of their common part. They are equal if it is a point.
    common: [DVec2; 2],
    /// Whether they cross, and no end of one is near the other.
    is_clean_cross: bool,
}

/// Findings about the conflicts. Each pair in `cuts` is a segment that is removed, and a segment because of which it is
/// removed. Each conflict has one of its segments in a cut. Conflicts and cuts are sorted.
pub(super) fn findings(
    segments: &Segments,
    conflicts: Vec<(u32, u32)>,
    cuts: &[(u32, u32)],
    separation: f64,
) -> Vec<Finding> {
    let mut reported = conflicts;
    if reported.len() > REPORTED_PAIRS.max(segments.len()) {
        reported = cuts.iter().map(|&(s, t)| (s.min(t), s.max(t))).collect();
        reported.par_sort_unstable();
        reported.dedup();
    }
    let pairs: Vec<Pair> = parallel::map_each(&reported, |&(s, t)| pair(segments, s, t, separation));
    let groups = groups(segments, &pairs, separation);
    parallel::map_each(&groups, |group| finding(segments, &pairs, group, cuts, separation))
}

/// Two places within this distance are one.
fn tolerance(p: DVec2, separation: f64) -> f64 {
    2.0 * separation + ROUNDING * p.abs().max_element()
}

fn pair(segments: &Segments, i: u32, j: u32, separation: f64) -> Pair {
    let (s, t) = (segments.get(i), segments.get(j));
    let near = |p: &DVec2, of: &Segment| point_distance(*p, of) <= tolerance(*p, separation);
    let of_s = [s.a, s.b].into_iter().filter(|p| near(p, &t));
    let of_t = [t.a, t.b].into_iter().filter(|p| near(p, &s));
    let ends: Vec<DVec2> = of_s.chain(of_t).collect();
    let meeting = meeting(&s, &t);
    let place = || geometry::place(&s, &t);
    let mut common = ends.first().map_or_else(|| [place(); 2], |&p| [p; 2]);
    for (k, &p) in ends.iter().enumerate() {
        for &q in &ends[k + 1..] {
            if p.distance(q) > common[0].distance(common[1]) {
                common = [p, q];
            }
        }
    }
    if common[0].distance(common[1]) <= 2.0 * tolerance(common[0], separation) {
        // A point: the place where they touch, if they touch exactly.
        common = [if meeting == Meeting::Apart { common[0] } else { place() }; 2];
    }
    Pair { segments: (i, j), meeting, common, is_clean_cross: ends.is_empty() && meeting == Meeting::Cross }
}

/// Groups of pairs that are one fault, as numbers of the pairs, in the order of their first pairs.
fn groups(segments: &Segments, pairs: &[Pair], separation: f64) -> Vec<Vec<usize>> {
    let mut sets = UnionFind::new(pairs.len());
    for (i, pair) in pairs.iter().enumerate().filter(|(_, pair)| !pair.is_clean_cross) {
        let (s, t) = pair.segments;
        for s in with_neighbours(segments, s) {
            for t in with_neighbours(segments, t) {
                let Ok(j) = pairs.binary_search_by_key(&(s.min(t), s.max(t)), |p| p.segments) else { continue };
                let other = &pairs[j];
                if j == i || other.is_clean_cross || !share_a_place(pair, other, separation) {
                    continue;
                }
                sets.unite(i, j);
            }
        }
    }
    let mut groups: BTreeMap<usize, Vec<usize>> = BTreeMap::new();
    for i in 0..pairs.len() {
        groups.entry(sets.root(i)).or_default().push(i);
    }
    groups.into_values().collect()
}

/// A segment with the segments before and after it on its line.
fn with_neighbours(segments: &Segments, s: u32) -> impl Iterator<Item = u32> {
    let line = segments.line_number(s);
    let (first, last) = (segments.start(line as u32), segments.start(line as u32 + 1) - 1);
    let is_closed = segments.lines()[line].is_closed();
    let before = if s > first { Some(s - 1) } else { is_closed.then_some(last) };
    let after = if s < last { Some(s + 1) } else { is_closed.then_some(first) };
    before.into_iter().chain([s]).chain(after)
}

fn share_a_place(a: &Pair, b: &Pair, separation: f64) -> bool {
    let is_same = |p: &DVec2, q: &DVec2| p.distance(*q) <= 2.0 * tolerance(*p, separation);
    a.common.iter().any(|p| b.common.iter().any(|q| is_same(p, q)))
}

/// A line's share in a fault.
struct LineShare<'a> {
    line: &'a Contour,
    /// How many of its segments are removed, and their length.
    count: usize,
    length: f64,
}

fn finding(segments: &Segments, pairs: &[Pair], group: &[usize], cuts: &[(u32, u32)], separation: f64) -> Finding {
    let of_group = || group.iter().map(|&i| &pairs[i]);
    let first = &pairs[group[0]];
    let lines = [segments.line_number(first.segments.0), segments.line_number(first.segments.1)];
    let mut involved: Vec<u32> = of_group().flat_map(|p| [p.segments.0, p.segments.1]).collect();
    involved.sort_unstable();
    involved.dedup();
    let side = |line: usize| {
        let goes = |s: &&u32| segments.line_number(**s) == line && cuts.binary_search_by_key(*s, |c| c.0).is_ok();
        let lengths = involved.iter().filter(goes).map(|&s| length(segments.get(s)));
        let (count, length) = lengths.fold((0, 0.0), |(n, sum), length| (n + 1, sum + length));
        LineShare { line: &segments.lines()[line], count, length }
    };
    let (mut one, mut other) = (side(lines[0]), side(lines[1]));
    if lines[0] == lines[1] {
        other = LineShare { line: other.line, count: 0, length: 0.0 };
    } else if other.length > one.length {
        (one, other) = (other, one);
    }

    let stretch: f64 = of_group().map(|p| p.common[0].distance(p.common[1])).sum();
    let overlaps = of_group().any(|p| p.meeting == Meeting::Overlap);
    let is_along = overlaps || stretch > ALONG * tolerance(first.common[0], separation);
    let (elevation, feature) = (one.line.elevation, one.line.feature);
    let whom = if other.line.elevation == elevation && other.line.feature == feature {
        "itself".to_owned()
    } else {
        format!("the contour {} m (feature {})", other.line.elevation, other.line.feature)
    };
    let (kind, place, how) = if is_along {
        let [from, to] = ends(segments, of_group());
        let along =
            format!("runs along {whom} for {stretch:.3} map units, ending {} of where it starts", way(to - from));
        (FindingKind::OverlappingLines, from, along)
    } else {
        let same = other.line.elevation == elevation;
        let kind = if same { FindingKind::SelfCross } else { FindingKind::LevelsCross };
        let place = first.common[0];
        let verb = if of_group().any(|p| p.meeting == Meeting::Cross) || crosses_at(segments, &involved, lines, place) {
            format!("crosses {whom}")
        } else if of_group().all(|p| p.meeting == Meeting::Apart) {
            format!("comes nearer than {separation} map units to {whom}")
        } else {
            format!("touches {whom}")
        };
        (kind, place, verb)
    };
    let message = format!("the contour {elevation} m (feature {feature}) {how}; {}", what_goes(&one, &other));
    Finding::at(kind, place, message).about(feature, elevation).about(other.line.feature, other.line.elevation)
}

fn what_goes(one: &LineShare, other: &LineShare) -> String {
    let count = |n: usize| if n == 1 { "one segment".to_owned() } else { format!("{n} segments") };
    let length = one.length + other.length;
    match (one.count, other.count) {
        (1, 0) => format!("one segment of it, {length:.3} map units long, was left out"),
        (n, 0) => format!("{n} segments of it, {length:.3} map units long, were left out"),
        (n, m) => {
            format!("{} of it and {} of the other, {length:.3} map units long, were left out", count(n), count(m))
        }
    }
}

/// The two ends of the common stretch, in the direction of the first line.
fn ends<'a>(segments: &Segments, pairs: impl Iterator<Item = &'a Pair>) -> [DVec2; 2] {
    let key = |s: u32, p: DVec2| (s, segments.get(s).a.distance(p));
    let mut places: Vec<((u32, f64), DVec2)> =
        pairs.flat_map(|pair| pair.common.map(|p| (key(pair.segments.0, p), p))).collect();
    places.sort_by(|a, b| a.0.0.cmp(&b.0.0).then(a.0.1.total_cmp(&b.0.1)));
    let line = segments.line_number(places[0].0.0);
    if segments.lines()[line].is_closed() {
        // The stretch may run across the ring's start. It begins after the widest part of the ring that is not in it.
        let count = segments.start(line as u32 + 1) - segments.start(line as u32);
        let apart = |i: usize| {
            let (before, here) = (places[(i + places.len() - 1) % places.len()].0.0, places[i].0.0);
            if i == 0 { here + count - before } else { here - before }
        };
        let start = (0..places.len()).max_by(|&i, &j| apart(i).cmp(&apart(j)).then(j.cmp(&i))).unwrap_or(0);
        places.rotate_left(start);
    }
    [places[0].1, places[places.len() - 1].1]
}

/// Whether two lines that have a point in common cross each other there.
fn crosses_at(segments: &Segments, involved: &[u32], lines: [usize; 2], place: DVec2) -> bool {
    let arms = |line: usize| -> Vec<f64> {
        let own = involved.iter().filter(|&&s| segments.line_number(s) == line);
        let ends = own.flat_map(|&s| {
            let Segment { a, b } = segments.get(s);
            [a, b]
        });
        ends.filter(|&p| p != place).map(|p| (p - place).to_angle()).collect()
    };
    let ([a, b], [c, d]) = (&arms(lines[0])[..], &arms(lines[1])[..]) else { return false };
    let turn = |to: &f64| (to - a).rem_euclid(std::f64::consts::TAU);
    lines[0] != lines[1] && (turn(c) < turn(b)) != (turn(d) < turn(b))
}

fn length(s: Segment) -> f64 {
    s.a.distance(s.b)
}

/// A displacement in words.
fn way(to: DVec2) -> String {
    let part = |d: f64, words: [&str; 2]| format!("{:.3} {}", d.abs(), words[usize::from(d < 0.0)]);
    format!("{} and {}", part(to.x, ["east", "west"]), part(to.y, ["north", "south"]))
}
