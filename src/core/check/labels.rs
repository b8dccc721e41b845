//! Wrong labels and missing contours, found from the bands around them.

use std::collections::BTreeMap;

use glam::DVec2;

use super::bands::{Explanation, Span, levels_between, separates};
use super::correction::{Correction, Judged};
use super::graph::{Graph, Stretch};
use super::grid::{Label, LevelGrid, is_other_unit, likeness};
use super::ground::Ground;
use crate::base::error::{Finding, FindingKind, Proposal};
use crate::contour::ContourMap;
use crate::subdomains::{line_at, line_starts};
use crate::tin::{NONE, VertexKind};

/// Cost of giving an innermost contour the level of the contours around it, as a difference of negative logarithms.
const FACING: f64 = 1.0;
/// A correction of a label is proposed only if every other one costs this much more, as a difference of negative
/// logarithms. Otherwise the proposal would be a guess.
const CLEAR: f64 = 0.5;
/// From this many labels on that equal their proposal in feet or in metres, the unit is wrong, not each label.
const OTHER_UNIT: usize = 3;
/// Most features that a finding about many lines names.
const NAMED: usize = 20;

/// A contour whose label contradicts the ground around it.
#[derive(Debug, Clone, PartialEq)]
pub struct Wrong {
    /// Number of the contour.
    pub line: u32,
    /// The levels that it can have instead, the most plausible first; none if the ground gives no level.
    pub levels: Vec<i64>,
    /// The levels between the ground on its two sides, ascending, if there are several. All of them but this line are
    /// missing.
    pub apart: Vec<i64>,
    /// Whether another line may be the wrong one instead.
    pub or_another: bool,
    /// Whether the first level is not clearly better than the second.
    pub is_open: bool,
}

/// The contours whose labels contradict the ground on their two sides.
pub fn wrong_labels(map: &ContourMap, graph: &Graph, explained: &Explanation, grid: &LevelGrid) -> Vec<Wrong> {
    let span = |r: u32| explained.spans.get(r as usize).copied().flatten().filter(|_| !graph.ragged[r as usize]);
    let mut wrong = Vec::new();
    let mut doubted = Vec::new();
    for of_line in graph.stretches.chunk_by(|a, b| a.line == b.line) {
        let line = of_line[0].line;
        let label = grid.label(map.contours[line as usize].elevation);
        let is_bad = |s: &&Stretch| match s.sides.map(|r| if r == NONE { None } else { span(r) }) {
            [Some(a), Some(b)] if !s.dangles() => !separates(label, a, b),
            [Some(a), _] | [None, Some(a)] => !a.meets(label),
            [None, None] => false,
        };
        let bad: Vec<&Stretch> = of_line.iter().filter(is_bad).collect();
        let judged: f64 =
            of_line.iter().filter(|s| s.sides.iter().any(|&r| r != NONE && span(r).is_some())).map(|s| s.share).sum();
        if bad.is_empty() || bad.iter().map(|s| s.share).sum::<f64>() <= 0.5 * judged {
            continue;
        }
        let longest = bad.iter().find(|s| !s.dangles() && s.sides.iter().all(|&r| r != NONE && span(r).is_some()));
        let (levels, apart) = longest.map_or_else(Default::default, |s| match s.sides.map(span) {
            [Some(a), Some(b)] => (levels_between(a, b).collect(), levels_apart(a, b)),
            _ => (Vec::new(), Vec::new()),
        });
        doubted.push((label, longest.map_or([NONE; 2], |s| s.sides)));
        wrong.push(Wrong { line, levels, apart, or_another: false, is_open: false });
    }
    for (wrong, margin) in wrong.iter_mut().zip(explained.margins(&doubted)) {
        wrong.or_another = margin < CLEAR;
    }
    wrong
}

/// The levels between two sub-domains if there are several; otherwise none.
fn levels_apart(a: Span, b: Span) -> Vec<i64> {
    let (low, high) = if a.lo <= b.lo { (a, b) } else { (b, a) };
    let levels = low.hi + 1..=high.lo;
    if levels.end() > levels.start() { levels.collect() } else { Vec::new() }
}

