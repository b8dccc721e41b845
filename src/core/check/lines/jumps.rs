//! Lines whose elevation jumps: exactly two ends meet at one point, and their levels differ.
//!
//! Maps are digitised in sheets and squares, and each piece of a line has its own elevation. Pieces that continue each
//! other are one line. If a single piece is wrong, most of the others show the right elevation.

use std::collections::BTreeMap;

use glam::DVec2;

use super::ends::{At, End, place};
use crate::base::error::{Finding, FindingKind, Proposal};
use crate::check::{Correction, Judged};
use crate::contour::{Contour, ContourMap};

/// Fewest pieces of a line whose majority decides its elevation. Of two pieces, either may be wrong.
const VOTERS: usize = 3;

pub(super) fn find(map: &ContourMap, ends: &[At]) -> Judged {
    let lines = &map.contours;
    let mut judged = Judged::default();
    let partner = |end: End| match ends[end] {
        At::One(other) if ends[other] == At::One(end) => Some(other),
        _ => None,
    };
    let level = |end: End| lines[end / 2].elevation;
    let jumps =
        |end: End| partner(end).filter(|&other| level(end) != level(other) && (level(end) - level(other)).is_finite());
    let mut seen = vec![false; lines.len()];
    for line in 0..lines.len() {
        let own = [2 * line, 2 * line + 1];
        if seen[line] || own.iter().all(|&end| jumps(end).is_none()) {
            continue;
        }
        let way = chain(own[0], partner);
        way.iter().for_each(|end| seen[end / 2] = true);
        let closes = partner(way[0]).is_some();
        let right = elevation_of(lines, &way, closes);
        if let Some(elevation) = right {
            let wrong = way.iter().map(|end| end / 2).filter(|&line| lines[line].elevation != elevation);
            judged.corrections.extend(wrong.map(|line| Correction::Label { line: line as u32, elevation }));
        }
        let entered = &way[usize::from(!closes)..];
        let pairs = entered.iter().filter_map(|&end| Some([end, jumps(end)?]));
        judged.findings.extend(pairs.map(|pair| finding(lines, pair, right)));
    }
    judged.corrections.sort_by_key(|c| match c {
        Correction::Label { line, .. } | Correction::LeaveOut { line, .. } => *line,
        Correction::Join { lines, .. } => lines[0],
    });
    judged
}

/// The pieces of the line that a piece belongs to, from one end of the line to the other, or once around. Each piece is
/// given by the end at which it is entered.
fn chain(start: End, partner: impl Fn(End) -> Option<End>) -> Vec<End> {
    let mut first = start;
    while let Some(before) = partner(first).map(|end| end ^ 1).filter(|&before| before != start) {
        first = before;
    }
    let mut way = vec![first];
    let mut end = first;
    while let Some(next) = partner(end ^ 1).filter(|&next| next != first) {
        way.push(next);
        end = next;
    }
    way
}

/// The elevation that most pieces of a line have, if those are most of its length too. Otherwise, the one on both sides
/// of the only piece that differs. None if neither holds.
fn elevation_of(lines: &[Contour], way: &[End], closes: bool) -> Option<f64> {
    let mut votes: BTreeMap<u64, (f64, Vec<f64>)> = BTreeMap::new();
    let mut runs: Vec<f64> = Vec::new();
    for line in way.iter().map(|end| &lines[end / 2]) {
        votes.entry((line.elevation + 0.0).to_bits()).or_insert((line.elevation, Vec::new())).1.push(line.length());
        if runs.last() != Some(&line.elevation) {
            runs.push(line.elevation);
        }
    }
    let votes: Vec<(f64, usize, f64)> = votes
        .into_values()
        .map(|(elevation, mut lengths)| {
            // Summed in a fixed order, from whichever end the line is followed.
            lengths.sort_unstable_by(f64::total_cmp);
            (elevation, lengths.len(), lengths.iter().sum())
        })
        .collect();
    let best = votes.iter().max_by(|a, b| a.1.cmp(&b.1).then(a.2.total_cmp(&b.2)))?;
    let is_clear = votes.iter().all(|v| v.0 == best.0 || (v.1 < best.1 && v.2 < best.2));
    if way.len() >= VOTERS && is_clear {
        return Some(best.0);
    }
    match runs[..] {
        [before, _, after] if !closes && before == after => Some(before),
        _ => None,
    }
}

fn finding(lines: &[Contour], [end, other]: [End; 2], right: Option<f64>) -> Finding {
    let (mut wrong, mut next) = (&lines[end / 2], &lines[other / 2]);
    // The line to be changed comes first; if neither is, the lower one.
    let is_right = |line: &Contour| Some(line.elevation) == right;
    if is_right(wrong) || (!is_right(next) && next.elevation < wrong.elevation) {
        (wrong, next) = (next, wrong);
    }
    let says = match right {
        Some(z) => format!("the other pieces of the line have {z} m"),
        None => "it is not known which of the two is right".to_owned(),
    };
    let message = format!(
        "the contour {} m (feature {}) continues as {} m (feature {}); {says}",
        wrong.elevation, wrong.feature, next.elevation, next.feature
    );
    let (p, q) = (place(lines, end), place(lines, other));
    let (p, q) = (p + DVec2::ZERO, q + DVec2::ZERO);
    let at = if p.x.total_cmp(&q.x).then(p.y.total_cmp(&q.y)).is_le() { p } else { q };
    let finding = Finding::at(FindingKind::LevelJump, at, message)
        .about(wrong.feature, wrong.elevation)
        .about(next.feature, next.elevation);
    match right {
        Some(to) => finding.proposing(Proposal::Relabel { from: wrong.elevation, to }),
        None => finding,
    }
}
