//! Gaps and other open ends.
//!
//! Two ends of one level in the same sub-domain are the two sides of a gap. The nearest and best aligned pairs come
//! first. The other ends lie inside the map. For an auxiliary contour that is normal; the others are reported. Along a
//! ragged outline lines end everywhere, which is no fault.

use std::collections::{BTreeMap, HashMap, HashSet};

use glam::DVec2;

use super::correction::{Correction, Judged};
use super::graph::Graph;
use super::grid::{Label, LevelGrid};
use super::ground::Ground;
use super::labels::Wrong;
use crate::base::bits::bits;
use crate::base::error::{Finding, FindingKind, Proposal};
use crate::subdomains::{FrameExtension, OpenEnd, Sight, line_starts};
use crate::tin::NONE;

/// A line stops short of the frame if its frame extension is longer than this many times the usual length (90th
/// percentile).
const SHORT_OF_FRAME: f64 = 8.0;
/// Ends nearer to the frame than this many times the usual length lie on a ragged outline.
const OUTLYING: f64 = 1.5;
/// The widest gap between ends that point at each other, as a share of the map's diagonal.
const WIDEST: f64 = 0.5;
/// The same for ends that do not point at each other.
const WIDEST_ASKEW: f64 = 0.1;
/// Largest turn between the end of a line and the way across a gap to which it points, as a cosine: 60 degrees.
const COS_POINTING: f64 = 0.5;
/// Ends in a chain of barrier edges: from this number on they follow a cliff or an outline.
const CLIFF: usize = 6;
/// Most ends of one level that are paired with each other. More of them mean that the map has no order.
const MOST_OF_LEVEL: usize = 1000;

/// An open end that is not explained yet.
struct Unexplained {
    /// Its number among all ends.
    end: usize,
    /// The sub-domains around it.
    around: Vec<u32>,
    /// Whether a long frame extension leads from it to the frame.
    is_extended: bool,
    /// Whether it was reported.
    is_reported: bool,
}

/// Two ends of a gap, by their numbers among all ends.
type Pair = [usize; 2];

/// Finds gaps and open ends. Lines in `wrong` were reported already; their ends are ignored.
pub fn report_ends(ground: &Ground, graph: &Graph, grid: &LevelGrid, wrong: &[Wrong], judged: &mut Judged) {
    let ends = ground.ends;
    let usual = usual_extension(ends, ground.extensions);
    let far = far_from_frame(ground, usual);
    // These ends are as near to the frame as others with a frame extension.
    let is_outlying = |i: usize| usual > 0.0 && distance_to_frame(ground, ends[i].position) <= OUTLYING * usual;
    let is_wrong = |line: u32| wrong.binary_search_by_key(&line, |w| w.line).is_ok();
    let is_level = |e: &OpenEnd| matches!(grid.label(e.elevation), Label::On(_));
    // Nothing is missing where the user left out a part of the map.
    let is_open = |i: usize| (!ends[i].at_frame || far[i]) && !ends[i].is_cut;
    let wanted: Vec<usize> = (0..ends.len()).filter(|&i| is_open(i) && !is_wrong(ends[i].contour)).collect();
    if wanted.is_empty() {
        return;
    }
    let vertex_of = vertices(ground, &wanted);
    let end_at: HashMap<u32, usize> = vertex_of.iter().map(|(&end, &v)| (v, end)).collect();
    let around = regions_around(ground, &end_at);
    let unexplained = |&end: &usize| {
        let around = around.get(&end).cloned().unwrap_or_default();
        (end, Unexplained { end, around, is_extended: far[end], is_reported: false })
    };
    let mut unexplained: BTreeMap<usize, Unexplained> = wanted.iter().map(unexplained).collect();

    let pair_of = |edge: &[u32; 2]| Some([*end_at.get(&edge[0])?, *end_at.get(&edge[1])?]);
    let mut closed: Vec<Pair> = ground.gaps.closures.iter().filter_map(pair_of).collect();
    closed.sort_unstable();
    for pair in closed {
        if !pair.iter().all(|&end| is_outlying(end)) {
            report_gap(ground, pair, true, judged);
        }
        pair.iter().for_each(|end| {
            unexplained.entry(*end).and_modify(|l| l.is_reported = true);
        });
    }

    // Auxiliary contours end inside the map, and lines end along a ragged outline: neither is a fault.
    unexplained.retain(|_, l| {
        !l.is_reported
            && is_level(&ends[l.end])
            && !is_outlying(l.end)
            && !l.around.iter().any(|&r| graph.ragged[r as usize])
    });
    let barriers: Vec<Pair> = ground.gaps.barriers.iter().filter_map(pair_of).collect();
    let chains = chains(&unexplained, &barriers, ends);
    for chain in chains.iter().filter(|c| c.len() >= CLIFF) {
        report_cliff(ground, chain, judged);
        chain.iter().for_each(|end| {
            unexplained.remove(end);
        });
    }

    report_pairs(ground, &mut unexplained, &barriers, judged);
    report_open(ground, &unexplained, judged);
}