/// Chooses the levels of innermost contours among the wrong ones. Such a contour could enclose a top or a pit: both
/// levels of the ground around it fit. The choice considers:
///
/// - whether the map's other innermost contours enclose tops or pits;
/// - the level of the contours around it, because a slope goes on more often than it turns;
/// - which level is easily mistaken for the label.
pub fn settle_innermost(ground: &Ground, graph: &Graph, grid: &LevelGrid, spans: &[Option<Span>], wrong: &mut [Wrong]) {
    let map = ground.map;
    let innermost = innermost(graph, ground.regions.regions.len());
    let mut asked: BTreeMap<u32, BTreeMap<i64, f64>> = BTreeMap::new();
    for w in wrong.iter_mut() {
        if let Some(span) = innermost.get(&w.line).and_then(|&[_, around]| spans[around as usize]) {
            w.levels = (span.lo..=span.hi + 1).collect();
            asked.insert(w.line, BTreeMap::new());
        }
    }
    if asked.is_empty() {
        return;
    }
    let (mut tops, mut pits) = (1.0f64, 1.0f64);
    for (line, &[inside, around]) in &innermost {
        if let (false, Some(a), Some(b)) = (asked.contains_key(line), spans[inside as usize], spans[around as usize]) {
            if a.lo > b.hi {
                tops += 1.0;
            } else if a.hi < b.lo {
                pits += 1.0;
            }
        }
    }
    facing(ground, &innermost, grid, &mut asked);
    for w in wrong {
        let (Some(faced), Some(&[_, around])) = (asked.get(&w.line), innermost.get(&w.line)) else { continue };
        let Some(span) = spans[around as usize] else { continue };
        let total: f64 = faced.values().sum::<f64>().max(f64::MIN_POSITIVE);
        let elevation = map.contours[w.line as usize].elevation;
        let cost = |y: i64| {
            let turn = if y > span.hi { tops } else { pits };
            FACING * faced.get(&y).unwrap_or(&0.0) / total - likeness(elevation, grid.elevation(y)) - turn.ln()
        };
        w.levels.sort_by(|&a, &b| cost(a).total_cmp(&cost(b)));
        w.is_open = matches!(w.levels[..], [first, second, ..] if cost(second) - cost(first) < CLEAR);
    }
}

/// The contours that alone bound a sub-domain, each with this sub-domain and the one on its other side.
fn innermost(graph: &Graph, count: usize) -> BTreeMap<u32, [u32; 2]> {
    let mut borders = vec![0u32; count];
    let apart = || graph.stretches.iter().filter(|s| !s.dangles());
    for r in apart().flat_map(|s| s.sides).filter(|&r| r != NONE) {
        borders[r as usize] += 1;
    }
    let mut innermost = BTreeMap::new();
    for s in apart().filter(|s| !s.sides.contains(&NONE)) {
        let [a, b] = s.sides;
        match [a, b].map(|r| borders[r as usize] == 1) {
            [true, false] => innermost.insert(s.line, [a, b]),
            [false, true] => innermost.insert(s.line, [b, a]),
            _ => None,
        };
    }
    innermost
}

/// Adds, for each line in `asked`, the levels of the contours that it faces, each with the length that faces it. Other
/// innermost contours do not count: they stand beside it on the same slope.
fn facing(
    ground: &Ground,
    innermost: &BTreeMap<u32, [u32; 2]>,
    grid: &LevelGrid,
    asked: &mut BTreeMap<u32, BTreeMap<i64, f64>>,
) {
    let tin = ground.tin;
    let start = line_starts(ground.map);
    for t in (0..tin.len() as u32).filter(|&t| tin.is_inside(t)) {
        for i in 0..3 {
            if tin.contour_level(t, i).is_none() {
                continue;
            }
            let apex = tin.triangles[t as usize][(i + 2) % 3];
            let line = line_at(tin, &start, tin.edge(t, i)[0]);
            let Some(faced) = line.and_then(|line| asked.get_mut(&line)) else { continue };
            if tin.kinds[apex as usize] == VertexKind::Contour
                && line_at(tin, &start, apex).is_none_or(|other| !innermost.contains_key(&other))
                && let Label::On(y) = grid.label(tin.heights[apex as usize])
            {
                *faced.entry(y).or_default() += tin.edge_length(t, i);
            }
        }
    }
}

