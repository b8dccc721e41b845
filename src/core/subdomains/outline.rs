//! An outline that follows the contours, for maps that do not fill their convex hull: countries, corridors, and maps with
//! a stray line or point far away.
//!
//! The contours are triangulated. Triangles are removed from the hull inwards, those behind the longest edge first. No
//! contour is crossed, so ground inside a closed contour stays. This is the shape of Duckham, Kulik, Worboys and Galton,
//! "Efficient generation of simple polygons for characterizing the shape of a set of points in the plane" (Pattern
//! Recognition 41, 2008), for lines instead of points.

use std::collections::BinaryHeap;
use std::ops::Range;

use geo::{Area, LineString, MultiPolygon, Polygon};
use glam::DVec2;

use super::frame::{Frame, FrameRing, frame_ring};
use super::orient::{line_at, line_starts};
use crate::base::Key;
use crate::base::error::{Finding, FindingKind};
use crate::contour::ContourMap;
use crate::tin::{NONE, Tin, TinInput, VertexKind, triangulate};

/// Edges longer than this many mean spacings of the contours lead into ground that is far from all contours.
const REACH: f64 = 10.0;
/// The outline is followed if less than this share of the hull is near contours.
const FOLLOWED: f64 = 1.0 / 3.0;
/// The user is told of far ground if less than this share of the hull is near contours.
const TOLD: f64 = 0.8;
/// The outline that is followed holds up to this many times the ground near contours. So bays and short gaps in a corridor
/// stay ground.
const SLACK: f64 = 1.5;
/// In these bays and gaps, edges are at most this many times as long as the reach.
const WIDEST: f64 = 4.0;
/// If fewer squares than this meet contours, they are too large for the test.
const FEW_SQUARES: usize = 500;
/// If more than this share of the vertices would have no ground, the lines are too few or too straight to tell what is near.
const LOST: f64 = 0.05;
/// Squares along a side of the box, and squares that lines meet, at most.
const MOST_ACROSS: f64 = 65_536.0;
const MOST_MET: f64 = 1e7;
/// The search for the ground near contours ends when it changes by no more than this share.
const STABLE: f64 = 0.1;
/// It ends after this many rounds.
const ROUNDS: usize = 5;
/// Squares of the quick test: in the hull, and at most in the box around it.
const SQUARES: [f64; 2] = [16e3, 4e6];

/// Decides on the frame of a clean map, if the program may choose it ([`Frame::Auto`]). Lines and spot heights without any
/// ground around them are removed from the map and reported.
pub fn settled(frame: Frame, map: &mut ContourMap, findings: &mut Vec<Finding>) -> Frame {
    if frame != Frame::Auto {
        return frame;
    }
    match outline(map) {
        None => Frame::Hull,
        Some(Outline { near, kept: None }) => {
            let message = format!(
                "{:.0} % of the ground inside the convex hull is far from all contours, and its heights are a guess: set the \
                 border of the map with --frame",
                100.0 * (1.0 - near)
            );
            findings.push(Finding::general(FindingKind::HullBeyondMap, message));
            Frame::Hull
        }
        Some(Outline { near, kept: Some(kept) }) => {
            let message = format!(
                "the contours fill {:.2} % of their convex hull, so the ground ends where the contours end; --frame hull takes \
                 the whole hull, --frame FILE a border",
                100.0 * near
            );
            findings.push(Finding::general(FindingKind::HullBeyondMap, message));
            leave_out(map, &kept, findings);
            Frame::Outline(kept.area)
        }
    }
}

/// How far a map fills its convex hull.
struct Outline {
    /// The share of the hull that is near contours.
    near: f64,
    /// The outline to follow; `None` if the hull is the better frame.
    kept: Option<Kept>,
}

/// The ground inside an outline.
struct Kept {
    area: MultiPolygon<f64>,
    /// The contours and spot heights without ground, by their numbers, ascending.
    lines: Vec<usize>,
    spots: Vec<usize>,
}