/// Reports gaps between pairs of ends, and takes those ends out of `unexplained`.
fn report_pairs(
    ground: &Ground,
    unexplained: &mut BTreeMap<usize, Unexplained>,
    barriers: &[Pair],
    judged: &mut Judged,
) {
    let sight = Sight::new(ground.map);
    for pair in pairs(unexplained, barriers, ground.ends, ground.frame.diagonal()) {
        let [a, b] = pair.map(|i| &ground.ends[i]);
        // The line of sight stops a little before the other end, because the line of that end would block it.
        let before = b.position.lerp(a.position, 1e-6);
        report_gap(ground, pair, sight.sees(ground.map, a.position, before), judged);
        pair.iter().for_each(|end| {
            unexplained.remove(end);
        });
    }
}

/// The usual length of frame extensions, map units: the 90th percentile, with 0 for ends on the frame.
fn usual_extension(ends: &[OpenEnd], extensions: &[FrameExtension]) -> f64 {
    let extended = extensions.iter().map(|l| l.end.distance(l.frame));
    let on_frame = ends.iter().filter(|e| e.at_frame).count().saturating_sub(extensions.len());
    let mut lengths: Vec<f64> = std::iter::repeat_n(0.0, on_frame).chain(extended).collect();
    lengths.sort_unstable_by(f64::total_cmp);
    lengths.get(lengths.len() * 9 / 10).copied().unwrap_or(0.0)
}

/// By end: whether its frame extension is much longer than usual.
fn far_from_frame(ground: &Ground, usual: f64) -> Vec<bool> {
    let Ground { ends, extensions, frame, .. } = *ground;
    let by_end: HashMap<[u64; 2], f64> = extensions.iter().map(|l| (bits(l.end), l.end.distance(l.frame))).collect();
    let least = (SHORT_OF_FRAME * usual).max(1e-3 * frame.diagonal());
    let length = |e: &OpenEnd| if e.at_frame { by_end.get(&bits(e.position)).copied().unwrap_or(0.0) } else { 0.0 };
    ends.iter().map(|e| length(e) > least).collect()
}

fn distance_to_frame(ground: &Ground, p: DVec2) -> f64 {
    let to_edge = |[a, b]: [DVec2; 2]| {
        let along = ((p - a).dot(b - a) / (b - a).length_squared()).clamp(0.0, 1.0);
        if along.is_nan() { p.distance(a) } else { p.distance(a.lerp(b, along)) }
    };
    ground.frame.edges().map(to_edge).fold(f64::INFINITY, f64::min)
}