/// Reports wrong labels, with their corrections.
pub fn report_wrong(map: &ContourMap, grid: &LevelGrid, wrong: &[Wrong], judged: &mut Judged) {
    let elevation = |w: &Wrong| map.contours[w.line as usize].elevation;
    let fits = |w: &Wrong| w.levels.first().map(|&y| grid.elevation(y));
    let in_other_unit = |w: &&Wrong| fits(w).is_some_and(|to| is_other_unit(elevation(w), to));
    let mixed = wrong.iter().filter(in_other_unit).count() >= OTHER_UNIT;
    for w in wrong {
        let contour = &map.contours[w.line as usize];
        let (from, feature) = (contour.elevation, contour.feature);
        let place = contour.points.get(contour.points.len() / 2).copied();
        let Some(to) = fits(w) else {
            if let [lowest, .., highest] = w.apart[..] {
                let message = format!(
                    "ground below {lowest} m and ground above {highest} m meet at feature {feature} ({from} m): all other contours \
                     from {lowest} m to {highest} m are missing there",
                    lowest = grid.elevation(lowest),
                    highest = grid.elevation(highest)
                );
                judged.findings.push(Finding::new(FindingKind::SkippedLevel, place, message).about(feature, from));
            }
            let can_be_right = matches!(grid.label(from), Label::On(y) if w.apart.contains(&y));
            let unless = if can_be_right { ", unless a contour beside it is missing" } else { "" };
            let message =
                format!("the elevation {from} m of feature {feature} contradicts the contours around it{unless}");
            judged.findings.push(Finding::new(FindingKind::WrongLabel, place, message).about(feature, from));
            judged.doubted.push(w.line);
            continue;
        };
        let others: Vec<String> = w.levels[1..].iter().take(2).map(|&y| format!("{} m", grid.elevation(y))).collect();
        let or = if others.is_empty() { String::new() } else { format!(", or perhaps {}", others.join(" or ")) };
        let (kind, why) = if mixed && in_other_unit(&w) {
            (FindingKind::MixedUnits, "is in another unit than those of the contours around it")
        } else if from == 0.0 {
            (FindingKind::ZeroElevation, "contradicts the contours around it")
        } else {
            (FindingKind::WrongLabel, "contradicts the contours around it")
        };
        // A label one level away from one that fits is right if the contour between is missing.
        let is_next = |&y: &i64| matches!(grid.label(from), Label::On(x) if x.abs_diff(y) == 1);
        let missing = if w.levels.len() > 1 && w.levels.iter().any(is_next) {
            ", unless a contour beside it is missing"
        } else {
            ""
        };
        let another = if w.or_another { ", unless a contour beside it is wrong or missing" } else { missing };
        let message = format!("the elevation {from} m of feature {feature} {why}; {to} m{or} would fit{another}");
        let finding = Finding::new(kind, place, message).about(feature, from);
        if w.or_another || w.is_open {
            judged.findings.push(finding);
            judged.doubted.push(w.line);
            continue;
        }
        judged.findings.push(finding.proposing(Proposal::Relabel { from, to }));
        judged.corrections.push(Correction::Label { line: w.line, elevation: to });
    }
}

/// The edge with the largest rise across a missing level.
#[derive(Debug, Clone, Copy)]
struct Steep {
    rise: f64,
    distance: f64,
    lines: [Option<u32>; 2],
    place: DVec2,
}

