//! Joins pieces of one level whose ends meet into lines and rings.
//!
//! Ends at exactly the same point are joined if there are two of them. Where three or more meet, nothing shows which
//! belong together. Two other ends are joined across a gap if each is the nearest end to the other. Both vertices stay,
//! and a short segment connects them.

use std::collections::{BTreeMap, HashSet};

use glam::DVec2;
use rayon::prelude::*;
use rstar::RTree;
use rstar::primitives::GeomWithData;

use super::removed::{self, SegmentKey};
use crate::base::FeatureId;
use crate::base::bits::bits;
use crate::base::error::{Finding, FindingKind};
use crate::contour::Contour;
use crate::geometry::compare_points;

/// Largest gap that closes a line, as a share of the line's length. A short straight line is not almost a ring, however
/// wide the snap distance.
const LARGEST_GAP: f64 = 0.5;

/// A segment that joins two ends.
pub(super) struct Connector {
    elevation: f64,
    /// Features of the two lines.
    features: [FeatureId; 2],
    ends: [DVec2; 2],
}

/// The segments that join ends across gaps, in a fixed order.
pub(super) type Connectors = BTreeMap<SegmentKey, Connector>;

/// Lines with their ends joined.
pub(super) struct Joined {
    /// Lines that were not joined.
    pub(super) unchanged: Vec<Contour>,
    /// Joined lines. They may visit a vertex twice.
    pub(super) joined: Vec<Contour>,
    /// The segments that were added to join ends.
    pub(super) connectors: Connectors,
}

/// An end of a line: twice the line's number, plus one for the line's last point.
type End = usize;

/// Joins lines, which must be simple and sorted. No segment that is `in_the_way` is used for it, and no gap is closed at an
/// end whose position is one of `apart`.
pub(super) fn join(
    lines: Vec<Contour>,
    snap: f64,
    apart: &HashSet<[u64; 2]>,
    in_the_way: &HashSet<SegmentKey>,
) -> Joined {
    let levels: Vec<Vec<Contour>> = by_level(lines);
    let levels: Vec<Joined> = levels.into_par_iter().map(|level| join_level(level, snap, apart, in_the_way)).collect();
    let mut all = Joined { unchanged: Vec::new(), joined: Vec::new(), connectors: BTreeMap::new() };
    for mut level in levels {
        all.unchanged.append(&mut level.unchanged);
        all.joined.append(&mut level.joined);
        all.connectors.append(&mut level.connectors);
    }
    all
}

fn by_level(lines: Vec<Contour>) -> Vec<Vec<Contour>> {
    let mut levels: Vec<Vec<Contour>> = Vec::new();
    for line in lines {
        match levels.last_mut() {
            Some(level) if level[0].elevation == line.elevation => level.push(line),
            _ => levels.push(vec![line]),
        }
    }
    levels
}

fn join_level(lines: Vec<Contour>, snap: f64, apart: &HashSet<[u64; 2]>, in_the_way: &HashSet<SegmentKey>) -> Joined {
    let mut partner: Vec<Option<End>> = vec![None; 2 * lines.len()];
    let mut single = pair_same_points(&lines, &mut partner);
    single.retain(|&end| !apart.contains(&bits(point(&lines, end))));
    if snap > 0.0 {
        pair_nearest(&lines, single, snap, &mut partner);
        for end in 0..partner.len() {
            let key = |other| removed::key(lines[end / 2].elevation, point(&lines, end), point(&lines, other));
            partner[end] = partner[end].filter(|&other| !in_the_way.contains(&key(other)));
        }
    }
    chain(lines, &mut partner)
}

fn point(lines: &[Contour], end: End) -> DVec2 {
    let points = &lines[end / 2].points;
    points[if end.is_multiple_of(2) { 0 } else { points.len() - 1 }]
}

/// Pairs the ends at a point if there are two. Returns the ends that are alone at their point.
fn pair_same_points(lines: &[Contour], partner: &mut [Option<End>]) -> Vec<End> {
    let open = lines.iter().enumerate().filter(|(_, line)| !line.is_closed());
    let mut ends: Vec<(DVec2, End)> =
        open.flat_map(|(i, _)| [2 * i, 2 * i + 1]).map(|end| (point(lines, end), end)).collect();
    ends.sort_unstable_by(|a, b| compare_points(&a.0, &b.0).then(a.1.cmp(&b.1)));
    let mut single = Vec::new();
    for group in ends.chunk_by(|a, b| a.0 == b.0) {
        match *group {
            [(_, end)] => single.push(end),
            [(_, a), (_, b)] => (partner[a], partner[b]) = (Some(b), Some(a)),
            _ => (),
        }
    }
    single
}