/// The vertices of ends in the triangulation.
fn vertices(ground: &Ground, wanted: &[usize]) -> HashMap<usize, u32> {
    let start = line_starts(ground.map);
    let source = |end: usize| {
        let line = ground.ends[end].contour as usize;
        let is_first = ground.map.contours[line].points.first() == Some(&ground.ends[end].position);
        if is_first { start[line] } else { start[line + 1] - 1 }
    };
    let by_source: HashMap<u32, usize> = wanted.iter().map(|&end| (source(end), end)).collect();
    let vertices = (0..ground.tin.positions.len() as u32).filter_map(|v| {
        let end = by_source.get(&ground.tin.source[v as usize])?;
        Some((*end, v))
    });
    vertices.collect()
}

/// The sub-domains that touch each end.
fn regions_around(ground: &Ground, end_at: &HashMap<u32, usize>) -> HashMap<usize, Vec<u32>> {
    let mut is_end = vec![false; ground.tin.positions.len()];
    end_at.keys().for_each(|&v| is_end[v as usize] = true);
    let mut around: HashMap<usize, Vec<u32>> = HashMap::new();
    for (t, corners) in ground.tin.triangles.iter().enumerate() {
        for v in corners.iter().filter(|&&v| is_end[v as usize]) {
            let (region, found) = (ground.regions.of_triangle[t], around.entry(end_at[v]).or_default());
            if region != NONE && !found.contains(&region) {
                found.push(region);
            }
        }
    }
    around
}

/// Chains of ends, joined by barrier edges between different levels.
fn chains(unexplained: &BTreeMap<usize, Unexplained>, barriers: &[Pair], ends: &[OpenEnd]) -> Vec<Vec<usize>> {
    let mut next: BTreeMap<usize, Vec<usize>> = BTreeMap::new();
    for &[a, b] in barriers {
        if ends[a].elevation != ends[b].elevation && unexplained.contains_key(&a) && unexplained.contains_key(&b) {
            next.entry(a).or_default().push(b);
            next.entry(b).or_default().push(a);
        }
    }
    let mut chains = Vec::new();
    while let Some((first, _)) = next.first_key_value() {
        let mut chain = vec![*first];
        let mut at = 0;
        while let Some(end) = chain.get(at).copied() {
            at += 1;
            for other in next.remove(&end).into_iter().flatten() {
                if next.contains_key(&other) && !chain.contains(&other) {
                    chain.push(other);
                }
            }
        }
        chains.push(chain);
    }
    chains
}

/// The pairs of ends that are the two sides of a gap, the nearest and best aligned ones first.
fn pairs(unexplained: &BTreeMap<usize, Unexplained>, barriers: &[Pair], ends: &[OpenEnd], diagonal: f64) -> Vec<Pair> {
    let mut by_level: BTreeMap<u64, Vec<&Unexplained>> = BTreeMap::new();
    for l in unexplained.values() {
        by_level.entry(ends[l.end].elevation.to_bits()).or_default().push(l);
    }
    let barriers: HashSet<Pair> = barriers.iter().map(|&[a, b]| [a.min(b), a.max(b)]).collect();
    let mut candidates: Vec<(f64, Pair)> = Vec::new();
    for of_level in by_level.values().filter(|of_level| of_level.len() <= MOST_OF_LEVEL) {
        for (i, a) in of_level.iter().enumerate() {
            for b in &of_level[i + 1..] {
                let has_barrier = || barriers.contains(&[a.end.min(b.end), a.end.max(b.end)]);
                if (a.around.iter().any(|r| b.around.contains(r)) || has_barrier())
                    && let Some(cost) = gap_cost(&ends[a.end], &ends[b.end], diagonal)
                {
                    candidates.push((cost, [a.end, b.end]));
                }
            }
        }
    }
    candidates.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
    let mut taken: HashSet<usize> = HashSet::new();
    candidates.retain(|(_, pair)| {
        let free = !pair.iter().any(|end| taken.contains(end));
        if free {
            taken.extend(pair);
        }
        free
    });
    candidates.into_iter().map(|(_, pair)| pair).collect()
}

