//! Moves reaches into the tips of contours.
//!
//! Where a stream crosses a contour, the contour bends upstream, and the stream lies in the tip of the bend. A stream
//! that was drawn apart from the contours crosses beside the tip. For each crossing of a reach, the tips within the
//! tolerance are candidates. Dynamic programming along the reach (Viterbi) takes those with deep bends, small shifts and
//! little change of shift from crossing to crossing. Between crossings, the shift changes steadily.

use glam::DVec2;

use super::along::Along;
use super::descend::Ground;
use super::network::Reach;
use crate::subdomains::line_at;
use crate::subdomains::{Course, Crossing};
use crate::tin::NONE;
use crate::tuning::StreamTuning;

/// A crossing of a reach with its shift.
#[derive(Debug, Clone, Copy)]
pub(super) struct Shift {
    /// Distance along the reach, map units.
    pub at: f64,
    /// From the crossing to its tip, map units; zero where the crossing stays.
    pub by: DVec2,
    /// The tip; the crossing itself where it stays.
    pub place: DVec2,
}

/// The shifts at the crossings of a reach. `points` and the course run downstream.
pub(super) fn shifts(
    ground: &Ground<'_>,
    points: &[DVec2],
    course: &Course,
    tolerance: f64,
    tuning: &StreamTuning,
) -> Vec<Shift> {
    if tolerance <= 0.0 {
        return Vec::new();
    }
    let along = Along::new(points);
    let crossings: Vec<&Crossing> = course.crossings.iter().filter(|c| c.level.is_some()).collect();
    let candidates: Vec<Vec<Candidate>> = crossings
        .iter()
        .map(|crossing| {
            let ends = [crossing.at - tolerance, crossing.at + tolerance].map(|at| along.place(at));
            let down = (ends[1] - ends[0]).normalize_or_zero();
            let mut found = vec![Candidate { by: DVec2::ZERO, place: crossing.place, cost: 0.0 }];
            found.extend(tips(ground, crossing, down, tolerance, tuning).map(|(place, depth)| {
                let by = place - crossing.place;
                let gain = (depth / (tuning.deep_tip * tolerance)).min(1.0);
                Candidate { by, place, cost: tuning.shift_cost * by.length() / tolerance - gain }
            }));
            found
        })
        .collect();
    let chosen = cheapest(&candidates, |a, b| tuning.change_cost * a.distance(b) / tolerance);
    let shift = |(crossing, chosen): (&&Crossing, Candidate)| {
        let Candidate { by, place, .. } = chosen;
        Shift { at: crossing.at, by, place }
    };
    crossings.iter().zip(chosen).map(shift).collect()
}

/// How far a reach runs beside the tips of the contours that it crosses, map units; none where it runs in them, or where
/// there are no tips. `shifts` are those that the tolerance allows.
pub(super) fn beside_tips(
    ground: &Ground<'_>,
    points: &[DVec2],
    course: &Course,
    (tolerance, shifts): (f64, &[Shift]),
    tuning: &StreamTuning,
) -> Option<f64> {
    // Most streams run in their valleys. The wider search is for the others.
    let stays = shifts.iter().filter(|shift| shift.by == DVec2::ZERO).count();
    if tolerance <= 0.0 || shifts.len() < 2 || 2 * stays <= shifts.len() {
        return None;
    }
    // Bends count here as they do within the tolerance, and a shift costs little: the course is looked for, not corrected.
    let StreamTuning { beside_reach, least_tip, deep_tip, shift_cost, .. } = *tuning;
    let of_wide = StreamTuning {
        least_tip: least_tip / beside_reach,
        deep_tip: deep_tip / beside_reach,
        shift_cost: shift_cost / beside_reach,
        ..*tuning
    };
    let wide = self::shifts(ground, points, course, beside_reach * tolerance, &of_wide);
    let mut off: Vec<f64> = wide.iter().map(|shift| shift.by.length()).filter(|by| *by > tolerance).collect();
    off.sort_unstable_by(f64::total_cmp);
    (2 * off.len() > wide.len()).then(|| off[off.len() / 2])
}

/// A place that a crossing may move to.
#[derive(Debug, Clone, Copy)]
struct Candidate {
    by: DVec2,
    place: DVec2,
    cost: f64,
}

/// The chain of candidates with the least sum of own costs and costs of changes.
fn cheapest(candidates: &[Vec<Candidate>], change: impl Fn(DVec2, DVec2) -> f64) -> Vec<Candidate> {
    // The least cost up to each candidate, and the candidate before it.
    let mut rows: Vec<Vec<(f64, usize)>> = Vec::with_capacity(candidates.len());
    for (k, row) in candidates.iter().enumerate() {
        let best = |own: &Candidate| match k.checked_sub(1) {
            None => (own.cost, 0),
            Some(before) => {
                let ways = candidates[before].iter().zip(&rows[before]).enumerate();
                let ways = ways.map(|(i, (from, &(sum, _)))| (sum + change(from.by, own.by) + own.cost, i));
                ways.fold((f64::INFINITY, 0), |best, way| if way.0 < best.0 { way } else { best })
            }
        };
        rows.push(row.iter().map(best).collect());
    }
    let mut chosen = Vec::with_capacity(candidates.len());
    let last = rows.last().into_iter().flatten().enumerate();
    let mut at = last.fold((f64::INFINITY, 0), |best, (i, &(cost, _))| if cost < best.0 { (cost, i) } else { best }).1;
    for (row, ways) in candidates.iter().zip(&rows).rev() {
        chosen.push(row[at]);
        at = ways[at].1;
    }
    chosen.reverse();
    chosen
}