/// Pairs ends that are nearest to each other.
fn pair_nearest(lines: &[Contour], ends: Vec<End>, snap: f64, partner: &mut [Option<End>]) {
    let tree = RTree::bulk_load(ends.iter().map(|&e| GeomWithData::new(point(lines, e).to_array(), e)).collect());
    let mut nearest: Vec<Option<End>> = vec![None; partner.len()];
    for &end in &ends {
        let at = point(lines, end).to_array();
        // The nearest end may be the line's own other end, even where the line may not be closed. Of equally near ends
        // the first counts.
        let mut best: Option<(f64, End)> = None;
        for (other, distance) in tree.nearest_neighbor_iter_with_distance_2(&at) {
            if distance > snap * snap || best.is_some_and(|(d, _)| distance > d) {
                break;
            }
            if other.data != end && may_meet(lines, end, other.data) && best.is_none_or(|(_, e)| other.data < e) {
                best = Some((distance, other.data));
            }
        }
        nearest[end] = best.map(|(_, other)| other);
    }
    for &end in &ends {
        partner[end] = partner[end].or(nearest[end].filter(|&other| nearest[other] == Some(end)));
    }
}

fn may_meet(lines: &[Contour], a: End, b: End) -> bool {
    if a / 2 != b / 2 {
        return true;
    }
    let line = &lines[a / 2];
    line.points.len() >= 3 && point(lines, a).distance(point(lines, b)) <= LARGEST_GAP * line.length()
}

/// Follows the pairs from line to line.
fn chain(mut lines: Vec<Contour>, partner: &mut [Option<End>]) -> Joined {
    let mut done = vec![false; lines.len()];
    let mut joined = Vec::new();
    let mut connectors = BTreeMap::new();
    // Open chains start from their free ends. The remaining lines form rings.
    let free = (0..partner.len()).filter(|&end| partner[end].is_none() && partner[end ^ 1].is_some());
    let starts: Vec<End> = free.chain((0..lines.len()).map(|i| 2 * i)).collect();
    for start in starts {
        if done[start / 2] || (partner[start].is_none() && partner[start ^ 1].is_none()) {
            continue;
        }
        let mut way = vec![start];
        let mut end = start;
        while let Some(next) = partner[end ^ 1].filter(|&next| next != start) {
            way.push(next);
            end = next;
        }
        for &end in &way {
            done[end / 2] = true;
        }
        let closes = partner[start].is_some();
        joined.push(run_together(&lines, &way, closes, &mut connectors));
    }
    let mut done = done.into_iter();
    lines.retain(|_| !done.next().unwrap_or(false));
    Joined { unchanged: lines, joined, connectors }
}

/// The line along `way`. Its items are the ends at which each line is entered.
fn run_together(lines: &[Contour], way: &[End], closes: bool, connectors: &mut Connectors) -> Contour {
    let feature = way.iter().map(|end| lines[end / 2].feature).min().unwrap_or_default();
    let elevation = lines[way[0] / 2].elevation;
    let mut connect = |from: End, to: End| {
        let ends = [point(lines, from), point(lines, to)];
        let features = [lines[from / 2].feature, lines[to / 2].feature];
        connectors.insert(removed::key(elevation, ends[0], ends[1]), Connector { elevation, features, ends });
    };
    let mut points: Vec<DVec2> = Vec::with_capacity(way.iter().map(|end| lines[end / 2].points.len()).sum());
    let mut last: Option<End> = None;
    for &end in way {
        match last {
            Some(last) if points.last() != Some(&point(lines, end)) => connect(last, end),
            // The two lines' common point comes with the second one.
            Some(_) => points.truncate(points.len() - 1),
            None => (),
        }
        let line = &lines[end / 2].points;
        if end.is_multiple_of(2) {
            points.extend(line);
        } else {
            points.extend(line.iter().rev());
        }
        last = Some(end ^ 1);
    }
    if let (true, Some(last)) = (closes, last) {
        let first = points[0];
        if points.last() != Some(&first) && points.len() >= 3 {
            connect(last, way[0]);
            points.push(first);
        }
    }
    Contour { elevation, points, feature }
}

/// Findings about the gaps that were closed.
pub(super) fn findings(connectors: &Connectors) -> impl Iterator<Item = Finding> {
    connectors.values().map(|c| {
        let gap = c.ends[0].distance(c.ends[1]);
        Finding::at(
            FindingKind::ClosedGap,
            c.ends[0].midpoint(c.ends[1]),
            format!(
                "a gap of {gap:.3} map units in the contour {} m (features {} and {}) was closed",
                c.elevation, c.features[0], c.features[1]
            ),
        )
        .about(c.features[0], c.elevation)
        .about(c.features[1], c.elevation)
    })
}