/// Reports skipped levels where the rise across them is largest, unless a line of such a level ends inside the sub-domain.
/// Levels that are missing between the same two lines of a sub-domain share a finding.
pub fn report_skipped(ground: &Ground, graph: &Graph, grid: &LevelGrid, spans: &[Option<Span>], judged: &mut Judged) {
    let Ground { map, tin, regions, .. } = *ground;
    let mut wanted: BTreeMap<u32, BTreeMap<i64, Option<Steep>>> = BTreeMap::new();
    for (r, span) in spans.iter().enumerate() {
        let ends = &graph.dangling[r];
        let skipped = span.iter().flat_map(|span| span.skipped());
        let missing: BTreeMap<i64, _> =
            skipped.filter(|&y| !ends.iter().any(|(l, _)| *l == Label::On(y))).map(|y| (y, None)).collect();
        if !missing.is_empty() && !graph.ragged[r] {
            wanted.insert(r as u32, missing);
        }
    }
    if wanted.is_empty() {
        return;
    }
    let start = line_starts(map);
    for t in (0..tin.len() as u32).filter(|&t| tin.is_inside(t)) {
        let region = regions.of_triangle[t as usize];
        let Some(missing) = wanted.get_mut(&region) else { continue };
        let Some(span) = spans[region as usize] else { continue };
        let limits = [grid.elevation(span.lo) - 0.1 * grid.step(), grid.elevation(span.hi + 1) + 0.1 * grid.step()];
        for i in 0..3 {
            let [u, v] = tin.edge(t, i);
            let ends = if tin.heights[u as usize] <= tin.heights[v as usize] { [u, v] } else { [v, u] };
            let [a, b] = ends.map(|v| tin.heights[v as usize]);
            let on_lines = [u, v].iter().all(|&v| tin.kinds[v as usize] == VertexKind::Contour);
            if !on_lines || a < limits[0] || b > limits[1] {
                continue;
            }
            let (rise, distance) = (b - a, tin.edge_length(t, i));
            for (_, best) in missing.iter_mut().filter(|&(&y, _)| a < grid.elevation(y) && grid.elevation(y) < b) {
                if best.is_none_or(|s| rise > s.rise || (rise == s.rise && distance < s.distance)) {
                    let place = 0.5 * (tin.positions[u as usize] + tin.positions[v as usize]) + tin.origin;
                    *best = Some(Steep { rise, distance, lines: ends.map(|v| line_at(tin, &start, v)), place });
                }
            }
        }
    }
    for (region, missing) in wanted {
        let mut by_lines = BTreeMap::new();
        for (level, steep) in missing {
            let (_, levels) = by_lines.entry(steep.map_or([None; 2], |s| s.lines)).or_insert((steep, Vec::new()));
            levels.push(format!("{} m", grid.elevation(level)));
        }
        for (steep, levels) in by_lines.into_values() {
            let lines: Vec<_> =
                steep.iter().flat_map(|s| s.lines).flatten().map(|line| &map.contours[line as usize]).collect();
            let levels = levels.join(", ");
            let message = match lines[..] {
                [a, b] => format!(
                    "contours {} m and {} m are neighbours: the contour {levels} between them is missing, or one of the two \
                     has a wrong elevation",
                    a.elevation, b.elevation
                ),
                _ => format!(
                    "the contours here skip a level: the contour {levels} is missing, or one has a wrong elevation"
                ),
            };
            let place = steep
                .map_or_else(|| tin.corners(regions.regions[region as usize].triangle)[0] + tin.origin, |s| s.place);
            let finding = Finding::at(FindingKind::SkippedLevel, place, message);
            judged.findings.push(lines.into_iter().fold(finding, |f, line| f.about(line.feature, line.elevation)));
        }
    }
}

/// Reports auxiliary contours, one note per elevation off the interval whose lines lie between its two levels.
pub fn report_auxiliary(map: &ContourMap, grid: &LevelGrid, wrong: &[Wrong], judged: &mut Judged) {
    let is_wrong = |line: usize| wrong.binary_search_by_key(&(line as u32), |w| w.line).is_ok();
    let mut by_level: BTreeMap<(i64, u64), Vec<usize>> = BTreeMap::new();
    for (line, contour) in map.contours.iter().enumerate() {
        if let Label::Within(k) = grid.label(contour.elevation)
            && !is_wrong(line)
        {
            by_level.entry((k, contour.elevation.to_bits())).or_default().push(line);
        }
    }
    for ((k, _), lines) in by_level {
        let first = &map.contours[lines[0]];
        let count = if lines.len() == 1 { String::new() } else { format!(" ({} lines)", lines.len()) };
        let message = format!(
            "the elevation {} m of feature {}{count} lies between the levels {} m and {} m: an auxiliary contour, or a wrong elevation",
            first.elevation,
            first.feature,
            grid.elevation(k),
            grid.elevation(k + 1)
        );
        let finding =
            Finding::new(FindingKind::OffInterval, first.points.get(first.points.len() / 2).copied(), message);
        let named = lines.iter().take(NAMED).map(|&line| &map.contours[line]);
        judged.findings.push(named.fold(finding, |f, c| f.about(c.feature, c.elevation)));
    }
}