/// How far a map fills its hull; `None` if it fills most of it.
fn outline(map: &ContourMap) -> Option<Outline> {
    let ring = frame_ring(map, &Frame::Hull);
    let hull = ring.area.unsigned_area();
    let length: f64 = map.contours.iter().map(|line| line.length()).sum();
    if !(hull > 0.0 && length > 0.0) {
        return None;
    }
    let mut near = roughly_near(map, &ring, length);
    if near > TOLD * hull {
        return None;
    }
    let tin = triangulate(input(map)).ok()?;
    let mut removed = Vec::new();
    for _ in 0..ROUNDS {
        removed = removed_from_outside(&tin, REACH * near / length);
        let found = hull - removed.iter().map(|removed| area(&tin, removed.triangle)).sum::<f64>();
        let is_stable = (found - near).abs() <= STABLE * near;
        near = found;
        if is_stable {
            break;
        }
    }
    let left: Vec<f64> = removed
        .iter()
        .scan(hull, |left, removed| {
            *left -= area(&tin, removed.triangle);
            Some(*left)
        })
        .collect();
    let near = left.last()? / hull;
    if near > TOLD {
        return None;
    }
    let starts = line_starts(map);
    let spans = open_spans(&tin, &removed, &starts);
    if vertices_of(map, lines_without_ground(&spans, removed.len())) > LOST * map.vertex_count() as f64 {
        return None;
    }
    if near > FOLLOWED {
        return Some(Outline { near, kept: None });
    }
    let widest = WIDEST * REACH * near * hull / length;
    let too_wide = removed.partition_point(|removed| removed.narrowest > widest);
    let count = too_wide.max(1 + left.partition_point(|&left| left > SLACK * near * hull));
    let count = without_parts_of_lines(&spans, count);
    if left[..count].last().is_none_or(|left| *left > FOLLOWED.max(SLACK * near) * hull) {
        return Some(Outline { near, kept: None });
    }
    let mut is_kept = vec![true; tin.len()];
    removed[..count].iter().for_each(|removed| is_kept[removed.triangle as usize] = false);
    let lines = lines_without_ground(&spans, count).collect();
    let spots = spots_without_ground(map, &tin, &is_kept, starts[map.contours.len()]);
    Some(Outline { near, kept: Some(Kept { area: rings(map, &tin, &is_kept), lines, spots }) })
}

/// About how much of the hull is near contours, counted in squares.
fn roughly_near(map: &ContourMap, ring: &FrameRing, length: f64) -> f64 {
    let ((lo, hi), hull) = (ring.extent(), ring.area.unsigned_area());
    let size = hi - lo;
    // Long narrow maps and long lines would need many more squares.
    let least = (size.max_element() / MOST_ACROSS).max(length / MOST_MET);
    let side = (hull / SQUARES[0]).max(size.x * size.y / SQUARES[1]).sqrt().max(least);
    let [cols, rows] = (size / side).ceil().max(DVec2::ONE).to_array().map(|n| n as usize);
    let mut is_met = vec![false; cols * rows];
    let mut meet = |p: DVec2| {
        let place = ((p - lo) / side).floor();
        is_met[(place.y as usize).min(rows - 1) * cols + (place.x as usize).min(cols - 1)] = true;
    };
    for line in &map.contours {
        for ends in line.points.windows(2) {
            let steps = (ends[0].distance(ends[1]) / side).ceil().max(1.0);
            (0..=steps as usize).for_each(|k| meet(ends[0].lerp(ends[1], k as f64 / steps)));
        }
    }
    let inside: Vec<Range<usize>> = (0..rows)
        .map(|row| {
            let [from, to] = across(ring, lo.y + (row as f64 + 0.5) * side).map(|x| ((x - lo.x) / side).round());
            let from = (from as usize).min(cols);
            from..(to as usize).clamp(from, cols)
        })
        .collect();
    // The reach follows from the ground that is near, and that from the reach. The search begins with little ground: a point far
    // away makes the hull as large as it likes.
    let met = is_met.iter().filter(|is_met| **is_met).count();
    let mut near = met as f64 * side * side;
    if met < FEW_SQUARES {
        // The squares are too large to tell. Boxes around lines hold each other, so this is still an upper bound.
        let boxes = map.contours.iter().map(|line| {
            let around = |(lo, hi): (DVec2, DVec2), p: &DVec2| (lo.min(*p), hi.max(*p));
            let (lo, hi) = line.points.iter().fold((DVec2::INFINITY, DVec2::NEG_INFINITY), around);
            (hi - lo).element_product()
        });
        return near.min(boxes.sum());
    }
    loop {
        // Ground nearer to a contour than an eighth of the reach is surely near.
        let reach = (REACH / 8.0 * near / length / side).ceil() as usize;
        let wide = spread(&is_met, cols, 1, reach);
        let is_near = spread(&wide, rows, cols, reach);
        let squares = (0..).zip(&inside).flat_map(|(row, inside)| &is_near[row * cols..][inside.clone()]);
        let found = (squares.filter(|is_near| **is_near).count() as f64 * side * side).min(hull);
        if found > TOLD * hull || found <= (1.0 + STABLE) * near {
            return found;
        }
        near = found;
    }
}