/// The tips of a contour within `reach` of a crossing: vertices from which both arms of the contour run downstream. Each
/// with its place and the depth of its bend (map units): how far the shorter arm runs downstream.
fn tips<'a>(
    ground: &'a Ground<'_>,
    crossing: &Crossing,
    down: DVec2,
    reach: f64,
    tuning: &StreamTuning,
) -> impl Iterator<Item = (DVec2, f64)> + use<'a> {
    let from = crossing.place;
    let [mut run, right] = arms(ground, crossing, 2.0 * reach);
    run.reverse();
    run.extend(right);
    let upstream: Vec<f64> = run.iter().map(|p| -(*p - from).dot(down)).collect();
    let least = tuning.least_tip * reach;
    let is_near = move |p: DVec2| p.distance(from) <= reach;
    let mut found = Vec::new();
    for k in 1..run.len().saturating_sub(1) {
        let here = upstream[k];
        if !is_near(run[k]) || upstream[k - 1] > here || upstream[k + 1] >= here {
            continue;
        }
        // Each arm as far as it stays below the tip.
        let arm = |side: &mut dyn Iterator<Item = f64>| side.take_while(|u| *u <= here).fold(here, f64::min);
        let left = here - arm(&mut upstream[..k].iter().rev().copied());
        let right = here - arm(&mut upstream[k + 1..].iter().copied());
        let depth = left.min(right);
        if depth >= least {
            found.push((run[k], depth));
        }
    }
    found.into_iter()
}

/// The vertices of the contour that is crossed, from the crossing to both sides, until they are `reach` away along it.
pub(super) fn arms(ground: &Ground<'_>, crossing: &Crossing, reach: f64) -> [Vec<DVec2>; 2] {
    let Ground { map, tin, starts, .. } = ground;
    let nothing = [Vec::new(), Vec::new()];
    let [u, v] = crossing.edge;
    let (Some(line), true) = (line_at(tin, starts, if u == NONE { return nothing } else { u }), v != NONE) else {
        return nothing;
    };
    let contour = &map.contours[line as usize];
    let first = starts[line as usize];
    let number = |v: u32| tin.source[v as usize].checked_sub(first).map(|n| n as usize);
    let count = contour.points.len() - usize::from(contour.is_closed());
    let (Some(a), Some(b)) = (number(u), number(v)) else { return nothing };
    if a >= count || b >= count {
        return nothing;
    }
    let (mut low, mut high) = (a.min(b), a.max(b));
    if high - low > 1 {
        (low, high) = (high, low);
    }
    let local = |k: usize| contour.points[k] - tin.origin;
    let walk = |start: usize, forward: bool| {
        let mut out = Vec::new();
        let (mut k, mut at, mut length) = (start, crossing.place, 0.0);
        for _ in 0..count {
            let p = local(k);
            length += at.distance(p);
            out.push(p);
            if length > reach {
                break;
            }
            at = p;
            k = match (forward, contour.is_closed()) {
                (true, true) => (k + 1) % count,
                (false, true) => (k + count - 1) % count,
                (true, false) if k + 1 < count => k + 1,
                (false, false) if k > 0 => k - 1,
                _ => break,
            };
        }
        out
    };
    [walk(low, false), walk(high, true)]
}

/// Moves the reaches, whose `shifts` are in their order. A node moves as the nearest crossings of its reaches do in the
/// mean.
pub(super) fn moved(reaches: &[Reach], nodes: usize, shifts: &[Vec<Shift>]) -> Vec<Reach> {
    let mut of_nodes = vec![(DVec2::ZERO, 0.0); nodes];
    for (reach, shifts) in reaches.iter().zip(shifts) {
        for (node, shift) in reach.nodes.into_iter().zip([shifts.first(), shifts.last()]) {
            if let Some(shift) = shift {
                of_nodes[node].0 += shift.by;
                of_nodes[node].1 += 1.0;
            }
        }
    }
    let of_node = |node: usize| {
        let (sum, count) = of_nodes[node];
        if count > 0.0 { sum / count } else { DVec2::ZERO }
    };
    let moved = |(reach, shifts): (&Reach, &Vec<Shift>)| {
        let [first, last] = reach.nodes.map(of_node);
        if first == DVec2::ZERO && last == DVec2::ZERO && shifts.iter().all(|s| s.by == DVec2::ZERO) {
            return reach.clone();
        }
        let length = reach.length();
        let inner = shifts.iter().map(|shift| (shift.at, shift.by));
        let all: Vec<(f64, DVec2)> = [(0.0, first)].into_iter().chain(inner).chain([(length, last)]).collect();
        let mut points: Vec<DVec2> = Vec::with_capacity(reach.points.len() + shifts.len());
        let mut next = 0;
        let mut walked = 0.0;
        points.push(reach.points[0] + first);
        for w in reach.points.windows(2) {
            let step = w[0].distance(w[1]);
            // Each crossing becomes a vertex, exactly at its tip.
            while let Some(shift) = shifts.get(next).filter(|shift| shift.at <= walked + step) {
                points.push(shift.place);
                next += 1;
            }
            walked += step;
            let k = all.partition_point(|(at, _)| *at <= walked).clamp(1, all.len() - 1);
            let ((a, from), (b, to)) = (all[k - 1], all[k]);
            let share = if b > a { ((walked - a) / (b - a)).clamp(0.0, 1.0) } else { 1.0 };
            points.push(w[1] + from.lerp(to, share));
        }
        if let Some(end) = points.last_mut() {
            *end = reach.points[reach.points.len() - 1] + last;
        }
        points.dedup();
        Reach { points, ..reach.clone() }
    };
    reaches.iter().zip(shifts).map(moved).collect()
}