/// The distance between two ends, up to three times as much where they point away from each other. None where it is
/// larger than the lines themselves, or larger than a gap can be on a map of this diagonal.
fn gap_cost(a: &OpenEnd, b: &OpenEnd, diagonal: f64) -> Option<f64> {
    let across = b.position - a.position;
    let distance = across.length();
    let way = across.normalize_or_zero();
    let facing = a.outwards.dot(way).min(b.outwards.dot(-way));
    let lines = if a.contour == b.contour { a.length } else { a.length + b.length };
    let most = if facing >= COS_POINTING {
        lines.min(WIDEST * diagonal)
    } else {
        a.length.min(b.length).min(WIDEST_ASKEW * diagonal)
    };
    (distance <= most).then_some(distance * (2.0 - facing))
}

/// Reports a gap. `is_clear` means that nothing lies between its ends: a straight piece can join them.
fn report_gap(ground: &Ground, pair: Pair, is_clear: bool, judged: &mut Judged) {
    let mut ends = pair.map(|i| &ground.ends[i]);
    ends.sort_by_key(|e| e.contour);
    let [a, b] = ends;
    let [one, other] = [a, b].map(|e| &ground.map.contours[e.contour as usize]);
    let gap = a.position.distance(b.position);
    let of = if one.feature == other.feature {
        format!("feature {}", one.feature)
    } else {
        format!("features {} and {}", one.feature, other.feature)
    };
    let message = format!("a gap of {gap:.3} map units in the contour {} m ({of})", a.elevation);
    let finding = Finding::at(FindingKind::Gap, a.position.midpoint(b.position), message);
    let mut finding = finding.about(one.feature, a.elevation).about(other.feature, a.elevation);
    if is_clear {
        let ends = [a.position, b.position];
        finding = finding.proposing(Proposal::Join { ends });
        judged.corrections.push(Correction::Join { lines: [a.contour, b.contour], ends });
    }
    judged.findings.push(finding);
}

/// Reports many lines that end beside each other.
fn report_cliff(ground: &Ground, chain: &[usize], judged: &mut Judged) {
    let levels = chain.iter().map(|&i| ground.ends[i].elevation);
    let (lo, hi) = levels.fold((f64::INFINITY, f64::NEG_INFINITY), |m, z| (m.0.min(z), m.1.max(z)));
    let message = format!(
        "{} contours from {lo} m to {hi} m end inside the map beside each other: a cliff, or a part of the map \
         is missing",
        chain.len()
    );
    let finding = Finding::at(FindingKind::OpenEnd, ground.ends[chain[chain.len() / 2]].position, message);
    let lines = chain.iter().map(|&i| &ground.ends[i]);
    judged
        .findings
        .push(lines.fold(finding, |f, e| f.about(ground.map.contours[e.contour as usize].feature, e.elevation)));
}

/// Reports the remaining ends, one finding per line.
fn report_open(ground: &Ground, unexplained: &BTreeMap<usize, Unexplained>, judged: &mut Judged) {
    let mut by_line: BTreeMap<u32, Vec<&Unexplained>> = BTreeMap::new();
    for l in unexplained.values() {
        by_line.entry(ground.ends[l.end].contour).or_default().push(l);
    }
    for (line, of_line) in by_line {
        let contour = &ground.map.contours[line as usize];
        let (elevation, feature) = (contour.elevation, contour.feature);
        let what = match of_line[..] {
            [one] if one.is_extended => "stops short of the frame: a piece may be missing",
            [_] => "ends inside the map: a piece of it is missing, or it ends at a cliff",
            _ => "ends inside the map on both sides: a piece of a contour, or an auxiliary contour",
        };
        let message = format!("the contour {elevation} m (feature {feature}) {what}");
        let place = ground.ends[of_line[0].end].position;
        judged.findings.push(Finding::at(FindingKind::OpenEnd, place, message).about(feature, elevation));
    }
}