/// The least and the greatest x of a convex ring at a height; infinite and in the wrong order where it has none.
fn across(ring: &FrameRing, y: f64) -> [f64; 2] {
    let crossed = ring.edges().filter(|[a, b]| (a.y > y) != (b.y > y));
    crossed
        .map(|[a, b]| a.x + (b.x - a.x) * (y - a.y) / (b.y - a.y))
        .fold([f64::INFINITY, f64::NEG_INFINITY], |[lo, hi], x| [lo.min(x), hi.max(x)])
}

/// Spreads marks along rows (`step` 1, `count` columns) or along columns (`step` the number of columns, `count` rows).
fn spread(marked: &[bool], count: usize, step: usize, reach: usize) -> Vec<bool> {
    let mut near = vec![false; marked.len()];
    for line in 0..marked.len() / count {
        let at = |k: usize| if step == 1 { line * count + k } else { k * step + line };
        let mut end = 0;
        for k in (0..count).filter(|&k| marked[at(k)]) {
            let last = (k + reach + 1).min(count);
            (k.saturating_sub(reach).max(end)..last).for_each(|k| near[at(k)] = true);
            end = last;
        }
    }
    near
}

/// The points of a map, in the order of [`line_starts`], and the pieces of its contours.
fn input(map: &ContourMap) -> TinInput {
    let (lo, hi) = map.places().fold((DVec2::INFINITY, DVec2::NEG_INFINITY), |(lo, hi), p| (lo.min(p), hi.max(p)));
    // No triangle is peeled off the hull.
    let mut input = TinInput::new([lo, hi], -1.0);
    for line in &map.contours {
        let mut before = None;
        for &p in &line.points {
            let point = input.push(p, line.elevation, VertexKind::Contour);
            before.into_iter().for_each(|before| input.push_edge(before, point));
            before = Some(point);
        }
    }
    map.spots.iter().for_each(|spot| {
        input.push(spot.truncate(), spot.z, VertexKind::Spot);
    });
    input
}

fn area(tin: &Tin, t: u32) -> f64 {
    let [a, b, c] = tin.corners(t);
    (b - a).perp_dot(c - a) / 2.0
}

/// A triangle far from contours that can be reached from outside.
struct Removed {
    triangle: u32,
    /// The shortest edge on the way to it, map units. Of all ways, it is the one on which this edge is longest.
    narrowest: f64,
}

/// The triangles far from contours that can be reached from outside, those behind the longest edges first. All edges on the
/// ways to them are longer than the reach.
fn removed_from_outside(tin: &Tin, reach: f64) -> Vec<Removed> {
    let mut ways: BinaryHeap<(Key, std::cmp::Reverse<u32>)> = BinaryHeap::new();
    for t in 0..tin.len() as u32 {
        for i in (0..3).filter(|&i| tin.neighbours[t as usize][i] == NONE && !tin.is_constraint(t, i)) {
            ways.push((Key(tin.edge_length(t, i)), std::cmp::Reverse(t)));
        }
    }
    let mut is_removed = vec![false; tin.len()];
    let mut removed = Vec::new();
    while let Some((Key(narrowest), std::cmp::Reverse(t))) = ways.pop() {
        if narrowest <= reach {
            break;
        }
        if std::mem::replace(&mut is_removed[t as usize], true) {
            continue;
        }
        removed.push(Removed { triangle: t, narrowest });
        for i in (0..3).filter(|&i| !tin.is_constraint(t, i)) {
            let n = tin.neighbours[t as usize][i];
            if n != NONE && !is_removed[n as usize] {
                ways.push((Key(narrowest.min(tin.edge_length(t, i))), std::cmp::Reverse(n)));
            }
        }
    }
    removed
}

/// By contour: after how many removals its first piece and its last piece have no ground on either side. `None` if no
/// piece ever does, and infinitely many if a piece never does.
fn open_spans(tin: &Tin, removed: &[Removed], starts: &[u32]) -> Vec<Option<[usize; 2]>> {
    let mut order = vec![usize::MAX; tin.len()];
    removed.iter().enumerate().for_each(|(k, removed)| order[removed.triangle as usize] = k);
    let mut spans: Vec<Option<[usize; 2]>> = vec![None; starts.len() - 1];
    for t in 0..tin.len() as u32 {
        for i in (0..3).filter(|&i| tin.is_constraint(t, i)) {
            let n = tin.neighbours[t as usize][i];
            let bare = order[t as usize].max(if n == NONE { 0 } else { order[n as usize] });
            // Vertices that several contours share bear no piece of their own; the other end of the piece does.
            let lines = tin.edge(t, i).map(|v| line_at(tin, starts, v));
            for line in lines.into_iter().flatten() {
                let span = &mut spans[line as usize];
                *span = Some(span.map_or([bare; 2], |[first, last]| [first.min(bare), last.max(bare)]));
            }
        }
    }
    spans.into_iter().map(|span| span.filter(|[first, _]| *first < usize::MAX)).collect()
}

/// The contours that have no ground along any piece after so many removals.
fn lines_without_ground(spans: &[Option<[usize; 2]>], count: usize) -> impl Iterator<Item = usize> {
    (0..spans.len()).filter(move |&line| spans[line].is_some_and(|[_, last]| last < count))
}

/// The number of vertices of some contours.
fn vertices_of(map: &ContourMap, lines: impl Iterator<Item = usize>) -> f64 {
    lines.map(|line| map.contours[line].points.len()).sum::<usize>() as f64
}

/// The largest number of removals, at most `count`, after which each contour has ground along all of its pieces or along
/// none.
fn without_parts_of_lines(spans: &[Option<[usize; 2]>], mut count: usize) -> usize {
    loop {
        let parted = spans.iter().flatten().filter(|[first, last]| *first < count && count <= *last);
        match parted.map(|[first, _]| *first).min() {
            Some(first) => count = first,
            None => return count,
        }
    }
}

fn spots_without_ground(map: &ContourMap, tin: &Tin, is_kept: &[bool], first: u32) -> Vec<usize> {
    let mut has_ground = vec![false; tin.positions.len()];
    let kept = tin.triangles.iter().zip(is_kept).filter(|(_, kept)| **kept);
    kept.flat_map(|(corners, _)| corners).for_each(|&v| has_ground[v as usize] = true);
    let bare = tin.source.iter().zip(has_ground).filter(|(source, has_ground)| **source >= first && !has_ground);
    let mut spots: Vec<usize> = bare.map(|(source, _)| (source - first) as usize).collect();
    // Of several spot heights at one position, only the first is a vertex.
    let places: Vec<DVec2> = spots.iter().map(|&k| map.spots[k].truncate()).collect();
    spots = (0..map.spots.len()).filter(|&k| places.contains(&map.spots[k].truncate())).collect();
    spots
}

/// The rings around the triangles that are kept. Rings may touch each other at a corner.
fn rings(map: &ContourMap, tin: &Tin, is_kept: &[bool]) -> MultiPolygon<f64> {
    let places: Vec<DVec2> = map.places().collect();
    let place = |v: u32| places[tin.source[v as usize] as usize];
    let is_kept = |t: u32| t != NONE && is_kept[t as usize];
    let is_border = |t: u32, i: usize| is_kept(t) && !is_kept(tin.neighbours[t as usize][i]);
    let mut is_taken = vec![[false; 3]; tin.len()];
    let mut polygons = Vec::new();
    for (first, i) in (0..tin.len() as u32).flat_map(|t| (0..3).map(move |i| (t, i))) {
        if !is_border(first, i) || is_taken[first as usize][i] {
            continue;
        }
        let mut ring = Vec::new();
        let (mut t, mut i) = (first, i);
        while !std::mem::replace(&mut is_taken[t as usize][i], true) {
            let p = place(tin.edge(t, i)[0]);
            ring.push((p.x, p.y));
            // The next edge of the border at the far end of this one, found by turning around that end.
            i = (i + 1) % 3;
            while !is_border(t, i) {
                let n = tin.neighbours[t as usize][i];
                let Some(k) = tin.edge_towards(n, t) else { break };
                (t, i) = (n, (k + 1) % 3);
            }
        }
        polygons.push(Polygon::new(LineString::from(ring), Vec::new()));
    }
    MultiPolygon::new(polygons)
}

/// Removes the lines and spot heights without ground from a map, and reports them.
fn leave_out(map: &mut ContourMap, kept: &Kept, findings: &mut Vec<Finding>) {
    for &line in &kept.lines {
        let line = &map.contours[line];
        let message = format!(
            "the contour {} m (feature {}) is left out: it lies far from all others, so there is no ground beside it",
            line.elevation, line.feature
        );
        let finding = Finding::new(FindingKind::FarAway, line.points.first().copied(), message);
        findings.push(finding.about(line.feature, line.elevation));
    }
    if let Some(first) = kept.spots.first().map(|&spot| map.spots[spot]) {
        let message = match kept.spots.len() {
            1 => format!("the spot height {} m is left out: it lies far from all contours", first.z),
            count => format!("{count} spot heights are left out: they lie far from all contours; the first"),
        };
        findings.push(Finding::at(FindingKind::FarAway, first.truncate(), message).of_elevations([first.z]));
    }
    let mut k = 0..;
    map.contours.retain(|_| k.next().is_none_or(|k| kept.lines.binary_search(&k).is_err()));
    let mut k = 0..;
    map.spots.retain(|_| k.next().is_none_or(|k| kept.spots.binary_search(&k).is_err()));
}
